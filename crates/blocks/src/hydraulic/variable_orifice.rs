use blocksim_block::physical::{Characteristics, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;
use super::opening::{Opening, ends_of_opening, with_ends};

/// The opening.
const EDGE: Handle = Handle::new("edge");

/// Orifice whose area a signal commands, as an ideal two-way valve: $A = A_l + \min(\max(s, 0), 1)\,(A_{max} - A_l)$.
///
/// $$ q = C_d A \sqrt{\frac{2}{\rho}}\; \frac{\Delta p}{(\Delta p^2 + p_l^2)^{1/4}}, \qquad \Delta p = p_a - p_b $$
///
/// Closed, the leakage area $A_l$ is left.
///
/// ```ron
/// VariableOrifice(area: "8 mm^2")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 3.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = VariableRestriction)]
pub struct VariableOrifice {
    /// Area of the whole opening $A_{max}$, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
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

impl VariableOrifice {
    fn area(&self, c: &Known) -> f64 {
        self.leakage + c.scalar(0).clamp(0.0, 1.0) * (self.area - self.leakage)
    }
}

impl Component for VariableOrifice {
    fn part(&self, _given: &Given) -> Part {
        let part = ends()
            .input(Input::real("s").scalar().unit("1").doc("how far it is open: 0 to 1"))
            .named(EDGE, self.opening.element(Pin::Port(0), Pin::Port(1), self.area))
            .reads("q", "m^3/s", Reading::Current(EDGE), "volume flow from a to b");
        with_ends(part)
    }

    fn characteristics(&self, c: &Moving, curves: &mut Characteristics) {
        let (area, (q, slope)) = (self.area(c), self.opening.jet(curves.voltage(EDGE)));
        curves.current(EDGE, area * q);
        curves.slope(EDGE, EDGE, area * slope);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        ends_of_opening(c.scalar(0), 0.0, 1.0, g);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(EDGE) * c.current(EDGE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const VALVE: VariableOrifice = VariableOrifice { area: 8e-6, leakage: 1e-12, opening: Opening::OIL };

    #[test]
    fn the_area_follows_the_signal_between_its_ends() {
        let at = |s: f64| VALVE.area(&Seen { u: &[s], inputs: &[(0, 1)], ..law() }.loaded());
        assert_eq!((at(-1.0), at(0.0)), (1e-12, 1e-12));
        assert!((at(1.0) - 8e-6).abs() < 1e-20 && at(7.0) == at(1.0));
        assert!((at(0.5) - 4e-6).abs() < 1e-11);
    }

    #[test]
    fn a_valve_that_cannot_close_or_does_not_leak_is_refused() {
        assert!(VariableOrifice { leakage: 0.0, ..VALVE }.errors()[0].help.is_some());
        assert_eq!(VariableOrifice { leakage: 9e-6, ..VALVE }.errors()[0].param, "leakage");
        assert_eq!(VALVE.errors()[..], []);
    }
}
