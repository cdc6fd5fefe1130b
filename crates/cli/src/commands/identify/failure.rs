//! What is said where an experiment fails.

use blocksim_sim::SimError;

use super::bench::INTERRUPTED;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::format::short_time;

/// Why an experiment could not be finished.
pub fn failed(error: &SimError, axis: usize) -> Failure {
    if error.code == INTERRUPTED {
        return Failure::interrupted("nothing was written");
    }
    let place = error.path.as_ref().map(|path| format!(" in `{path}`")).unwrap_or_default();
    let said = format!(
        "the experiment with axis {axis} failed at t = {} s{place}: {}",
        short_time(error.t),
        error.message
    );
    Failure::new(Exit::Failed, error.code, said).perhaps_help(error.help.as_ref())
}
