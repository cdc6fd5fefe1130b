//! From a tree of diagrams to one list of blocks: hierarchy and buses are names, and names end here.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{Block, Bus, Interface, ParamUnits};
use blocksim_signal::{Dimension, Unit, closest};

use crate::ast::{ConnectionAst, Reference, list};
use crate::model::{Content, Model, ModelBlock};
use crate::problems::Problems;
use crate::tree::{Node, Shape};

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
    /// Where it is declared.
    pub place: Option<Place>,
    /// Parameters and functions.
    pub block: Arc<dyn Block>,
    /// Units of the parameters as written.
    pub units: ParamUnits,
    /// Ports, as far as they are known.
    pub interface: Interface,
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

/// What a name stands for.
#[derive(Debug, Clone)]
enum Tree {
    Leaf {
        block: usize,
        output: usize,
    },
    Bus(Vec<(String, Tree)>),
    /// Reported elsewhere.
    Unknown,
}

/// Flattens a checked model.
pub(crate) fn flatten(model: &Model, problems: &mut Problems) -> Flat {
    let mut view = View { levels: Vec::new(), inside: HashMap::new(), index: HashMap::new() };
    let mut flat = Flat::default();
    let mut found: Vec<(usize, &ModelBlock)> = Vec::new();
    view.add(model, None, &mut found);
    found.sort_by(|(_, a), (_, b)| a.path.cmp(&b.path));
    let executed: Vec<&(usize, &ModelBlock)> = found.iter().filter(|(_, block)| executed(block)).collect();
    for (index, (level, block)) in executed.iter().enumerate() {
        view.index.insert((*level, block.name.clone()), index);
    }
    for (level, block) in executed {
        let Content::Block { block: built, units, interface } = &block.content else { continue };
        let mut inputs = Vec::new();
        for input in &interface.inputs {
            inputs.push(view.input(*level, &block.name, &input.name, problems));
        }
        flat.blocks.push(FlatBlock {
            path: block.path.clone(),
            kind: block.kind.clone(),
            place: Some(block.place.clone()),
            block: built.clone(),
            units: units.clone(),
            interface: (**interface).clone(),
            inputs,
            output_names: interface
                .outputs
                .iter()
                .map(|output| format!("{}.{}", block.path, output.name))
                .collect(),
        });
    }
    flat.nodes = view.nodes(&flat);
    flat.declared = view.declared(problems);
    record(model, &view, &found, &mut flat, problems);
    flat
}

fn executed(block: &ModelBlock) -> bool {
    matches!(&block.content, Content::Block { block, .. } if block.bus().is_none())
}

struct View<'m> {
    levels: Vec<Level<'m>>,
    /// Level inside a subsystem: outer level and name.
    inside: HashMap<(usize, String), usize>,
    /// Index in the flat list.
    index: HashMap<(usize, String), usize>,
}

struct Level<'m> {
    model: &'m Model,
    /// Outer level and the name of this subsystem there.
    parent: Option<(usize, String)>,
    /// What drives each input.
    drivers: HashMap<(&'m str, &'m str), (&'m Reference, &'m Reference)>,
}

/// A question that may lead through many levels; problems are shown where it was asked.
struct Asked<'r> {
    place: Place,
    text: &'r str,
    /// A variant on the way, which may explain a missing element.
    variant: Option<String>,
    hops: u32,
}

