//! Blocks: sources.

mod chirp;
mod clock;
mod constant;
mod from_file;
mod pulse;
mod ramp;
mod sine;
mod step;
mod table;

pub use chirp::Chirp;
pub use clock::Clock;
pub use constant::Constant;
pub use from_file::{After, FromFile};
pub use pulse::Pulse;
pub use ramp::Ramp;
pub use sine::Sine;
pub use step::Step;
