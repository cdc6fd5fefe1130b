use std::f64::consts::{FRAC_PI_6, SQRT_2, TAU};
use std::sync::OnceLock;

use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

use super::machine_per_unit::{PerUnit, turned};

/// Three-phase induction machine with a squirrel cage: fundamental wave, no saturation.
///
/// In per unit and in a frame that turns with the supply at the speed $w$, with the rotor at
/// $w_r = N (\omega_r - \omega_c)/w_b$:
///
/// $$ v_s = R_s i_s + \tfrac{1}{w_b}\dot\psi_s + j w \psi_s, \qquad
///    0 = R_r i_r + \tfrac{1}{w_b}\dot\psi_r + j (w - w_r)\psi_r $$
/// $$ \psi_s = L_s i_s + L_m i_r, \quad \psi_r = L_r i_r + L_m i_s, \qquad
///    T = \psi_{ds} i_{qs} - \psi_{qs} i_{ds}, \quad T_e = T\,S_n N / w_b $$
///
/// States are the fluxes of stator and rotor in per unit. The torque acts on `r` and its reaction on `c`; the
/// machine has no inertia and no damping of its own: add an `Inertia` and a `RotationalDamper` at `r`.
///
/// Windings in `Delta` see the voltage from line to line, windings in `Wye` that from line to star point: a
/// third of the torque at the same slip. No zero sequence can be driven through either of them (the star
/// point floats), so `x_0` has no influence.
///
/// A machine starts without flux, or magnetised: in the steady state of a given supply and slip, so that a
/// drive that holds a load starts without a transient. The inertia must be given the matching speed.
///
/// The outputs that begin with `pu_` are in per unit, their vectors in a frame that turns at the rated
/// frequency. `slip` refers to the frequency of the supply (0 when that is 0), `slip_rated` to the rated
/// frequency.
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
#[block(category = "Electrical")]
pub struct AsynchronousMachine {
    /// Rated apparent power; it only scales what is in per unit.
    #[block(unit = "W")]
    pub rated_power: f64,
    /// Rated voltage, RMS from line to line.
    #[block(unit = "V")]
    pub rated_voltage: f64,
    /// Rated frequency, at which the reactances are given.
    #[block(unit = "Hz")]
    pub rated_frequency: f64,
    /// Number of pole pairs $N$.
    pub pole_pairs: u32,
    /// Resistance of a stator winding.
    #[block(unit = "ohm")]
    pub r_s: f64,
    /// Leakage reactance of a stator winding.
    #[block(unit = "ohm")]
    pub x_ls: f64,
    /// Resistance of the rotor, referred to the stator.
    #[block(unit = "ohm")]
    pub r_r: f64,
    /// Leakage reactance of the rotor, referred to the stator.
    #[block(unit = "ohm")]
    pub x_lr: f64,
    /// Magnetising reactance.
    #[block(unit = "ohm")]
    pub x_m: f64,
    /// Zero-sequence reactance; without influence, see above.
    #[block(unit = "ohm", default = 0.0)]
    pub x_0: f64,
    /// `Delta` or `Wye`.
    #[block(default = Connection::Delta)]
    pub connection: Connection,
    /// `Zero` or `Magnetised(voltage: .., frequency: .., slip: ..)`.
    #[block(default = Start::Zero)]
    pub start: Start,
    /// Constants that follow from the parameters, worked out when they are first used.
    #[block(skip)]
    pub per_unit: OnceLock<PerUnit>,
}

/// How the windings are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Connection {
    /// Each winding lies between two lines.
    #[default]
    Delta,
    /// Each winding lies between a line and a common point that is connected to nothing else.
    Wye,
}

/// Fluxes at the start.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
pub enum Start {
    /// No flux.
    #[default]
    Zero,
    /// The steady state of a supply and a slip.
    Magnetised {
        /// RMS voltage from line to line, V.
        voltage: f64,
        /// Frequency of the supply, Hz; zero for direct current.
        frequency: f64,
        /// Slip against that frequency: 0 for no load, 1 for standstill.
        slip: f64,
    },
}

const TORQUE: usize = 0;
const I_RMS: usize = 1;
const SLIP: usize = 2;
const SLIP_RATED: usize = 3;
const POWER: usize = 4;
const PU_TORQUE: usize = 5;
const PU_VELOCITY: usize = 6;
const PU_V: usize = 7;
const PU_I: usize = 9;

impl AsynchronousMachine {
    /// Base values and constants.
    pub fn base(&self) -> &PerUnit {
        self.per_unit.get_or_init(|| PerUnit::of(self))
    }

    /// Winding voltage in per unit in the frame of the supply.
    #[inline]
    fn voltage(&self, c: &Law) -> [f64; 2] {
        c.supply.voltage.map(|v| self.base().voltage * v)
    }

    /// Fluxes at the start, in per unit.
    fn start_fluxes(&self) -> [f64; 4] {
        match self.start {
            Start::Zero => [0.0; 4],
            Start::Magnetised { voltage, frequency, slip } => {
                let phase = voltage * (2.0_f64 / 3.0).sqrt();
                let base = self.base();
                base.steady_state(base.voltage * phase, frequency / self.rated_frequency, slip)
            }
        }
    }
}

