use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Brushed motor whose field winding lies in series with the armature, for direct and alternating voltage.
///
/// $$ v = R i + L \frac{di}{dt} + L_{af}\, i\, w, \qquad \tau = L_{af}\, i^2 $$
///
/// $R$ and $L$ are those of field and armature together. The torque goes with the square of the current: it
/// does not change sign when the voltage does. So the motor runs on alternating voltage, with a torque that
/// pulsates at twice the frequency, and **cannot be reversed by its voltage**; a drive that needs both
/// directions wants a `DcMotor`. On direct voltage the steady state is
///
/// $$ i = \frac{V}{R + L_{af} w}, \qquad \tau = L_{af} \Bigl(\frac{V}{R + L_{af} w}\Bigr)^2 $$
///
/// Without load nothing but the damping holds the speed. Turned backwards faster than $R/L_{af}$ the motor
/// excites itself: the current grows without a source.
///
/// From a rating with direct voltage $V$, electrical power $P_e$, power of the shaft $P$ and speed $w$, without
/// damping: $i = P_e/V$, $L_{af} = P/(w i^2)$, $R = V/i - L_{af} w$.
///
/// The rotor has the inertia $j$, against an implied ground, and a damping between rotor and housing; no
/// saturation.
///
/// ```ron
/// UniversalMotor(r: "4 ohm", l: "20 mH", l_af: "0.12 H", j: "1e-4 kg*m^2")
/// ```
///
/// Source: P. C. Krause, O. Wasynczuk, S. D. Sudhoff, *Analysis of Electric Machinery* (2002), chapter 2.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M ~"))]
pub struct UniversalMotor {
    /// Resistance of field and armature together.
    #[block(unit = "ohm", not_negative)]
    pub r: f64,
    /// Inductance of field and armature together, positive.
    #[block(unit = "H", positive, remedy = "the time constant l / r of both windings is some milliseconds")]
    pub l: f64,
    /// Mutual inductance of field and armature: torque over the square of the current.
    #[block(unit = "H", finite)]
    pub l_af: f64,
    /// Moment of inertia of the rotor; zero is allowed where something else gives the shaft its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Damping of the rotor.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Current at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i0: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for UniversalMotor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: true })
            .current_is(Gives::State(0))
            .element(Element::Branch { r: 2, c: 3 })
            .element(Element::Inertia { port: 2, inertia: self.j, speed: None })
            .state_in("i", self.i0, "A")
            .measures("i", "A", Needs::State, "current from p to n")
            .measures("torque", "N*m", Needs::State, "torque of the armature, before the damping")
            .heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let value = self.damping * c.speed[0] - self.l_af * c.x[0] * c.x[0];
        tau[0] = Torque { value, slope: self.damping };
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        internal[0] = (self.r + self.l_af * c.speed[0]) * c.x[0];
        inverse[0] = 1.0 / self.l;
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x[0] += volt_seconds[0] / self.l;
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = (c.voltage[0] - self.r * c.x[0] - self.l_af * c.x[0] * c.speed[0]) / self.l;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (i, w) = (c.x[0], c.speed[0]);
        Energy {
            stored: 0.5 * self.l * i * i,
            dissipated: self.r * i * i + self.damping * w * w,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[c.x[0], self.l_af * c.x[0] * c.x[0]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const MOTOR: UniversalMotor =
        UniversalMotor { r: 4.0, l: 0.02, l_af: 0.12, j: 1e-4, damping: 1e-4, i0: 0.0, heat_port: false };

    #[test]
    fn the_torque_is_the_same_for_both_directions_of_the_current() {
        for i in [5.0, -5.0] {
            let seen = Seen { x: &[i], voltage: &[20.0 * i], speed: &[50.0], ..law() };
            let c = seen.loaded();
            let (mut tau, mut dx, mut y) = ([Torque::default()], [0.0], [0.0; 2]);
            MOTOR.torques(&c, &mut tau);
            Component::derivatives(&MOTOR, &c, &mut dx);
            MOTOR.measure_state(&c, &mut y);
            assert!((tau[0].value - (5e-3 - 3.0)).abs() < 1e-14);
            assert!((dx[0] - i * (20.0 - 4.0 - 6.0) / 0.02).abs() < 1e-9);
            assert_eq!(y, [i, 3.0]);
        }
    }

    #[test]
    fn the_formulas_of_a_rating_give_back_its_torque() {
        // 230 V and 800 W electrical, 500 W at the shaft at 8000 rpm.
        let (v, w) = (230.0_f64, 8000.0 * std::f64::consts::PI / 30.0);
        let i = 800.0 / v;
        let l_af = 500.0 / (w * i * i);
        let r = v / i - l_af * w;
        let current = v / (r + l_af * w);
        assert!((l_af * current * current * w - 500.0).abs() < 1e-10);
        assert!((v * current - 800.0).abs() < 1e-10);
        assert!((r * current * current - 300.0).abs() < 1e-10, "the rest is heat");
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |motor: UniversalMotor| motor.errors()[0].param.clone();
        assert_eq!(refused(UniversalMotor { l: 0.0, ..MOTOR }), "l");
        assert_eq!(refused(UniversalMotor { r: f64::NAN, ..MOTOR }), "r");
        assert_eq!(MOTOR.errors()[..], []);
    }
}
