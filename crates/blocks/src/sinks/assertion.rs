use blocksim_block::prelude::*;

/// Stops the simulation with a message when its input is false.
///
/// The input is looked at wherever the solver stops, after all outputs are known.
///
/// ```ron
/// Assertion(message: "the arm touches the floor")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sinks", symbol = Text("✓"))]
pub struct Assertion {
    /// What is wrong when the input is false.
    pub message: String,
}

impl Block for Assertion {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(Input::boolean("ok").doc("What must be true; all elements of a vector."))
            .jumps())
    }

    /// Nothing jumps here: it is the one function that is called at every major step with all inputs known.
    fn jump(&self, c: &Context, _w: &mut Scratch, _x: &mut [f64], _d: &mut [f64]) -> bool {
        if c.input(0).contains(&0.0) {
            c.fail(self.message.as_str());
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::Fault;

    fn reason(ok: &[f64]) -> Option<String> {
        let fault = Fault::default();
        let block = Assertion { message: "too hot".to_owned() };
        let inputs = [(0, ok.len() as u32)];
        let c = Context {
            t: 0.0,
            x: &[],
            d: &[],
            u: ok,
            inputs: &inputs,
            outputs: &[],
            evaluation: 0,
            resolution: blocksim_block::Resolution::default(),
            seed: 0,
            fault: &fault,
        };
        assert!(!block.jump(&c, &mut Scratch::default(), &mut [], &mut []));
        fault.take()
    }

    #[test]
    fn it_fails_with_its_message_when_any_element_is_false() {
        assert_eq!(reason(&[1.0]), None);
        assert_eq!(reason(&[0.0]).as_deref(), Some("too hot"));
        assert_eq!(reason(&[1.0, 0.0, 1.0]).as_deref(), Some("too hot"));
    }

    #[test]
    fn it_looks_at_truth_values_at_major_steps() {
        let interface = Assertion { message: String::new() }.interface(&Given::nothing()).unwrap();
        assert_eq!(interface.inputs[0].kind, Some(Kind::Bool));
        assert!(interface.jumps && interface.outputs.is_empty());
    }
}
