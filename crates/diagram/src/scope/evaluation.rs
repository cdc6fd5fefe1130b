//! What a written value means where a value of any type may stand.

use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Quantity, Value, closest, surely};

use super::{Scope, expression, missing_file, read_tree};
use crate::problems::{list, unknown_member};
use blocksim_syntax::{Name, Node, Shape};

/// Names that go with `value` in a number that says where it comes from.
const PROVENANCE: [&str; 4] = ["source", "note", "tolerance", "published"];

/// What stands in `Choice(...)`.
const CHOICE: [&str; 2] = ["default", "of"];

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
        self.scope.deeper(1, || self.place(node), || self.meaning(node))
    }

    fn meaning(&self, node: &Node) -> Result<Value, Problem> {
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
            Shape::Word(word) => Err(Problem::error("parameter", format!("`{word}` is not a value"))
                .at(&self.place(node), "")
                .help(format!("write \"{word}\" for a parameter of that name, Text(\"{word}\") for a text"))),
            Shape::Tuple(None, _) => Err(Problem::error("parameter", "a tuple is not a value")
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
                    format!("`{}` occurs twice in this set", name.text),
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
        match name.map(|name| name.text.as_str()) {
            Some("Choice") => self.choice(node, members),
            // A set may carry a name, as a move in a file of its own does.
            Some(name) if surely(name, ["Choice"]).is_some() => Err(self.no_value(node, name)),
            Some(_) => self.set(members),
            None => match described(members) {
                Some(value) => self.value(value),
                None => self.set(members),
            },
        }
    }

    fn no_value(&self, node: &Node, name: &str) -> Problem {
        Problem::error("parameter", format!("`{name}(...)` is not a value")).at(&self.place(node), "").help(
            match closest(name, ["File", "Text", "Choice"]) {
                Some(known) => format!("did you mean `{known}(...)`?"),
                None => "values are numbers, texts, lists, sets, File(\"...\") and Text(\"...\")".to_owned(),
            },
        )
    }

    fn choice(&self, node: &Node, members: &[(Name, Node)]) -> Result<Value, Problem> {
        if let Some((name, _)) = members.iter().find(|(name, _)| !CHOICE.contains(&name.text.as_str())) {
            let place = Place { file: self.file, span: name.span.clone() };
            return Err(unknown_member("`Choice`: ", &name.text, place, &CHOICE));
        }
        let text = |name: &str| members.iter().find(|(n, _)| n.text == name).map(|(_, node)| &node.value);
        let (Some(Shape::Text(default)), Some(Shape::List(_))) = (text("default"), text("of")) else {
            return Err(Problem::error("parameter", "a choice needs a default and its alternatives")
                .at(&self.place(node), "")
                .help("write Choice(default: \"dc\", of: [\"asm\", \"dc\"])"));
        };
        let of = choices(node);
        if !of.contains(default) {
            return Err(Problem::error("parameter", format!("`{default}` is not one of {}", list(&of)))
                .at(&self.place(node), "the default must be one of the alternatives"));
        }
        Ok(Value::Text(default.clone()))
    }

    fn called(&self, node: &Node, name: &str, items: &[Node]) -> Result<Value, Problem> {
        let [item] = items else {
            return Err(Problem::error("parameter", format!("`{name}(...)` is not a value"))
                .at(&self.place(node), ""));
        };
        let Shape::Text(text) = &item.value else {
            return Err(Problem::error("parameter", format!("`{name}(...)` holds {}", item.describe()))
                .at(&self.place(item), "expected a text"));
        };
        match name {
            "Text" => Ok(Value::Text(text.clone())),
            "File" => self.read(item, text),
            _ => Err(self.no_value(node, name)),
        }
    }

    fn read(&self, item: &Node, path: &str) -> Result<Value, Problem> {
        let sources = self.scope.sources;
        let full = sources.folder(self.file).join(path);
        let file =
            sources.open(&full).map_err(|reason| missing_file(sources, path, &reason, &self.place(item)))?;
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

/// The value of one that says where it comes from: `(value: "4000 W", source: "a data sheet")`.
pub(crate) fn described(members: &[(Name, Node)]) -> Option<&Node> {
    let fits = |name: &str| name == "value" || PROVENANCE.contains(&name);
    let (_, value) = members.iter().find(|(name, _)| name.text == "value")?;
    members.iter().all(|(name, _)| fits(&name.text)).then_some(value)
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
