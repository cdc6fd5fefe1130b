//! Which wires carry more than one value.

use std::collections::BTreeSet;

use blocksim_block::Interface;
use blocksim_diagram::{ConnectionAst, Content, Model, Reference};

/// Deepest hierarchy that is followed.
const DEPTH: usize = 64;

/// Whether a source is a bus or a vector, as far as it can be seen without compiling.
pub(crate) fn is_bus(model: &Model, source: &Reference, buses: &BTreeSet<String>) -> bool {
    follow(model, source, buses, DEPTH)
}

fn follow(model: &Model, source: &Reference, buses: &BTreeSet<String>, depth: usize) -> bool {
    if depth == 0 {
        return false;
    }
    if source.block == "in" {
        let picked = |reference: &Reference| {
            reference.block == "in" && reference.port == source.port && !reference.elements.is_empty()
        };
        return source.elements.is_empty() && (buses.contains(&source.port) || sources(model).any(picked));
    }
    let Some(block) = model.block(&source.block) else { return false };
    match &block.content {
        Content::Diagram(inside) => {
            let output = inside.ast.outputs.iter().find(|(name, _)| name.text == source.port);
            output.is_some_and(|(_, reference)| {
                let mut deeper = reference.clone();
                deeper.elements.extend(source.elements.iter().cloned());
                follow(inside, &deeper, &BTreeSet::new(), depth - 1)
            })
        }
        Content::Block { interface, .. } => match source.elements.split_first() {
            None => block.kind == "BusCreator" || is_vector(interface, &source.port),
            Some((element, rest)) => driver(model, &source.block, element).is_some_and(|driver| {
                let mut further = driver.clone();
                further.elements.extend(rest.iter().cloned());
                follow(model, &further, buses, depth - 1)
            }),
        },
        Content::Unknown => false,
    }
}

fn is_vector(interface: &Interface, port: &str) -> bool {
    let output = interface.outputs.iter().find(|output| output.name == port);
    output.is_some_and(|output| output.port_type.shape.len() > 1)
}

fn sources(model: &Model) -> impl Iterator<Item = &Reference> {
    model.ast.connections.iter().filter_map(|connection| match connection {
        ConnectionAst::Signal(source, _) => Some(source),
        ConnectionAst::Conserving(_) => None,
    })
}

/// What drives an input of a block.
pub(crate) fn driver<'a>(model: &'a Model, block: &str, input: &str) -> Option<&'a Reference> {
    model.ast.connections.iter().find_map(|connection| match connection {
        ConnectionAst::Signal(source, targets) => {
            targets.iter().any(|target| target.block == block && target.port == input).then_some(source)
        }
        ConnectionAst::Conserving(_) => None,
    })
}

/// The inputs of the subsystem `block` that carry buses.
pub(crate) fn buses_into(model: &Model, block: &str, buses: &BTreeSet<String>) -> BTreeSet<String> {
    let Some(block) = model.block(block) else { return BTreeSet::new() };
    let carries =
        |input: &String| driver(model, &block.name, input).is_some_and(|source| is_bus(model, source, buses));
    block.inputs().into_iter().filter(carries).collect()
}
