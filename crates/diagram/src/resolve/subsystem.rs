//! A diagram inside another, with what it is given.

use std::rc::Rc;

use blocksim_block::problem::{FileId, Problem};

use super::{Giver, HIERARCHY, Instance, Resolver};
use crate::ast::{Ast, BlockAst};
use crate::mentions::Event;
use crate::model::{Content, Model};
use crate::scope::{Scope, missing_file};
use blocksim_signal::closest;
use blocksim_syntax::{Node, Shape};

impl<'a> Resolver<'a> {
    pub(super) fn subsystem(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: &str,
        stack: &[FileId],
    ) -> Content {
        if !self.names_fit(ast, block, &HIERARCHY[0], &block.parameters) {
            return Content::Unknown;
        }
        let parameter =
            |name: &str| block.parameters.iter().find(|(n, _)| n.text == name).map(|(_, node)| node);
        let Some(Node { value: Shape::Text(name), span }) = parameter("file") else {
            self.report(
                Problem::error("parameter", "the file of a subsystem is a text")
                    .at(&ast.place(&block.span), "")
                    .help("write `file: \"name.ron\"`"),
            );
            return Content::Unknown;
        };
        let place = ast.place(span);
        let file = match self.sources.open(&self.sources.folder(ast.file).join(name)) {
            Ok(file) => file,
            Err(reason) => {
                self.report(missing_file(self.sources, name, &reason, &place));
                return Content::Unknown;
            }
        };
        if stack.contains(&file) {
            self.report(
                Problem::error("recursive_file", format!("`{name}` contains itself"))
                    .at(&place, "is being built already")
                    .help("a diagram cannot be part of itself"),
            );
            return Content::Unknown;
        }
        let Some(inside) = self.ast(file) else { return Content::Unknown };
        if !self.has_room_inside(ast, block, name, &inside, stack) {
            return Content::Unknown;
        }
        self.sources.log.note(Event::Inside { block: ast.place(&block.name.span), ast: inside.clone() });
        let inner = Rc::new(Scope::new(self.sources, Some(scope.clone())));
        inside.parameters.iter().for_each(|(name, node)| inner.declare(name, file, node));
        let mut unknown = Vec::new();
        if let Some(with) = parameter("with") {
            for (given, node) in with.members().unwrap_or_default() {
                if let Some(declared) = inner.own_declared(&given.text) {
                    self.sources.log.note(Event::Named { place: ast.place(&given.span), declared });
                    inner.give(given, ast.file, node, scope);
                } else if !inside.unread.parameters {
                    unknown.push(given.text.as_str());
                    self.unknown_with(ast, given, name, &inner.own_names());
                }
            }
        }
        let condition = self.condition(ast, block, scope, &inside);
        let Ok(condition) = condition else { return Content::Unknown };
        self.override_parameters(&inside, &inner, path);
        let mut fits = unknown.is_empty();
        for (parameter, node) in &inside.parameters {
            let required = matches!(&node.value, Shape::Word(word) if word == "Required");
            let given = !required
                || !matches!(inner.value(&parameter.text), Some(Err(p)) if p.code == "missing_parameter");
            if given {
                continue;
            }
            fits = false;
            // What is missing stands there under a wrong name.
            if closest(&parameter.text, unknown.iter().copied()).is_none() {
                self.report(
                    Problem::error(
                        "missing_parameter",
                        format!("`{name}` needs the parameter `{}`", parameter.text),
                    )
                    .at(&ast.place(&block.span), "not given")
                    .at(&inside.place(&parameter.span), "required here")
                    .help(format!("add it to `with: {{ \"{}\": ... }}`", parameter.text)),
                );
            }
        }
        if !fits {
            return Content::Unknown;
        }
        let giver = Giver { block: block.clone(), file: ast.file, scope: scope.clone() };
        self.log_defaults(&inside, &inner);
        self.built(Instance {
            path: path.to_owned(),
            ast: inside.clone(),
            scope: inner.clone(),
            giver: Some(giver),
        });
        let mut stack = stack.to_vec();
        stack.push(file);
        let model = self.model(&inside, &inner, path, &stack);
        Content::Diagram(Box::new(Model { condition, ..model }))
    }
}
