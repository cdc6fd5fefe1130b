use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Ideal current source that a signal commands: $i$ flows from `p` through the source to `n`, whatever voltage that
/// takes.
///
/// Inductances in series with it take its current; the voltage across them contains its derivative: connect `di` where something
/// measures that voltage.
///
/// ```ron
/// ControlledCurrentSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = CurrentSource)]
pub struct ControlledCurrentSource;

impl Component for ControlledCurrentSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .input(Input::real("i").scalar().unit("A").doc("current from p to n"))
            .input(Input::real("di").scalar().unit("A/s").default(0.0).doc("derivative of i"))
            .rate_input()
            .element(Element::CurrentSource { p: Pin::Port(0), n: Pin::Port(1) })
            .current_is(Gives::Input(0))
    }

    fn current_rates(&self, c: &Moving, di: &mut [f64]) {
        di[0] = c.scalar(1);
    }
}
