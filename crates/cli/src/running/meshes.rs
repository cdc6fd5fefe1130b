//! Meshes of a mechanism, kept with its run: it can be shown wherever its folder goes.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use blocksim_diagram::fingerprint;
use blocksim_recording::{ResultsError, RunFolder};
use blocksim_scene::{Form, Scene};

/// Bytes of all meshes that a run keeps; what comes on top is not shown in its page.
const MOST: u64 = 256 << 20;

/// Copies the files of the meshes that are to be seen into the folder of the run; returns their names there by their
/// files. Equal ones are kept once. What cannot be read is left out.
///
/// # Errors
/// [`ResultsError`] where a copy cannot be written.
pub fn keep(folder: &RunFolder, scene: &Scene) -> Result<HashMap<String, String>, ResultsError> {
    let mut kept: HashMap<String, String> = HashMap::new();
    let mut room = MOST;
    for shape in scene.shapes.iter().filter(|shape| shape.shape.is_visual()) {
        let Form::Mesh { file, .. } = &shape.shape.form else { continue };
        let fits = fs::metadata(file).is_ok_and(|about| about.is_file() && about.len() <= room);
        if kept.contains_key(file) || !fits {
            continue;
        }
        let Ok(bytes) = fs::read(file) else { continue };
        let name = name(file, &bytes);
        if !kept.values().any(|known| *known == name) {
            folder.write(&name, |out| out.write_all(&bytes))?;
            room = room.saturating_sub(bytes.len() as u64);
        }
        kept.insert(file.clone(), name);
    }
    Ok(kept)
}

/// `mesh-0f3a….stl`: named after what is in it.
fn name(file: &str, bytes: &[u8]) -> String {
    let sum = fingerprint(bytes);
    let sum = sum.rsplit(':').next().unwrap_or_default();
    let ending = Path::new(file).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let ending =
        ending.filter(|ending| ending.len() <= 8 && ending.chars().all(|sign| sign.is_ascii_alphanumeric()));
    format!("mesh-{sum}.{}", ending.as_deref().unwrap_or("stl"))
}
