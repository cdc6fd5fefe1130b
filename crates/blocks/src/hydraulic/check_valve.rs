use blocksim_block::physical::{Characteristics, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;
use super::opening::{Opening, ends_of_opening, smooth_share, with_ends};

/// The opening.
const SEAT: Handle = Handle::new("seat");

/// Check valve: lets fluid flow from `a` to `b` and holds it back the other way.
///
/// Its area follows the pressure difference $\Delta p = p_a - p_b$ at once, from the leakage area below the cracking pressure $p_o$ to the
/// whole area at $p_f$, smoothly,
///
/// $$ A = A_l + (3 x^2 - 2 x^3)(A_{max} - A_l), \qquad x = \min\left(\max\left(\frac{\Delta p - p_o}{p_f - p_o}, 0\right), 1\right) $$
///
/// and the flow is that of a sharp-edged orifice of this area.
///
/// ```ron
/// CheckValve(area: "20 mm^2")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 3, for the orifice.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = CheckValve)]
pub struct CheckValve {
    /// Area of the whole opening $A_{max}$, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
    /// Cracking pressure $p_o$, at which it begins to open.
    #[block(unit = "Pa", not_negative, default = 3e4)]
    pub p_open: f64,
    /// Pressure difference $p_f$ at which it is fully open, above `p_open`.
    #[block(unit = "Pa", finite, above = p_open, default = 1.2e5)]
    pub p_full: f64,
    /// Area that is left when it is closed $A_l$, positive and below `area`.
    #[block(
        unit = "m^2", positive, below = area, default = 1e-12,
        remedy = "every valve leaks a little; without leakage nothing determines the pressure behind it: write \"1e-12 m^2\"",
    )]
    pub leakage: f64,
    /// Edge and fluid.
    #[block(group)]
    pub opening: Opening,
}

impl Component for CheckValve {
    fn part(&self, _given: &Given) -> Part {
        let part = ends()
            .named(SEAT, self.opening.element(Pin::Port(0), Pin::Port(1), self.area))
            .reads("q", "m^3/s", Reading::Current(SEAT), "volume flow from a to b")
            .reads("dp", "Pa", Reading::Voltage(SEAT), "pressure at a above that at b");
        with_ends(part)
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let dp = curves.voltage(SEAT);
        let (share, rise) = smooth_share(dp, self.p_open, self.p_full);
        let (span, (q, slope)) = (self.area - self.leakage, self.opening.jet(dp));
        let area = self.leakage + share * span;
        curves.current(SEAT, area * q);
        curves.slope(SEAT, SEAT, area * slope + rise * span * q);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        ends_of_opening(c.voltage(SEAT), self.p_open, self.p_full, g);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(SEAT) * c.current(SEAT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const VALVE: CheckValve =
        CheckValve { area: 20e-6, p_open: 3e4, p_full: 1.2e5, leakage: 1e-12, opening: Opening::OIL };

    #[test]
    fn it_lets_through_one_way_alone() {
        let q = |dp: f64| characteristic(&VALVE, &[], &[dp]).0[0];
        assert!((q(1e6) - 20e-6 * Opening::OIL.jet(1e6).0).abs() < 1e-15);
        assert!(q(-2e7) < 0.0 && q(-2e7).abs() < 1e-9 && q(2e4) < 1e-10);
        [-2e7, 2e4, 5e4, 1e5, 1e6].iter().for_each(|dp| slopes_are_exact(&VALVE, &[], &[*dp]));
    }

    #[test]
    fn a_valve_that_is_open_before_it_cracks_is_refused() {
        assert!(!CheckValve { p_full: 1e4, ..VALVE }.errors().is_empty());
        assert_eq!(CheckValve { p_open: -1.0, ..VALVE }.errors()[0].param, "p_open");
        assert_eq!(VALVE.errors()[..], []);
    }
}
