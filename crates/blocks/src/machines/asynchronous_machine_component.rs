//! An induction machine as part of a network, whatever its parameters came from.

use std::f64::consts::{FRAC_PI_6, SQRT_2, TAU};

use blocksim_block::physical::{Domain, Element, Field};
use blocksim_block::prelude::*;

use super::asynchronous_machine_outputs as out;
use super::asynchronous_machine_parameters::{Connection, Start};
use super::induction::{Base, Circuit, Complex, Machine};
use super::space_vector::turned;

/// Speeds of the flux, in per unit, below which a slip against it says nothing.
const STANDSTILL: f64 = 1e-6;

/// Everything that does not change while a machine runs.
#[derive(Debug, Clone)]
pub struct Motor {
    base: Base,
    machine: Machine,
    /// Rated apparent power, V*A.
    power: f64,
    connection: Connection,
    /// Winding voltage in per unit for a voltage of 1 V at the terminals.
    voltage: f64,
    /// Current in the lines, A, for a winding current of 1 in per unit.
    line: f64,
    /// Fluxes at the start.
    start: Vec<f64>,
    /// They belong to a voltage along the axis of phase a.
    turns: bool,
    /// It has a port for heat.
    heat_port: bool,
}

/// Whether a machine of this connection can have a current of the zero sequence.
pub(super) fn has_zero_sequence(connection: Connection, start: &Start) -> bool {
    let circulating = matches!(start, Start::Explicit { psi_0s, .. } if *psi_0s != 0.0);
    connection == Connection::Open || (connection == Connection::Delta && circulating)
}

impl Motor {
    /// From base values, the rated apparent power (V*A), a circuit, and the rated frequency (Hz). Reported are a circuit without
    /// meaning, and a start that no supply can bring about.
    pub(super) fn new(
        (base, power): (Base, f64),
        circuit: Circuit,
        connection: Connection,
        start: &Start,
        errors: &mut ParamErrors,
    ) -> Option<Self> {
        circuit.validate(errors);
        if !errors.is_empty() {
            return None;
        }
        // In delta a winding lies between two lines: its voltage is larger than that of a phase, and a line feeds two.
        let delta = match connection {
            Connection::Delta => 3.0_f64.sqrt(),
            Connection::Wye | Connection::Open => 1.0,
        };
        let (voltage, line) = (delta / base.v, delta * base.i);
        let machine = Machine::new(circuit, base.w);
        let mut motor = Self {
            base,
            machine,
            power,
            connection,
            voltage,
            line,
            start: Vec::new(),
            turns: false,
            heat_port: false,
        };
        motor.turns = matches!(start, Start::Magnetised { .. });
        motor.start = motor.fluxes(start, errors)?;
        Some(motor)
    }

    /// The same with a port for heat, if that is wanted.
    pub(super) fn with_heat_port(self, heat_port: bool) -> Self {
        Self { heat_port, ..self }
    }

    fn fluxes(&self, start: &Start, errors: &mut ParamErrors) -> Option<Vec<f64>> {
        let machine = &self.machine;
        match *start {
            Start::Zero => Some(vec![0.0; machine.states()]),
            Start::Magnetised { voltage, frequency, slip } => {
                let peak = SQRT_2 * voltage;
                let at_terminals =
                    if self.connection == Connection::Open { peak } else { peak / 3.0_f64.sqrt() };
                let w = TAU * frequency / self.base.w;
                let psi = machine.steady_fluxes(self.voltage * at_terminals, w, slip * w);
                if psi.iter().all(|psi| psi.is_finite()) {
                    return Some(psi);
                }
                let message = "this supply and slip have no steady state: the current is not limited";
                let help = "give the windings their resistances, or write `start: Zero`";
                errors.add(ParamError::new("start", message).help(help));
                None
            }
            Start::Explicit { psi_s, psi_r, psi_r2, psi_0s } => {
                let mut psi = [psi_s, psi_r, psi_r2].concat();
                if machine.circuit().cages.count() == 1 && psi_r2 != [0.0; 2] {
                    let message = "`psi_r2` is the flux of a second cage, but there is one cage";
                    let error = ParamError::new("start.psi_r2", message);
                    errors.add(error.help("leave it out, or write `cage: Double(..)`"));
                }
                psi.truncate(2 * (1 + machine.circuit().cages.count()));
                if machine.circuit().l_0.is_some() {
                    psi.push(psi_0s);
                } else if psi_0s != 0.0 {
                    let message = "`psi_0s` is not 0, but no current of the zero sequence can flow";
                    errors.add(ParamError::new("start.psi_0s", message).help("leave it out"));
                }
                errors.is_empty().then_some(psi)
            }
        }
    }

