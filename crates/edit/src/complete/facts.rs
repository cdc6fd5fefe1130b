//! What is known of the blocks of a model: their ports, values and alternatives.

use std::collections::BTreeMap;
use std::path::PathBuf;

use blocksim_block::BlockInfo;
use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Compiled, Content, Model, ModelBlock, Sources};
use blocksim_signal::{Unit, si_text};
use blocksim_syntax::{Node, Shape};

/// A port of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// `input`, `output` or the domain of a conserving one.
    pub side: String,
    /// Its unit, where it has one.
    pub unit: String,
    /// A sentence.
    pub doc: String,
}

/// What a compilation knows of a block.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Facts {
    /// Its ports.
    pub ports: Vec<Port>,
    /// Values of its parameters, where they are numbers: `k`, `2 rad/s`.
    pub values: Vec<(String, String)>,
    /// The alternative that is built, if it is a variant.
    pub chosen: Option<String>,
}

/// Blocks of a file, as they were when the diagram could be read last.
pub type Blocks = BTreeMap<String, Facts>;

/// What a compilation knows of all blocks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Learned {
    /// Blocks by file.
    pub blocks: BTreeMap<PathBuf, Blocks>,
    /// The alternatives of `Choice` parameters by the name of the parameter.
    pub choices: BTreeMap<String, Vec<String>>,
}

impl Learned {
    /// Adds the blocks of a model and of all diagrams inside it. Those that could not be read stay as they were known before.
    pub fn learn(&mut self, model: &Model, sources: &Sources, compiled: &Compiled) {
        remember(model, sources, &units(compiled), &mut self.blocks, &mut self.choices);
    }
}

/// Units of outputs by path and port, as far as the compiler came.
fn units(compiled: &Compiled) -> BTreeMap<&str, String> {
    let of = |schedule: &'_ Schedule| -> Vec<(usize, String)> {
        let unit = |(n, signal): (usize, &blocksim_block::schedule::Signal)| {
            let dimension = signal.dimension.filter(|dimension| !dimension.is_open())?;
            Some((n, dimension.to_string()))
        };
        schedule.signals.iter().enumerate().filter_map(unit).collect()
    };
    let Some(schedule) = &compiled.schedule else { return BTreeMap::new() };
    of(schedule).into_iter().map(|(n, unit)| (schedule.signals[n].path.as_str(), unit)).collect()
}

/// Keeps what is known of the blocks of a diagram and of those inside.
fn remember(
    model: &Model,
    sources: &Sources,
    units: &BTreeMap<&str, String>,
    all: &mut BTreeMap<PathBuf, Blocks>,
    choices: &mut BTreeMap<String, Vec<String>>,
) {
    for (name, node) in &model.ast.parameters {
        let of = alternatives(node);
        if !of.is_empty() {
            choices.insert(name.text.clone(), of);
        }
    }
    let blocks = all.entry(sources.file(model.ast.file).path).or_default();
    for block in model.blocks.iter().filter(|block| !matches!(block.content, Content::Unknown)) {
        blocks.insert(block.name.clone(), facts(block, units));
    }
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content {
            remember(inside, sources, units, all, choices);
        }
    }
}

/// The alternatives of `Choice(default: .., of: [..])`.
fn alternatives(node: &Node) -> Vec<String> {
    let Shape::Struct(Some(word), members) = &node.value else { return Vec::new() };
    let of = members.iter().find(|(name, _)| word.text == "Choice" && name.text == "of");
    let Some(Node { value: Shape::List(items), .. }) = of.map(|(_, node)| node) else { return Vec::new() };
    let text = |item: &Node| if let Shape::Text(text) = &item.value { Some(text.clone()) } else { None };
    items.iter().filter_map(text).collect()
}

fn facts(block: &ModelBlock, units: &BTreeMap<&str, String>) -> Facts {
    let mut ports = ports(block);
    for port in ports.iter_mut().filter(|port| port.side == "output" && port.unit.is_empty()) {
        let unit = units.get(format!("{}.{}", block.path, port.name).as_str());
        port.unit = unit.cloned().unwrap_or_default();
    }
    Facts {
        ports,
        values: values(block),
        chosen: block.variant.as_ref().map(|variant| variant.chosen.clone()),
    }
}

/// Most numbers of one parameter that are shown.
const NUMBERS: usize = 6;

/// The numbers of the parameters with their units.
fn values(block: &ModelBlock) -> Vec<(String, String)> {
    let Content::Block { numbers, units, .. } = &block.content else { return Vec::new() };
    let info = BlockInfo::find(&block.kind);
    let value = |(name, numbers): &(String, Vec<f64>)| {
        let parameter = info.and_then(|info| info.parameters.iter().find(|known| known.name == name));
        let fixed = parameter.filter(|parameter| !parameter.unit.is_empty());
        let fixed = fixed.and_then(|parameter| Unit::parse(parameter.unit).ok()).map(|unit| unit.dimension);
        let dimension = fixed.or(units.find(name)).unwrap_or_default();
        let shown: Vec<String> =
            numbers.iter().take(NUMBERS).map(|&number| si_text(number, dimension)).collect();
        let more = if numbers.len() > NUMBERS { ", ..." } else { "" };
        let text = shown.join(", ");
        (name.clone(), if numbers.len() == 1 { text } else { format!("[{text}{more}]") })
    };
    numbers.iter().map(value).collect()
}

/// Ports of a block: inputs, outputs, conserving ones.
fn ports(block: &ModelBlock) -> Vec<Port> {
    let Content::Block { interface, .. } = &block.content else {
        let named = |names: Vec<String>, side: &'static str| {
            let port =
                move |name| Port { name, side: side.to_owned(), unit: String::new(), doc: String::new() };
            names.into_iter().map(port)
        };
        let signals = named(block.inputs(), "input").chain(named(block.outputs(), "output"));
        return signals.chain(named(block.ports(), "conserving")).collect();
    };
    let inputs = interface.inputs.iter().map(|input| Port {
        name: input.name.clone(),
        side: "input".to_owned(),
        unit: written(input.dimension),
        doc: input.doc.to_owned(),
    });
    let outputs = interface.outputs.iter().map(|output| Port {
        name: output.name.clone(),
        side: "output".to_owned(),
        unit: written(output.port_type.dimension),
        doc: output.doc.to_owned(),
    });
    let conserving = interface.ports.iter().filter(|port| !port.inner).map(|port| Port {
        name: port.name.clone(),
        side: port.domain.to_string(),
        unit: String::new(),
        doc: port.doc.to_owned(),
    });
    inputs.chain(outputs).chain(conserving).collect()
}

/// A unit; empty where there is none.
fn written(unit: Option<impl ToString>) -> String {
    unit.map_or_else(String::new, |unit| unit.to_string())
}
