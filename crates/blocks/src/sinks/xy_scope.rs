use blocksim_block::RecordRequest;
use blocksim_block::prelude::*;
use blocksim_signal::Unit;

/// Records two signals and shows one over the other: `y` over `x`, as in a phase plane or for the path of a tool.
///
/// Both may be vectors of one length, of which each pair of elements is a curve; one `x` alone counts for all. Where both are shown
/// in the same unit, and neither is much larger than the other, lengths are the same in both directions, so that circles are round.
/// `label` gives the picture a title. Both signals are in the recording as those of a Scope.
///
/// ```ron
/// XyScope(display_x: "deg", display_y: "deg/s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sinks", symbol = Scope)]
pub struct XyScope {
    /// Unit in which `x` is shown; SI without.
    #[block(a_unit, default = None)]
    pub display_x: Option<String>,
    /// Unit in which `y` is shown; SI without.
    #[block(a_unit, default = None)]
    pub display_y: Option<String>,
    /// A text for `y` in the legend.
    #[block(default = None)]
    pub legend: Option<String>,
}

/// Number of the input to the right.
const X: usize = 0;

impl XyScope {
    /// Inputs with the parameters that say their units.
    fn displays(&self) -> [(&'static str, &'static str, &Option<String>); 2] {
        [("x", "display_x", &self.display_x), ("y", "display_y", &self.display_y)]
    }
}

impl Block for XyScope {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        given.common_shape(&["x", "y"], &[])?;
        let (x, y) = (given.input_or_unknown("x").shape.len(), given.input_or_unknown("y").shape.len());
        if x > 1 && y == 1 {
            let message = format!("`x` has {x} elements, but `y` has one");
            return Err(InterfaceError::types(&["x", "y"], message)
                .help("show several signals over one: connect the single one to `x`"));
        }
        let mut interface = Interface::new();
        for (name, _, display) in self.displays() {
            interface = interface.input(Input::any(name));
            let unit = display.as_ref().and_then(|text| Unit::parse(text).ok());
            let shown = given.input_or_unknown(name);
            if let (Some(unit), Some(dimension), Kind::Real) = (unit, shown.dimension, shown.kind)
                && !unit.dimension.compatible(dimension)
            {
                let message = format!("`{name}` is in {dimension}, which cannot be shown in {}", unit.text);
                return Err(InterfaceError::units(&[name], message)
                    .help("write a unit of the same kind, or leave it away"));
            }
        }
        let legend = self.legend.iter().flat_map(|text| ["x".to_owned(), text.clone()]).collect();
        Ok(interface.records(RecordRequest {
            display: None,
            displays: vec![self.display_x.clone(), self.display_y.clone()],
            legend,
            over: Some(X),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::given;

    fn scope(x: Option<&str>, y: Option<&str>) -> XyScope {
        XyScope { display_x: x.map(str::to_owned), display_y: y.map(str::to_owned), legend: None }
    }

    #[test]
    fn both_are_recorded_in_their_units_and_y_over_x() {
        let interface = scope(Some("deg"), None).interface(&given(&[("x", "rad"), ("y", "V")], &[])).unwrap();
        let recorded = interface.recorded.unwrap();
        assert_eq!((recorded.over, recorded.displays), (Some(0), vec![Some("deg".to_owned()), None]));
    }

    #[test]
    fn units_and_shapes_must_fit() {
        let error = scope(None, Some("deg")).interface(&given(&[("x", "rad"), ("y", "V")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports), ("unit_mismatch", vec!["y".to_owned()]));
        assert_eq!(scope(None, Some("degg")).errors()[0].param, "display_y");
        let of = |x: usize, y: usize| {
            let port = |n| if n == 1 { PortType::scalar() } else { PortType::vector(n) };
            let inputs = vec![("x".to_owned(), port(x)), ("y".to_owned(), port(y))];
            scope(None, None).interface(&Given::new(inputs, Default::default()))
        };
        assert!(of(1, 3).is_ok() && of(3, 3).is_ok());
        assert_eq!([of(3, 1), of(2, 3)].map(|error| error.unwrap_err().code), ["type_mismatch"; 2]);
    }
}
