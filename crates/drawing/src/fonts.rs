//! Sizes of texts.

/// Names below blocks.
pub(crate) const NAME: f64 = 10.0;
/// Texts in signs.
pub(crate) const TEXT: f64 = 11.0;
/// Names of ports.
pub(crate) const PORT: f64 = 8.5;
/// Distance of the lines of a name.
pub(crate) const LINE: f64 = 12.0;
