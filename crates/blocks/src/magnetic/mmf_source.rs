use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

use super::poles;

/// Source of a magnetic potential difference that a signal commands, whatever flux that drives: an ideal winding with a current that
/// is given, times its turns; or a permanent magnet, $V_m = H_c l$ in series with the reluctance of its volume. An `EnergyAccount` cannot book
/// what it supplies and refuses it.
///
/// ```ron
/// MmfSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = VoltageSource)]
pub struct MmfSource;

impl Component for MmfSource {
    fn part(&self, _given: &Given) -> Part {
        poles()
            .input(Input::real("v").scalar().unit("A").doc("magnetic potential difference from p to n"))
            .element(Element::VoltageSource { p: Pin::Port(0), n: Pin::Port(1) })
            .voltage_is(Gives::Input(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_potential_difference_is_the_input() {
        let mut v = [0.0];
        let part = MmfSource.part(&Given::nothing());
        part.write_voltages(&MmfSource, &Seen { u: &[-250.0], ..law() }.loaded(), &mut v);
        assert_eq!(v, [-250.0]);
    }
}
