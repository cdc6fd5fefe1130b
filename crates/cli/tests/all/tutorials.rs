//! The tutorials of the manual: every file is written, every command typed, in the order of the page, and answers as the page says.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{in_shell, root};

/// A part of a page between fences.
struct Fence<'a> {
    /// Language, and the name of the file that the part is.
    language: &'a str,
    file: Option<&'a str>,
    text: &'a str,
    /// Whether nothing but blank lines lies between it and the fence before.
    follows: bool,
}

fn fences(page: &str) -> Vec<Fence<'_>> {
    let parts: Vec<&str> = page.split("```").collect();
    let fence = |at: usize| {
        let (info, text) = parts[at].split_once('\n').expect("a line below the fence");
        let mut words = info.split_whitespace();
        let (language, file) = (words.next().unwrap_or_default(), words.next());
        Fence { language, file, text, follows: parts[at - 1].trim().is_empty() }
    };
    (1..parts.len()).step_by(2).map(fence).collect()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let (entry, name) = entry.map(|entry| (entry.path(), entry.file_name())).expect("an entry");
        if entry.is_dir() {
            copy(&entry, &to.join(name));
        } else {
            fs::copy(&entry, to.join(name)).expect("a copy");
        }
    }
}

/// A folder like that of the project, as far as a tutorial needs it.
fn desk(page: &str) -> PathBuf {
    let desk =
        PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("tutorial-{page}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&desk);
    for part in ["diagrams", "params"] {
        copy(&root().join(part), &desk.join(part));
    }
    // Crates stay where their workspace is.
    let plugins = root().join("plugins").canonicalize().expect("the plug-ins");
    std::os::unix::fs::symlink(plugins, desk.join("plugins")).expect("a link");
    desk
}

/// Follows a page; returns how many commands were typed.
fn follow(name: &str) -> usize {
    let page = fs::read_to_string(root().join("docs/tutorials").join(name)).expect("a page");
    let desk = desk(name);
    let (mut answer, mut typed) = (String::new(), 0);
    for Fence { language, file, text, follows } in fences(&page) {
        match (language, file) {
            (_, Some(file)) => fs::write(desk.join(file), text).expect("a file"),
            ("sh", None) => {
                answer.clear();
                for line in text.lines() {
                    let (command, code) = line.split_once("# exits with ").unwrap_or((line, "0"));
                    let output = in_shell(command, &desk);
                    let said = [output.stdout, output.stderr]
                        .map(|said| String::from_utf8_lossy(&said).into_owned());
                    answer += &said.concat();
                    let expected = code.trim().parse().ok();
                    assert_eq!(output.status.code(), expected, "{name}: {command}\n{}", said.concat());
                    typed += 1;
                }
            }
            ("text", None) if follows => {
                for line in text.lines().filter(|line| !line.is_empty()) {
                    assert!(answer.contains(line), "{name}: the page shows\n{line}\nof\n{answer}");
                }
            }
            _ => {}
        }
    }
    fs::remove_dir_all(&desk).expect("to tidy up");
    typed
}

#[test]
fn the_tutorials_can_be_followed_word_for_word() {
    let pages = fs::read_dir(root().join("docs/tutorials")).expect("the tutorials");
    let names = pages.map(|page| page.expect("an entry").file_name().to_string_lossy().into_owned());
    let typed: usize = names.map(|name| follow(&name)).sum();
    assert!(typed >= 20, "only {typed} commands are typed");
}
