use super::names::{is_name, no_name};
use blocksim_block::prelude::*;

/// Takes elements out of a bus, by paths with points.
///
/// Each output bears the last name of its path. A bus only gives names, so this costs nothing when the diagram runs.
///
/// ```ron
/// BusSelector(elements: ["Joint1OutBus.Angle", "Joint1OutBus.Velo"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Bar)]
pub struct BusSelector {
    /// Paths of the elements.
    #[block(not_empty, empty = "name at least one")]
    pub elements: Vec<String>,
}

/// The last name of a path.
fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

impl BusSelector {
    fn validate(&self, errors: &mut ParamErrors) {
        for (i, path) in self.elements.iter().enumerate() {
            // One by one, for a name may well occur twice in one path.
            for name in path.split('.').filter(|name| !is_name(name)) {
                errors.add(no_name(&format!("elements[{i}]"), "elements", name));
            }
        }
        let names: Vec<&str> = self.elements.iter().map(|path| last(path)).collect();
        for (i, name) in
            names.iter().enumerate().filter(|(i, name)| is_name(name) && names[..*i].contains(name))
        {
            let error = ParamError::new(format!("elements[{i}]"), format!("`elements` names `{name}` twice"));
            let help = "outputs bear the last names of the paths; use a second BusSelector for the same name";
            errors.add(error.help(help));
        }
    }
}

impl Block for BusSelector {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let interface = Interface::new().input(Input::any("u"));
        Ok(self
            .elements
            .iter()
            .fold(interface, |interface, path| interface.output(Output::like(last(path), PortType::UNKNOWN))))
    }

    fn bus(&self) -> Option<Bus> {
        Some(Bus::Select(self.elements.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn selector(elements: &[&str]) -> BusSelector {
        BusSelector { elements: elements.iter().map(ToString::to_string).collect() }
    }

    #[test]
    fn the_outputs_bear_the_last_names_of_the_paths() {
        let block = selector(&["Joint1OutBus.Angle", "Time"]);
        let interface = block.interface(&Given::nothing()).unwrap();
        let names: Vec<_> = interface.outputs.iter().map(|output| output.name.as_str()).collect();
        assert_eq!(names, ["Angle", "Time"]);
        assert_eq!(block.bus(), Some(Bus::Select(block.elements.clone())));
    }

    #[test]
    fn paths_are_made_of_names_and_end_differently() {
        assert!(selector(&["A.A.B", "A.C"]).errors().is_empty());
        for elements in [&[][..], &["a.x", "b.x"], &["a..x"], &["a.x."], &["a x"]] {
            assert!(selector(elements).errors()[0].param.starts_with("elements"), "{elements:?}");
        }
    }
}
