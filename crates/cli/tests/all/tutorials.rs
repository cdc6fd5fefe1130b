//! The tutorials of the manual: every file is written, every command typed, in the order of the page, and answers as the page says.

use std::fs;

use crate::support::pages::{Fence, fences, folder_of_project};
use crate::support::{in_shell, root};

/// Follows a page; returns how many commands were typed.
fn follow(name: &str) -> usize {
    let page = fs::read_to_string(root().join("docs/tutorials").join(name)).expect("a page");
    let desk = folder_of_project(&format!("tutorial-{name}"));
    let (mut answer, mut typed) = (String::new(), 0);
    for Fence { language, file, text, follows } in fences(&page) {
        match (language, file) {
            (_, Some(file)) => fs::write(desk.join(file), text).expect("a file"),
            ("sh", None) => {
                answer.clear();
                // The studio goes on until somebody ends it; it has a test of its own.
                for line in text.lines().filter(|line| !line.starts_with("blocksim studio")) {
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
    let names = names.filter(|name| name.ends_with(".md"));
    let typed: usize = names.map(|name| follow(&name)).sum();
    assert!(typed >= 20, "only {typed} commands are typed");
}
