//! Runs a compiled diagram: it gives time to a [`Schedule`](blocksim_block::schedule::Schedule).
//!
//! One [`Simulation`] owns all that changes (time, states, signals, scratch space); the schedule is shared. What comes
//! out is handed to an [`Observer`] row by row. The engine knows no text and no files, and it does not allocate once it
//! has started.
//!
//! | file | idea |
//! |---|---|
//! | `simulation` | the step loop |
//! | `major` | what happens at one instant: outputs, jumps, record, updates |
//! | `early` | resets from outside, which come before all else of their time |
//! | `advance` | from one instant to the next: solver, events, rows in between |
//! | `guards`, `looks`, `slopes`, `turn`, `scan` | conditions over a step: values, looks at stages, extrema, samples |
//! | `rhythm`, `pace` | events that come faster and faster; too many of them |
//! | `audit`, `verify` | was anything passed over? how far is a more exact run? |
//! | `plan` | the schedule as the hot loop wants it |
//! | `evaluate`, `act`, `system` | calls of the blocks: outputs, all else, and what the solver sees |
//! | `clock`, `events`, `modes` | sample hits and time events; zero crossings; modes where nobody looks for these |
//! | `record`, `sides`, `refine` | rows; which sample hits need them on both sides; rows within steps |
//! | `angles` | steps no longer than an eighth of a turn of what turns |
//! | `departure` | guards that leave zero flatly |
//! | `hops` | hops of guards that are lower than the tolerance |
//! | `stepwise` | whether outputs that change at major steps alone have changed |
//! | `graph`, `spread` | which output depends on which at the same time; what depends at once on some signals |
//! | `influence` | which derivatives a state can act on, and whether that is so |
//! | `chain` | slopes of what a pass computes, by the chain rule over its calls |
//! | `kinks` | steps that have looked beyond a kink, once more |
//! | `fused`, `listing` | laws that are data, run as one; what is run, for those who print it |
//! | `native` | machine code in the place of what runs them |
//! | `past` | what blocks remember of steps |
//! | `taps`, `period` | signals that can be changed from outside; the map of a model from one sample hit to another |
//! | `frozen` | a simulation at one instant: what if a state or a signal were a bit different |
//! | `steady` | where nothing moves, and where signals have given values |
//! | `sensitivity` | derivatives of recorded signals by a parameter |
//! | `methods`, `error`, `diagnose`, `snapshot` | choice of the solver; what can go wrong and why; save and restore |

mod act;
mod advance;
mod angles;
mod audit;
mod chain;
mod clock;
mod departure;
mod diagnose;
mod early;
mod error;
mod evaluate;
mod events;
mod exact_slopes;
mod frozen;
mod fused;
mod graph;
mod guards;
mod hold;
mod hops;
mod ignored_states;
mod influence;
mod kinks;
mod listing;
mod looks;
mod loops;
mod major;
mod methods;
mod modes;
mod native;
mod pace;
mod past;
mod peaks;
mod period;
mod plan;
mod record;
mod refine;
mod rhythm;
mod scan;
mod sensitivity;
mod sides;
mod simulation;
mod slopes;
mod snapshot;
mod spread;
mod steady;
mod stepwise;
mod system;
mod taps;
mod turn;
mod verify;

pub use audit::{Findings, Missed};
pub use chain::Origin;
pub use diagnose::state_names;
pub use error::SimError;
pub use exact_slopes::Slope;
pub use frozen::{Frozen, Tap};
pub use influence::Undeclared;
pub use listing::{LoopMethod, Pass, PassKind, PassPart, passes};
pub use period::{Period, PeriodMap};
pub use record::{Control, Observer};
pub use sensitivity::{DISTANCES, Sensitivity, sensitivity};
pub use simulation::{Counts, Ended, Simulation};
pub use snapshot::Snapshot;
pub use steady::Rest;
pub use verify::{Difference, Verification, verify};

pub use blocksim_solve::Share;
