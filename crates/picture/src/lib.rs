//! Pictures: drawings in SVG made into PNG, and how wide a text is. Knows nothing of blocks and plots.
//!
//! A drawing is text in SVG 1.1 with literal colours. Its `text` elements are drawn with a font that comes with
//! the program, so that a picture is the same everywhere; see [`png`] for what they may say.

mod error;
mod font;
mod outline;
mod raster;

pub use error::PictureError;
pub use font::text_width;
pub use raster::png;
