//! Drawings of block diagrams: from a level of a model to SVG, or to signs of a terminal.
//!
//! ```text
//! Model -level-> Level -layout-> Layout -svg-> SVG text
//!                                       -text-> lines of signs
//! ```
//!
//! Every block wears the sign of its field, [`blocksim_block::Symbol`]. Texts are escaped: no name of a diagram can add
//! anything to a drawing.

mod bus;
mod canvas;
mod colours;
mod figure;
mod fonts;
mod layers;
mod level;
mod marks;
mod size;
mod svg;
mod symbols;
mod text;
mod walk;

pub use blocksim_picture::Theme;
pub use colours::{style_sheet, style_variables};
pub use figure::{Figure, Look, PortLook};
pub use layers::{Facts, Layer, LevelFacts, OfBlock, OfWire, Pace};
pub use level::{Level, Line, level};
pub use marks::Marks;
pub use svg::{inline, svg, svg_with_layers, svg_with_marks};
pub use text::text;
pub use walk::{PathError, all_levels, level_at};
