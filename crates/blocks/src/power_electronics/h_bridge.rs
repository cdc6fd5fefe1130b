use blocksim_block::physical::{Domain, Pin};
use blocksim_block::prelude::*;

use super::valve::{Device, Valve};

/// Bridge of four switches between a DC link and two pins: a DC motor between `a` and `b` runs in both directions.
///
/// `gates` are those of a+, a-, b+, b-, as `HBridgePwm` makes them: upper and lower switch of the leg whose middle is
/// `a`, then of that whose middle is `b`.
///
/// ```ron
/// HBridge(device: Mosfet, r_on: "5 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Transistor)]
pub struct HBridge {
    /// `Igbt` or `Mosfet`, both with diodes in parallel, or `Contact`.
    #[block(default = Device::Mosfet)]
    pub device: Device,
    /// Properties of each switch while on and off.
    #[block(group)]
    pub valve: Valve,
}

impl Component for HBridge {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .pins()
            .port("a", Domain::Electrical, "middle of the first leg")
            .port("b", Domain::Electrical, "middle of the second leg")
            .input(Input::boolean("gates").shape(Shape::Vector(4)).doc("a+, a-, b+, b-"));
        [2, 3]
            .into_iter()
            .flat_map(|port| {
                let (middle, valve) = (Pin::Port(port), self.valve);
                let upper = self.device.elements(&valve, Pin::Port(0), middle);
                upper.into_iter().chain(self.device.elements(&valve, middle, Pin::Port(1)))
            })
            .fold(part, Part::element)
            .heat_port(self.valve.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        self.device.gates(c.input(0), on);
    }
}
