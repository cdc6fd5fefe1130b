use blocksim_block::prelude::*;

use super::modulation::{Amount, Carrier, Modulation, Modulator, Sampling};
use super::switching;

/// Gates of a three-phase bridge for phase voltages: pulse-width modulation.
///
/// $$ m_x = \frac{v_x + v_0}{V_{dc}/2}, \qquad d_x = \min(\max((1 + m_x)/2, 0), 1) $$
///
/// A leg is high for the share $d_x$ of each period of a triangular carrier, in the middle of the period: with
/// symmetric sampling, in period $k$ of length $T$, from $(k + (1 - d_x)/2)\,T$ to $(k + (1 + d_x)/2)\,T$. The mean of its
/// voltage over the period is then $d_x V_{dc}$. The laws differ in $v_0$, which no winding sees:
///
/// - `Sine`: $v_0 = 0$. Phase voltages up to $V_{dc}/2$; all others reach $V_{dc}/\sqrt3$.
/// - `SpaceVector`: $v_0 = -(\max(v) + \min(v))/2$.
/// - `Discontinuous60`, `Discontinuous60Leading`, `Discontinuous60Lagging`, `Discontinuous30`,
///   `Discontinuous120Upper`, `Discontinuous120Lower`: $v_0$ holds one leg at a time still, which saves a third of the
///   switching. Each leg rests for 60 degrees around its peaks, or 30 degrees earlier or later; four times for 30 degrees
///   beside its peaks; or for 120 degrees high or low.
///
/// Sampling: `Symmetric` takes the inputs at the start of each period, `Asymmetric` in its middle as well. `Natural`
/// compares them with the carrier all the time; the solver finds where they cross. With a method of fixed step, which
/// looks for no crossings, natural edges fall on its steps. Edges that are known beforehand are hit exactly, and do not
/// drift: their times are computed from the number of the period. Where the references of a discontinuous law jump, and where
/// the DC link comes and goes, the solver stops as well: legs may turn there, too. A controller that samples at the same instant as the
/// modulator is taken without delay; put a `UnitDelay` between them for one that computes for a period.
///
/// After a leg is turned, both its switches are off for `dead_time`. That shortens each pulse and costs voltage:
/// for a current of constant sign $V_{dc}$ times `dead_time` in each period. Without a DC link the duties are 1/2.
///
/// Source: D. G. Holmes, T. A. Lipo, *Pulse Width Modulation for Power Converters*, chapters 3, 5 and 6.
///
/// ```ron
/// PwmGenerator(switching_frequency: "8 kHz", modulation: SpaceVector, dead_time: "2 us")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Curve(Modulation))]
pub struct PwmGenerator {
    /// Periods of the carrier per second, positive.
    #[block(unit = "Hz", positive, remedy = "drives switch at 2 kHz to 20 kHz")]
    pub switching_frequency: f64,
    /// `Sine`, `SpaceVector`, `Discontinuous60`, `Discontinuous60Leading`, `Discontinuous60Lagging`,
    /// `Discontinuous30`, `Discontinuous120Upper` or `Discontinuous120Lower`.
    #[block(default = Modulation::SpaceVector)]
    pub modulation: Modulation,
    /// `Natural`, `Symmetric` or `Asymmetric`.
    #[block(default = Sampling::Symmetric)]
    pub sampling: Sampling,
    /// For how long both switches of a leg are off when it turns; less than half of a period.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub dead_time: f64,
}

const V: usize = 0;
const VDC: usize = 1;

const LEGS: [&str; 3] = ["a", "b", "c"];

const MODULATION: usize = 1;
const DUTY: usize = 2;

