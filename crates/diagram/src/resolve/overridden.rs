//! What the command line replaces: parameters of diagrams and of blocks.

use std::ops::Range;
use std::rc::Rc;

use blocksim_block::BlockInfo;
use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Value, closest};

use super::Resolver;
use crate::ast::{Ast, BlockAst};
use crate::model::{Content, Model};
use crate::overrides::{Override, Used, before_block, replace};
use crate::problems::list;
use crate::replacing::{Place as Where, Replacing};
use crate::scope::{Evaluation, Scope, choices};
use blocksim_syntax::{Name, Node, Shape};

impl<'a> Resolver<'a> {
    /// Parameters with those replaced that the command line names.
    pub(super) fn block_overrides(
        &self,
        block: &BlockAst,
        info: &BlockInfo,
        at: (FileId, &Rc<Scope<'a>>),
        path: &str,
    ) -> Vec<(Name, Node)> {
        let (file, scope) = at;
        let mut parameters = block.parameters.clone();
        let old = |name: &str| {
            let (_, node) = block.parameters.iter().find(|(known, _)| known.text == name)?;
            Some(Where { scope: scope.clone(), file, node: Rc::new(node.clone()) })
        };
        for (over, names) in self.overrides_of(path) {
            // A parameter of the diagram that has the member comes before a block of the same name.
            if over.path.is_empty() && over.of_parameter.get() {
                continue;
            }
            let Some((first, rest)) = names.split_first() else { continue };
            let Some(parameter) = info.parameters.iter().find(|parameter| parameter.name == *first) else {
                // The parameters of a plug-in stand in a set of their own.
                let inner = parameters.iter_mut().find(|(name, _)| name.text == "parameters");
                if let (Some((_, node)), []) = (inner, rest)
                    && let Shape::Map(members) | Shape::Struct(None, members) = &mut node.value
                {
                    self.uses(over);
                    let old = members.iter().find(|(name, _)| name.text == *first).map(|(_, node)| node);
                    let old =
                        old.map(|node| Where { scope: scope.clone(), file, node: Rc::new(node.clone()) });
                    let replacing = Replacing { target: over.target(), scope, file, unit: "" };
                    let new = self.meant(over, &replacing, value_node(over, true), old.as_ref());
                    put(members, first, new, &node.span);
                }
                continue;
            };
            if rest.is_empty() {
                self.uses(over);
                let text = !parameter.unit.is_empty()
                    || ["f64", "String", "usize", "u32", "ParamValue", "Entries"]
                        .iter()
                        .any(|t| parameter.rust_type.contains(t));
                let new = value_node(over, text);
                let new = match parameter.rust_type.contains("String") {
                    true => new,
                    false => {
                        let unit = parameter.unit;
                        let replacing = Replacing { target: over.target(), scope, file, unit };
                        self.meant(over, &replacing, new, old(first).as_ref())
                    }
                };
                put(&mut parameters, first, new, &block.span);
            }
        }
        parameters
    }

    /// Something has the name of an override, here or in an alternative that is not built.
    fn uses(&self, over: &Override) {
        let used = match &*self.apart.borrow() {
            Some(_) if *over.used.borrow() == Used::Here => return,
            Some(alternative) => Used::Apart(alternative.clone()),
            None => Used::Here,
        };
        over.used.replace(used);
    }

    /// What a new value means; a problem is reported.
    fn meant(
        &self,
        over: &Override,
        replacing: &Replacing<'_, 'a>,
        new: Node,
        old: Option<&Where<'a>>,
    ) -> Node {
        match replacing.meaning(&new, old) {
            Ok(meant) => {
                over.meant.replace(meant.text);
                over.worth.replace(worth(replacing, &meant.node));
                meant.node
            }
            Err(problem) => {
                self.report(problem.at(&over.place(), ""));
                new
            }
        }
    }

    /// What the command line sets in the block at a path, with the names below it.
    fn overrides_of<'s>(&'s self, path: &'s str) -> impl Iterator<Item = (&'s Override, &'s [String])> {
        self.overrides.iter().filter_map(move |over| {
            // At the top a block and a parameter look alike: `pid.kp`.
            let top = over.path.is_empty() && over.names.len() > 1 && over.names[0] == path;
            match over.path == path {
                true if !over.path.is_empty() => Some((over, over.names.as_slice())),
                _ if top => Some((over, &over.names[1..])),
                _ => None,
            }
        })
    }

