//! Random models of any signals.
//!
//! A model is made of sources, limits, logic, memories, dead times, integrators and controllers, wired at random. Its reference is
//! a small interpreter that goes ahead in tiny steps of fixed length and brackets what switches by bisection. Engine and interpreter
//! must agree on what every signal is in the end, how often it has jumped, and what its integral is.
//!
//! What nobody can decide is left out and counted: models that chatter, that touch a threshold without crossing it, or
//! that turn out otherwise if their derivatives and thresholds change by a few millionths.
//!
//! | file | idea |
//! |---|---|
//! | `model` | what a model is: nodes, each with a law and inputs |
//! | `generate` | a model of a seed |
//! | `text` | its diagram |
//! | `reference` | what comes out, by how much it may be off, whether anybody can know |
//! | `run`, `nodes`, `memory`, `laws` | the interpreter: time and instants, nodes at a point, what they remember, what they do |
//! | `compare` | a run compared with what is known |
//! | `simpler` | models that are a little simpler |

mod compare;
mod generate;
mod laws;
mod memory;
mod model;
mod nodes;
mod reference;
mod run;
mod simpler;
mod text;

use super::puzzle::{Fault, Puzzle, Undecided};
use super::variants::Variant;
use crate::Run;
pub use model::Model as Signals;
use reference::Outcome;

/// Runs are not made shorter than this, s.
const SHORTEST: f64 = 0.1;

impl Puzzle for Signals {
    type Outcome = Outcome;
    const EFFORT: u32 = 2;

    fn of(seed: u64) -> Self {
        generate::generate(seed)
    }

    fn text(&self, variant: &Variant) -> String {
        text::diagram(self, variant)
    }

    fn refer(&self, effort: u32, change: f64) -> Result<Outcome, Undecided> {
        reference::refer(self, effort, change)
    }

    fn shorter(&self) -> Option<Self> {
        (self.stop > SHORTEST).then(|| Self { stop: 0.5 * self.stop, ..self.clone() })
    }

    fn compare(&self, outcome: &Outcome, run: &Run) -> Option<Fault> {
        compare::compare(self, outcome, run)
    }

    fn simpler(&self) -> Vec<Self> {
        simpler::simpler(self)
    }
}
