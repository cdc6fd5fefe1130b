use crate::math::elements::numbered;
use blocksim_block::prelude::*;

/// Splits a vector into parts, one behind the other: equal parts, or parts of the given sizes.
///
/// A part of one element is a scalar.
///
/// ```ron
/// Demux(sizes: [3, 1, 2])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Bar)]
pub struct Demux {
    /// Number of equal parts, if there are no `sizes`.
    #[block(at_least = 1, at_most = MOST_PORTS, default = 2)]
    pub outputs: usize,
    /// Number of elements of each part.
    #[block(at_least = 1, default = Vec::new())]
    pub sizes: Vec<usize>,
}

impl Demux {
    /// Sizes of the parts of a vector of `length`; scalars while the length is not known.
    fn parts(&self, length: Option<usize>) -> Result<Vec<usize>, InterfaceError> {
        let refuse = |length, parts: String| {
            InterfaceError::types(&["u"], format!("`u` has {length} elements, which do not make {parts}"))
        };
        match length {
            None if self.sizes.is_empty() => Ok(vec![1; self.outputs]),
            None => Ok(self.sizes.clone()),
            Some(length) if self.sizes.is_empty() => {
                if length == 0 || length % self.outputs != 0 {
                    return Err(
                        refuse(length, format!("{} equal parts", self.outputs)).help("give the `sizes`")
                    );
                }
                Ok(vec![length / self.outputs; self.outputs])
            }
            Some(length) if self.sizes.iter().sum::<usize>() != length => {
                Err(refuse(length, format!("parts of {:?}", self.sizes))
                    .help("the `sizes` must add up to the length"))
            }
            Some(_) => Ok(self.sizes.clone()),
        }
    }
}

impl Block for Demux {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let parts = self.parts(given.input("u").map(|u| u.shape.len()))?;
        let mut interface = Interface::new().input(Input::any("u"));
        for (name, size) in numbered("y", parts.len()).into_iter().zip(parts) {
            let shape = if size == 1 { Shape::Scalar } else { Shape::Vector(size) };
            interface = interface.output(Output::like(name, u.shaped(shape)));
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let mut elements = l.input(0).iter();
        (0..l.outputs()).for_each(|port| {
            l.each(port, |_| elements.next().copied().unwrap_or_else(|| l.constant(f64::NAN)))
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    fn interface(block: &Demux, u: PortType) -> Result<Interface, InterfaceError> {
        block.interface(&Given::new(vec![("u".to_owned(), u)], Default::default()))
    }

    #[test]
    fn parts_of_the_given_sizes_keep_kind_and_unit() {
        let block = Demux { outputs: 2, sizes: vec![2, 1] };
        let u = PortType::vector(3).of(Some(dimension("V")));
        let outputs = interface(&block, u).unwrap().outputs;
        assert_eq!(outputs.iter().map(|y| y.name.as_str()).collect::<Vec<_>>(), ["y1", "y2"]);
        assert_eq!(outputs[0].port_type, u.shaped(Shape::Vector(2)));
        assert_eq!(outputs[1].port_type, u.shaped(Shape::Scalar));
    }

    #[test]
    fn elements_keep_their_order() {
        let block = Demux { outputs: 3, sizes: vec![] };
        let mut bench = Bench::with_inputs(block, vec![("u".to_owned(), PortType::vector(6))]);
        assert_eq!(bench.interface.outputs[2].port_type.shape, Shape::Vector(2));
        let u = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(bench.set(0, &u).major(), u);
    }

    #[test]
    fn names_of_outputs_are_known_before_the_input() {
        let names =
            |outputs, sizes| Demux { outputs, sizes }.interface(&Given::nothing()).unwrap().outputs.len();
        assert_eq!((names(3, vec![]), names(2, vec![1, 2, 3, 4])), (3, 4));
    }

    #[test]
    fn parts_must_make_up_the_whole() {
        for block in [Demux { outputs: 2, sizes: vec![] }, Demux { outputs: 2, sizes: vec![1, 3] }] {
            let error = interface(&block, PortType::vector(5)).unwrap_err();
            assert_eq!((error.code, error.ports), ("type_mismatch", vec!["u".to_owned()]));
        }
        assert_eq!(Demux { outputs: 2, sizes: vec![1, 0] }.errors()[0].param, "sizes[1]");
        assert_eq!(Demux { outputs: 0, sizes: vec![] }.errors()[0].param, "outputs");
    }
}
