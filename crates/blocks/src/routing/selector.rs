use blocksim_block::prelude::*;

/// Picks elements of a vector by their index, counted from 0, in the given order; an element may be picked twice.
///
/// One index gives a scalar.
///
/// ```ron
/// Selector(indices: [2, 0])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Text("u[i]"))]
pub struct Selector {
    /// Indices, counted from 0.
    #[block(not_empty, empty = "name at least one")]
    pub indices: Vec<usize>,
}

impl Block for Selector {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let length = given.input("u").map_or(usize::MAX, |u| u.shape.len());
        if let Some(index) = self.indices.iter().find(|index| **index >= length) {
            let message = format!("`u` is a {}, so it has no element {index}", u.shape);
            return Err(InterfaceError::types(&["u"], message).help("elements are counted from 0"));
        }
        let shape = if self.indices.len() == 1 { Shape::Scalar } else { Shape::Vector(self.indices.len()) };
        Ok(Interface::new().input(Input::any("u")).output(Output::like("y", u.shaped(shape))))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.input(0).get(self.indices[i]).copied().unwrap_or_else(|| l.constant(f64::NAN)));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    fn bench(indices: &[usize]) -> Bench {
        let u = PortType::vector(3).of(Some(dimension("V")));
        Bench::with_inputs(Selector { indices: indices.to_vec() }, vec![("u".to_owned(), u)])
    }

    #[test]
    fn elements_come_out_in_the_order_of_the_indices() {
        assert_eq!(bench(&[2, 0, 2]).set(0, &[1.0, 2.0, 3.0]).major(), [3.0, 1.0, 3.0]);
    }

    #[test]
    fn one_index_gives_a_scalar_of_the_same_unit() {
        let mut bench = bench(&[1]);
        assert_eq!(bench.interface.outputs[0].port_type, PortType::scalar().of(Some(dimension("V"))));
        assert_eq!(bench.set(0, &[1.0, 2.0, 3.0]).major(), [2.0]);
    }

    #[test]
    fn an_index_behind_the_end_is_refused() {
        let given = Given::new(vec![("u".to_owned(), PortType::vector(3))], Default::default());
        let error = Selector { indices: vec![3] }.interface(&given).unwrap_err();
        assert_eq!(error.message, "`u` is a vector of 3, so it has no element 3");
        assert!(
            Selector { indices: vec![3] }.interface(&Given::nothing()).is_ok(),
            "the length is not known yet"
        );
        assert_eq!(Selector { indices: vec![] }.errors()[0].param, "indices");
    }
}
