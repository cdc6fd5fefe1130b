use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Ideal transformer: $v_1 = n v_2$, $i_2 = -n i_1$, at all frequencies, also for direct current.
///
/// Both currents count into the positive pins. It stores and loses nothing. Nothing connects its sides electrically: the
/// circuit of each needs a reference of its own. One whose current of magnetisation ends the passing of direct
/// current is `Transformer`.
///
/// ```ron
/// IdealTransformer(ratio: 10)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Transformer)]
pub struct IdealTransformer {
    /// Turns of the first winding over turns of the second; negative for the other sense.
    #[block(
        unit = "1",
        not_zero,
        zero = "write the turns of the first winding over those of the second, negative for the other sense"
    )]
    pub ratio: f64,
}

impl Component for IdealTransformer {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("p1", Domain::Electrical, "positive pin of the first winding")
            .port("n1", Domain::Electrical, "negative pin of the first winding")
            .port("p2", Domain::Electrical, "positive pin of the second winding")
            .port("n2", Domain::Electrical, "negative pin of the second winding")
            .element(Element::IdealTransformer {
                primary: (Pin::Port(0), Pin::Port(1)),
                secondary: (Pin::Port(2), Pin::Port(3)),
                ratio: self.ratio,
            })
            .measures("i1", "A", Needs::Electrics, "current from p1 to n1")
            .measures("i2", "A", Needs::Electrics, "current from p2 to n2")
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current[0], c.current[1]]);
    }
}
