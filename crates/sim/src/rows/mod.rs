//! What is recorded, and when.

pub(crate) mod record;
pub(crate) mod refine;
pub(crate) mod sides;
