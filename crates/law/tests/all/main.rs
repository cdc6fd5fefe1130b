//! Laws against evaluators that are written differently, closed forms and differences.

mod modes;
mod passes;
mod random;
mod slopes;
