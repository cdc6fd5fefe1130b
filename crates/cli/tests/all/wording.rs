//! The words of the program and of its manual: plain English, the terms of the field.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{program, root};

/// Words that are refused, and what to write instead.
const WORDS: [(&str, &str); 18] = [
    ("tell", "print, show, list, report"),
    ("tells", "prints, shows, lists, reports"),
    ("telling", "printing, showing, reporting"),
    ("told", "printed, shown, reported"),
    ("says", "shows, states, has"),
    ("said", "given, stated, reported"),
    ("mend", "fix"),
    ("mends", "fixes"),
    ("mended", "fixed"),
    ("mending", "fixing"),
    ("heed", "respect"),
    ("heeds", "respects"),
    ("heeded", "respected"),
    ("wanted", "required, set"),
    ("asked", "requested"),
    ("untold", "unknown"),
    ("nobody", "nothing, or the passive"),
    ("somebody", "a user"),
];

/// Phrases that are refused, and what to write instead.
const PHRASES: [(&str, &str); 21] = [
    ("to and fro", "is chattering"),
    ("is no value", "is not a value"),
    ("is no name", "is not a valid name"),
    ("is no choice", "is not one of"),
    ("is no number", "is not a number"),
    ("is no unit", "is not a unit"),
    ("is no file", "is not a file"),
    ("is no folder", "is not a folder"),
    ("is no scene", "is not a scene"),
    ("are no numbers", "are not numbers"),
    ("there is none", "is missing, does not exist"),
    ("is none", "is missing, is empty, is not one"),
    ("at its end time", "at stop time"),
    ("in space", "3D"),
    ("the rest came", "clearances"),
    ("becomes of it", "vary its ..."),
    ("taken are", "assuming"),
    ("must be able to do", "the contract"),
    ("` is no", "is not a"),
    ("this is no", "this is not a"),
    ("it is no", "it is not a"),
];

/// Text with what is allowed: a file, and a piece of the line with the word, as short as can be.
const ALLOWED: [(&str, &str); 2] =
    [("crates/cli/src/search/synonyms.rs", "\"tell\""), ("docs/errors/plugin_panic.md", "panicked")];

/// The first refused word or phrase of a line, with the advice.
fn refused(line: &str) -> Option<(&'static str, &'static str)> {
    let line = line.to_lowercase();
    let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '-');
    let word = |word: &str| WORDS.iter().find(|(refused, _)| *refused == word);
    let found = words.find_map(word).copied();
    let bounded = |phrase: &str| {
        line.match_indices(phrase).any(|(at, _)| {
            let ends = [line[..at].chars().next_back(), line[at + phrase.len()..].chars().next()];
            ends.into_iter().flatten().all(|c| !c.is_alphanumeric())
        })
    };
    found.or_else(|| PHRASES.iter().find(|(phrase, _)| bounded(phrase)).copied())
}

/// The string literals of a Rust source before its tests, with their lines; comments are left out.
fn literals(source: &str) -> Vec<(usize, String)> {
    let source = source.split("#[cfg(test)]").next().unwrap_or_default();
    let (mut found, mut line, mut signs) = (Vec::new(), 1, source.chars().peekable());
    let mut before = ' ';
    while let Some(sign) = signs.next() {
        match sign {
            '\n' => line += 1,
            '/' if signs.peek() == Some(&'/') => while signs.next_if(|sign| *sign != '\n').is_some() {},
            // A character, or the name of a lifetime.
            '\'' => {
                let next = signs.next();
                match (next, signs.peek()) {
                    (Some('\\'), _) => {
                        signs.next();
                        while signs.next_if(|sign| *sign != '\'').is_some() {}
                        signs.next();
                    }
                    (_, Some('\'')) => drop(signs.next()),
                    _ => {}
                }
            }
            'r' if matches!(signs.peek(), Some('"' | '#')) && !before.is_alphanumeric() && before != '_' => {
                let mut hashes = 0;
                while signs.next_if_eq(&'#').is_some() {
                    hashes += 1;
                }
                if signs.next_if_eq(&'"').is_some() {
                    let (begin, end) = (line, format!("\"{}", "#".repeat(hashes)));
                    let mut text = String::new();
                    for sign in signs.by_ref() {
                        line += usize::from(sign == '\n');
                        text.push(sign);
                        if text.ends_with(&end) {
                            break;
                        }
                    }
                    found.push((begin, text));
                }
            }
            '"' => {
                let (begin, mut text) = (line, String::new());
                while let Some(sign) = signs.next() {
                    line += usize::from(sign == '\n');
                    match sign {
                        '"' => break,
                        '\\' => match signs.next() {
                            Some('\n') => {
                                line += 1;
                                while signs.next_if(|sign| *sign == ' ').is_some() {}
                            }
                            Some('n') => text.push('\n'),
                            _ => text.push(' '),
                        },
                        sign => text.push(sign),
                    }
                }
                // What stands in braces is code.
                found.push((begin, without_braces(&text)));
            }
            _ => {}
        }
        before = sign;
    }
    found
}

fn without_braces(text: &str) -> String {
    let mut depth = 0_usize;
    text.chars()
        .filter(|sign| {
            depth += usize::from(*sign == '{');
            let is_outside = depth == 0;
            depth -= usize::from(*sign == '}' && depth > 0);
            is_outside
        })
        .collect()
}

fn files_below(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            if path.file_name().is_none_or(|name| name != "target") {
                files_below(&path, ending, found);
            }
        } else if path.extension().is_some_and(|own| own == ending) {
            found.push(path);
        }
    }
}