impl PwmGenerator {
    fn modulator(&self) -> Modulator {
        Modulator {
            carrier: Carrier { frequency: self.switching_frequency },
            sampling: self.sampling,
            dead_time: self.dead_time,
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        switching::validate(self.switching_frequency, self.dead_time, errors);
    }
}

impl Block for PwmGenerator {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let three = PortType::vector(3);
        let interface = Interface::new()
            .input(Input::real("v").shape(Shape::Vector(3)).unit("V").doc("required phase voltages a, b, c"))
            .input(Input::real("vdc").scalar().unit("V").doc("voltage of the DC link"))
            .output(switching::gates(6, "a+, a-, b+, b-, c+, c-"))
            .output(Output::like("modulation", three).doc("of each leg, -1 (always low) to 1 (always high)"))
            .output(Output::like("duty", three).doc("share of the period during which each leg is high"));
        let interface = switching::remember(interface, self.sampling, &LEGS);
        Ok(match self.sampling {
            Sampling::Natural => switching::hold_branches(interface, self.modulation),
            Sampling::Symmetric | Sampling::Asymmetric => interface,
        })
    }

    fn law(&self, l: &Recording) -> bool {
        let v = [0, 1, 2].map(|phase| l.input(V)[phase]);
        // Not limited: natural sampling needs no limits, and a reference that stays beyond the carrier must not touch it.
        let duties = |branches| self.modulation.references_of(v, l.u(VDC), branches).map(|m| 0.5 * (1.0 + m));
        let (turning, duties) = match self.sampling {
            Sampling::Natural => {
                let own = [Modulator::cells(LEGS.len()), LEGS.len()];
                let [held, now] = switching::record_branches(l, self.modulation, (v, l.u(VDC)), own);
                (duties(now), duties(held))
            }
            Sampling::Symmetric | Sampling::Asymmetric => {
                let sampled = duties(self.modulation.branches(v, l.u(VDC)));
                (sampled, sampled)
            }
        };
        switching::record(l, &self.modulator(), [&turning, &duties]);
        let duty = |leg: usize| match self.sampling {
            Sampling::Natural => duties[leg].within(0.0, 1.0),
            _ => Modulator::duty(l.d(), leg),
        };
        l.each(MODULATION, |leg| 2.0 * duty(leg) - 1.0);
        l.each(DUTY, duty);
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.modulator().next_event(c.t, c.d)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use blocksim_block::testing::Bench;

    const PWM: PwmGenerator = PwmGenerator {
        switching_frequency: 5e3,
        modulation: Modulation::SpaceVector,
        sampling: Sampling::Symmetric,
        dead_time: 0.0,
    };
    const PERIOD: f64 = 1.0 / 5e3;

    fn bench(pwm: PwmGenerator) -> Bench {
        Bench::with_inputs(
            pwm,
            vec![("v".to_owned(), PortType::vector(3)), ("vdc".to_owned(), PortType::scalar())],
        )
    }

    fn phases(amplitude: f64, angle: f64) -> [f64; 3] {
        [0.0, 1.0, 2.0].map(|k| amplitude * (angle - k * TAU / 3.0).cos())
    }

    /// Steps from event to event up to `end`, with inputs as functions of time; hands out start, end and outputs.
    fn walk(
        bench: &mut Bench,
        end: f64,
        v: impl Fn(f64) -> [f64; 3],
        mut seen: impl FnMut(f64, f64, &[f64]),
    ) {
        while bench.t < end {
            let start = bench.t;
            let y = bench.set(V, &v(start)).set(VDC, &[560.0]).major();
            let next = bench.next_event();
            assert!(next > start);
            seen(start, next, &y);
            bench.t = next;
        }
    }

    #[test]
    fn volt_seconds_of_each_period_are_those_of_the_references() {
        for modulation in [Modulation::Sine, Modulation::SpaceVector, Modulation::Discontinuous60] {
            let v = |t: f64| phases(270.0, TAU * 50.0 * t);
            let mut area = [[0.0; 3]; 100];
            let mut bench = bench(PwmGenerator { modulation, ..PWM });
            walk(&mut bench, 100.0 * PERIOD, v, |start, end, y| {
                let period = ((start + end) / 2.0 / PERIOD) as usize;
                for leg in 0..3 {
                    area[period][leg] += 560.0 * y[2 * leg] * (end - start);
                }
            });
            for (k, area) in area.iter().enumerate() {
                let v = v(k as f64 / 5e3);
                for (x, y) in [(0, 1), (1, 2), (2, 0)] {
                    let wanted = (v[x] - v[y]) * PERIOD;
                    assert!((area[x] - area[y] - wanted).abs() < 1e-12, "{modulation:?}, period {k}");
                }
            }
        }
    }

    #[test]
    fn gates_modulation_and_duty_tell_the_same() {
        let mut bench = bench(PwmGenerator { modulation: Modulation::Sine, ..PWM });
        let y = bench.set(V, &[140.0, -280.0, 280.0]).set(VDC, &[560.0]).major();
        assert_eq!(y, [0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.5, -1.0, 1.0, 0.75, 0.0, 1.0]);
        assert_eq!(bench.next_event(), 0.125 * PERIOD);
        bench.t = 0.125 * PERIOD;
        assert_eq!(bench.major()[..6], [1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_new_reference_waits_for_the_next_sample() {
        for (sampling, half) in [(Sampling::Symmetric, 2.0), (Sampling::Asymmetric, 1.0)] {
            let mut bench = bench(PwmGenerator { sampling, ..PWM });
            let before = bench.set(VDC, &[560.0]).major();
            bench.t = 0.1 * PERIOD;
            assert_eq!(bench.set(V, &[200.0, -100.0, -100.0]).major()[6..], before[6..]);
            bench.t = half / 1e4;
            assert_ne!(bench.major()[6..], before[6..]);
        }
    }

    #[test]
    fn between_major_steps_gates_are_held_and_natural_duties_move() {
        let mut bench =
            bench(PwmGenerator { sampling: Sampling::Natural, modulation: Modulation::Sine, ..PWM });
        bench.t = 0.2 * PERIOD;
        let y = bench.set(V, &[0.0; 3]).set(VDC, &[560.0]).major();
        assert_eq!(y[..6], [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
        // Duty 1/2, carrier 1 - 0.4.
        assert!(bench.guards()[..3].iter().all(|g| (g + 0.1).abs() < 1e-12));
        let y = bench.set(V, &[140.0, 0.0, -140.0]).minor();
        assert_eq!((&y[..6], &y[9..]), (&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0][..], &[0.75, 0.5, 0.25][..]));
        assert!(bench.guards()[0] > 0.0);
        assert_eq!(bench.major()[..2], [1.0, 0.0]);
        assert_eq!(bench.next_event(), 0.5 * PERIOD);
    }

    #[test]
    fn overmodulation_cuts_off_and_ends_in_six_steps() {
        let mut pulses = 0;
        let mut last = None;
        let mut bench = bench(PWM);
        // Far beyond the limit each leg is high for half of a turn: six changes in 20 ms.
        walk(
            &mut bench,
            0.02,
            |t| phases(1e6, TAU * 50.0 * t + 0.013),
            |_, _, y| {
                let gates: Vec<f64> = y[..6].to_vec();
                pulses += i32::from(last.as_ref().is_some_and(|last| *last != gates));
                last = Some(gates);
                assert!(y[9..].iter().all(|d| *d == 0.0 || *d == 1.0));
            },
        );
        assert_eq!(pulses, 6);
    }

    #[test]
    fn guards_belong_to_natural_sampling_alone() {
        assert!(bench(PWM).interface.guards.is_empty());
        let natural = bench(PwmGenerator { sampling: Sampling::Natural, ..PWM });
        let names: Vec<&str> = natural.interface.guards.iter().map(|guard| guard.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "c", "link"]);
        let resting =
            PwmGenerator { sampling: Sampling::Natural, modulation: Modulation::Discontinuous60, ..PWM };
        assert_eq!(bench(resting).interface.guards[4].name, "low_leads");
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        for frequency in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            let error = PwmGenerator { switching_frequency: frequency, ..PWM }.errors()[0].clone();
            assert_eq!(error.param, "switching_frequency");
        }
        for dead_time in [-1e-6, 1e-4, f64::NAN] {
            let error = PwmGenerator { dead_time, ..PWM }.errors()[0].clone();
            assert_eq!(error.param, "dead_time");
        }
        assert!(PwmGenerator { dead_time: 0.9e-4, ..PWM }.errors().is_empty());
    }
}
