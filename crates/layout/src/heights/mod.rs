//! Heights in a given order.

pub(crate) mod rows;
pub(crate) mod straighten;
