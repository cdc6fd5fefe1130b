//! Linear systems: what control engineers want to know of them. Knows nothing of blocks, diagrams and files; names and
//! units are kept by the caller.
//!
//! A [`StateSpace`] has any number of inputs and outputs, a [`Channel`] one of each. Both are in continuous time or
//! have a period. [`jacobian`] makes them of any function, by differences whose accuracy it tells.
//!
//! | file | idea |
//! |---|---|
//! | `differences` | derivatives of a function, with their accuracy and the kinks at hand |
//! | `system` | the matrices; one channel of them; sampling with a zero-order hold |
//! | `constrained` | states that others decide, by what is zero whatever happens |
//! | `transition` | what a system whose matrices change with time makes of its states over a step |
//! | `minimal` | what of a channel can be reached and seen, and what leaving the rest away changes |
//! | `parts` | which states depend on each other in a circle |
//! | `poles`, `zeros` | eigenvalues with damping and frequency; invariant zeros |
//! | `response`, `course` | over frequency; over time |
//! | `delayed` | dead times as they are, in a system of one input and output |
//! | `grid`, `margins` | frequencies worth looking at; gain, phase and delay margins, bandwidth |

mod constrained;
mod course;
mod delayed;
mod differences;
mod error;
mod grid;
mod margins;
mod minimal;
mod parts;
mod poles;
mod response;
mod system;
mod transition;
mod zeros;

pub use constrained::{Constrained, Directions, directions};
pub use course::{StepInfo, step_info, step_response};
pub use delayed::Delayed;
pub use differences::{Jacobian, Kink, jacobian, jacobian_over, sparse_jacobian};
pub use error::LinearError;
pub use grid::frequencies;
pub use margins::{Margin, Margins, bandwidth, bandwidth_delayed, is_at_border, margins, margins_delayed};
pub use minimal::{Reduced, minimal, reduced};
pub use nalgebra::Complex;
pub use nalgebra::DMatrix;
pub use poles::{Mode, is_stable, modes, poles, poles_by_part};
pub use response::{Gain, Response, static_gain};
pub use system::{Channel, StateSpace};
pub use transition::{Instant, NODES, transition};
pub use zeros::zeros;
