//! The terms of all parts: `blocksim licences` has the texts of what is in the lock, and `.deny.toml` allows them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::support::{program, root};

/// What is written when the texts are renewed; a machine need not have the crates of other systems.
const SYSTEMS: [&str; 3] = ["x86_64-unknown-linux-gnu", "aarch64-apple-darwin", "x86_64-pc-windows-msvc"];

/// Terms, those first that ask least; of several that may be chosen the first is.
const TERMS: [&str; 10] = [
    "0BSD",
    "CC0-1.0",
    "Unlicense",
    "MIT",
    "ISC",
    "Zlib",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "Unicode-3.0",
    "Apache-2.0",
];

/// A crate of another project.
#[derive(Debug, Clone)]
struct Part {
    name: String,
    version: String,
    licence: String,
    source: String,
    folder: PathBuf,
}

fn texts_file() -> PathBuf {
    root().join("crates/cli/src/commands/licences/third_party.txt")
}

fn metadata(systems: &[&str]) -> Value {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["metadata", "--format-version", "1", "--locked", "--offline"]).current_dir(root());
    systems.iter().for_each(|system| {
        command.args(["--filter-platform", system]);
    });
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("data")
}

fn here() -> String {
    let output = Command::new("rustc").arg("-vV").output().expect("rustc runs");
    let said = String::from_utf8(output.stdout).expect("text");
    said.lines().find_map(|line| line.strip_prefix("host: ")).expect("a system").to_owned()
}

/// All crates of others in the lock, and those of them that the program is made of.
fn parts(systems: &[&str]) -> (Vec<Part>, Vec<Part>) {
    let metadata = metadata(systems);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut all = BTreeMap::new();
    for package in list(&metadata["packages"]).iter().filter(|package| !package["source"].is_null()) {
        let manifest = PathBuf::from(text(&package["manifest_path"]));
        let part = Part {
            name: text(&package["name"]),
            version: text(&package["version"]),
            licence: text(&package["license"]),
            source: text(&package["source"]),
            folder: manifest.parent().expect("a folder").to_owned(),
        };
        all.insert(text(&package["id"]), part);
    }
    let nodes: BTreeMap<String, Value> =
        list(&metadata["resolve"]["nodes"]).into_iter().map(|node| (text(&node["id"]), node)).collect();
    let program = list(&metadata["packages"]).into_iter().find(|package| package["name"] == "blocksim-cli");
    let mut waiting = vec![text(&program.expect("the program")["id"])];
    let mut seen = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if !seen.insert(id.clone()) {
            continue;
        }
        for needed in list(&nodes[&id]["deps"]) {
            // Not what only tests and build scripts need.
            if list(&needed["dep_kinds"]).iter().any(|kind| kind["kind"].is_null()) {
                waiting.push(text(&needed["pkg"]));
            }
        }
    }
    let used = seen.iter().filter_map(|id| all.get(id).cloned()).collect();
    (all.into_values().collect(), used)
}

/// The terms of an expression of SPDX that are chosen where only `allowed` ones are; `None` if it cannot be met.
fn chosen(expression: &str, allowed: &[String]) -> Option<BTreeSet<String>> {
    let expression = expression.trim();
    for (word, is_either) in [(" OR ", true), ("/", true), (" AND ", false)] {
        let parts = split(expression, word);
        if parts.len() < 2 {
            continue;
        }
        let each: Vec<Option<BTreeSet<String>>> = parts.iter().map(|part| chosen(part, allowed)).collect();
        return match is_either {
            true => each.into_iter().flatten().min_by_key(cost),
            false => Some(each.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten().collect()),
        };
    }
    match expression.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => chosen(inner, allowed),
        None => {
            allowed.iter().any(|known| known == expression).then(|| BTreeSet::from([expression.to_owned()]))
        }
    }
}

