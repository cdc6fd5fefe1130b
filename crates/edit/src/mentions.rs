//! Entries of `record`, `panel` and `simulation` that name a block.

use std::collections::BTreeSet;
use std::ops::Range;

use blocksim_syntax::{Node, Shape};

use crate::delete::listed;
use crate::text::{Entries, Splice};

/// A list or a map, and the number of one of its entries.
struct Entry<'n> {
    brackets: &'n Node,
    at: usize,
    /// The entry of a list that all of this is within, where it means nothing without.
    around: Option<(&'n Node, usize)>,
}

fn has(node: &Node, span: &Range<usize>) -> bool {
    node.span.start <= span.start && span.end <= node.span.end
}

/// The entry that a name of a path is in: a text of a list, a key of a map, `(signals: "arm/**.q", every: ...)`, or an element of a
/// panel, such as `Slider("pid.k", "0 .. 9")`.
fn entry<'n>(node: &'n Node, span: &Range<usize>, around: Option<(&'n Node, usize)>) -> Option<Entry<'n>> {
    match &node.value {
        Shape::List(items) => {
            let at = items.iter().position(|item| has(item, span))?;
            let item = &items[at];
            if matches!(item.value, Shape::Text(_)) {
                return Some(Entry { brackets: node, at, around });
            }
            let is_text = |value: &Node| has(value, span) && matches!(value.value, Shape::Text(_));
            let names_it = match &item.value {
                Shape::Tuple(_, values) => values.iter().any(is_text),
                _ => item.members().unwrap_or_default().iter().any(|(_, value)| is_text(value)),
            };
            match names_it {
                true => Some(Entry { brackets: node, at, around: None }),
                false => entry(item, span, Some((node, at))),
            }
        }
        Shape::Map(members) | Shape::Struct(_, members) => {
            let within = |(name, _): &(blocksim_syntax::Name, Node)| {
                name.span.start <= span.start && span.end <= name.span.end
            };
            if let Some(at) = members.iter().position(within) {
                return Some(Entry { brackets: node, at, around: None });
            }
            let (_, value) = members.iter().find(|(_, value)| has(value, span))?;
            entry(value, span, around)
        }
        _ => None,
    }
}

/// Entries that go, as a person counts them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Gone {
    pub count: usize,
    /// The sections that they are of.
    pub sections: BTreeSet<String>,
}

impl Gone {
    pub(crate) fn extend(&mut self, other: Gone) {
        self.count += other.count;
        self.sections.extend(other.sections);
    }

    /// A sentence without period; nothing where no entry goes.
    pub(crate) fn described(&self) -> Option<String> {
        let entries = match self.count {
            0 => return None,
            1 => "an entry".to_owned(),
            count => format!("{count} entries"),
        };
        let sections: Vec<String> = self.sections.iter().map(|name| format!("`{name}`")).collect();
        let verb = if self.count == 1 { "was" } else { "were" };
        Some(format!("{entries} of {} {verb} removed as well", listed(&sections)))
    }
}

/// Brackets, the numbers of those of their entries that go, and which entry of others the brackets are.
type Going<'n> = (&'n Node, Vec<usize>, Option<(&'n Node, usize)>);

/// Takes the entries out that names are in.
pub(crate) fn without<'n>(text: &str, root: &'n Node, spots: &[Range<usize>]) -> (Vec<Splice>, Gone) {
    let mut sections: BTreeSet<String> = BTreeSet::new();
    let mut gone: Vec<Going> = Vec::new();
    let mut note = |brackets: &'n Node, at, around| match gone
        .iter_mut()
        .find(|(known, ..)| std::ptr::eq(*known, brackets))
    {
        Some((_, all, _)) if all.contains(&at) => {}
        Some((_, all, _)) => all.push(at),
        None => gone.push((brackets, vec![at], around)),
    };
    for spot in spots {
        if let Some(Entry { brackets, at, around }) = entry(root, spot, None) {
            note(brackets, at, around);
            let section = root.members().unwrap_or_default().iter().find(|(_, value)| has(value, spot));
            sections.extend(section.map(|(name, _)| name.text.clone()));
        }
    }
    // A list without anything left goes with what it is part of.
    let mut whole: Vec<(&Node, usize)> = Vec::new();
    gone.retain(|(brackets, all, around)| {
        let is_empty = matches!(&brackets.value, Shape::List(items) if items.len() == all.len());
        match (is_empty, around) {
            (true, Some(around)) => {
                whole.push(*around);
                false
            }
            _ => true,
        }
    });
    for (brackets, at) in whole {
        match gone.iter_mut().find(|(known, ..)| std::ptr::eq(*known, brackets)) {
            Some((_, all, _)) => all.push(at),
            None => gone.push((brackets, vec![at], None)),
        }
    }
    let count = gone.iter().map(|(_, all, _)| all.len()).sum();
    let splices = gone
        .iter()
        .filter_map(|(brackets, all, _)| Some(Entries::of(text, brackets)?.without(|at| all.contains(&at))));
    (splices.flatten().collect(), Gone { count, sections })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::spliced;
    use blocksim_syntax::read;

    fn left(text: &str, name: &str) -> (String, Gone) {
        let root = read(text).unwrap();
        let spots: Vec<Range<usize>> =
            text.match_indices(name).map(|(at, name)| at..at + name.len()).collect();
        let (splices, gone) = without(text, &root, &spots);
        (spliced(text, splices).unwrap(), gone)
    }

    #[test]
    fn entries_of_lists_and_maps_go_and_with_them_what_means_nothing_without() {
        let text = r#"D(record: ["pid.u", (signals: "pid.e", every: "1 ms"), (signals: ["pid.u", "b.y"], rows: 2),
            (signals: ["pid.u"], rows: 3), "b.y"], simulation: (atol: {"pid": 1, "b": 2}, start: Steady(free: ["pid.x"])))"#;
        let expected = r#"D(record: [(signals: ["b.y"], rows: 2),
            "b.y"], simulation: (atol: {"b": 2}, start: Steady(free: [])))"#;
        let (new, gone) = left(text, "pid");
        assert_eq!(new, expected);
        assert_eq!(gone.count, 6);
        assert_eq!(gone.described().unwrap(), "6 entries of `record` and `simulation` were removed as well");
        assert_eq!(left(text, "nothing"), (text.to_owned(), Gone::default()));
        assert_eq!(Gone::default().described(), None);
    }

    #[test]
    fn elements_of_panels_go_however_they_are_written() {
        let text = r#"D(panel: [
            Slider("pid.k", "0 .. 9"), // turned
            Knob(target: "b.k", range: "0 .. 9", label: "gain of b"),
            Switch(target: "pid.on", label: "b"),
            Lamp("pid.y"),
            Gauge("a/b.y", "0 .. pid"),
        ])"#;
        let expected = r#"D(panel: [
            Knob(target: "b.k", range: "0 .. 9", label: "gain of b"),
            Gauge("a/b.y", "0 .. pid"),
        ])"#;
        let root = read(text).unwrap();
        let spots = text.match_indices("\"pid.").map(|(at, _)| at + 1..at + 4).collect::<Vec<_>>();
        let (splices, gone) = without(text, &root, &spots);
        assert_eq!(spliced(text, splices).unwrap(), expected);
        assert_eq!(gone.described().unwrap(), "3 entries of `panel` were removed as well");
    }
}
