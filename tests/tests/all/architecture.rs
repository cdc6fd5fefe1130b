//! What ARCHITECTURE.md promises, checked against the sources.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use blocksim_tests::root;

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the folders in `crates/`.
fn crates() -> BTreeSet<String> {
    let entries = std::fs::read_dir(root().join("crates")).expect("the crates");
    let folders =
        entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.join("Cargo.toml").is_file());
    folders.filter_map(|path| path.file_name()?.to_str().map(str::to_owned)).collect()
}

/// The rows of the table of crates: name, what it knows nothing of.
fn table(page: &str) -> BTreeMap<String, String> {
    let rows = page.lines().filter_map(|line| {
        let cells: Vec<&str> = line.strip_prefix("| `")?.split('|').map(str::trim).collect();
        Some((cells[0].trim_end_matches('`').to_owned(), cells.get(2)?.to_string()))
    });
    rows.collect()
}

/// Dependencies of a crate within the project, those of its tests left out; short names.
fn dependencies(name: &str) -> BTreeSet<String> {
    let manifest = read(&root().join("crates").join(name).join("Cargo.toml"));
    let section = manifest.split("\n[").find_map(|section| section.strip_prefix("dependencies]"));
    let keys = section.unwrap_or_default().lines().filter_map(|line| {
        let key = line.split(['=', '.']).next()?.trim();
        (!key.is_empty() && !key.starts_with('#')).then_some(key)
    });
    keys.map(|key| key.strip_prefix("blocksim-").unwrap_or(key).to_owned()).collect()
}

/// All that a crate depends on, directly or through others.
fn reach(name: &str) -> BTreeSet<String> {
    let (mut found, mut open) = (BTreeSet::new(), vec![name.to_owned()]);
    while let Some(next) = open.pop() {
        let inside = root().join("crates").join(&next).is_dir();
        let further = if inside { dependencies(&next) } else { BTreeSet::new() };
        open.extend(further.into_iter().filter(|dependency| found.insert(dependency.clone())));
    }
    found
}

#[test]
fn the_page_names_every_crate_and_no_other() {
    let page = read(&root().join("ARCHITECTURE.md"));
    let named: BTreeSet<String> = table(&page).into_keys().collect();
    assert_eq!(named, crates());
}

/// Every program of tests is linked for itself, with all that it depends on: a crate has one, and one more where an
/// allocator counts.
#[test]
fn every_crate_has_one_program_of_tests() {
    let folders = crates().into_iter().map(|name| root().join("crates").join(name).join("tests"));
    for folder in folders.chain([root().join("tests/tests")]).filter(|folder| folder.is_dir()) {
        let entries = std::fs::read_dir(&folder).expect("tests").map(|entry| entry.expect("an entry").path());
        let programs = entries.filter(|path| {
            let counts = path.file_stem().is_some_and(|stem| stem == "allocation");
            !counts && (path.extension().is_some_and(|e| e == "rs") || path.join("main.rs").is_file())
        });
        let programs: Vec<PathBuf> = programs.collect();
        assert!(programs.len() <= 1, "make these modules of one program: {programs:?}");
    }
}

/// Whether the documentation in a file of sources has an example in Rust, which is a test.
fn has_example(source: &str) -> bool {
    let in_rust = ["", "rust", "no_run", "should_panic", "compile_fail", "ignore", "edition2024"];
    let docs = source
        .lines()
        .map(str::trim_start)
        .filter_map(|line| line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).map(str::trim));
    let fences = docs.filter_map(|line| line.strip_prefix("```"));
    // Every second fence closes what the one before has opened.
    let mut opening = fences.step_by(2);
    opening.any(|info| info.split([',', ' ']).all(|word| in_rust.contains(&word)))
}

