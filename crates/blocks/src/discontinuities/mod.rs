//! Blocks: discontinuities.

mod backlash;
mod dead_zone;
mod quantizer;
mod rate_limiter;
mod relay;
mod saturation;

pub use backlash::Backlash;
pub use dead_zone::DeadZone;
pub use quantizer::Quantizer;
pub use rate_limiter::RateLimiter;
pub use relay::Relay;
pub use saturation::Saturation;
