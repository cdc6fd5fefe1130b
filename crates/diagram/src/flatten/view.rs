//! Names through levels: which output stands behind `block.port.element`.

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{Bus, Interface};
use blocksim_signal::closest;
use foldhash::{HashMap, HashMapExt};

use super::Source;
use crate::ast::{ConnectionAst, Reference};
use crate::model::{Content, Model, ModelBlock};
use crate::problems::{Problems, list};

/// What a name stands for.
#[derive(Debug, Clone)]
pub(super) enum Tree {
    Leaf {
        block: usize,
        output: usize,
    },
    Bus(Vec<(String, Tree)>),
    /// Reported elsewhere.
    Unknown,
}

#[derive(Default)]
pub(super) struct View<'m> {
    pub levels: Vec<Level<'m>>,
    /// Level inside a subsystem: outer level and name.
    pub inside: HashMap<(usize, String), usize>,
    /// Index in the flat list.
    pub index: HashMap<(usize, &'m str), usize>,
    /// Outputs of conditional subsystems that have a block of their own: level inside and name, index in the flat list.
    pub outlets: HashMap<(usize, String), usize>,
}

pub(super) struct Level<'m> {
    pub model: &'m Model,
    /// The blocks by name.
    pub blocks: HashMap<&'m str, &'m ModelBlock>,
    /// Outer level and the name of this subsystem there.
    pub parent: Option<(usize, String)>,
    /// What drives each input.
    pub drivers: HashMap<(&'m str, &'m str), (&'m Reference, &'m Reference)>,
}

/// A question that may lead through many levels; problems are shown where it was asked.
pub(super) struct Asked<'r> {
    place: Place,
    text: &'r str,
    /// A variant on the way, which may explain a missing element.
    variant: Option<String>,
    /// Steps taken so far.
    hops: u32,
    /// Steps that wait for the present one.
    depth: u32,
}

/// Steps from an input through buses and subsystems to its source. More of them are a circle; few enough that the stack
/// of a thread holds them.
const DEEPEST: u32 = 200;

/// Steps to all elements of a bus.
const MOST_HOPS: u32 = 100_000;

impl<'r> Asked<'r> {
    pub(super) fn new(place: Place, text: &'r str) -> Self {
        Self { place, text, variant: None, hops: 0, depth: 0 }
    }
}

impl<'m> View<'m> {
    pub(super) fn add(
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
        let blocks = model.blocks.iter().map(|block| (block.name.as_str(), block)).collect();
        self.levels.push(Level { model, blocks, parent, drivers });
        for block in &model.blocks {
            found.push((level, block));
            if let Content::Diagram(inner) = &block.content {
                self.inside.insert((level, block.name.clone()), self.levels.len());
                self.add(inner, Some((level, block.name.clone())), found);
            }
        }
    }

    /// The labels of the subsystems around a block and its own, the outermost first. A block without a label of its own
    /// goes by its name, unless that is `scope`; where nothing has a label, there is no title.
    pub(super) fn title(&self, level: usize, block: &ModelBlock) -> Vec<String> {
        let mut labels = Vec::new();
        let mut outer = self.levels[level].parent.as_ref();
        while let Some((level, name)) = outer {
            let subsystem = self.levels[*level].blocks.get(name.as_str());
            labels.extend(subsystem.and_then(|subsystem| subsystem.label.clone()));
            outer = self.levels[*level].parent.as_ref();
        }
        labels.reverse();
        match &block.label {
            Some(label) => labels.push(label.clone()),
            None if !labels.is_empty() && block.name != "scope" => labels.push(block.name.clone()),
            None => {}
        }
        labels
    }

    pub(super) fn input(
        &self,
        level: usize,
        block: &str,
        input: &str,
        problems: &mut Problems,
    ) -> Option<Source> {
        let (source, target) = self.levels[level].drivers.get(&(block, input))?;
        let ast = &self.levels[level].model.ast;
        let (place, at) = (ast.place(&source.span), ast.place(&target.span));
        let mut asked = Asked::new(place.clone(), &source.port);
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
    pub(super) fn tree(
        &self,
        level: usize,
        block: &str,
        port: &str,
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        asked.hops += 1;
        asked.depth += 1;
        let tree = if asked.depth > DEEPEST {
            Err(Problem::error("recursive_bus", "a bus contains itself")
                .at(&asked.place, "leads around in a circle")
                .help("a BusCreator cannot take its own bus as an element"))
        } else if asked.hops > MOST_HOPS {
            Err(Problem::error("recursive_bus", format!("a bus has more than {MOST_HOPS} elements"))
                .at(&asked.place, "leads to too many signals")
                .help("buses in buses multiply: select what is needed before it is put into the next bus"))
        } else {
            self.meaning(level, block, port, elements, asked)
        };
        asked.depth -= 1;
        tree
    }

    /// The same one step further.
    fn meaning(
        &self,
        level: usize,
        block: &str,
        port: &str,
        elements: &[String],
        asked: &mut Asked,
    ) -> Result<Tree, Problem> {
        if block == "in" {
            return self.outside(level, port, elements, asked);
        }
        let Some(found) = self.levels[level].blocks.get(block) else { return Ok(Tree::Unknown) };
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
                if let (Some(outlet), None) =
                    (self.outlets.get(&(*inner_level, port.to_owned())), elements.first())
                {
                    return Ok(Tree::Leaf { block: *outlet, output: 0 });
                }
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
        match (self.index.get(&(level, block)), output) {
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

    pub(super) fn driven(
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
}
