//! The end of a program into which plug-ins were loaded.
//!
//! Functions that plug-ins have left for it, such as destructors and those of `atexit`, may do anything: end the process in a way that
//! nobody sees coming (`_exit`, `quick_exit`, a signal that no handler gets), crash, or not return. So they run in a copy of the process
//! (`fork`), which this one waits for. This one then ends with the exit code that was decided, and calls none of them.
//!
//! What C has buffered is written before, so that no copy can lose it. A copy has one thread; if a plug-in has started others that are
//! still there, one of those functions may wait for them. Then all of it happens in this process as it would anywhere else, and
//! crashes and loops are seen, but not `_exit`.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::Duration;

use super::fatal;

/// The exit code of a copy that has come to its end.
const ENDED: i32 = 94;
/// Looks for threads that are about to end.
const LOOKS: u32 = 20;

static ENDING: OnceLock<Ending> = OnceLock::new();
/// The copy, while it is waited for.
static COPY: AtomicI32 = AtomicI32::new(0);
static IS_TOLD: AtomicBool = AtomicBool::new(false);

/// The end of the program, while plug-ins may still act on it.
pub(super) struct Ending {
    code: i32,
    /// Who may act.
    whose: String,
}

/// The end, once it has begun.
pub(super) fn begun() -> Option<&'static Ending> {
    ENDING.get()
}

/// Ends the program with this exit code; `whose` is whose functions are called.
pub(super) fn end(code: i32, whose: String) -> ! {
    let end = ENDING.get_or_init(|| Ending { code, whose });
    // SAFETY: all streams of C; a stream that is locked for ever is a hang that the watch sees.
    unsafe { libc::fflush(std::ptr::null_mut()) };
    let copy = if is_alone() {
        // SAFETY: the main thread calls it, and no other one that could hold a lock is left but the watch, which takes none that is
        // needed at the end.
        unsafe { libc::fork() }
    } else {
        -1
    };
    match copy {
        // SAFETY: the main thread calls it, and does nothing else then. The library's own way to the end would take away the stack
        // for handlers of signals first.
        -1 => unsafe { libc::exit(code) },
        0 => {
            fatal::release();
            // SAFETY: as above.
            unsafe { libc::exit(ENDED) }
        }
        copy => {
            COPY.store(copy, Ordering::Release);
            if let Some(deed) = deed(copy) {
                end_anyway(end, deed);
            }
            // SAFETY: ends the process.
            unsafe { libc::_exit(code) }
        }
    }
}

/// Waits for a copy; what it did but coming to its end.
fn deed(copy: i32) -> Option<&'static str> {
    let mut status = 0;
    // SAFETY: room for a number.
    while unsafe { libc::waitpid(copy, &raw mut status, 0) } != copy {
        // Another signal came, or somebody has taken care of all children and nothing is known of this one.
        if std::io::Error::last_os_error().kind() != std::io::ErrorKind::Interrupted {
            return None;
        }
    }
    if libc::WIFEXITED(status) {
        return (libc::WEXITSTATUS(status) != ENDED).then_some("called `_exit`");
    }
    Some(if fatal::SIGNALS.contains(&libc::WTERMSIG(status)) { "crashed" } else { "was ended by a signal" })
}

/// Ends the program where a function that a plug-in has left for its end does not let it. A handler of signals may call it.
pub(super) fn end_anyway(end: &Ending, deed: &str) -> ! {
    if IS_TOLD.swap(true, Ordering::AcqRel) {
        // Another thread is just doing so.
        loop {
            // SAFETY: waits for a signal.
            unsafe { libc::pause() };
        }
    }
    let copy = COPY.load(Ordering::Acquire);
    if copy > 0 {
        // SAFETY: a child of this process. Where it has ended and was waited for, this process is about to end as well.
        unsafe { libc::kill(copy, libc::SIGKILL) };
    }
    let rest = " when the program ended; all results were written before\n";
    fatal::print_and_end(&["warning: ", &end.whose, " ", deed, rest], end.code)
}

/// Whether this process has no threads but the main one and the watch. One that was waited for may be about to go.
fn is_alone() -> bool {
    (0..LOOKS).any(|look| {
        if look > 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
        // Where nobody counts them, threads of plug-ins are taken for the exception that they are.
        std::fs::read_dir("/proc/self/task").map_or(true, |tasks| tasks.count() <= 2)
    })
}
