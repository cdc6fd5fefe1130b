//! Outputs of conditional subsystems that no block inside holds.

use blocksim_block::{Block, Context, Given, Input, Interface, InterfaceError, Output, Scratch};
use blocksim_signal::{Kind, Quantity};

use super::gate::{GateState, gate_input};

/// An output of a conditional subsystem that gives a value while the subsystem is disabled, or that comes from one of its inputs, which
/// goes on changing while the subsystem does not run.
#[derive(Debug)]
pub(crate) struct Outlet {
    /// What it gives while the subsystem is disabled; what it gave last if absent.
    pub value: Option<Quantity>,
}

impl Block for Outlet {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut u = given.input_or_unknown("u");
        if let Some(value) = self.value {
            if u.kind == Kind::Bool && value.value != 0.0 && value.value != 1.0 {
                let message =
                    format!("the output is a truth value, but `when_disabled` gives {}", value.value);
                return Err(InterfaceError::types(&["u"], message).help("write 0 for false or 1 for true"));
            }
            match u.dimension {
                Some(dimension) if !dimension.compatible(value.dimension) => {
                    let has = |it: blocksim_signal::Dimension| {
                        if it.is_none() { "has no unit".to_owned() } else { format!("is in {it}") }
                    };
                    let message = format!(
                        "the output {}, but its value of `when_disabled` {}",
                        has(dimension),
                        has(value.dimension)
                    );
                    return Err(InterfaceError::units(&["u"], message)
                        .help("give the value in the unit of the output"));
                }
                Some(_) => {}
                None => u.dimension = Some(value.dimension),
            }
        }
        let mut interface = Interface::new()
            .input(Input::any("u"))
            .input(gate_input())
            .output(Output::like("y", u))
            .memory("held", u.shape.len(), self.value.map_or(0.0, |value| value.value));
        interface.holds = Some(0);
        Ok(interface)
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let gate = GateState::new(c.input(1));
        match self.value {
            _ if gate.runs(c.t) => y.copy_from_slice(c.input(0)),
            Some(value) if !gate.enabled => y.fill(value.value),
            _ => y.copy_from_slice(c.d),
        }
    }
}
