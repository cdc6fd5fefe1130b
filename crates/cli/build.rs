//! Puts the pages of the manual, `docs/*.md` and `docs/tutorials/*.md`, and those about errors, `docs/errors/*.md`, into the program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    write(&[("", docs.join("errors"))], "ERROR_PAGES", "Pages about problems by code, sorted.");
    let guides = [("", docs.clone()), ("tutorials/", docs.join("tutorials"))];
    write(&guides, "MANUAL_PAGES", "Guides by name, sorted.");
}

/// Writes a table of names and texts of the pages in folders, to include. What stands before a folder begins the names of its pages.
fn write(folders: &[(&str, PathBuf)], table: &str, about: &str) {
    let entries: String = folders.iter().map(|(before, folder)| entries(before, folder)).collect();
    let text = format!("/// {about}\nconst {table}: &[(&str, &str)] = &[\n{entries}];\n");
    let target =
        Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join(format!("{}.rs", table.to_lowercase()));
    fs::write(&target, text).expect("cargo's folder for generated files can be written");
}

fn entries(before: &str, folder: &Path) -> String {
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut pages: Vec<PathBuf> = fs::read_dir(folder)
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    pages.sort();
    let entry = |page: &PathBuf| {
        let name = format!("{before}{}", page.file_stem()?.to_str()?);
        Some(format!("    ({name:?}, include_str!({page:?})),\n"))
    };
    pages.iter().filter_map(entry).collect()
}
