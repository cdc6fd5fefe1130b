//! The layout of texts, over all models, sets and examples that ship with the project.

use std::path::{Path, PathBuf};

use blocksim_block::kinds;
use blocksim_blocks as _;
use blocksim_syntax::{Node, Shape, format as laid_out};
use blocksim_tests::root;

/// All `.ron` files of a folder and below.
fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "ron") {
            found.push(path);
        }
    }
}

/// The tree without places.
fn said(node: &Node) -> String {
    let members = |members: &[(blocksim_syntax::Name, Node)]| {
        members.iter().map(|(name, node)| format!("{:?}={};", name.text, said(node))).collect::<String>()
    };
    let items = |items: &[Node]| items.iter().map(|node| said(node) + ";").collect::<String>();
    let word = |word: &Option<blocksim_syntax::Name>| word.as_ref().map(|word| word.text.clone());
    match &node.value {
        Shape::List(all) => format!("[{}]", items(all)),
        Shape::Tuple(name, all) => format!("{:?}({})", word(name), items(all)),
        Shape::Map(all) => format!("{{{}}}", members(all)),
        Shape::Struct(name, all) => format!("{:?}({})", word(name), members(all)),
        plain => format!("{plain:?}"),
    }
}

#[track_caller]
fn is_kept(name: &str, text: &str) {
    let tree = said(&blocksim_syntax::read(text).expect(name));
    // Also as one line, and as one with a line for each bracket: the rules have more to do then.
    for text in [text.to_owned(), text.replace('(', "(\n"), text.replace(", ", ",\n")] {
        if blocksim_syntax::read(&text).is_ok_and(|node| said(&node) == tree) {
            let once = laid_out(&text).unwrap_or_else(|error| panic!("{name}: {error:?}"));
            assert_eq!(said(&blocksim_syntax::read(&once).expect(name)), tree, "{name}");
            assert_eq!(laid_out(&once).as_ref(), Ok(&once), "{name}");
        }
    }
}

#[test]
fn all_models_and_sets_of_the_project_are_laid_out() {
    let mut files = Vec::new();
    for folder in ["diagrams", "params", "plugins", "crates/cli/src/commands"] {
        texts(&root().join(folder), &mut files);
    }
    assert!(files.len() > 60);
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a text");
        is_kept(&file.display().to_string(), &text);
        let formatted = laid_out(&text).expect("a text");
        assert!(formatted == text, "{}: run `blocksim fmt diagrams params` on it", file.display());
    }
}

#[test]
fn examples_of_blocks_mean_the_same_when_they_are_laid_out() {
    let mut seen = 0;
    for block in kinds() {
        for example in block.examples() {
            // Some are lines of a diagram.
            let text = if blocksim_syntax::read(example).is_ok() {
                example.to_owned()
            } else {
                format!("{{{example}}}")
            };
            if blocksim_syntax::read(&text).is_ok() {
                is_kept(block.kind, &text);
                seen += 1;
            }
        }
    }
    assert!(seen > 150, "{seen}");
}
