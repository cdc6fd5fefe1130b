//! Recordings on disk: `signals.rec`, written in chunks while a run goes and read one signal at a time.
//!
//! The format is described byte by byte in `docs/recordings.md`; `layout` is its header, `column` the values of
//! one signal in one chunk, `chunk` the rows of one time base, `index` the table at the end; `places` finds chunks and `pick`
//! takes columns out of one. [`StoreWriter`] and
//! [`Store`] put them together; [`Stream`] writes beside a run, and `sieve` picks its rows.

mod bytes;
mod chunk;
mod column;
mod index;
mod layout;
mod marks;
mod pick;
mod places;
mod predict;
mod reader;
mod sieve;
mod stream;
mod writer;

pub use layout::{Layout, Rate, SignalInfo};
pub use reader::{Store, Take};
pub use stream::Stream;
pub use writer::{StoreWriter, write_store};

#[cfg(test)]
mod tests;
