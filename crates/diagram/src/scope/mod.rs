//! Parameters: where a name is looked up.

mod evaluation;
mod expression;
mod files;

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{Part, Value};
use indexmap::IndexMap;

use crate::replacing;
use crate::source::Sources;
use blocksim_syntax::{Name, Node};

pub(crate) use evaluation::{Evaluation, choices, described};
pub(crate) use expression::{expression, noted};
pub(crate) use files::{missing_file, read_tree};

/// Parameters of one instance of a diagram.
///
/// A name is looked up in what the instance was given and the file's own defaults, then in the enclosing
/// diagrams. Values are computed when they are first needed, so they may refer to each other in any order.
pub(crate) struct Scope<'a> {
    pub sources: &'a Sources<'a>,
    pub parent: Option<Rc<Scope<'a>>>,
    entries: RefCell<IndexMap<String, Entry<'a>>>,
    /// What expressions name of these parameters, with members and items as written: `axis.mass`, `start[0]`.
    reads: RefCell<BTreeSet<String>>,
    /// How deep the present value lies within others that wait for it, over all scopes of the model.
    depth: Rc<Cell<usize>>,
}

/// How deep values, brackets and parameters may lie in each other. All of them take the stack of the thread.
const DEEPEST: usize = 600;

struct Entry<'a> {
    place: Place,
    /// Where the diagram declares it, whoever gives it a value.
    declared: Place,
    /// As a file says it, whatever replaced it since.
    written: (FileId, Rc<Node>, Option<Rc<Scope<'a>>>),
    /// What replaced it or members of it since, with their names below it.
    replaced: Vec<(Vec<String>, FileId, Rc<Node>)>,
    state: State<'a>,
}

#[derive(Clone)]
enum State<'a> {
    /// Written in a file, to be evaluated in a scope: its own (`None`) or the one that gives it.
    Written {
        file: FileId,
        node: Rc<Node>,
        within: Option<Rc<Scope<'a>>>,
    },
    Busy,
    Ready(Result<Value, Problem>),
}

impl<'a> Scope<'a> {
    pub(crate) fn new(sources: &'a Sources<'a>, parent: Option<Rc<Scope<'a>>>) -> Self {
        let depth = parent.as_ref().map(|parent| parent.depth.clone()).unwrap_or_default();
        Self { sources, parent, entries: RefCell::default(), reads: RefCell::default(), depth }
    }

    /// Adds a parameter that a file declares.
    pub(crate) fn declare(&self, name: &Name, file: FileId, node: &Node) {
        self.insert(name, file, node, None);
    }

    /// Replaces the default by what an instance gives; it is evaluated in the scope of the giver.
    pub(crate) fn give(&self, name: &Name, file: FileId, node: &Node, within: &Rc<Scope<'a>>) {
        self.insert(name, file, node, Some(within.clone()));
    }

    /// Replaces a value by a known one, of which a member or all was written anew: at the path of `names`, in `file`.
    pub(crate) fn set(&self, names: &[String], value: Value, file: FileId, node: &Node) {
        let Some((name, below)) = names.split_first() else { return };
        if let Some(entry) = self.entries.borrow_mut().get_mut(name) {
            entry.state = State::Ready(Ok(value));
            entry.replaced.push((below.to_vec(), file, Rc::new(node.clone())));
        }
    }

