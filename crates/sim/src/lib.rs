//! Runs a compiled diagram: it gives time to a [`Schedule`](blocksim_block::schedule::Schedule).
//!
//! One [`Simulation`] owns all that changes (time, states, signals, scratch space); the schedule is shared. What comes
//! out is handed to an [`Observer`] row by row. The engine knows no text and no files, and it does not allocate once it
//! has started.
//!
//! | room | what is in it |
//! |---|---|
//! | `simulation`, `error`, `diagnose`, `snapshot` | the step loop; what can go wrong and why; save and restore |
//! | `stepping` | how time goes on: instants (`major`), resets from outside (`early`), steps up to the next instant (`advance`), no longer than an eighth of a turn (`angles`), sample hits (`clock`), what blocks remember of steps (`past`), the choice of the method (`methods`) |
//! | `events` | conditions over a step: values (`guards`), zeros (`crossings`), looks at stages (`looks`), extrema (`turn`, `scan`, `slopes`, `peaks`), kinks, hops below the tolerance, flat departures from zero, modes; events that come faster and faster (`rhythm`) or are too many (`pace`); `audit` |
//! | `evaluation` | one point of time and states: calls of the blocks (`evaluate`, `act`), algebraic loops (`loops`), what the solver sees (`system`), outputs that are held (`hold`, `stepwise`) |
//! | `program` | the schedule as it is run: flat (`plan`), laws as tapes (`fused`), machine code (`native`), what depends on what (`graph`, `spread`, `influence`), for those who print it (`listing`) |
//! | `rows` | what is recorded (`record`), on which sides of sample hits (`sides`), and within steps (`refine`) |
//! | `variation` | what if: a simulation at one instant (`frozen`), signals changed from outside (`taps`), from one sample hit to the next (`period`), slopes by the chain rule (`chain`), derivatives by parameters (`sensitivity`) |
//! | `steady`, `verify`, `ignored_states`, `floors`, `coarse_step` | where nothing moves; how far a more exact run is; states below all tolerances; states where no law holds; fixed steps too long for a source |

mod coarse_step;
mod diagnose;
mod error;
mod evaluation;
mod events;
mod floors;
mod ignored_states;
mod program;
mod rows;
mod simulation;
mod snapshot;
mod steady;
mod stepping;
mod tuning;
mod variation;
mod verify;

pub use diagnose::state_names;
pub use error::SimError;
pub use events::audit::{Findings, Missed};
pub use program::exact_slopes::Slope;
pub use program::influence::Undeclared;
pub use program::listing::{LoopMethod, Pass, PassKind, PassPart, passes};
pub use rows::record::{Control, Observer};
pub use simulation::{Counts, Ended, Simulation};
pub use snapshot::Snapshot;
pub use steady::Rest;
pub use tuning::{NUMBERS, other_model, untunable};
pub use variation::chain::Origin;
pub use variation::frozen::{Frozen, Tap};
pub use variation::period::{Period, PeriodMap, PeriodSlopes};
pub use variation::sensitivity::{
    Course, DISTANCES, Sensitivity, course, sensitivity, sensitivity_on, tangent_on,
};
pub use verify::{Difference, Verification, verify};

pub use blocksim_solve::Share;
