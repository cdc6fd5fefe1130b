//! Puts the pages of the manual, `docs/*.md` and `docs/tutorials/*.md`, those about errors, `docs/errors/*.md`, the examples of
//! blocks, `docs/blocks/*.ron`, and the pictures of the manual into the program.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    write(&[("", docs.join("errors"))], "ERROR_PAGES", "Pages about problems by code, sorted.");
    let guides = [("", docs.clone()), ("tutorials/", docs.join("tutorials"))];
    write(&guides, "MANUAL_PAGES", "Guides by name, sorted.");
    // Only the site needs these.
    let examples = entries("", &docs.join("blocks"), &["ron"], "include_str");
    write_table(
        "BLOCK_EXAMPLES",
        "&[(&str, &str)]",
        "Diagrams around the examples of blocks, by kind.",
        &examples,
    );
    let endings = ["svg", "png", "webp"];
    let mut pictures = entries("", &docs, &endings, "include_bytes");
    pictures += &entries("tutorials/", &docs.join("tutorials"), &endings, "include_bytes");
    write_table("MANUAL_PICTURES", "&[(&str, &[u8])]", "Pictures of the guides by name, sorted.", &pictures);
}

/// Writes a table of names and texts of the pages in folders, to include. What stands before a folder begins the names of its pages.
fn write(folders: &[(&str, PathBuf)], table: &str, about: &str) {
    let one = |(before, folder): &(&str, PathBuf)| entries(before, folder, &["md"], "include_str");
    let entries: String = folders.iter().map(one).collect();
    write_table(table, "&[(&str, &str)]", about, &entries);
}

fn write_table(table: &str, sort: &str, about: &str, entries: &str) {
    let text = format!("/// {about}\nconst {table}: {sort} = &[\n{entries}];\n");
    let target =
        Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join(format!("{}.rs", table.to_lowercase()));
    fs::write(&target, text).expect("cargo's folder for generated files can be written");
}

/// An entry for each file of a folder with one of these endings: its name, with the ending if there are several, and what it holds.
fn entries(before: &str, folder: &Path, endings: &[&str], include: &str) -> String {
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut pages: Vec<PathBuf> = fs::read_dir(folder)
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    pages.retain(|page| page.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)));
    pages.sort();
    let entry = |page: &PathBuf| {
        let name = if endings.len() == 1 { page.file_stem() } else { page.file_name() };
        let name = format!("{before}{}", name?.to_str()?);
        Some(format!("    ({name:?}, {include}!({page:?})),\n"))
    };
    pages.iter().filter_map(entry).collect()
}
