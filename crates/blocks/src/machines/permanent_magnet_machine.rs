use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

use super::space_vector::{Vector, turned};
use super::warm_winding::WarmWinding;
use std::f64::consts::TAU;

/// Three-phase synchronous machine with permanent magnets (PMSM): fundamental wave, no saturation, no damper
/// cage.
///
/// In the frame of the rotor, whose d axis lies along the magnets and turns at the electrical speed $w_e$:
///
/// $$ v_d = R_s i_d + L_d \frac{di_d}{dt} - w_e L_q i_q, \qquad
///    v_q = R_s i_q + L_q \frac{di_q}{dt} + w_e (L_d i_d + \psi) $$
/// $$ \tau = \tfrac32 N \bigl(\psi i_q + (L_d - L_q) i_d i_q\bigr), \qquad
///    \dot\theta = w_e = N (w_r - w_c) $$
///
/// Vectors are amplitude invariant: their length is the peak of a phase. The voltage that the lines give is
/// turned into this frame by $\theta$, the angle of the d axis against the axis of phase a, and the currents are
/// turned back. The windings are in star and the star point is connected to nothing.
///
/// The torque acts on `r` and its reaction on `c`; the machine has no inertia and no damping of its own: add an
/// `Inertia` and a `RotationalDamper` at `r`. The output `theta` is not reduced to one turn, so it has no jumps;
/// with `theta0` it starts where the rotor stands. It depends on a state alone, as currents and torque do: a
/// controller may read all of them without closing an algebraic loop.
///
/// With `heat_port: true` the heat of the windings leaves by the thermal port `h`, and their resistance follows the temperature there,
/// $R_s = r_s (1 + \alpha (T - T_\mathrm{ref}))$. Connect a `HeatCapacity` to it.
///
/// Magnets on the surface of the rotor give $L_d = L_q$; buried ones $L_d < L_q$, and a negative $i_d$ then adds
/// torque. With `flux` 0 it is a reluctance machine.
///
/// ```ron
/// PermanentMagnetMachine(pole_pairs: 4, r_s: "0.6 ohm", l_d: "1.4 mH", l_q: "2.8 mH", flux: "0.12 Wb")
/// ```
///
/// Source: P. C. Krause, O. Wasynczuk, S. D. Sudhoff, *Analysis of Electric Machinery* (2002), with the axes of
/// the rotor named as in field-oriented control.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("MS 3~"))]
pub struct PermanentMagnetMachine {
    /// Number of pole pairs $N$.
    #[block(at_least = 1, zero = "frequency of the voltage times 60 over the speed in rpm")]
    pub pole_pairs: u32,
    /// Resistance of a phase.
    #[block(unit = "ohm", not_negative)]
    pub r_s: f64,
    /// Inductance along the magnets, positive.
    #[block(
        unit = "H",
        positive,
        remedy = "with surface magnets half of what is measured between two lines, for both axes"
    )]
    pub l_d: f64,
    /// Inductance across the magnets, positive.
    #[block(
        unit = "H",
        positive,
        remedy = "with surface magnets half of what is measured between two lines, for both axes"
    )]
    pub l_q: f64,
    /// Flux linkage of the magnets $\psi$: peak phase voltage without current over the electrical speed.
    #[block(
        unit = "Wb",
        not_negative,
        remedy = "peak phase voltage without current over the electrical speed"
    )]
    pub flux: f64,
    /// Electrical angle of the rotor at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub theta0: f64,
    /// Current along the magnets at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i_d0: f64,
    /// Current across the magnets at the start.
    #[block(unit = "A", finite, default = 0.0)]
    pub i_q0: f64,
    /// Heat of the machine.
    #[block(group)]
    pub warm: WarmWinding,
}

const I_D: usize = 0;
const I_Q: usize = 1;
const THETA: usize = 2;

impl PermanentMagnetMachine {
    /// Torque on the rotor, N*m.
    fn torque(&self, c: &Known) -> f64 {
        let (i_d, i_q) = (c.x[I_D], c.x[I_Q]);
        1.5 * f64::from(self.pole_pairs) * (self.flux + (self.l_d - self.l_q) * i_d) * i_q
    }

