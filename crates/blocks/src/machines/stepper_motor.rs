use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Two-phase hybrid stepper motor.
///
/// With $N$ teeth of the rotor, the angle $\theta$ and the speed $w = w_r - w_c$ of the rotor against the housing, for the
/// phases A and B:
///
/// $$ v_A = R i_A + L \frac{di_A}{dt} + e_A, \quad e_A = -k w \sin N\theta, \qquad
///    v_B = R i_B + L \frac{di_B}{dt} + e_B, \quad e_B = k w \cos N\theta $$
/// $$ \tau = -k\,(i_A - g_m e_A) \sin N\theta + k\,(i_B - g_m e_B) \cos N\theta - T_d \sin 4N\theta - d\,w,
///    \qquad \dot\theta = w $$
///
/// A full step is a quarter of a tooth, $\pi/(2N)$: 50 teeth make 200 steps of 1.8 degrees. Currents
/// $i_A = I\cos\varphi$, $i_B = I\sin\varphi$ hold the rotor at $N\theta = \varphi$ with up to $k I$: a positive current in A
/// alone at $\theta = 0$, both alike half a step further, with $\sqrt2\,k I$. Small oscillations about such a point have
/// the angular frequency $\sqrt{N (k I + 4 T_d)/j}$ where one phase conducts.
///
/// The detent torque $T_d$ pulls the rotor to whole steps without any current. The iron losses $g_m$ brake as a damping
/// $g_m k^2$ does. The rotor has the inertia $j$, against an implied ground. With $L > 0$ the currents are states; with
/// $L = 0$ they follow at once from voltages and speed. `StepperDriver` makes the voltages.
///
/// ```ron
/// StepperMotor(teeth: 50, r: "1.2 Ohm", l: "2.4 mH", k: "0.22 N*m/A", j: "5.4e-6 kg*m^2", detent: "8 mN*m")
/// ```
///
/// Source: P. P. Acarnley, *Stepping Motors: A Guide to Theory and Practice* (2002); T. Kenjo, A. Sugawara, *Stepping
/// Motors and Their Microprocessor Controls* (1994).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M"))]
pub struct StepperMotor {
    /// Teeth of the rotor $N$: a quarter of the full steps in a turn.
    #[block(
        at_least = 1,
        default = 50,
        zero = "90 degrees over the step angle: 50 for steps of 1.8 degrees"
    )]
    pub teeth: u32,
    /// Resistance of a phase; may be zero unless the inductance is.
    #[block(unit = "Ohm", not_negative)]
    pub r: f64,
    /// Inductance of a phase; may be zero unless the resistance is.
    #[block(unit = "H", not_negative)]
    pub l: f64,
    /// Torque constant $k$: holding torque of one phase over its current and, with the same number, peak of the induced
    /// voltage over the speed.
    #[block(unit = "N*m/A", finite)]
    pub k: f64,
    /// Moment of inertia of the rotor; zero is allowed where something else gives the shaft its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Detent torque $T_d$: largest torque without current.
    #[block(unit = "N*m", not_negative, default = 0.0)]
    pub detent: f64,
    /// Damping of the rotor $d$.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Conductance $g_m$ that stands for the losses in the iron, across the induced voltage of each phase.
    #[block(unit = "S", not_negative, default = 0.0)]
    pub g_m: f64,
    /// Angle of the rotor at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub theta0: f64,
    /// Current of phase A at the start; only with an inductance.
    #[block(unit = "A", finite, default = 0.0)]
    pub i_a0: f64,
    /// Current of phase B at the start; only with an inductance.
    #[block(unit = "A", finite, default = 0.0)]
    pub i_b0: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl StepperMotor {
    fn n(&self) -> f64 {
        f64::from(self.teeth)
    }

    /// Angle of the rotor, rad: the last of the states.
    fn theta(c: &Known) -> f64 {
        c.x[c.x.len() - 1]
    }

    /// Torque of each phase for each ampere, N*m/A, which is also its induced voltage for each rad/s.
    fn constants(&self, c: &Known) -> [f64; 2] {
        let (sin, cos) = (self.n() * Self::theta(c)).sin_cos();
        [-self.k * sin, self.k * cos]
    }

    /// Currents of both phases, A; without inductance they follow from the voltages.
    fn phase_currents(&self, c: &Flowing) -> [f64; 2] {
        if self.l > 0.0 {
            return [c.x[0], c.x[1]];
        }
        let k = self.constants(c);
        [0, 1].map(|phase| (c.voltage[phase] - k[phase] * c.speed[0]) / self.r)
    }

    /// Damping by friction and by the losses in the iron, N*m*s/rad.
    fn braking(&self) -> f64 {
        self.damping + self.g_m * self.k * self.k
    }

    /// Torque of these currents, magnets and losses in the iron on the rotor, N*m.
    fn torque(&self, c: &Moving, [i_a, i_b]: [f64; 2]) -> f64 {
        let [k_a, k_b] = self.constants(c);
        let detent = self.detent * (4.0 * self.n() * Self::theta(c)).sin();
        k_a * i_a + k_b * i_b - detent - self.g_m * self.k * self.k * c.speed[0]
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.l == 0.0 && self.r == 0.0 {
            let error = ParamError::new("r", "`r` and `l` are both 0, so nothing limits the currents");
            errors.add(error.beside(&["l"]).help("give the phases their resistance"));
        }
        for (name, start) in [("i_a0", self.i_a0), ("i_b0", self.i_b0)] {
            if self.l == 0.0 && start != 0.0 {
                let error =
                    ParamError::new(name, "without inductance the current has no start value of its own");
                let help = format!("leave `{name}` out, or give the phases their inductance `l`");
                errors.add(error.beside(&["l"]).help(help));
            }
        }
    }
}

