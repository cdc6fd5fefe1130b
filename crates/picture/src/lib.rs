//! Pictures: colours of drawings, how wide a text is, signals over time as drawings ([`plot`]), and drawings in SVG made into PNG. Knows
//! nothing of blocks and files.
//!
//! A drawing is text in SVG 1.1 with literal colours. Its `text` elements are drawn with a font that comes with
//! the program, so that a picture is the same everywhere; see `png` for what they may say. Pictures are made where the feature
//! `png` is on; widths need nothing.

#[cfg(feature = "png")]
mod error;
mod font;
#[cfg(feature = "png")]
mod glyphs;
#[cfg(feature = "png")]
mod outline;
mod palette;
pub mod plot;
#[cfg(feature = "png")]
mod raster;

#[cfg(feature = "png")]
pub use error::PictureError;
pub use font::text_width;
pub use palette::{Palette, Theme};
pub use plot::{
    Across, Figure, Label, Line, Mark, Panel, Plane, PlaneAxis, Sign, Strip, Style, pages, pairs, plane_svg,
    pretty_unit, svg, thinned,
};
#[cfg(feature = "png")]
pub use raster::png;
