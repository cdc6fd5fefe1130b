//! Parameters: where a name is looked up, and what a written value means.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Lookup, Quantity, Scope as Names, Value, closest, evaluate};

use crate::ast::list;
use crate::source::Sources;
use crate::tree::{Name, Node, Shape};

/// Names that go with `value` in a number that says where it comes from.
const PROVENANCE: [&str; 4] = ["source", "note", "tolerance", "published"];

/// Parameters of one instance of a diagram.
///
/// A name is looked up in what the instance was given and the file's own defaults, then in the enclosing
/// diagrams. Values are computed when they are first needed, so they may refer to each other in any order.
pub(crate) struct Scope<'a> {
    pub sources: &'a Sources<'a>,
    pub parent: Option<Rc<Scope<'a>>>,
    entries: RefCell<Vec<Entry<'a>>>,
}

struct Entry<'a> {
    name: String,
    place: Place,
    state: State<'a>,
}

#[derive(Clone)]
enum State<'a> {
    /// Written in a file, to be evaluated in a scope: its own (`None`) or the one that gives it.
    Written {
        file: FileId,
        node: Rc<Node>,
        within: Option<Rc<Scope<'a>>>,
    },
    Busy,
    Ready(Result<Value, Problem>),
}

impl<'a> Scope<'a> {
    pub(crate) fn new(sources: &'a Sources<'a>, parent: Option<Rc<Scope<'a>>>) -> Self {
        Self { sources, parent, entries: RefCell::default() }
    }

    /// Adds a parameter that a file declares.
    pub(crate) fn declare(&self, name: &Name, file: FileId, node: &Node) {
        let state = State::Written { file, node: Rc::new(node.clone()), within: None };
        self.insert(&name.text, Place { file, span: name.span.clone() }, state);
    }

    /// Replaces the default by what an instance gives; it is evaluated in the scope of the giver.
    pub(crate) fn give(&self, name: &Name, file: FileId, node: &Node, within: &Rc<Scope<'a>>) {
        let state = State::Written { file, node: Rc::new(node.clone()), within: Some(within.clone()) };
        self.insert(&name.text, Place { file, span: name.span.clone() }, state);
    }

    /// Replaces a value by a known one.
    pub(crate) fn set(&self, name: &str, value: Value) {
        let mut entries = self.entries.borrow_mut();
        if let Some(entry) = entries.iter_mut().find(|entry| entry.name == name) {
            entry.state = State::Ready(Ok(value));
        }
    }

    fn insert(&self, name: &str, place: Place, state: State<'a>) {
        let mut entries = self.entries.borrow_mut();
        match entries.iter_mut().find(|entry| entry.name == name) {
            Some(entry) => (entry.place, entry.state) = (place, state),
            None => entries.push(Entry { name: name.to_owned(), place, state }),
        }
    }

    /// Names of this diagram's own parameters.
    pub(crate) fn own_names(&self) -> Vec<String> {
        self.entries.borrow().iter().map(|entry| entry.name.clone()).collect()
    }

    /// Whether this diagram itself has a parameter of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.entries.borrow().iter().any(|entry| entry.name == name)
    }

    /// Value of a parameter; `None` when no diagram has it.
    pub(crate) fn value(self: &Rc<Self>, name: &str) -> Option<Result<Value, Problem>> {
        let found = {
            let mut entries = self.entries.borrow_mut();
            entries.iter_mut().find(|entry| entry.name == name).map(|entry| {
                let state = std::mem::replace(&mut entry.state, State::Busy);
                (state, entry.place.clone())
            })
        };
        let Some((state, place)) = found else {
            return self.parent.as_ref().and_then(|parent| parent.value(name));
        };
        let value = match state {
            State::Ready(value) => value,
            State::Busy => Err(Problem::error("recursive_parameter", format!("`{name}` depends on itself"))
                .at(&place, "the value is needed to compute it")
                .help("give one of the parameters on the way a value of its own")),
            State::Written { file, node, within } => {
                let scope = within.as_ref().unwrap_or(self);
                let stack = Vec::new();
                Evaluation { scope, file, stack: &stack }.value(&node)
            }
        };
        let mut entries = self.entries.borrow_mut();
        if let Some(entry) = entries.iter_mut().find(|entry| entry.name == name) {
            entry.state = State::Ready(value.clone());
        }
        Some(value)
    }
}