impl Component for StepperMotor {
    fn part(&self, _given: &Given) -> Part {
        let from_state = self.l > 0.0;
        let winding = |p| Element::Winding { p: Pin::Port(p), n: Pin::Port(p + 1), from_state };
        let part = Part::new()
            .port("a_p", Domain::Electrical, "positive pin of phase A")
            .port("a_n", Domain::Electrical, "negative pin of phase A")
            .port("b_p", Domain::Electrical, "positive pin of phase B")
            .port("b_n", Domain::Electrical, "negative pin of phase B")
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(winding(0))
            .element(winding(2))
            .element(Element::Branch { r: 4, c: 5 })
            .element(Element::Inertia { port: 4, inertia: self.j, speed: None });
        let (part, needs) = if from_state {
            (part.linear().state_in("i_a", self.i_a0, "A").state_in("i_b", self.i_b0, "A"), Needs::State)
        } else {
            (part, Needs::Electrics)
        };
        part.drifting_state("theta", self.theta0)
            .measures("i_a", "A", needs, "current of phase A, from a_p to a_n")
            .measures("i_b", "A", needs, "current of phase B, from b_p to b_n")
            .measures("torque", "N*m", needs, "torque of the field on the rotor")
            .measures(
                "theta",
                "rad",
                Needs::State,
                "angle of the rotor against the housing, not reduced to a turn",
            )
            .heat_port(self.heat_port)
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        if self.l > 0.0 {
            i.copy_from_slice(&c.x[..2]);
        }
    }