    /// Resistance of a phase, ohm.
    fn resistance(&self, c: &Flowing) -> f64 {
        self.warm.resistance(self.r_s, c)
    }

    /// Electrical speed of the rotor, rad/s.
    fn w_e(&self, c: &Moving) -> f64 {
        f64::from(self.pole_pairs) * c.speed[0]
    }

    /// Phase voltage in the frame of the rotor, V.
    fn voltage(&self, c: &Flowing) -> Vector {
        turned(c.supply.voltage, c.supply.angle - c.x[THETA])
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.warm.rotor_heat_port {
            let error = ParamError::new("rotor_heat_port", "the rotor of this machine has no losses");
            errors.add(error.help("leave it out"));
        }
    }
}

impl Component for PermanentMagnetMachine {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("ac", Domain::ThreePhase, "the lines")
            .port("r", Domain::Rotational, "rotor")
            .port("c", Domain::Rotational, "housing")
            .element(Element::Machine { ac: 0, ends: None })
            .element(Element::Branch { r: 1, c: 2 })
            .measures("torque", "N*m", Needs::State, "torque on the rotor")
            .measures("i_d", "A", Needs::State, "current along the magnets")
            .measures("i_q", "A", Needs::State, "current across the magnets")
            .measures("theta", "rad", Needs::State, "electrical angle of the rotor, not reduced to one turn")
            .measures("power", "W", Needs::Electrics, "power drawn from the lines")
            .state_in("i_d", self.i_d0, "A")
            .state_in("i_q", self.i_q0, "A")
            .drifting_state("theta", self.theta0);
        self.warm.part(part)
    }

    fn line_current(&self, c: &Fed) -> [f64; 3] {
        let [d, q] = turned([c.x[I_D], c.x[I_Q]], c.x[THETA] - c.supply.angle);
        [d, q, 0.0]
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        // v - u = L di/dt in the frame of the rotor, whose turning itself changes the currents of the supply's frame.
        let (w_e, turn) = (self.w_e(c), c.x[THETA] - c.supply.angle);
        let (i_d, i_q) = (c.x[I_D], c.x[I_Q]);
        let (r_s, w) = (self.resistance(c), w_e - TAU * c.supply.frequency);
        let u = [
            r_s * i_d - w_e * self.l_q * i_q + self.l_d * w * i_q,
            r_s * i_q + w_e * (self.l_d * i_d + self.flux) - self.l_q * w * i_d,
        ];
        let u = turned(u, turn);
        internal.copy_from_slice(&[u[0], u[1], 0.0]);
        let (sin, cos) = turn.sin_cos();
        let (d, q) = (1.0 / self.l_d, 1.0 / self.l_q);
        let cross = (d - q) * sin * cos;
        inverse.copy_from_slice(&[
            d * cos * cos + q * sin * sin,
            cross,
            0.0,
            cross,
            d * sin * sin + q * cos * cos,
            0.0,
            0.0,
            0.0,
            0.0,
        ]);
    }

    fn strike(&self, c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        let [d, q] = turned([volt_seconds[0], volt_seconds[1]], c.supply.angle - c.x[THETA]);
        x[I_D] += d / self.l_d;
        x[I_Q] += q / self.l_q;
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = Torque { value: -self.torque(c), slope: 0.0 };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let ([v_d, v_q], w_e) = (self.voltage(c), self.w_e(c));
        let (i_d, i_q, r_s) = (c.x[I_D], c.x[I_Q], self.resistance(c));
        dx[I_D] = (v_d - r_s * i_d + w_e * self.l_q * i_q) / self.l_d;
        dx[I_Q] = (v_q - r_s * i_q - w_e * (self.l_d * i_d + self.flux)) / self.l_q;
        dx[THETA] = w_e;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        // The magnets bring a constant, which is left out.
        let (i_d, i_q) = (c.x[I_D], c.x[I_Q]);
        Energy {
            stored: 0.75 * (self.l_d * i_d * i_d + self.l_q * i_q * i_q),
            dissipated: 1.5 * self.resistance(c) * (i_d * i_d + i_q * i_q),
            ..Energy::default()
        }
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        self.warm.guards(c, g);
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[..4].copy_from_slice(&[self.torque(c), c.x[I_D], c.x[I_Q], c.x[THETA]]);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let [v_d, v_q] = self.voltage(c);
        y[4] = 1.5 * (v_d * c.x[I_D] + v_q * c.x[I_Q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};
    use blocksim_block::physical::Supply;

    const MACHINE: PermanentMagnetMachine = PermanentMagnetMachine {
        pole_pairs: 4,
        r_s: 0.6,
        l_d: 1.4e-3,
        l_q: 2.8e-3,
        flux: 0.12,
        theta0: 0.3,
        i_d0: 0.0,
        i_q0: 0.0,
        warm: WarmWinding::NONE,
    };

    /// Voltage of phase a for a vector in a frame that stands at an angle.
    fn phase_a(v: Vector, angle: f64) -> f64 {
        turned(v, angle)[0]
    }

    #[test]
    fn the_voltage_in_the_frame_of_the_rotor_is_that_of_the_phases() {
        let supply = Supply {
            voltage: turned([100.0, 0.0], 0.4),
            zero: 0.0,
            frequency: 50.0,
            angle: 1.1,
            ..Supply::NONE
        };
        let c = Seen { x: &[0.0, 0.0, 2.3], supply: &supply, ..law() }.loaded();
        let v = MACHINE.voltage(&c);
        // Phases b and c are a third of a turn behind.
        for lag in [0.0, 1.0, 2.0].map(|third| third * std::f64::consts::TAU / 3.0) {
            let expected = 100.0 * (1.1 + 0.4 - lag).cos();
            assert!((phase_a(v, 2.3 - lag) - expected).abs() < 1e-12);
        }
        assert!((v[0] - 100.0 * (1.5_f64 - 2.3).cos()).abs() < 1e-12);
    }

    #[test]
    fn the_frame_of_the_supply_does_not_matter() {
        let see = |offset: f64, angle: f64| {
            let supply = Supply {
                voltage: turned([100.0, 0.0], offset),
                zero: 0.0,
                frequency: 50.0,
                angle,
                ..Supply::NONE
            };
            let c = Seen { x: &[3.0, 7.0, 2.3], speed: &[20.0], supply: &supply, ..law() }.loaded();
            let mut dx = [0.0; 3];
            Component::derivatives(&MACHINE, &c, &mut dx);
            let [d, q, _] = MACHINE.line_current(&c);
            (dx, turned([d, q], angle))
        };
        let ((dx, i), (dx_other, i_other)) = (see(0.4, 1.1), see(1.5, 0.0));
        assert!(dx.iter().zip(dx_other).all(|(a, b)| (a - b).abs() < 1e-9 * a.abs()));
        assert!(i.iter().zip(i_other).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    #[test]
    fn the_lines_give_the_power_that_the_windings_take() {
        let supply = Supply {
            voltage: turned([80.0, 0.0], -0.2),
            zero: 0.0,
            frequency: 30.0,
            angle: 5.0,
            ..Supply::NONE
        };
        let c = Seen { x: &[-2.0, 6.0, 4.1], speed: &[20.0], supply: &supply, ..law() }.loaded();
        let mut y = [0.0; 5];
        MACHINE.measure_electrics(&c, &mut y);
        let delivered = crate::three_phase::three_phase_source::delivered(&supply, MACHINE.line_current(&c));
        assert!((y[4] - delivered).abs() < 1e-11, "{} != {delivered}", y[4]);
    }

    #[test]
    fn buried_magnets_give_reluctance_torque_for_a_negative_current_along_them() {
        let torque = |i_d: f64| MACHINE.torque(&Seen { x: &[i_d, 10.0, 0.0], ..law() }.loaded());
        assert!((torque(0.0) - 7.2).abs() < 1e-14);
        assert!((torque(-10.0) - (7.2 + 6.0 * 0.14)).abs() < 1e-14);
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |machine: PermanentMagnetMachine| machine.errors()[0].param.clone();
        assert_eq!(refused(PermanentMagnetMachine { pole_pairs: 0, ..MACHINE }), "pole_pairs");
        assert_eq!(refused(PermanentMagnetMachine { l_d: 0.0, ..MACHINE }), "l_d");
        assert_eq!(refused(PermanentMagnetMachine { flux: -0.1, ..MACHINE }), "flux");
        assert_eq!(MACHINE.errors()[..], []);
    }
}
