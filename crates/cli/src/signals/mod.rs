//! Recorded signals as people ask for them: by name, in display units, in pairs of set and actual values, as charts.

pub mod charts;
pub mod differences;
pub mod followed;
pub mod headings;
pub mod naming;
pub mod other;
pub mod shown;
pub mod traces;
pub mod tracking;
