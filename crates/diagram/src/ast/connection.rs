//! Connections and names of ports: `a.y -> b.u`, `a.p <-> b.n`, `bus.y.speed`.

use blocksim_block::problem::Problem;

use super::parse::Section;
use super::{ConnectionAst, Reference};
use blocksim_syntax::{Node, Shape};

impl Section<'_> {
    pub(super) fn connections(&mut self, node: &Node) -> Vec<ConnectionAst> {
        let Shape::List(items) = &node.value else {
            self.expected("a list of connections", node);
            return Vec::new();
        };
        let mut connections = Vec::with_capacity(items.len());
        connections.extend(items.iter().filter_map(|item| self.connection(item)));
        connections
    }

    fn connection(&mut self, node: &Node) -> Option<ConnectionAst> {
        let Shape::Text(text) = &node.value else {
            self.expected("a connection such as `\"a.y -> b.u\"`", node);
            return None;
        };
        // Texts without escapes begin one quote after their place.
        let base = node.span.start + 1;
        let first = text.as_bytes().windows(2).position(|signs| signs == b"->");
        let (arrow, double) = match first {
            Some(at) if text[..at].ends_with('<') => (None, Some(at - 1)),
            Some(at) => (first, text[at..].find('<').and_then(|_| text.find("<->"))),
            None => (None, None),
        };
        let problem = |this: &mut Self, message: &str, help: &str| {
            let place = this.place(&node.span);
            this.problems.push(Problem::error("syntax", message).at(&place, "").help(help));
        };
        match (arrow, double) {
            (Some(at), None) => {
                let source = self.reference(&text[..at], base)?;
                let mut targets = Vec::new();
                let mut start = at + 2;
                for part in text[start..].split(',') {
                    targets.push(self.reference(part, base + start)?);
                    start += part.len() + 1;
                }
                Some(ConnectionAst::Signal(source, targets))
            }
            (None, Some(_)) => {
                let mut joined = Vec::new();
                let mut start = 0;
                for part in text.split("<->") {
                    joined.push(self.reference(part, base + start)?);
                    start += part.len() + 3;
                }
                Some(ConnectionAst::Conserving(joined))
            }
            (Some(_), Some(_)) => {
                problem(self, "`->` and `<->` do not mix in one connection", "write two connections");
                None
            }
            (None, None) => {
                problem(
                    self,
                    "a connection needs an arrow",
                    "`a.y -> b.u` connects signals, `a.p <-> b.n` joins conserving ports",
                );
                None
            }
        }
    }

    pub(super) fn reference(&mut self, text: &str, base: usize) -> Option<Reference> {
        let trimmed = text.trim();
        let start = base + text.len() - text.trim_start().len();
        let span = start..start + trimmed.len();
        let mut parts = trimmed.split('.');
        let fits =
            |part: &&str| !part.is_empty() && part.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_');
        match (parts.next().filter(fits), parts.next().filter(fits)) {
            (Some(block), Some(port)) if parts.clone().all(|part| fits(&part)) => {
                let elements = parts.map(str::to_owned).collect();
                return Some(Reference { block: block.to_owned(), port: port.to_owned(), elements, span });
            }
            (Some(block), None) if !trimmed.contains('.') => {
                let place = self.place(&span);
                self.problems.push(
                    Problem::error("syntax", format!("`{block}` names a block but no port"))
                        .at(&place, "which port?")
                        .help("write `block.port`; most outputs are called `y`, most inputs `u`"),
                );
                return None;
            }
            _ => {}
        }
        let place = self.place(&span);
        self.problems.push(
            Problem::error("syntax", format!("`{trimmed}` is not a port"))
                .at(&place, "")
                .help("write `block.port`, or `block.port.element` for an element of a bus"),
        );
        None
    }
}
