//! Blocks of the library: a kind, its parameters and the ports that follow from them.

use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{Block, BlockInfo, BlockKind, Given, MOST_MEMORY, ParamUnits};
use serde::Deserialize;

use super::Resolver;
use crate::ast::{Ast, BlockAst};
use crate::de::{Noted, Numbers, Reading, Tagged, Written};
use crate::model::Content;
use crate::scope::Scope;
use crate::source::BlockFiles;
use blocksim_syntax::{Node, Shape};

impl<'a> Resolver<'a> {
    pub(super) fn primitive(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: &str,
    ) -> Content {
        let Some(info) = BlockInfo::find(&block.kind.text) else {
            self.unknown_kind(ast, &block.kind);
            return Content::Unknown;
        };
        let parameters = self.block_overrides(block, info, (ast.file, scope), path);
        let names_fit = self.names_fit(ast, block, info, &parameters);
        // A wrong name does not hide what is wrong with the values of others; one that stands twice has been reported.
        let mut rest: Vec<&str> = info.parameters.iter().map(|parameter| parameter.name).collect();
        let parameters = parameters
            .into_iter()
            .filter(|(name, _)| {
                let at = rest.iter().position(|known| *known == name.text);
                at.map(|at| rest.swap_remove(at)).is_some()
            })
            .collect();
        let node =
            Node { span: block.span.clone(), value: Shape::Struct(Some(block.kind.clone()), parameters) };
        let reading = Reading::new(scope.clone(), ast.file, Some(info)).strict(self.strict);
        let body = Written::new(&reading, &node);
        let kind = match Box::<dyn BlockKind>::deserialize(Tagged { kind: &block.kind.text, body }) {
            Ok(kind) => kind,
            Err(noted) => {
                // Those that are missing have been reported.
                let noted = if names_fit { noted } else { Noted::default() };
                for problem in reading.problems(noted, &ast.place(&block.span)) {
                    self.report(self.about_override(problem, path));
                }
                return Content::Unknown;
            }
        };
        if !names_fit {
            return Content::Unknown;
        }
        for problem in reading.bare.take() {
            self.report(problem.note(format!("in block `{path}` ({})", block.kind.text)));
        }
        let mut built = kind.into_block();
        let (units, numbers) = (reading.units.take(), reading.numbers.take());
        let place_of = |param: &str| {
            let name = param.split(['.', '[']).next().unwrap_or(param);
            let parameter = block.parameters.iter().find(|(known, _)| known.text == name);
            ast.place(parameter.map_or(&block.span, |(_, node)| &node.span))
        };
        let files = BlockFiles::beside(self.sources, ast.file);
        let loaded = built.load(&files);
        for warning in files.warnings() {
            let problem = Problem::warning(warning.code, warning.message).at(&place_of(warning.param), "");
            self.report(with_help(problem, warning.help));
        }
        if let Err(error) = loaded {
            let problem = Problem::error(error.code, error.message).at(&place_of(error.param), "");
            self.report(with_help(problem, error.help));
            return Content::Unknown;
        }
        built.place(path);
        if let Err(error) = built.check() {
            let mut place = place_of(&error.param);
            if let Some(span) = error.span {
                place.span = self.within(&place, span);
            }
            let problem = Problem::error("parameter", error.message)
                .at(&place, "")
                .note(format!("in block `{path}` ({})", block.kind.text));
            self.report(with_help(problem, error.help));
            return Content::Unknown;
        }
        let plain = self.strict && reading.has_open.get();
        self.interface(ast, block, Arc::from(built), (units, numbers, plain))
    }

    /// The place of some bytes of a text; the whole text where they are none of it, as behind characters that are written
    /// in another way, or where the text stands elsewhere.
    fn within(&self, text: &Place, span: Range<usize>) -> Range<usize> {
        let file = self.sources.file(text.file);
        let written = file.text.get(text.span.clone()).unwrap_or_default();
        let inner = written.strip_prefix('"').and_then(|inner| inner.strip_suffix('"'));
        match inner {
            Some(inner) if !inner.contains('\\') && inner.get(span.clone()).is_some() => {
                let start = text.span.start + 1;
                start + span.start..start + span.end
            }
            _ => text.span.clone(),
        }
    }

    fn interface(
        &self,
        ast: &Ast,
        block: &BlockAst,
        built: Arc<dyn Block>,
        (units, numbers, plain): (ParamUnits, Numbers, bool),
    ) -> Content {
        match built.interface(&Given::new(Vec::new(), units.clone())) {
            Ok(interface) if !self.has_room_for(&interface) => {
                self.report(
                    Problem::error(
                        "too_large",
                        format!("this model remembers more than {MOST_MEMORY} numbers"),
                    )
                    .at(&ast.place(&block.span), "there is no room for this block")
                    .help("delay fewer samples, or make the model of fewer blocks"),
                );
                Content::Unknown
            }
            Ok(interface) => {
                Content::Block { block: built, units, numbers, interface: Box::new(interface), plain }
            }
            Err(error) => {
                let problem = Problem::error(error.code, error.message).at(&ast.place(&block.span), "");
                self.report(with_help(problem, error.help));
                Content::Unknown
            }
        }
    }
}

fn with_help(problem: Problem, help: Option<String>) -> Problem {
    match help {
        Some(help) => problem.help(help),
        None => problem,
    }
}
