//! By what a recording is known.

/// First bytes of a file. The first one is no ASCII, the last is a line feed: files that were mangled as text are
/// noticed.
pub(super) const MAGIC: [u8; 8] = *b"\x89BLKSIM\n";
/// Last bytes of a file that was closed.
pub(super) const END: [u8; 8] = *b"BLKSEND\n";
/// Version of the format. Recordings of version 1, which have no predicted values, are read as well.
pub(super) const VERSION: u32 = 2;
/// Most rows of a chunk that are read; the writer keeps far below.
pub(super) const MOST_ROWS: u32 = 1 << 20;