/// Gathers what is refused in a line of a file.
fn look(faults: &mut Vec<String>, file: &str, number: usize, line: &str) {
    let is_allowed = ALLOWED.iter().any(|(name, piece)| file.ends_with(name) && line.contains(piece));
    if let Some((word, instead)) = refused(line).filter(|_| !is_allowed) {
        faults.push(format!("{file}:{number}: `{word}`, but: {instead}\n    {}", line.trim()));
    }
}

fn none(mut faults: Vec<String>) {
    let count = faults.len();
    faults.truncate(200);
    assert!(faults.is_empty(), "{count} places:\n{}", faults.join("\n"));
}

#[test]
fn messages_are_in_plain_english() {
    let (mut files, mut faults, mut seen) = (Vec::new(), Vec::new(), 0);
    files_below(&root().join("crates"), "rs", &mut files);
    files_below(&root().join("plugins"), "rs", &mut files);
    for file in files {
        let name = file.strip_prefix(root()).expect("below the project").display().to_string();
        let is_code = name.contains("/src/") && !name.ends_with("tests.rs") && !name.contains("block-macros");
        if !is_code {
            continue;
        }
        for (line, literal) in literals(&fs::read_to_string(&file).expect("a source")) {
            // A word alone is a name: of a field, a metric, an option.
            if literal.contains(' ') {
                seen += 1;
                literal.split('\n').for_each(|text| look(&mut faults, &name, line, text));
            }
        }
    }
    assert!(seen > 3000, "only {seen} texts were looked at");
    none(faults);
}

#[test]
fn the_manual_is_in_plain_english() {
    let (mut files, mut faults) =
        (vec![root().join("README.md"), root().join("diagrams/README.md")], Vec::new());
    files_below(&root().join("docs"), "md", &mut files);
    assert!(files.len() > 100, "only {} pages were found", files.len());
    for file in files {
        let name = file.strip_prefix(root()).expect("below the project").display().to_string();
        let text = fs::read_to_string(&file).expect("a page");
        for (number, line) in text.lines().enumerate() {
            look(&mut faults, &name, number + 1, line);
        }
    }
    none(faults);
}

/// A sentence that stands twice in a page was pasted into the place of another one.
#[test]
fn no_line_of_a_guide_is_there_twice() {
    let (mut files, mut faults) =
        (vec![root().join("README.md"), root().join("ARCHITECTURE.md")], Vec::new());
    files_below(&root().join("docs"), "md", &mut files);
    for file in files {
        let text = fs::read_to_string(&file).expect("a page");
        let (mut is_code, mut seen) = (false, BTreeSet::new());
        for line in text.lines() {
            is_code ^= line.starts_with("```");
            let is_prose = !is_code && !line.starts_with('|') && line.chars().count() > 60;
            if is_prose && !seen.insert(line) {
                faults.push(format!("{}: {line}", file.display()));
            }
        }
    }
    none(faults);
}

/// The commands that the help of a command lists.
fn commands(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let lines = lines.take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next().map(str::to_owned)).collect()
}

#[test]
fn help_is_in_plain_english() {
    let (mut left, mut faults, mut seen) = (vec![Vec::<String>::new()], Vec::new(), 0);
    while let Some(words) = left.pop() {
        let output =
            program().args(&words).arg("--help").env("COLUMNS", "400").output().expect("the program");
        let help = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{words:?}: {help}");
        let name = format!("blocksim {} --help", words.join(" "));
        help.lines().enumerate().for_each(|(at, line)| look(&mut faults, &name, at + 1, line));
        seen += 1;
        for command in commands(&help).into_iter().filter(|command| command != "help") {
            left.push(words.iter().cloned().chain([command]).collect());
        }
    }
    assert!(seen > 35, "only {seen} commands were looked at");
    none(faults);
}

#[test]
fn pages_of_blocks_are_in_plain_english() {
    // Linked is only what is named.
    use blocksim_blocks as _;
    let mut faults = Vec::new();
    let kinds = blocksim_block::kinds();
    assert!(kinds.len() > 100, "the library is not linked");
    for info in kinds {
        let texts = std::iter::once(info.doc).chain(info.parameters.iter().map(|parameter| parameter.doc));
        let lines = texts.flat_map(str::lines);
        lines.enumerate().for_each(|(at, line)| look(&mut faults, info.kind, at + 1, line));
    }
    none(faults);
}

/// Files are named after what they hold.
#[test]
fn files_have_names_that_are_nouns() {
    let refused =
        ["told", "said", "asked", "kept", "seen", "shown", "drawn", "held", "wanted", "meant", "unseen"];
    let mut files = Vec::new();
    files_below(&root().join("crates"), "rs", &mut files);
    files.retain(|file| {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        stem.rsplit('_').next().is_some_and(|word| refused.contains(&word))
    });
    assert!(files.is_empty(), "{files:?}");
}

#[test]
fn refused_words_are_found_where_they_stand() {
    assert_eq!(refused("This tells nothing").map(|(word, _)| word), Some("tells"));
    assert_eq!(refused("`x` is no number").map(|(word, _)| word), Some("is no number"));
    assert_eq!(refused("a number of tellers, mendelevium; this is nonentity"), None);
    let source = "// \"told\"\nlet a = \"one \\\n    two {told}\"; 'x'; '\"'; r#\"is no \"name\" \"#;\n#[cfg(test)] \"said\"";
    let texts: Vec<(usize, String)> = literals(source);
    assert_eq!(texts[0], (2, "one two ".to_owned()));
    assert_eq!(texts[1].0, 3);
    assert!(texts[1].1.starts_with("is no \"name\""));
    assert_eq!(texts.len(), 2);
}