/// The names that an expression sees, for `blocksim_signal::evaluate`; keeps the problem of a parameter that
/// could not be computed.
struct Visible<'s, 'a> {
    scope: &'s Rc<Scope<'a>>,
    failed: RefCell<Option<Problem>>,
}

impl Names for Visible<'_, '_> {
    fn lookup(&self, name: &str) -> Lookup {
        match self.scope.value(name) {
            None => Lookup::Unknown,
            Some(Ok(value)) => Lookup::Found(value),
            Some(Err(problem)) => {
                let reason = problem.message.clone();
                self.failed.borrow_mut().get_or_insert(problem);
                Lookup::Failed(reason)
            }
        }
    }

    fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        let mut scope = Some(self.scope);
        while let Some(current) = scope {
            names.extend(current.own_names());
            scope = current.parent.as_ref();
        }
        names
    }
}

/// Evaluates an expression; problems are placed in the text that begins at `start` of `file`.
pub(crate) fn expression(
    scope: &Rc<Scope>,
    text: &str,
    file: FileId,
    start: usize,
    whole: &std::ops::Range<usize>,
) -> Result<Value, Problem> {
    let visible = Visible { scope, failed: RefCell::default() };
    evaluate(text, &visible).map_err(|error| {
        if let Some(problem) = visible.failed.take() {
            return problem;
        }
        // Texts with escapes are longer in the file than in memory: then the whole text is shown.
        let inside = start + error.span.end <= whole.end;
        let span = if inside && !error.span.is_empty() {
            start + error.span.start..start + error.span.end
        } else {
            whole.clone()
        };
        let problem = Problem::error("expression", error.message).at(&Place { file, span }, "");
        match error.help {
            Some(help) => problem.help(help),
            None => problem,
        }
    })
}

/// What a written value means where a value of any type may stand.
pub(crate) struct Evaluation<'s, 'a> {
    pub scope: &'s Rc<Scope<'a>>,
    pub file: FileId,
    /// Parameter files that are being read, to find one that names itself.
    pub stack: &'s Vec<FileId>,
}

