//! Builds plug-ins from their sources: crates with cargo, C and C++ with the compiler of the system.
//!
//! What was built before is used as long as everything that it was built from is as it was then (`fresh`).

mod c;
mod cargo;
mod crate_files;
mod fresh;
mod settings;
mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::time::{Duration, Instant};

use blocksim_block::LoadError;

pub use c::{Compilers, is_source};
pub use settings::SETTINGS;

use crate::locate::Target;

/// Blocks of one diagram that name one folder share an answer; a diagram that is read again later, say after an edit, asks
/// again.
pub const ANSWER_HOLDS: Duration = Duration::from_secs(2);
/// Lines of a compiler's errors that are shown.
const SHOWN_LINES: usize = 20;

type Answer = Result<PathBuf, LoadError>;
/// The last answer for one folder and target; locked while it is built.
type Slot = Arc<Mutex<Option<(Instant, Answer)>>>;

static SLOTS: Mutex<BTreeMap<(PathBuf, Target), Slot>> = Mutex::new(BTreeMap::new());
static NOTICE: RwLock<Option<fn(&str)>> = RwLock::new(None);

/// Sets who is told that a plug-in is compiled, what its compiler warns of, or that cargo waits for another cargo. Nobody is
/// told where everything is built already.
pub fn set_build_notice(notice: fn(&str)) {
    *NOTICE.write().unwrap_or_else(PoisonError::into_inner) = Some(notice);
}

fn notify(text: &str) {
    if let Some(notice) = *NOTICE.read().unwrap_or_else(PoisonError::into_inner) {
        notice(text);
    }
}

/// Folders of all plug-ins that this process has built, whether they could be built or not.
pub fn folders() -> Vec<PathBuf> {
    SLOTS.lock().unwrap_or_else(PoisonError::into_inner).keys().map(|(folder, _)| folder.clone()).collect()
}

/// Folders of sources that this process has built last without an error, with what was built of each.
pub fn built() -> Vec<(PathBuf, PathBuf)> {
    let slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner);
    let one = |((folder, _), slot): (&(PathBuf, Target), &Slot)| {
        // One that is being built is not known yet.
        let last = slot.try_lock().ok()?;
        let (_, answer) = last.as_ref()?;
        Some((folder.clone(), answer.clone().ok()?))
    };
    slots.iter().filter_map(one).collect()
}

/// The library of the crate in `folder`, or the module if that is the target, up to date. `named` is how the diagram calls it.
///
/// # Errors
/// The crate does not build, or builds no library; there is no cargo and no built library; Rust has not got the target.
pub fn of_crate(folder: &Path, named: &str, target: Target) -> Answer {
    once(folder, target, || cargo::built(&cargo::program(), folder, named, target))
}

/// The library of the C or C++ sources in `folder`, up to date. `named` is how the diagram calls it.
///
/// # Errors
/// The sources do not compile, the settings are wrong, or there is no compiler.
pub fn of_sources(folder: &Path, named: &str) -> Answer {
    once(folder, Target::Native, || c::built(&c::Compilers::of_environment(), folder, named))
}

fn once(folder: &Path, target: Target, build: impl FnOnce() -> Answer) -> Answer {
    let slot = {
        let mut slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(slots.entry((folder.to_owned(), target)).or_default())
    };
    let mut last = slot.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((asked, answer)) = last.as_ref()
        && asked.elapsed() < ANSWER_HOLDS
    {
        return answer.clone();
    }
    let answer = build();
    *last = Some((Instant::now(), answer.clone()));
    answer
}
