//! Laws that are written as text: from formulas to a program, and the program as the law of a block.

mod formulas;
mod parameters;
mod record;
mod text_law;

pub(crate) use formulas::Formulas;
pub(crate) use parameters::{LawParameters, name_fits, number_named};
pub(crate) use record::{Part, constants, record};
pub(crate) use text_law::{TextLaw, no_value};

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
