use crate::math::elements::{borrowed, input_names};
use blocksim_block::prelude::*;

/// Joins scalars and vectors, one behind the other, to one vector.
///
/// All inputs are of one kind. If they are of one unit, so is the vector; else nothing is known of its unit.
///
/// ```ron
/// Mux(inputs: 3)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Bar)]
pub struct Mux {
    /// Number of inputs.
    #[block(at_least = 1, at_most = MOST_PORTS, default = 2)]
    pub inputs: usize,
}

impl Block for Mux {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(self.inputs);
        let names = borrowed(&names);
        let mut kind: Option<(Kind, &str)> = None;
        for name in &names {
            let Some(u) = given.input(name) else { continue };
            if let Shape::Matrix(..) = u.shape {
                return Err(InterfaceError::types(
                    &[name],
                    format!("`{name}` is a {}, which does not fit a vector", u.shape),
                ));
            }
            match kind {
                Some((first, first_name)) if first != u.kind => {
                    let message = format!("`{name}` is {}, but `{first_name}` is {first}", u.kind);
                    return Err(InterfaceError::types(&[name, first_name], message)
                        .help("make numbers of truth values with Convert"));
                }
                _ => kind = Some((u.kind, name)),
            }
        }
        let types: Vec<PortType> = names.iter().map(|name| given.input_or_unknown(name)).collect();
        let meet = |a: Option<Dimension>, b: Option<Dimension>| a.zip(b).and_then(|(a, b)| a.meet(b));
        let dimension = types.iter().map(|u| u.dimension).reduce(meet).flatten();
        let y = PortType {
            kind: kind.map_or(Kind::Real, |(kind, _)| kind),
            shape: Shape::Vector(types.iter().map(|u| u.shape.len()).sum()),
            dimension,
        };
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::any(*name)));
        Ok(interface.output(Output::like("y", y)))
    }

    fn law(&self, l: &Recording) -> bool {
        let elements = (0..l.inputs()).flat_map(|port| l.input(port));
        elements.enumerate().for_each(|(i, u)| l.set(0, i, *u));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    #[test]
    fn scalars_and_vectors_are_joined_in_order() {
        let inputs = vec![
            ("u1".to_owned(), PortType::scalar()),
            ("u2".to_owned(), PortType::vector(2)),
            ("u3".to_owned(), PortType::scalar()),
        ];
        let mut bench = Bench::with_inputs(Mux { inputs: 3 }, inputs);
        assert_eq!(bench.interface.outputs[0].port_type, PortType::vector(4));
        let y = bench.set(0, &[1.0]).set(1, &[2.0, 3.0]).set(2, &[f64::NAN]).major();
        assert!(y[..3] == [1.0, 2.0, 3.0] && y[3].is_nan());
    }

    #[test]
    fn a_common_unit_is_kept_and_mixed_ones_are_forgotten() {
        let unit = |given: &Given| Mux { inputs: 2 }.interface(given).unwrap().outputs[0].port_type.dimension;
        assert_eq!(unit(&given(&[("u1", "V"), ("u2", "mV")], &[])), Some(dimension("V")));
        assert_eq!(unit(&given(&[("u1", "V"), ("u2", "A")], &[])), None);
        assert_eq!(unit(&given(&[("u1", "V")], &[])), None);
    }

    #[test]
    fn kinds_are_not_mixed_and_matrices_do_not_fit() {
        let mux = |u1, u2| {
            let inputs = vec![("u1".to_owned(), u1), ("u2".to_owned(), u2)];
            Mux { inputs: 2 }.interface(&Given::new(inputs, Default::default()))
        };
        let boolean = PortType::boolean();
        assert_eq!(mux(boolean, boolean).unwrap().outputs[0].port_type.kind, Kind::Bool);
        assert_eq!(mux(PortType::scalar(), boolean).unwrap_err().ports, ["u2", "u1"]);
        assert_eq!(mux(PortType::scalar().shaped(Shape::Matrix(2, 2)), boolean).unwrap_err().ports, ["u1"]);
        assert_eq!(Mux { inputs: 0 }.errors()[0].param, "inputs");
    }
}
