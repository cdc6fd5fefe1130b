//! Blocks: discontinuities.

mod backlash;
mod dead_zone;
mod hit_crossing;
mod quantizer;
mod rate_limiter;
mod relay;
mod saturation;

pub use backlash::Backlash;
pub use dead_zone::DeadZone;
pub use hit_crossing::HitCrossing;
pub use quantizer::Quantizer;
pub use rate_limiter::RateLimiter;
pub use relay::Relay;
pub use saturation::Saturation;
