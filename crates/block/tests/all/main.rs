//! Parameters of kinds of block, as they are read.

mod groups;
mod reading;
