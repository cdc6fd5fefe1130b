//! What the system tells a program while it runs, without unsafe code here.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes over Ctrl-C and the request to terminate that batch systems and `kill` send: the first asks the run to stop and
/// keeps its data, the second ends the program at once. Where the system refuses, they end it as if nothing had been asked.
pub fn take_over() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        for signal in [SIGINT, SIGTERM] {
            let code = i32::from(Exit::Interrupted.code());
            // Looks at the flag before the second one sets it.
            let _ = flag::register_conditional_shutdown(signal, code, &REQUESTED);
            let _ = flag::register(signal, &REQUESTED);
        }
    });
}

/// Asks the run to stop, as Ctrl-C does.
pub fn request() {
    REQUESTED.store(true, Ordering::Relaxed);
}

/// Whether somebody wants the run to stop.
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// A file that reaches the size that the system allows (`ulimit -f`) makes writing fail, which is told with the place,
/// instead of ending the program without a word.
pub fn survive_full_files() {
    #[cfg(unix)]
    {
        static FULL: AtomicBool = AtomicBool::new(false);
        let _ = flag::register(signal_hook::consts::SIGXFSZ, &FULL);
    }
}
