//! Drawings and pictures as files.

use std::path::{Path, PathBuf};

use blocksim_results::{ResultsError, write_whole};

/// Writes a drawing as SVG and as PNG, where asked for, each whole or not at all; returns the files.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn write_pictures(
    drawing: &str,
    as_svg: Option<&Path>,
    as_png: Option<&Path>,
    scale: f64,
    replace: bool,
) -> Result<Vec<PathBuf>, String> {
    for file in [as_svg, as_png].into_iter().flatten() {
        let folder = folder_of(file);
        if !folder.is_dir() {
            return Err(format!(
                "error: cannot write `{}`: there is no folder `{}`\n  = help: create it, or choose another place",
                file.display(),
                folder.display()
            ));
        }
        if file.exists() && !replace {
            return Err(format!(
                "error: `{}` is there already\n  = help: choose another name, or replace it with --yes",
                file.display()
            ));
        }
    }
    // The picture is made before the first file is written.
    let picture = as_png.map(|file| Ok::<_, String>((file, png(drawing, scale, file)?))).transpose()?;
    let mut written = Vec::new();
    if let Some(file) = as_svg {
        written.push(write(file, drawing.as_bytes())?);
    }
    if let Some((file, picture)) = picture {
        written.push(write(file, &picture)?);
    }
    Ok(written)
}

#[cfg(feature = "png")]
fn png(drawing: &str, scale: f64, _file: &Path) -> Result<Vec<u8>, String> {
    blocksim_picture::png(drawing, scale).map_err(|error| format!("error: {error}"))
}

#[cfg(not(feature = "png"))]
fn png(_drawing: &str, _scale: f64, file: &Path) -> Result<Vec<u8>, String> {
    let done = format!("cannot write `{}`", file.display());
    Err(crate::left_out::said(&done, "pictures as PNG (those as SVG are there)", "png"))
}

fn write(file: &Path, content: &[u8]) -> Result<PathBuf, String> {
    let folder = folder_of(file);
    let Some(name) = file.file_name() else {
        return Err(format!("error: `{}` names no file\n  = help: choose another name", file.display()));
    };
    let told = |error: ResultsError| {
        format!(
            "error: cannot write `{}`: {}\n  = help: choose another place",
            file.display(),
            error.reason()
        )
    };
    write_whole(folder, &name.to_string_lossy(), |out| out.write_all(content)).map_err(told)?;
    Ok(file.to_owned())
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
