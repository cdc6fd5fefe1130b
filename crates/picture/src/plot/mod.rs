//! Signals over time as drawings: plain data to SVG, light and dark. Knows nothing of blocks and files.
//!
//! A [`Figure`] is a grid of [`Panel`]s; a panel has [`Line`]s over one axis of time and, where set and actual values
//! are paired, a strip with their difference below. [`thinned`] reduces any number of values to what a screen can
//! show, [`pairs`] finds set and actual values by their names, and [`svg`] draws. A [`Plane`] has curves and marks over two axes of
//! numbers.

mod decimate;
mod figure;
mod frame;
mod legend;
mod paired;
mod plane;
mod straighten;
mod svg;
mod units;

pub use decimate::thinned;
pub use figure::{Across, Figure, Line, Panel, PlaneAxis, Strip, Style};
pub use paired::pairs;
pub use plane::{Label, Mark, Plane, Sign, plane_svg};
pub use svg::{pages, svg};
pub use units::pretty_unit;
