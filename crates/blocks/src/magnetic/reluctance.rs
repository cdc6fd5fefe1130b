use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::poles;

/// The way of the flux.
const PATH: Handle = Handle::new("path");

/// Reluctance of a path of the flux: $V_m = R_m \Phi$ with the magnetic potential difference $V_m$ from `p` to `n`.
///
/// A path of the length $l$, the cross-section $A$ and the relative permeability $\mu_r$ has
///
/// $$ R_m = \frac{l}{\mu_0 \mu_r A} $$
///
/// so an air gap of 0.5 mm and 1 cm^2 is `r: "0.5e-3 / (4e-7 * pi * 1e-4) 1/H"`. Iron that saturates is `MagneticCore`. The field
/// stores $V_m \Phi / 2$.
///
/// ```ron
/// Reluctance(r: "4e6 1/H")
/// ```
///
/// Source: H. C. Roters, *Electromagnetic Devices* (1941), for the reluctances of flux paths.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Resistor)]
pub struct Reluctance {
    /// Reluctance, positive: for zero join the poles, for infinity leave it out.
    #[block(
        unit = "1/H",
        positive,
        zero = "without reluctance both poles have one potential: join the two nodes instead"
    )]
    pub r: f64,
}

impl Component for Reluctance {
    fn part(&self, _given: &Given) -> Part {
        poles()
            .named(PATH, Element::Resistance { p: Pin::Port(0), n: Pin::Port(1), resistance: self.r })
            .reads("flux", "Wb", Reading::Current(PATH), "flux from p to n")
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let flux = c.voltage(PATH) / self.r;
        Energy::stored(0.5 * self.r * flux * flux)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reluctances_that_are_none_are_refused() {
        assert!(Reluctance { r: 0.0 }.errors()[0].help.is_some());
        assert_eq!(Reluctance { r: -1.0 }.errors()[0].param, "r");
        assert_eq!(Reluctance { r: f64::INFINITY }.errors()[0].param, "r");
    }
}
