//! Blocks: sources.

mod chirp;
mod clock;
mod constant;
mod course;
mod from_file;
mod noise;
mod prbs;
mod pulse;
mod ramp;
mod sawtooth;
mod signal_builder;
mod sine;
mod step;
mod table;

pub use chirp::Chirp;
pub use clock::Clock;
pub use constant::Constant;
pub use course::After;
pub use from_file::FromFile;
pub use noise::{Distribution, Noise};
pub use prbs::Prbs;
pub use pulse::Pulse;
pub use ramp::Ramp;
pub use sawtooth::Sawtooth;
pub use signal_builder::{Interpolation, SignalBuilder};
pub use sine::Sine;
pub use step::Step;
