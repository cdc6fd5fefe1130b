use blocksim_block::prelude::*;

/// The time of the simulation: $y = t$, in s.
///
/// ```ron
/// Clock
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Text("t"))]
pub struct Clock;

impl Block for Clock {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new().output(Output::real("y").unit("s")))
    }

    fn law(&self, l: &Recording) -> bool {
        l.set(0, 0, l.time());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_output_is_the_time_in_seconds() {
        let mut bench = Bench::new(Clock);
        bench.t = 0.25;
        assert_eq!(bench.minor(), [0.25]);
        assert_eq!(bench.interface.outputs[0].port_type.dimension, Some(dimension("s")));
        assert!(bench.interface.uses_time);
    }
}
