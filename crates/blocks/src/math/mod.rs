//! Blocks: math.

mod abs;
mod algebraic_constraint;
mod atan2;
mod compare;
mod convert;
mod divide;
pub(crate) mod elements;
mod expression;
mod function;
mod gain;
mod linear_solve;
mod logic;
mod min_max;
mod power;
mod product;
mod sign;
mod sum;
mod switch;

pub use abs::Abs;
pub use algebraic_constraint::AlgebraicConstraint;
pub use atan2::Atan2;
pub use compare::{Compare, Relation};
pub use convert::Convert;
pub use divide::Divide;
pub use expression::Expression;
pub use function::{Function, FunctionName};
pub use gain::Gain;
pub use linear_solve::LinearSolve;
pub use logic::{Gate, Logic};
pub use min_max::{Extremum, MinMax};
pub use power::Power;
pub use product::Product;
pub use sign::Sign;
pub use sum::Sum;
pub use switch::Switch;
