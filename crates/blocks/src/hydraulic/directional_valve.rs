use blocksim_block::physical::{Characteristics, Domain, Handle, Pin};
use blocksim_block::prelude::*;

use super::opening::Opening;

/// The four edges: from the supply to `a` and `b`, from these to the tank.
const P_A: Handle = Handle::new("p to a");
const P_B: Handle = Handle::new("p to b");
const A_T: Handle = Handle::new("a to t");
const B_T: Handle = Handle::new("b to t");

/// Proportional directional valve with four ways and three positions (4/3), closed in the middle.
///
/// The position $s$ of the spool, from -1 to 1, opens two of its four edges: above zero from `p` to `a` and from `b` to `t`, below zero
/// from `p` to `b` and from `a` to `t`. Each edge is a sharp-edged orifice,
///
/// $$ q = C_d A \sqrt{\frac{2}{\rho}}\; \frac{\Delta p}{(\Delta p^2 + p_l^2)^{1/4}}, \qquad
///    A = A_l + \frac{\max(|s| - u, 0)}{1 - u}\,(A_{max} - A_l) $$
///
/// with the overlap $u$ of the spool in its middle position. A closed edge leaks through $A_l$. The spool follows the signal at once:
/// put a `TransferFunction` before it for its dynamics. Where an edge begins to open is an event.
///
/// ```ron
/// DirectionalValve(area: "10 mm^2")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 5.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = SpoolValve)]
pub struct DirectionalValve {
    /// Area of an edge that is fully open $A_{max}$, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
    /// Share of the way of the spool before an edge opens $u$: 0 or above, below 1.
    #[block(
        not_negative,
        below = 1.0,
        default = 0.0,
        remedy = "at 1 the valve never opens: give it as a share of the way of the spool, such as 0.05"
    )]
    pub overlap: f64,
    /// Area that is left of a closed edge $A_l$, positive and below `area`.
    #[block(
        unit = "m^2", positive, below = area, default = 1e-12,
        remedy = "every valve leaks a little; without leakage nothing determines the pressure behind it: write \"1e-12 m^2\"",
    )]
    pub leakage: f64,
    /// Edges and fluid.
    #[block(group)]
    pub opening: Opening,
}

impl DirectionalValve {
    /// Area of the edges that open above and below zero, m^2.
    fn areas(&self, s: f64) -> [f64; 2] {
        [s, -s].map(|s| {
            let share = ((s.min(1.0) - self.overlap) / (1.0 - self.overlap)).max(0.0);
            self.leakage + share * (self.area - self.leakage)
        })
    }
}

impl Component for DirectionalValve {
    fn part(&self, _given: &Given) -> Part {
        let edge = |p, n| self.opening.element(Pin::Port(p), Pin::Port(n), self.area);
        Part::new()
            .port("p", Domain::Hydraulic, "supply")
            .port("t", Domain::Hydraulic, "tank")
            .port("a", Domain::Hydraulic, "first working port")
            .port("b", Domain::Hydraulic, "second working port")
            .input(Input::real("s").scalar().unit("1").doc("position of the spool: -1 to 1"))
            .named(P_A, edge(0, 2))
            .named(P_B, edge(0, 3))
            .named(A_T, edge(2, 1))
            .named(B_T, edge(3, 1))
            .measures("q_a", "m^3/s", Needs::Electrics, "volume flow out of a")
            .measures("q_b", "m^3/s", Needs::Electrics, "volume flow out of b")
            .kink("opens_a", "opens from p to a", "closes from p to a")
            .kink("opens_b", "opens from p to b", "closes from p to b")
    }

    fn characteristics(&self, c: &Moving, curves: &mut Characteristics) {
        let [forward, backward] = self.areas(c.scalar(0));
        for (edge, area) in [(P_A, forward), (B_T, forward), (P_B, backward), (A_T, backward)] {
            let (q, slope) = self.opening.jet(curves.voltage(edge));
            curves.current(edge, area * q);
            curves.slope(edge, edge, area * slope);
        }
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        let s = c.scalar(0);
        g[..2].copy_from_slice(&[s - self.overlap, -s - self.overlap]);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated([P_A, P_B, A_T, B_T].iter().map(|edge| c.voltage(*edge) * c.current(*edge)).sum())
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current(P_A) - c.current(A_T), c.current(P_B) - c.current(B_T)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALVE: DirectionalValve =
        DirectionalValve { area: 10e-6, overlap: 0.0, leakage: 1e-12, opening: Opening::OIL };

    #[test]
    fn each_direction_opens_its_own_edges() {
        let [forward, backward] = VALVE.areas(0.3);
        assert!((forward - 3e-6).abs() < 1e-11 && backward == 1e-12);
        assert_eq!(VALVE.areas(-0.3), [backward, forward]);
        assert_eq!(VALVE.areas(4.0), VALVE.areas(1.0));
        let covered = DirectionalValve { overlap: 0.2, ..VALVE };
        assert_eq!(covered.areas(0.2), [1e-12; 2]);
        assert!((covered.areas(0.6)[0] - 5e-6).abs() < 1e-11);
    }

    #[test]
    fn a_valve_that_never_opens_is_refused() {
        assert!(DirectionalValve { overlap: 1.0, ..VALVE }.errors()[0].help.is_some());
        assert_eq!(DirectionalValve { area: -1.0, ..VALVE }.errors()[0].param, "area");
        assert_eq!(VALVE.errors()[..], []);
    }
}
