//! The section `panel`: what changes and shows a model while it runs.

use std::ops::Range;

use blocksim_block::problem::Problem;
use blocksim_signal::closest;

use super::parse::{Section, unique};
use crate::problems::{list, mended};
use blocksim_syntax::{Name, Node, Shape};

/// Most elements of a panel: of each one the model is made anew to try how far it goes.
const MOST: usize = 100;

/// An element of a panel, as it is written: `Slider("pid.kp", "0 .. 50")`, or `Slider(target: "pid.kp", range: "0 .. 50")`.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelAst {
    /// What it is.
    pub kind: PanelWord,
    /// Its members; those without a name have got that of their position.
    pub members: Vec<(Name, Node)>,
    /// The whole element.
    pub span: Range<usize>,
}

/// Kinds of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PanelWord {
    /// Changes a number along a line.
    Slider,
    /// Changes a number in a circle.
    Knob,
    /// Changes between two values.
    Switch,
    /// Has another value as long as it is pressed.
    Button,
    /// Shows a signal on a scale.
    Gauge,
    /// Shows whether a signal is not zero.
    Lamp,
}

impl PanelWord {
    /// All kinds.
    pub const ALL: [PanelWord; 6] = [
        PanelWord::Slider,
        PanelWord::Knob,
        PanelWord::Switch,
        PanelWord::Button,
        PanelWord::Gauge,
        PanelWord::Lamp,
    ];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            PanelWord::Slider => "Slider",
            PanelWord::Knob => "Knob",
            PanelWord::Switch => "Switch",
            PanelWord::Button => "Button",
            PanelWord::Gauge => "Gauge",
            PanelWord::Lamp => "Lamp",
        }
    }

    /// Names of its members, in the order of their positions.
    pub fn members(self) -> &'static [&'static str] {
        match self {
            PanelWord::Slider | PanelWord::Knob => &["target", "range", "label"],
            PanelWord::Switch | PanelWord::Button => &["target", "off", "on", "label"],
            PanelWord::Gauge => &["signal", "range", "label"],
            PanelWord::Lamp => &["signal", "label"],
        }
    }

    /// What it does, with an example.
    pub fn what(self) -> &'static str {
        match self {
            PanelWord::Slider => "Changes a number while a run goes on: `Slider(\"pid.kp\", \"0 .. 50\")`.",
            PanelWord::Knob => "As a slider, to be turned: `Knob(\"demand.after\", \"-90 .. 90 deg\")`.",
            PanelWord::Switch => {
                "Changes between two values, false and true unless it has others: `Switch(\"load.value\", \"0 N*m\", \"5 N*m\")`."
            }
            PanelWord::Button => {
                "Has its second value as long as it is pressed: `Button(\"kick.value\", 0, 1)`."
            }
            PanelWord::Gauge => "Shows a signal on a scale: `Gauge(\"motor.w\", \"0 .. 3000 rpm\")`.",
            PanelWord::Lamp => "Is lit while a signal is not zero: `Lamp(\"stop.y\")`.",
        }
    }

    /// What it must have.
    fn needed(self) -> &'static [&'static str] {
        match self {
            PanelWord::Slider | PanelWord::Knob => &["target", "range"],
            PanelWord::Switch | PanelWord::Button => &["target"],
            PanelWord::Gauge | PanelWord::Lamp => &["signal"],
        }
    }
}

impl PanelAst {
    /// A member by its name.
    pub fn member(&self, name: &str) -> Option<&Node> {
        self.members.iter().find(|(known, _)| known.text == name).map(|(_, node)| node)
    }

    /// The text of a member, and where it stands.
    pub fn text(&self, name: &str) -> Option<(&str, &Range<usize>)> {
        let node = self.member(name)?;
        if let Shape::Text(text) = &node.value { Some((text, &node.span)) } else { None }
    }

    /// The parameter or the signal that it is about.
    pub fn about(&self) -> Option<(&str, &Range<usize>)> {
        self.text(self.kind.members()[0])
    }
}