    /// Where a parameter of a block is replaced on the command line.
    pub(super) fn override_of(&self, path: &str, name: &str) -> Option<Place> {
        let replaced =
            self.overrides_of(path).filter(|(_, names)| names.first().is_some_and(|first| first == name));
        replaced.map(|(over, _)| over.place()).last()
    }

    /// A value from the command line has no place in the file.
    pub(super) fn about_override(&self, problem: Problem, path: &str) -> Problem {
        match self.overrides_of(path).next() {
            Some((over, _)) => problem.note(format!("with `--set {}`", over.text)),
            None => problem,
        }
    }

    /// Parameters of a diagram that the command line replaces.
    pub(super) fn override_parameters(&self, ast: &Ast, scope: &Rc<Scope<'a>>, path: &str) {
        for (index, over) in self.overrides.iter().enumerate() {
            // At the top a subsystem and a parameter look alike: `arm.gain`.
            let is_here = over.path == path;
            let is_alike = !is_here && over.path.is_empty() && over.names.len() > 1 && over.names[0] == path;
            let names = if is_alike { &over.names[1..] } else { &over.names[..] };
            if !(is_here || is_alike && !over.of_parameter.get()) || !scope.has(&names[0]) {
                continue;
            }
            let is_block = ast.blocks.iter().any(|block| block.name.text == names[0]);
            let is_meant = |value: Value| before_block(&value, names.get(1));
            if is_block && !scope.value(&names[0]).and_then(Result::ok).is_some_and(is_meant) {
                continue;
            }
            self.uses(over);
            over.of_parameter.set(path.is_empty());
            let declared =
                ast.parameters.iter().find(|(name, _)| name.text == names[0]).map(|(_, node)| node);
            match self.overridden(over, names, declared, scope) {
                Ok((value, node)) => {
                    scope.set(names, value, over.file, &node);
                    let path = names.join(".").replace(".[", "[");
                    self.replaced.borrow_mut().push((index, scope.clone(), path));
                }
                Err(problem) => self.report(problem),
            }
        }
    }

    fn overridden(
        &self,
        over: &Override,
        names: &[String],
        declared: Option<&Node>,
        scope: &Rc<Scope<'a>>,
    ) -> Result<(Value, Node), Problem> {
        let alternatives = declared.map(choices).unwrap_or_default();
        let fail = |message: String| Problem::error("unknown_override", message).at(&over.place(), "");
        if names.len() == 1 && !alternatives.is_empty() {
            let (Shape::Word(word) | Shape::Text(word)) = &over.node.value else {
                return Err(fail(format!("`{}` is one of {}", names[0], list(&alternatives))));
            };
            if alternatives.contains(word) {
                return Ok((Value::Text(word.clone()), over.node.clone()));
            }
            let problem = fail(format!("`{}` has no alternative `{word}`", names[0]));
            return Err(match closest(word, alternatives.iter().map(String::as_str)) {
                Some(close) => problem
                    .help(format!("did you mean `{close}`? The alternatives are {}", list(&alternatives))),
                None => problem.help(format!("the alternatives are {}", list(&alternatives))),
            });
        }
        let required =
            matches!(declared.map(|node| &node.value), Some(Shape::Word(word)) if word == "Required");
        let mut value = match scope.value(&names[0]) {
            Some(Ok(value)) => value,
            Some(Err(_)) if required && names.len() == 1 => Value::Bool(false),
            Some(Err(problem)) => return Err(problem),
            None => return Err(fail(format!("there is no parameter `{}`", names[0]))),
        };
        let old_is_text = matches!(value, Value::Text(_)) && names.len() == 1;
        let (new, node) = match &over.node.value {
            Shape::Word(word) | Shape::Text(word) if old_is_text => {
                (Value::Text(word.clone()), over.node.clone())
            }
            _ => {
                let old = Where::of(scope, names);
                let replacing = Replacing { target: over.target(), scope, file: over.file, unit: "" };
                let meant = replacing.meaning(&value_node(over, true), old.as_ref());
                let meant = meant.map_err(|problem| problem.at(&over.place(), ""))?;
                over.meant.replace(meant.text);
                let stack = Vec::new();
                (Evaluation { scope, file: over.file, stack: &stack }.value(&meant.node)?, meant.node)
            }
        };
        over.worth.replace(single(&new).then(|| new.clone()));
        replace(&mut value, &names[1..], new).map_err(fail)?;
        Ok((value, node))
    }

