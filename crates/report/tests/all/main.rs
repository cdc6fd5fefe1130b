//! The page of a run.

mod browser;
mod page;
mod values;
