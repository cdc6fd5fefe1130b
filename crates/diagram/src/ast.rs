//! A diagram as it is written: names, raw parameters, places. No block is known yet.

use std::collections::HashMap;
use std::ops::Range;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::closest;

use crate::problems::Problems;
use crate::tree::{Name, Node, Shape};

/// A file that holds a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Ast {
    /// The file.
    pub file: FileId,
    /// Title, if it has one.
    pub title: Option<String>,
    /// Parameters with their defaults.
    pub parameters: Vec<(Name, Node)>,
    /// `simulation: (...)`.
    pub simulation: Option<Node>,
    /// Signal inputs when used as a subsystem.
    pub inputs: Vec<(Name, Node)>,
    /// Signal outputs when used as a subsystem.
    pub outputs: Vec<(Name, Reference)>,
    /// Conserving ports when used as a subsystem.
    pub ports: Vec<(Name, Reference)>,
    /// Blocks in the order of the file.
    pub blocks: Vec<BlockAst>,
    /// Connections in the order of the file.
    pub connections: Vec<ConnectionAst>,
    /// Patterns of signals to record.
    pub record: Vec<Name>,
    /// The word `Diagram`, for problems of the whole.
    pub span: Range<usize>,
}

/// A block as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockAst {
    /// Name.
    pub name: Name,
    /// Kind.
    pub kind: Name,
    /// Text for drawings.
    pub label: Option<String>,
    /// Parameters.
    pub parameters: Vec<(Name, Node)>,
    /// The whole value.
    pub span: Range<usize>,
}

/// A port of a block, or an element of a bus behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Block, or `in` for the inputs of the diagram.
    pub block: String,
    /// Port.
    pub port: String,
    /// Path within the bus.
    pub elements: Vec<String>,
    /// Place of the text.
    pub span: Range<usize>,
}

/// A connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConnectionAst {
    /// One output to inputs.
    Signal(Reference, Vec<Reference>),
    /// Conserving ports joined.
    Conserving(Vec<Reference>),
}

impl Ast {
    /// A place in this file.
    pub fn place(&self, span: &Range<usize>) -> Place {
        Place { file: self.file, span: span.clone() }
    }
}

const SECTIONS: [&str; 9] =
    ["title", "parameters", "simulation", "inputs", "outputs", "ports", "blocks", "connections", "record"];

/// Reads the sections of a diagram.
pub(crate) fn parse(file: FileId, root: &Node, problems: &mut Problems) -> Option<Ast> {
    let place = |span: &Range<usize>| Place { file, span: span.clone() };
    let members = match &root.value {
        Shape::Struct(name, members) if name.as_ref().is_none_or(|name| name.text == "Diagram") => members,
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
        span: word,
    };
    unique(file, members, "section", problems);
    for (name, node) in members {
        let mut reader = Section { file, problems };
        match name.text.as_str() {
            "title" => ast.title = reader.text(node),
            "parameters" => ast.parameters = reader.named(node, "parameter"),
            "simulation" => ast.simulation = Some(node.clone()),
            "inputs" => ast.inputs = reader.named(node, "input"),
            "outputs" => ast.outputs = reader.references(node, "output"),
            "ports" => ast.ports = reader.references(node, "port"),
            "blocks" => ast.blocks = reader.blocks(node),
            "connections" => ast.connections = reader.connections(node),
            "record" => ast.record = reader.texts(node),
            other => {
                let mut problem =
                    Problem::error("unknown_parameter", format!("a diagram has no section `{other}`"))
                        .at(&place(&name.span), "no such section");
                problem = problem.help(match closest(other, SECTIONS) {
                    Some(known) => format!("did you mean `{known}`?"),
                    None => format!("the sections are {}", list(&SECTIONS)),
                });
                problems.push(problem);
            }
        }
    }
    Some(ast)
}

