//! Blocks: sinks.
