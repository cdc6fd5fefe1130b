//! A run from the method that it is solved with to what is kept and said of it.

pub mod blame;
pub mod happenings;
pub mod interrupt;
pub mod keep;
pub mod live;
pub mod manifest;
mod meshes;
pub mod model_text;
pub mod native;
pub mod parallel;
pub mod recorder;
pub mod report;
pub mod rescue;
pub mod selection;
pub mod solver;
pub mod start;
mod summary;
pub mod tuning;
pub mod varied;
