//! Numbers about signals over time: how well one follows another, whether two are the same within tolerances, and by
//! how much one is late. Knows nothing of blocks, files and units.
//!
//! A signal is a [`Series`]: times and values. Two values may share a time, those before and after a jump.

mod align;
mod bounds;
mod compare;
mod cut;
mod metrics;
mod series;
mod smooth;
mod statistics;
mod together;
mod turns;

pub use align::lag;
pub use compare::{Comparison, Deviation, Instants, Rule, compare};
pub use cut::cut;
pub use metrics::{Metrics, metrics};
pub use series::{Interpolation, Series};
pub use smooth::refined;
pub use statistics::{Statistics, statistics};
pub use together::together;
pub use turns::{brought_together, continued, jumps, with_gaps, without_jumps};