impl Section<'_> {
    pub(super) fn panel(&mut self, node: &Node) -> Vec<PanelAst> {
        let Shape::List(items) = &node.value else {
            self.expected("a list such as `[Slider(\"pid.kp\", \"0 .. 50\")]`", node);
            return Vec::new();
        };
        if let Some(first) = items.get(MOST) {
            let place = self.place(&first.span);
            let told = format!("a panel has at most {MOST} elements, this one has {}", items.len());
            let problem = Problem::error("panel", told).at(&place, "one too many");
            self.problems
                .push(problem.help("show what is turned most often; all else can be set by `--change`"));
        }
        items.iter().take(MOST).filter_map(|item| self.element(item)).collect()
    }

    fn element(&mut self, node: &Node) -> Option<PanelAst> {
        let word = match &node.value {
            Shape::Tuple(Some(word), _) | Shape::Struct(Some(word), _) => word.clone(),
            Shape::Word(word) => Name { text: word.clone(), span: node.span.clone() },
            _ => {
                self.expected("an element such as `Slider(\"pid.kp\", \"0 .. 50\")`", node);
                return None;
            }
        };
        let Some(kind) = PanelWord::ALL.into_iter().find(|kind| kind.name() == word.text) else {
            self.no_element(&word);
            return None;
        };
        let members = match &node.value {
            Shape::Tuple(_, items) => self.by_position(kind, items, node),
            Shape::Struct(_, members) => {
                unique(self.file, members, "member", self.problems);
                members.iter().filter(|(name, _)| self.is_member(kind, name)).cloned().collect()
            }
            _ => Vec::new(),
        };
        let count = if let Shape::Struct(_, all) = &node.value { all.len() } else { members.len() };
        // What is missing may be the one that is misspelt, which has been reported.
        if count != members.len() {
            return None;
        }
        let element = PanelAst { kind, members, span: node.span.clone() };
        let missing = kind.needed().iter().find(|name| element.member(name).is_none());
        if let Some(missing) = missing {
            let place = self.place(&node.span);
            let name = kind.name();
            let problem = Problem::error("missing_parameter", format!("`{missing}` of a {name} is missing"));
            self.problems.push(problem.at(&place, "").help(kind.what()));
            return None;
        }
        let texts = [kind.members()[0], "range", "label"];
        let mut is_good = true;
        for name in texts {
            if let Some(node) = element.member(name)
                && !matches!(node.value, Shape::Text(_))
            {
                self.expected(if name == "range" { "a range such as `\"0 .. 50\"`" } else { "a text" }, node);
                is_good = false;
            }
        }
        is_good.then_some(element)
    }

    /// Members without names, by their positions.
    fn by_position(&mut self, kind: PanelWord, items: &[Node], whole: &Node) -> Vec<(Name, Node)> {
        let names = kind.members();
        // A label is a name for people, and is given by name alone.
        let count = names.len() - 1;
        if items.len() > count {
            let place = self.place(&whole.span);
            let told = format!("a {} has at most {count} members without a name", kind.name());
            let problem = Problem::error("syntax", told).at(&place, "has more");
            self.problems.push(problem.help(format!("write `{}({}: ..., ...)`", kind.name(), names[0])));
        }
        let named = names[..count].iter().zip(items);
        named
            .map(|(name, node)| (Name { text: (*name).to_owned(), span: node.span.clone() }, node.clone()))
            .collect()
    }

    fn is_member(&mut self, kind: PanelWord, name: &Name) -> bool {
        let known = kind.members();
        if known.contains(&name.text.as_str()) {
            return true;
        }
        let place = self.place(&name.span);
        let told = format!("a {} has no `{}`", kind.name(), name.text);
        let problem = Problem::error("unknown_parameter", told);
        let problem = mended(problem, place.clone(), &name.text, known.iter().copied());
        self.problems.push(problem.at(&place, "no such member").help(
            match closest(&name.text, known.iter().copied()) {
                Some(known) => format!("did you mean `{known}`?"),
                None => format!("its members are {}", list(known)),
            },
        ));
        false
    }

    fn no_element(&mut self, word: &Name) {
        let known = PanelWord::ALL.map(PanelWord::name);
        let place = self.place(&word.span);
        let problem = Problem::error("unknown_parameter", format!("a panel has no `{}`", word.text));
        let problem = mended(problem, place.clone(), &word.text, known);
        self.problems.push(problem.at(&place, "no such element").help(match closest(&word.text, known) {
            Some(known) => format!("did you mean `{known}`?"),
            None => format!("the elements are {}", list(&known)),
        }));
    }
}