impl<'a> Evaluation<'_, 'a> {
    fn place(&self, node: &Node) -> Place {
        Place { file: self.file, span: node.span.clone() }
    }

    /// Value of a node.
    pub(crate) fn value(&self, node: &Node) -> Result<Value, Problem> {
        match &node.value {
            Shape::Number(value) => Ok(Value::Number(Quantity::plain(*value))),
            Shape::Bool(value) => Ok(Value::Bool(*value)),
            Shape::Text(text) => expression(self.scope, text, self.file, node.span.start + 1, &node.span),
            Shape::List(items) => {
                items.iter().map(|item| self.value(item)).collect::<Result<_, _>>().map(Value::List)
            }
            Shape::Map(members) => self.set(members),
            Shape::Struct(name, members) => self.structure(node, name.as_ref(), members),
            Shape::Tuple(Some(name), items) => self.called(node, &name.text, items),
            Shape::Word(word) if word == "Required" => Err(Problem::error(
                "missing_parameter",
                "this parameter must be given by whoever uses the diagram",
            )
            .at(&self.place(node), "has no default")
            .help("give it with `with: {...}` or `--set`")),
            Shape::Tuple(None, items) if items.is_empty() => Ok(Value::Set(Vec::new())),
            Shape::Word(word) => Err(Problem::error("parameter", format!("`{word}` is no value"))
                .at(&self.place(node), "")
                .help(format!("write \"{word}\" for a parameter of that name, Text(\"{word}\") for a text"))),
            Shape::Tuple(None, _) => Err(Problem::error("parameter", "a tuple is no value")
                .at(&self.place(node), "")
                .help("write a list `[...]` or a set `(name: value)`")),
        }
    }

    fn set(&self, members: &[(Name, Node)]) -> Result<Value, Problem> {
        let mut set: Vec<(String, Value)> = Vec::with_capacity(members.len());
        for (name, node) in members {
            if set.iter().any(|(known, _)| *known == name.text) {
                return Err(Problem::error(
                    "duplicate_name",
                    format!("`{}` stands twice in this set", name.text),
                )
                .at(&Place { file: self.file, span: name.span.clone() }, "the second")
                .help("rename or remove one of them"));
            }
            set.push((name.text.clone(), self.value(node)?));
        }
        Ok(Value::Set(set))
    }

    fn structure(
        &self,
        node: &Node,
        name: Option<&Name>,
        members: &[(Name, Node)],
    ) -> Result<Value, Problem> {
        if name.is_some_and(|name| name.text == "Choice") {
            return self.choice(node, members);
        }
        let described = members.iter().any(|(name, _)| name.text == "value")
            && members
                .iter()
                .all(|(name, _)| name.text == "value" || PROVENANCE.contains(&name.text.as_str()));
        match members.iter().find(|(name, _)| name.text == "value") {
            Some((_, value)) if described && name.is_none() => self.value(value),
            _ => self.set(members),
        }
    }

    fn choice(&self, node: &Node, members: &[(Name, Node)]) -> Result<Value, Problem> {
        let text = |name: &str| members.iter().find(|(n, _)| n.text == name).map(|(_, node)| &node.value);
        let (Some(Shape::Text(default)), Some(Shape::List(_))) = (text("default"), text("of")) else {
            return Err(Problem::error("parameter", "a choice needs a default and its alternatives")
                .at(&self.place(node), "")
                .help("write Choice(default: \"dc\", of: [\"asm\", \"dc\"])"));
        };
        let of = choices(node);
        if !of.contains(default) {
            return Err(Problem::error("parameter", format!("`{default}` is none of {}", list(&of)))
                .at(&self.place(node), "the default must be one of the alternatives"));
        }
        Ok(Value::Text(default.clone()))
    }

    fn called(&self, node: &Node, name: &str, items: &[Node]) -> Result<Value, Problem> {
        let [item] = items else {
            return Err(
                Problem::error("parameter", format!("`{name}(...)` is no value")).at(&self.place(node), "")
            );
        };
        let Shape::Text(text) = &item.value else {
            return Err(Problem::error("parameter", format!("`{name}(...)` holds {}", item.describe()))
                .at(&self.place(item), "expected a text"));
        };
        match name {
            "Text" => Ok(Value::Text(text.clone())),
            "File" => self.read(item, text),
            _ => Err(Problem::error("parameter", format!("`{name}(...)` is no value"))
                .at(&self.place(node), "")
                .help(match closest(name, ["File", "Text", "Choice"]) {
                    Some(known) => format!("did you mean `{known}(...)`?"),
                    None => {
                        "values are numbers, texts, lists, sets, File(\"...\") and Text(\"...\")".to_owned()
                    }
                })),
        }
    }

    fn read(&self, item: &Node, path: &str) -> Result<Value, Problem> {
        let sources = self.scope.sources;
        let full = sources.folder(self.file).join(path);
        let file = sources.open(&full).map_err(|reason| missing_file(path, &reason, &self.place(item)))?;
        if file == self.file || self.stack.contains(&file) {
            return Err(Problem::error("recursive_file", format!("`{path}` includes itself"))
                .at(&self.place(item), "is being read already"));
        }
        let root = read_tree(sources, file)?;
        let mut stack = self.stack.clone();
        stack.push(self.file);
        Evaluation { scope: self.scope, file, stack: &stack }.value(&root)
    }
}

/// The alternatives of `Choice(default: .., of: [..])`.
pub(crate) fn choices(node: &Node) -> Vec<String> {
    let Shape::Struct(Some(name), members) = &node.value else { return Vec::new() };
    if name.text != "Choice" {
        return Vec::new();
    }
    let of = members.iter().find(|(name, _)| name.text == "of").map(|(_, node)| &node.value);
    match of {
        Some(Shape::List(items)) => items
            .iter()
            .filter_map(|item| if let Shape::Text(text) = &item.value { Some(text.clone()) } else { None })
            .collect(),
        _ => Vec::new(),
    }
}

/// Reads a file as a tree.
pub(crate) fn read_tree(sources: &Sources, file: FileId) -> Result<Node, Problem> {
    crate::tree::read(&sources.file(file).text).map_err(|error| {
        let problem = Problem::error("syntax", error.message).at(&Place { file, span: error.span }, "");
        match error.help {
            Some(help) => problem.help(help),
            None => problem,
        }
    })
}

/// A file that cannot be read.
pub(crate) fn missing_file(path: impl AsRef<Path>, reason: &str, place: &Place) -> Problem {
    Problem::error("missing_file", format!("cannot read `{}`: {reason}", path.as_ref().display()))
        .at(place, "named here")
        .help("paths are relative to the file that names them")
}
