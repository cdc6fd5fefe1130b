use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Ideal transformer whose ratio a signal commands: $v_1 = n v_2$, $i_2 = -n i_1$, at all frequencies, also for direct
/// current.
///
/// Both currents count into the positive pins. It stores and loses nothing, whatever the ratio and however it changes. With
/// $n = 0$ the first side is short-circuited and the second one carries no current. It is the mean of what a converter does
/// that switches the first side between the pins of the second one during the share $n$ of its time: a step-down
/// converter between a source at `p2`, `n2` and a load at `p1`, `n1`.
///
/// The second side needs something that determines its voltage: a source, or a capacitor.
///
/// ```ron
/// VariableTransformer
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Transformer)]
pub struct VariableTransformer;

impl Component for VariableTransformer {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("p1", Domain::Electrical, "positive pin of the first side")
            .port("n1", Domain::Electrical, "negative pin of the first side")
            .port("p2", Domain::Electrical, "positive pin of the second side")
            .port("n2", Domain::Electrical, "negative pin of the second side")
            .input(
                Input::real("ratio")
                    .scalar()
                    .unit("1")
                    .doc("voltage of the first side over that of the second"),
            )
            .element(Element::VariableTransformer {
                primary: (Pin::Port(0), Pin::Port(1)),
                secondary: (Pin::Port(2), Pin::Port(3)),
            })
            .measures("i1", "A", Needs::Electrics, "current from p1 to n1")
            .measures("i2", "A", Needs::Electrics, "current from p2 to n2")
    }

    fn ratios(&self, c: &Known, ratio: &mut [f64]) {
        ratio[0] = c.scalar(0);
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.current[1]]);
    }
}
