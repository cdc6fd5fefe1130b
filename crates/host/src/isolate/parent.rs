//! The side that asks.

use std::cell::{Cell, RefCell};
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, Stdio};
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use blocksim_abi::OK;
use blocksim_block::LoadError;

use super::{LENGTH, LONGEST, Op, PROGRAM, begin, finish, pull, push, word};
use crate::call::Failure;
use crate::fault::{self, CRASH, MISSING};
use crate::guard::{Given, Wanted};
use crate::kind::Calls;
use crate::offer::served;
use crate::open::{Binary, Library};
use crate::watch::{Cause, DIED, Record, call_limit, is_interrupted};

/// How often Ctrl-C is looked for while an answer is awaited.
const EVERY: Duration = Duration::from_millis(50);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether a call was given up because somebody wants the program to stop.
pub fn was_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// A library that is served. There is one for each state of a file.
#[derive(Debug)]
struct Place {
    binary: Binary,
    /// What the diagram calls it.
    named: String,
    /// Whether each call is to have buffers at other places.
    is_moving: bool,
}

/// A block of a plug-in in another process.
#[derive(Debug, Clone, Copy)]
pub struct Remote {
    place: &'static Place,
    block: u32,
}

/// A process that serves one library.
struct Server {
    process: Child,
    stream: UnixStream,
    message: Vec<u8>,
}

/// The process that serves a library, or the reason why it ended.
enum Link {
    Up(Server),
    Down(String),
}

thread_local!(static DURATION: Cell<f64> = const { Cell::new(0.0) });
thread_local!(static LINKS: RefCell<Vec<(*const Place, Link)>> = const { RefCell::new(Vec::new()) });

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// How long the last call of this thread that succeeded took in the other process, s.
pub fn last_duration() -> f64 {
    DURATION.get()
}

/// The plug-in in a built library, served by another process; there each call has buffers at other places if `is_moving`.
///
/// # Errors
/// As if it were loaded here, or that it died of being loaded.
pub fn open(binary: &Binary, named: &str, is_moving: bool) -> Result<Library, LoadError> {
    let place: &'static Place =
        Box::leak(Box::new(Place { binary: binary.clone(), named: named.to_owned(), is_moving }));
    let (server, offer) = start(place)?;
    let broken = |reason: String| fault::library(fault::ABI, format!("the plug-in `{named}`: {reason}"));
    let mut library = served(&fault::shown(&binary.path), &offer).map_err(broken)?;
    for (at, kind) in library.blocks.iter_mut().enumerate() {
        kind.calls = Calls::Remote(Remote { place, block: at as u32 });
    }
    LINKS.with_borrow_mut(|links| links.push((place, Link::Up(server))));
    Ok(library)
}

/// Starts a process and lets it load a library; gives what this offers.
fn start(place: &Place) -> Result<(Server, String), LoadError> {
    let Place { binary, named, is_moving } = place;
    let cannot = |what: &str, e: &dyn std::fmt::Display| {
        fault::library(
            MISSING,
            format!("the plug-in `{named}` cannot be run in a process of its own: {what}: {e}"),
        )
    };
    let program = PROGRAM.read().unwrap_or_else(PoisonError::into_inner).clone();
    let (program, arguments) =
        program.ok_or_else(|| cannot("there is no program for it", &"a bug of blocksim"))?;
    let (mine, its) = UnixStream::pair().map_err(|e| cannot("no socket", &e))?;
    let process = Command::new(&program)
        .args(arguments)
        .stdin(Stdio::from(OwnedFd::from(its)))
        // Ctrl-C is for this process, which then ends that one.
        .process_group(0)
        .spawn()
        .map_err(|e| cannot(&program.display().to_string(), &e))?;
    let mut server = Server { process, stream: mine, message: Vec::new() };
    let timeouts = |stream: &UnixStream| {
        stream.set_read_timeout(Some(EVERY)).and_then(|()| stream.set_write_timeout(Some(call_limit())))
    };
    timeouts(&server.stream).map_err(|e| cannot("no socket", &e))?;
    begin(&mut server.message);
    server.message.extend(named.as_bytes());
    server.message.extend([0, u8::from(*is_moving), u8::from(binary.is_module)]);
    server.message.extend(binary.path.as_os_str().as_encoded_bytes());
    let status = server.exchange().map_err(|reason| {
        let error = fault::library(CRASH, format!("the plug-in `{named}` {reason} while it was loaded"));
        fault::help(error, "nothing runs then but initialisers and `blocksim_plugin_v1`")
    })?;
    let text = String::from_utf8_lossy(server.body()).into_owned();
    if status == OK {
        return Ok((server, text));
    }
    let mut parts = text.split('\0');
    let mut next = || parts.next().unwrap_or_default().to_owned();
    let (code, message, help) = (next(), next(), next());
    Err(LoadError {
        param: "library",
        code: fault::known(&code),
        message,
        help: Some(help).filter(|help| !help.is_empty()),
    })
}

