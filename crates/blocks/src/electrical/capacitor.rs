use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Capacitor: $i = C \frac{dv}{dt}$. Its voltage is a state.
///
/// In parallel to an ideal voltage source or to another capacitor the voltages cannot be independent: connect them
/// through a resistance.
///
/// ```ron
/// Capacitor(c: "470 uF", v0: "12 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Capacitor)]
pub struct Capacitor {
    /// Capacitance, positive.
    #[block(unit = "F")]
    pub c: f64,
    /// Voltage at the start, from `p` to `n`.
    #[block(unit = "V", default = 0.0)]
    pub v0: f64,
}

impl Block for Capacitor {
    fn check(&self) -> Result<(), ParamError> {
        positive("c", self.c).map_err(|error| match self.c {
            0.0 => error.help("without capacitance it connects nothing: leave it out"),
            _ => error,
        })?;
        finite("v0", self.v0)
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Capacitor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .state("v", self.v0)
            .element(Element::Capacitance { p: Pin::Port(0), n: Pin::Port(1) })
            .measures("v", "V", Needs::State, "voltage from p to n")
    }

    fn voltages(&self, c: &Law, v: &mut [f64]) {
        v[0] = c.x[0];
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        dx[0] = c.current[0] / self.c;
    }

    fn energy(&self, c: &Law) -> Energy {
        Energy::stored(0.5 * self.c * c.x[0] * c.x[0])
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.x[0];
    }
}