/// To look for examples takes as long as to read the whole crate, so crates without any are left out; one that gets its first
/// example must not be.
#[test]
fn the_examples_of_every_crate_are_tested_where_there_are_any() {
    assert!(has_example("/// ```\n/// let a = 1;\n/// ```\nfn f() {}"));
    assert!(has_example("//! ```text\n//! a\n//! ```\n//!\n//! ```no_run\n//! f();\n//! ```"));
    assert!(!has_example("/// ```text\n/// a\n/// ```\nfn f() {}"));
    let mut tested = 0;
    for name in crates() {
        let manifest = read(&root().join("crates").join(&name).join("Cargo.toml"));
        let left_out = manifest.contains("doctest = false");
        let file = sources_of(&name).into_iter().find(|file| has_example(&read(file)));
        assert!(
            !(left_out && file.is_some()),
            "remove `doctest = false` from {name}: {file:?} has an example"
        );
        assert!(
            left_out || file.is_some(),
            "{name} has no example: `doctest = false` saves to look for some"
        );
        tested += usize::from(!left_out);
    }
    assert!(tested >= 5, "only {tested} crates have examples");
}

/// What stands between backticks, without blocks of code.
fn spans(page: &str) -> Vec<&str> {
    let prose: Vec<&str> = page.split("```").step_by(2).collect();
    prose.into_iter().flat_map(|part| part.split('`').skip(1).step_by(2)).collect()
}

#[test]
fn every_path_on_the_page_exists() {
    let page = read(&root().join("ARCHITECTURE.md"));
    let files: Vec<PathBuf> = crates().iter().flat_map(|name| sources_of(name)).collect();
    let mut looked_at = 0;
    for span in spans(&page) {
        // `crates/blocks/src/<category>/`, `diagram/tree.rs`, `docs/`; neither commands nor formulas.
        if span.contains([' ', '*', '=', '(', ':']) || !(span.contains('/') || span.ends_with(".rs")) {
            continue;
        }
        let path = span.split('<').next().unwrap_or_default().trim_end_matches('/');
        let in_crate =
            path.split_once('/').map(|(name, rest)| root().join("crates").join(name).join("src").join(rest));
        let alone = |path: &str| files.iter().any(|file| !path.contains('/') && file.ends_with(path));
        let exists = root().join(path).exists() || in_crate.is_some_and(|path| path.exists()) || alone(path);
        assert!(exists, "`{span}` does not exist");
        looked_at += 1;
    }
    assert!(looked_at >= 8, "only {looked_at} paths were found on the page");
}

#[test]
fn every_function_type_and_crate_on_the_page_exists() {
    let page = read(&root().join("ARCHITECTURE.md"));
    let mut sources = String::new();
    for file in crates().iter().flat_map(|name| sources_of(name)) {
        sources.push_str(&read(&file));
    }
    let words: HashSet<&str> = sources.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let crates = crates();
    for span in spans(&page) {
        let is_name = span.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let known = crates.contains(span) || words.contains(span);
        assert!(!is_name || known, "nothing is called `{span}`");
    }
}

/// All Rust files of a crate's sources.
fn sources_of(name: &str) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![root().join("crates").join(name).join("src")]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("sources").map(|entry| entry.expect("an entry").path())
        {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|extension| extension == "rs") {
                files.push(entry);
            }
        }
    }
    files
}

/// Whether a line of code holds this word; comments and texts do not count.
fn holds_word(line: &str, word: &str) -> bool {
    let code: String =
        line.split("//").next().unwrap_or_default().split('"').step_by(2).collect::<Vec<_>>().join(" ");
    // A word with a hyphen, as in a policy of a page, is none of Rust.
    code.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).any(|found| found == word)
}

#[test]
fn unsafe_occurs_in_abi_controller_and_host_alone() {
    let mut found = BTreeSet::new();
    for name in crates() {
        for file in sources_of(&name) {
            if read(&file).lines().any(|line| holds_word(line, "unsafe")) {
                found.insert(name.clone());
            }
        }
    }
    let expected: BTreeSet<String> = ["abi", "controller", "host"].map(str::to_owned).into();
    assert_eq!(found, expected);
}

#[test]
fn all_other_crates_take_the_lint_that_forbids_it() {
    let lints = read(&root().join("Cargo.toml"));
    assert!(lints.contains("unsafe_code = \"forbid\""), "the workspace forbids it");
    for name in crates() {
        let manifest = read(&root().join("crates").join(&name).join("Cargo.toml"));
        let takes = manifest.contains("[lints]\nworkspace = true");
        assert_eq!(takes, !["abi", "controller", "host"].contains(&name.as_str()), "{name}");
    }
}

