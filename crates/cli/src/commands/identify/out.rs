//! The file of `--out`: whole or not at all, and never over another one unasked.

use std::path::Path;

use blocksim_results::write_whole;

use super::bench::Refusal;

/// Whether a result may be written there.
///
/// # Errors
/// Another ending than those that are known, or a file that is there without `--yes`.
pub fn check(path: Option<&Path>, yes: bool, endings: &[&str]) -> Result<(), Refusal> {
    let Some(path) = path else { return Ok(()) };
    let known = path.extension().and_then(|ending| ending.to_str()).is_some_and(|e| endings.contains(&e));
    if !known {
        return Err(Refusal::new(
            format!("`{}` is no file that a result can be written to", path.display()),
            format!("give it one of the endings: .{}", endings.join(", .")),
        ));
    }
    if path.exists() && !yes {
        return Err(Refusal::new(
            format!("`{}` exists", path.display()),
            "choose another name, or --yes to replace it",
        ));
    }
    Ok(())
}

/// Writes it.
///
/// # Errors
/// What the system says, as it is told.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    write_whole(folder, name, |file| file.write_all(text.as_bytes())).map(|_| ()).map_err(|error| {
        format!(
            "error: cannot write `{}`: {}\n  = help: {}",
            error.place().display(),
            error.reason(),
            error.remedy()
        )
    })
}
