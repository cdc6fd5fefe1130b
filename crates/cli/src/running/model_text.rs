//! The texts of a model as they were when it ran, kept with the run: what is drawn and listed later is what was run,
//! whatever has become of the files.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use blocksim_diagram::{Reader, SourceFile};
use serde_json::{Value, json};

/// Name of the file in the folder of a run.
pub const MODEL: &str = "model.json";

/// The files of a model, the diagram itself first, a line each.
pub fn json(files: &[SourceFile]) -> String {
    let files: Vec<String> = files
        .iter()
        .map(|file| format!("  {}", json!({ "path": file.path.to_string_lossy(), "text": &*file.text })))
        .collect();
    format!("{{\"v\": 1, \"files\": [\n{}\n]}}\n", files.join(",\n"))
}

/// Files that were kept.
#[derive(Debug, Default)]
pub struct Kept {
    /// The diagram itself.
    pub root: PathBuf,
    texts: HashMap<PathBuf, String>,
}

impl Kept {
    /// From the text of `model.json`.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn read(text: &str) -> Result<Kept, String> {
        let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let mut kept = Kept::default();
        for file in value["files"].as_array().ok_or("it lists no files")? {
            let (Some(path), Some(text)) = (file["path"].as_str(), file["text"].as_str()) else {
                return Err("a file has no path or no text".to_owned());
            };
            if kept.texts.is_empty() {
                kept.root = PathBuf::from(path);
            }
            kept.texts.insert(PathBuf::from(path), text.to_owned());
        }
        if kept.texts.is_empty() { Err("it lists no files".to_owned()) } else { Ok(kept) }
    }
}

impl Reader for Kept {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.texts.get(path).cloned().ok_or_else(|| "it was not kept with the run".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_reads_back() {
        let file = |path: &str, text: &str| SourceFile { path: path.into(), text: text.into() };
        let files = [file("a/top.ron", "Diagram(\n\"ä\")"), file("a/part.ron", "x")];
        let kept = Kept::read(&json(&files)).unwrap();
        assert_eq!(kept.root, Path::new("a/top.ron"));
        assert_eq!(kept.read(Path::new("a/part.ron")).as_deref(), Ok("x"));
        assert_eq!(kept.read(Path::new("a/top.ron")).as_deref(), Ok("Diagram(\n\"ä\")"));
        assert!(kept.read(Path::new("b.ron")).is_err());
    }

    #[test]
    fn damaged_files_are_refused() {
        for text in ["", "{", "{}", "{\"files\": []}", "{\"files\": [{\"path\": 1}]}"] {
            assert!(Kept::read(text).is_err(), "{text}");
        }
    }
}
