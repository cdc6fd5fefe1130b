use blocksim_block::physical::{Element, Pin, ValveKind};
use blocksim_block::prelude::*;

use super::valve::Valve;

/// Resistor that a transistor connects between the rails of a DC link, to burn what a braking machine feeds into it.
///
/// `ChopperControl` makes `gate` from the voltage of the link. A diode in parallel to the resistor lets the current of its
/// inductance, if it has any, run on; this one has none.
///
/// ```ron
/// BrakeChopper(r: "33 Ohm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Power electronics", symbol = Transistor)]
pub struct BrakeChopper {
    /// Resistance, positive.
    #[block(unit = "Ohm", positive, remedy = "without resistance it would short-circuit the link")]
    pub r: f64,
    /// Resistance of the transistor while it conducts.
    #[block(unit = "Ohm", not_negative, default = 0.01)]
    pub r_on: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for BrakeChopper {
    fn part(&self, _given: &Given) -> Part {
        let (middle, valve) =
            (Pin::Inner(0), Valve { r_on: self.r_on, v_f: 0.0, g_off: 0.0, heat_port: self.heat_port });
        Part::new()
            .pins()
            .input(Input::boolean("gate").scalar().doc("turns the resistor on"))
            .element(Element::Resistance { p: Pin::Port(0), n: middle, resistance: self.r })
            .element(valve.element(middle, Pin::Port(1), ValveKind::Switch))
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .measures("power", "W", Needs::Electrics, "power that the resistor turns into heat")
            .heat_port(self.heat_port)
    }

    fn gates(&self, c: &Known, on: &mut [bool]) {
        on[0] = c.scalar(0) != 0.0;
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let i = c.current[0];
        y.copy_from_slice(&[i, self.r * i * i]);
    }
}
