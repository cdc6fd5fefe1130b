use blocksim_block::physical::{Characteristics, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;
use super::opening::{Opening, ends_of_opening, smooth_share, with_ends};

/// The opening.
const SEAT: Handle = Handle::new("seat");

/// Pressure relief valve: opens from `a` to `b` where the pressure between them exceeds what it is set to, and so limits it.
///
/// Its area follows the pressure difference at once, from the leakage area at the set pressure to the whole area a regulation range
/// above it, smoothly (see `CheckValve`); the flow is that of a sharp-edged orifice of this area.
///
/// ```ron
/// ReliefValve(area: "30 mm^2", p_set: "160 bar")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 9, for what such a valve does; chapter 3 for the orifice.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = ReliefValve)]
pub struct ReliefValve {
    /// Area of the whole opening, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
    /// Pressure difference at which it begins to open, positive.
    #[block(unit = "Pa", positive)]
    pub p_set: f64,
    /// Pressure above `p_set` at which it is fully open, positive.
    #[block(unit = "Pa", positive, default = 5e5)]
    pub regulation: f64,
    /// Area that is left when it is closed, positive and below `area`.
    #[block(
        unit = "m^2", positive, below = area, default = 1e-12,
        remedy = "every valve leaks a little; without leakage nothing determines the pressure behind it: write \"1e-12 m^2\"",
    )]
    pub leakage: f64,
    /// Edge and fluid.
    #[block(group)]
    pub opening: Opening,
}

impl Component for ReliefValve {
    fn part(&self, _given: &Given) -> Part {
        let part = ends()
            .named(SEAT, self.opening.element(Pin::Port(0), Pin::Port(1), self.area))
            .reads("q", "m^3/s", Reading::Current(SEAT), "volume flow from a to b")
            .reads("dp", "Pa", Reading::Voltage(SEAT), "pressure at a above that at b");
        with_ends(part)
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let dp = curves.voltage(SEAT);
        let (share, rise) = smooth_share(dp, self.p_set, self.p_set + self.regulation);
        let (span, (q, slope)) = (self.area - self.leakage, self.opening.jet(dp));
        let area = self.leakage + share * span;
        curves.current(SEAT, area * q);
        curves.slope(SEAT, SEAT, area * slope + rise * span * q);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        ends_of_opening(c.voltage(SEAT), self.p_set, self.p_set + self.regulation, g);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(SEAT) * c.current(SEAT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const VALVE: ReliefValve =
        ReliefValve { area: 30e-6, p_set: 1.6e7, regulation: 5e5, leakage: 1e-12, opening: Opening::OIL };

    #[test]
    fn it_is_closed_up_to_its_pressure_and_open_above() {
        let q = |dp: f64| characteristic(&VALVE, &[], &[dp]).0[0];
        assert!(q(1.59e7) < 2e-10);
        assert!((q(1.65e7) - 30e-6 * Opening::OIL.jet(1.65e7).0).abs() < 1e-12);
        [-1e6, 1.5e7, 1.62e7, 1.7e7].iter().for_each(|dp| slopes_are_exact(&VALVE, &[], &[*dp]));
    }

    #[test]
    fn a_valve_without_a_pressure_is_refused() {
        assert_eq!(ReliefValve { p_set: 0.0, ..VALVE }.errors()[0].param, "p_set");
        assert_eq!(ReliefValve { regulation: 0.0, ..VALVE }.errors()[0].param, "regulation");
        assert_eq!(VALVE.errors()[..], []);
    }
}
