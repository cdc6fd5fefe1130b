//! The texts of `connections`: one output to inputs, or conserving ports joined.

use std::ops::Range;

use blocksim_syntax::{Node, Shape};

use super::{Entries, Splice};

/// What joins the ends of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wire {
    /// `a.y -> b.u, c.u`: the first end is the source.
    Signal,
    /// `a.p <-> b.n <-> c.p`
    Conserving,
}

/// A connection: its ends as written, with the blanks around them.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Item {
    wire: Wire,
    ends: Vec<String>,
    /// Where it stands, with its quotes.
    span: Range<usize>,
    /// How it was written.
    old: String,
    /// New connections that stand behind it.
    behind: Vec<String>,
}

impl Item {
    /// Takes a text apart; `None` where it is no connection, or written in another way than between plain quotes.
    fn read(text: &str, node: &Node) -> Option<Item> {
        let Shape::Text(content) = &node.value else { return None };
        if *text.get(node.span.clone())? != format!("\"{content}\"") {
            return None;
        }
        let pieces = |text: &str, by: &str| text.split(by).map(str::to_owned).collect::<Vec<_>>();
        let (wire, ends) = match content.split_once("<->") {
            Some(_) => (Wire::Conserving, pieces(content, "<->")),
            None => {
                let (source, targets) = content.split_once("->")?;
                let mut ends = vec![source.to_owned()];
                ends.extend(pieces(targets, ","));
                (Wire::Signal, ends)
            }
        };
        Some(Item { wire, ends, span: node.span.clone(), old: content.clone(), behind: Vec::new() })
    }

    fn text(&self) -> String {
        match self.wire {
            Wire::Conserving => self.ends.join("<->").trim().to_owned(),
            Wire::Signal => {
                let (source, targets) = self.ends.split_first().map_or(("", &[][..]), |(s, t)| (s, t));
                format!("{}->{}", source.trim_start(), targets.join(",").trim_end())
            }
        }
    }

    /// Whether it still joins anything.
    fn is_wire(&self) -> bool {
        self.ends.len() > 1
    }
}

/// All connections of a diagram, to be changed.
#[derive(Debug, Clone)]
pub(crate) struct Wires<'t> {
    /// Where they stand; nothing where the diagram has no such section.
    entries: Option<Entries<'t>>,
    items: Vec<Item>,
    /// Connections that stand before all others.
    first: Vec<String>,
}

