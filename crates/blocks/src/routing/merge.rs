use crate::math::elements::{numbered, parameters_like};
use blocksim_block::Merging;
use blocksim_block::prelude::*;

/// Passes the output of whichever conditional subsystem runs: one signal from several alternatives.
///
/// Each input comes from an output of a subsystem with `enable` or `trigger`; these are best chosen by one `IfElse` or `SwitchCase`, so
/// that one runs at a time. While none runs, the output holds what it gave last, exactly at the time at which the last one stopped.
/// Before any has run, it gives `initial`; without `initial` the run ends there with an error. Two that run at the same time end the
/// run with an error, too. All inputs are of one kind and unit.
///
/// An input counts as running while the outermost conditional subsystem that it comes from does, as seen from where the Merge stands.
///
/// ```ron
/// Merge(inputs: 2, initial: 0)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Text("merge"))]
pub struct Merge {
    /// Number of inputs `u1`, `u2` ... to choose from.
    #[block(at_least = 2, at_most = 1000, default = 2)]
    pub inputs: usize,
    /// Output before any of the subsystems has run, in the unit of the inputs; an error ends the run if it is not given.
    #[block(finite, default = None)]
    pub initial: Option<f64>,
}

impl Block for Merge {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = numbered("u", self.inputs);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let y = PortType {
            kind: given.common_kind(&names)?.unwrap_or(Kind::Real),
            shape: given.common_shape(&names, &[])?,
            dimension: given.common_dimension(&names)?,
        };
        let dimension = match self.initial {
            Some(initial) if y.kind == Kind::Bool && initial != 0.0 && initial != 1.0 => {
                let message = format!("`u1` is true or false, but `initial` is {initial}");
                return Err(InterfaceError::types(&["u1"], message).help("write 0 for false or 1 for true"));
            }
            Some(_) => parameters_like(given, "u1", y.dimension, &["initial"])?,
            None => y.dimension,
        };
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::any(*name)));
        Ok(interface.output(Output::like("y", y.of(dimension))).merges(Merging { initial: self.initial }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_is_of_the_type_of_the_inputs() {
        let of = |u1, u2, initial| {
            let inputs = vec![("u1".to_owned(), u1), ("u2".to_owned(), u2)];
            Merge { inputs: 2, initial }.interface(&Given::new(inputs, Default::default()))
        };
        let (real, truth) = (PortType::vector(2), PortType::boolean());
        let y = of(real, PortType::scalar(), None).unwrap().outputs[0].port_type;
        assert_eq!((y.kind, y.shape.len()), (Kind::Real, 2));
        assert_eq!(of(truth, truth, Some(1.0)).unwrap().outputs[0].port_type.kind, Kind::Bool);
        assert_eq!(of(real, truth, None).unwrap_err().ports, ["u2", "u1"]);
        assert_eq!(of(truth, truth, Some(2.0)).unwrap_err().ports, ["u1"]);
        assert_eq!(Merge { inputs: 1, initial: None }.errors()[0].param, "inputs");
        assert_eq!(Merge { inputs: 2, initial: Some(f64::NAN) }.errors()[0].param, "initial");
    }
}
