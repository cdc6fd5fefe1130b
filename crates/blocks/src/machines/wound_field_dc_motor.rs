use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Brushed motor with a separately excited field winding.
///
/// $$ v = R i + L \frac{di}{dt} + k w, \qquad v_f = R_f i_f + L_f \frac{di_f}{dt}, \qquad
///    k = L_{af} i_f, \qquad \tau = k i $$
///
/// The field current makes the constant $k$ that a motor with permanent magnets has by itself. Less of it lets
/// the motor turn faster at the same voltage with less torque for each ampere: field weakening. Without field
/// there is no torque, and nothing but resistance limits the current of the armature.
///
/// The armature lies between `p` and `n`, the field between `fp` and `fn`. A shunt motor has both at one
/// source; its torque does not change sign with the voltage, as both currents do. For field and armature in
/// series there is `UniversalMotor`. The rotor has the inertia $j$, against an implied ground, and a damping
/// between rotor and housing; no saturation.
///
/// ```ron
/// WoundFieldDcMotor(
///     r: "0.5 ohm", l: "10 mH", r_f: "240 ohm", l_f: "60 H", l_af: "1.8 H", j: "0.05 kg*m^2",
/// )
/// ```
///
/// Source: P. C. Krause, O. Wasynczuk, S. D. Sudhoff, *Analysis of Electric Machinery* (2002), chapter 2.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M"))]
pub struct WoundFieldDcMotor {
    /// Resistance of the armature.
    #[block(unit = "ohm", not_negative)]
    pub r: f64,
    /// Inductance of the armature, positive.
    #[block(unit = "H", positive, remedy = "the time constant l / r of an armature is some milliseconds")]
    pub l: f64,
    /// Resistance of the field winding.
    #[block(unit = "ohm", not_negative)]
    pub r_f: f64,
    /// Inductance of the field winding, positive.
    #[block(unit = "H", positive, remedy = "for a constant field take a DcMotor with k = l_af i_f")]
    pub l_f: f64,
    /// Mutual inductance: torque over the product of both currents.
    #[block(unit = "H", finite)]
    pub l_af: f64,
    /// Moment of inertia of the rotor; zero is allowed where something else gives the shaft its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Damping of the rotor.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Current of the armature at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i0: f64,
    /// Current of the field at the start; its voltage over `r_f` starts with full field.
    #[block(unit = "A", finite, default = 0.0)]
    pub i_f0: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

/// States, windings and their voltages: first the armature, then the field.
const ARMATURE: usize = 0;
const FIELD: usize = 1;

impl WoundFieldDcMotor {
    /// Constant of torque and induced voltage, N*m/A.
    fn k(&self, c: &Known) -> f64 {
        self.l_af * c.x[FIELD]
    }
}

impl Component for WoundFieldDcMotor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("p", Domain::Electrical, "positive pin of the armature")
            .port("n", Domain::Electrical, "negative pin of the armature")
            .port("fp", Domain::Electrical, "positive pin of the field winding")
            .port("fn", Domain::Electrical, "negative pin of the field winding")
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: true })
            .current_is(Gives::State(0))
            .current_is(Gives::State(1))
            .element(Element::Winding { p: Pin::Port(2), n: Pin::Port(3), from_state: true })
            .element(Element::Branch { r: 4, c: 5 })
            .element(Element::Inertia { port: 4, inertia: self.j, speed: None })
            .state_in("i", self.i0, "A")
            .state_in("i_f", self.i_f0, "A")
            .measures("i", "A", Needs::State, "current of the armature from p to n")
            .measures("i_f", "A", Needs::State, "current of the field from fp to fn")
            .measures("torque", "N*m", Needs::State, "torque of the armature, before the damping")
            .heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let value = self.damping * c.speed[0] - self.k(c) * c.x[ARMATURE];
        tau[0] = Torque { value, slope: self.damping };
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        internal[ARMATURE] = self.r * c.x[ARMATURE] + self.k(c) * c.speed[0];
        internal[FIELD] = self.r_f * c.x[FIELD];
        inverse.copy_from_slice(&[1.0 / self.l, 0.0, 0.0, 1.0 / self.l_f]);
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x[ARMATURE] += volt_seconds[ARMATURE] / self.l;
        x[FIELD] += volt_seconds[FIELD] / self.l_f;
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let (i, i_f) = (c.x[ARMATURE], c.x[FIELD]);
        dx[ARMATURE] = (c.voltage[ARMATURE] - self.r * i - self.k(c) * c.speed[0]) / self.l;
        dx[FIELD] = (c.voltage[FIELD] - self.r_f * i_f) / self.l_f;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (i, i_f, w) = (c.x[ARMATURE], c.x[FIELD], c.speed[0]);
        Energy {
            stored: 0.5 * (self.l * i * i + self.l_f * i_f * i_f),
            dissipated: self.r * i * i + self.r_f * i_f * i_f + self.damping * w * w,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[c.x[ARMATURE], c.x[FIELD], self.k(c) * c.x[ARMATURE]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const MOTOR: WoundFieldDcMotor = WoundFieldDcMotor {
        r: 0.5,
        l: 0.01,
        r_f: 240.0,
        l_f: 60.0,
        l_af: 1.8,
        j: 0.05,
        damping: 0.01,
        i0: 0.0,
        i_f0: 1.0,
        heat_port: false,
    };

    #[test]
    fn the_field_makes_the_constant_of_the_armature() {
        let c = Seen { x: &[10.0, 0.5], voltage: &[240.0, 180.0], speed: &[100.0], ..law() }.loaded();
        let (mut tau, mut dx, mut y) = ([Torque::default()], [0.0; 2], [0.0; 3]);
        MOTOR.torques(&c, &mut tau);
        Component::derivatives(&MOTOR, &c, &mut dx);
        MOTOR.measure_state(&c, &mut y);
        assert!((tau[0].value - (1.0 - 0.9 * 10.0)).abs() < 1e-13);
        assert!((dx[ARMATURE] - (240.0 - 5.0 - 90.0) / 0.01).abs() < 1e-9);
        assert!((dx[FIELD] - (180.0 - 120.0) / 60.0).abs() < 1e-14);
        assert_eq!(y, [10.0, 0.5, 9.0]);
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |motor: WoundFieldDcMotor| motor.errors()[0].param.clone();
        assert_eq!(refused(WoundFieldDcMotor { l: 0.0, ..MOTOR }), "l");
        assert_eq!(refused(WoundFieldDcMotor { l_f: 0.0, ..MOTOR }), "l_f");
        assert_eq!(refused(WoundFieldDcMotor { r_f: -1.0, ..MOTOR }), "r_f");
        assert_eq!(MOTOR.errors()[..], []);
    }
}
