//! Blocks: discrete.
