//! What is done when a plug-in dies in this process, or does not return: the run cannot go on, and what there is of it is kept.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use blocksim_block::problem::Problem;
use blocksim_block::schedule::Schedule;
use blocksim_host::{Cause, Death};
use blocksim_sim::SimError;

use crate::commands::tell_with;
use crate::exit::Exit;
use crate::running::interrupt;
use crate::terminal::console::Console;

/// Who keeps what there is of the run.
static WAITING: Mutex<Option<Sender<Death>>> = Mutex::new(None);

/// Where deaths are told.
static CONSOLE: OnceLock<Console> = OnceLock::new();

/// What helps where a plug-in has died.
const HELP: &str = "`--isolate` keeps plug-ins in processes of their own";

/// Listens to deaths of plug-ins from now on.
pub fn prepare(console: Console) {
    let _ = CONSOLE.set(console);
    blocksim_host::set_interrupt(interrupt::is_requested);
    blocksim_host::set_death_notice(on_death);
}

/// Tells of a death, where nobody has anything to keep; gives the exit code.
fn on_death(death: &Death) -> i32 {
    let waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner).take();
    if waiting.is_some_and(|sender| sender.send(death.clone()).is_ok()) {
        // The program ends as soon as the run is kept.
        loop {
            std::thread::park();
        }
    }
    let Some(console) = CONSOLE.get().copied() else { return Exit::Failed.code().into() };
    if death.cause == Cause::Interrupted {
        return Exit::Interrupted.code().into();
    }
    let during = match death.kind.as_str() {
        kind if death.t.is_nan() => format!(" while the parameters of `{kind}` were read"),
        kind => format!(" in `{kind}` at t = {} s", death.t),
    };
    let (code, exit) =
        if death.t.is_nan() { ("plugin_crash", Exit::Model) } else { ("block_failed", Exit::Failed) };
    let problem = Problem { help: Some(HELP.to_owned()), ..Problem::error(code, format!("{death}{during}")) };
    let _ = tell_with(&[problem], &[], Some(exit), console);
    exit.code().into()
}

/// Takes part in being told, until it is dropped.
struct Waiting;

impl Drop for Waiting {
    fn drop(&mut self) {
        WAITING.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}

/// Does some work that calls plug-ins. Should one of them die, `keep` is called with what is known, on another thread, and the
/// program ends with its exit code; the work never goes on.
pub fn during<R>(keep: impl FnOnce(&Death) -> Exit + Send, work: impl FnOnce() -> R) -> R {
    let (sender, deaths) = channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            if let Ok(death) = deaths.recv() {
                blocksim_host::leave(keep(&death).code().into());
            }
        });
        *WAITING.lock().unwrap_or_else(PoisonError::into_inner) = Some(sender);
        let _waiting = Waiting;
        work()
    })
}

/// A death as the failure of a block.
pub fn failure(death: &Death, schedule: &Schedule) -> SimError {
    let block = schedule.blocks.iter().find(|block| {
        let address: *const () = Arc::as_ptr(&block.block).cast();
        address as usize == death.block
    });
    let path = block.map_or_else(|| death.kind.clone(), |block| block.path.clone());
    SimError {
        code: "block_failed",
        t: death.t,
        message: format!("`{path}` cannot go on: {death}"),
        path: Some(path),
        help: Some(HELP.to_owned()),
    }
}
