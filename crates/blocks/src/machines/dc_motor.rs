use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

use super::warm_winding::WarmWinding;

/// Brushed motor with permanent magnets.
///
/// $$ v = R i + L \frac{di}{dt} + k w, \qquad \tau = k i, \qquad w = w_r - w_c $$
///
/// The conversion is lossless, so one constant $k$ (V*s/rad or N*m/A) serves voltage and torque. The rotor
/// has the inertia $j$, against an implied ground, and a damping between rotor and housing. In the steady
/// state $\tau = k (V - k w)/R$ less the damping.
///
/// With `heat_port: true` the heat of winding and damping leaves by the thermal port `h`, and the resistance follows the
/// temperature there,
///
/// $$ R = r\,(1 + \alpha\,(T - T_\mathrm{ref})) $$
///
/// With `rotor_heat_port: true` the heat of the damping leaves by a port of its own, `h_r`. Connect a `HeatCapacity` to each port. A
/// winding that becomes hotter than `t_max` is reported as an event: at a constant current, $\alpha > 0$ makes more heat the hotter it
/// is, and beyond $\alpha\,r\,i^2 R_\mathrm{th} = 1$ no cooling through a thermal resistance $R_\mathrm{th}$ holds it. At 10 000 K the run
/// ends with an error.
///
/// With $L > 0$ the current is a state; with $L = 0$ it follows at once from voltage and speed, $i = (v - k
/// w)/R$.
///
/// ```ron
/// DcMotor(r: "1.5 ohm", l: "2.5 mH", k: "0.22 N*m/A", j: "5e-5 kg*m^2")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M"))]
pub struct DcMotor {
    /// Resistance of the winding; may be zero unless the inductance is.
    #[block(unit = "ohm", not_negative)]
    pub r: f64,
    /// Inductance of the winding; may be zero unless the resistance is.
    #[block(unit = "H", not_negative)]
    pub l: f64,
    /// Torque constant and, with the same number, back-EMF constant.
    #[block(unit = "N*m/A", finite)]
    pub k: f64,
    /// Moment of inertia of the rotor; zero is allowed where something else gives the shaft its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Damping of the rotor.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Current at the start; only with an inductance.
    #[block(unit = "A", finite, default = 0.0)]
    pub i0: f64,
    /// Heat of the motor.
    #[block(group)]
    pub warm: WarmWinding,
}

impl DcMotor {
    /// Current from `p` to `n`, A.
    fn current(&self, c: &Flowing) -> f64 {
        if self.l > 0.0 { c.x[0] } else { (c.voltage[0] - self.k * c.speed[0]) / self.resistance(c) }
    }

    /// Resistance of the winding, ohm.
    fn resistance(&self, c: &Flowing) -> f64 {
        self.warm.resistance(self.r, c)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.l == 0.0 && self.r == 0.0 {
            let error = ParamError::new("r", "`r` and `l` are both 0, so nothing limits the current");
            errors.add(error.beside(&["l"]).help("give the winding its resistance"));
        }
        no_start_without_inductance(self.l, self.i0, errors);
    }
}

/// Reports a current at the start that is no state.
pub(super) fn no_start_without_inductance(l: f64, i0: f64, errors: &mut ParamErrors) {
    if l == 0.0 && i0 != 0.0 {
        let error = ParamError::new("i0", "without inductance the current has no start value of its own");
        errors.add(error.beside(&["l"]).help("leave `i0` out, or give the winding its inductance `l`"));
    }
}

