//! Blocks: discontinuities.

mod backlash;
mod counter;
mod dead_zone;
mod hit_crossing;
mod on_off_delay;
mod quantizer;
mod rate_limiter;
mod relay;
mod saturation;
mod sr_flip_flop;

pub use backlash::Backlash;
pub use counter::{AtLimit, Counter};
pub use dead_zone::DeadZone;
pub use hit_crossing::HitCrossing;
pub use on_off_delay::OnOffDelay;
pub use quantizer::Quantizer;
pub use rate_limiter::RateLimiter;
pub use relay::Relay;
pub use saturation::Saturation;
pub(crate) use saturation::crossed;
pub use sr_flip_flop::{Priority, SrFlipFlop};
