use blocksim_block::prelude::*;

/// Ends the run when its input is true.
///
/// The run ends where the input becomes true, once everything at this time is known, as if that were its stop time: its results
/// are kept, and the program ends without an error. The summary and the manifest of the run give the message. A condition that must
/// hold, and whose violation is an error, is an `Assertion`.
///
/// ```ron
/// Stop(message: "the vehicle has come to rest")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sinks", symbol = Text("STOP"))]
pub struct Stop {
    /// Why the run ends.
    #[block(not_empty, empty = "write why the run ends")]
    pub message: String,
    /// Where the block is in the model.
    #[block(skip)]
    path: String,
}

impl Block for Stop {
    fn place(&mut self, path: &str) -> bool {
        path.clone_into(&mut self.path);
        true
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let stop = Input::boolean("stop").doc("Ends the run when it is true, or one element of a vector is.");
        Ok(Interface::new().input(stop).jumps().jump_called(""))
    }

    /// Nothing jumps here: it is the one function that is called at every major step with all inputs known.
    fn jump(&self, c: &Context, _w: &mut Scratch, _x: &mut [f64], _d: &mut [f64]) -> bool {
        if c.input(0).iter().any(|stop| *stop != 0.0) {
            c.finish(format!("{}: {}", self.path, self.message));
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_without_words_is_refused() {
        let stop = |message: &str| Stop { message: message.to_owned(), path: String::new() };
        assert_eq!(stop(" ").errors()[0].param, "message");
        assert_eq!(stop("done").errors()[..], []);
    }
}
