//! What stands above what in each layer.

pub(crate) mod crossings;
pub(crate) mod improve;
pub(crate) mod insert;
pub(crate) mod lanes;
pub(crate) mod search;
pub(crate) mod stack;
