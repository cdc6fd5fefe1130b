//! Puts the pages of the manual, `docs/*.md` and those about errors, `docs/errors/*.md`, into the program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    write(&docs.join("errors"), "ERROR_PAGES", "Pages about problems by code, sorted.");
    write(&docs, "MANUAL_PAGES", "Guides by name, sorted.");
}

/// Writes a table of names and texts of the pages in a folder, to include.
fn write(folder: &Path, table: &str, about: &str) {
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut pages: Vec<PathBuf> = fs::read_dir(folder)
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
    let text = format!("/// {about}\nconst {table}: &[(&str, &str)] = &[\n{entries}];\n");
    let target =
        Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join(format!("{}.rs", table.to_lowercase()));
    fs::write(&target, text).expect("cargo's folder for generated files can be written");
}
