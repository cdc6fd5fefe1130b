//! Generated code, compiled by the compiler of the system and held against the engine.

mod agreement;
mod refusals;
mod support;
mod texts;
