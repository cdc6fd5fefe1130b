//! Laws that are written as text: from formulas to a program, and the program as the engine runs it.

mod parameters;
mod record;
mod runner;

pub(crate) use parameters::{LawParameters, name_fits};
pub(crate) use record::{Part, constants, record};
pub(crate) use runner::Runner;

use blocksim_block::ParamError;
use blocksim_signal::ExprError;

/// A mistake in the text of a parameter.
pub(crate) fn in_text(param: &str, error: ExprError) -> ParamError {
    let wrong = ParamError::new(param, error.message).within(error.span);
    match error.help {
        Some(help) => wrong.help(help),
        None => wrong,
    }
}