#[test]
fn no_crate_depends_on_what_it_knows_nothing_of() {
    let nothing_of = [
        ("signal", &["*"][..]),
        ("numbers", &["*"]),
        ("syntax", &["*"]),
        ("law", &["signal", "block", "blocks", "diagram", "sim", "solve", "syntax", "serde"]),
        ("solve", &["block", "blocks", "syntax", "serde"]),
        ("multibody", &["block", "blocks", "diagram"]),
        ("scene", &["block", "blocks", "diagram", "syntax"]),
        ("robotics", &["block", "blocks", "diagram", "syntax"]),
        ("identify", &["block", "blocks", "syntax", "serde", "diagram", "sim"]),
        ("block", &["blocks", "diagram", "syntax"]),
        ("blocks", &["diagram", "network", "sim", "syntax"]),
        ("network", &["syntax", "diagram", "blocks"]),
        ("diagram", &["blocks", "sim", "host", "recording"]),
        ("sim", &["syntax", "diagram", "blocks", "network", "recording"]),
        ("codegen", &["blocks", "diagram", "syntax", "network", "recording"]),
        ("abi", &["*"]),
        ("controller", &["host", "block", "diagram"]),
        ("host", &["diagram", "blocks", "sim"]),
        ("import", &["block", "blocks", "diagram"]),
        ("recording", &["block", "blocks", "diagram", "sim"]),
        ("export", &["block", "blocks", "diagram", "sim"]),
        ("terminal", &["block", "blocks", "diagram", "recording"]),
        ("params", &["blocks", "sim", "recording"]),
        ("picture", &["block", "blocks", "diagram", "sim", "recording"]),
        ("analysis", &["*"]),
        ("layout", &["*"]),
        ("linear", &["block", "blocks", "syntax", "serde", "diagram", "sim"]),
        ("drawing", &["blocks", "sim", "host", "recording"]),
        ("report", &["block", "blocks", "diagram", "recording"]),
        ("studio", &["block", "blocks", "diagram", "sim", "recording"]),
        ("edit", &["blocks", "sim", "host"]),
        ("lsp", &["blocks", "sim", "host"]),
        ("site", &["signal", "block", "blocks", "diagram", "sim", "recording", "picture", "drawing"]),
    ];
    for (name, absent) in nothing_of {
        let reached = reach(name);
        for other in absent {
            assert!(
                if *other == "*" { reached.is_empty() } else { !reached.contains(*other) },
                "{name} reaches {reached:?}"
            );
        }
    }
    // The page's own words agree with the list above: a crate with an entry in the last column is in it.
    let page = read(&root().join("ARCHITECTURE.md"));
    for (name, absent) in table(&page) {
        let listed = nothing_of.iter().any(|(listed, _)| *listed == name);
        assert_eq!(listed, !absent.is_empty(), "{name}: knows nothing of {absent:?}");
    }
}

/// Heavy crates of others: who alone may need them, and not without its feature.
#[test]
fn heavy_crates_stand_behind_a_feature_of_the_one_that_needs_them() {
    let heavy = [
        ("parquet", "export", "parquet"),
        ("calamine", "params", "xlsx"),
        ("rust_xlsxwriter", "params", "xlsx"),
        ("zip", "params", "xlsx"),
        ("resvg", "picture", "png"),
        ("wasmi", "host", "wasm"),
        ("lsp", "cli", "lsp"),
        ("site", "cli", "site"),
    ];
    let manifest = |name: &str| read(&root().join("crates").join(name).join("Cargo.toml"));
    for (heavy, owner, feature) in heavy {
        let users: Vec<String> =
            crates().into_iter().filter(|name| dependencies(name).contains(heavy)).collect();
        assert_eq!(users, [owner], "{heavy}");
        let text = manifest(owner);
        let line = text.lines().find(|line| {
            let key = line.split(['=', '.']).next().unwrap_or_default().trim();
            key.strip_prefix("blocksim-").unwrap_or(key) == heavy && line.contains("optional")
        });
        assert!(line.is_some_and(|line| line.contains("optional = true")), "{heavy} in {owner}");
        let brings = |line: &str| {
            line.split_once(" = ").is_some_and(|(key, crates)| key == feature && crates.contains("dep:"))
        };
        assert!(text.lines().any(brings), "no feature `{feature}` of {owner}");
    }
    // The program takes them by features of the same names and has none of them by default.
    let program = manifest("cli");
    for (_, owner, feature) in heavy.iter().filter(|(_, owner, _)| *owner != "cli") {
        assert!(program.contains(&format!("{feature} = [\"blocksim-{owner}/{feature}\"]")), "{feature}");
    }
    assert!(program.contains("full = [\"lsp\", \"parquet\", \"png\", \"site\", \"wasm\", \"xlsx\"]"));
    assert!(
        !program.lines().any(|line| line.starts_with("default =")),
        "all of them are off where a clone first builds"
    );
}

