//! The equivalent circuit from what a catalogue says of a machine.

use blocksim_block::prelude::positive;
use blocksim_block::{ParamError, ParamErrors};

use super::base::Base;
use super::circuit::{Cages, Circuit};
use super::complex::complex;
use super::fit::least_squares;
use super::magnetisation::Magnetisation;

/// Rated values of a machine, at rated voltage and frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamePlate {
    /// Power at the shaft, W.
    pub power: f64,
    /// RMS voltage from line to line, V, for windings in delta.
    pub voltage: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Number of pole pairs.
    pub pole_pairs: u32,
    /// Slip at rated power.
    pub slip: f64,
    /// Power factor at rated power.
    pub power_factor: f64,
    /// Power at the shaft over power from the lines.
    pub efficiency: f64,
    /// Power that friction and the fan of the machine take, W.
    pub mechanical_loss: f64,
    /// Largest torque over rated torque.
    pub breakdown_torque: f64,
    /// What the machine does at standstill; `None` for a circuit with a single cage.
    pub locked_rotor: Option<LockedRotor>,
    /// Leakage reactance of the stator over that of the cage (of the outer one, where there are two).
    pub leakage_ratio: f64,
    /// Relative deviation that is accepted where no circuit has all these figures.
    pub tolerance: f64,
}

/// Standstill, over rated values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LockedRotor {
    /// Torque over rated torque.
    pub torque: f64,
    /// Current over rated current.
    pub current: f64,
}

