//! The texts of a model as they were when it ran, kept with the run: what is drawn and listed later is what was run,
//! whatever has become of the files.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use blocksim_block::{CodePolicy, Decision, LoadError, untrusted};
use blocksim_diagram::{Reader, SourceFile};
use serde_json::{Value, json};

use crate::trust::key;

/// Name of the file in the folder of a run.
pub const MODEL: &str = "model.json";

/// The files of a model, the diagram itself first, and what its plug-ins offer by the names of [`key`](crate::trust::key); a line each.
pub fn json(files: &[SourceFile], offers: &BTreeMap<String, String>) -> String {
    let files: Vec<String> = files
        .iter()
        .map(|file| format!("  {}", json!({ "path": file.path.to_string_lossy(), "text": &*file.text })))
        .collect();
    let plugins: Vec<String> = offers
        .iter()
        .map(|(library, offer)| format!("  {}", json!({ "library": library, "offer": offer })))
        .collect();
    let plugins = if plugins.is_empty() { String::new() } else { format!("\n{}\n", plugins.join(",\n")) };
    format!("{{\"v\": 1, \"files\": [\n{}\n], \"plugins\": [{plugins}]}}\n", files.join(",\n"))
}

/// Files that were kept.
#[derive(Debug, Default)]
pub struct Kept {
    /// The diagram itself.
    pub root: PathBuf,
    texts: HashMap<PathBuf, String>,
    offers: HashMap<String, String>,
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
        // Runs of earlier versions list no plug-ins.
        for plugin in value["plugins"].as_array().into_iter().flatten() {
            let (Some(library), Some(offer)) = (plugin["library"].as_str(), plugin["offer"].as_str()) else {
                return Err("a plug-in has no library or no offer".to_owned());
            };
            kept.offers.insert(library.to_owned(), offer.to_owned());
        }
        if kept.texts.is_empty() { Err("it lists no files".to_owned()) } else { Ok(kept) }
    }
}

impl Reader for Kept {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.texts.get(path).cloned().ok_or_else(|| "it was not kept with the run".to_owned())
    }

    fn code(&self) -> &dyn CodePolicy {
        self
    }
}

/// A run is data, whoever made it: its plug-ins are shown as they were, and never looked for on this computer.
impl CodePolicy for Kept {
    fn decide(&self, folder: &Path, named: &str) -> Decision {
        let message = format!("the run did not keep what the plug-in `{named}` offers");
        let refusal = LoadError { message, ..untrusted(named) };
        match self.offers.get(&key(folder, named)) {
            Some(offer) => Decision::Recall { offer: offer.clone(), warning: None, refusal },
            None => Decision::Refuse(refusal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_reads_back() {
        let file = |path: &str, text: &str| SourceFile { path: path.into(), text: text.into() };
        let files = [file("a/top.ron", "Diagram(\n\"ä\")"), file("a/part.ron", "x")];
        let kept = Kept::read(&json(&files, &BTreeMap::new())).unwrap();
        assert_eq!(kept.root, Path::new("a/top.ron"));
        assert_eq!(kept.read(Path::new("a/part.ron")).as_deref(), Ok("x"));
        assert_eq!(kept.read(Path::new("a/top.ron")).as_deref(), Ok("Diagram(\n\"ä\")"));
        assert!(kept.read(Path::new("b.ron")).is_err());
    }

    #[test]
    fn plug_ins_are_what_the_run_says_and_nothing_else() {
        let file = SourceFile { path: "a/top.ron".into(), text: "x".into() };
        let offers = BTreeMap::from([("a/../plugins/pid".to_owned(), "offer".to_owned())]);
        let kept = Kept::read(&json(&[file], &offers)).unwrap();
        let known = kept.decide(Path::new("a"), "../plugins/pid");
        assert!(matches!(known, Decision::Recall { offer, .. } if offer == "offer"));
        assert!(matches!(kept.decide(Path::new("a"), "../plugins/other"), Decision::Refuse(_)));
    }

    #[test]
    fn damaged_files_are_refused() {
        const PLUGIN: &str = r#"{"files": [{"path": "a", "text": "b"}], "plugins": [{"library": 1}]}"#;
        for text in ["", "{", "{}", "{\"files\": []}", "{\"files\": [{\"path\": 1}]}", PLUGIN] {
            assert!(Kept::read(text).is_err(), "{text}");
        }
    }
}
