//! Laws as data: formulas that are recorded once with ordinary operators, and the programs that they become.
//!
//! ```
//! use blocksim_law::{Code, Recorder, Sources};
//!
//! let recorder = Recorder::new();
//! let (u1, u2) = (recorder.input("u1"), recorder.input("u2"));
//! recorder.output("y", u1.sin() * u2 + 3.0);
//! let program = recorder.finish().optimised();
//!
//! let code = Code::new(&program, &program.output_values());
//! let mut registers = vec![0.0; code.registers()];
//! assert!(code.run(&Sources { inputs: &[0.5, 2.0], ..Sources::default() }, &mut registers).is_none());
//! assert_eq!(code.result(&registers, 0), 0.5_f64.sin() * 2.0 + 3.0);
//! ```
//!
//! A [`Program`] is in static single assignment: a flat list of typed instructions, each behind those that it needs.
//! Passes are functions from program to program. Truth values are numbers, 0 and 1. What jumps is held: a [`Mode`] keeps
//! its value between major steps and names the guards at whose zeros it may change. What has a kink says where.
//! The crate knows neither blocks nor diagrams.

mod along;
mod code;
mod interpreter;
mod op;
mod print;
mod program;
mod recorder;
mod replay;
mod tangent;
mod tape;

pub mod passes;

pub use along::Along;
pub use code::{Code, Failure, Sources};
pub use op::{Binary, Domain, Id, Op, Relation, Unary};
pub use program::{Guard, Instruction, Memory, Mode, Program, State};
pub use recorder::{Condition, Recorder, Value};
pub use replay::{Outside, Replayed};
pub use tangent::{rates, slopes, tangent};
pub use tape::{Leaf, Machine, Made, Met, Ran, Root, Tape, Word, WordCode};
