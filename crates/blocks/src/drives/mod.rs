//! Blocks: electronics of drives, as signals.

pub mod modulation;
