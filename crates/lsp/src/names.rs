//! What a file declares, also while it is half written.

use std::ops::Range;

use crate::scan::{Event, scan};

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
    scan(text, |open, event| {
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
}
