//! From written diagrams to blocks: kinds are looked up, parameters computed, subsystems and variants built.

mod alike;
mod condition;
mod hierarchy;
mod names;
mod overridden;
mod primitive;
mod subsystem;
mod unused;
mod variant;

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use blocksim_block::problem::{FileId, Problem};
use blocksim_block::{Interface, MOST_MEMORY};
use foldhash::HashMap;

use crate::ast::{Ast, BlockAst, parse};
use crate::model::{Content, Model, ModelBlock};
use crate::overrides::{Override, Used};
use crate::problems::Problems;
use crate::scope::{Evaluation, Scope, read_tree};
use crate::source::Sources;
use alike::Alike;
use blocksim_syntax::{Name, Node};

pub use hierarchy::HIERARCHY;

/// A diagram that was built, with its parameters.
pub(crate) struct Instance<'a> {
    /// Path of the subsystem; empty at the top.
    pub path: String,
    pub ast: Rc<Ast>,
    pub scope: Rc<Scope<'a>>,
    /// Who built it; nobody the top.
    pub giver: Option<Giver<'a>>,
}

/// A block of the library in the place of a variant.
pub(crate) struct Chosen<'a> {
    /// Path of the variant.
    pub path: String,
    pub block: BlockAst,
    pub file: FileId,
    pub scope: Rc<Scope<'a>>,
}

/// The block that makes a diagram, which may give it parameters.
pub(crate) struct Giver<'a> {
    pub block: BlockAst,
    pub file: FileId,
    pub scope: Rc<Scope<'a>>,
}

impl Giver<'_> {
    /// What it gives.
    pub(crate) fn with(&self) -> &[(Name, Node)] {
        let with = self.block.parameters.iter().find(|(name, _)| name.text == "with");
        with.and_then(|(_, node)| node.members()).unwrap_or_default()
    }
}

/// Resolves the top diagram and everything below it.
pub(crate) struct Resolver<'a> {
    pub sources: &'a Sources<'a>,
    pub overrides: Vec<Override>,
    pub problems: RefCell<Problems>,
    /// The diagrams that were built, each before those inside it.
    pub instances: RefCell<Vec<Instance<'a>>>,
    /// Blocks of the library that variants have chosen, in the order in which they were built.
    pub chosen: RefCell<Vec<Chosen<'a>>>,
    /// The alternative that is not chosen and just read, where one is.
    apart: RefCell<Option<String>>,
    /// Parameters of diagrams that the command line has replaced: which of the overrides, in which diagram, and the path there.
    replaced: RefCell<Vec<(usize, Rc<Scope<'a>>, String)>>,
    /// Whether a bare number has no unit, rather than an open one.
    pub strict: bool,
    asts: RefCell<HashMap<FileId, Option<Rc<Ast>>>>,
    /// What became of blocks, for those that are written alike.
    alike: RefCell<Alike<'a>>,
    /// Names that nothing has, so far.
    unknown: Cell<usize>,
    /// Blocks and what they remember, so far.
    blocks: Cell<usize>,
    memory: Cell<usize>,
}

/// Most blocks of a model, those of subsystems counted each time.
const MOST_BLOCKS: usize = 100_000;

/// Most diagrams inside each other.
const DEEPEST: usize = 64;

impl<'a> Resolver<'a> {
    pub(crate) fn new(sources: &'a Sources<'a>, overrides: Vec<Override>) -> Self {
        Self {
            sources,
            overrides,
            problems: RefCell::default(),
            alike: RefCell::default(),
            unknown: Cell::default(),
            blocks: Cell::default(),
            memory: Cell::default(),
            instances: RefCell::default(),
            chosen: RefCell::default(),
            apart: RefCell::default(),
            replaced: RefCell::default(),
            strict: false,
            asts: RefCell::default(),
        }
    }

    /// Counts what a block remembers; whether there is room for it.
    fn has_room_for(&self, interface: &Interface) -> bool {
        let memory = self.memory.get() + interface.discrete.len() + interface.states.len();
        self.memory.set(memory);
        memory <= MOST_MEMORY
    }

