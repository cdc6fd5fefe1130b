use blocksim_block::prelude::*;

/// Exchanges the phases b and c of a three-phase signal while `reverse` is true: the field turns the other way.
///
/// $$ y = (a, b, c) \text{ or, reversed, } (a, c, b) $$
///
/// Takes signals of every kind. Swap the reference voltages in front of a `PwmGenerator`, not its gates: it then keeps
/// the dead time. Swapping mirrors the angle of the voltage, which jumps unless phase a is at a peak; a frequency that
/// goes through zero to negative values reverses without a jump.
///
/// ```ron
/// PhaseSwap
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("b ↔ c"))]
pub struct PhaseSwap;

const REVERSE: usize = 1;

impl Block for PhaseSwap {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u").shaped(Shape::Vector(3));
        Ok(Interface::new()
            .input(Input::any("u").shape(Shape::Vector(3)).doc("phases a, b, c"))
            .input(Input::boolean("reverse").scalar().doc("exchanges the phases b and c"))
            .output(Output::like("y", u)))
    }

    fn law(&self, l: &Recording) -> bool {
        let reverse = l.u(REVERSE).is_true();
        let [a, b, c] = [0, 1, 2].map(|i| l.input(0)[i]);
        l.set(0, 0, a);
        l.set(0, 1, reverse.select(c, b));
        l.set(0, 2, reverse.select(b, c));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    #[test]
    fn only_b_and_c_change_places_and_the_unit_stays() {
        let volts = PortType::vector(3).of(Some(dimension("V")));
        let inputs = vec![("u".to_owned(), volts), ("reverse".to_owned(), PortType::boolean())];
        let mut bench = Bench::with_inputs(PhaseSwap, inputs);
        assert_eq!(bench.set(0, &[1.0, 2.0, 3.0]).major(), [1.0, 2.0, 3.0]);
        assert_eq!(bench.set(1, &[1.0]).major(), [1.0, 3.0, 2.0]);
        assert_eq!(bench.interface.outputs[0].port_type, volts);
    }
}
