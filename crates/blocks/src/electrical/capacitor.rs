use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Capacitor: $i = C \frac{dv}{dt}$. Its voltage is a state.
///
/// In a loop of capacitors and ideal voltages the voltages depend on each other: the charges of the nodes are then what is
/// left of the states. When an ideal switch closes such a loop, the charges divide at once, and what that costs
/// of the energy is heat. In series with a source that a signal commands, the current through both contains the slope of the
/// signal, which is unknown: what depends on it needs a resistance in between.
///
/// ```ron
/// Capacitor(c: "470 uF", v0: "12 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Capacitor)]
pub struct Capacitor {
    /// Capacitance, positive.
    #[block(unit = "F", positive, zero = "without capacitance it connects nothing: leave it out")]
    pub c: f64,
    /// Voltage at the start, from `p` to `n`. Where none is given it follows from ideal voltages around it, else zero.
    #[block(unit = "V", finite, default = None)]
    pub v0: Option<f64>,
}

impl Component for Capacitor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .state_in("v", self.v0.unwrap_or(0.0), "V")
            .element(Element::Capacitance {
                p: Pin::Port(0),
                n: Pin::Port(1),
                capacitance: self.c,
                state: 0,
                start: self.v0,
            })
            .voltage_is(Gives::State(0))
            .reads("v", "V", Reading::State(0), "voltage from p to n")
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.current[0] / self.c;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::stored(0.5 * self.c * c.x[0] * c.x[0])
    }
}