    /// What replaced a parameter or the member of it with this path, and the names that are left of the path.
    pub(crate) fn replaced<'n>(
        self: &Rc<Self>,
        names: &'n [String],
    ) -> Option<(replacing::Place<'a>, &'n [String])> {
        let (name, below) = names.split_first()?;
        if let Some(entry) = self.entries.borrow().get(name) {
            let (path, file, node) =
                entry.replaced.iter().rev().find(|(path, ..)| below.starts_with(path))?;
            let place = replacing::Place { scope: self.clone(), file: *file, node: node.clone() };
            return Some((place, &below[path.len()..]));
        }
        self.parent.as_ref()?.replaced(names)
    }

    fn insert(&self, name: &Name, file: FileId, node: &Node, within: Option<Rc<Scope<'a>>>) {
        let node = Rc::new(node.clone());
        let written = (file, node.clone(), within.clone());
        let place = Place { file, span: name.span.clone() };
        let declared = self.entries.borrow().get(&name.text).map(|entry| entry.declared.clone());
        let declared = declared.unwrap_or_else(|| place.clone());
        let state = State::Written { file, node, within };
        self.entries
            .borrow_mut()
            .insert(name.text.clone(), Entry { place, declared, written, replaced: Vec::new(), state });
    }

    /// What a file says of a parameter, with the file and the scope in which that is meant; `None` when no diagram has it.
    pub(crate) fn written(self: &Rc<Self>, name: &str) -> Option<(Rc<Self>, FileId, Rc<Node>)> {
        if let Some(entry) = self.entries.borrow().get(name) {
            let (file, node, within) = &entry.written;
            return Some((within.as_ref().unwrap_or(self).clone(), *file, node.clone()));
        }
        self.parent.as_ref()?.written(name)
    }

    /// Keeps that an expression names a parameter, in the diagram that declares it.
    fn note_read(&self, path: &str) {
        if self.has(segments(path).next().unwrap_or_default()) {
            self.reads.borrow_mut().insert(path.to_owned());
        } else if let Some(parent) = &self.parent {
            parent.note_read(path);
        }
    }

    /// Where the diagram that has a parameter declares it; `None` when no diagram has it.
    pub(crate) fn declared(&self, name: &str) -> Option<Place> {
        self.own_declared(name).or_else(|| self.parent.as_ref()?.declared(name))
    }

    /// Whether an expression has named a parameter of this diagram, a member of it or a set around it.
    pub(crate) fn is_read(&self, path: &str) -> bool {
        self.reads.borrow().iter().any(|read| segments(read).zip(segments(path)).all(|(a, b)| a == b))
    }

    /// What expressions have named of this diagram's own parameters.
    pub(crate) fn reads(&self) -> Vec<String> {
        self.reads.borrow().iter().cloned().collect()
    }

    /// Names of this diagram's own parameters.
    pub(crate) fn own_names(&self) -> Vec<String> {
        self.entries.borrow().keys().cloned().collect()
    }

    /// Paths of all that stands in sets below this diagram's own parameters and is no set itself, as far as they have been
    /// computed: `robot.payload.mass`.
    pub(crate) fn members(&self) -> Vec<String> {
        fn below(path: &str, value: &Value, found: &mut Vec<String>) {
            match value {
                Value::Set(members) => {
                    members.iter().for_each(|(name, value)| below(&format!("{path}.{name}"), value, found))
                }
                _ => found.push(path.to_owned()),
            }
        }
        let mut found = Vec::new();
        for (name, entry) in self.entries.borrow().iter() {
            if let State::Ready(Ok(value @ Value::Set(_))) = &entry.state {
                below(name, value, &mut found);
            }
        }
        found
    }

    /// Whether this diagram itself has a parameter of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.entries.borrow().contains_key(name)
    }

    /// Where this diagram itself declares a parameter.
    pub(crate) fn own_declared(&self, name: &str) -> Option<Place> {
        self.entries.borrow().get(name).map(|entry| entry.declared.clone())
    }

    /// Computes a value `levels` deeper than the present one.
    fn deeper<T>(
        &self,
        levels: usize,
        place: impl FnOnce() -> Place,
        compute: impl FnOnce() -> Result<T, Problem>,
    ) -> Result<T, Problem> {
        let depth = self.depth.get();
        if depth >= DEEPEST {
            return Err(Problem::error("recursive_parameter", "too many parameters wait for each other")
                .at(&place(), "needed by all of them")
                .help("declare a parameter before those that refer to it"));
        }
        self.depth.set(depth + levels);
        let value = compute();
        self.depth.set(depth);
        value
    }

    /// What a path leads to from a parameter that has a value; `None` for all else.
    pub(crate) fn select(self: &Rc<Self>, name: &str, path: &[Part]) -> Option<Value> {
        let is_known = match self.entries.borrow().get(name).map(|entry| &entry.state) {
            None => return self.parent.as_ref()?.select(name, path),
            Some(State::Ready(Ok(value))) => return value.at(path).cloned(),
            Some(State::Ready(Err(_)) | State::Busy) => true,
            Some(State::Written { .. }) => false,
        };
        // It is computed once, and then there.
        if is_known || self.value(name)?.is_err() { None } else { self.select(name, path) }
    }

    /// Value of a parameter; `None` when no diagram has it.
    pub(crate) fn value(self: &Rc<Self>, name: &str) -> Option<Result<Value, Problem>> {
        let found = {
            let mut entries = self.entries.borrow_mut();
            entries.get_mut(name).map(|entry| {
                let state = std::mem::replace(&mut entry.state, State::Busy);
                (state, entry.place.clone())
            })
        };
        let Some((state, place)) = found else {
            return self.parent.as_ref().and_then(|parent| parent.value(name));
        };
        let value = match state {
            State::Ready(value) => value,
            State::Busy => Err(Problem::error("recursive_parameter", format!("`{name}` depends on itself"))
                .at(&place, "the value is needed to compute it")
                .help("give one of the parameters on the way a value of its own")),
            State::Written { file, node, within } => {
                let scope = within.as_ref().unwrap_or(self);
                let stack = Vec::new();
                Evaluation { scope, file, stack: &stack }.value(&node)
            }
        };
        if let Some(entry) = self.entries.borrow_mut().get_mut(name) {
            entry.state = State::Ready(value.clone());
        }
        Some(value)
    }
}

