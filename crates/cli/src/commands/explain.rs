use blocksim_signal::closest;

use crate::args::manual::ExplainArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::terminal::prose::prose;

include!(concat!(env!("OUT_DIR"), "/error_pages.rs"));

/// Pages about problems, by their codes.
pub fn error_pages() -> impl Iterator<Item = (&'static str, &'static str)> {
    ERROR_PAGES.iter().copied()
}

/// Prints the page of the manual about a problem, or which pages there are.
///
/// # Errors
/// If there is no such page.
pub fn explain(args: &ExplainArgs, console: Console) -> Outcome {
    let codes = || ERROR_PAGES.iter().map(|(code, _)| *code);
    let Some(code) = &args.code else {
        console.data(&codes().map(|code| format!("{code}\n")).collect::<String>())?;
        return Ok(Exit::Done);
    };
    // People copy the brackets, too.
    let code = code.trim_start_matches("error").trim_start_matches("warning").trim_matches(['[', ']', ':']);
    if let Some((_, page)) = ERROR_PAGES.iter().find(|(known, _)| *known == code) {
        console.data(&prose(page))?;
        return Ok(Exit::Done);
    }
    Err(Failure::usage(format!("there is no page about `{code}`")).help(match closest(code, codes()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "`blocksim explain` lists all pages".to_owned(),
    }))
}
