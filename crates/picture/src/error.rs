use std::fmt;

/// Why a drawing cannot be made into a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PictureError {
    /// The text is no SVG.
    NotSvg(String),
    /// The picture would have more dots than is sensible.
    TooLarge {
        /// Dots across.
        width: u64,
        /// Dots down.
        height: u64,
    },
    /// The picture cannot be packed.
    Packing(String),
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PictureError::NotSvg(reason) => write!(f, "this is not a drawing in SVG: {reason}"),
            PictureError::TooLarge { width, height } => {
                write!(f, "a picture of {width} x {height} dots is too large; choose a smaller size or scale")
            }
            PictureError::Packing(reason) => write!(f, "the picture cannot be packed as PNG: {reason}"),
        }
    }
}

impl std::error::Error for PictureError {}
