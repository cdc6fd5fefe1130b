//! Values, shapes, units and the expressions that combine them.
//!
//! Everything a diagram says in numbers passes through this crate: `"12.5 kW"` becomes a [`Quantity`] in SI units
//! with its [`Dimension`], `"robot.axis1.mass * 9.81 m/s^2"` is [`evaluate`]d against a [`Scope`], and ports describe
//! their signals by [`Shape`], [`Kind`] and [`SampleTime`]. The crate knows no block, no diagram and no file.

mod arithmetic;
mod dimension;
mod error;
mod expression;
mod formula;
mod functions;
mod lexer;
mod quantity;
mod scope;
mod select;
mod shape;
mod spelling;
mod unit;
mod unit_hint;
mod unit_reader;
mod unit_table;
mod value;

pub use dimension::Dimension;
pub use error::ExprError;
pub use expression::{Noted, evaluate, evaluate_noted};
pub use formula::{Comparison, Formula, Function, Node, NodeKind, Operator};
pub use quantity::{Quantity, si_text};
pub use scope::{Lookup, Part, Scope};
pub use shape::{Kind, SampleTime, Shape};
pub use spelling::{closest, surely};
pub use unit::{Unit, UnitError};
pub use value::Value;
