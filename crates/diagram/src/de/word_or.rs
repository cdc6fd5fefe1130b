//! A value that is either a word or something else, such as `Auto` or a time.

use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Visitor};

/// A value that is either an alternative written as a word, or something else.
pub(crate) enum Either<A, B> {
    /// `Word` or `Word(...)`.
    Word(A),
    /// A number, a text ...
    Other(B),
}

/// Reads a word as `A` and everything else as `B`.
pub(crate) fn word_or<'de, D, A, B>(deserializer: D) -> Result<Either<A, B>, D::Error>
where
    D: Deserializer<'de>,
    A: Deserialize<'de>,
    B: Deserialize<'de>,
{
    struct Look<A, B>(PhantomData<(A, B)>);
    impl<'de, A: Deserialize<'de>, B: Deserialize<'de>> Visitor<'de> for Look<A, B> {
        type Value = Either<A, B>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("a word or a value")
        }

        fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
            A::deserialize(deserializer).map(Either::Word)
        }

        fn visit_newtype_struct<D: Deserializer<'de>>(
            self,
            deserializer: D,
        ) -> Result<Self::Value, D::Error> {
            B::deserialize(deserializer).map(Either::Other)
        }
    }
    deserializer.deserialize_newtype_struct(WORD_OR, Look(PhantomData))
}

/// Asks a written value whether it is a word.
pub(super) const WORD_OR: &str = "$blocksim::WordOr";
