use super::names::validate_names;
use blocksim_block::prelude::*;

/// Gives signals names and bundles them to a bus.
///
/// The inputs bear the names of the elements; an element may be a bus itself. A bus only gives names and costs nothing
/// when the diagram runs; its elements keep their units and sample times.
///
/// ```ron
/// BusCreator(elements: ["Angle", "Velo"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Bar)]
pub struct BusCreator {
    /// Names of the elements.
    pub elements: Vec<String>,
}

impl BusCreator {
    fn validate(&self, errors: &mut ParamErrors) {
        validate_names("elements", self.elements.iter().map(String::as_str), errors);
    }
}

impl Block for BusCreator {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let inputs =
            self.elements.iter().fold(Interface::new(), |interface, name| interface.input(Input::any(name)));
        Ok(inputs.output(Output::like("y", PortType::UNKNOWN)))
    }

    fn bus(&self) -> Option<Bus> {
        Some(Bus::Create(self.elements.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn creator(elements: &[&str]) -> BusCreator {
        BusCreator { elements: elements.iter().map(ToString::to_string).collect() }
    }

    #[test]
    fn the_inputs_bear_the_names_of_the_elements() {
        let block = creator(&["Angle", "Velo"]);
        let interface = block.interface(&Given::nothing()).unwrap();
        let names: Vec<_> = interface.inputs.iter().map(|input| input.name.clone()).collect();
        assert_eq!(block.bus(), Some(Bus::Create(names)));
        assert_eq!(interface.outputs[0].name, "y");
    }

    #[test]
    fn elements_are_names_that_differ() {
        for (elements, param) in
            [(&[][..], "elements"), (&["a", "a"], "elements[1]"), (&["a.b"], "elements[0]")]
        {
            assert_eq!(creator(elements).errors()[0].param, param);
        }
    }
}
