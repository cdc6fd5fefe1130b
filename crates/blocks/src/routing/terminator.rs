use blocksim_block::prelude::*;

/// Takes a signal of any kind and does nothing with it: shows that an output is left open on purpose.
///
/// ```ron
/// Terminator
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Terminator)]
pub struct Terminator;

impl Block for Terminator {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new().input(Input::any("u")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_everything_and_gives_nothing() {
        let interface = Terminator.interface(&Given::nothing()).unwrap();
        assert_eq!(interface, Interface::new().input(Input::any("u")));
    }
}
