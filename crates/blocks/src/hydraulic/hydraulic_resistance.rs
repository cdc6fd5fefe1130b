use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;

/// What fluid flows through.
const GAP: Handle = Handle::new("gap");

/// Laminar hydraulic resistance: $p_a - p_b = R q$.
///
/// A pipe of the length $l$ and the diameter $d$ has $R = 128 \rho \nu l / (\pi d^4)$ (Hagen and Poiseuille), a gap between plates of the
/// height $h$ and the width $b$ has $R = 12 \rho \nu l / (b h^3)$. A sharp edge is an `Orifice`.
///
/// ```ron
/// HydraulicResistance(r: "2e9 Pa*s/m^3")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 3.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Resistor)]
pub struct HydraulicResistance {
    /// Resistance, positive: for zero join the ports, for infinity leave it out.
    #[block(
        unit = "Pa*s/m^3",
        positive,
        zero = "without resistance both sides have one pressure: join the two nodes instead"
    )]
    pub r: f64,
}

impl Component for HydraulicResistance {
    fn part(&self, _given: &Given) -> Part {
        ends().named(GAP, Element::Resistance { p: Pin::Port(0), n: Pin::Port(1), resistance: self.r }).reads(
            "q",
            "m^3/s",
            Reading::Current(GAP),
            "volume flow from a to b",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resistances_that_are_none_are_refused() {
        assert!(HydraulicResistance { r: 0.0 }.errors()[0].help.is_some());
        assert_eq!(HydraulicResistance { r: f64::INFINITY }.errors()[0].param, "r");
    }
}
