use std::io;

use blocksim_signal::closest;

use crate::args::manual::ExplainArgs;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::prose::prose;

include!(concat!(env!("OUT_DIR"), "/error_pages.rs"));

/// Prints the page of the manual about a problem, or which pages there are.
///
/// # Errors
/// If the standard output cannot be written.
pub fn explain(args: &ExplainArgs, console: Console) -> io::Result<Exit> {
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
    console.say(&match closest(code, codes()) {
        Some(meant) => format!("error: there is no page about `{code}`; did you mean `{meant}`?"),
        None => format!("error: there is no page about `{code}`; `blocksim explain` lists all pages"),
    });
    Ok(Exit::Usage)
}
