//! The sections of a diagram are read; what does not fit is reported and left out.

use std::ops::Range;

use blocksim_block::kinds;
use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::closest;
use foldhash::{HashMap, HashMapExt};

use super::{Ast, BlockAst, Reference, Unread};
use crate::problems::{Problems, a, list, mended};
use blocksim_syntax::{Name, Node, Shape};

const SECTIONS: [&str; 10] = [
    "title",
    "parameters",
    "simulation",
    "inputs",
    "outputs",
    "ports",
    "blocks",
    "connections",
    "record",
    "panel",
];

/// Reads the sections of a diagram.
pub(crate) fn parse(file: FileId, root: &Node, problems: &mut Problems) -> Option<Ast> {
    let place = |span: &Range<usize>| Place { file, span: span.clone() };
    let members = match &root.value {
        Shape::Struct(name, members) if name.as_ref().is_none_or(|name| name.text == "Diagram") => {
            // A set that somebody took for a diagram: one message says more than one for each member.
            let is_section = |name: &Name| {
                SECTIONS.contains(&name.text.as_str()) || closest(&name.text, SECTIONS).is_some()
            };
            if name.is_none() && !members.is_empty() && !members.iter().any(|(name, _)| is_section(name)) {
                problems.push(
                    Problem::error("syntax", "this is a set of parameters, no diagram")
                        .at(&place(&(root.span.start..root.span.start + 1)), "the file starts here")
                        .help("a diagram uses it by `File(\"...\")`; a diagram file holds one `Diagram(blocks: {...}, ...)`"),
                );
                return None;
            }
            members
        }
        Shape::Tuple(Some(name), items) if name.text == "Diagram" && items.is_empty() => {
            problems.push(
                Problem::error("syntax", "the diagram is empty")
                    .at(&place(&root.span), "nothing is in it")
                    .help("write blocks and connections, `Diagram(blocks: {...}, connections: [...])`"),
            );
            return None;
        }
        _ => {
            problems.push(
                Problem::error("syntax", format!("expected `Diagram(...)`, found {}", root.describe()))
                    .at(&place(&(root.span.start..root.span.start + 1)), "the file starts here")
                    .help("a diagram file holds one `Diagram(blocks: {...}, connections: [...])`"),
            );
            return None;
        }
    };
    let word = match &root.value {
        Shape::Struct(Some(name), _) => name.span.clone(),
        _ => root.span.start..root.span.start + 1,
    };
    let mut ast = Ast {
        file,
        title: None,
        parameters: Vec::new(),
        simulation: None,
        inputs: Vec::new(),
        outputs: Vec::new(),
        ports: Vec::new(),
        blocks: Vec::new(),
        connections: Vec::new(),
        record: Vec::new(),
        panel: Vec::new(),
        unread: Unread::default(),
        span: word,
    };
    unique(file, members, "section", problems);
    for (name, node) in members {
        let mut reader = Section { file, problems };
        match name.text.as_str() {
            "title" => ast.title = reader.text(node),
            "parameters" => ast.parameters = reader.named(node, "parameter").to_vec(),
            "simulation" => ast.simulation = Some(node.clone()),
            "inputs" => ast.inputs = reader.named(node, "input").to_vec(),
            "outputs" => ast.outputs = reader.references(node, "output"),
            "ports" => ast.ports = reader.references(node, "port"),
            "blocks" => ast.blocks = reader.blocks(node),
            "connections" => ast.connections = reader.connections(node),
            "record" => ast.record = reader.record(node),
            "panel" => ast.panel = reader.panel(node),
            other => {
                let mut problem =
                    Problem::error("unknown_parameter", format!("a diagram has no section `{other}`"))
                        .at(&place(&name.span), "no such section");
                problem = mended(problem, place(&name.span), other, SECTIONS);
                problem = problem.help(match closest(other, SECTIONS) {
                    Some(known) => {
                        ast.unread.mark(known);
                        format!("did you mean `{known}`?")
                    }
                    None => {
                        let is_there = |section: &str| members.iter().any(|(name, _)| name.text == section);
                        let absent = SECTIONS.into_iter().filter(|section| !is_there(section));
                        absent.for_each(|section| ast.unread.mark(section));
                        format!("the sections are {}", list(&SECTIONS))
                    }
                });
                problems.push(problem);
            }
        }
        let read = match name.text.as_str() {
            "parameters" => ast.parameters.len(),
            "inputs" => ast.inputs.len(),
            "outputs" => ast.outputs.len(),
            "ports" => ast.ports.len(),
            "blocks" => ast.blocks.len(),
            "connections" => ast.connections.len(),
            _ => continue,
        };
        if entries(node).is_none_or(|entries| read < entries) {
            ast.unread.mark(&name.text);
        }
    }
    if ast.unread.parameters {
        problems.parameters_are_unread();
    }
    for (output, _) in &ast.outputs {
        if let Some((input, _)) = ast.inputs.iter().find(|(input, _)| input.text == output.text) {
            // A connection names a port without saying which of both is meant.
            problems.push(
                Problem::error(
                    "duplicate_name",
                    format!("an input and an output are called `{}`", output.text),
                )
                .at(&place(&output.span), "the output")
                .at(&place(&input.span), "the input")
                .help("rename one of them"),
            );
        }
    }
    Some(ast)
}

/// How many entries a section has; `None` where it is neither a set nor a list.
fn entries(node: &Node) -> Option<usize> {
    match &node.value {
        Shape::List(items) => Some(items.len()),
        _ => node.members().map(<[_]>::len),
    }
}

