//! What the names in the texts of a model stand for, and every place that names the same thing: for editors that rename, and
//! list references.
//!
//! Nothing here knows the rules of scopes. The resolver notes what it finds while it builds the model ([`Log`]), for every
//! instance and every alternative of a variant, so a name means here what it means in a run.

mod gather;
mod log;
mod paths;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::Value;

use crate::ast::Ast;
use crate::overrides::{before_block, members};
use crate::problems::Problems;
use crate::scope::Scope;
use crate::source::Sources;
use crate::{rates, settings, top};
use gather::Gathered;

pub(crate) use log::{Event, Log};

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Meaning {
    /// A parameter of a diagram.
    Parameter,
    /// A block.
    Block,
    /// An input, an output or a conserving port of a diagram that is used as a block.
    Port,
}

impl Meaning {
    /// In words, with an article.
    pub fn described(self) -> &'static str {
        match self {
            Meaning::Parameter => "a parameter",
            Meaning::Block => "a block",
            Meaning::Port => "a port",
        }
    }
}

/// Something that is declared under a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// What it is.
    pub meaning: Meaning,
    /// Its name.
    pub name: String,
    /// Where it is declared, without quotes. The alternatives of a variant declare their common ports in several files.
    pub declared: Vec<Place>,
    /// Why it cannot have another name, where it cannot.
    pub fixed: Option<String>,
}

/// A place that names symbols.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mention {
    /// The name there, without quotes.
    pub place: Place,
    /// The symbols, numbered as in [`Mentions::symbols`]; several where instances of one text differ in what they mean.
    pub symbols: Vec<usize>,
    /// A pattern with stars that matches the name, instead of the name itself.
    pub pattern: Option<String>,
}

/// All names of a model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mentions {
    /// What is declared.
    pub symbols: Vec<Symbol>,
    /// Where it is named, the declarations included, in the order of files and places.
    pub all: Vec<Mention>,
    /// Values of parameters of the top whose names blocks bear as well.
    shared: BTreeMap<String, Option<Value>>,
}

impl Mentions {
    /// The name at a byte of a file, or directly before it.
    pub fn at(&self, file: FileId, byte: usize) -> Option<&Mention> {
        let holds = |mention: &&Mention| {
            let span = &mention.place.span;
            mention.place.file == file && span.start <= byte && byte <= span.end
        };
        self.all.iter().filter(|mention| mention.pattern.is_none()).find(holds)
    }

    /// Whether a target of `--set` or of a panel that begins with the name of a parameter of the top means it, and not a block that bears the
    /// same name.
    pub fn is_of_parameter(&self, target: &str) -> bool {
        of_parameter(&self.shared, target)
    }

    /// Every place that names a symbol.
    pub fn of(&self, symbol: usize) -> impl Iterator<Item = &Mention> {
        self.all.iter().filter(move |mention| mention.symbols.contains(&symbol))
    }
}

/// The names of a model, and the problems found on the way. Where there are errors, names may be missing.
pub fn mentions(sources: &Sources, root: &Path) -> (Mentions, Vec<Problem>) {
    let mut problems = Problems::default();
    sources.log.start();
    let Some(top) = top(sources, root, &[], false, &mut problems) else {
        return (Mentions::default(), problems.sorted());
    };
    crate::connect::check(&top.model, &mut problems);
    // The settings may name parameters, too; what is wrong with them is for those who run the model.
    let mut others = Problems::default();
    let settings = settings::settings(&top.model.ast, &top.scope, None, false, &mut others);
    rates::rates(&top.model.ast, &top.scope, &settings, &mut others);
    let mut gathered = Gathered::new(sources, sources.log.take(), &top.model);
    gathered.diagrams();
    let shared = shared(&top.model.ast, &top.scope);
    paths::paths(&mut gathered, &top.model, &shared);
    (Mentions { shared, ..gathered.finish() }, problems.sorted())
}

/// Values of parameters whose names blocks of the same diagram bear; none of those that have none.
fn shared(ast: &Ast, scope: &Rc<Scope>) -> BTreeMap<String, Option<Value>> {
    let names = ast.parameters.iter().map(|(name, _)| &name.text);
    let names = names.filter(|name| ast.blocks.iter().any(|block| block.name.text == **name));
    names.map(|name| (name.clone(), scope.value(name).and_then(Result::ok))).collect()
}

fn of_parameter(shared: &BTreeMap<String, Option<Value>>, target: &str) -> bool {
    let names = members(target);
    let known = names.first().and_then(|name| shared.get(name));
    known.is_none_or(|value| value.as_ref().is_some_and(|value| before_block(value, names.get(1))))
}
