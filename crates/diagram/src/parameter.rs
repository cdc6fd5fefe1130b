//! One value out of a diagram or a file of values, for programs that do not run the diagram.

use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_signal::closest;
use serde::de::DeserializeOwned;

use crate::de::{Reading, Written};
use crate::overrides;
use crate::problems::list;
use crate::resolve::Resolver;
use crate::scope::{Scope, read_tree};
use crate::source::Sources;
use blocksim_syntax::{Node, Shape};

/// Reads a parameter of a diagram as a value of any type: the file at `root` is a diagram that has a parameter
/// `name`, or itself a set or a list. `overrides` are `target=value` as of `--set`; in a diagram only.
///
/// # Errors
/// All problems with their places, as of [`compile`](crate::compile).
pub fn parameter<T: DeserializeOwned>(
    sources: &Sources,
    root: &Path,
    overrides: &[String],
    name: &str,
) -> Result<T, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let file = sources.open(root).map_err(|reason| {
        let problem = Problem::error("missing_file", format!("cannot read `{}`: {reason}", root.display()));
        one(problem.help("give the path of a diagram or of a file of values"))
    })?;
    let tree = read_tree(sources, file).map_err(one)?;
    let is_diagram = matches!(&tree.value, Shape::Struct(Some(kind), _) if kind.text == "Diagram");
    let scope = Rc::new(Scope::new(sources, None));
    if !is_diagram {
        return read(Reading::new(scope, file, None), &tree).map_err(one);
    }
    let overrides: Vec<_> = overrides
        .iter()
        .map(|text| overrides::parse(sources, text))
        .collect::<Result<_, _>>()
        .map_err(one)?;
    let resolver = Resolver::new(sources, overrides);
    let Some((ast, scope)) = resolver.parameters(file) else {
        return Err(resolver.problems.take().sorted());
    };
    let problems = resolver.problems.take();
    if problems.any_error() {
        return Err(problems.sorted());
    }
    let Some((_, declared)) = ast.parameters.iter().find(|(known, _)| known.text == name) else {
        let known: Vec<&str> = ast.parameters.iter().map(|(known, _)| known.text.as_str()).collect();
        let problem = Problem::error("parameter", format!("`{}` has no parameter `{name}`", root.display()));
        return Err(one(match closest(name, known.iter().copied()) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None if known.is_empty() => problem.help(format!("add it: `parameters: {{ \"{name}\": ... }}`")),
            None => problem.help(format!("its parameters are {}", list(&known))),
        }));
    };
    let node = Node { span: declared.span.clone(), value: Shape::Text(name.to_owned()) };
    read(Reading::new(scope, file, None), &node).map_err(one)
}

/// Whether the file at `root` is a diagram that has a parameter `name`. A file that cannot be read has none.
pub fn has_parameter(sources: &Sources, root: &Path, name: &str) -> bool {
    let Ok(file) = sources.open(root) else { return false };
    let is_diagram = read_tree(sources, file)
        .is_ok_and(|tree| matches!(&tree.value, Shape::Struct(Some(kind), _) if kind.text == "Diagram"));
    let declared = || Resolver::new(sources, Vec::new()).parameters(file);
    is_diagram
        && declared().is_some_and(|(ast, _)| ast.parameters.iter().any(|(known, _)| known.text == name))
}

fn read<T: DeserializeOwned>(reading: Reading, node: &Node) -> Result<T, Problem> {
    T::deserialize(Written::new(&reading, node)).map_err(|noted| {
        let place = blocksim_block::problem::Place { file: reading.file, span: node.span.clone() };
        reading.problem(noted, &place)
    })
}