impl Component for DcMotor {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .pins()
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: self.l > 0.0 })
            .element(Element::Branch { r: 2, c: 3 })
            .element(Element::Inertia { port: 2, inertia: self.j, speed: None });
        let part = self.warm.part(part);
        if self.l > 0.0 {
            part.linear().state_in("i", self.i0, "A").current_is(Gives::State(0)).reads(
                "i",
                "A",
                Reading::State(0),
                "current from p to n",
            )
        } else {
            part.measures("i", "A", Needs::Electrics, "current from p to n")
        }
    }

    fn currents_by_voltages(&self, c: &Flowing, i: &mut [f64]) {
        i[0] = self.current(c);
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        internal[0] = self.resistance(c) * c.x[0] + self.k * c.speed[0];
        inverse[0] = 1.0 / self.l;
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x[0] += volt_seconds[0] / self.l;
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        // Without inductance the back EMF damps as k^2/R does.
        let braking = if self.l > 0.0 { 0.0 } else { self.k * self.k / self.resistance(c) };
        tau[0] = Torque {
            value: self.damping * c.speed[0] - self.k * self.current(c),
            slope: self.damping + braking,
        };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        if self.l > 0.0 {
            dx[0] = (c.voltage[0] - self.resistance(c) * c.x[0] - self.k * c.speed[0]) / self.l;
        }
    }

    fn linearize(&self, law: &Flowing, a: &mut [f64], b: &mut [f64], c: &mut [f64]) {
        (a[0], b[0], c[0]) = (-self.resistance(law) / self.l, -self.k / self.l, -self.k);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (i, w) = (self.current(c), c.speed[0]);
        Energy {
            stored: 0.5 * self.l * i * i,
            dissipated: self.resistance(c) * i * i + self.damping * w * w,
            ..Energy::default()
        }
    }

    fn heats(&self, c: &Flowing, dissipated: f64, q: &mut [f64]) {
        let i = self.current(c);
        self.warm.heats(self.resistance(c) * i * i, dissipated, q);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        self.warm.guards(c, g);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[0] = self.current(c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const MOTOR: DcMotor =
        DcMotor { r: 1.5, l: 2.5e-3, k: 0.2, j: 5e-5, damping: 0.01, i0: 3.0, warm: WarmWinding::NONE };

    #[test]
    fn with_inductance_the_current_is_a_state() {
        let c = Seen { x: &[4.0], voltage: &[48.0], speed: &[100.0], ..law() }.loaded();
        let (mut tau, mut dx) = ([Torque::default()], [0.0]);
        MOTOR.torques(&c, &mut tau);
        Component::derivatives(&MOTOR, &c, &mut dx);
        assert!((tau[0].value - (1.0 - 0.8)).abs() < 1e-15);
        assert!((dx[0] - (48.0 - 6.0 - 20.0) / 2.5e-3).abs() < 1e-9);
        assert_eq!(MOTOR.part(&Given::nothing()).outputs[0].1, Needs::State);
    }

    #[test]
    fn without_inductance_the_current_follows_from_voltage_and_speed() {
        let motor = DcMotor { l: 0.0, i0: 0.0, ..MOTOR };
        let c = Seen { voltage: &[48.0], speed: &[90.0], ..law() }.loaded();
        let (mut tau, mut i) = ([Torque::default()], [0.0]);
        motor.currents_by_voltages(&c, &mut i);
        motor.torques(&c, &mut tau);
        assert!((i[0] - 20.0).abs() < 1e-13);
        assert!((tau[0].value - (0.9 - 4.0)).abs() < 1e-13);
        assert!((tau[0].slope - (0.01 + 0.04 / 1.5)).abs() < 1e-15);
        assert_eq!(motor.part(&Given::nothing()).outputs[0].1, Needs::Electrics);
    }

    #[test]
    fn a_warm_winding_has_more_resistance_and_its_heat_leaves_apart_from_that_of_the_rotor() {
        let warm = WarmWinding { heat_port: true, rotor_heat_port: true, alpha: 4e-3, ..WarmWinding::NONE };
        let motor = DcMotor { warm, ..MOTOR };
        assert_eq!(motor.errors()[..], []);
        let places = crate::electrical::testing::places(&motor);
        // Winding, then the temperatures of both ports: 50 K above the reference.
        let voltage = [48.0, 343.15, 300.0];
        let c = Seen { x: &[4.0], voltage: &voltage, speed: &[100.0], places: &places, ..law() }.loaded();
        let mut dx = [0.0];
        Component::derivatives(&motor, &c, &mut dx);
        assert!((dx[0] - (48.0 - 1.8 * 4.0 - 20.0) / 2.5e-3).abs() < 1e-9);
        let (dissipated, mut q) = (motor.energy(&c).dissipated, [0.0; 2]);
        motor.heats(&c, dissipated, &mut q);
        assert!((q[0] - 1.8 * 16.0).abs() < 1e-12 && (q[1] - 100.0).abs() < 1e-12, "{q:?}");
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        assert_eq!(DcMotor { r: 0.0, l: 0.0, ..MOTOR }.errors()[0].param, "r");
        assert_eq!(DcMotor { l: 0.0, ..MOTOR }.errors()[0].param, "i0");
        assert_eq!(DcMotor { j: -1.0, ..MOTOR }.errors()[0].param, "j");
        assert_eq!(MOTOR.errors()[..], []);
    }
}
