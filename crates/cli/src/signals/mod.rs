//! Recorded signals as people ask for them: by name, in display units, in pairs of set and actual values, as charts.

pub mod charts;
pub mod differences;
pub mod display;
pub mod headings;
pub mod measured;
pub mod naming;
pub mod other;
pub mod traces;
pub mod tracking;
pub mod tracking_table;
