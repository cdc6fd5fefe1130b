//! The pages of the manual about errors of the program itself: their commands fail in the words that the pages show.

use crate::support::{commands_of, in_shell, root};

#[test]
fn the_commands_of_error_pages_fail_in_the_words_shown() {
    let folder = root().join("docs/errors");
    let mut tried = 0;
    for entry in std::fs::read_dir(folder).expect("the pages") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        let page = format!("errors/{name}");
        // Other pages are about a diagram, which the tests of diagrams try.
        let is_command = std::fs::read_to_string(root().join("docs").join(&page))
            .expect("a page")
            .contains("## For example\n");
        for (commands, answer) in commands_of(&page).into_iter().filter(|_| is_command) {
            let desk = std::env::temp_dir().join(format!("blocksim-page-{name}-{}", std::process::id()));
            let _ = std::fs::remove_dir_all(&desk);
            std::fs::create_dir_all(&desk).expect("a folder");
            let mut last = (String::new(), Some(0));
            for line in commands.lines() {
                assert_eq!(last.1, Some(0), "{name}: {}", last.0);
                let output = in_shell(line, &desk);
                last = (String::from_utf8_lossy(&output.stderr).into_owned(), output.status.code());
            }
            assert_eq!(last.0.trim(), answer.trim(), "{name}");
            let codes = last.0.split("error[").nth(1).and_then(|rest| rest.split(']').next());
            assert_eq!(
                codes.map(|code| format!("{code}.md")),
                Some(name.clone()),
                "the page is about its own code"
            );
            assert!(matches!(last.1, Some(1..=4)), "{:?}", last.1);
            std::fs::remove_dir_all(&desk).expect("to tidy up");
            tried += 1;
        }
    }
    assert!(tried >= 6, "only {tried} pages have commands");
}
