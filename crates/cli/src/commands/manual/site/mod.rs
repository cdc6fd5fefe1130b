//! `blocksim manual --site FOLDER`: guides, tutorials, errors and blocks as one static site.

mod block;
mod example;
mod pages;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use blocksim_drawing::{style_sheet, style_variables};
use blocksim_picture::Theme;
use blocksim_site::{Rendered, Site};

use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::parallel;
use crate::terminal::console::Console;

include!(concat!(env!("OUT_DIR"), "/block_examples.rs"));
include!(concat!(env!("OUT_DIR"), "/manual_pictures.rs"));

/// A file of every site, by which one is known again.
const MARK: &str = "search-index.js";

/// Writes the site, whole or not at all.
///
/// # Errors
/// The folder is there and is not a site that may be replaced, or it cannot be written.
pub fn write(folder: &Path, replace: bool, console: Console) -> Outcome {
    check_place(folder, replace)?;
    let rendered = site().render();
    assert!(rendered.dead.is_empty(), "{:?}", rendered.dead);
    put(folder, &rendered)?;
    let pages = rendered.files.keys().filter(|name| name.ends_with(".html")).count();
    console.data(&format!("{pages} pages, open {}\n", folder.join("index.html").display()))?;
    Ok(Exit::Done)
}

/// The site as it is in this program.
fn site() -> Site {
    let kinds = block::kinds();
    let runs = parallel::all(&kinds, parallel::processors(), |info| block::page(info), |_| ());
    let mut site = Site { title: "blocksim manual".to_owned(), ..Site::default() };
    site.words = kinds.iter().map(|info| (info.kind.to_owned(), format!("blocks/{}", info.kind))).collect();
    site.pages.extend(pages::guides());
    site.pages.push(block::overview(&kinds));
    for (page, pictures) in runs {
        site.pages.push(page);
        site.files.extend(pictures);
    }
    site.pages.extend(pages::errors());
    let pictures = MANUAL_PICTURES.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec()));
    site.files.extend(pictures);
    site.style = drawing_style();
    site
}

/// Style of drawings that stand within pages, for light and dark.
fn drawing_style() -> String {
    let (light, dark) = (style_variables(Theme::Light), style_variables(Theme::Dark));
    format!(
        ":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root:not([data-theme=light]) {{ {dark} }} }}\n\
         :root[data-theme=dark] {{ {dark} }}\n@media print {{ :root, :root:not([data-theme=light]), :root[data-theme=dark] {{ {light} }} }}\n{}",
        style_sheet()
    )
}

/// Whether a site may be written there.
fn check_place(folder: &Path, replace: bool) -> Result<(), Failure> {
    if folder.symlink_metadata().is_err() {
        return Ok(());
    }
    let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    if is_empty || (replace && folder.join(MARK).is_file()) {
        return Ok(());
    }
    let said = format!("`{}` already exists", folder.display());
    let help = match folder.join(MARK).is_file() {
        true => "name another folder, or add --yes to replace the site in it",
        false => "name a new folder: what is in this one is not a manual, and is left alone",
    };
    Err(Failure::new(Exit::Files, "exists", said).help(help))
}

/// Writes all files beside the folder, and puts them in its place at the end.
fn put(folder: &Path, rendered: &Rendered) -> Result<(), Failure> {
    let fails = |path: &Path| {
        let path = path.display().to_string();
        move |error: std::io::Error| Failure::unwritable(format!("cannot write `{path}`: {error}"))
    };
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.map_or_else(|| PathBuf::from("."), Path::to_path_buf);
    let Some(name) = folder.file_name().map(|name| name.to_string_lossy().into_owned()) else {
        let said = format!("`{}` names no folder", folder.display());
        return Err(Failure::unwritable(said).help("add the name of a folder"));
    };
    let beside = |what: &str| parent.join(format!(".{name}.{what}-{}", std::process::id()));
    let (new, old) = (beside("new"), beside("old"));
    let written = write_all(&new, &rendered.files).map_err(fails(folder)).and_then(|()| {
        let had = folder.symlink_metadata().is_ok();
        if had {
            fs::rename(folder, &old).map_err(fails(folder))?;
        }
        fs::rename(&new, folder).map_err(|error| {
            // What was there stays there.
            let _ = if had { fs::rename(&old, folder) } else { Ok(()) };
            fails(folder)(error)
        })
    });
    // What is left is of no use; it is not worth a failure.
    let _ = (fs::remove_dir_all(&new), fs::remove_dir_all(&old));
    written
}

