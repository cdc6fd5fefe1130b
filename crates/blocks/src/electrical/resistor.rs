use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Resistor: $v = R i$.
///
/// ```ron
/// Resistor(r: "10 Ohm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Resistor)]
pub struct Resistor {
    /// Resistance, positive: for zero use a wire (join the pins), for infinity nothing.
    #[block(unit = "Ohm")]
    pub r: f64,
}

impl Block for Resistor {
    fn check(&self) -> Result<(), ParamError> {
        positive("r", self.r).map_err(|error| match self.r {
            0.0 => error.help("a resistance of zero is a wire: join the two nodes instead"),
            _ => error,
        })
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Resistor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .element(Element::Resistance { p: Pin::Port(0), n: Pin::Port(1), resistance: self.r })
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .measures("i", "A", Needs::Electrics, "current from p to n")
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y.copy_from_slice(&[c.voltage[0], c.current[0]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resistances_that_are_none_are_refused() {
        assert!(Resistor { r: -1.0 }.check().is_err());
        assert!(Resistor { r: 0.0 }.check().unwrap_err().help.is_some());
    }
}