/// A figure of a name plate with its value in per unit.
type Figure = (&'static str, f64);

impl NamePlate {
    /// Base values; the apparent power is that which the machine draws at rated power, so that the rated current is 1.
    pub fn base(&self) -> Base {
        let apparent = self.power / (self.efficiency * self.power_factor);
        Base::of(apparent, self.voltage, self.frequency, self.pole_pairs)
    }

    /// The circuit that draws the rated current at the rated power factor, gives the rated power, and has the torque
    /// and the current that are wanted at breakdown and at standstill.
    ///
    /// With voltage and current 1, the power factor is the power drawn, and the torque is the power that reaches the
    /// rotor, `efficiency power_factor / (1 - slip)` (with the mechanical loss added to the power at the shaft). The
    /// rest is lost in the stator: `r_s = power_factor - torque`. Iron losses are not modelled; they are counted as
    /// losses in the stator's resistance.
    ///
    /// The other parameters are found by least squares, in logarithms: with a single cage `x_m`, `r_r`, `x_lr` from
    /// torque and reactive power at rated slip and the breakdown torque; with two cages `x_m`, `r_r`, `x_lr`, `r_r2`,
    /// `x_lr2` from the same and torque and current at standstill. The second cage has the higher resistance and the
    /// smaller reactance. In both cases `x_ls` is a given multiple of the reactance of the (outer) cage.
    ///
    /// # Errors
    /// Figures that no circuit has within the tolerance.
    pub fn circuit(&self) -> Result<Circuit, ParamError> {
        let torque = self.torque();
        let r_s = (self.power_factor - torque).max(0.0);
        let reactive = (1.0 - self.power_factor.powi(2)).sqrt();
        let mut figures = vec![
            ("slip", torque),
            ("power_factor", reactive),
            ("breakdown_torque", self.breakdown_torque * torque),
        ];
        if let Some(locked) = self.locked_rotor {
            figures.push(("locked_rotor.torque", locked.torque * torque));
            figures.push(("locked_rotor.current", locked.current));
        }
        let circuit = match self.locked_rotor {
            None => search(&figures, self.slip, single_starts(r_s, reactive, &figures), |x| {
                let [x_m, r, l] = x.map(f64::exp);
                assembled(r_s, self.leakage_ratio * l, x_m, Cages::Single { r, l })
            }),
            Some(locked) => {
                search(&figures, self.slip, double_starts(r_s, reactive, torque, self.slip, locked), |x| {
                    let [x_m, r_1, r_more, l_2, l_more] = x.map(f64::exp);
                    let cages = Cages::Double { r: [r_1, r_1 + r_more], l: [l_2 + l_more, l_2], common: 0.0 };
                    assembled(r_s, self.leakage_ratio * l_2, x_m, cages)
                })
            }
        };
        self.accept(circuit, &figures)
    }

    /// Rated torque in per unit: the power that reaches the rotor.
    fn torque(&self) -> f64 {
        let shaft = self.efficiency * self.power_factor;
        shaft * (1.0 + self.mechanical_loss / self.power) / (1.0 - self.slip)
    }

    /// Reports figures that contradict each other; what each of them must be is declared where they are parameters.
    pub fn validate(&self, errors: &mut ParamErrors) {
        if !(self.slip > 0.0 && self.slip < 1.0) {
            let message =
                format!("the slip at rated power is {:.4}, but a motor slips by more than 0", self.slip);
            let error = ParamError::new("speed", message).beside(&["frequency", "pole_pairs"]);
            errors.add(error.help("rated speed is a little less than frequency over pole pairs: check both"));
        }
        let torque = self.torque();
        if torque > self.power_factor * (1.0 + 1e-12) {
            let best = (1.0 - self.slip) / (1.0 + self.mechanical_loss / self.power);
            let message = format!(
                "`efficiency` is {:.4}, but at a slip of {:.4} the rotor alone leaves no more than {best:.4}",
                self.efficiency, self.slip
            );
            let error = ParamError::new("efficiency", message);
            errors.add(
                error
                    .beside(&["power_factor", "mechanical_loss", "power", "speed", "frequency", "pole_pairs"])
                    .help("check speed, pole pairs and frequency, or make `mechanical_loss` smaller"),
            );
        }
        if let Some(locked) = self.locked_rotor {
            self.validate_locked(locked, torque, errors);
        }
    }

    fn validate_locked(&self, locked: LockedRotor, torque: f64, errors: &mut ParamErrors) {
        errors.take(positive("locked_rotor.torque", locked.torque));
        errors.take(positive("locked_rotor.current", locked.current));
        if !errors.is_right("locked_rotor") {
            return;
        }
        if locked.torque > self.breakdown_torque {
            let message = format!(
                "the torque at standstill ({}) is larger than `breakdown_torque` ({}), the maximum of all",
                locked.torque, self.breakdown_torque
            );
            let error = ParamError::new("locked_rotor.torque", message).beside(&["breakdown_torque"]);
            errors.add(error.help("both are multiples of the rated torque: check which is which"));
        }
        // All power that reaches a locked rotor heats it.
        let r_s = (self.power_factor - torque).max(0.0);
        let power = locked.torque * torque + r_s * locked.current.powi(2);
        if power >= locked.current {
            let message = format!(
                "at standstill rotor and stator would take {power:.3} times the rated apparent power, but the \
                 current brings no more than {:.3}",
                locked.current
            );
            let error = ParamError::new("locked_rotor.current", message);
            errors.add(
                error
                    .beside(&["efficiency", "power_factor", "speed"])
                    .help("check both figures; a higher `efficiency` makes the losses of the stator smaller"),
            );
        }
    }

    /// The circuit, if its figures are near enough.
    fn accept(&self, circuit: Circuit, figures: &[Figure]) -> Result<Circuit, ParamError> {
        let found = figures_of(&circuit, self.slip);
        let deviation = |k: usize| found[k] / figures[k].1 - 1.0;
        let Some(worst) =
            (0..figures.len()).max_by(|a, b| deviation(*a).abs().total_cmp(&deviation(*b).abs()))
        else {
            return Ok(circuit);
        };
        // What the search leaves is rounding.
        if deviation(worst).abs() <= self.tolerance.max(1e-9) {
            return Ok(circuit);
        }
        let cages = if self.locked_rotor.is_some() { "two cages" } else { "a single cage" };
        let words: Vec<String> = (0..figures.len())
            .filter(|k| deviation(*k).abs() > self.tolerance.max(1e-3))
            .map(|k| {
                let what = match figures[k].0 {
                    "slip" => "rated torque",
                    "power_factor" => "rated reactive power",
                    "breakdown_torque" => "breakdown torque",
                    "locked_rotor.torque" => "torque at standstill",
                    _ => "current at standstill",
                };
                format!("{what} {:+.1} %", 100.0 * deviation(k))
            })
            .collect();
        let message = format!(
            "no circuit with {cages} has all these figures; the nearest deviates: {}",
            if words.is_empty() { format!("{:+.3} %", 100.0 * deviation(worst)) } else { words.join(", ") }
        );
        let percent = (100.0 * deviation(worst).abs() * 1.05).ceil().max(1.0);
        Err(ParamError::new(if figures[worst].0 == "slip" { "speed" } else { figures[worst].0 }, message)
            .help(format!(
                "check the figures, change `leakage_ratio`, or accept it with `tolerance: \"{percent} %\"`"
            )))
    }
}

fn assembled(r_s: f64, l_ls: f64, x_m: f64, cages: Cages) -> Circuit {
    Circuit { r_s, l_ls, magnetisation: Magnetisation::linear(x_m), cages, l_0: None }
}

/// Torque and reactive power at rated slip, breakdown torque, torque and current at standstill.
fn figures_of(circuit: &Circuit, slip: f64) -> [f64; 5] {
    let rated = circuit.steady_state(1.0, 1.0, slip);
    let locked = circuit.steady_state(1.0, 1.0, 1.0);
    [rated.torque, -rated.i_s.im, circuit.breakdown(1.0, 1.0).1, locked.torque, locked.i_s.abs()]
}

/// The circuit with the smallest deviation from the figures; the search ends with the first that has them all.
fn search<const N: usize>(
    figures: &[Figure],
    slip: f64,
    starts: Vec<[f64; N]>,
    circuit: impl Fn(&[f64; N]) -> Circuit,
) -> Circuit {
    let residuals = |x: &[f64; N]| {
        let found = figures_of(&circuit(x), slip);
        std::array::from_fn(|k| (found[k] / figures[k].1).ln())
    };
    let mut best: Option<([f64; N], f64)> = None;
    for start in starts {
        let result = least_squares(residuals, start.map(f64::ln));
        if best.is_none_or(|best| result.1 < best.1) {
            best = Some(result);
        }
        if result.1 < 1e-20 {
            break;
        }
    }
    circuit(&best.map_or([0.0; N], |best| best.0))
}

/// Magnetising reactance, resistance and reactance of the cage.
fn single_starts(r_s: f64, reactive: f64, figures: &[Figure]) -> Vec<[f64; 3]> {
    // T_b = 1 / (2 (r_s + |r_s + j x|)), without the magnetising current.
    let half = 0.5 / figures[2].1;
    let x = (half * half - 2.0 * half * r_s).max(1e-4 * half * half).sqrt();
    [0.5, 0.25, 1.0, 0.05].iter().map(|share| [1.0 / reactive, 0.02, share * x]).collect()
}

/// Magnetising reactance, resistance of the inner cage, what the outer has more, reactance of the outer cage, what
/// the inner has more.
fn double_starts(r_s: f64, reactive: f64, torque: f64, slip: f64, locked: LockedRotor) -> Vec<[f64; 5]> {
    // At standstill, without the magnetising current: z = 1/i = r_s + r + j x.
    let z = 1.0 / locked.current;
    let r = locked.torque * torque / locked.current.powi(2);
    let x = (z * z - (r_s + r).powi(2)).max(0.01 * z * z).sqrt();
    let r_1 = slip / torque * complex(1.0, x).square();
    let mut starts = Vec::new();
    for outer in [0.3, 0.1] {
        for more in [1.0, 3.0, 0.3] {
            for inner in [1.0, 3.0] {
                starts.push([1.0 / reactive, r_1, more * r.max(r_1), outer * x, inner * outer * x]);
            }
        }
    }
    starts
}

#[cfg(test)]
#[path = "name_plate_tests.rs"]
mod tests;
