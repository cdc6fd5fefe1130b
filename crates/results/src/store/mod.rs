//! Recordings on disk: `signals.rec`, written in chunks while a run goes and read one signal at a time.
//!
//! The format is described byte by byte in `docs/recordings.md`; `layout` is its header, `column` the values of
//! one signal in one chunk, `chunk` the rows of one time base, `index` the table at the end. [`StoreWriter`] and
//! [`Store`] put them together; [`Stream`] writes beside a run, and `sieve` picks its rows.

mod bytes;
mod chunk;
mod column;
mod index;
mod layout;
mod predict;
mod reader;
mod sieve;
mod stream;
mod writer;

pub use layout::{Layout, Rate, SignalInfo};
pub use reader::{Store, Take};
pub use stream::Stream;
pub use writer::{StoreWriter, write_store};

/// First bytes of a file. The first one is no ASCII, the last is a line feed: files that were mangled as text are
/// noticed.
const MAGIC: [u8; 8] = *b"\x89BLKSIM\n";
/// Last bytes of a file that was closed.
const END: [u8; 8] = *b"BLKSEND\n";
/// Version of the format. Recordings of version 1, which have no predicted values, are read as well.
const VERSION: u32 = 2;
/// Most rows of a chunk that are read; the writer keeps far below.
const MOST_ROWS: u32 = 1 << 20;

#[cfg(test)]
mod tests;
