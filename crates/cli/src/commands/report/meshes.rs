//! Meshes of a mechanism, made fit for a page.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_report::Surface;
use blocksim_results::limited_bytes;
use blocksim_scene::mesh::{self, Packed, simplified};
use serde_json::{Value, json};

use crate::disk::reason;

/// Triangles of all meshes of a page together.
const MOST: usize = 16_000;
/// Triangles of each mesh where all values are kept.
const MOST_FULL: usize = 4_000_000;
/// Triangles that a mesh keeps, however small its share is.
const FEWEST: usize = 100;
/// Bytes of a file that is read.
const LARGEST: u64 = 256 << 20;
/// Bytes of all files together.
const LARGEST_TOGETHER: u64 = 512 << 20;
/// Meshes that are told one by one.
const TOLD: usize = 5;

/// Reads the meshes that are to be seen; each shape with one gets its number, `"surface": 0`. What cannot be drawn is
/// told, and all else is drawn. A run keeps copies of its meshes in its `folder`; they count before the files themselves.
pub fn surfaces(scene: &mut Value, folder: &Path, full: bool, warnings: &mut Vec<String>) -> Vec<Surface> {
    let mut found: BTreeMap<String, Option<usize>> = BTreeMap::new();
    let (mut read, mut failed, mut bytes) = (Vec::new(), Vec::new(), 0);
    for shape in scene["shapes"].as_array_mut().into_iter().flatten() {
        if shape["kind"] != "mesh" || shape["use"] == "collision" {
            continue;
        }
        let file = shape["file"].as_str().unwrap_or_default().to_owned();
        let key = format!("{file} {}", shape["scale"]);
        let kept = shape["kept"].as_str().filter(|name| Path::new(name).file_name() == Some(name.as_ref()));
        let kept = kept.map(|name| folder.join(name)).filter(|kept| kept.is_file());
        let place = kept.unwrap_or_else(|| PathBuf::from(&file));
        let number = *found.entry(key).or_insert_with(|| match open(&place, &shape["scale"], &mut bytes) {
            Ok(surface) => {
                read.push(surface);
                Some(read.len() - 1)
            }
            Err(reason) => {
                let owner = shape["owner"].as_str().unwrap_or_default();
                failed.push(format!("The mesh `{file}` of `{owner}` is not shown: {reason}."));
                None
            }
        });
        if let Some(number) = number {
            shape["surface"] = json!(number);
        }
    }
    let more = failed.len().saturating_sub(TOLD);
    failed.truncate(TOLD);
    warnings.append(&mut failed);
    if more > 0 {
        warnings.push(format!("{more} more meshes are not shown."));
    }
    let all: usize = read.iter().map(|surface| surface.triangles.len()).sum();
    let share = |n: usize| match full {
        true => MOST_FULL,
        false => (MOST * n / all.max(1)).max(FEWEST),
    };
    read.iter()
        .map(|surface| {
            let Packed { low, step, corners, triangles } =
                Packed::of(&simplified(surface, share(surface.triangles.len())));
            Surface { low, step, corners, triangles }
        })
        .collect()
}

/// Reads a mesh; `bytes` have been read so far.
fn open(file: &Path, scale: &Value, bytes: &mut u64) -> Result<mesh::Surface, String> {
    let scale: Vec<f64> = scale.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    let [x, y, z] = scale[..] else { return Err("it has no scale".to_owned()) };
    let read = limited_bytes(file, LARGEST).map_err(|error| reason(&error))?;
    *bytes += read.len() as u64;
    if *bytes > LARGEST_TOGETHER {
        return Err(format!("all meshes together have more than {} MiB", LARGEST_TOGETHER >> 20));
    }
    mesh::read(&file.to_string_lossy(), &read, [x, y, z])
        .map_err(|fault| format!("{fault}; {}", fault.remedy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_cannot_be_read_is_told_once_and_all_else_is_drawn() {
        let folder = std::env::temp_dir().join(format!("blocksim-meshes-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let good = folder.join("good.stl");
        fs::write(&good, "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")
            .unwrap();
        fs::write(folder.join("broken.stl"), "solid\nvertex 1 2\n").unwrap();
        let shape = |name: &str, purpose: &str| json!({"kind": "mesh", "use": purpose, "owner": "arm", "file": folder.join(name), "scale": [1, 1, 1]});
        let mut scene = json!({ "shapes": [
            shape("good.stl", "both"), shape("gone.stl", "both"), shape("gone.stl", "visual"),
            shape("broken.stl", "visual"), shape("good.stl", "visual"), shape("other.stl", "collision"),
        ] });
        let mut warnings = Vec::new();
        let surfaces = surfaces(&mut scene, &folder, false, &mut warnings);
        assert_eq!(surfaces.len(), 1);
        let numbers: Vec<&Value> =
            scene["shapes"].as_array().unwrap().iter().map(|shape| &shape["surface"]).collect();
        assert_eq!(numbers, [&json!(0), &Value::Null, &Value::Null, &Value::Null, &json!(0), &Value::Null]);
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].contains("gone.stl` of `arm` is not shown"), "{}", warnings[0]);
        assert!(warnings[1].contains("line 2: `1 2` are no three numbers; write three"), "{}", warnings[1]);
        fs::remove_dir_all(folder).unwrap();
    }
}
