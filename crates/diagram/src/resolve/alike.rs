//! Blocks that are written alike: what became of one of them is what becomes of all.

use std::hash::{BuildHasher, Hash, Hasher};
use std::rc::Rc;

use blocksim_block::problem::FileId;
use foldhash::HashMap;
use foldhash::fast::FixedState;

use crate::ast::BlockAst;
use crate::model::Content;
use crate::scope::Scope;
use blocksim_syntax::{Name, Node, Shape};

/// What became of blocks, by all that is written of them.
#[derive(Default)]
pub(super) struct Alike<'a> {
    known: HashMap<u64, Vec<Class<'a>>>,
}

/// Blocks that are written alike in the same scope.
struct Class<'a> {
    /// One of them.
    node: Node,
    file: FileId,
    scope: Rc<Scope<'a>>,
    became: Became,
}

/// What is known of blocks that are written alike.
#[derive(Clone)]
pub(super) enum Became {
    /// All of them are this.
    Same(Content),
    /// Each of them is something else, by its place in the model.
    Each,
}

impl<'a> Alike<'a> {
    /// What is known of the blocks like this one; nothing where it is the first.
    pub(super) fn of(&self, block: &BlockAst, file: FileId, scope: &Rc<Scope<'a>>) -> Option<&Became> {
        let classes = self.known.get(&hash(&block.kind, &block.parameters, file, scope))?;
        let is_like = |class: &&Class<'a>| {
            let Shape::Struct(Some(kind), parameters) = &class.node.value else { return false };
            class.file == file
                && Rc::ptr_eq(&class.scope, scope)
                && kind.text == block.kind.text
                && are_members_alike(parameters, &block.parameters)
        };
        classes.iter().find(is_like).map(|class| &class.became)
    }

    /// Notes what is known of the blocks like this one, which is the first; `node` holds its kind and parameters.
    pub(super) fn note(&mut self, node: Node, file: FileId, scope: &Rc<Scope<'a>>, became: Became) {
        let Shape::Struct(Some(kind), parameters) = &node.value else { return };
        let classes = self.known.entry(hash(kind, parameters, file, scope)).or_default();
        classes.push(Class { node, file, scope: scope.clone(), became });
    }
}

fn hash(kind: &Name, parameters: &[(Name, Node)], file: FileId, scope: &Rc<Scope>) -> u64 {
    let mut hasher = FixedState::default().build_hasher();
    file.hash(&mut hasher);
    Rc::as_ptr(scope).hash(&mut hasher);
    kind.text.hash(&mut hasher);
    hash_members(parameters, &mut hasher);
    hasher.finish()
}

fn hash_members(members: &[(Name, Node)], hasher: &mut impl Hasher) {
    members.len().hash(hasher);
    for (name, node) in members {
        name.text.hash(hasher);
        hash_node(node, hasher);
    }
}

fn hash_node(node: &Node, hasher: &mut impl Hasher) {
    std::mem::discriminant(&node.value).hash(hasher);
    match &node.value {
        Shape::Number(value) => value.to_bits().hash(hasher),
        Shape::Bool(value) => value.hash(hasher),
        Shape::Text(text) | Shape::Word(text) => text.hash(hasher),
        Shape::List(items) | Shape::Tuple(_, items) => {
            items.len().hash(hasher);
            items.iter().for_each(|item| hash_node(item, hasher));
        }
        Shape::Map(members) | Shape::Struct(_, members) => hash_members(members, hasher),
    }
}

/// Whether two values are written alike, wherever they stand.
fn are_alike(a: &Node, b: &Node) -> bool {
    let is_name = |a: &Option<Name>, b: &Option<Name>| {
        a.as_ref().map(|name| &name.text) == b.as_ref().map(|name| &name.text)
    };
    match (&a.value, &b.value) {
        (Shape::Number(a), Shape::Number(b)) => a.to_bits() == b.to_bits(),
        (Shape::Bool(a), Shape::Bool(b)) => a == b,
        (Shape::Text(a), Shape::Text(b)) | (Shape::Word(a), Shape::Word(b)) => a == b,
        (Shape::List(a), Shape::List(b)) => are_items_alike(a, b),
        (Shape::Map(a), Shape::Map(b)) => are_members_alike(a, b),
        (Shape::Struct(name, a), Shape::Struct(other, b)) => is_name(name, other) && are_members_alike(a, b),
        (Shape::Tuple(name, a), Shape::Tuple(other, b)) => is_name(name, other) && are_items_alike(a, b),
        _ => false,
    }
}

fn are_items_alike(a: &[Node], b: &[Node]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| are_alike(a, b))
}

fn are_members_alike(a: &[(Name, Node)], b: &[(Name, Node)]) -> bool {
    let is_like =
        |((name, a), (other, b)): (&(Name, Node), &(Name, Node))| name.text == other.text && are_alike(a, b);
    a.len() == b.len() && a.iter().zip(b).all(is_like)
}
