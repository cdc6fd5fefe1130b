//! Blocks: discontinuities.
