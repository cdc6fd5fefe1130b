//! Who is running when something goes wrong that no call returns from: a crash, an `exit`, an endless loop.
//!
//! Each thread notes which block it calls, in a slot that a thread of its own looks at. That thread hears of crashes from
//! the handlers in `fatal`, finds calls that take too long or that Ctrl-C is to end, and then tells whoever has asked to be
//! told ([`set_death_notice`]), once. The thread that was calling never goes on: nothing is known of the state of the plug-in.

#[cfg(unix)]
mod ending;
#[cfg(unix)]
mod fatal;

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, Once, PoisonError, RwLock};
use std::time::{Duration, Instant};

#[cfg(unix)]
pub use fatal::{DIED, Record, report_to};

use crate::open;

/// How often calls are looked at.
const EVERY: Duration = Duration::from_millis(50);
/// Longest call that Ctrl-C waits for.
const GRACE: Duration = Duration::from_millis(200);
/// Longest call where nobody has said otherwise.
const LIMIT: Duration = Duration::from_secs(10);

static LIMIT_NANOS: AtomicU64 = AtomicU64::new(LIMIT.as_nanos() as u64);
/// Hears of a death and gives the exit code of the program.
type DeathNotice = fn(&Death) -> i32;

static NOTICE: RwLock<Option<DeathNotice>> = RwLock::new(None);
static INTERRUPT: RwLock<Option<fn() -> bool>> = RwLock::new(None);
static SLOTS: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

/// What a thread is doing. Written by that thread alone.
#[derive(Debug)]
pub(crate) struct Slot {
    /// Whose function is running; NULL between calls.
    tag: AtomicPtr<Tag>,
    /// Address of the block that calls, 0 while a model is compiled.
    block: AtomicUsize,
    /// Bits of the time of the simulation.
    t: AtomicU64,
    /// Calls so far.
    calls: AtomicU64,
}

/// A block of a plug-in, by the names that a diagram has for them.
#[derive(Debug)]
pub struct Tag {
    /// What the diagram calls the library.
    pub library: String,
    /// Kind of block; empty while the library is loaded.
    pub kind: String,
}

/// What no call returns from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// A signal of the system, with the address that it is about.
    Signal {
        /// Its number.
        signal: i32,
        /// What was touched, if that is known.
        address: u64,
        /// Whether the stack was at its end.
        is_stack: bool,
    },
    /// The plug-in called `exit`.
    Exit,
    /// The call is still going on after this time.
    TooLong(Duration),
    /// Somebody wants the run to end, and the call does not.
    Interrupted,
}

/// A plug-in that was running when its process could not go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Death {
    /// Address of the block as it stands in a schedule, 0 while a model is compiled.
    pub block: usize,
    /// What the diagram calls the library.
    pub library: String,
    /// Kind of block; empty while the library was loaded.
    pub kind: String,
    /// Time of the simulation, s.
    pub t: f64,
    /// What happened.
    pub cause: Cause,
}

impl fmt::Display for Death {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "the plug-in `{}` {}", self.library, self.cause)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Cause::Signal { is_stack: true, .. } => {
                f.write_str("overflowed its stack: a recursion without end?")
            }
            Cause::Signal { signal, address, .. } => signal_text(f, *signal, *address),
            Cause::Exit => f.write_str("called `exit`, which ends the whole program"),
            Cause::TooLong(limit) => {
                write!(f, "did not return within {} s: a loop without end?", limit.as_secs_f64())
            }
            Cause::Interrupted => f.write_str("was interrupted"),
        }
    }
}

#[cfg(unix)]
fn signal_text(f: &mut fmt::Formatter, signal: i32, address: u64) -> fmt::Result {
    const PAGE: u64 = 4096;
    match signal {
        libc::SIGSEGV if address < PAGE => f.write_str("crashed: it used a NULL pointer (SIGSEGV)"),
        libc::SIGSEGV | libc::SIGBUS => {
            f.write_str("crashed: it touched memory that is not its own (SIGSEGV)")
        }
        libc::SIGFPE => f.write_str("crashed: it divided an integer by zero (SIGFPE)"),
        libc::SIGILL | libc::SIGTRAP => f.write_str("crashed: it executed an illegal instruction (SIGILL)"),
        libc::SIGABRT => f.write_str("aborted (SIGABRT)"),
        signal => write!(f, "was ended by signal {signal}"),
    }
}

#[cfg(not(unix))]
fn signal_text(f: &mut fmt::Formatter, signal: i32, _address: u64) -> fmt::Result {
    write!(f, "was ended by signal {signal}")
}

/// Sets who is told of a plug-in that died, or does not return, in this process. What it returns becomes the exit code of the
/// program, which then ends without any more ado.
pub fn set_death_notice(notice: DeathNotice) {
    *NOTICE.write().unwrap_or_else(PoisonError::into_inner) = Some(notice);
}

/// Sets how it is found out whether somebody wants the program to stop.
pub fn set_interrupt(is_requested: fn() -> bool) {
    *INTERRUPT.write().unwrap_or_else(PoisonError::into_inner) = Some(is_requested);
}

