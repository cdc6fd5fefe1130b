use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What conducts.
const BODY: Handle = Handle::new("body");

/// Thermal resistance: $T_a - T_b = R q$.
///
/// Conduction through a wall of the thickness $d$, area $A$ and conductivity $\lambda$ has $R = d / (\lambda A)$, convection at a
/// surface with the heat transfer coefficient $h$ has $R = 1 / (h A)$: `r: "1 / (25 * 0.04) K/W"`. Radiation between surfaces is
/// `ThermalRadiation`.
///
/// ```ron
/// ThermalResistance(r: "0.5 K/W")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Resistor)]
pub struct ThermalResistance {
    /// Thermal resistance, positive: for zero join the ports, for infinity leave it out.
    #[block(
        unit = "K/W",
        positive,
        zero = "without resistance both sides have one temperature: join the two nodes instead"
    )]
    pub r: f64,
}

impl Component for ThermalResistance {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Thermal, "thermal port that heat enters by")
            .port("b", Domain::Thermal, "thermal port that it leaves by")
            .named(BODY, Element::Resistance { p: Pin::Port(0), n: Pin::Port(1), resistance: self.r })
            .reads("q", "W", Reading::Current(BODY), "heat flow from a to b")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resistances_that_are_none_are_refused() {
        assert!(ThermalResistance { r: 0.0 }.errors()[0].help.is_some());
        assert_eq!(ThermalResistance { r: f64::INFINITY }.errors()[0].param, "r");
    }
}
