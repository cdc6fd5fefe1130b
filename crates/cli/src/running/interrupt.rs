//! Ctrl-C: the first asks the run to stop and keeps its data, the second ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::Exit;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes Ctrl-C over. Where the system refuses, Ctrl-C ends the program as if nothing had been asked.
pub fn take_over() {
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
    });
}

/// Whether somebody wants the run to stop.
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
