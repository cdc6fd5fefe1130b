//! Plug-ins in processes of their own: the same functions with the same numbers, over a socket.
//!
//! A process serves one library to one thread, so that runs at the same time do not wait for each other. It is this program
//! again (`serve`), with the socket as its standard input. A request is an operation, a block, a time and the numbers of its
//! buffers; an answer is a status and the results, or a text. Whatever becomes of that process, this one goes on.

#[cfg(not(unix))]
mod elsewhere;
#[cfg(unix)]
mod parent;
#[cfg(unix)]
mod serve;

use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

#[cfg(not(unix))]
pub use elsewhere::{Remote, last_duration, open, serve, was_interrupted};
#[cfg(unix)]
pub use parent::{Remote, last_duration, open, was_interrupted};
#[cfg(unix)]
pub use serve::serve;

use crate::kind::Sizes;

/// The program that serves plug-ins, with its arguments.
static PROGRAM: RwLock<Option<(PathBuf, &'static [&'static str])>> = RwLock::new(None);

/// From now on plug-ins are not loaded into this process but served by this program, which with these arguments calls
/// [`serve`].
pub fn set_isolation(program: PathBuf, arguments: &'static [&'static str]) {
    *PROGRAM.write().unwrap_or_else(PoisonError::into_inner) = Some((program, arguments));
}

/// Whether plug-ins are kept out of this process.
pub fn is_isolated() -> bool {
    PROGRAM.read().unwrap_or_else(PoisonError::into_inner).is_some()
}

/// What a process is asked to do with a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Op {
    /// See the functions of the contract.
    Check,
    SampleTime,
    Reset,
    Outputs,
    Update,
    Derivatives,
}

impl Op {
    const ALL: [Op; 6] = [Op::Check, Op::SampleTime, Op::Reset, Op::Outputs, Op::Update, Op::Derivatives];

    /// The function of the contract.
    #[cfg(feature = "wasm")]
    pub fn name(self) -> &'static str {
        match self {
            Op::Check => "check",
            Op::SampleTime => "sample_time",
            Op::Reset => "reset",
            Op::Outputs => "outputs",
            Op::Update => "update",
            Op::Derivatives => "derivatives",
        }
    }

    fn of(number: u32) -> Option<Op> {
        Op::ALL.get(number as usize).copied()
    }

    /// How many numbers each buffer holds: given ones, then wanted ones.
    pub fn buffers(self, sizes: Sizes) -> (Vec<usize>, Vec<usize>) {
        let Sizes { params, u, y, x, xd } = sizes;
        match self {
            Op::Check => (vec![params], vec![]),
            Op::SampleTime => (vec![params], vec![1]),
            Op::Reset => (vec![params], vec![x, xd]),
            Op::Outputs => (vec![params, x, xd, u], vec![y]),
            Op::Update => (vec![params, x, xd, u], vec![xd]),
            Op::Derivatives => (vec![params, x, xd, u], vec![x]),
        }
    }
}

/// Bytes before a message: how many follow.
const LENGTH: usize = 4;
/// Longer messages are not of this program.
const LONGEST: usize = 1 << 28;

/// Begins a message; its length is filled in by [`finish`].
fn begin(message: &mut Vec<u8>) {
    message.clear();
    message.extend([0; LENGTH]);
}

fn finish(message: &mut [u8]) {
    let length = (message.len() - LENGTH) as u32;
    message[..LENGTH].copy_from_slice(&length.to_ne_bytes());
}

fn push(message: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| message.extend(number.to_ne_bytes()));
}

/// As many numbers as there is room for; whether the bytes are exactly those.
fn pull(bytes: &[u8], numbers: &mut [f64]) -> bool {
    let (words, rest) = bytes.as_chunks::<8>();
    numbers.iter_mut().zip(words).for_each(|(number, word)| *number = f64::from_ne_bytes(*word));
    rest.is_empty() && words.len() == numbers.len()
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_ne_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
