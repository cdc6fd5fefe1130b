//! Puts the pages of the manual about errors, `docs/errors/*.md`, into the program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/errors");
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut pages: Vec<PathBuf> = fs::read_dir(&folder)
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    pages.sort();
    let entries: String = pages
        .iter()
        .filter_map(|page| {
            Some(format!("    ({:?}, include_str!({:?})),\n", page.file_stem()?.to_str()?, page))
        })
        .collect();
    let text = format!(
        "/// Pages about problems by code, sorted.\nconst ERROR_PAGES: &[(&str, &str)] = &[\n{entries}];\n"
    );
    let target = Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join("error_pages.rs");
    fs::write(&target, text).expect("cargo's folder for generated files can be written");
}
