use blocksim_block::prelude::*;

/// Multiplies by a constant: $y = k u$, element by element.
///
/// The unit of the output is that of the input times that of `k`: with `k: "48 V"` a signal without unit becomes
/// a voltage.
///
/// ```ron
/// Gain(k: "48 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Gain("k"))]
pub struct Gain {
    /// Factor.
    pub k: f64,
}

impl Block for Gain {
    fn check(&self) -> Result<(), ParamError> {
        finite("k", self.k)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = u.dimension.map(|dimension| dimension.times(given.parameters.get("k")));
        Ok(Interface::new().input(Input::real("u")).output(Output::like("y", u.of(dimension))))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| self.k * l.element(0, i));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_output_is_the_input_times_k() {
        for (k, u) in [(2.0, 3.0), (-0.5, 4.0), (0.0, 1e300)] {
            assert_eq!(Bench::new(Gain { k }).respond(u), k * u);
        }
    }
}
