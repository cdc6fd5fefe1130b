//! What plug-ins offered when they were loaded last: a file for each, in the folder of what can be worked out again.

use std::fs;
use std::path::{Path, PathBuf};

use blocksim_diagram::fingerprint;
use blocksim_results::{limited_text, write_whole};
use serde_json::{Value, json};

use super::places;

/// Most bytes of a file.
const LARGEST: u64 = 16 << 20;

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
    let earlier = recall(code);
    let offer =
        earlier.as_deref().map_or_else(|| offer.to_owned(), |known| blocksim_host::merged(known, offer));
    let (Some((folder, name)), Some(path)) = (place(code), code.to_str()) else { return };
    if earlier.as_ref() == Some(&offer) || fs::create_dir_all(&folder).is_err() {
        return;
    }
    let text = format!("{}\n", json!({ "v": 1, "code": path, "offer": offer }));
    let _ = write_whole(&folder, &name, |out| out.write_all(text.as_bytes()));
}

fn place(code: &Path) -> Option<(PathBuf, String)> {
    let sum = fingerprint(code.to_str()?.as_bytes());
    let sum = sum.rsplit(':').next().unwrap_or_default();
    Some((places::cache()?.join("plugins"), format!("{sum}.json")))
}
