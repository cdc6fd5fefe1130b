//! What is computed at one point of time and states.

pub(crate) mod act;
pub(crate) mod evaluate;
pub(crate) mod hold;
pub(crate) mod loops;
pub(crate) mod stepwise;
pub(crate) mod system;
