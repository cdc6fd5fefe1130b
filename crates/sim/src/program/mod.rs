//! The schedule as it is run.

pub(crate) mod direct;
pub(crate) mod exact_slopes;
pub(crate) mod fused;
pub(crate) mod graph;
pub(crate) mod influence;
pub(crate) mod listing;
pub(crate) mod native;
pub(crate) mod plain;
pub(crate) mod plan;
pub(crate) mod spread;
pub(crate) mod stages;
pub(crate) mod whole;
