//! What all sharp-edged openings have in common: the flow through an area.

use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Pressure difference at which the linear behaviour of valves is looked at, Pa.
const TYPICAL: f64 = 1e6;

/// What a sharp-edged opening does whatever its area.
///
/// $$ q = C_d A \sqrt{\frac{2}{\rho}}\; \frac{\Delta p}{(\Delta p^2 + p_l^2)^{1/4}} $$
///
/// Far above the pressure difference $p_l$ this is the law of a turbulent jet, $q = C_d A \sqrt{2 |\Delta p| / \rho}$; below it the flow is
/// laminar, in proportion to the pressure difference.
#[derive(Debug, Clone, Copy, PartialEq, Parameters)]
pub struct Opening {
    /// Discharge coefficient $C_d$, above 0 and at most 1.
    #[block(
        positive,
        at_most = 1.0,
        default = 0.62,
        remedy = "no jet is wider than its opening: a sharp edge has about 0.62, a rounded one up to 1"
    )]
    pub discharge: f64,
    /// Density of the fluid, positive.
    #[block(unit = "kg/m^3", positive, default = 860.0)]
    pub density: f64,
    /// Pressure difference $p_l$ of the transition from laminar to turbulent flow, positive.
    #[block(unit = "Pa", positive, default = 1e4)]
    pub p_laminar: f64,
}

impl Opening {
    /// Mineral oil and a sharp edge.
    pub const OIL: Opening = Opening { discharge: 0.62, density: 860.0, p_laminar: 1e4 };

    /// Flow through an area of 1 m^2 at a pressure difference, and its slope.
    pub(crate) fn jet(&self, dp: f64) -> (f64, f64) {
        let factor = self.discharge * (2.0 / self.density).sqrt();
        let sum = dp * dp + self.p_laminar * self.p_laminar;
        let root = sum.sqrt().sqrt();
        (factor * dp / root, factor * (1.0 - 0.5 * dp * dp / sum) / root)
    }

    /// The element between two pins of an opening whose typical area this is.
    pub(crate) fn element(&self, p: Pin, n: Pin, area: f64) -> Element {
        let conductance = area * self.jet(TYPICAL).1;
        Element::Characteristic { p, n, conductance, guess: 0.0 }
    }
}

/// Share of an opening between two pressures: 0 below the first, 1 above the second, smooth in between; and its slope.
pub(crate) fn smooth_share(p: f64, from: f64, to: f64) -> (f64, f64) {
    let x = ((p - from) / (to - from)).clamp(0.0, 1.0);
    (x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) / (to - from))
}

/// Adds the events of an opening that follows something between two values: a step over one of them may see nothing of it.
pub(crate) fn with_ends(part: Part) -> Part {
    part.kink("opens", "opens", "closes").kink("whole", "is fully open", "is no longer fully open")
}

/// Their guards, for what it follows and the two values.
pub(crate) fn ends_of_opening(p: f64, from: f64, to: f64, g: &mut [f64]) {
    g[..2].copy_from_slice(&[p - from, p - to]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jet_has_the_speed_of_torricelli_and_starts_laminar() {
        let oil = Opening::OIL;
        let (q, _) = oil.jet(1e7);
        let turbulent = 0.62 * (2.0 * 1e7 / 860.0_f64).sqrt();
        assert!((q / turbulent - 1.0).abs() < 1e-6, "{q} for {turbulent}");
        assert_eq!(oil.jet(-1e7).0, -q);
        let (q, slope) = oil.jet(1.0);
        assert!((q / slope - 1.0).abs() < 1e-6 && slope > 0.0);
    }

    #[test]
    fn slopes_are_those_of_the_flow() {
        for dp in [-3e6, -1e4, 0.0, 2e3, 1e5, 2e7] {
            let h = 1e-4 * f64::max(1e4, f64::abs(dp));
            let difference = (Opening::OIL.jet(dp + h).0 - Opening::OIL.jet(dp - h).0) / (2.0 * h);
            assert!((difference / Opening::OIL.jet(dp).1 - 1.0).abs() < 1e-6, "{difference} at {dp} Pa");
            let (_, slope) = smooth_share(dp, 1e5, 4e6);
            let difference =
                (smooth_share(dp + h, 1e5, 4e6).0 - smooth_share(dp - h, 1e5, 4e6).0) / (2.0 * h);
            assert!((difference - slope).abs() <= 2e-3 * slope + 1e-8, "{difference} for {slope} at {dp} Pa");
        }
    }

    #[test]
    fn what_is_no_opening_is_refused() {
        assert!(Opening { discharge: 1.2, ..Opening::OIL }.errors()[0].help.is_some());
        assert_eq!(Opening { density: 0.0, ..Opening::OIL }.errors()[0].param, "density");
        assert_eq!(Opening { p_laminar: 0.0, ..Opening::OIL }.errors()[0].param, "p_laminar");
    }
}
