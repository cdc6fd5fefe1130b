//! What a new import changes: numbers that came, went or have another value.

use std::collections::BTreeMap;

use blocksim_syntax::{Node, Shape, TokenKind, Tokens, read};

/// Numbers of two parameter files by their paths, `bodies.link_1.mass`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Differences {
    /// Paths that only the new file has.
    pub added: Vec<String>,
    /// Paths that only the old file had.
    pub removed: Vec<String>,
    /// Paths with another value.
    pub changed: Vec<String>,
}

impl Differences {
    /// The groups, such as `bodies.link_7`, of which all numbers are among `paths`, and the other paths.
    pub fn groups(paths: &[String], others: &str) -> Vec<String> {
        let kept = values(others);
        let mut groups: Vec<String> = Vec::new();
        for path in paths {
            let group: Vec<&str> = path.splitn(3, '.').take(2).collect();
            let group = group.join(".");
            let whole = !kept.keys().any(|key| key.starts_with(&format!("{group}.")));
            let told = if whole { group } else { path.clone() };
            if groups.last() != Some(&told) && !groups.contains(&told) {
                groups.push(told);
            }
        }
        groups
    }
}

/// Compares two parameter files as [`parameters`](crate::parameters) writes them.
pub fn differences(old: &str, new: &str) -> Differences {
    let (old, new) = (values(old), values(new));
    let only = |a: &BTreeMap<String, String>, b: &BTreeMap<String, String>| -> Vec<String> {
        a.keys().filter(|key| !b.contains_key(*key)).cloned().collect()
    };
    let changed = new.iter().filter(|(key, value)| old.get(*key).is_some_and(|before| before != *value));
    Differences {
        added: only(&new, &old),
        removed: only(&old, &new),
        changed: changed.map(|(key, _)| key.clone()).collect(),
    }
}

/// Values of a parameter file by their paths, without comments and however they are laid out; none of a text that cannot be read.
pub(crate) fn values(text: &str) -> BTreeMap<String, String> {
    let mut values = BTreeMap::new();
    if let Ok(root) = read(text) {
        gather(text, &root, "", &mut values);
    }
    // What the numbers refer to is compared on its own.
    values.retain(|path, _| !path.starts_with("structure."));
    values
}

fn gather(text: &str, node: &Node, path: &str, values: &mut BTreeMap<String, String>) {
    match &node.value {
        Shape::Struct(None, members) | Shape::Map(members) => {
            for (name, member) in members {
                let dot = if path.is_empty() { "" } else { "." };
                gather(text, member, &format!("{path}{dot}{}", name.text), values);
            }
        }
        _ => {
            let written = &text[node.span.clone()];
            let tokens = Tokens::new(written);
            let tokens = tokens.filter(|token| !token.kind.is_comment() && token.kind != TokenKind::Comma);
            let tokens: Vec<&str> = tokens.map(|token| token.of(written)).collect();
            values.insert(path.to_owned(), tokens.join(" "));
        }
    }
}

/// Lines of a diagram that name a number by its path (or one in a group), from 1.
pub fn named_in(diagram: &str, path: &str) -> Vec<usize> {
    lines_with(diagram, &[format!("model.{path}")])
}

/// The same, and the lines that connect the frames of the blocks which have these numbers, whatever these are called by now.
pub fn wired_in(diagram: &str, path: &str) -> Vec<usize> {
    let number = format!("model.{path}");
    let blocks = read(diagram).map(|root| blocks_with(diagram, &root, &number)).unwrap_or_default();
    let ports =
        blocks.iter().flat_map(|block| ["base", "follower", "frame"].map(|port| format!("{block}.{port}")));
    lines_with(diagram, &std::iter::once(number.clone()).chain(ports).collect::<Vec<_>>())
}

/// Names of the innermost blocks whose parameters name a number.
fn blocks_with(diagram: &str, node: &Node, number: &str) -> Vec<String> {
    let members = node.members().unwrap_or_default();
    let found = members.iter().flat_map(|(name, member)| {
        let inner = blocks_with(diagram, member, number);
        let is_block = member.word().is_some() && inner.is_empty();
        match is_block && contains(&diagram[member.span.clone()], number) {
            true => vec![name.text.clone()],
            false => inner,
        }
    });
    found.collect()
}

/// Lines that contain one of some names, from 1.
fn lines_with(text: &str, names: &[String]) -> Vec<usize> {
    let found = text.lines().enumerate().filter(|(_, line)| names.iter().any(|name| contains(line, name)));
    found.map(|(i, _)| i + 1).collect()
}

/// Whether a text contains a name as a whole, or followed by `.`.
fn contains(text: &str, name: &str) -> bool {
    let goes_on = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(name)
        .any(|(at, _)| !text[..at].ends_with(goes_on) && !text[at + name.len()..].starts_with(goes_on))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = "// x: y\n(\n    bodies: (\n        a: (\n            mass: \"1 kg\",\n            com: [\"0 m\"],\n        ),\n        b: (\n            mass: \"2 kg\",\n        ),\n    ),\n)\n";

    #[test]
    fn what_came_went_and_changed_is_told_by_path() {
        let new = OLD
            .replace("\"1 kg\"", "\"3 kg\"")
            .replace("        b: (", "        c: (")
            .replace("com: [", "moi: [");
        let found = differences(OLD, &new);
        assert_eq!(found.added, ["bodies.a.moi", "bodies.c.mass"]);
        assert_eq!(found.removed, ["bodies.a.com", "bodies.b.mass"]);
        assert_eq!(found.changed, ["bodies.a.mass"]);
        assert_eq!(Differences::groups(&found.removed, &new), ["bodies.a.com", "bodies.b"]);
        assert_eq!(differences(OLD, OLD), Differences::default());
        // A layout is no change.
        let on_one_line = "(bodies: (a: (mass: \"1 kg\", /* x */ com: [\"0 m\"]), b: (mass: \"2 kg\")))";
        assert_eq!(differences(OLD, on_one_line), Differences::default());
    }

    #[test]
    fn lines_that_name_a_number_are_found_by_whole_names() {
        let diagram = "x\n\"model.bodies.b.mass\"\n\"model.bodies.b2.mass\"\n\"2 * model.bodies.b\"";
        assert_eq!(named_in(diagram, "bodies.b"), [2, 4]);
        assert_eq!(named_in(diagram, "bodies.b.mass"), [2]);
    }
}
