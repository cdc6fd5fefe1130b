//! Blocks that look values up in tables.

mod akima;
mod interval;
pub use interval::Extrapolation;
mod lookup_table_1d;
pub use lookup_table_1d::{Interpolation, LookupTable1D};
mod lookup_table_2d;
pub use lookup_table_2d::LookupTable2D;