impl<'t> Wires<'t> {
    /// Those of a diagram; the byte of the first that cannot be changed here where there is one.
    pub(crate) fn of(text: &'t str, connections: Option<&Node>) -> Result<Wires<'t>, usize> {
        let Some(node) = connections else {
            return Ok(Wires { entries: None, items: Vec::new(), first: Vec::new() });
        };
        let Shape::List(list) = &node.value else { return Err(node.span.start) };
        let mut items = Vec::with_capacity(list.len());
        for item in list {
            items.push(Item::read(text, item).ok_or(item.span.start)?);
        }
        Ok(Wires { entries: Entries::of(text, node), items, first: Vec::new() })
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.items.len()
    }

    /// What joins the ends of one.
    pub(crate) fn wire(&self, at: usize) -> Wire {
        self.items[at].wire
    }

    /// The ends of one; of a signal the source comes first. None where it is gone.
    pub(crate) fn ends(&self, at: usize) -> Vec<&str> {
        self.items[at].ends.iter().map(|end| end.trim()).collect()
    }

    /// The connection that has an end at a place among its ends, as [`Wires::ends`] has them.
    pub(crate) fn find(&self, wire: Wire, is_end: impl Fn(usize, &str) -> bool) -> Option<usize> {
        let fits = |item: &Item| {
            item.wire == wire
                && item.is_wire()
                && item.ends.iter().enumerate().any(|(n, end)| is_end(n, end.trim()))
        };
        self.items.iter().rposition(fits)
    }

    /// Takes ends out of a connection; what joins nothing any more goes.
    pub(crate) fn remove(&mut self, at: usize, is_gone: impl Fn(usize, &str) -> bool) {
        let item = &mut self.items[at];
        let mut n = 0;
        item.ends.retain(|end| {
            n += 1;
            !is_gone(n - 1, end.trim())
        });
        if item.ends.len() < 2 {
            item.ends.clear();
        }
    }

    /// Takes a conserving port out of whatever joins it; what it held together stays joined.
    pub(crate) fn leave(&mut self, end: &str) {
        let joins =
            |item: &Item| item.wire == Wire::Conserving && item.ends.iter().any(|known| known.trim() == end);
        let all: Vec<usize> = (0..self.items.len()).filter(|at| joins(&self.items[*at])).collect();
        let Some((&first, others)) = all.split_first() else { return };
        let rest: Vec<String> =
            others.iter().flat_map(|at| self.take(*at)).filter(|other| other != end).collect();
        self.items[first].ends.retain(|known| known.trim() != end);
        for other in rest {
            if !self.items[first].ends.iter().any(|known| *known.trim() == other) {
                self.append(first, &other);
            }
        }
        self.remove(first, |_, _| false);
    }

    /// All ends that conserving connections join to one, perhaps by way of others; itself first.
    pub(crate) fn joined(&self, end: &str) -> Vec<String> {
        let mut all = vec![end.to_owned()];
        let mut next = 0;
        while let Some(end) = all.get(next).cloned() {
            for at in (0..self.len()).filter(|at| self.wire(*at) == Wire::Conserving) {
                let ends = self.ends(at);
                if ends.contains(&end.as_str()) {
                    for end in ends {
                        if !all.iter().any(|known| known == end) {
                            all.push(end.to_owned());
                        }
                    }
                }
            }
            next += 1;
        }
        all
    }

    /// Puts one end in the place of others in each conserving connection that joins them to anything else; the first of these.
    /// What is among the others alone stays.
    pub(crate) fn stand_in(&mut self, others: &[String], new: &str) -> Option<usize> {
        let mut first = None;
        for at in 0..self.len() {
            let gone: Vec<bool> =
                self.ends(at).into_iter().map(|end| others.iter().any(|other| other == end)).collect();
            let place = gone.iter().position(|gone| *gone).filter(|_| gone.contains(&false));
            let Some(place) = place.filter(|_| self.wire(at) == Wire::Conserving) else { continue };
            self.replace(at, place, new);
            self.remove(at, |n, _| n != place && gone[n]);
            first = first.or(Some(at));
        }
        first
    }

    /// Joins a conserving end to another.
    pub(crate) fn hang(&mut self, on: &str, new: &str) {
        match self.find(Wire::Conserving, |_, end| end == on) {
            Some(at) => self.append(at, new),
            None => self.add(None, Wire::Conserving, &[on, new]),
        }
    }

    /// Takes a connection out.
    pub(crate) fn take(&mut self, at: usize) -> Vec<String> {
        std::mem::take(&mut self.items[at].ends).iter().map(|end| end.trim().to_owned()).collect()
    }

    /// Puts an end in the place of another.
    pub(crate) fn replace(&mut self, at: usize, end: usize, new: &str) {
        let old = &mut self.items[at].ends[end];
        let trimmed = old.trim();
        if !trimmed.is_empty() {
            *old = old.replacen(trimmed, new, 1);
        }
    }

    /// Adds an end behind the last.
    pub(crate) fn append(&mut self, at: usize, new: &str) {
        let item = &mut self.items[at];
        match item.wire {
            Wire::Signal => item.ends.push(format!(" {new}")),
            Wire::Conserving => {
                if let Some(last) = item.ends.last_mut().filter(|last| !last.ends_with(' ')) {
                    last.push(' ');
                }
                item.ends.push(format!(" {new}"));
            }
        }
    }

    /// Adds a connection behind one, or behind all.
    pub(crate) fn add(&mut self, behind: Option<usize>, wire: Wire, ends: &[&str]) {
        let text = match wire {
            Wire::Conserving => ends.join(" <-> "),
            Wire::Signal => {
                let (source, targets) = ends.split_first().map_or(("", &[][..]), |(s, t)| (*s, t));
                format!("{source} -> {}", targets.join(", "))
            }
        };
        let behind = behind.or_else(|| self.items.len().checked_sub(1));
        match behind.and_then(|at| self.items.get_mut(at)) {
            Some(item) => item.behind.push(text),
            None => self.first.push(text),
        }
    }

    /// The changes of the text; and the connections that have no place yet, as the diagram has no section for them.
    pub(crate) fn finish(mut self) -> (Vec<Splice>, Vec<String>) {
        let quoted = |texts: &[String]| texts.iter().map(|text| format!("\"{text}\"")).collect::<Vec<_>>();
        let Some(entries) = &self.entries else { return (Vec::new(), quoted(&self.first)) };
        // What is gone makes place for what is new right behind it.
        for item in &mut self.items {
            if !item.is_wire() && !item.behind.is_empty() {
                let new = item.behind.remove(0);
                item.ends = match new.split_once(" -> ") {
                    Some((source, targets)) => {
                        item.wire = Wire::Signal;
                        std::iter::once(format!("{source} "))
                            .chain(
                                targets
                                    .split(',')
                                    .enumerate()
                                    .map(|(n, end)| if n == 0 { format!(" {end}") } else { end.to_owned() }),
                            )
                            .collect()
                    }
                    None => {
                        item.wire = Wire::Conserving;
                        new.split("<->").map(str::to_owned).collect()
                    }
                };
            }
        }
        let new: Vec<(usize, Vec<String>)> =
            self.items.iter().enumerate().map(|(at, item)| (at, quoted(&item.behind))).collect();
        let mut splices = entries.changed(|at| !self.items[at].is_wire(), &new);
        for item in self.items.iter().filter(|item| item.is_wire()) {
            let text = item.text();
            if text != item.old.trim() {
                splices.push(Splice::new(item.span.clone(), format!("\"{text}\"")));
            }
        }
        splices.extend(entries.with(None, &quoted(&self.first)));
        (splices, Vec::new())
    }
}

#[cfg(test)]
mod tests {
    use super::super::spliced;
    use super::*;
    use blocksim_syntax::read;

