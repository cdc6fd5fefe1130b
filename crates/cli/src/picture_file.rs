//! Drawings and pictures as files.

use std::path::{Path, PathBuf};

use blocksim_picture::{Figure, pages};

use crate::disk::{free, write_file};
use crate::failure::Failure;
use crate::terminal::console::Console;

/// The page of a figure that is asked for, counted from 1; where there are more, a note says so.
///
/// # Errors
/// If there is no such page.
pub fn page(figure: &Figure, wanted: u32, console: Console) -> Result<Figure, Failure> {
    let pages = pages(figure);
    let count = pages.len();
    let Some(page) = pages.into_iter().nth(wanted as usize - 1) else {
        let there = if count == 1 { "one page".to_owned() } else { format!("{count} pages") };
        return Err(Failure::usage(format!("there is no page {wanted}: the drawing has {there}"))
            .help("leave `--page` away for the first one, or choose signals"));
    };
    if count > 1 {
        let next = if wanted as usize == count { 1 } else { wanted + 1 };
        console.say(&format!("note: page {wanted} of {count}; `--page {next}` draws another one"));
    }
    Ok(page)
}

/// Writes a drawing as SVG and as PNG, where asked for, each whole or not at all; returns the files.
///
/// # Errors
/// Why they cannot be written; none is then.
pub fn write_pictures(
    drawing: &str,
    as_svg: Option<&Path>,
    as_png: Option<&Path>,
    scale: f64,
    replace: bool,
) -> Result<Vec<PathBuf>, Failure> {
    for file in [as_svg, as_png].into_iter().flatten() {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            let said = format!(
                "cannot write `{}`: the folder `{}` does not exist",
                file.display(),
                folder.display()
            );
            return Err(Failure::unwritable(said).help("create it, or choose another place"));
        }
        free(file, replace)?;
    }
    // The picture is made before the first file is written.
    let picture = as_png.map(|file| Ok::<_, Failure>((file, png(drawing, scale, file)?))).transpose()?;
    let mut written = Vec::new();
    if let Some(file) = as_svg {
        write_file(file, drawing.as_bytes(), replace)?;
        written.push(file.to_owned());
    }
    if let Some((file, picture)) = picture {
        write_file(file, &picture, replace)?;
        written.push(file.to_owned());
    }
    Ok(written)
}

#[cfg(feature = "png")]
fn png(drawing: &str, scale: f64, file: &Path) -> Result<Vec<u8>, Failure> {
    let unwritable = |reason| Failure::unwritable(format!("cannot write `{}`: {reason}", file.display()));
    blocksim_picture::png(drawing, scale).map_err(unwritable)
}

#[cfg(not(feature = "png"))]
fn png(_drawing: &str, _scale: f64, file: &Path) -> Result<Vec<u8>, Failure> {
    let done = format!("cannot write `{}`", file.display());
    Err(crate::left_out::failure(&done, "pictures as PNG (those as SVG are there)", "png"))
}
