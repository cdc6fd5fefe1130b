//! The side that answers: a process that loads one library and calls its functions.

use std::io::{self, Read, Write};
use std::os::fd::{AsRawFd, FromRawFd};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::Instant;

use blocksim_abi::OK;

use super::{LENGTH, LONGEST, Op, begin, finish, pull, push, word};
use crate::call::Failure;
use crate::guard::move_buffers;
use crate::kind::{At, Kind};
use crate::offer::offer;
use crate::open::{Binary, Library, load};
use crate::watch::{calling, report_to, tag};

/// First word of an answer: results, or a text.
const RESULTS: u32 = 0;
const TEXT: u32 = 1;

/// Serves a plug-in to the process at the other end of the standard input, until that closes it.
///
/// # Errors
/// If the standard input is no such socket.
pub fn serve() -> io::Result<()> {
    // SAFETY: plain calls; the standard input stays open, as what a plug-in finds there must not be the socket.
    let mut stream = unsafe {
        let socket = libc::fcntl(libc::STDIN_FILENO, libc::F_DUPFD_CLOEXEC, 3);
        if socket < 0 {
            return Err(io::Error::last_os_error());
        }
        let nothing = libc::open(c"/dev/null".as_ptr(), libc::O_RDONLY);
        libc::dup2(nothing, libc::STDIN_FILENO);
        libc::close(nothing);
        UnixStream::from_raw_fd(socket)
    };
    stream.peer_addr()?;
    #[cfg(target_os = "linux")]
    // SAFETY: asks to be ended with the thread that has started this process, should that be killed.
    unsafe {
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
    }
    report_to(stream.as_raw_fd());
    let mut message = Vec::new();
    if !receive(&mut stream, &mut message)? {
        return Ok(());
    }
    let (named, is_moving, binary) = split(&message);
    if is_moving {
        move_buffers();
    }
    let library = match load(&binary, &named) {
        Ok(library) => {
            let offer = offer(library);
            answer(&mut stream, &mut message, TEXT, OK, offer.as_bytes())?;
            library
        }
        Err(error) => {
            let text = [error.code, &error.message, error.help.as_deref().unwrap_or_default()].join("\0");
            return answer(&mut stream, &mut message, TEXT, -1, text.as_bytes());
        }
    };
    let mut numbers = Vec::new();
    while receive(&mut stream, &mut message)? {
        let asked = Instant::now();
        let outcome = perform(&named, library, &message, &mut numbers);
        match outcome {
            Ok(results) => {
                begin(&mut message);
                message.extend(RESULTS.to_ne_bytes());
                message.extend(OK.to_ne_bytes());
                push(&mut message, &numbers[results..]);
                push(&mut message, &[asked.elapsed().as_secs_f64()]);
                finish(&mut message);
                stream.write_all(&message)?;
            }
            Err(failure) => {
                answer(&mut stream, &mut message, TEXT, failure.status, failure.text.as_bytes())?;
            }
        }
    }
    Ok(())
}

/// The name, whether buffers move, and the path, from the first message.
fn split(message: &[u8]) -> (String, bool, Binary) {
    use std::os::unix::ffi::OsStrExt;
    let end = message.iter().position(|&byte| byte == 0).unwrap_or(message.len());
    let path = std::ffi::OsStr::from_bytes(message.get(end + 3..).unwrap_or_default());
    (
        String::from_utf8_lossy(&message[..end]).into_owned(),
        message.get(end + 1) == Some(&1),
        Binary { path: PathBuf::from(path), is_module: message.get(end + 2) == Some(&1) },
    )
}

/// Calls what a request names; gives where the results begin in the numbers.
fn perform(named: &str, library: &Library, request: &[u8], numbers: &mut Vec<f64>) -> Result<usize, Failure> {
    let wrong =
        || Failure { status: -1, text: "a bug of blocksim: a request that makes no sense".to_owned() };
    let op = word(request, 0).and_then(Op::of).ok_or_else(wrong)?;
    let block = word(request, 4).and_then(|at| library.blocks.get(at as usize)).ok_or_else(wrong)?;
    let (given, wanted) = op.buffers(block.sizes);
    let count = 1 + given.iter().sum::<usize>() + wanted.iter().sum::<usize>();
    numbers.resize(count, 0.0);
    if !pull(&request[8..], numbers) {
        return Err(wrong());
    }
    let results = 1 + given.iter().sum::<usize>();
    let (inputs, outputs) = numbers.split_at_mut(results);
    call(named, block, op, inputs, &given, outputs)?;
    Ok(results)
}

fn call(
    named: &str,
    kind: &Kind,
    op: Op,
    inputs: &[f64],
    given: &[usize],
    out: &mut [f64],
) -> Result<(), Failure> {
    let (t, mut rest) = (inputs[0], &inputs[1..]);
    let _calling = calling(tag(named, kind.name), 0, t);
    let mut next = |at: usize| {
        let (numbers, more) = rest.split_at(given.get(at).copied().unwrap_or(0));
        rest = more;
        numbers
    };
    let (params, x, xd, u) = (next(0), next(1), next(2), next(3));
    let at = At { params, t, x, xd, u };
    match op {
        Op::Check => kind.check(params),
        Op::SampleTime => {
            out[0] = kind.sample_time(params)?;
            Ok(())
        }
        Op::Reset => {
            let (x, xd) = out.split_at_mut(kind.sizes.x);
            kind.reset(params, x, xd)
        }
        Op::Outputs => kind.outputs(None, &at, out),
        Op::Update => kind.update(None, &at, out),
        Op::Derivatives => kind.derivatives(None, &at, out),
    }
}

fn answer(
    stream: &mut UnixStream,
    message: &mut Vec<u8>,
    kind: u32,
    status: i32,
    body: &[u8],
) -> io::Result<()> {
    begin(message);
    message.extend(kind.to_ne_bytes());
    message.extend(status.to_ne_bytes());
    message.extend(body);
    finish(message);
    stream.write_all(message)
}

/// Receives a message; false at the end.
fn receive(stream: &mut UnixStream, message: &mut Vec<u8>) -> io::Result<bool> {
    let mut length = [0; LENGTH];
    match stream.read_exact(&mut length) {
        Ok(()) => {}
        Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => return Ok(false),
        Err(e) => return Err(e),
    }
    message.clear();
    message.resize((u32::from_ne_bytes(length) as usize).min(LONGEST), 0);
    stream.read_exact(message).map(|()| true)
}