    const TEXT: &str =
        "(c: [\n    \"a.y -> b.u, c.u\", // two\n    \"p.n <-> q.p <-> r.p\",\n    \"b.y -> d.u\",\n])";

    fn changed(text: &str, change: impl FnOnce(&mut Wires)) -> String {
        let root = read(text).expect("RON");
        let (_, node) = &root.members().expect("members")[0];
        let mut wires = Wires::of(text, Some(node)).expect("connections");
        change(&mut wires);
        let (splices, left) = wires.finish();
        assert!(left.is_empty());
        spliced(text, splices).expect("no overlap")
    }

    #[test]
    fn ends_come_and_go_in_their_texts() {
        assert_eq!(changed(TEXT, |w| w.remove(0, |_, end| end == "b.u")), TEXT.replace("b.u, ", ""));
        assert_eq!(changed(TEXT, |w| w.remove(0, |_, end| end == "c.u")), TEXT.replace(", c.u", ""));
        assert_eq!(changed(TEXT, |w| w.remove(1, |_, end| end == "p.n")), TEXT.replace("p.n <-> ", ""));
        assert_eq!(changed(TEXT, |w| w.remove(1, |_, end| end == "r.p")), TEXT.replace(" <-> r.p", ""));
        assert_eq!(
            changed(TEXT, |w| w.remove(2, |_, end| end == "d.u")),
            TEXT.replace("    \"b.y -> d.u\",\n", "")
        );
        assert_eq!(changed(TEXT, |w| w.append(0, "e.u")), TEXT.replace("c.u", "c.u, e.u"));
        assert_eq!(changed(TEXT, |w| w.append(1, "s.p")), TEXT.replace("r.p", "r.p <-> s.p"));
        assert_eq!(changed(TEXT, |w| w.replace(0, 0, "in.x")), TEXT.replace("a.y", "in.x"));
        assert_eq!(changed(TEXT, |_| ()), TEXT);
    }

