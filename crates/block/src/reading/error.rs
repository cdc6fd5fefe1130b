//! What goes wrong while a value is read, until it is back in the error of whoever gave the value.

use std::fmt::{self, Display};

use serde::de::Error;

/// An error of the concrete deserializer. It keeps what deserializers word for themselves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReadError {
    /// Any other.
    Text(String),
    /// A name in a set that is not known; the known ones.
    UnknownField(String, &'static [&'static str]),
    /// An alternative that is not known; the known ones.
    UnknownVariant(String, &'static [&'static str]),
    /// A name that is missing.
    MissingField(&'static str),
    /// A name that stands twice.
    DuplicateField(&'static str),
}

impl ReadError {
    /// The same as another error.
    pub(crate) fn raise<E: Error>(self) -> E {
        match self {
            ReadError::Text(text) => E::custom(text),
            ReadError::UnknownField(name, known) => E::unknown_field(&name, known),
            ReadError::UnknownVariant(name, known) => E::unknown_variant(&name, known),
            ReadError::MissingField(name) => E::missing_field(name),
            ReadError::DuplicateField(name) => E::duplicate_field(name),
        }
    }

    /// What another error says.
    pub(crate) fn from_text<E: Display>(error: E) -> Self {
        ReadError::Text(error.to_string())
    }

    /// Whether this is only the sign that an error was noted, by whoever gave the value.
    pub(crate) fn is_noted(&self) -> bool {
        matches!(self, ReadError::Text(text) if text.is_empty())
    }

    /// Something was asked for its value twice.
    pub(super) fn twice() -> Self {
        ReadError::Text("a value is read once".to_owned())
    }
}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.clone().raise::<serde::de::value::Error>().fmt(f)
    }
}

impl std::error::Error for ReadError {}

impl Error for ReadError {
    fn custom<T: Display>(message: T) -> Self {
        Self::from_text(message)
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        ReadError::UnknownField(field.to_owned(), expected)
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        ReadError::UnknownVariant(variant.to_owned(), expected)
    }

    fn missing_field(field: &'static str) -> Self {
        ReadError::MissingField(field)
    }

    fn duplicate_field(field: &'static str) -> Self {
        ReadError::DuplicateField(field)
    }
}
