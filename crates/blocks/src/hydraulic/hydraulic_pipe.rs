use std::f64::consts::PI;

use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::fluid_volume::TYPICAL_PRESSURE;
use super::{VACUUM, ends};

/// The fluid near both ends, and what moves between them.
const NEAR_A: Handle = Handle::new("near a");
const NEAR_B: Handle = Handle::new("near b");
const COLUMN: Handle = Handle::new("column");

/// States.
const A: usize = 0;
const B: usize = 1;
const Q: usize = 2;

/// Reynolds numbers where laminar flow ends and turbulent flow begins.
const LAMINAR: f64 = 2000.0;
const TURBULENT: f64 = 4000.0;

/// Pipe with the inertia of its fluid, the friction of its wall and the capacity of its volume, one half near each end.
///
/// $$ \frac{V}{2 \beta} \dot p_a = q_a - q, \qquad \frac{\rho l}{A} \dot q = p_a - p_b - \Delta p(q), \qquad
///    \frac{V}{2 \beta} \dot p_b = q - q_b $$
/// $$ \Delta p = f(\mathrm{Re})\, \frac{l}{d}\, \frac{\rho\, q |q|}{2 A^2}, \qquad \mathrm{Re} = \frac{|q| d}{A \nu} $$
///
/// with $f = 64/\mathrm{Re}$ up to a Reynolds number of 2000 (Hagen and Poiseuille), $f = 0.3164\,\mathrm{Re}^{-1/4}$ above 4000 (Blasius, a
/// smooth wall), and a straight line between the two. Both pressures and the flow are states. A pipe as one such piece is right up to
/// frequencies far below $\sqrt{\beta/\rho}/(2 l)$; a long one is a chain of several.
///
/// ```ron
/// HydraulicPipe(length: "3 m", diameter: "12 mm")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 3.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Pipe)]
pub struct HydraulicPipe {
    /// Length, positive.
    #[block(unit = "m", positive)]
    pub length: f64,
    /// Inner diameter, positive.
    #[block(unit = "m", positive)]
    pub diameter: f64,
    /// Bulk modulus $\beta$ of fluid and wall together, positive.
    #[block(unit = "Pa", positive, default = 1.4e9)]
    pub bulk_modulus: f64,
    /// Density of the fluid $\rho$, positive.
    #[block(unit = "kg/m^3", positive, default = 860.0)]
    pub density: f64,
    /// Kinematic viscosity $\nu$, positive: 46 mm^2/s for ISO VG 46 at 40 degC.
    #[block(unit = "m^2/s", positive, default = 46e-6)]
    pub viscosity: f64,
    /// Pressure at the start near both ends. Where none is given it follows from given pressures at the same node, else it is zero.
    #[block(unit = "Pa", finite, default = None)]
    pub p0: Option<f64>,
    /// Flow at the start.
    #[block(unit = "m^3/s", finite, default = 0.0)]
    pub q0: f64,
}

impl HydraulicPipe {
    fn area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }

    /// Capacity of half of the volume, m^3/Pa.
    fn capacity(&self) -> f64 {
        0.5 * self.area() * self.length / self.bulk_modulus
    }

    /// Inertia of the fluid, Pa*s^2/m^3.
    fn inertance(&self) -> f64 {
        self.density * self.length / self.area()
    }

    /// Pressure that the wall takes at a flow, Pa.
    fn friction(&self, q: f64) -> f64 {
        let (area, d) = (self.area(), self.diameter);
        let laminar = 128.0 * self.density * self.viscosity * self.length / (PI * d.powi(4));
        let reynolds = q.abs() * d / (area * self.viscosity);
        if reynolds <= LAMINAR {
            return laminar * q;
        }
        let blasius = |re: f64| 0.3164 * re.powf(-0.25);
        let factor = if reynolds >= TURBULENT {
            blasius(reynolds)
        } else {
            let share = (reynolds - LAMINAR) / (TURBULENT - LAMINAR);
            64.0 / LAMINAR + share * (blasius(TURBULENT) - 64.0 / LAMINAR)
        };
        factor * self.length / d * 0.5 * self.density * q * q.abs() / (area * area)
    }
}

