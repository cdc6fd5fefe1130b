use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::VACUUM;
use super::fluid_volume::TYPICAL_PRESSURE;
use crate::mechanics::contact::Travel;
use crate::mechanics::elastic::ElasticLaw;
use crate::multibody::joint_limit::JointLimit;

/// The fluid in both chambers, and what the piston displaces of it.
const CHAMBER_A: Handle = Handle::new("chamber a");
const CHAMBER_B: Handle = Handle::new("chamber b");
const PISTON_A: Handle = Handle::new("piston a");
const PISTON_B: Handle = Handle::new("piston b");

/// States.
const A: usize = 0;
const B: usize = 1;
const X: usize = 2;

/// Hydraulic cylinder with two chambers, a piston rod and ends of travel: volume flow to translation and back.
///
/// $$ \frac{V_a}{\beta} \dot p_a = q_a - A_a v - q_l, \qquad \frac{V_b}{\beta} \dot p_b = q_b + A_b v + q_l, \qquad
///    F = A_a p_a - A_b p_b - d v $$
///
/// Pressure in chamber `a` drives the rod `r` out of the cylinder `c`, with the velocity $v = v_r - v_c$ and the force $F$; $q_l = G (p_a -
/// p_b)$ leaks past the piston. Position and both pressures are states. The chambers yield as they do with the piston in the middle,
/// with half of the stroke and the dead volume each: the position does not change that. At the ends of the stroke a spring and a
/// damper stop the piston, as in `TranslationalHardStop`. Friction of the seals that sticks is a `TranslationalFriction` beside it; the
/// rod has no mass.
///
/// ```ron
/// HydraulicCylinder(area_a: "20 cm^2", area_b: "12 cm^2", stroke: "400 mm", x0: "50 mm")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 6.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = HydraulicCylinder)]
pub struct HydraulicCylinder {
    /// Area of the piston $A_a$, positive.
    #[block(unit = "m^2", positive)]
    pub area_a: f64,
    /// Area of the side with the rod $A_b$, positive.
    #[block(unit = "m^2", positive)]
    pub area_b: f64,
    /// Way from one end to the other, positive.
    #[block(unit = "m", positive)]
    pub stroke: f64,
    /// Volume that is left in each chamber at its end, with the lines that lead to it; zero is allowed.
    #[block(unit = "m^3", not_negative, default = 2e-5)]
    pub dead_volume: f64,
    /// Bulk modulus $\beta$, positive.
    #[block(unit = "Pa", positive, default = 1.4e9)]
    pub bulk_modulus: f64,
    /// Leakage past the piston $G$ over the pressure difference; zero is allowed.
    #[block(unit = "m^3/(s*Pa)", not_negative, default = 0.0)]
    pub leakage: f64,
    /// Viscous friction $d$ of the piston; zero is allowed.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub damping: f64,
    /// Position at the start, from 0 to `stroke`.
    #[block(
        unit = "m", finite, at_least = 0.0, at_most = stroke, default = 0.0,
        remedy = "the position counts from the end where chamber a is smallest",
    )]
    pub x0: f64,
    /// Pressure of chamber `a` at the start. Where none is given it follows from given pressures at the same node, else it is zero.
    #[block(unit = "Pa", finite, default = None)]
    pub p_a0: Option<f64>,
    /// Pressure of chamber `b` at the start, likewise.
    #[block(unit = "Pa", finite, default = None)]
    pub p_b0: Option<f64>,
    /// Stiffness of both ends.
    #[block(unit = "N/m", not_negative, default = 1e8)]
    pub stop_stiffness: f64,
    /// Damping of both ends.
    #[block(unit = "N*s/m", not_negative, default = 1e5)]
    pub stop_damping: f64,
    /// Width over which an end sets in; zero sets in at once.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub stop_transition: f64,
}

impl HydraulicCylinder {
    fn travel(&self) -> Travel {
        let (stiffness, damping, transition) = (self.stop_stiffness, self.stop_damping, self.stop_transition);
        Travel { lower: 0.0, upper: self.stroke, end: JointLimit { stiffness, damping, transition } }
    }

    /// How much more fluid each chamber holds for a pressure, m^3/Pa.
    fn capacities(&self) -> [f64; 2] {
        [self.area_a, self.area_b]
            .map(|area| (self.dead_volume + 0.5 * area * self.stroke) / self.bulk_modulus)
    }

    /// Force of the fluid on the rod, N.
    fn force(&self, c: &Known) -> f64 {
        self.area_a * c.x[A] - self.area_b * c.x[B]
    }
}