/// All crates of the program with the features that are asked of them, by name and version.
fn features_of_program(options: &[&str]) -> BTreeMap<String, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["tree", "--package", "blocksim-cli", "--edges", "no-dev", "--prefix", "none"]);
    command.args(["--format", "{p}|{f}", "--locked", "--offline", "--quiet"]).args(options);
    let output = command.current_dir(root()).output().expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let lines = text.lines().filter_map(|line| line.trim_end_matches(" (*)").split_once('|'));
    lines.map(|(name, features)| (name.to_owned(), features.to_owned())).collect()
}

/// Who builds the program without its parts and then with them builds the library of blocks and the engine once: what they
/// stand on has the same features in both.
#[test]
fn a_build_with_all_parts_goes_on_from_one_without() {
    let (lean, full) = (features_of_program(&[]), features_of_program(&["--features", "full"]));
    assert!(lean.len() > 60 && full.len() > lean.len() + 30, "{} crates, {} in all", lean.len(), full.len());
    // The parts themselves, and what only these and the pages of runs need.
    let own =
        ["blocksim-cli ", "blocksim-export ", "blocksim-host ", "blocksim-params ", "blocksim-picture "];
    let above = ["flate2 ", "simd-adler32 "];
    for (name, features) in &lean {
        if own.iter().chain(&above).all(|own| !name.starts_with(own)) {
            let asked = &full[name];
            assert_eq!(features, asked, "ask for these features of {name} in crates/cli/Cargo.toml");
        }
    }
}

/// The check of absences sees what is there.
#[test]
fn the_edges_reach_all_crates_of_the_program() {
    let reached = reach("cli");
    for name in [
        "blocks",
        "diagram",
        "network",
        "multibody",
        "robotics",
        "solve",
        "sim",
        "host",
        "abi",
        "recording",
        "syntax",
    ] {
        assert!(reached.contains(name), "cli does not reach {name}: {reached:?}");
    }
    assert!(holds_word("let x = unsafe { y };", "unsafe") && !holds_word("// unsafe", "unsafe"));
    assert!(!holds_word("unsafe_code = 1; \"unsafe\"", "unsafe"));
}

/// Opening files from a pass of the compiler, or printing below the program, would break the layers.
#[test]
fn no_pass_of_the_compiler_opens_a_file_and_no_library_prints() {
    for name in crates() {
        for file in sources_of(&name) {
            let text = read(&file);
            let tests = file.to_string_lossy().ends_with("_tests.rs")
                || file.to_string_lossy().ends_with("/tests.rs");
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            let opens = |line: &str| line.contains("std::fs") && !line.trim_start().starts_with("//");
            if ["diagram", "sim", "block", "blocks", "network", "signal", "solve"].contains(&name.as_str())
                && !tests
            {
                assert!(!code.lines().any(opens), "{} opens files", file.display());
            }
            if name != "cli" && !tests {
                let prints = |line: &str| ["println", "eprintln"].iter().any(|word| holds_word(line, word));
                assert!(!code.lines().any(prints), "{} prints", file.display());
            }
        }
    }
}