impl Component for HydraulicPipe {
    fn part(&self, _given: &Given) -> Part {
        let (start, capacitance) = (self.p0, self.capacity());
        let half = |port, state| Element::Capacitance {
            p: Pin::Port(port),
            n: Pin::Ground,
            capacitance,
            state,
            start,
        };
        // The flow at one metre a second.
        let typical = self.area();
        ends()
            .nominal_state("p_a", self.p0.unwrap_or(0.0), TYPICAL_PRESSURE)
            .floor(VACUUM)
            .nominal_state("p_b", self.p0.unwrap_or(0.0), TYPICAL_PRESSURE)
            .floor(VACUUM)
            .nominal_state("q", self.q0, typical)
            .named(NEAR_A, half(0, A))
            .named(NEAR_B, half(1, B))
            .named(COLUMN, Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: true })
            .measures("q", "m^3/s", Needs::State, "volume flow from a to b in the middle")
            .measures("p_a", "Pa", Needs::State, "pressure at a")
            .measures("p_b", "Pa", Needs::State, "pressure at b")
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v[..2].copy_from_slice(&[c.x[A], c.x[B]]);
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i[0] = c.x[Q];
    }

    fn reluctance(&self, c: &Flowing, internal: &mut [f64], inverse: &mut [f64]) {
        internal[0] = self.friction(c.x[Q]);
        inverse[0] = 1.0 / self.inertance();
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        let capacity = self.capacity();
        let q = (c.voltage(COLUMN) - self.friction(c.x[Q])) / self.inertance();
        dx.copy_from_slice(&[c.current(NEAR_A) / capacity, c.current(NEAR_B) / capacity, q]);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let q = c.x[Q];
        let pressed = 0.5 * self.capacity() * (c.x[A] * c.x[A] + c.x[B] * c.x[B]);
        Energy {
            stored: pressed + 0.5 * self.inertance() * q * q,
            dissipated: self.friction(q) * q,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[c.x[Q], c.x[A], c.x[B]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIPE: HydraulicPipe = HydraulicPipe {
        length: 3.0,
        diameter: 0.012,
        bulk_modulus: 1.4e9,
        density: 860.0,
        viscosity: 46e-6,
        p0: None,
        q0: 0.0,
    };

    /// Volume flow of a Reynolds number.
    fn flow(reynolds: f64) -> f64 {
        reynolds * PIPE.area() * PIPE.viscosity / PIPE.diameter
    }

    #[test]
    fn slow_flow_is_that_of_hagen_and_poiseuille() {
        let (q, mean) = (flow(500.0), flow(500.0) / PIPE.area());
        let expected = 32.0 * 860.0 * 46e-6 * 3.0 * mean / 0.012_f64.powi(2);
        assert!((PIPE.friction(q) / expected - 1.0).abs() < 1e-12);
        assert_eq!(PIPE.friction(-q), -PIPE.friction(q));
    }

    #[test]
    fn fast_flow_is_that_of_blasius_and_no_step_is_in_between() {
        let mean = flow(1e5) / PIPE.area();
        let expected = 0.3164 * 1e5_f64.powf(-0.25) * 3.0 / 0.012 * 0.5 * 860.0 * mean * mean;
        assert!((PIPE.friction(flow(1e5)) / expected - 1.0).abs() < 1e-12);
        for re in [2000.0, 4000.0] {
            let (below, above) =
                (PIPE.friction(flow(re * (1.0 - 1e-9))), PIPE.friction(flow(re * (1.0 + 1e-9))));
            assert!((above / below - 1.0).abs() < 1e-7, "{below} and {above} at Re = {re}");
        }
        let all: Vec<f64> = (1..200).map(|k| PIPE.friction(flow(50.0 * f64::from(k)))).collect();
        assert!(all.windows(2).all(|pair| pair[1] > pair[0]));
    }

    #[test]
    fn pipes_that_are_none_are_refused() {
        assert_eq!(HydraulicPipe { diameter: 0.0, ..PIPE }.errors()[0].param, "diameter");
        assert_eq!(HydraulicPipe { viscosity: -1.0, ..PIPE }.errors()[0].param, "viscosity");
        assert_eq!(PIPE.errors()[..], []);
    }
}