impl<'m> View<'m> {
    fn add(
        &mut self,
        model: &'m Model,
        parent: Option<(usize, String)>,
        found: &mut Vec<(usize, &'m ModelBlock)>,
    ) {
        let level = self.levels.len();
        let mut drivers = HashMap::new();
        for connection in &model.ast.connections {
            if let ConnectionAst::Signal(source, targets) = connection {
                for target in targets {
                    drivers.entry((target.block.as_str(), target.port.as_str())).or_insert((source, target));
                }
            }
        }
        self.levels.push(Level { model, parent, drivers });
        for block in &model.blocks {
            found.push((level, block));
            if let Content::Diagram(inner) = &block.content {
                self.inside.insert((level, block.name.clone()), self.levels.len());
                self.add(inner, Some((level, block.name.clone())), found);
            }
        }
    }

    fn input(&self, level: usize, block: &str, input: &str, problems: &mut Problems) -> Option<Source> {
        let (source, target) = self.levels[level].drivers.get(&(block, input))?;
        let ast = &self.levels[level].model.ast;
        let (place, at) = (ast.place(&source.span), ast.place(&target.span));
        let mut asked = Asked { place: place.clone(), text: &source.port, variant: None, hops: 0 };
        match self.tree(level, &source.block, &source.port, &source.elements, &mut asked) {
            Ok(Tree::Leaf { block, output }) => Some(Source { block, output, target: at, place }),
            Ok(Tree::Unknown) => None,
            Ok(Tree::Bus(elements)) => {
                let names: Vec<&str> = elements.iter().map(|(name, _)| name.as_str()).collect();
                problems.push(
                    Problem::error("type_mismatch", format!("`{block}.{input}` takes a signal, not a bus"))
                        .at(&place, format!("carries a bus with {}", list(&names)))
                        .at(&at, "takes one signal")
                        .help(format!(
                            "select an element: `{}.{}.{}`",
                            source.block,
                            source.port,
                            names.first().unwrap_or(&"...")
                        )),
                );
                None
            }
            Err(problem) => {
                problems.push(problem);
                None
            }
        }
    }

    /// What `block.port.elements` stands for at a level.
    fn tree(
        &self,
        level: usize,
        block: &str,
        port: &str,
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        asked.hops += 1;
        if asked.hops > 10_000 {
            return Err(Problem::error("recursive_bus", "a bus contains itself")
                .at(&asked.place, "leads around in a circle")
                .help("a BusCreator cannot take its own bus as an element"));
        }
        if block == "in" {
            return self.outside(level, port, elements, asked);
        }
        let Some(found) = self.levels[level].model.block(block) else { return Ok(Tree::Unknown) };
        if let Some(variant) = &found.variant {
            let others: Vec<&String> = variant.of.iter().filter(|name| **name != variant.chosen).collect();
            asked.variant = Some(format!(
                "`{}` is a variant, alternative `{}` is chosen; {} may have it",
                found.path,
                variant.chosen,
                list(&others)
            ));
        }
        match &found.content {
            Content::Unknown => Ok(Tree::Unknown),
            Content::Diagram(inner) => {
                let Some((_, inside)) = inner.ast.outputs.iter().find(|(name, _)| name.text == port) else {
                    return Ok(Tree::Unknown);
                };
                let Some(inner_level) = self.inside.get(&(level, block.to_owned())) else {
                    return Ok(Tree::Unknown);
                };
                let path: Vec<String> = inside.elements.iter().chain(elements).cloned().collect();
                self.tree(*inner_level, &inside.block, &inside.port, &path, asked)
            }
            Content::Block { block: built, interface, .. } => match built.bus() {
                Some(Bus::Create(names)) => self.created(level, block, &names, elements, asked),
                Some(Bus::Select(paths)) => {
                    let Some(path) = paths.iter().find(|path| path.rsplit('.').next() == Some(port)) else {
                        return Ok(Tree::Unknown);
                    };
                    let path: Vec<String> =
                        path.split('.').map(str::to_owned).chain(elements.iter().cloned()).collect();
                    self.driven(level, block, "u", &path, asked)
                }
                None => self.leaf(level, block, port, interface, elements, asked),
            },
        }
    }

    fn leaf(
        &self,
        level: usize,
        block: &str,
        port: &str,
        interface: &Interface,
        elements: &[String],
        asked: &Asked,
    ) -> Result<Tree, Problem> {
        if let Some(element) = elements.first() {
            return Err(Problem::error(
                "unknown_element",
                format!("`{}` has no element `{element}`", asked.text),
            )
            .at(&asked.place, "this is a signal, not a bus")
            .help("connect the signal itself"));
        }
        let output = interface.outputs.iter().position(|output| output.name == port);
        match (self.index.get(&(level, block.to_owned())), output) {
            (Some(block), Some(output)) => Ok(Tree::Leaf { block: *block, output }),
            _ => Ok(Tree::Unknown),
        }
    }

    fn created(
        &self,
        level: usize,
        block: &str,
        names: &[String],
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        let Some((element, rest)) = elements.split_first() else {
            let mut bus = Vec::new();
            for name in names {
                bus.push((name.clone(), self.driven(level, block, name, &[], asked)?));
            }
            return Ok(Tree::Bus(bus));
        };
        if names.contains(element) {
            return self.driven(level, block, element, rest, asked);
        }
        let problem = Problem::error("unknown_element", format!("the bus has no element `{element}`"))
            .at(&asked.place, "no such element");
        let problem = match &asked.variant {
            Some(variant) => problem.note(variant.clone()),
            None => problem,
        };
        Err(match closest(element, names.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`? The elements are {}", list(names))),
            None => problem.help(format!("its elements are {}", list(names))),
        })
    }

    fn driven(
        &self,
        level: usize,
        block: &str,
        input: &str,
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        let Some((source, _)) = self.levels[level].drivers.get(&(block, input)) else {
            return Ok(Tree::Unknown);
        };
        let path: Vec<String> = source.elements.iter().chain(elements).cloned().collect();
        self.tree(level, &source.block, &source.port, &path, asked)
    }

    fn outside(
        &self,
        level: usize,
        input: &str,
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        match &self.levels[level].parent {
            Some((parent, name)) => self.driven(*parent, name, input, elements, asked),
            None => Ok(Tree::Unknown),
        }
    }

    /// Inputs of subsystems that say their unit, with what drives them.
    fn declared(&self, problems: &mut Problems) -> Vec<Declared> {
        let mut declared = Vec::new();
        for level in &self.levels {
            let ast = &level.model.ast;
            for (name, node) in &ast.inputs {
                let dimension = match declared_unit(node) {
                    Ok(Some(dimension)) => dimension,
                    Ok(None) => continue,
                    Err((message, help)) => {
                        let problem = Problem::error("parameter", message).at(&ast.place(&node.span), "");
                        problems.push(problem.help(help));
                        continue;
                    }
                };
                let Some((parent, block)) = &level.parent else { continue };
                let Some((from, target)) =
                    self.levels[*parent].drivers.get(&(block.as_str(), name.text.as_str()))
                else {
                    continue;
                };
                let outer = &self.levels[*parent].model.ast;
                let (place, target) = (outer.place(&from.span), outer.place(&target.span));
                let mut asked = Asked { place: place.clone(), text: &from.port, variant: None, hops: 0 };
                // What is wrong with the name itself is reported where a block asks for it.
                let tree = self.tree(*parent, &from.block, &from.port, &from.elements, &mut asked);
                if let Ok(Tree::Leaf { block, output }) = tree {
                    declared.push(Declared {
                        name: format!("{}.{}", level.model.path, name.text),
                        dimension,
                        place: ast.place(&node.span),
                        source: Source { block, output, target, place },
                    });
                }
            }
        }
        declared
    }

    /// The conserving port of a block of the list that a name leads to.
    fn terminal(&self, level: usize, block: &str, port: &str) -> Option<(usize, String)> {
        let found = self.levels[level].model.block(block)?;
        match &found.content {
            Content::Diagram(inner) => {
                let (_, inside) = inner.ast.ports.iter().find(|(name, _)| name.text == port)?;
                let inner_level = self.inside.get(&(level, block.to_owned()))?;
                self.terminal(*inner_level, &inside.block, &inside.port)
            }
            Content::Block { .. } => {
                self.index.get(&(level, block.to_owned())).map(|index| (*index, port.to_owned()))
            }
            Content::Unknown => None,
        }
    }

    /// Sets of joined conserving ports over all levels.
    fn nodes(&self, flat: &Flat) -> Vec<Vec<(usize, usize)>> {
        let port_of = |(block, port): (usize, String)| {
            let index = flat.blocks[block].interface.ports.iter().position(|known| known.name == port)?;
            Some((block, index))
        };
        let mut sets: Vec<Vec<(usize, usize)>> = Vec::new();
        for (level, inside) in self.levels.iter().enumerate() {
            for connection in &inside.model.ast.connections {
                let ConnectionAst::Conserving(joined) = connection else { continue };
                let mut merged: Vec<(usize, usize)> = joined
                    .iter()
                    .filter_map(|reference| self.terminal(level, &reference.block, &reference.port))
                    .filter_map(port_of)
                    .collect();
                let (touching, others) =
                    sets.into_iter().partition(|set: &Vec<_>| set.iter().any(|t| merged.contains(t)));
                sets = others;
                merged.extend(touching.into_iter().flatten());
                merged.sort_unstable();
                merged.dedup();
                sets.push(merged);
            }
        }
        sets.retain(|set| !set.is_empty());
        sets.sort();
        sets
    }
}

/// The unit of `(unit: "rad/s")`; nothing for `()`.
fn declared_unit(node: &Node) -> Result<Option<Dimension>, (String, String)> {
    let help = "write `(unit: \"rad/s\")`, or `()` for any signal or bus".to_owned();
    let Some(members) = node.members() else {
        return Err((format!("expected a unit, found {}", node.describe()), help));
    };
    let mut dimension = None;
    for (name, value) in members {
        match (&value.value, name.text.as_str()) {
            (Shape::Text(text), "unit") => match Unit::parse(text) {
                Ok(unit) => dimension = Some(unit.dimension),
                Err(error) => return Err((error.message, error.help.unwrap_or(help))),
            },
            (_, "unit") => return Err((format!("expected a unit, found {}", value.describe()), help)),
            (_, other) => return Err((format!("an input has no `{other}`"), help)),
        }
    }
    Ok(dimension)
}

/// Signals that `record` asks for at the top: outputs of blocks and elements of buses.
fn record(
    model: &Model,
    view: &View,
    found: &[(usize, &ModelBlock)],
    flat: &mut Flat,
    problems: &mut Problems,
) {
    if model.ast.record.is_empty() {
        return;
    }
    let mut candidates: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (level, block) in found {
        for output in block.outputs() {
            let place = block.place.clone();
            let mut asked = Asked { place, text: &output, variant: None, hops: 0 };
            if let Ok(tree) = view.tree(*level, &block.name, &output, &[], &mut asked) {
                name_leaves(&format!("{}.{output}", block.path), &tree, &mut candidates);
            }
        }
    }
    for pattern in &model.ast.record {
        let place = model.ast.place(&pattern.span);
        let matching: Vec<_> = candidates.iter().filter(|(name, _)| matches(&pattern.text, name)).collect();
        if matching.is_empty() {
            problems.push(
                Problem::error("unknown_signal", format!("no signal matches `{}`", pattern.text))
                    .at(&place, "matches nothing")
                    .help("`*` stands for any part of a name, `**` for any number of subsystems: `arm/**.Angle`"),
            );
        }
        for (name, (block, output)) in matching {
            if flat.recorded.iter().all(|(known, _)| known != name) {
                let source =
                    Source { block: *block, output: *output, target: place.clone(), place: place.clone() };
                flat.recorded.push((name.clone(), source));
            }
        }
    }
}

fn name_leaves(name: &str, tree: &Tree, out: &mut BTreeMap<String, (usize, usize)>) {
    match tree {
        Tree::Leaf { block, output } => {
            out.insert(name.to_owned(), (*block, *output));
        }
        Tree::Bus(elements) => {
            for (element, tree) in elements {
                name_leaves(&format!("{name}.{element}"), tree, out);
            }
        }
        Tree::Unknown => {}
    }
}

/// `*` stands for any text without `/` and `.`, `**` for any text.
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
    fn go(pattern: &[u8], name: &[u8]) -> bool {
        match pattern {
            [] => name.is_empty(),
            [b'*', b'*', rest @ ..] => (0..=name.len()).any(|skip| go(rest, &name[skip..])),
            [b'*', rest @ ..] => (0..=name.len())
                .take_while(|skip| name[..*skip].iter().all(|c| *c != b'/' && *c != b'.'))
                .any(|skip| go(rest, &name[skip..])),
            [c, rest @ ..] => name.first() == Some(c) && go(rest, &name[1..]),
        }
    }
    pattern.len() < 256 && pattern.matches('*').count() < 12 && go(pattern.as_bytes(), name.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn patterns_match_within_and_across_levels() {
        assert!(matches("arm/**.Angle", "arm/base/out.y.Angle"));
        assert!(matches("arm/*/joint.q", "arm/base/joint.q"));
        assert!(!matches("arm/*.q", "arm/base/joint.q"));
        assert!(matches("**", "anything.y"));
        assert!(!matches("arm", "arm.y"));
    }
}