/// The parts of `axis.start[0]`: `axis`, `start`, `0`.
fn segments(path: &str) -> impl Iterator<Item = &str> {
    path.split(['.', '[', ']']).map(str::trim).filter(|part| !part.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toys::NoFiles;
    use blocksim_syntax::read;

    const FILE: FileId = FileId(0);

    fn name(text: &str) -> Name {
        Name { text: text.to_owned(), span: 0..0 }
    }

    fn declare(scope: &Scope, parameter: &str, written: &str) {
        scope.declare(&name(parameter), FILE, &read(written).expect("RON"));
    }

    fn number(scope: &Rc<Scope>, parameter: &str) -> f64 {
        let value = scope.value(parameter).expect("a parameter").expect("a value");
        value.as_number().expect("a number").value
    }

    #[test]
    fn what_is_given_comes_before_the_default_and_that_before_the_enclosing_diagram() {
        let sources = Sources::new(&NoFiles);
        let outer = Rc::new(Scope::new(&sources, None));
        declare(&outer, "a", "1");
        declare(&outer, "b", "2");
        declare(&outer, "c", "3");
        let inner = Rc::new(Scope::new(&sources, Some(outer.clone())));
        declare(&inner, "b", "20");
        declare(&inner, "c", "30");
        // What is given is computed where it is written: this `c` is the outer one.
        inner.give(&name("c"), FILE, &read("\"c * 100\"").expect("RON"), &outer);
        assert_eq!((number(&inner, "a"), number(&inner, "b"), number(&inner, "c")), (1.0, 20.0, 300.0));
        assert!(inner.value("d").is_none() && !inner.has("a"));
    }

    #[test]
    fn parameters_refer_to_each_other_in_any_order() {
        let sources = Sources::new(&NoFiles);
        let scope = Rc::new(Scope::new(&sources, None));
        declare(&scope, "area", "\"width * height\"");
        declare(&scope, "width", "2");
        declare(&scope, "height", "\"3 * width\"");
        assert_eq!(number(&scope, "area"), 12.0);
    }

    #[test]
    fn what_is_read_is_kept_where_it_is_declared() {
        let sources = Sources::new(&NoFiles);
        let outer = Rc::new(Scope::new(&sources, None));
        declare(&outer, "axis", "(mass: 1, start: [2, 3])");
        let inner = Rc::new(Scope::new(&sources, Some(outer.clone())));
        declare(&inner, "twice", "\"2 * axis.start[1]\"");
        assert_eq!(number(&inner, "twice"), 6.0);
        for (path, is_read) in [
            ("axis", true),
            ("axis.start", true),
            ("axis.start[1]", true),
            ("axis.start[0]", false),
            ("axis.mass", false),
            ("axe", false),
        ] {
            assert_eq!(outer.is_read(path), is_read, "{path}");
        }
        assert!(!inner.is_read("twice") && inner.reads().is_empty());
    }

    #[test]
    fn a_parameter_that_needs_itself_is_refused() {
        let sources = Sources::new(&NoFiles);
        let scope = Rc::new(Scope::new(&sources, None));
        declare(&scope, "a", "\"b\"");
        declare(&scope, "b", "\"a + 1\"");
        let problem = scope.value("a").expect("a parameter").expect_err("a circle");
        assert_eq!(
            (problem.code, problem.message.as_str()),
            ("recursive_parameter", "`a` depends on itself")
        );
    }

    #[test]
    fn a_long_chain_of_parameters_does_not_take_the_stack() {
        let sources = Sources::new(&NoFiles);
        let scope = Rc::new(Scope::new(&sources, None));
        let nested = |inner: &str| format!("\"{}{inner}{}\"", "(".repeat(30), ")".repeat(30));
        (0..10_000).for_each(|n| declare(&scope, &format!("p{n}"), &nested(&format!("p{} + 1", n + 1))));
        declare(&scope, "p10000", "0");
        let problem = scope.value("p0").expect("a parameter").expect_err("too long");
        assert_eq!(problem.code, "recursive_parameter");
        let forward = Rc::new(Scope::new(&sources, None));
        declare(&forward, "q0", "0");
        for n in 0..10_000 {
            declare(&forward, &format!("q{}", n + 1), &format!("\"q{n} + 1\""));
            assert_eq!(number(&forward, &format!("q{}", n + 1)), f64::from(n + 1));
        }
    }
}