impl Block for AsynchronousMachine {
    fn check(&self) -> Result<(), ParamError> {
        positive("rated_power", self.rated_power)?;
        positive("rated_voltage", self.rated_voltage)?;
        positive("rated_frequency", self.rated_frequency)?;
        if self.pole_pairs == 0 {
            return Err(ParamError::new("pole_pairs", "`pole_pairs` is 0, but a machine has poles")
                .help("rated frequency times 60 over the synchronous speed in rpm"));
        }
        not_negative("r_s", self.r_s)?;
        not_negative("x_ls", self.x_ls)?;
        not_negative("r_r", self.r_r)?;
        not_negative("x_lr", self.x_lr)?;
        positive("x_m", self.x_m)?;
        not_negative("x_0", self.x_0)?;
        if self.x_ls + self.x_lr == 0.0 {
            return Err(ParamError::new(
                "x_ls",
                "`x_ls` and `x_lr` are both 0, so nothing limits the currents",
            )
            .help("give stator or rotor its leakage reactance"));
        }
        if let Start::Magnetised { voltage, frequency, slip } = self.start {
            not_negative("start", voltage)?;
            finite("start", frequency)?;
            finite("start", slip)?;
            if !self.start_fluxes().iter().all(|psi| psi.is_finite()) {
                return Err(ParamError::new(
                    "start",
                    "this supply and slip have no steady state: the current is not limited",
                )
                .help("give the windings their resistances, or write `start: Zero`"));
            }
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for AsynchronousMachine {
    fn part(&self, _given: &Given) -> Part {
        let psi = self.start_fluxes();
        let mut part = Part::new()
            .port("ac", Domain::ThreePhase, "the lines")
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(Element::Machine { ac: 0, ends: None })
            .element(Element::Branch { r: 1, c: 2 })
            .measures("torque", "N*m", Needs::State, "torque on the rotor")
            .measures("i_rms", "A", Needs::State, "RMS current of a winding")
            .measures("slip", "1", Needs::Electrics, "slip against the frequency of the supply")
            .measures("slip_rated", "1", Needs::State, "slip against the rated frequency")
            .measures("power", "W", Needs::Electrics, "power drawn from the lines")
            .measures("pu_torque", "1", Needs::State, "torque in per unit")
            .measures("pu_velocity", "1", Needs::State, "speed of the rotor in per unit")
            .measures("pu_vds", "1", Needs::Electrics, "stator voltage, direct axis, in per unit")
            .measures("pu_vqs", "1", Needs::Electrics, "stator voltage, quadrature axis, in per unit")
            .measures("pu_ids", "1", Needs::Electrics, "stator current, direct axis, in per unit")
            .measures("pu_iqs", "1", Needs::Electrics, "stator current, quadrature axis, in per unit");
        for (name, value) in ["psi_ds", "psi_qs", "psi_dr", "psi_qr"].into_iter().zip(psi) {
            part = part.state(name, value);
        }
        part
    }

    fn line_current(&self, c: &Law) -> [f64; 3] {
        let base = self.base();
        let [d, q] = base.stator_current(c.x).map(|i| base.line * i);
        [d, q, 0.0]
    }

    fn reluctance(&self, c: &Law, internal: &mut [f64], inverse: &mut [f64]) {
        let base = self.base();
        let w = TAU * c.supply.frequency / base.w_base;
        let (inner, per_flux) = base.reluctance(c.x, w, base.speed * c.speed[0]);
        internal.copy_from_slice(&[inner[0] / base.voltage, inner[1] / base.voltage, 0.0]);
        let of_lines = base.line * base.w_base * per_flux * base.voltage;
        inverse.copy_from_slice(&[of_lines, 0.0, 0.0, 0.0, of_lines, 0.0, 0.0, 0.0, 0.0]);
    }

    fn strike(&self, _c: &Law, volt_seconds: &[f64], x: &mut [f64]) {
        let base = self.base();
        x[0] += base.w_base * base.voltage * volt_seconds[0];
        x[1] += base.w_base * base.voltage * volt_seconds[1];
    }

    fn torques(&self, c: &Law, tau: &mut [Torque]) {
        let base = self.base();
        tau[0] = Torque { value: -base.t_base * base.torque(c.x), slope: 0.0 };
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        let base = self.base();
        let w = TAU * c.supply.frequency / base.w_base;
        base.derivatives(c.x, self.voltage(c), w, base.speed * c.speed[0], dx);
    }

    fn measure(&self, c: &Law, needs: Needs, y: &mut [f64]) {
        let base = self.base();
        let velocity = base.speed * c.speed[0];
        let i = base.stator_current(c.x);
        match needs {
            Needs::State => {
                y[PU_TORQUE] = base.torque(c.x);
                y[TORQUE] = base.t_base * y[PU_TORQUE];
                y[I_RMS] = base.i_base / SQRT_2 * i[0].hypot(i[1]);
                y[PU_VELOCITY] = velocity;
                y[SLIP_RATED] = 1.0 - velocity;
            }
            Needs::Electrics => {
                let v = self.voltage(c);
                let w = TAU * c.supply.frequency / base.w_base;
                y[SLIP] = if w == 0.0 { 0.0 } else { 1.0 - velocity / w };
                y[POWER] = self.rated_power * (v[0] * i[0] + v[1] * i[1]);
                // The voltage of a winding in delta leads that of the phase by 30 degrees.
                let lead = match self.connection {
                    Connection::Delta => FRAC_PI_6,
                    Connection::Wye => 0.0,
                };
                let angle = c.supply.angle + lead - base.w_base * c.t;
                y[PU_V..PU_V + 2].copy_from_slice(&turned(v, angle));
                y[PU_I..PU_I + 2].copy_from_slice(&turned(i, angle));
            }
            Needs::Motion => {}
        }
    }
}

#[cfg(test)]
#[path = "asynchronous_machine_tests.rs"]
mod tests;
