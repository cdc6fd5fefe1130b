use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Cyclic exchange of the phases: a of `ac1` is c of `ac2`, b is a, c is b.
///
/// Between the starts and the ends of three windings it connects them in delta: each winding then lies between two
/// lines.
///
/// ```ron
/// PhasePermute
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Text("abc → bca"))]
pub struct PhasePermute;

impl Component for PhasePermute {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().port("ac1", Domain::ThreePhase, "phases a, b, c").port(
            "ac2",
            Domain::ThreePhase,
            "phases c, a, b of ac1",
        );
        let joined = |(from, to)| Element::Junction { p: Pin::Phase(0, from), n: Pin::Phase(1, to) };
        [(0, 2), (1, 0), (2, 1)].map(joined).into_iter().fold(part, Part::element)
    }
}
