//! Blocks: lookup.