impl Component for HydraulicCylinder {
    fn part(&self, _given: &Given) -> Part {
        let [of_a, of_b] = self.capacities();
        let chamber = |port, capacitance, state, start| Element::Capacitance {
            p: Pin::Port(port),
            n: Pin::Ground,
            capacitance,
            state,
            start,
        };
        let displaced = |port| Element::Winding { p: Pin::Port(port), n: Pin::Ground, from_state: true };
        let part = Part::new()
            .port("a", Domain::Hydraulic, "chamber that drives the rod out")
            .port("b", Domain::Hydraulic, "chamber on the side of the rod")
            .port("r", Domain::Translational, "rod")
            .port("c", Domain::Translational, "cylinder")
            .nominal_state("p_a", self.p_a0.unwrap_or(0.0), TYPICAL_PRESSURE)
            .floor(VACUUM)
            .nominal_state("p_b", self.p_b0.unwrap_or(0.0), TYPICAL_PRESSURE)
            .floor(VACUUM)
            .state_in("x", self.x0, "m")
            .named(CHAMBER_A, chamber(0, of_a, A, self.p_a0))
            .named(CHAMBER_B, chamber(1, of_b, B, self.p_b0))
            .named(PISTON_A, displaced(0))
            .named(PISTON_B, displaced(1))
            .element(Element::Branch { r: 2, c: 3 })
            .measures("x", "m", Needs::State, "position of the rod")
            .measures("f", "N", Needs::State, "force of the fluid on the rod")
            .measures("p_a", "Pa", Needs::State, "pressure in chamber a")
            .measures("p_b", "Pa", Needs::State, "pressure in chamber b");
        let part = self.travel().events(part);
        match self.leakage {
            0.0 => part,
            g => part.element(Element::Resistance { p: Pin::Port(0), n: Pin::Port(1), resistance: 1.0 / g }),
        }
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v[..2].copy_from_slice(&[c.x[A], c.x[B]]);
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i[..2].copy_from_slice(&[self.area_a * c.speed[0], -self.area_b * c.speed[0]]);
    }

    fn torques(&self, c: &Flowing, f: &mut [Torque]) {
        let stop = self.travel().load(c.x[X], c.speed[0], c.d);
        // What the piston takes from the fluid, and nothing else, drives it.
        let drive = self.area_a * c.voltage(PISTON_A) - self.area_b * c.voltage(PISTON_B);
        let value = stop.value + self.damping * c.speed[0] - drive;
        f[0] = Torque { value, slope: stop.slope + self.damping };
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let [of_a, of_b] = self.capacities();
        dx.copy_from_slice(&[c.current(CHAMBER_A) / of_a, c.current(CHAMBER_B) / of_b, c.speed[0]]);
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.travel().settle(c.x[X], c.speed[0], d)
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        self.travel().guards(c.x[X], c.speed[0], c.d, g);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let [of_a, of_b] = self.capacities();
        let stored = 0.5 * (of_a * c.x[A] * c.x[A] + of_b * c.x[B] * c.x[B]);
        let lost = self.damping * c.speed[0] * c.speed[0];
        self.travel().energy(c.x[X], c.speed[0], c.d)
            + Energy { stored, dissipated: lost, ..Energy::default() }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[c.x[X], self.force(c), c.x[A], c.x[B]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::places;
    use crate::mechanics::testing::{Seen, law};

    const CYLINDER: HydraulicCylinder = HydraulicCylinder {
        area_a: 20e-4,
        area_b: 12e-4,
        stroke: 0.4,
        dead_volume: 2e-5,
        bulk_modulus: 1.4e9,
        leakage: 0.0,
        damping: 100.0,
        x0: 0.1,
        p_a0: None,
        p_b0: None,
        stop_stiffness: 1e8,
        stop_damping: 1e5,
        stop_transition: 1e-4,
    };

    /// With both pressures, Pa, a position, m, and a velocity, m/s.
    fn at(pressures: [f64; 2], x: f64, v: f64) -> (f64, [f64; 2]) {
        let places = places(&CYLINDER);
        let [a, b] = pressures;
        let seen = Seen { x: &[a, b, x], speed: &[v], voltage: &[a, b, a, b], places: &places, ..law() };
        let c = seen.loaded();
        let (mut f, mut q) = ([Torque::default()], [0.0; 2]);
        CYLINDER.torques(&c, &mut f);
        CYLINDER.currents(&c, &mut q);
        assert_eq!(CYLINDER.force(&c), 20e-4 * a - 12e-4 * b);
        (f[0].value, q)
    }

    #[test]
    fn the_force_is_that_of_both_pressures_on_their_areas() {
        let (f, q) = at([1e7, 2e6], 0.1, 0.5);
        assert!((f - (50.0 - 20_000.0 + 2_400.0)).abs() < 1e-9, "{f}");
        assert!((q[0] - 1e-3).abs() < 1e-18 && (q[1] + 6e-4).abs() < 1e-18);
    }

    #[test]
    fn beyond_its_stroke_the_end_pushes_back() {
        let (upper, lower) = (at([0.0; 2], 0.401, 0.0).0, at([0.0; 2], -0.001, 0.0).0);
        assert!((upper - 1e5).abs() < 1e-6 && (lower + 1e5).abs() < 1e-6, "{upper} {lower}");
    }

    #[test]
    fn a_piston_outside_of_its_cylinder_is_refused() {
        assert!(HydraulicCylinder { x0: 0.5, ..CYLINDER }.errors()[0].help.is_some());
        assert_eq!(HydraulicCylinder { stroke: 0.0, ..CYLINDER }.errors()[0].param, "stroke");
        assert_eq!(CYLINDER.errors()[..], []);
    }
}