/// Most members of a small set.
const SMALL: usize = 8;

/// Reports names that stand twice.
pub(super) fn unique(file: FileId, members: &[(Name, Node)], what: &str, problems: &mut Problems) {
    // Most sets are so small that to look through them is quicker than a map.
    let is_small = members.len() <= SMALL;
    let mut first: HashMap<&str, &Name> = HashMap::new();
    for (at, (name, _)) in members.iter().enumerate() {
        let other = match is_small {
            true => members[..at].iter().map(|(other, _)| other).rfind(|other| other.text == name.text),
            false => first.insert(&name.text, name),
        };
        if let Some(other) = other {
            let place = |span: &Range<usize>| Place { file, span: span.clone() };
            problems.push(
                Problem::error("duplicate_name", format!("the {what} `{}` is defined twice", name.text))
                    .at(&place(&name.span), "the second")
                    .at(&place(&other.span), "the first")
                    .help("rename or remove one of them"),
            );
        }
    }
}

pub(super) struct Section<'a> {
    pub(super) file: FileId,
    pub(super) problems: &'a mut Problems,
}

impl Section<'_> {
    pub(super) fn place(&self, span: &Range<usize>) -> Place {
        Place { file: self.file, span: span.clone() }
    }

    pub(super) fn expected(&mut self, what: &str, node: &Node) {
        let place = self.place(&node.span);
        self.problems.push(
            Problem::error("syntax", format!("expected {what}, found {}", node.describe()))
                .at(&place, format!("should be {what}")),
        );
    }

    pub(super) fn text(&mut self, node: &Node) -> Option<String> {
        if let Shape::Text(text) = &node.value {
            return Some(text.clone());
        }
        self.expected("a text", node);
        None
    }

    fn named<'n>(&mut self, node: &'n Node, what: &str) -> &'n [(Name, Node)] {
        let Some(members) = node.members() else {
            self.expected("names with values, as in `{\"a\": 1}`", node);
            return &[];
        };
        unique(self.file, members, what, self.problems);
        for (name, _) in members {
            self.check_name(name, what);
        }
        members
    }

    fn check_name(&mut self, name: &Name, what: &str) {
        let fits = name.text.chars().next().is_some_and(|c| c.is_ascii_alphabetic())
            && name.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !fits || name.text == "in" {
            let place = self.place(&name.span);
            self.problems.push(
                Problem::error("bad_name", format!("`{}` cannot name {}", name.text, a(what)))
                    .at(&place, "not a name")
                    .help("names start with a letter, then letters, digits and `_`; `in` is reserved"),
            );
        }
    }

    fn references(&mut self, node: &Node, what: &str) -> Vec<(Name, Reference)> {
        let members = self.named(node, what);
        members
            .iter()
            .filter_map(|(name, node)| {
                let Shape::Text(text) = &node.value else {
                    self.expected("a text such as `\"block.port\"`", node);
                    return None;
                };
                self.reference(text, node.span.start + 1).map(|reference| (name.clone(), reference))
            })
            .collect()
    }

    /// Values stand where parameters with names should. One value is meant for the one parameter that a kind requires.
    fn nameless(&self, block: &Name, kind: &Name, items: &[Node], node: &Node) -> Problem {
        let problem = Problem::error("syntax", format!("the parameters of `{}` have no names", block.text))
            .at(&self.place(&node.span), "values without names");
        let kinds = kinds();
        let info = kinds.iter().find(|info| info.kind == kind.text);
        let mut parameters = info.map_or(&[][..], |info| info.parameters).iter();
        let required: Vec<&str> = parameters
            .by_ref()
            .filter(|parameter| parameter.default.is_none())
            .map(|parameter| parameter.name)
            .collect();
        match (required.as_slice(), items) {
            ([meant], [value]) => problem
                .edit(self.place(&(value.span.start..value.span.start)), "", format!("{meant}: "))
                .help(format!("write `{}({meant}: ...)`", kind.text)),
            ([first, ..], _) => problem.help(format!("write `{}({first}: value, ...)`", kind.text)),
            _ => problem.help(format!("write `{}(name: value, ...)`", kind.text)),
        }
    }

    fn blocks(&mut self, node: &Node) -> Vec<BlockAst> {
        let members = self.named(node, "block");
        let mut blocks = Vec::with_capacity(members.len());
        blocks.extend(members.iter().filter_map(|(name, node)| {
            let (kind, parameters) = match &node.value {
                Shape::Word(word) => (Name { text: word.clone(), span: node.span.clone() }, &[][..]),
                Shape::Struct(Some(kind), members) => (kind.clone(), &members[..]),
                Shape::Tuple(Some(kind), items) if items.is_empty() => (kind.clone(), &[][..]),
                Shape::Tuple(Some(kind), items) => {
                    let problem = self.nameless(name, kind, items, node);
                    self.problems.push(problem);
                    return None;
                }
                _ => {
                    self.expected("a block such as `Gain(k: 2)`", node);
                    return None;
                }
            };
            unique(self.file, parameters, "parameter", self.problems);
            let mut label = None;
            let mut kept = Vec::with_capacity(parameters.len());
            for (name, value) in parameters {
                match &value.value {
                    Shape::Text(text) if name.text == "label" => label = Some(text.clone()),
                    _ => kept.push((name.clone(), value.clone())),
                }
            }
            Some(BlockAst { name: name.clone(), kind, label, parameters: kept, span: node.span.clone() })
        }));
        blocks
    }
}
