//! A simulation at one instant, and what if something were a bit different.

pub(crate) mod chain;
pub(crate) mod frozen;
pub(crate) mod period;
pub(crate) mod sensitivity;
pub(crate) mod taps;
