//! Parameters that nothing reads, so that they change nothing.

use std::collections::BTreeSet;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Problem};
use blocksim_signal::closest;

use super::Resolver;
use crate::overrides::{Override, Used};
use crate::scope::{Scope, described};
use blocksim_syntax::{Node, Shape};

/// Parameters that commands ask for by their names: a description of the robot, and what stands around it.
const OF_COMMANDS: [&str; 2] = ["manipulator", "surroundings"];

impl Resolver<'_> {
    /// Warnings about parameters of diagrams, and about values of the command line, that nothing has read. A model is to be
    /// resolved with all its settings before.
    pub(crate) fn unused(&self) -> Vec<Problem> {
        if self.overrides.is_empty() {
            return self.declared_in_vain();
        }
        // What is declared may have been read by what is replaced: only the new values are looked at.
        let replaced = self.replaced.borrow();
        let unread = replaced.iter().filter(|(_, scope, path)| !is_read(scope, path));
        let unread = unread.map(|(index, scope, path)| self.without_effect(*index, scope, path));
        unread.chain(self.overrides.iter().filter_map(not_chosen)).collect()
    }

    fn without_effect(&self, index: usize, scope: &Rc<Scope>, path: &str) -> Problem {
        let over = &self.overrides[index];
        let problem =
            Problem::warning("unused_parameter", format!("nothing reads `{path}`, so this changes nothing"))
                .at(&over.place(), "");
        let read = scope.reads();
        match closest(path, read.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`?")),
            None => problem.help("`blocksim params list MODEL` lists what can be set, with the values"),
        }
    }

    fn declared_in_vain(&self) -> Vec<Problem> {
        let instances = self.instances.borrow();
        // A file may be used several times, and read what it declares in some of them only.
        let read: BTreeSet<(FileId, String)> = instances
            .iter()
            .flat_map(|instance| {
                let paths = instance.ast.parameters.iter().flat_map(|(name, node)| leaves(&name.text, node));
                let read = paths.filter(|(path, ..)| is_read(&instance.scope, path));
                read.map(|(path, ..)| (instance.ast.file, path)).collect::<Vec<_>>()
            })
            .collect();
        let mut problems = Vec::new();
        for instance in instances.iter() {
            let ast = &instance.ast;
            for (name, node) in &ast.parameters {
                let leaves = leaves(&name.text, node);
                let unread: Vec<_> =
                    leaves.iter().filter(|(path, ..)| !read.contains(&(ast.file, path.clone()))).collect();
                if unread.len() == leaves.len() {
                    problems.push(unused(&name.text, &ast.place(&name.span)));
                } else {
                    problems.extend(unread.iter().map(|(path, span)| unused(path, &ast.place(span))));
                }
            }
        }
        problems
    }
}

/// That a value of the command line is for an alternative that is not built.
fn not_chosen(over: &Override) -> Option<Problem> {
    let Used::Apart(alternative) = &*over.used.borrow() else { return None };
    let target = over.target();
    let told = format!(
        "`{target}` is in the alternative {alternative}, which is not chosen, so this changes nothing"
    );
    let problem = Problem::warning("unused_parameter", told).at(&over.place(), "");
    Some(problem.help("`blocksim params list MODEL` lists what can be set, with the values"))
}

fn is_read(scope: &Scope, path: &str) -> bool {
    OF_COMMANDS.iter().any(|name| path.split(['.', '[']).next() == Some(name)) || scope.is_read(path)
}

fn unused(path: &str, place: &blocksim_block::problem::Place) -> Problem {
    Problem::warning("unused_parameter", format!("nothing reads the parameter `{path}`"))
        .at(place, "changes nothing")
        .help(format!("remove it, or name it where it is to act: `\"{path}\"`"))
}

/// The members of a set that is written here, with the places of their names; of anything else the parameter itself.
fn leaves(path: &str, node: &Node) -> Vec<(String, std::ops::Range<usize>)> {
    let (Shape::Struct(None, members) | Shape::Map(members)) = &node.value else {
        return vec![(path.to_owned(), node.span.clone())];
    };
    if members.is_empty() || described(members).is_some() {
        return vec![(path.to_owned(), node.span.clone())];
    }
    let below = members.iter().flat_map(|(name, node)| {
        let path = format!("{path}.{}", name.text);
        match &node.value {
            Shape::Struct(None, _) | Shape::Map(_) => leaves(&path, node),
            _ => vec![(path, name.span.clone())],
        }
    });
    below.collect()
}
