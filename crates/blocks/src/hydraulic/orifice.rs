use blocksim_block::physical::{Characteristics, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;
use super::opening::Opening;

/// The opening.
const EDGE: Handle = Handle::new("edge");

/// Sharp-edged orifice of a fixed area, from laminar to turbulent flow, in both directions.
///
/// $$ q = C_d A \sqrt{\frac{2}{\rho}}\; \frac{\Delta p}{(\Delta p^2 + p_l^2)^{1/4}}, \qquad \Delta p = p_a - p_b $$
///
/// ```ron
/// Orifice(area: "3 mm^2")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 3; the transition to laminar flow is that of widespread libraries
/// of hydraulic parts.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Restriction)]
pub struct Orifice {
    /// Area of the opening, positive.
    #[block(unit = "m^2", positive, zero = "an orifice without area lets nothing through: leave it out")]
    pub area: f64,
    /// Edge and fluid.
    #[block(group)]
    pub opening: Opening,
}

impl Component for Orifice {
    fn part(&self, _given: &Given) -> Part {
        ends()
            .named(EDGE, self.opening.element(Pin::Port(0), Pin::Port(1), self.area))
            .reads("q", "m^3/s", Reading::Current(EDGE), "volume flow from a to b")
            .reads("dp", "Pa", Reading::Voltage(EDGE), "pressure at a above that at b")
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let (q, slope) = self.opening.jet(curves.voltage(EDGE));
        curves.current(EDGE, self.area * q);
        curves.slope(EDGE, EDGE, self.area * slope);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(EDGE) * c.current(EDGE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const ORIFICE: Orifice = Orifice { area: 3e-6, opening: Opening::OIL };

    #[test]
    fn three_square_millimetres_let_seventeen_litres_a_minute_through_at_two_hundred_bar() {
        let (q, _) = characteristic(&ORIFICE, &[], &[2e7]);
        let expected = 0.62 * 3e-6 * (2.0 * 2e7 / 860.0_f64).sqrt();
        assert!((q[0] / expected - 1.0).abs() < 1e-6, "{q:?}");
        [-2e7, 0.0, 5e3, 1e6].iter().for_each(|dp| slopes_are_exact(&ORIFICE, &[], &[*dp]));
    }

    #[test]
    fn an_orifice_without_area_is_refused() {
        assert!(Orifice { area: 0.0, ..ORIFICE }.errors()[0].help.is_some());
        assert_eq!(ORIFICE.errors()[..], []);
    }
}
