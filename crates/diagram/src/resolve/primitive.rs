//! Blocks of the library: a kind, its parameters and the ports that follow from them.

use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{Block, BlockInfo, Draft, Given, MOST_MEMORY, ParamError, ParamUnits};
use blocksim_signal::Unit;
use serde::Deserialize;

use super::Resolver;
use super::alike::Became;
use crate::ast::{Ast, BlockAst};
use crate::de::{Numbers, Reading, Tagged, Written};
use crate::model::Content;
use crate::replacing::{self, WrittenUnit};
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
        // Where somebody asks what names mean, each is to be told; what is replaced stands for one block alone.
        let is_one_of_many = self.overrides.is_empty() && !self.sources.log.is_on();
        let known = self.alike.borrow().of(block, ast.file, scope).filter(|_| is_one_of_many).cloned();
        if let Some(Became::Same(content)) = known {
            return self.with_room(ast, block, content);
        }
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
        let (built, errors) = match Draft::deserialize(Tagged { kind: &block.kind.text, body }) {
            Ok(draft) => draft.finish(&|name| written_unit(&reading, info, &node, name)),
            Err(noted) => {
                for problem in reading.problems(noted, &ast.place(&block.span)) {
                    self.report(self.about_override(problem, path));
                }
                return Content::Unknown;
            }
        };
        let unread = reading.noted();
        let is_read = unread.is_empty() && names_fit;
        for problem in unread {
            self.report(self.about_override(problem, path));
        }
        let places = Places { resolver: self, ast, block, path };
        let is_right = errors.is_empty();
        errors.into_iter().for_each(|error| self.report(places.refused(error)));
        let Some(mut built) = built.filter(|_| is_read && is_right) else { return Content::Unknown };
        let bare = reading.bare.take();
        let mut is_own = !bare.is_empty();
        for problem in bare {
            self.report(problem.note(format!("in block `{path}` ({})", block.kind.text)));
        }
        let (units, numbers) = (reading.units.take(), reading.numbers.take());
        let files = BlockFiles::beside(self.sources, ast.file);
        let loaded = built.load(&files);
        // What is in files is not compared, and plug-ins that die are found by where their blocks lie.
        is_own |= files.were_asked();
        for warning in files.warnings() {
            let problem = Problem::warning(warning.code, warning.message).at(&places.of(warning.param), "");
            self.report(with_help(problem, warning.help));
        }
        if let Err(error) = loaded {
            let problem = Problem::error(error.code, error.message).at(&places.of(error.param), "");
            self.report(with_help(problem, error.help));
            return Content::Unknown;
        }
        is_own |= built.place(path);
        let plain = self.strict && reading.has_open.get();
        let content = self.interface(ast, block, Arc::from(built), (units, numbers, plain));
        if is_one_of_many && let Content::Block { .. } = content {
            let became = if is_own { Became::Each } else { Became::Same(content.clone()) };
            if known.is_none() {
                self.alike.borrow_mut().note(node, ast.file, scope, became);
            }
        }
        content
    }

    /// What a block is, unless there is no room for what it remembers.
    fn with_room(&self, ast: &Ast, block: &BlockAst, content: Content) -> Content {
        if let Content::Block { interface, .. } = &content
            && !self.has_room_for(interface)
        {
            self.report(
                Problem::error("too_large", format!("this model remembers more than {MOST_MEMORY} numbers"))
                    .at(&ast.place(&block.span), "there is no room for this block")
                    .help("delay fewer samples, or make the model of fewer blocks"),
            );
            return Content::Unknown;
        }
        content
    }

    fn interface(
        &self,
        ast: &Ast,
        block: &BlockAst,
        built: Arc<dyn Block>,
        (units, numbers, plain): (ParamUnits, Numbers, bool),
    ) -> Content {
        let units = Arc::new(units);
        match built.interface(&Given::sharing(Vec::new(), Arc::clone(&units))) {
            Ok(interface) => {
                let (numbers, interface) = (Arc::new(numbers), Arc::new(interface));
                self.with_room(ast, block, Content::Block { block: built, units, numbers, interface, plain })
            }
            Err(error) => {
                let problem = Problem::error(error.code, error.message).at(&ast.place(&block.span), "");
                self.report(with_help(problem, error.help));
                Content::Unknown
            }
        }
    }
}

