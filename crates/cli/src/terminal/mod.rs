//! What is written to the terminal: where it goes, and how problems, numbers, formulas and pages of the manual look there.

pub mod browser;
pub mod clean;
pub mod console;
pub mod diff;
pub mod format;
mod formula;
pub mod places;
pub mod progress;
pub mod prose;
pub mod render;
