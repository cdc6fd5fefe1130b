use super::names::check_names;
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
    pub elements: Vec<String>,
}

/// The last name of a path.
fn last(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

impl Block for BusSelector {
    fn check(&self) -> Result<(), ParamError> {
        for path in &self.elements {
            // One by one, for a name may well occur twice in one path.
            path.split('.').try_for_each(|name| check_names("elements", [name]))?;
        }
        check_names("elements", self.elements.iter().map(|path| last(path))).map_err(|error| {
            error.help("outputs bear the last names of the paths; use a second BusSelector for the same name")
        })
    }

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
        assert!(selector(&["A.A.B", "A.C"]).check().is_ok());
        for elements in [&[][..], &["a.x", "b.x"], &["a..x"], &["a.x."], &["a x"]] {
            assert_eq!(selector(elements).check().unwrap_err().param, "elements", "{elements:?}");
        }
    }
}