    /// Winding voltage in per unit in the frame of the supply, and its zero sequence.
    #[inline]
    fn winding_voltage(&self, c: &Flowing) -> (Complex, f64) {
        let v = Complex::from_vector(c.supply.voltage.map(|v| self.voltage * v));
        let zero = if self.connection == Connection::Open { c.supply.zero / self.base.v } else { 0.0 };
        (v, zero)
    }

    /// Speed of the frame of the supply and of the rotor in per unit.
    #[inline]
    fn speeds(&self, c: &Fed) -> (f64, f64) {
        (TAU * c.supply.frequency / self.base.w, self.base.speed * c.speed[0])
    }

    /// Speed of the supply in per unit, where its frequency is known.
    fn supply_speed(&self, c: &Fed) -> Option<f64> {
        let (w, _) = self.speeds(c);
        let turning = |frequency: f64| TAU * frequency / self.base.w;
        match c.supply.field {
            _ if w != 0.0 => Some(w),
            Field::Turns(frequency) if frequency != 0.0 => Some(turning(frequency)),
            Field::Either(frequency) if frequency != 0.0 => {
                Some(turning(frequency.abs()).copysign(self.stator_flux_turn(c)))
            }
            _ => None,
        }
    }

    fn stator_flux_turn(&self, c: &Fed) -> f64 {
        let v = Complex::from_vector(c.supply.voltage.map(|v| self.voltage * v));
        self.machine.stator_flux_turn(c.x, v)
    }

    /// Whether the field turns backward. Where nothing is known of the supply the flux of the stator shows it, from the first instant of a
    /// start: that of the rotor follows late.
    fn turns_backward(&self, c: &Fed) -> bool {
        self.supply_speed(c).unwrap_or_else(|| self.stator_flux_turn(c)) < 0.0
    }

    /// Slip against the supply, else against the flux of the rotor: voltages that are switched turn in jumps.
    fn slip(&self, c: &Fed) -> f64 {
        let (_, w_r) = self.speeds(c);
        let w = self.supply_speed(c).unwrap_or_else(|| self.machine.rotor_flux_speed(c.x, w_r));
        if w.abs() < STANDSTILL { 0.0 } else { 1.0 - w_r / w }
    }
}

/// Mean over the three windings of the square of what has this space vector (peak) and zero sequence.
fn mean_square(vector: Complex, zero: f64) -> f64 {
    0.5 * vector.dot(vector) + zero * zero
}

impl Component for Motor {
    fn part(&self, _given: &Given) -> Part {
        let open = self.connection == Connection::Open;
        let lines = if open { "starts of the windings" } else { "the lines" };
        let mut part = Part::new()
            .port(if open { "ac1" } else { "ac" }, Domain::ThreePhase, lines)
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing");
        if open {
            part = part.port("ac2", Domain::ThreePhase, "ends of the windings");
        }
        part = part
            .element(Element::Machine { ac: 0, ends: open.then_some(3) })
            .element(Element::Branch { r: 1, c: 2 });
        for (name, value) in self.machine.names().into_iter().zip(&self.start) {
            // Fluxes are in per unit.
            part = part.nominal_state(name, *value, 1.0);
        }
        out::measured(part).heat_port(self.heat_port)
    }