/// Words in a row for people: `a`, `b` and `c`.
pub(crate) fn list<S: AsRef<str>>(words: &[S]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{}`", word.as_ref())).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} and {last}", head.join(", ")),
    }
}

/// Reports names that stand twice.
pub(crate) fn unique(file: FileId, members: &[(Name, Node)], what: &str, problems: &mut Problems) {
    let mut first: HashMap<&str, &Name> = HashMap::new();
    for (name, _) in members {
        if let Some(other) = first.insert(&name.text, name) {
            let place = |span: &Range<usize>| Place { file, span: span.clone() };
            problems.push(
                Problem::error("duplicate_name", format!("the {what} `{}` stands twice", name.text))
                    .at(&place(&name.span), "the second")
                    .at(&place(&other.span), "the first")
                    .help("rename or remove one of them"),
            );
        }
    }
}

struct Section<'a> {
    file: FileId,
    problems: &'a mut Problems,
}

impl Section<'_> {
    fn place(&self, span: &Range<usize>) -> Place {
        Place { file: self.file, span: span.clone() }
    }

    fn expected(&mut self, what: &str, node: &Node) {
        let place = self.place(&node.span);
        self.problems.push(
            Problem::error("syntax", format!("expected {what}, found {}", node.describe()))
                .at(&place, format!("should be {what}")),
        );
    }

    fn text(&mut self, node: &Node) -> Option<String> {
        if let Shape::Text(text) = &node.value {
            return Some(text.clone());
        }
        self.expected("a text", node);
        None
    }

    fn texts(&mut self, node: &Node) -> Vec<Name> {
        let Shape::List(items) = &node.value else {
            self.expected("a list of texts", node);
            return Vec::new();
        };
        items
            .iter()
            .filter_map(|item| self.text(item).map(|text| Name { text, span: item.span.clone() }))
            .collect()
    }

    fn named(&mut self, node: &Node, what: &str) -> Vec<(Name, Node)> {
        let Some(members) = node.members() else {
            self.expected("names with values, as in `{\"a\": 1}`", node);
            return Vec::new();
        };
        unique(self.file, members, what, self.problems);
        for (name, _) in members {
            self.check_name(name, what);
        }
        members.to_vec()
    }

    fn check_name(&mut self, name: &Name, what: &str) {
        let fits = name.text.chars().next().is_some_and(|c| c.is_ascii_alphabetic())
            && name.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !fits || name.text == "in" {
            let place = self.place(&name.span);
            self.problems.push(
                Problem::error("bad_name", format!("`{}` cannot name a {what}", name.text))
                    .at(&place, "not a name")
                    .help("names start with a letter, then letters, digits and `_`; `in` is reserved"),
            );
        }
    }

    fn references(&mut self, node: &Node, what: &str) -> Vec<(Name, Reference)> {
        let members = self.named(node, what);
        members
            .into_iter()
            .filter_map(|(name, node)| {
                let Shape::Text(text) = &node.value else {
                    self.expected("a text such as `\"block.port\"`", &node);
                    return None;
                };
                self.reference(text, node.span.start + 1).map(|reference| (name, reference))
            })
            .collect()
    }

    fn blocks(&mut self, node: &Node) -> Vec<BlockAst> {
        let members = self.named(node, "block");
        members
            .into_iter()
            .filter_map(|(name, node)| {
                let (kind, parameters) = match node.value {
                    Shape::Word(ref word) => {
                        (Name { text: word.clone(), span: node.span.clone() }, Vec::new())
                    }
                    Shape::Struct(Some(ref kind), ref members) => (kind.clone(), members.clone()),
                    Shape::Tuple(Some(ref kind), ref items) if items.is_empty() => (kind.clone(), Vec::new()),
                    Shape::Tuple(Some(ref kind), _) => {
                        let place = self.place(&node.span);
                        self.problems.push(
                            Problem::error(
                                "syntax",
                                format!("the parameters of `{}` have no names", name.text),
                            )
                            .at(&place, "values without names")
                            .help(format!("write `{}(name: value, ...)`", kind.text)),
                        );
                        return None;
                    }
                    _ => {
                        self.expected("a block such as `Gain(k: 2)`", &node);
                        return None;
                    }
                };
                unique(self.file, &parameters, "parameter", self.problems);
                let mut label = None;
                let mut kept = Vec::new();
                for (name, value) in parameters {
                    match &value.value {
                        Shape::Text(text) if name.text == "label" => label = Some(text.clone()),
                        _ => kept.push((name, value)),
                    }
                }
                Some(BlockAst { name, kind, label, parameters: kept, span: node.span.clone() })
            })
            .collect()
    }

    fn connections(&mut self, node: &Node) -> Vec<ConnectionAst> {
        let Shape::List(items) = &node.value else {
            self.expected("a list of connections", node);
            return Vec::new();
        };
        items.iter().filter_map(|item| self.connection(item)).collect()
    }

    fn connection(&mut self, node: &Node) -> Option<ConnectionAst> {
        let Shape::Text(text) = &node.value else {
            self.expected("a connection such as `\"a.y -> b.u\"`", node);
            return None;
        };
        // Texts without escapes begin one quote after their place.
        let base = node.span.start + 1;
        let (arrow, double) = (text.find("->").filter(|at| !text[..*at].ends_with('<')), text.find("<->"));
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

    fn reference(&mut self, text: &str, base: usize) -> Option<Reference> {
        let trimmed = text.trim();
        let start = base + text.len() - text.trim_start().len();
        let span = start..start + trimmed.len();
        let mut parts = trimmed.split('.').map(str::to_owned);
        let fits =
            |part: &String| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        match (parts.next().filter(fits), parts.next().filter(fits)) {
            (Some(block), Some(port)) => {
                let elements: Vec<String> = parts.collect();
                if elements.iter().all(fits) {
                    return Some(Reference { block, port, elements, span });
                }
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
            Problem::error("syntax", format!("`{trimmed}` is no port"))
                .at(&place, "")
                .help("write `block.port`, or `block.port.element` for an element of a bus"),
        );
        None
    }
}
