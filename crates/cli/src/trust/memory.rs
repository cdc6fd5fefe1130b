//! What plug-ins offered when they were loaded last: a file for each, in the folder of what can be worked out again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use blocksim_diagram::fingerprint;
use blocksim_recording::{limited_text, write_whole};
use serde_json::{Value, json};

use crate::home;

/// Most bytes of a file.
const LARGEST: u64 = 16 << 20;

/// What this process has kept last of each plug-in: an editor has a model compiled at every keystroke.
static KEPT: Mutex<BTreeMap<PathBuf, String>> = Mutex::new(BTreeMap::new());

/// What is remembered of a plug-in, by its path without links.
pub fn recall(code: &Path) -> Option<String> {
    let (folder, name) = place(code)?;
    let text = limited_text(&folder.join(name), LARGEST).ok()?;
    let value: Value = serde_json::from_str(&text).ok()?;
    // Two paths may have one fingerprint.
    let is_it = value["code"].as_str() == code.to_str();
    value["offer"].as_str().filter(|_| is_it).map(str::to_owned)
}

/// Keeps what a plug-in offers. Where that cannot be written, it is asked again the next time.
pub fn remember(code: &Path, offer: &str) {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.get(code).is_none_or(|known| known != offer) && keep(code, offer) {
        kept.insert(code.to_owned(), offer.to_owned());
    }
}

/// Adds an offer to what the file has; whether it has it then.
fn keep(code: &Path, offer: &str) -> bool {
    let earlier = recall(code);
    let offer =
        earlier.as_deref().map_or_else(|| offer.to_owned(), |known| blocksim_host::merged(known, offer));
    if earlier.as_ref() == Some(&offer) {
        return true;
    }
    let (Some((folder, name)), Some(path)) = (place(code), code.to_str()) else { return false };
    if fs::create_dir_all(&folder).is_err() {
        return false;
    }
    let text = format!("{}\n", json!({ "v": 1, "code": path, "offer": offer }));
    write_whole(&folder, &name, |out| out.write_all(text.as_bytes())).is_ok()
}

fn place(code: &Path) -> Option<(PathBuf, String)> {
    let sum = fingerprint(code.to_str()?.as_bytes());
    let sum = sum.rsplit(':').next().unwrap_or_default();
    Some((home::cache()?.join("plugins"), format!("{sum}.json")))
}
