//! A run as one HTML page that needs nothing else: it opens from disk, prints, and works without a network.
//!
//! A [`Report`] is plain data; [`html`] makes the page. Numbers travel as compressed typed arrays, thinned to what a
//! screen shows unless [`Report::full`] asks for all. Knows nothing of blocks, diagrams and files.
//!
//! No text of a model can become a script: texts are escaped, and the page's own policy names the hashes of the only
//! scripts that a browser may run.

mod assets;
mod body;
mod corridor;
mod data;
mod diagram;
mod escape;
mod numbers;
mod other_signals;
mod pack;
mod page;
mod surface;
mod thin;

pub use assets::{Asset, DIAGRAM, MAIN, SCRIPTS, SPACE, STYLES, VENDORED, Vendored};
pub use corridor::{Few, few};
pub use data::{
    Animation, Compared, Contact, Diagram, Drawing, Effort, Event, Inspected, Kind, Level, Net, Overlay,
    Panel, PlanePicture, PortPlace, Probe, Report, Role, Rows, Series, Unseen,
};
pub use diagram::texts;
pub use escape::escape;
pub use page::html;
pub use surface::{Surface, surfaces};
pub use thin::rows as telling_rows;

/// Bytes that a page is made to fit into unless all values are asked for.
pub const BUDGET: usize = 500_000;
