//! What a file declares, also while it is half written.

use std::ops::Range;

use blocksim_syntax::{Event, scan};

/// A parameter, a block, or what comes in, goes out or is joined.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Declared<'a> {
    /// Its name.
    pub name: &'a str,
    /// Kind of a block; empty for all else.
    pub kind: &'a str,
    /// Place of the name, without quotes.
    pub place: Range<usize>,
    /// What it is.
    pub section: Section,
}

/// Sections of a diagram that declare names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// `parameters`
    Parameter,
    /// `inputs`
    Input,
    /// `outputs`
    Output,
    /// `ports`
    Port,
    /// `blocks`
    Block,
}

/// What the section of this key declares.
fn section(key: &str) -> Option<Section> {
    Some(match key {
        "parameters" => Section::Parameter,
        "inputs" => Section::Input,
        "outputs" => Section::Output,
        "ports" => Section::Port,
        "blocks" => Section::Block,
        _ => return None,
    })
}

/// All that the diagram in a text declares, in its order.
pub fn declared(text: &str) -> Vec<Declared<'_>> {
    let mut found: Vec<Declared> = Vec::new();
    scan(text, text.len(), |open, event| {
        let [outer, inner, ..] = open else { return };
        let Some(section) = section(inner.key).filter(|_| outer.word == "Diagram" && inner.sign == '{')
        else {
            return;
        };
        match event {
            Event::Key(name, place) if open.len() == 2 => {
                found.push(Declared { name, kind: "", place, section });
            }
            Event::Word(word, _) if open.len() == 2 && section == Section::Block => {
                if let Some(block) = found.last_mut().filter(|last| last.kind.is_empty()) {
                    block.kind = word;
                }
            }
            _ => {}
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use blocksim_syntax::{Node, Shape};

    use super::*;

    #[test]
    fn blocks_have_kinds_and_all_else_has_none() {
        let text = r#"Diagram(
            parameters: { "k": "2", "motor": File("m.ron") },
            inputs: { "u": () },
            blocks: { "a": Gain(k: "k"), "b": Divide, "half": Ga"#;
        let found: Vec<_> = declared(text).iter().map(|d| (d.name, d.kind, d.section)).collect();
        assert_eq!(
            found,
            [
                ("k", "", Section::Parameter),
                ("motor", "", Section::Parameter),
                ("u", "", Section::Input),
                ("a", "Gain", Section::Block),
                ("b", "Divide", Section::Block),
                ("half", "", Section::Block)
            ]
        );
        assert_eq!(&text[declared(text)[3].place.clone()], "a");
    }

    /// All `.ron` files of a folder and below.
    fn files(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            match entry.file_type().unwrap().is_dir() {
                true if entry.file_name() != "runs" && entry.file_name() != "target" => files(&path, found),
                false if path.extension().is_some_and(|ending| ending == "ron") => found.push(path),
                _ => {}
            }
        }
    }

    #[test]
    fn the_compiler_reads_the_same_names_of_all_diagrams_and_pages() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut paths = Vec::new();
        ["diagrams", "docs"].iter().for_each(|folder| files(&root.join(folder), &mut paths));
        let mut compared = 0;
        for path in paths {
            let text = std::fs::read_to_string(&path).unwrap();
            let Ok(Node { value: Shape::Struct(Some(word), members), .. }) = blocksim_syntax::read(&text)
            else {
                continue;
            };
            if word.text != "Diagram" {
                continue;
            }
            let written = members.iter().filter_map(|(key, node)| match &node.value {
                Shape::Map(entries) => Some((section(&key.text)?, entries)),
                _ => None,
            });
            let written = written.flat_map(|(section, entries)| {
                entries.iter().map(move |(name, node)| {
                    let kind = node.word().filter(|_| section == Section::Block);
                    (name, kind.unwrap_or_default(), section)
                })
            });
            let written: Vec<_> =
                written.map(|(name, kind, section)| (name.text.as_str(), kind, section)).collect();
            let found = declared(&text);
            let found: Vec<_> = found.iter().map(|one| (one.name, one.kind, one.section)).collect();
            assert_eq!(found, written, "{}", path.display());
            compared += written.len();
        }
        assert!(compared > 1000, "{compared}");
    }
}