fn write_all(folder: &Path, files: &BTreeMap<String, Vec<u8>>) -> std::io::Result<()> {
    for (name, bytes) in files {
        let path = folder.join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(path, bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kinds whose examples name other files, so that there is no diagram around them.
    const OF_FILES: [&str; 5] = ["FromFile", "Merge", "Plugin", "Subsystem", "Variant"];

    #[test]
    fn every_kind_has_an_example_that_runs_and_holds_what_its_page_says() {
        let plain = |text: &str| {
            text.chars().filter(|sign| !sign.is_whitespace() && *sign != ',').collect::<String>()
        };
        for info in block::kinds() {
            let known = BLOCK_EXAMPLES.iter().find(|(kind, _)| *kind == info.kind);
            let Some((kind, text)) = known else {
                assert!(
                    OF_FILES.contains(&info.kind),
                    "docs/blocks/{}.ron is missing: its example in a diagram",
                    info.kind
                );
                continue;
            };
            let example = info.examples().first().copied().unwrap_or_default();
            // Some examples are lines with names.
            let example = example.split_once("\": ").map_or(example, |(_, block)| block);
            assert!(
                plain(text).contains(plain(example).trim_end_matches("()")),
                "docs/blocks/{kind}.ron differs from {example}"
            );
            let shown =
                example::shown(kind, text).unwrap_or_else(|error| panic!("docs/blocks/{kind}.ron: {error}"));
            assert!(shown.rows > 1 && shown.lines > 0, "docs/blocks/{kind}.ron: {} rows", shown.rows);
            assert!(shown.drawing.contains("<svg") && shown.light.contains("<svg"), "{kind}");
        }
        let strays: Vec<_> = BLOCK_EXAMPLES
            .iter()
            .filter(|(kind, _)| block::kinds().iter().all(|info| info.kind != *kind))
            .collect();
        assert!(strays.is_empty(), "{strays:?}");
    }

    #[test]
    fn no_link_is_dead_no_formula_is_left_and_nothing_outside_is_asked_for() {
        let rendered = site().render();
        assert_eq!(rendered.dead, []);
        assert_eq!(rendered.formulas, Vec::<String>::new());
        assert!(rendered.files.len() > 3 * BLOCK_EXAMPLES.len(), "{}", rendered.files.len());
        let text = |name: &str| String::from_utf8_lossy(&rendered.files[name]).into_owned();
        let mut checked = 0;
        for name in rendered.files.keys().filter(|name| name.ends_with(".html")) {
            let html = text(name);
            let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
            let attributes = html.split(" href=\"").skip(1).chain(html.split(" src=\"").skip(1));
            for target in attributes.filter_map(|rest| rest.split('"').next()) {
                // The reader may follow a link outside; the page itself loads nothing from there.
                if target.starts_with("https://") {
                    assert!(!html.contains(&format!("src=\"{target}")), "{name}: {target}");
                    continue;
                }
                let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
                let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
                for part in path.split('/') {
                    if part == ".." {
                        assert!(parts.pop().is_some(), "{name}: {target}")
                    } else {
                        parts.push(part)
                    }
                }
                let file = if path.is_empty() { name.clone() } else { parts.join("/") };
                assert!(rendered.files.contains_key(&file), "{name}: {target}");
                if !anchor.is_empty() {
                    assert!(text(&file).contains(&format!("id=\"{anchor}\"")), "{name}: {target}");
                }
                checked += 1;
            }
            assert!(
                !html.contains("<link rel=\"stylesheet\" href=\"http") && !html.contains("@import"),
                "{name}"
            );
        }
        assert!(checked > 10_000, "{checked} links");
        assert!(!text("site.css").contains("url(http") && !text("search.js").contains("http"));
        // Whatever the terminal prints as a page is a page here.
        for (page, _) in super::super::MANUAL_PAGES {
            let name = page.replace("README", "index");
            assert!(rendered.files.contains_key(&format!("{name}.html")), "{page}");
        }
        for (code, _) in crate::commands::explain::error_pages() {
            assert!(rendered.files.contains_key(&format!("errors/{code}.html")), "{code}");
        }
    }

    #[test]
    fn a_folder_of_something_else_is_left_alone() {
        let base = std::env::temp_dir().join(format!("blocksim-site-{}", std::process::id()));
        fs::create_dir_all(base.join("mine")).expect("a folder");
        fs::write(base.join("mine/notes.txt"), "keep").expect("a file");
        let failure = check_place(&base.join("mine"), true).expect_err("not a site");
        assert!(failure.text().contains("is left alone"), "{}", failure.text());
        let rendered = Rendered {
            files: BTreeMap::from([(MARK.to_owned(), b"1".to_vec()), ("a/b.html".to_owned(), Vec::new())]),
            ..Rendered::default()
        };
        let site = base.join("site");
        put(&site, &rendered).unwrap_or_else(|failure| panic!("{}", failure.text()));
        assert!(check_place(&site, false).is_err() && check_place(&site, true).is_ok());
        let rendered =
            Rendered { files: BTreeMap::from([(MARK.to_owned(), b"2".to_vec())]), ..Rendered::default() };
        put(&site, &rendered).unwrap_or_else(|failure| panic!("{}", failure.text()));
        assert!(fs::read(site.join(MARK)).expect("a file") == b"2" && !site.join("a").exists());
        assert_eq!(fs::read_dir(&base).expect("the folder").count(), 2, "nothing is left beside it");
        fs::remove_dir_all(&base).expect("the folder");
    }
}
