//! block-macros
