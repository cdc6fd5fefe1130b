//! Random models of signals, as a judge of the engine that shares nothing with it.
//!
//! A model is made of a seed: sources, limits, logic, memories, dead times, integrators and controllers, wired at random. It
//! is run twice: by the engine, from the text of its diagram and with default settings, and by a small interpreter
//! that goes ahead in tiny steps of fixed length and brackets what switches by bisection. Both must agree on what every signal
//! is in the end, how often it has jumped, and what its integral is.
//!
//! What nobody can decide is left out and counted: models that chatter, that touch a threshold without crossing it, or
//! that turn out otherwise if their derivatives and thresholds change by a few millionths.
//!
//! | file | idea |
//! |---|---|
//! | `dice` | numbers at random, from a seed |
//! | `model` | what a model is: nodes, each with a law and inputs |
//! | `generate` | a model of a seed |
//! | `text` | its diagram |
//! | `reference` | what comes out, by how much it may be off, whether anybody can know |
//! | `run`, `nodes`, `memory`, `laws` | the interpreter: time and instants, nodes at a point, what they remember, what they do |
//! | `judge` | both results compared |
//! | `variants` | the same model put differently: other methods, tolerances, names, rows |
//! | `shrink` | the smallest model that still fails |
//!
//! Beside these models of any signals there are classes with references of their own:
//!
//! | file | idea |
//! |---|---|
//! | `puzzle` | what classes have in common |
//! | `mechanisms` | chains of pendulums, closed loops, balls on planes, with friction, springs and ends of travel |
//! | `sampled` | loops of sampled control at one or two rates around continuous plants |

mod dice;
mod generate;
mod judge;
mod laws;
mod mechanisms;
mod memory;
mod model;
mod nodes;
mod puzzle;
mod reference;
mod run;
mod sampled;
mod shrink;
mod text;
mod variants;

pub use dice::Dice;
pub use generate::{Size, generate};
pub use judge::{Fault, Verdict, compare, judge};
pub use mechanisms::Mechanisms;
pub use model::{Law, Model, Node};
pub use puzzle::{Finding, Puzzle, least};
pub use reference::{Outcome, Undecided, refer};
pub use sampled::Sampled;
pub use shrink::shrink;
pub use text::diagram;
pub use variants::{Variant, vary};
