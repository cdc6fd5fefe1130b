//! Meshes of a mechanism, made fit for a page.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_recording::limited_bytes;
use blocksim_report::Surface;
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

/// Where the meshes of a page may come from.
#[derive(Debug, Clone, Copy)]
pub struct MeshSources<'a> {
    /// The folder of the run.
    pub folder: &'a Path,
    /// How many shapes are those of the run; what stands around the mechanism comes behind them.
    pub of_run: usize,
    /// Whether what stands around comes from a file that the command line names, and may name others.
    pub reads_others: bool,
}

/// Reads the meshes that are to be seen; each shape with one gets its number, `"surface": 0`. What cannot be drawn is
/// reported, and all else is drawn. A run keeps copies of its meshes in its `folder`, and nothing else is read: a run that comes from
/// somebody else may name any file of this computer.
pub fn surfaces(
    scene: &mut Value,
    sources: MeshSources,
    full: bool,
    warnings: &mut Vec<String>,
) -> Vec<Surface> {
    let mut found: BTreeMap<String, Option<usize>> = BTreeMap::new();
    let (mut read, mut failed, mut bytes) = (Vec::new(), Vec::new(), 0);
    for (index, shape) in scene["shapes"].as_array_mut().into_iter().flatten().enumerate() {
        if shape["kind"] != "mesh" || shape["use"] == "collision" {
            continue;
        }
        let file = shape["file"].as_str().unwrap_or_default().to_owned();
        let key = format!("{file} {}", shape["scale"]);
        let place = match index >= sources.of_run && sources.reads_others {
            true => Some(PathBuf::from(&file)),
            false => copy(sources.folder, &shape["kept"]),
        };
        let mut read_copy = |place: Option<PathBuf>| {
            let place = place.ok_or("the run has no copy of it; run the model again to keep one")?;
            open(&place, &shape["scale"], &mut bytes)
        };
        let number = *found.entry(key).or_insert_with(|| match read_copy(place) {
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

/// The copy of a mesh in the folder of a run: a file of its own there, and no link out of it.
fn copy(folder: &Path, kept: &Value) -> Option<PathBuf> {
    let name = kept.as_str().filter(|name| Path::new(name).file_name() == Some(name.as_ref()))?;
    let place = folder.join(name);
    std::fs::symlink_metadata(&place).is_ok_and(|about| about.is_file()).then_some(place)
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

    fn of(folder: &Path) -> MeshSources<'_> {
        MeshSources { folder, of_run: usize::MAX, reads_others: true }
    }

    #[test]
    fn nothing_outside_of_the_folder_of_a_run_is_read() {
        let folder = std::env::temp_dir().join(format!("blocksim-copies-{}", std::process::id()));
        let run = folder.join("run");
        fs::create_dir_all(&run).unwrap();
        let triangle = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
        let secret = folder.join("secret.stl");
        fs::write(&secret, triangle).unwrap();
        fs::write(run.join("own.stl"), triangle).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(&secret, run.join("link.stl")).unwrap();
        let shape = |kept: &Value| json!({"kind": "mesh", "use": "both", "owner": "arm", "file": secret, "kept": kept, "scale": [1, 1, 1]});
        let kept =
            [Value::Null, json!("../secret.stl"), json!(secret), json!("link.stl"), json!(".."), json!(7)];
        for kept in kept {
            let mut warnings = Vec::new();
            let mut scene = json!({ "shapes": [shape(&kept)] });
            assert!(surfaces(&mut scene, of(&run), false, &mut warnings).is_empty(), "{kept} was read");
            assert!(warnings[0].contains("the run has no copy of it"), "{warnings:?}");
        }
        let mut scene = json!({ "shapes": [shape(&json!("own.stl"))] });
        assert_eq!(surfaces(&mut scene, of(&run), false, &mut Vec::new()).len(), 1);
        // What the command line names may lie anywhere; what a model has around its mechanism may not.
        for reads_others in [true, false] {
            let sources = MeshSources { folder: &run, of_run: 0, reads_others };
            let mut scene = json!({ "shapes": [shape(&Value::Null)] });
            let surfaces = surfaces(&mut scene, sources, false, &mut Vec::new());
            assert_eq!(surfaces.len(), usize::from(reads_others));
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_cannot_be_read_is_told_once_and_all_else_is_drawn() {
        let folder = std::env::temp_dir().join(format!("blocksim-meshes-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let good = folder.join("good.stl");
        fs::write(&good, "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")
            .unwrap();
        fs::write(folder.join("broken.stl"), "solid\nvertex 1 2\n").unwrap();
        let shape = |name: &str, purpose: &str| json!({"kind": "mesh", "use": purpose, "owner": "arm", "file": folder.join(name), "kept": name, "scale": [1, 1, 1]});
        let mut scene = json!({ "shapes": [
            shape("good.stl", "both"), shape("gone.stl", "both"), shape("gone.stl", "visual"),
            shape("broken.stl", "visual"), shape("good.stl", "visual"), shape("other.stl", "collision"),
        ] });
        let mut warnings = Vec::new();
        let surfaces = surfaces(&mut scene, of(&folder), false, &mut warnings);
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
