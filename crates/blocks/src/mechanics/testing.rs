//! What the law of a component sees, for tests of single components.

use blocksim_block::physical::Law;

/// Everything at rest, up to four scalar inputs, nothing connected; to be completed by `Law { x: &[..],
/// ..law() }`.
pub(crate) fn law() -> Law<'static> {
    Law { inputs: &[(0, 1), (1, 2), (2, 3), (3, 4)], ..Law::nothing() }
}
