//! Alternatives with the same ports, of which one is built.

use std::ops::Range;
use std::rc::Rc;

use blocksim_block::BlockInfo;
use blocksim_block::problem::{FileId, Problem};
use blocksim_signal::{Value, closest};

use super::{Chosen, HIERARCHY, Resolver};
use crate::ast::{Ast, BlockAst, parse};
use crate::mentions::Event;
use crate::model::{Content, ModelBlock, VariantChoice};
use crate::problems::list;
use crate::scope::{Evaluation, Scope};
use blocksim_syntax::{Name, Node, Shape};

impl<'a> Resolver<'a> {
    pub(super) fn variant(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: &str,
        stack: &[FileId],
    ) -> (Option<VariantChoice>, Content) {
        if !self.names_fit(ast, block, &HIERARCHY[1], &block.parameters) {
            return (None, Content::Unknown);
        }
        let parameter =
            |name: &str| block.parameters.iter().find(|(n, _)| n.text == name).map(|(_, node)| node);
        let (Some(choice), Some(of)) = (parameter("choice"), parameter("of")) else {
            return (None, Content::Unknown);
        };
        let alternatives = self.alternatives(ast, of);
        let names: Vec<String> = alternatives.iter().map(|block| block.name.text.clone()).collect();
        let stack_of_files = Vec::new();
        let chosen = Evaluation { scope, file: ast.file, stack: &stack_of_files }.value(choice);
        let chosen = match chosen {
            Ok(Value::Text(chosen)) => chosen,
            Ok(other) => {
                self.report(
                    Problem::error(
                        "parameter",
                        format!("the choice of a variant is a text, found {}", other.describe()),
                    )
                    .at(&ast.place(&choice.span), "")
                    .help("name a parameter whose value is Text(\"...\") or a Choice"),
                );
                return (None, Content::Unknown);
            }
            Err(problem) => {
                self.report(problem);
                return (None, Content::Unknown);
            }
        };
        if !names.contains(&chosen) {
            let problem = Problem::error("unknown_variant", format!("there is no alternative `{chosen}`"))
                .at(&ast.place(&choice.span), "chosen here")
                .at(&ast.place(&of.span), "the alternatives");
            self.report(match closest(&chosen, names.iter().map(String::as_str)) {
                Some(close) => problem.help(format!("did you mean `{close}`?")),
                None => problem.help(format!("the alternatives are {}", list(&names))),
            });
            return (None, Content::Unknown);
        }
        // All alternatives are read and checked; one is kept.
        let build = |block: &BlockAst| {
            if block.name.text == chosen {
                if BlockInfo::find(&block.kind.text).is_some() {
                    let (block, scope) = (block.clone(), scope.clone());
                    let chosen = Chosen { path: path.to_owned(), block, file: ast.file, scope };
                    self.chosen.borrow_mut().push(chosen);
                }
                return self.block(ast, block, scope, path.to_owned(), stack);
            }
            let before = (self.instances.borrow().len(), self.chosen.borrow().len());
            let around = self.apart.borrow().clone();
            self.apart.borrow_mut().get_or_insert_with(|| format!("`{}` of `{path}`", block.name.text));
            let built = self.block(ast, block, scope, path.to_owned(), stack);
            self.apart.replace(around);
            self.instances.borrow_mut().truncate(before.0);
            self.chosen.borrow_mut().truncate(before.1);
            built
        };
        self.sources.log.note(Event::Variant {
            block: ast.place(&block.name.span),
            alternatives: alternatives
                .iter()
                .map(|one| (ast.place(&one.name.span), one.kind.text.clone()))
                .collect(),
        });
        let built: Vec<ModelBlock> = alternatives.iter().map(build).collect();
        let is_sound = self.same_ports(ast, &alternatives, &built);
        for (model, block) in built.iter().zip(&alternatives) {
            if let Content::Diagram(model) = &model.content
                && (block.name.text != chosen || !is_sound)
            {
                crate::connect::check(model, &mut self.problems.borrow_mut());
            }
        }
        let by = if let Shape::Text(text) = &choice.value { text.clone() } else { String::new() };
        let kept = built
            .into_iter()
            .find(|block| block.name == chosen)
            // What it offers is unclear: that it lacks a port has been told.
            .filter(|_| is_sound)
            .map_or(Content::Unknown, |block| block.content);
        (Some(VariantChoice { by, chosen, of: names }), kept)
    }

    fn alternatives(&self, ast: &Ast, of: &Node) -> Vec<BlockAst> {
        let members = of.members().unwrap_or_default();
        let wrapped = Node {
            span: of.span.clone(),
            value: Shape::Struct(
                None,
                vec![(
                    Name { text: "blocks".to_owned(), span: of.span.clone() },
                    Node { span: of.span.clone(), value: Shape::Map(members.to_vec()) },
                )],
            ),
        };
        parse(ast.file, &wrapped, &mut self.problems.borrow_mut()).map(|ast| ast.blocks).unwrap_or_default()
    }

    /// Alternatives must be exchangeable. Returns whether they are.
    fn same_ports(&self, ast: &Ast, alternatives: &[BlockAst], built: &[ModelBlock]) -> bool {
        let known: Vec<(&ModelBlock, &BlockAst)> = built
            .iter()
            .zip(alternatives)
            .filter(|(block, _)| !matches!(block.content, Content::Unknown))
            .collect();
        let Some(((first, first_ast), others)) = known.split_first() else { return true };
        let mut is_sound = true;
        for (other, other_ast) in others {
            let sides: [(&str, Vec<String>, Vec<String>); 3] = [
                ("input", first.inputs(), other.inputs()),
                ("output", first.outputs(), other.outputs()),
                ("conserving port", first.ports(), other.ports()),
            ];
            for (what, a, b) in sides {
                let place = |span: &Range<usize>| ast.place(span);
                // What a file misses itself is told there.
                let misses = |of: &ModelBlock| matches!(&of.content, Content::Diagram(model) if model.ast.lacks_inputs());
                if what == "input" && (misses(first) || misses(other)) {
                    continue;
                }
                let lacks = |names: &[String], others: &[String], of: &ModelBlock| {
                    names.iter().find(|name| !others.contains(name) && of.port(name).is_none()).cloned()
                };
                let (port, has, has_not) = match (lacks(&a, &b, other), lacks(&b, &a, first)) {
                    (Some(port), _) => (port, first_ast, other_ast),
                    (None, Some(port)) => (port, other_ast, first_ast),
                    (None, None) => continue,
                };
                is_sound = false;
                self.report(
                    Problem::error(
                        "variant_ports",
                        format!("alternative `{}` has no {what} `{port}`", has_not.name.text),
                    )
                    .at(&place(&has_not.name.span), format!("no {what} `{port}`"))
                    .at(&place(&has.name.span), "has it")
                    .help("all alternatives of a variant offer the same ports"),
                );
            }
        }
        is_sound
    }
}
