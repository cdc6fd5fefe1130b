use std::f64::consts::SQRT_2;

use blocksim_block::prelude::*;

use super::asynchronous_machine_component::{Motor, has_zero_sequence};
use super::asynchronous_machine_parameters::{
    Cage, Connection, Impedance, Impedances, Saturation, Start, ZeroSequence,
};
use super::induction::{Base, Cages, Circuit, Magnetisation};

/// Three-phase induction machine with a squirrel cage: fundamental wave, one or two cages, with or without saturation of
/// the main flux.
///
/// In per unit and in a frame that turns at the speed $w$, with the rotor at
/// $w_r = N (\omega_r - \omega_c)/w_b$, stator $s$ and cages $k$:
///
/// $$ v_s = R_s i_s + \tfrac{1}{w_b}\dot\psi_s + j w \psi_s, \qquad
///    0 = R_k i_k + \tfrac{1}{w_b}\dot\psi_k + j (w - w_r)\psi_k $$
/// $$ \psi_s = L_{ls} i_s + \psi_m, \quad \psi_k = L_{lk} i_k + \psi_m, \quad \psi_m = L_m(|i_m|) i_m, \quad
///    i_m = i_s + \textstyle\sum i_k, \qquad T = \psi_{ds} i_{qs} - \psi_{qs} i_{ds}, \quad T_e = T\,S_n N / w_b $$
///
/// States are the fluxes in per unit, in the frame of an ideal source that feeds the machine directly, otherwise in a
/// frame that stands still. The torque acts on `r` and its reaction on `c`; the machine has no inertia and no damping of
/// its own: add an `Inertia` and a `RotationalDamper` at `r`.
///
/// Windings in `Delta` see the voltage from line to line, windings in `Wye` that from line to a star point that floats: a
/// third of the torque at the same slip. `Open` windings have their starts at `ac1` and their ends at `ac2`, for
/// connections that are made outside or change while the machine runs.
///
/// With `impedances: PerUnit` resistances and reactances are in units of $3 V_n^2/S_n$, the base of a machine in delta,
/// whatever the connection.
///
/// `cage: Double(r_r2: .., x_lr2: ..)` adds a second cage to `r_r` and `x_lr`; `x_lr12` is the leakage that both have in
/// common, as bars below each other in one slot. `saturation: Table(current: [..], voltage: [..])` is the curve of the
/// machine turning without load at rated frequency, beginning with 0, 0: RMS values of a winding in A and V, or in per
/// unit without units. It takes the place of `x_m`, is straight between its points, and goes on along its last line.
///
/// A current of the zero sequence can flow in `Open` windings, and circulate in `Delta` when the start has one: it
/// follows from `x_0`. With `zero_sequence: Exclude` it is zero, whatever voltage the connection forces.
///
/// A machine starts without flux; or `Magnetised`, in the steady state of a given supply and slip, so that a drive that
/// holds a load starts without a transient (the inertia must be given the matching speed); or with `Explicit` fluxes.
///
/// Values of the stator are those of its windings; vectors `ds`, `qs`, `0s` are peak values in a frame that turns at
/// the rated frequency. Outputs that begin with `pu_` are in per unit. `slip` refers to the frequency of an ideal source
/// that feeds the machine directly, otherwise to the speed at which the flux of the rotor turns, and is 0 where that
/// stands still; `slip_rated` refers to the rated frequency.
///
/// ```ron
/// AsynchronousMachine(
///     rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
///     r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
/// )
/// ```
///
/// Source: P. C. Krause, O. Wasynczuk, S. D. Sudhoff, *Analysis of Electric Machinery* (2002), chapter 4.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M 3~"), builds = Motor)]
pub struct AsynchronousMachine {
    /// Rated apparent power; it only scales what is in per unit.
    #[block(unit = "W", positive)]
    pub rated_power: f64,
    /// Rated voltage, RMS from line to line.
    #[block(unit = "V", positive)]
    pub rated_voltage: f64,
    /// Rated frequency, at which the reactances are given.
    #[block(unit = "Hz", positive)]
    pub rated_frequency: f64,
    /// Number of pole pairs $N$.
    #[block(at_least = 1, zero = "rated frequency times 60 over the synchronous speed in rpm")]
    pub pole_pairs: u32,
    /// Resistance of a stator winding.
    #[block(unit = "ohm", not_negative)]
    pub r_s: Impedance,
    /// Leakage reactance of a stator winding.
    #[block(unit = "ohm", not_negative)]
    pub x_ls: Impedance,
    /// Resistance of the rotor, referred to the stator.
    #[block(unit = "ohm", not_negative)]
    pub r_r: Impedance,
    /// Leakage reactance of the rotor, referred to the stator.
    #[block(unit = "ohm", not_negative)]
    pub x_lr: Impedance,
    /// Magnetising reactance; needed without a table of saturation.
    #[block(unit = "ohm", positive, default = None)]
    pub x_m: Option<Impedance>,
    /// Zero-sequence reactance; needed where a current of the zero sequence can flow, see above.
    #[block(unit = "ohm", not_negative, default = None)]
    pub x_0: Option<Impedance>,
    /// `Ohm` or `PerUnit`.
    #[block(default = Impedances::Ohm)]
    pub impedances: Impedances,
    /// `Single` or `Double(r_r2: .., x_lr2: .., x_lr12: ..)`.
    #[block(default = Cage::Single)]
    pub cage: Cage,
    /// `None` or `Table(current: [..], voltage: [..])`.
    #[block(default = Saturation::None)]
    pub saturation: Saturation,
    /// `Include` or `Exclude`.
    #[block(default = ZeroSequence::Include)]
    pub zero_sequence: ZeroSequence,
    /// `Delta`, `Wye` or `Open`.
    #[block(default = Connection::Delta)]
    pub connection: Connection,
    /// `Zero`, `Magnetised(voltage: .., frequency: .., slip: ..)` or `Explicit(psi_s: [..], psi_r: [..])`.
    #[block(default = Start::Zero)]
    pub start: Start,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl AsynchronousMachine {
    fn base(&self) -> Base {
        Base::of(self.rated_power, self.rated_voltage, self.rated_frequency, self.pole_pairs)
    }

    /// Whether a current of the zero sequence can flow.
    fn has_zero_sequence(&self) -> bool {
        self.zero_sequence == ZeroSequence::Include && has_zero_sequence(self.connection, &self.start)
    }

    /// The equivalent circuit in per unit.
    ///
    /// # Errors
    /// A curve without meaning.
    pub fn circuit(&self) -> Result<Circuit, ParamError> {
        let base = self.base();
        let scaled = |value: Impedance| value.per_unit(self.impedances, base.z);
        let l_ls = scaled(self.x_ls);
        let (current, voltage) = (base.i / SQRT_2, self.rated_voltage);
        let curve = self.saturation.curve(current, voltage, l_ls)?;
        // Without a curve there is an `x_m`.
        let magnetisation = curve.unwrap_or_else(|| Magnetisation::linear(self.x_m.map_or(f64::NAN, scaled)));
        let (r, l) = (scaled(self.r_r), scaled(self.x_lr));
        let cages = match self.cage {
            Cage::Single => Cages::Single { r, l },
            Cage::Double { r_r2, x_lr2, x_lr12 } => {
                Cages::Double { r: [r, scaled(r_r2)], l: [l, scaled(x_lr2)], common: scaled(x_lr12) }
            }
        };
        let l_0 = self.x_0.filter(|_| self.has_zero_sequence()).map(scaled);
        Ok(Circuit { r_s: scaled(self.r_s), l_ls, magnetisation, cages, l_0 })
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let given = [("r_s", self.r_s), ("x_ls", self.x_ls), ("r_r", self.r_r), ("x_lr", self.x_lr)];
        let optional = [("x_m", self.x_m), ("x_0", self.x_0)];
        let optional = optional.into_iter().filter_map(|(name, value)| Some((name, value?)));
        for (name, value) in given.into_iter().chain(optional).chain(self.cage.impedances()) {
            errors.take(value.fits(name, self.impedances));
        }
        if self.x_m.is_none() && self.saturation == Saturation::None {
            errors.add(
                ParamError::new("x_m", "`x_m` is missing")
                    .help("give the magnetising reactance, or a `saturation: Table(..)`"),
            );
        }
        if self.x_0.is_none() && self.has_zero_sequence() {
            let message = "`x_0` is missing, but a current of the zero sequence can flow";
            let help = "give the reactance, about that of the leakage, or write `zero_sequence: Exclude`";
            errors.add(ParamError::new("x_0", message).help(help));
        }
        self.start.validate(errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Motor> {
        let circuit = errors.take(self.circuit())?;
        let motor =
            Motor::new((self.base(), self.rated_power), circuit, self.connection, &self.start, errors)?;
        Some(motor.with_heat_port(self.heat_port))
    }
}

#[cfg(test)]
#[path = "asynchronous_machine_tests.rs"]
mod tests;
