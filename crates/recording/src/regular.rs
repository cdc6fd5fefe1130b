//! Regular files alone, and not too much of them: pipes and devices might never end, and opening some of them waits for ever. The
//! folder of a run may be somebody else's, with links in it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a file that describes a run or a model.
pub const MOST_TEXT: u64 = 256 << 20;

/// Opens a regular file.
///
/// # Errors
/// The file does not exist, is a folder, device or pipe, or cannot be opened.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !about.is_file() {
        return Err(io::Error::other("it is a device or a pipe, not a regular file"));
    }
    File::open(path)
}

/// The bytes of a regular file of at most `most`.
///
/// # Errors
/// As of [`open_regular`], or the file is longer or cannot be read.
pub fn limited_bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Some files have more in them than the system says.
    open_regular(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("it has more than {} MiB", most >> 20)));
    }
    Ok(bytes)
}

/// The text of a regular file of at most `most` bytes.
///
/// # Errors
/// As of [`limited_bytes`], or the bytes are not UTF-8.
pub fn limited_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(limited_bytes(path, most)?).map_err(|_| io::ErrorKind::InvalidData.into())
}
