use blocksim_block::prelude::*;

/// Absolute value: $y = |u|$, element by element.
///
/// The solver steps onto the kink at zero.
///
/// ```ron
/// Abs
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("|u|"))]
pub struct Abs;

impl Block for Abs {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let interface = Interface::new().input(Input::real("u")).output(Output::like("y", u));
        Ok(interface.kink_each("zero", u.shape.len()).called("turns positive", "turns negative"))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.element(0, i).abs());
        (0..l.width(0)).for_each(|i| l.guard(i, l.element(0, i)));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn each_element_loses_its_sign_and_is_guarded() {
        let mut bench = Bench::with_inputs(Abs, vec![("u".to_owned(), PortType::vector(3))]);
        assert_eq!(bench.set(0, &[-2.0, 0.0, 3.0]).major(), [2.0, 0.0, 3.0]);
        assert_eq!(bench.guards(), [-2.0, 0.0, 3.0]);
        assert!(bench.set(0, &[f64::NAN; 3]).major()[0].is_nan());
    }

    #[test]
    fn the_unit_stays() {
        let interface = Abs.interface(&given(&[("u", "V")], &[])).unwrap();
        assert_eq!(interface.outputs[0].port_type.dimension, Some(dimension("V")));
        assert_eq!(interface.guards[0].name, "zero");
    }
}
