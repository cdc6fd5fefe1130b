//! One concrete deserializer for the parameters of all kinds of block.
//!
//! The registry of kinds hands a type-erased deserializer to each of them. Everything that a type asks of it directly is
//! compiled anew for this type, some thirty functions each time, and there are hundreds of kinds and types. So a type asks a
//! [`Source`], which instantiates only the functions that answer its question; the way behind it ([`parts`]) is compiled once.

mod error;
mod parts;
mod source;

pub use error::ReadError;
pub use source::Source;

use serde::de::{Deserializer, MapAccess};

use parts::Taken;

/// What the erased deserializer gives, for one question.
type Erased<'r, 'de> = &'r mut dyn erased_serde::Deserializer<'de>;

/// Takes one value.
type Take<'t, 'de> = &'t mut dyn FnMut(Erased<'_, 'de>) -> Result<(), ReadError>;

/// Values that are read one after the other, of whatever they are.
pub trait Values<'de> {
    /// Hands the next value to `take`.
    ///
    /// # Errors
    /// There is none, or `take` refuses it.
    fn next(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError>;
}

/// The values of a map.
pub(crate) struct Of<'m, M>(pub &'m mut M);

impl<'de, M: MapAccess<'de>> Values<'de> for Of<'_, M> {
    fn next(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError> {
        self.0.next_value_seed(Taken(take)).map_err(ReadError::from_text)
    }
}

/// Erases a deserializer and hands it on; its errors get back into the error of the deserializer.
fn handed<'de, D: Deserializer<'de>>(deserializer: D, take: Take<'_, 'de>) -> Result<(), D::Error> {
    take(&mut <dyn erased_serde::Deserializer>::erase(deserializer)).map_err(ReadError::raise)
}
