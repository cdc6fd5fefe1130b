//! Handlers for what ends a process: signals of a crash, and `exit`. They use nothing but what a handler may use.

use std::os::fd::RawFd;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicPtr, Ordering};
use std::time::Duration;

use super::{Cause, Death, SLOT, Slot, Tag, ending};

/// Signals that a crash raises.
pub(super) const SIGNALS: [i32; 6] =
    [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT, libc::SIGTRAP];
/// How near to the top of the stack an address is that a stack without room has been extended to.
const NEAR: u64 = 1 << 16;
/// How long those who are told of a crash may take, s. They may hang, if the plug-in has crashed within `malloc`.
const PATIENCE: libc::time_t = 30;
/// The status of a record, which no plug-in reports.
pub const DIED: i32 = i32::MIN;
/// In place of a signal: `exit`.
const EXIT: i32 = -1;

/// What a handler writes: as a message of a process for plug-ins, with its length first.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Record {
    length: u32,
    status: i32,
    signal: i32,
    is_stack: u32,
    address: u64,
    slot: u64,
}

/// Bytes of a record.
const SIZE: usize = size_of::<Record>();

static OLD: [AtomicPtr<libc::sigaction>; SIGNALS.len()] = [const { AtomicPtr::new(std::ptr::null_mut()) }; _];
static TO: AtomicI32 = AtomicI32::new(-1);
/// Whether this process is one for plug-ins, whose parent tells of its end.
static IS_CHILD: AtomicBool = AtomicBool::new(false);

impl Record {
    /// The cause of a death, from what stands behind the status.
    pub fn cause(body: &[u8]) -> Option<Cause> {
        let number = |at: usize| Some(i32::from_ne_bytes(body.get(at..at + 4)?.try_into().ok()?));
        let (signal, is_stack) = (number(0)?, number(4)? != 0);
        let address = u64::from_ne_bytes(body.get(8..16)?.try_into().ok()?);
        Some(if signal == EXIT { Cause::Exit } else { Cause::Signal { signal, address, is_stack } })
    }
}

/// The end of a pipe from which records come.
pub(super) struct Crashes(RawFd);

/// Takes over the signals; `None` if the system refuses.
pub(super) fn listen() -> Option<Crashes> {
    if is_child() {
        return None;
    }
    let mut ends = [0; 2];
    // SAFETY: room for two numbers.
    if unsafe { libc::pipe(ends.as_mut_ptr()) } != 0 {
        return None;
    }
    for end in ends {
        // SAFETY: a descriptor that was just opened.
        unsafe { libc::fcntl(end, libc::F_SETFD, libc::FD_CLOEXEC) };
    }
    TO.store(ends[1], Ordering::Relaxed);
    install();
    Some(Crashes(ends[0]))
}

/// For a process for plug-ins: crashes are written to this descriptor, and the process ends.
pub fn report_to(descriptor: RawFd) {
    IS_CHILD.store(true, Ordering::Relaxed);
    TO.store(descriptor, Ordering::Relaxed);
    install();
}

/// Whether this process is one for plug-ins.
pub(super) fn is_child() -> bool {
    IS_CHILD.load(Ordering::Relaxed)
}

fn install() {
    for (signal, old) in SIGNALS.into_iter().zip(&OLD) {
        // SAFETY: all bytes zero is a legal value.
        let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
        let mut before = action;
        action.sa_sigaction = on_signal as *const () as usize;
        // A stack without room needs another one, which the standard library has set up for each thread.
        action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
        // SAFETY: both structs are whole, and the handler keeps the rules of handlers.
        unsafe {
            libc::sigemptyset(&raw mut action.sa_mask);
            libc::sigaction(signal, &raw const action, &raw mut before);
        }
        old.store(Box::into_raw(Box::new(before)), Ordering::Release);
    }
    // SAFETY: a function that lives as long as the process.
    unsafe { libc::atexit(on_exit) };
}

/// Lets crashes end the process, as if there were no handlers, and without a file of its memory: for a copy that is waited for.
pub(super) fn release() {
    let none = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: a whole struct, and the handlers of the system.
    unsafe {
        libc::setrlimit(libc::RLIMIT_CORE, &raw const none);
        for signal in SIGNALS {
            libc::signal(signal, libc::SIG_DFL);
        }
    }
}

/// The slot of this thread, if it is calling a plug-in.
fn calling() -> Option<&'static Slot> {
    SLOT.try_with(std::cell::Cell::get)
        .ok()
        .flatten()
        .filter(|slot| !slot.tag.load(Ordering::Acquire).is_null())
}