fn cost(terms: &BTreeSet<String>) -> usize {
    terms.iter().map(|term| 1 + TERMS.iter().position(|known| known == term).unwrap_or(TERMS.len())).sum()
}

/// Parts between a word that stands outside of parentheses.
fn split<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ if depth == 0 && at >= start && text[at..].starts_with(word) => {
                parts.push(&text[start..at]);
                start = at + word.len();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// A list of `.deny.toml`: what stands in quotes between `name = [` and `]`.
fn listed(name: &str) -> Vec<String> {
    let rules = fs::read_to_string(root().join(".deny.toml")).expect("the rules");
    let (_, rest) = rules.split_once(&format!("\n{name} = [")).unwrap_or_else(|| panic!("no list {name}"));
    rest.split(']').next().unwrap_or_default().split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// Licence files of a crate for some terms.
fn files(part: &Part, terms: &BTreeSet<String>) -> Vec<PathBuf> {
    // Some crates bring the sources of others along.
    let inside = part.folder.join("c_src/mimalloc/v3");
    let folders = [Some(&part.folder), Some(&inside).filter(|inside| inside.is_dir())];
    let mut all: Vec<PathBuf> = folders
        .into_iter()
        .flatten()
        .flat_map(|folder| fs::read_dir(folder).expect("a crate"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| {
            let name = name_of(path);
            path.is_file()
                && ["LICEN", "COPYING", "UNLICEN", "NOTICE"].iter().any(|begin| name.starts_with(begin))
        })
        .collect();
    all.sort();
    let words = ["MIT", "APACHE", "BSD", "ZLIB", "UNICODE", "0BSD", "CC0", "UNLICENSE", "ISC"];
    let is_named = |path: &PathBuf| words.iter().any(|word| name_of(path).contains(word));
    let is_of = |path: &PathBuf, term: &str| {
        let term = term.to_uppercase();
        words.iter().any(|word| term.starts_with(word) && name_of(path).contains(word))
    };
    let mut found: Vec<PathBuf> = Vec::new();
    for term in terms {
        let named: Vec<PathBuf> = all.iter().filter(|path| is_of(path, term)).cloned().collect();
        match named.is_empty() {
            false => found.extend(named),
            // One file without a name holds the terms of all, or those that remain.
            true => found.extend(all.iter().filter(|path| !is_named(path)).cloned()),
        }
    }
    found.extend(all.iter().filter(|path| name_of(path).starts_with("NOTICE")).cloned());
    found.sort();
    found.dedup();
    if found.is_empty() { all } else { found }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_uppercase()
}

/// The lines of a licence that name its holders, and the text without them.
fn holders(text: &str) -> (Vec<String>, String) {
    let is_holder = |line: &str| {
        let line = line.trim().to_lowercase();
        (line.starts_with("copyright (c)")
            || line.starts_with("copyright ©")
            || line.starts_with("copyright 2"))
            && !line.contains("[yyyy]")
            && !line.contains("{yyyy}")
    };
    let (holders, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| is_holder(line));
    (holders.iter().map(|line| line.trim().to_owned()).collect(), rest.join("\n").trim().to_owned())
}

/// Texts that differ in white space and capitals alone.
fn key(text: &str) -> String {
    text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The file of the program: all crates with their terms, and each text once, below those whose it is.
fn written(parts: &[Part]) -> String {
    let allowed = listed("allow");
    let mut out = "Crates of other projects\n------------------------\n\n".to_owned();
    let mut texts: BTreeMap<String, (String, Vec<String>)> = BTreeMap::new();
    let mut order = Vec::new();
    for part in parts {
        let terms = chosen(&part.licence, &allowed).unwrap_or_else(|| panic!("{part:?}"));
        let list = terms.iter().cloned().collect::<Vec<_>>().join(" and ");
        out.push_str(&format!("{} {}: {} (under {list})\n", part.name, part.version, part.licence));
        for file in files(part, &terms) {
            let text = fs::read_to_string(&file).expect("a licence").replace('\r', "");
            let (holders, rest) = holders(&text);
            let entry = texts.entry(key(&rest)).or_insert_with(|| {
                order.push(key(&rest));
                (rest, Vec::new())
            });
            entry.1.push(format!("{} {}", part.name, part.version));
            entry.1.extend(holders.iter().map(|holder| format!("    {holder}")));
        }
    }
    for key in order {
        let (text, owners) = &texts[&key];
        let text: Vec<&str> = text.lines().map(str::trim_end).collect();
        out.push_str(&format!(
            "\n{}\n\nThe terms of\n\n{}\n\n{}\n",
            "-".repeat(80),
            owners.join("\n"),
            text.join("\n")
        ));
    }
    out
}

#[test]
fn the_licences_of_all_crates_are_printed() {
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(texts_file(), written(&parts(&SYSTEMS).1)).expect("the texts");
    }
    let output = program().arg("licences").output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0));
    let printed = String::from_utf8(output.stdout).expect("text");
    let file = fs::read_to_string(texts_file()).expect("the texts");
    assert!(printed.ends_with(&file) || std::env::var_os("UPDATE_EXPECT").is_some());
    for text in [
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "crates/report/assets/uPlot.LICENSE",
        "crates/picture/assets/LICENSE.txt",
    ] {
        let text = fs::read_to_string(root().join(text)).expect("a licence");
        assert!(printed.contains(text.trim_end()), "{text}");
    }
    let (_, used) = parts(&[&here()]);
    assert!(used.len() > 50, "{}", used.len());
    for Part { name, version, licence, .. } in &used {
        let line = format!("\n{name} {version}: {licence} (under ");
        assert!(file.contains(&line), "{line} is missing; UPDATE_EXPECT=1 writes the texts anew");
    }
    // What is no longer a part is not printed either.
    let lock = fs::read_to_string(root().join("Cargo.lock")).expect("the lock");
    for line in file.lines().skip(3).take_while(|line| !line.is_empty()) {
        let (part, _) = line.split_once(": ").expect("a part");
        let (name, version) = part.split_once(' ').expect("a version");
        assert!(lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"")), "{part} is gone");
    }
}

