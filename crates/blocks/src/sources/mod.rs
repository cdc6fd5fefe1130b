//! Blocks: sources.
