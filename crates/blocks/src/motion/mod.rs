//! Blocks: motion.