    fn line_current(&self, c: &Fed) -> [f64; 3] {
        let [d, q] = self.machine.currents(c.x)[0].vector();
        let zero = if self.connection == Connection::Open { self.machine.zero_current(c.x) } else { 0.0 };
        [d, q, zero].map(|i| self.line * i)
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        let (w, w_r) = self.speeds(c);
        let found = self.machine.reluctance(c.x, w, w_r);
        let [d, q] = found.internal;
        let [[dd, dq], [qd, qq]] = found.inverse;
        // Where no current of the zero sequence flows, its voltage is that which leaves it so: none.
        let (zero_internal, zero) = match self.machine.circuit().l_0 {
            Some(_) => (found.zero_internal, found.zero_inverse),
            None => (0.0, 0.5 * (dd + qq)),
        };
        let to_lines = self.line * self.voltage;
        internal.copy_from_slice(&[d, q, zero_internal].map(|v| v / self.voltage));
        inverse.copy_from_slice(&[dd, dq, 0.0, qd, qq, 0.0, 0.0, 0.0, zero].map(|g| to_lines * g));
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        let flux = self.base.w * self.voltage;
        x[0] += flux * volt_seconds[0];
        x[1] += flux * volt_seconds[1];
        if let (Some(zero), Connection::Open) = (x.get_mut(self.machine.states() - 1), self.connection)
            && self.machine.circuit().l_0.is_some()
        {
            *zero += flux * volt_seconds[2];
        }
    }

    fn turn(&self, angle: f64, x: &mut [f64]) {
        if self.turns {
            let fluxes = 2 * (1 + self.machine.circuit().cages.count());
            for flux in x[..fluxes].chunks_exact_mut(2) {
                flux.copy_from_slice(&turned([flux[0], flux[1]], angle));
            }
        }
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = Torque { value: -self.base.t * self.machine.torque(c.x), slope: 0.0 };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let ((v, v_0), (w, w_r)) = (self.winding_voltage(c), self.speeds(c));
        self.machine.derivatives(c.x, v, v_0, w, w_r, dx);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (field, heat) = self.machine.energy(c.x);
        Energy {
            stored: self.power / self.base.w * field,
            dissipated: self.power * heat,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let base = &self.base;
        let i = self.machine.currents(c.x)[0];
        let velocity = base.speed * c.speed[0];
        y[out::PU_TORQUE] = self.machine.torque(c.x);
        y[out::TORQUE] = base.t * y[out::PU_TORQUE];
        y[out::VELOCITY] = c.speed[0];
        y[out::PU_VELOCITY] = velocity;
        y[out::SLIP_RATED] = 1.0 - velocity;
        y[out::PU_CURRENT] = i.abs();
        y[out::I_RMS] = base.i * mean_square(i, self.machine.zero_current(c.x)).sqrt();
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let base = &self.base;
        let i = self.machine.currents(c.x)[0];
        let ((v, v_0), i_0) = (self.winding_voltage(c), self.machine.zero_current(c.x));
        y[out::SLIP] = self.slip(c);
        let p = v.dot(i) + 2.0 * v_0 * i_0;
        // What magnetises a winding is positive, whichever way the field turns.
        let q = -v.cross(i) * if self.turns_backward(c) { -1.0 } else { 1.0 };
        let s = 2.0 * (mean_square(v, v_0) * mean_square(i, i_0)).sqrt();
        let powers = [out::PU_POWER, out::PU_REACTIVE_POWER, out::PU_APPARENT_POWER];
        let in_watts = [out::POWER, out::REACTIVE_POWER, out::APPARENT_POWER];
        for ((value, pu), si) in [p, q, s].into_iter().zip(powers).zip(in_watts) {
            y[pu] = value;
            y[si] = self.power * value;
        }
        y[out::POWER_FACTOR] = if s == 0.0 { 0.0 } else { p / s };
        y[out::PU_VOLTAGE] = v.abs();
        y[out::V_RMS] = base.v * mean_square(v, v_0).sqrt();
        // The voltage of a winding in delta leads that of the phase by 30 degrees.
        let lead = if self.connection == Connection::Delta { FRAC_PI_6 } else { 0.0 };
        let angle = c.supply.angle + lead - base.w * c.t;
        let turned = |z: Complex, zero: f64| {
            let [d, q] = z.turned(angle).vector();
            [d, q, zero]
        };
        let places =
            [(out::PU_V, out::V, base.v, turned(v, v_0)), (out::PU_I, out::I, base.i, turned(i, i_0))];
        for (pu, si, unit, values) in places {
            y[pu..pu + 3].copy_from_slice(&values);
            y[si..si + 3].copy_from_slice(&values.map(|value| unit * value));
        }
    }
}