/// The unit in which a parameter of a block is written, of the kind that it has.
fn written_unit(reading: &Reading, info: &BlockInfo, block: &Node, name: &str) -> Option<Unit> {
    let known = info.parameters.iter().find(|parameter| parameter.name == name)?;
    let dimension = match known.unit {
        "" => reading.units.borrow().find(name)?,
        unit => Unit::parse(unit).ok()?.dimension,
    };
    let (_, node) = block.members()?.iter().find(|(written, _)| written.text == name)?;
    let (scope, node) = (reading.scope.clone(), Rc::new(node.clone()));
    match (replacing::Place { scope, file: reading.file, node }).unit(dimension) {
        WrittenUnit::One(unit) => Some(unit),
        _ => None,
    }
}

/// Where parameters of a block stand.
struct Places<'p, 'a> {
    resolver: &'p Resolver<'a>,
    ast: &'p Ast,
    block: &'p BlockAst,
    path: &'p str,
}

impl Places<'_, '_> {
    /// The place of a parameter or of a part of it, `axes[2].upper`; the block where it is not written.
    fn of(&self, param: &str) -> Place {
        let mut steps = param.split(['.', '[']).map(|step| step.trim_end_matches(']'));
        let name = steps.next().unwrap_or(param);
        if let Some(place) = self.resolver.override_of(self.path, name) {
            return place;
        }
        let parameter = self.block.parameters.iter().find(|(known, _)| known.text == name);
        let Some((_, whole)) = parameter else { return self.ast.place(&self.block.span) };
        let mut node = whole;
        for step in steps {
            let inner = match &node.value {
                Shape::List(items) | Shape::Tuple(None, items) => {
                    step.parse().ok().and_then(|i: usize| items.get(i))
                }
                _ => node.members().and_then(|members| {
                    members.iter().find(|(known, _)| known.text == step).map(|(_, node)| node)
                }),
            };
            match inner {
                Some(inner) => node = inner,
                // An expression or a file; its text is as near as one gets.
                None => break,
            }
        }
        self.ast.place(&node.span)
    }

    /// What is wrong with a parameter, and what takes part in it.
    fn refused(&self, error: ParamError) -> Problem {
        let mut place = self.of(&error.param);
        if let Some(span) = error.span {
            place.span = self.within(&place, span);
        }
        let problem = Problem::error("parameter", error.message).at(&place, "");
        let others = error.beside.iter().filter_map(|name| Some((name, self.written(name)?)));
        let problem = others.fold(problem, |problem, (name, other)| match other == place {
            true => problem,
            false => problem.at(&other, format!("`{name}`")),
        });
        let problem = problem.note(format!("in block `{}` ({})", self.path, self.block.kind.text));
        with_help(problem, error.help)
    }

    /// The place of a parameter that is written.
    fn written(&self, name: &str) -> Option<Place> {
        let is_written = self.block.parameters.iter().any(|(known, _)| known.text == name);
        (is_written || self.resolver.override_of(self.path, name).is_some()).then(|| self.of(name))
    }

    /// The place of some bytes of a text; the whole text where they are none of it, as behind characters that are written
    /// in another way, or where the text stands elsewhere.
    fn within(&self, text: &Place, span: Range<usize>) -> Range<usize> {
        let file = self.resolver.sources.file(text.file);
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
}

fn with_help(problem: Problem, help: Option<String>) -> Problem {
    match help {
        Some(help) => problem.help(help),
        None => problem,
    }
}