    fn currents_by_voltages(&self, c: &Flowing, i: &mut [f64]) {
        i.copy_from_slice(&self.phase_currents(c));
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        let k = self.constants(c);
        for phase in 0..2 {
            internal[phase] = self.r * c.x[phase] + k[phase] * c.speed[0];
        }
        inverse.copy_from_slice(&[1.0 / self.l, 0.0, 0.0, 1.0 / self.l]);
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x.iter_mut().zip(volt_seconds).for_each(|(i, flux)| *i += flux / self.l);
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        // Without inductance the induced voltages damp as k^2/R does: sin^2 + cos^2 = 1.
        let induced = if self.l > 0.0 { 0.0 } else { self.k * self.k / self.r };
        tau[0] = Torque {
            value: self.damping * c.speed[0] - self.torque(c, self.phase_currents(c)),
            slope: self.braking() + induced,
        };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        if self.l > 0.0 {
            let k = self.constants(c);
            for phase in 0..2 {
                dx[phase] = (c.voltage[phase] - self.r * c.x[phase] - k[phase] * c.speed[0]) / self.l;
            }
        }
        dx[c.x.len() - 1] = c.speed[0];
    }

    fn linearize(&self, law: &Flowing, a: &mut [f64], b: &mut [f64], c: &mut [f64]) {
        let ([i_a, i_b], [k_a, k_b]) = (self.phase_currents(law), self.constants(law));
        let (n, w, theta) = (self.n(), law.speed[0], Self::theta(law));
        // Turning exchanges the constants: dk_a/dtheta = -N k_b, dk_b/dtheta = N k_a.
        let stiffness = n * (k_b * i_a - k_a * i_b) + 4.0 * n * self.detent * (4.0 * n * theta).cos();
        a.copy_from_slice(&[
            -self.r / self.l,
            0.0,
            n * k_b * w / self.l,
            0.0,
            -self.r / self.l,
            -n * k_a * w / self.l,
            0.0,
            0.0,
            0.0,
        ]);
        b.copy_from_slice(&[-k_a / self.l, -k_b / self.l, 1.0]);
        c.copy_from_slice(&[-k_a, -k_b, stiffness]);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let ([i_a, i_b], w, n) = (self.phase_currents(c), c.speed[0], self.n());
        let squares = i_a * i_a + i_b * i_b;
        let magnets = self.detent * (1.0 - (4.0 * n * Self::theta(c)).cos()) / (4.0 * n);
        Energy {
            stored: 0.5 * self.l * squares + magnets,
            dissipated: self.r * squares + self.braking() * w * w,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[3] = Self::theta(c);
        if self.l > 0.0 {
            let i = [c.x[0], c.x[1]];
            y[..2].copy_from_slice(&i);
            y[2] = self.torque(c, i);
        }
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        if self.l == 0.0 {
            let i = self.phase_currents(c);
            y[..2].copy_from_slice(&i);
            y[2] = self.torque(c, i);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const MOTOR: StepperMotor = StepperMotor {
        teeth: 50,
        r: 1.2,
        l: 2.4e-3,
        k: 0.22,
        j: 5.4e-6,
        detent: 8e-3,
        damping: 1e-4,
        g_m: 0.01,
        theta0: 0.0,
        i_a0: 0.0,
        i_b0: 0.0,
        heat_port: false,
    };

    fn torque(motor: &StepperMotor, x: [f64; 3]) -> f64 {
        motor.torque(&Seen { x: &x, speed: &[0.0], ..law() }.loaded(), [x[0], x[1]])
    }

    #[test]
    fn the_holding_torque_is_a_sine_of_the_angle_about_the_point_that_the_currents_say() {
        let motor = StepperMotor { detent: 0.0, ..MOTOR };
        for phi in [0.0, 0.4, FRAC_PI_2, 2.0, PI, 5.0] {
            let (i_a, i_b) = (1.5 * f64::cos(phi), 1.5 * f64::sin(phi));
            for k in 0..40 {
                let theta = f64::from(k) * TAU / 50.0 / 40.0;
                let expected = 0.22 * 1.5 * (phi - 50.0 * theta).sin();
                assert!((torque(&motor, [i_a, i_b, theta]) - expected).abs() < 1e-14, "{phi}, {theta}");
            }
        }
        // Two phases hold with the square root of two of one.
        let most =
            (0..4000).map(|k| torque(&motor, [1.5, 1.5, f64::from(k) * TAU / 2e5])).fold(0.0, f64::max);
        assert!((most - 2.0_f64.sqrt() * 0.33).abs() < 1e-6, "{most}");
    }

    #[test]
    fn without_current_the_rotor_rests_at_whole_steps() {
        for step in 0..8 {
            let theta = f64::from(step) * TAU / 200.0;
            let at = |offset: f64| torque(&MOTOR, [0.0, 0.0, theta + offset]);
            assert!(at(0.0).abs() < 1e-15 && at(1e-4) < 0.0 && at(-1e-4) > 0.0, "step {step}");
        }
        assert!((torque(&MOTOR, [0.0, 0.0, -PI / 400.0]) - 8e-3).abs() < 1e-17);
    }

    #[test]
    fn what_the_solver_is_told_of_the_stiffness_is_the_slope_of_the_law() {
        let point = |x: [f64; 3], w: f64| {
            let (mut tau, mut dx) = ([Torque::default()], [0.0; 3]);
            let seen = Seen { x: &x, voltage: &[3.0, -2.0], speed: &[w], ..law() };
            let c = seen.loaded();
            MOTOR.torques(&c, &mut tau);
            Component::derivatives(&MOTOR, &c, &mut dx);
            [dx[0], dx[1], dx[2], tau[0].value]
        };
        let (x, w) = ([0.7, -0.3, 0.013], 20.0);
        let (mut a, mut b, mut c) = ([0.0; 9], [0.0; 3], [0.0; 3]);
        MOTOR.linearize(&Seen { x: &x, speed: &[w], ..law() }.loaded(), &mut a, &mut b, &mut c);
        let slope = |k: usize, row: usize| {
            let h = 1e-6;
            let at = |h: f64| {
                let mut moved = x;
                if k < 3 {
                    moved[k] += h;
                }
                point(moved, if k == 3 { w + h } else { w })[row]
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        for row in 0..3 {
            for k in 0..3 {
                assert!(
                    (a[3 * row + k] - slope(k, row)).abs() < 1e-4 * (1.0 + slope(k, row).abs()),
                    "{row}, {k}"
                );
            }
            assert!((b[row] - slope(3, row)).abs() < 1e-5 * (1.0 + b[row].abs()));
            assert!((c[row] - slope(row, 3)).abs() < 1e-5 * (1.0 + c[row].abs()), "{row}");
        }
    }

    #[test]
    fn without_inductance_the_currents_follow_from_voltages_and_speed() {
        let motor = StepperMotor { l: 0.0, ..MOTOR };
        let c = Seen { x: &[0.0], voltage: &[2.4, 1.2], speed: &[10.0], ..law() }.loaded();
        // At zero, phase A induces nothing and phase B 2.2 V.
        let i = motor.phase_currents(&c);
        assert!((i[0] - 2.0).abs() < 1e-15 && (i[1] - (1.2 - 2.2) / 1.2).abs() < 1e-15, "{i:?}");
        assert_eq!(motor.part(&Given::nothing()).outputs[0].1, Needs::Electrics);
        assert_eq!(motor.errors()[..], []);
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |motor: StepperMotor| motor.errors()[0].param.clone();
        assert_eq!(refused(StepperMotor { teeth: 0, ..MOTOR }), "teeth");
        assert_eq!(refused(StepperMotor { r: 0.0, l: 0.0, ..MOTOR }), "r");
        assert_eq!(refused(StepperMotor { l: 0.0, i_b0: 1.0, ..MOTOR }), "i_b0");
        assert_eq!(refused(StepperMotor { detent: -1.0, ..MOTOR }), "detent");
        assert_eq!(refused(StepperMotor { g_m: f64::NAN, ..MOTOR }), "g_m");
        assert_eq!(MOTOR.errors()[..], []);
    }
}
