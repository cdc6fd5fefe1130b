//! The section `record`: patterns of signals, some with a rate.

use blocksim_block::problem::Problem;
use blocksim_signal::closest;

use super::parse::{Section, unique};
use super::{RATES, RecordAst};
use crate::problems::{list, mended};
use blocksim_syntax::{Name, Node, Shape};

/// What an entry may look like.
const FORM: &str = "a pattern such as `\"arm/**\"`, or `(signals: \"arm/**\", every: \"10 ms\")`";

impl Section<'_> {
    pub(super) fn record(&mut self, node: &Node) -> Vec<RecordAst> {
        let Shape::List(items) = &node.value else {
            self.expected("a list of patterns", node);
            return Vec::new();
        };
        items.iter().filter_map(|item| self.entry(item)).collect()
    }

    fn entry(&mut self, node: &Node) -> Option<RecordAst> {
        match &node.value {
            Shape::Text(_) => Some(RecordAst { signals: self.patterns(node), rate: None }),
            Shape::Struct(None, members) => {
                unique(self.file, members, "word", self.problems);
                let mut entry = RecordAst { signals: Vec::new(), rate: None };
                for (name, value) in members {
                    match name.text.as_str() {
                        "signals" => entry.signals = self.patterns(value),
                        word if RATES.contains(&word) => match &entry.rate {
                            None => entry.rate = Some((name.clone(), value.clone())),
                            Some((first, _)) if first.text != name.text => self.two_rates(first, name),
                            Some(_) => {}
                        },
                        _ => self.unknown(name),
                    }
                }
                if !members.iter().any(|(name, _)| name.text == "signals") {
                    let place = self.place(&node.span);
                    let problem =
                        Problem::error("missing_parameter", "an entry of `record` names no signals");
                    self.problems
                        .push(problem.at(&place, "`signals` is missing").help(format!("write {FORM}")));
                }
                Some(entry)
            }
            _ => {
                self.expected(FORM, node);
                None
            }
        }
    }

    fn patterns(&mut self, node: &Node) -> Vec<Name> {
        let items = match &node.value {
            Shape::List(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        items
            .iter()
            .filter_map(|item| self.text(item).map(|text| Name { text, span: item.span.clone() }))
            .collect()
    }

    fn two_rates(&mut self, first: &Name, second: &Name) {
        let (at, other) = (self.place(&second.span), self.place(&first.span));
        self.problems.push(
            Problem::error(
                "record_rate",
                format!("`{}` and `{}` contradict each other", first.text, second.text),
            )
            .at(&at, "the second")
            .at(&other, "the first")
            .help("keep one of them"),
        );
    }

    fn unknown(&mut self, name: &Name) {
        let words = || ["signals"].into_iter().chain(RATES);
        let place = self.place(&name.span);
        let problem = Problem::error("unknown_parameter", format!("`record` knows no `{}`", name.text));
        let problem = mended(problem, place.clone(), &name.text, words());
        self.problems.push(problem.at(&place, "no such word").help(match closest(&name.text, words()) {
            Some(known) => format!("did you mean `{known}`?"),
            None => format!("the words are {}", list(&words().collect::<Vec<_>>())),
        }));
    }
}