/// Sets the longest time that a call may take.
pub fn set_call_limit(limit: Duration) {
    LIMIT_NANOS.store(u64::try_from(limit.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
}

pub(crate) fn call_limit() -> Duration {
    Duration::from_nanos(LIMIT_NANOS.load(Ordering::Relaxed))
}

pub(crate) fn is_interrupted() -> bool {
    let interrupt = *INTERRUPT.read().unwrap_or_else(PoisonError::into_inner);
    interrupt.is_some_and(|is_requested| is_requested())
}

/// Ends the program with an exit code, if a plug-in was loaded into it: functions that plug-ins have left for the end, such as
/// destructors and what flushes the files of C, are called, and whatever they do, the exit code is this one.
pub fn end(code: u8) {
    let libraries = open::loaded();
    if libraries.is_empty() {
        return;
    }
    let code = i32::from(code);
    #[cfg(unix)]
    {
        use std::io::Write;
        if fatal::is_child() {
            // Whoever has started this process ends it anyway.
            leave(code);
        }
        let whose = match &libraries[..] {
            [one] => format!("the plug-in `{one}`"),
            several => format!("one of the plug-ins `{}`", several.join("`, `")),
        };
        let _ = std::io::stdout().flush();
        ending::end(code, whose)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// Ends the program at once, without functions that plug-ins may have left for its end.
pub fn leave(code: i32) -> ! {
    use std::io::Write;
    let _ = std::io::stdout().flush();
    #[cfg(unix)]
    // SAFETY: ends the process.
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// The one tag of a library and a kind.
pub(crate) fn tag(library: &str, kind: &str) -> &'static Tag {
    static TAGS: Mutex<BTreeMap<(String, String), &'static Tag>> = Mutex::new(BTreeMap::new());
    let mut tags = TAGS.lock().unwrap_or_else(PoisonError::into_inner);
    tags.entry((library.to_owned(), kind.to_owned()))
        .or_insert_with(|| Box::leak(Box::new(Tag { library: library.to_owned(), kind: kind.to_owned() })))
}

thread_local!(static SLOT: Cell<Option<&'static Slot>> = const { Cell::new(None) });

fn slot() -> &'static Slot {
    SLOT.get().unwrap_or_else(|| {
        let slot: &'static Slot = Box::leak(Box::new(Slot {
            tag: AtomicPtr::default(),
            block: AtomicUsize::new(0),
            t: AtomicU64::new(0),
            calls: AtomicU64::new(0),
        }));
        SLOTS.lock().unwrap_or_else(PoisonError::into_inner).push(slot);
        SLOT.set(Some(slot));
        slot
    })
}

/// A call that is going on; it is over when this is dropped.
pub(crate) struct Calling(&'static Slot);

impl Drop for Calling {
    fn drop(&mut self) {
        self.0.tag.store(std::ptr::null_mut(), Ordering::Relaxed);
    }
}

/// Notes that this thread calls a plug-in.
#[inline]
pub(crate) fn calling(tag: &'static Tag, block: usize, t: f64) -> Calling {
    let slot = slot();
    slot.block.store(block, Ordering::Relaxed);
    slot.t.store(t.to_bits(), Ordering::Relaxed);
    slot.calls.store(slot.calls.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    slot.tag.store(std::ptr::from_ref(tag).cast_mut(), Ordering::Release);
    Calling(slot)
}

impl Slot {
    /// What is known of a death here.
    fn death(&self, cause: Cause) -> Option<Death> {
        let tag = self.tag.load(Ordering::Acquire);
        // SAFETY: tags live as long as the process.
        let tag = unsafe { tag.as_ref() }?;
        Some(Death {
            block: self.block.load(Ordering::Relaxed),
            library: tag.library.clone(),
            kind: tag.kind.clone(),
            t: f64::from_bits(self.t.load(Ordering::Relaxed)),
            cause,
        })
    }
}

/// Watches over calls from now on.
pub(crate) fn start() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        #[cfg(unix)]
        let crashes = fatal::listen();
        let work = move || {
            let mut seen: Vec<(u64, Duration)> = Vec::new();
            let mut last = Instant::now();
            #[cfg(unix)]
            let mut ending = Duration::ZERO;
            loop {
                #[cfg(unix)]
                let died = crashes.as_ref().and_then(|crashes| crashes.wait(EVERY));
                #[cfg(unix)]
                if crashes.is_none() {
                    std::thread::sleep(EVERY);
                }
                #[cfg(not(unix))]
                let died = {
                    std::thread::sleep(EVERY);
                    None
                };
                let now = Instant::now();
                // A computer that slept has not calculated.
                let passed = now.duration_since(last).min(4 * EVERY);
                last = now;
                #[cfg(unix)]
                if let Some(end) = ending::begun() {
                    ending += passed;
                    if ending >= call_limit() || ending >= GRACE && is_interrupted() {
                        ending::end_anyway(end, "does not return");
                    }
                }
                if let Some(death) = died.or_else(|| overdue(&mut seen, passed)) {
                    #[cfg(unix)]
                    if death.kind.is_empty() {
                        // The loader of the system holds locks that others would wait for.
                        fatal::last_words(Some(tag(&death.library, "")), "did not return");
                    }
                    let notice = *NOTICE.read().unwrap_or_else(PoisonError::into_inner);
                    leave(notice.map_or(1, |notice| notice(&death)));
                }
            }
        };
        // Without it, calls go on unwatched.
        let _ = std::thread::Builder::new().name("plug-in watch".to_owned()).spawn(work);
    });
}

/// A call that goes on for too long; `seen` holds for each thread the call that was seen last, and for how long.
fn overdue(seen: &mut Vec<(u64, Duration)>, passed: Duration) -> Option<Death> {
    let slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner).clone();
    seen.resize(slots.len(), (0, Duration::ZERO));
    for (slot, (call, since)) in slots.iter().zip(seen) {
        let calls = slot.calls.load(Ordering::Relaxed);
        if slot.tag.load(Ordering::Acquire).is_null() || calls != *call {
            (*call, *since) = (calls, Duration::ZERO);
            continue;
        }
        *since += passed;
        let limit = call_limit();
        if *since >= limit {
            return slot.death(Cause::TooLong(limit));
        }
        if *since >= GRACE && is_interrupted() {
            return slot.death(Cause::Interrupted);
        }
    }
    None
}
