//! Small files that are read while plug-ins are built.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of one.
const MOST: u64 = 1 << 20;

/// The text of a regular file of at most 1 MiB: a pipe might never end, and neither does a device.
///
/// # Errors
/// It is not such a file, it cannot be read, or it is not UTF-8.
pub fn text(path: &Path) -> io::Result<String> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let mut text = String::new();
    File::open(path)?.take(MOST + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MOST {
        return Err(io::Error::other("it has more than 1 MiB"));
    }
    Ok(text)
}
