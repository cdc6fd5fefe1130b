//! Numbers for people: with as many digits as make sense, and round ones for axes. Knows nothing else.

pub mod format;
pub mod ticks;
