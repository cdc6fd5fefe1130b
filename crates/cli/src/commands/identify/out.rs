//! The file of `--out`: looked at before an experiment, which takes long.

use std::path::Path;

use crate::disk::free;
use crate::failure::Failure;

/// Whether a result may be written there.
///
/// # Errors
/// Another ending than those that are known, or a file that is there without `--yes`.
pub fn check(path: Option<&Path>, yes: bool, endings: &[&str]) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let known = path.extension().and_then(|ending| ending.to_str()).is_some_and(|e| endings.contains(&e));
    if !known {
        let said = format!("`{}` is not a file that a result can be written to", path.display());
        return Err(
            Failure::usage(said).help(format!("give it one of the endings: .{}", endings.join(", .")))
        );
    }
    free(path, yes)
}