#[test]
fn the_rules_allow_what_is_used_and_no_more() {
    let allowed = listed("allow");
    let (all, _) = parts(&[&here()]);
    for part in &all {
        assert!(
            chosen(&part.licence, &allowed).is_some(),
            "{part:?} has terms that .deny.toml does not allow"
        );
        assert!(part.source.starts_with("registry+") && part.source == all[0].source, "{part:?}");
    }
    let needed = |term: &String| {
        let others: Vec<String> = allowed.iter().filter(|other| *other != term).cloned().collect();
        all.iter().any(|part| chosen(&part.licence, &others).is_none())
    };
    let idle: Vec<&String> = allowed.iter().filter(|term| !needed(term)).collect();
    assert!(idle.is_empty(), "no part needs {idle:?}");
}

#[test]
fn expressions_of_terms_are_understood() {
    let allowed: Vec<String> = ["MIT", "Apache-2.0", "BSD-3-Clause"].map(str::to_owned).to_vec();
    let of = |text: &str| chosen(text, &allowed).map(|terms| terms.into_iter().collect::<Vec<_>>().join(" "));
    assert_eq!(of("MIT OR Apache-2.0").as_deref(), Some("MIT"));
    assert_eq!(of("GPL-3.0 OR Apache-2.0").as_deref(), Some("Apache-2.0"));
    assert_eq!(of("(Apache-2.0 OR MIT) AND BSD-3-Clause").as_deref(), Some("BSD-3-Clause MIT"));
    assert_eq!(of("MIT/Apache-2.0").as_deref(), Some("MIT"));
    assert_eq!(of("MIT AND GPL-3.0"), None);
    assert_eq!(of("Apache-2.0 WITH LLVM-exception"), None);
}
