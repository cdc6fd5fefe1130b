//! What goes wrong while a value is read, until it is back in the error of whoever gave the value.

use std::fmt::{self, Display};

use serde::de::{Error, Expected, Unexpected};

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

    /// A whole number that its type cannot hold, which serde words with the name of that type.
    fn invalid_value(unexpected: Unexpected, expected: &dyn Expected) -> Self {
        let found = match unexpected {
            Unexpected::Signed(value) => i128::from(value),
            Unexpected::Unsigned(value) => i128::from(value),
            _ => return Self::custom(format_args!("invalid value: {unexpected}, expected {expected}")),
        };
        ReadError::Text(match greatest(&expected.to_string()) {
            Some(_) if found < 0 => {
                format!("expected a whole number that is not negative, found {found}")
            }
            Some(greatest) => format!("expected a whole number up to {greatest}, found {found}"),
            None => format!("invalid value: {unexpected}, expected {expected}"),
        })
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

/// The greatest number of a type without a sign, by the name of the type.
fn greatest(name: &str) -> Option<u64> {
    match name {
        "u8" => Some(u8::MAX.into()),
        "u16" => Some(u16::MAX.into()),
        "u32" => Some(u32::MAX.into()),
        "u64" | "usize" => Some(u64::MAX),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;
    use serde::de::IntoDeserializer;
    use serde::de::value::{I64Deserializer, U64Deserializer};

    use super::ReadError;

    #[test]
    fn whole_numbers_that_do_not_fit_are_explained_without_names_of_types() {
        let number: I64Deserializer<ReadError> = (-3_i64).into_deserializer();
        let said = usize::deserialize(number).expect_err("negative").to_string();
        assert_eq!(said, "expected a whole number that is not negative, found -3");
        let number: U64Deserializer<ReadError> = 5_000_000_000_u64.into_deserializer();
        let said = u32::deserialize(number).expect_err("too large").to_string();
        assert_eq!(said, "expected a whole number up to 4294967295, found 5000000000");
        let number: I64Deserializer<ReadError> = 7_i64.into_deserializer();
        assert_eq!(usize::deserialize(number), Ok(7));
    }
}