extern "C" fn on_signal(signal: i32, info: *mut libc::siginfo_t, context: *mut libc::c_void) {
    let Some(slot) = calling() else {
        if let Some(end) = ending::begun() {
            ending::end_anyway(end, "crashed");
        }
        // Somebody else's crash: as if this handler were not there. The instruction that failed is tried again.
        let old = SIGNALS.iter().position(|known| *known == signal).map(|at| OLD[at].load(Ordering::Acquire));
        if let Some(old) = old.filter(|old| !old.is_null()) {
            // SAFETY: what the system gave when this handler came in its place.
            unsafe { libc::sigaction(signal, old, std::ptr::null_mut()) };
        }
        return;
    };
    // SAFETY: the system hands over a whole struct.
    let (code, address) = unsafe { ((*info).si_code, (*info).si_addr() as u64) };
    // Sent by somebody, or by the processor without an address.
    const KERNEL: i32 = 0x80;
    let address = if code <= 0 || code == KERNEL { u64::MAX } else { address };
    let is_stack =
        signal == libc::SIGSEGV && stack_pointer(context).is_some_and(|top| address.abs_diff(top) < NEAR);
    tell(slot, signal, is_stack, address);
}

extern "C" fn on_exit() {
    if let Some(slot) = calling() {
        tell(slot, EXIT, false, 0);
    }
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn stack_pointer(context: *mut libc::c_void) -> Option<u64> {
    // SAFETY: the system hands over a whole struct.
    Some(unsafe { (*context.cast::<libc::ucontext_t>()).uc_mcontext.gregs[libc::REG_RSP as usize] } as u64)
}

#[cfg(all(target_os = "linux", target_arch = "aarch64"))]
fn stack_pointer(context: *mut libc::c_void) -> Option<u64> {
    // SAFETY: the system hands over a whole struct.
    Some(unsafe { (*context.cast::<libc::ucontext_t>()).uc_mcontext.sp })
}

#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"))))]
fn stack_pointer(_context: *mut libc::c_void) -> Option<u64> {
    None
}

/// Writes a record, and never returns: this thread is lost.
fn tell(slot: &'static Slot, signal: i32, is_stack: bool, address: u64) -> ! {
    // SAFETY: tags live as long as the process.
    let tag = unsafe { slot.tag.load(Ordering::Acquire).as_ref() };
    let is_child = is_child();
    // While a library is loaded the system holds locks that whoever is told would wait for.
    if is_child || tag.is_some_and(|tag| !tag.kind.is_empty()) {
        let length = (SIZE - size_of::<u32>()) as u32;
        let slot = std::ptr::from_ref(slot) as u64;
        let record = Record { length, status: DIED, signal, is_stack: is_stack.into(), address, slot };
        // SAFETY: a struct without padding, of its own size.
        let written = unsafe { libc::write(TO.load(Ordering::Relaxed), (&raw const record).cast(), SIZE) };
        if is_child {
            // SAFETY: ends the process.
            unsafe { libc::_exit(1) };
        }
        if written == SIZE as isize {
            let mut left = libc::timespec { tv_sec: PATIENCE, tv_nsec: 0 };
            // SAFETY: a whole struct. Another signal may cut the sleep short, and leaves the rest of it.
            while unsafe { libc::nanosleep(&raw const left, &raw mut left) } != 0 {}
        }
    }
    // Nobody listens, or those who do hang.
    last_words(tag, if signal == EXIT { "called `exit`" } else { "crashed" });
}

/// Tells of a death with nothing but what a handler may use, and ends the process.
pub(super) fn last_words(tag: Option<&Tag>, deed: &str) -> ! {
    let name = tag.map_or("", |tag| &tag.library);
    let (head, code, end) = match tag.is_none_or(|tag| tag.kind.is_empty()) {
        true => ("error[plugin_crash]: the plug-in `", 3, " while it was loaded; nothing was run\n"),
        false => {
            ("error[block_failed]: the plug-in `", 1, "; what was recorded is in the folder of the run\n")
        }
    };
    print_and_end(&["\n", head, name, "` ", deed, end], code)
}

/// Prints texts as a handler may, and ends the process.
pub(super) fn print_and_end(texts: &[&str], code: i32) -> ! {
    for text in texts {
        // SAFETY: bytes of a text.
        unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
    }
    // SAFETY: ends the process.
    unsafe { libc::_exit(code) }
}

impl Crashes {
    /// Waits for a crash, for so long.
    pub fn wait(&self, patience: Duration) -> Option<Death> {
        let mut poll = libc::pollfd { fd: self.0, events: libc::POLLIN, revents: 0 };
        // SAFETY: one struct.
        if unsafe { libc::poll(&raw mut poll, 1, patience.as_millis() as i32) } <= 0 {
            return None;
        }
        let mut bytes = [0_u8; SIZE];
        // SAFETY: room for a record, which is written at once.
        if unsafe { libc::read(self.0, bytes.as_mut_ptr().cast(), SIZE) } != SIZE as isize {
            return None;
        }
        let slot = u64::from_ne_bytes(bytes[SIZE - 8..].try_into().ok()?) as *const Slot;
        // SAFETY: slots live as long as the process, and the pipe is of this process alone.
        unsafe { slot.as_ref() }?.death(Record::cause(&bytes[8..])?)
    }
}
