//! Random circuits: sources of voltage and current, coils, capacitors, resistances, ideal transformers, and valves of all kinds,
//! with gates that follow time or a sampled state.
//!
//! The reference goes ahead in short equal steps, in which coils and capacitors are resistances with a source, and tries sets of
//! conducting valves until one contradicts nothing. Engine and reference must agree on currents of coils and voltages of
//! capacitors, at the end or all along, and on the integrals of the potentials; no diode may ever be on the wrong side.
//!
//! | file | idea |
//! |---|---|
//! | `circuit` | what a circuit is: nodes and branches |
//! | `draw` | circuits of a seed |
//! | `text` | their diagram |
//! | `walk` | motion in time, by a method of fixed steps |
//! | `nodal` | the equations of one stage for a set of conducting valves |
//! | `reference` | what comes out, and by how much it may be off |
//! | `compare` | a run compared with what is known |

mod circuit;
mod compare;
mod draw;
mod nodal;
mod reference;
mod text;
mod walk;

use super::dice::rounded;
use super::puzzle::{Fault, Puzzle, Undecided};
use super::variants::Variant;
use crate::Run;
pub use circuit::{Branch, Circuit, Gate, Kind, Source, Valve};
pub use compare::contradiction;
pub use reference::Outcome;

/// Runs are not shrunk below this, s: what is wrong then is something else.
const SHORTEST: f64 = 5e-4;

impl Puzzle for Circuit {
    type Outcome = Outcome;

    fn of(seed: u64) -> Self {
        draw::draw(seed)
    }

    fn text(&self, variant: &Variant) -> String {
        text::diagram(self, variant)
    }

    fn refer(&self, effort: u32, change: f64) -> Result<Outcome, Undecided> {
        reference::refer(self, effort, change)
    }

    fn compare(&self, outcome: &Outcome, run: &Run) -> Option<Fault> {
        compare::compare(self, outcome, run)
    }

    fn simpler(&self) -> Vec<Self> {
        let mut all = Vec::new();
        for share in [0.25, 0.5, 0.8] {
            let stop = rounded(share * self.stop);
            if stop >= SHORTEST {
                all.push(Circuit { stop, ..self.clone() });
            }
        }
        // What is left must still give every node a way to ground and every transformer its own.
        for k in 0..self.branches.len() {
            all.push(self.without(k));
        }
        for k in 0..self.branches.len() {
            for kind in self.branches[k].kind.simpler() {
                let mut simple = self.clone();
                simple.branches[k].kind = kind;
                all.push(simple);
            }
        }
        all.push(Circuit { integrals: false, ..self.clone() });
        all.push(Circuit { every: None, ..self.clone() });
        all.retain(Circuit::is_sound);
        all
    }
}
