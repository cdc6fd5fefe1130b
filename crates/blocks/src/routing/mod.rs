//! Blocks: routing.