impl Remote {
    /// Has a function called in the other process.
    ///
    /// # Errors
    /// What the function reported, which rule it broke, or what became of the process.
    pub fn call(&self, op: Op, t: f64, given: &[Given], wanted: &mut [Wanted]) -> Result<(), Failure> {
        let failed =
            |text: String| Failure { status: OK, text: format!("the plug-in `{}` {text}", self.place.named) };
        LINKS.with_borrow_mut(|links| {
            let at =
                links.iter().position(|(place, _)| std::ptr::eq(*place, self.place)).unwrap_or_else(|| {
                    links.push((self.place, Link::Down(String::new())));
                    links.len() - 1
                });
            let link = &mut links[at].1;
            // Each thread has a process of its own, and each run begins with one that lives.
            if matches!(link, Link::Down(reason) if reason.is_empty() || op == Op::Reset) {
                *link = match start(self.place) {
                    Ok((server, _)) => Link::Up(server),
                    Err(error) => Link::Down(error.message),
                };
            }
            let server = match link {
                Link::Up(server) => server,
                Link::Down(reason) => return Err(failed(reason.clone())),
            };
            server.ask(op, self.block, t, given, wanted).unwrap_or_else(|reason| {
                *link = Link::Down(reason.clone());
                Err(failed(reason))
            })
        })
    }
}

impl Server {
    /// The outcome of a call, or what became of the process.
    fn ask(
        &mut self,
        op: Op,
        block: u32,
        t: f64,
        given: &[Given],
        wanted: &mut [Wanted],
    ) -> Result<Result<(), Failure>, String> {
        begin(&mut self.message);
        self.message.extend((op as u32).to_ne_bytes());
        self.message.extend(block.to_ne_bytes());
        push(&mut self.message, &[t]);
        given.iter().for_each(|given| push(&mut self.message, given.numbers));
        wanted.iter().for_each(|wanted| push(&mut self.message, wanted.numbers));
        let status = self.exchange()?;
        let mut body = self.body();
        if status != OK || word(&self.message, 0) == Some(1) {
            return Ok(Err(Failure { status, text: String::from_utf8_lossy(body).into_owned() }));
        }
        for wanted in wanted {
            let (numbers, rest) = body.split_at_checked(8 * wanted.numbers.len()).unwrap_or_default();
            if !pull(numbers, wanted.numbers) {
                return Err("gave an answer that makes no sense".to_owned());
            }
            body = rest;
        }
        let mut duration = [0.0];
        if pull(body, &mut duration) {
            DURATION.set(duration[0]);
        }
        Ok(Ok(()))
    }

    /// What stands behind kind and status of an answer.
    fn body(&self) -> &[u8] {
        self.message.get(8..).unwrap_or_default()
    }

    /// Sends the message, replaces it by the answer and returns the status of the answer.
    ///
    /// # Errors
    /// What happened to the process, to follow the name of the plug-in: "aborted (SIGABRT)".
    fn exchange(&mut self) -> Result<i32, String> {
        finish(&mut self.message);
        let asked = Instant::now();
        if self.stream.write_all(&self.message).is_err() {
            return Err(self.end(asked));
        }
        let mut length = [0; LENGTH];
        if !self.receive(&mut length, asked)? {
            return Err(self.end(asked));
        }
        let length = u32::from_ne_bytes(length) as usize;
        let mut message = std::mem::take(&mut self.message);
        message.clear();
        message.resize(length.min(LONGEST), 0);
        let is_there = self.receive(&mut message, asked)?;
        self.message = message;
        if !is_there {
            return Err(self.end(asked));
        }
        if word(&self.message, 0).map(u32::cast_signed) == Some(DIED) {
            let cause = Record::cause(&self.message[4..]);
            return Err(cause.map_or_else(|| self.end(asked), |cause| cause.to_string()));
        }
        word(&self.message, 4).map(u32::cast_signed).ok_or_else(|| self.end(asked))
    }

    /// Fills a buffer; false if the other side has gone.
    fn receive(&mut self, mut buffer: &mut [u8], asked: Instant) -> Result<bool, String> {
        while !buffer.is_empty() {
            match self.stream.read(buffer) {
                Ok(0) => return Ok(false),
                Ok(n) => buffer = &mut buffer[n..],
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                    if is_interrupted() {
                        INTERRUPTED.store(true, Ordering::Relaxed);
                        return Err(Cause::Interrupted.to_string());
                    }
                    if asked.elapsed() >= call_limit() {
                        return Err(Cause::TooLong(call_limit()).to_string());
                    }
                }
                Err(_) => return Ok(false),
            }
        }
        Ok(true)
    }

    /// How a process ended that told nothing.
    fn end(&mut self, asked: Instant) -> String {
        // It closes its socket a moment before it ends; one that has only closed the socket is ended.
        while asked.elapsed() < call_limit() && matches!(self.process.try_wait(), Ok(None)) {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = self.process.kill();
        match self.process.wait() {
            Ok(status) => match (status.code(), status.signal()) {
                (Some(code), _) => format!("ended its process with exit code {code}"),
                (_, Some(signal)) => {
                    format!("crashed: its process was ended by signal {signal}")
                }
                _ => "ended its process".to_owned(),
            },
            Err(e) => format!("lost its process: {e}"),
        }
    }
}
