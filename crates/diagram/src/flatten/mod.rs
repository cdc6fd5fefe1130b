//! From a tree of diagrams to one list of blocks: hierarchy and buses are names, and names end here.

mod conditions;
mod input_units;
mod nodes;
mod origins;
pub(crate) mod record;
mod view;

use std::sync::Arc;

use blocksim_block::problem::Place;
use blocksim_block::schedule::BlockPart;
use blocksim_block::{Block, Interface, ParamUnits};
use blocksim_signal::Dimension;

use crate::model::{Content, Model, ModelBlock};
use crate::problems::Problems;
pub use origins::origins;
use record::record;
use view::View;

/// A list of blocks and how they are connected.
#[derive(Debug, Clone, Default)]
pub struct Flat {
    /// The blocks, sorted by path.
    pub blocks: Vec<FlatBlock>,
    /// Sets of conserving ports that are joined: block and port.
    pub nodes: Vec<Vec<(usize, usize)>>,
    /// Further signals to record: name and source.
    pub recorded: Vec<(String, Source)>,
    /// Inputs of subsystems that say their unit.
    pub declared: Vec<Declared>,
}

/// An input of a subsystem with the unit that its diagram declares.
#[derive(Debug, Clone, PartialEq)]
pub struct Declared {
    /// Path of the subsystem and name of the input.
    pub name: String,
    /// What the unit measures.
    pub dimension: Dimension,
    /// Where the unit is declared.
    pub place: Place,
    /// What drives the input.
    pub source: Source,
}

/// A block of the list.
#[derive(Debug, Clone)]
pub struct FlatBlock {
    /// Path from the top.
    pub path: String,
    /// Kind.
    pub kind: String,
    /// What it is called in pictures: see [`Recorded::title`](blocksim_block::schedule::Recorded::title).
    pub title: Vec<String>,
    /// Where it is declared.
    pub place: Option<Place>,
    /// The blocks that became this one, if it is a physical network.
    pub parts: Vec<BlockPart>,
    /// Parameters and functions.
    pub block: Arc<dyn Block>,
    /// Units of the parameters as written.
    pub units: Arc<ParamUnits>,
    /// Whether bare numbers of it have no unit, rather than an open one.
    pub plain: bool,
    /// Ports, as far as they are known.
    pub interface: Arc<Interface>,
    /// Where each input comes from; `None` when it is not connected.
    pub inputs: Vec<Option<Source>>,
    /// Names of the outputs as signals: path and port.
    pub output_names: Vec<String>,
}

/// Where an input comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Index of the block.
    pub block: usize,
    /// Index of its output.
    pub output: usize,
    /// Where the connection names the input.
    pub target: Place,
    /// Where the connection names the source.
    pub place: Place,
}

/// Flattens a checked model. The signals that fit the patterns of `also` are recorded as if the diagram said so.
pub(crate) fn flatten(model: &Model, also: &[(String, Place)], problems: &mut Problems) -> Flat {
    let mut view = View::default();
    let mut flat = Flat::default();
    let mut found: Vec<(usize, &ModelBlock)> = Vec::new();
    view.add(model, None, &mut found);
    found.sort_by(|(_, a), (_, b)| a.path.cmp(&b.path));
    let executed: Vec<&(usize, &ModelBlock)> = found.iter().filter(|(_, block)| executed(block)).collect();
    for (index, (level, block)) in executed.iter().enumerate() {
        view.index.insert((*level, block.name.as_str()), index);
    }
    let levels: Vec<usize> = executed.iter().map(|(level, _)| *level).collect();
    let conditions = view.conditions(&levels, problems);
    flat.blocks.reserve(executed.len());
    for (level, block) in executed {
        let Content::Block { block: built, units, interface, plain, .. } = &block.content else { continue };
        let mut inputs = Vec::new();
        for input in &interface.inputs {
            inputs.push(view.input(*level, &block.name, &input.name, problems));
        }
        flat.blocks.push(FlatBlock {
            path: block.path.clone(),
            kind: block.kind.clone(),
            title: view.title(*level, block),
            place: Some(block.place.clone()),
            parts: Vec::new(),
            block: built.clone(),
            units: units.clone(),
            plain: *plain,
            interface: interface.clone(),
            inputs,
            output_names: interface
                .outputs
                .iter()
                .map(|output| format!("{}.{}", block.path, output.name))
                .collect(),
        });
    }
    view.apply(&conditions, &levels, &mut flat, problems);
    flat.nodes = view.nodes(&flat);
    flat.declared = view.declared(problems);
    record(model, also, &view, &found, &mut flat, problems);
    flat
}

fn executed(block: &ModelBlock) -> bool {
    matches!(&block.content, Content::Block { block, .. } if block.bus().is_none())
}
