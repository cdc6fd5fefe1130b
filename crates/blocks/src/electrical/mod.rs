//! Blocks: electrical.
