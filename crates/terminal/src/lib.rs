//! Tables, plots and lines of signals for a person at a terminal, as text.

mod canvas;
mod plot;
mod sparkline;
mod table;

pub use plot::{PlotOptions, Series, plot};
pub use sparkline::sparkline;
pub use table::{Align, Table};
