use super::elements::parameters_like;
use blocksim_block::prelude::*;

/// Passes `u1` while the control input is true or at least the threshold, else `u3`; element by element.
///
/// `u1` and `u3` are of one kind and unit. Which one is passed is chosen where the solver stops, and it stops where a
/// real control signal crosses the threshold; in between the choice is held. If the control signal is not a number,
/// neither is the output.
///
/// ```ron
/// Switch(threshold: 0.5)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Switch)]
pub struct Switch {
    /// Where a real control signal switches, in its unit; a Bool counts as 0 or 1.
    #[block(finite, default = 0.5)]
    pub threshold: f64,
}

impl Block for Switch {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let control = given.input_or_unknown("control");
        parameters_like(given, "control", control.dimension, &["threshold"])?;
        let boolean = control.kind == Kind::Bool;
        if boolean && !(self.threshold > 0.0 && self.threshold <= 1.0) {
            let message =
                format!("`control` is true or false, so a threshold of {} never switches", self.threshold);
            return Err(InterfaceError::types(&["control"], message).help("leave `threshold` away"));
        }
        let kind = given.common_kind(&["u1", "u3"])?.unwrap_or(Kind::Real);
        let dimension = given.common_dimension(&["u1", "u3"])?;
        let shape = given.common_shape(&["u1", "u3", "control"], &[])?;
        let n = control.shape.len();
        let interface = Interface::new()
            .input(Input::any("u1").doc("Passed while the control signal is true or at least the threshold."))
            .input(Input::any("control").doc("Chooses; Bool or real."))
            .input(Input::any("u3").doc("Passed otherwise."))
            .output(Output::like("y", PortType { kind, shape, dimension }))
            .memory("first", n, 0.0);
        let guards = if boolean { 0 } else { n };
        Ok(interface.guard_each("threshold", guards).called("passes `u1`", "passes `u3`"))
    }

    fn law(&self, l: &Recording) -> bool {
        let control = l.input(1);
        for (i, control) in control.iter().enumerate() {
            let first = control.live(Relation::GreaterEqual, l.constant(self.threshold));
            // What is not a number passes neither.
            l.settle(i, control.is_number().select(first.number(), *control));
            if l.guards() > 0 {
                l.guard(i, *control - self.threshold);
            }
        }
        l.each(0, |i| {
            let first = if let [first] = l.d() { *first } else { l.d()[i] };
            let passed = first.is_true().select(l.element(0, i), l.element(2, i));
            first.is_number().select(passed, first)
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn on_the_threshold_the_first_input_is_passed() {
        let mut bench = Bench::new(Switch { threshold: 2.0 });
        bench.set(0, &[10.0]).set(2, &[30.0]);
        for (control, expected) in [(1.9, 30.0), (2.0, 10.0), (2.1, 10.0)] {
            assert_eq!(bench.set(1, &[control]).major(), [expected]);
        }
        assert!(bench.set(1, &[f64::NAN]).major()[0].is_nan());
    }

    #[test]
    fn the_choice_is_held_between_major_steps_while_values_are_live() {
        let mut bench = Bench::new(Switch { threshold: 0.5 });
        bench.set(0, &[10.0]).set(1, &[1.0]).set(2, &[30.0]).major();
        assert_eq!(bench.set(0, &[11.0]).set(1, &[0.25]).minor(), [11.0]);
        assert_eq!(bench.guards(), [-0.25]);
        assert_eq!(bench.major(), [30.0]);
    }

    #[test]
    fn a_truth_value_chooses_for_a_whole_vector() {
        let inputs = vec![
            ("u1".to_owned(), PortType::vector(2)),
            ("control".to_owned(), PortType::boolean()),
            ("u3".to_owned(), PortType::scalar()),
        ];
        let mut bench = Bench::with_inputs(Switch { threshold: 0.5 }, inputs);
        assert!(bench.interface.guards.is_empty());
        assert_eq!(bench.set(0, &[1.0, 2.0]).set(1, &[1.0]).set(2, &[7.0]).major(), [1.0, 2.0]);
        assert_eq!(bench.set(1, &[0.0]).major(), [7.0, 7.0]);
    }

    #[test]
    fn the_passed_signals_have_one_unit_and_the_threshold_that_of_the_control() {
        let block = Switch { threshold: 0.5 };
        let y = block.interface(&given(&[("u1", "V"), ("control", "A")], &[("threshold", "mA")])).unwrap();
        assert_eq!(y.outputs[0].port_type.dimension, Some(dimension("V")));
        let error = block.interface(&given(&[("u1", "V"), ("u3", "A")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports.len()), ("unit_mismatch", 2));
        assert!(block.interface(&given(&[("control", "A")], &[("threshold", "V")])).is_err());
    }

    #[test]
    fn kinds_are_not_mixed_and_a_threshold_must_be_able_to_switch() {
        let types = |u1, u3| {
            let inputs = [("u1", u1), ("u3", u3), ("control", PortType::boolean())];
            Given::new(inputs.map(|(name, port)| (name.to_owned(), port)).to_vec(), Default::default())
        };
        let block = Switch { threshold: 0.5 };
        let y =
            block.interface(&types(PortType::boolean(), PortType::boolean())).unwrap().outputs[0].port_type;
        assert_eq!(y.kind, Kind::Bool);
        assert_eq!(
            block.interface(&types(PortType::boolean(), PortType::scalar())).unwrap_err().ports,
            ["u3", "u1"]
        );
        let never = Switch { threshold: 0.0 }.interface(&types(PortType::scalar(), PortType::scalar()));
        assert_eq!(never.unwrap_err().ports, ["control"]);
        assert_eq!(Switch { threshold: f64::NAN }.errors()[0].param, "threshold");
    }
}
