//! Pictures: colours of drawings, how wide a text is, and drawings in SVG made into PNG. Knows nothing of blocks and plots.
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
#[cfg(feature = "png")]
mod raster;

#[cfg(feature = "png")]
pub use error::PictureError;
pub use font::text_width;
pub use palette::{Palette, Theme};
#[cfg(feature = "png")]
pub use raster::png;