    /// Whether one more diagram fits: a few files that contain each other many times over make any number of blocks.
    fn has_room_inside(
        &self,
        ast: &Ast,
        block: &BlockAst,
        name: &str,
        inside: &Ast,
        stack: &[FileId],
    ) -> bool {
        let blocks = self.blocks.get() + inside.blocks.len();
        self.blocks.set(blocks);
        let reason = match (stack.len() >= DEEPEST, blocks > MOST_BLOCKS) {
            (true, _) => format!("more than {DEEPEST} diagrams are inside each other here"),
            // One problem is enough for the thousands of places that are left out.
            (_, true) if blocks - inside.blocks.len() > MOST_BLOCKS => return false,
            (_, true) => format!("this model has more than {MOST_BLOCKS} blocks"),
            (false, false) => return true,
        };
        self.report(
            Problem::error("too_large", reason)
                .at(&ast.place(&block.span), format!("`{name}` is left out"))
                .help("make the model of fewer subsystems"),
        );
        false
    }

    fn report(&self, problem: Problem) {
        self.problems.borrow_mut().push(problem);
    }

    /// Reads the defaults of parameters for the names in them, also of those that are given another value.
    fn log_defaults(&self, ast: &Ast, scope: &Rc<Scope<'a>>) {
        if self.sources.log.is_on() {
            let stack = Vec::new();
            let evaluation = Evaluation { scope, file: ast.file, stack: &stack };
            ast.parameters.iter().for_each(|(_, node)| drop(evaluation.value(node)));
        }
    }

    fn built(&self, instance: Instance<'a>) {
        self.instances.borrow_mut().push(instance);
    }

    /// Reads a diagram once.
    pub(crate) fn ast(&self, file: FileId) -> Option<Rc<Ast>> {
        if let Some(known) = self.asts.borrow().get(&file) {
            return known.clone();
        }
        let ast = match read_tree(self.sources, file) {
            Ok(root) => parse(file, &root, &mut self.problems.borrow_mut()).map(Rc::new),
            Err(problem) => {
                self.report(problem);
                None
            }
        };
        self.asts.borrow_mut().insert(file, ast.clone());
        ast
    }

    /// The top diagram with its scope.
    pub(crate) fn top(&self, file: FileId) -> Option<(Model, Rc<Scope<'a>>)> {
        let (ast, scope) = self.parameters(file)?;
        self.built(Instance { path: String::new(), ast: ast.clone(), scope: scope.clone(), giver: None });
        let model = self.model(&ast, &scope, "", &[file]);
        for unused in self.overrides.iter().filter(|over| *over.used.borrow() == Used::Never) {
            self.report(self.unknown_override(unused, &model, &scope));
        }
        Some((model, scope))
    }

    /// The top diagram as written, and the scope of its parameters.
    pub(crate) fn parameters(&self, file: FileId) -> Option<(Rc<Ast>, Rc<Scope<'a>>)> {
        let ast = self.ast(file)?;
        let scope = Rc::new(Scope::new(self.sources, None));
        ast.parameters.iter().for_each(|(name, node)| scope.declare(name, file, node));
        self.override_parameters(&ast, &scope, "");
        Some((ast, scope))
    }

    /// The blocks of a diagram whose parameters are known.
    fn model(&self, ast: &Rc<Ast>, scope: &Rc<Scope<'a>>, path: &str, stack: &[FileId]) -> Model {
        for (name, _) in &ast.parameters {
            if let Some(Err(problem)) = scope.value(&name.text) {
                self.report(problem);
            }
        }
        let blocks = ast
            .blocks
            .iter()
            .map(|block| {
                let path = if path.is_empty() {
                    block.name.text.clone()
                } else {
                    format!("{path}/{}", block.name.text)
                };
                self.block(ast, block, scope, path, stack)
            })
            .collect();
        Model { path: path.to_owned(), ast: ast.clone(), blocks, condition: None }
    }

    fn block(
        &self,
        ast: &Ast,
        block: &BlockAst,
        scope: &Rc<Scope<'a>>,
        path: String,
        stack: &[FileId],
    ) -> ModelBlock {
        let mut variant = None;
        let content = match block.kind.text.as_str() {
            _ if self.sources.is_cancelled() => Content::Unknown,
            "Subsystem" => self.subsystem(ast, block, scope, &path, stack),
            "Variant" => {
                let (choice, content) = self.variant(ast, block, scope, &path, stack);
                variant = choice;
                content
            }
            _ => self.primitive(ast, block, scope, &path),
        };
        ModelBlock {
            name: block.name.text.clone(),
            path,
            kind: block.kind.text.clone(),
            label: block.label.clone(),
            place: ast.place(&block.name.span),
            variant,
            content,
        }
    }
}