    pub(super) fn unknown_override(&self, over: &Override, model: &Model, scope: &Rc<Scope<'a>>) -> Problem {
        let target = over.target();
        let problem = Problem::error("unknown_override", format!("there is no `{target}` to set"))
            .at(&over.place(), "");
        let mut known: Vec<String> = model.ast.parameters.iter().map(|(name, _)| name.text.clone()).collect();
        collect_parameters(model, &mut known);
        if target == "simulation" || target.starts_with("simulation.") {
            return problem.help(
                "the settings in `simulation` are changed by --until, --solver, --rtol, --atol and --step, or by a parameter of the \
                 diagram that stands in it",
            );
        }
        let inside = named_inside(target, &known, &scope.members());
        match closest(target, known.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None if inside.len() == 1 => problem.help(format!("did you mean `{}`?", inside[0])),
            None if !inside.is_empty() => problem.help(format!("with that name there are {}", list(&inside))),
            None => problem.help(format!(
                "parameters of the diagram are {}; `path/to/block.parameter` names one of a block",
                list(&model.ast.parameters.iter().map(|(name, _)| name.text.clone()).collect::<Vec<_>>())
            )),
        }
    }
}

/// What a new value is worth, where it is one value.
fn worth(replacing: &Replacing, node: &Node) -> Option<Value> {
    let (Shape::Number(_) | Shape::Bool(_) | Shape::Text(_)) = node.value else { return None };
    let stack = Vec::new();
    let evaluation = Evaluation { scope: replacing.scope, file: replacing.file, stack: &stack };
    evaluation.value(node).ok().filter(single)
}

fn single(value: &Value) -> bool {
    matches!(value, Value::Number(_) | Value::Bool(_))
}

/// Replaces or adds a member.
fn put(members: &mut Vec<(Name, Node)>, name: &str, node: Node, span: &Range<usize>) {
    // The value stands on the command line; in the file the whole block is its place.
    let node = Node { span: span.clone(), ..node };
    match members.iter_mut().find(|(known, _)| known.text == name) {
        Some((_, old)) => *old = Node { span: old.span.clone(), ..node },
        None => members.push((Name { text: name.to_owned(), span: span.clone() }, node)),
    }
}

/// A word from the command line is an expression or a text where one of them is asked for.
fn value_node(over: &Override, text: bool) -> Node {
    match &over.node.value {
        Shape::Word(word) if text && word != "None" => {
            Node { span: over.node.span.clone(), value: Shape::Text(word.clone()) }
        }
        _ => over.node.clone(),
    }
}

/// Numbers, texts and lists whose path ends with what was written, or with a set of that name before: of `payload` the mass and
/// all else that a payload has.
fn named_inside(target: &str, known: &[String], members: &[String]) -> Vec<String> {
    let (last, around) = (format!(".{target}"), format!(".{target}."));
    let is_meant = |path: &&String| {
        path.ends_with(&last)
            || path.rfind(&around).is_some_and(|at| !path[at + around.len()..].contains(['.', '[']))
    };
    let mut found: Vec<String> = known.iter().chain(members).filter(is_meant).cloned().collect();
    found.dedup();
    found
}

/// What `--set` could have meant.
fn collect_parameters(model: &Model, known: &mut Vec<String>) {
    for block in &model.blocks {
        match &block.content {
            Content::Diagram(inside) => {
                known.extend(
                    inside.ast.parameters.iter().map(|(name, _)| format!("{}.{}", block.path, name.text)),
                );
                collect_parameters(inside, known);
            }
            Content::Block { .. } => {
                if let Some(info) = BlockInfo::find(&block.kind) {
                    known.extend(info.parameters.iter().map(|p| format!("{}.{}", block.path, p.name)));
                }
            }
            Content::Unknown => {}
        }
    }
}
