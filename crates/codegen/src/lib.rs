//! C99 of a part of a compiled diagram, for targets: the laws that the engine runs, joined to programs and written down.
//!
//! A [`Part`] is some blocks of a [`Schedule`] with what goes in and out. [`generate`] turns it
//! into a header, a source, and a test with the inputs and outputs of a simulation of the part alone, which the code reproduces bit by
//! bit in double precision. What cannot be translated is refused with the block, the reason and a remedy.
//!
//! | file | idea |
//! |---|---|
//! | `part` | which blocks, what goes in and out, and when each output group is evaluated |
//! | `refuse` | what cannot be translated, and why |
//! | `programs` | the laws of the part as programs, in the order in which they run |
//! | `replay` | the part alone as a diagram, fed with recorded inputs |
//! | `c` | programs as C99 |

mod c;
mod part;
mod programs;
mod refuse;
mod replay;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{FixedMethod, Schedule};

pub use part::{Part, Port};

/// How a part is translated.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Name of the code: what files, types and functions begin with, as far as C allows it.
    pub name: String,
    /// Time between two steps, s.
    pub step: f64,
    /// How continuous states are integrated; without it there must be none.
    pub method: Option<Method>,
    /// Single precision.
    pub float: bool,
    /// Steps of the test, at most.
    pub test_steps: usize,
}

/// Methods of fixed step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Euler's method, `Ode1` of the engine.
    Euler,
    /// The classical method of Runge and Kutta, `Ode4` of the engine.
    Rk4,
}

impl Method {
    fn of_engine(self) -> FixedMethod {
        match self {
            Method::Euler => FixedMethod::Ode1,
            Method::Rk4 => FixedMethod::Ode4,
        }
    }
}

/// What a part became.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Generated {
    /// Names and texts of the files.
    pub files: Vec<(String, String)>,
    /// The name in C.
    pub name: String,
    /// Steps of the test.
    pub test_steps: usize,
    /// Functions of the mathematical library that the code calls and whose last digit is up to that library.
    pub functions: Vec<String>,
    /// What is doubtful about the method and its step.
    pub warnings: Vec<Problem>,
}

/// Translates a part.
///
/// # Errors
/// Everything that cannot be translated, and a simulation for the test that fails. The code of all is `export`.
pub fn generate(schedule: &Schedule, part: &Part, target: &Target) -> Result<Generated, Vec<Problem>> {
    let selected = part::Selected::new(schedule, part, target);
    let problems = refuse::refusals(&selected);
    if !problems.is_empty() {
        return Err(problems);
    }
    let start = replay::start(&selected).map_err(|problem| vec![problem])?;
    let programs = programs::Programs::new(&selected, &start);
    let record = replay::record(&selected, &start).map_err(|problem| vec![problem])?;
    Ok(c::write(&selected, &start, &programs, &record))
}

/// A refusal.
fn refusal(message: String, help: &str) -> Problem {
    Problem::error("export", message).help(help)
}