    #[test]
    fn what_a_port_held_together_stays_joined_without_it() {
        let text = "(c: [\n    \"a.p <-> x.p\",\n    \"x.p <-> b.p <-> c.p\",\n    \"x.n <-> d.p\",\n])";
        let left = "(c: [\n    \"a.p <-> b.p <-> c.p\",\n    \"x.n <-> d.p\",\n])";
        assert_eq!(changed(text, |w| w.leave("x.p")), left);
        assert_eq!(changed(text, |w| w.leave("b.p")), text.replace(" <-> b.p", ""));
        assert_eq!(changed(text, |w| w.leave("d.p")), text.replace("    \"x.n <-> d.p\",\n", ""));
        assert_eq!(changed(text, |w| w.leave("e.p")), text);
    }

    #[test]
    fn one_end_stands_in_for_others_wherever_they_are_joined_to_something_else() {
        let text = "(c: [\n    \"a.p <-> x.p\",\n    \"x.p <-> y.p\", // both\n    \"y.p <-> b.p <-> x.p\",\n    \"x.y -> c.u\",\n])";
        let new = text.replace("a.p <-> x.p", "a.p <-> n.p").replace("y.p <-> b.p <-> x.p", "n.p <-> b.p");
        let others = ["x.p", "y.p"].map(str::to_owned);
        assert_eq!(changed(text, |w| assert_eq!(w.stand_in(&others, "n.p"), Some(0))), new);
        let all = |end: &str, w: &Wires| w.joined(end).join(" ");
        assert_eq!(changed(text, |w| assert_eq!(all("b.p", w), "b.p y.p x.p a.p")), text);
        assert_eq!(
            changed(&new, |w| assert_eq!(
                (all("b.p", w), all("x.p", w)),
                ("b.p n.p a.p".into(), "x.p y.p".into())
            )),
            new
        );
        assert_eq!(
            changed(text, |w| w.hang("a.p", "n.p")),
            text.replace("a.p <-> x.p", "a.p <-> x.p <-> n.p")
        );
    }

    #[test]
    fn new_connections_stand_where_they_belong_also_in_the_place_of_one_that_goes() {
        let add = |w: &mut Wires, at| w.add(at, Wire::Signal, &["n.y", "m.u", "o.u"]);
        assert_eq!(
            changed(TEXT, |w| add(w, Some(0))),
            TEXT.replace("// two\n", "// two\n    \"n.y -> m.u, o.u\",\n")
        );
        assert_eq!(
            changed(TEXT, |w| add(w, None)),
            TEXT.replace("d.u\",\n", "d.u\",\n    \"n.y -> m.u, o.u\",\n")
        );
        let new = changed(TEXT, |w| {
            w.take(2);
            add(w, Some(2));
            w.add(Some(2), Wire::Conserving, &["x.p", "y.p"]);
        });
        assert_eq!(new, TEXT.replace("\"b.y -> d.u\",", "\"n.y -> m.u, o.u\",\n    \"x.p <-> y.p\","));
        let all = changed(TEXT, |w| {
            (0..3).for_each(|at| drop(w.take(at)));
            add(w, Some(0));
        });
        assert_eq!(all, "(c: [\n    \"n.y -> m.u, o.u\", // two\n])");
    }

    #[test]
    fn what_is_written_otherwise_is_left_to_its_author() {
        for text in ["(c: [\"a.y -> b\\u{2e}u\"])", "(c: [r\"a.y -> b.u\"])", "(c: [1])", "(c: [\"a.y\"])"] {
            let root = read(text).unwrap();
            assert!(Wires::of(text, Some(&root.members().unwrap()[0].1)).is_err(), "{text}");
        }
        let spaced = "(c: [\"  a.y->b.u ,c.u  \"])";
        assert_eq!(changed(spaced, |_| ()), spaced);
        assert_eq!(changed(spaced, |w| w.append(0, "d.u")), "(c: [\"a.y->b.u ,c.u  , d.u\"])");
    }
}
