//! What is said where an experiment fails.

use blocksim_sim::SimError;

use super::bench::INTERRUPTED;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::format::short_time;

/// Tells of an experiment that could not be finished.
pub fn failed(error: &SimError, axis: usize, console: Console) -> Exit {
    if error.code == INTERRUPTED {
        console.say("interrupted; nothing was written");
        return Exit::Interrupted;
    }
    let place = error.path.as_ref().map(|path| format!(" in `{path}`")).unwrap_or_default();
    console.say(&format!(
        "error[{}]: the experiment with axis {axis} failed at t = {} s{place}: {}",
        error.code,
        short_time(error.t),
        error.message
    ));
    if let Some(help) = &error.help {
        console.say(&format!("  = help: {help}"));
    }
    Exit::Failed
}
