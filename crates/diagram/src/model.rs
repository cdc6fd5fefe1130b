//! A diagram with its blocks known and its hierarchy built.

use std::rc::Rc;
use std::sync::Arc;

use blocksim_block::physical::Domain;
use blocksim_block::problem::Place;
use blocksim_block::{Block, Interface, ParamUnits};

use crate::ast::Ast;
use crate::condition::Condition;

/// A diagram as it was instantiated: the top, or the inside of a subsystem.
#[derive(Debug, Clone)]
pub struct Model {
    /// Path of the subsystem; empty at the top.
    pub path: String,
    /// The file.
    pub ast: Rc<Ast>,
    /// The blocks, in the order of the file.
    pub blocks: Vec<ModelBlock>,
    /// When it runs, if not always.
    pub condition: Option<Condition>,
}

/// A block of a model.
#[derive(Debug, Clone)]
pub struct ModelBlock {
    /// Name within its diagram.
    pub name: String,
    /// Path from the top.
    pub path: String,
    /// Kind as written.
    pub kind: String,
    /// Text for drawings.
    pub label: Option<String>,
    /// Where it is declared.
    pub place: Place,
    /// The alternatives and the one that was chosen, if this is a variant.
    pub variant: Option<VariantChoice>,
    /// What it is.
    pub content: Content,
}

/// Which alternative of a variant is built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VariantChoice {
    /// The expression that chooses.
    pub by: String,
    /// The chosen alternative.
    pub chosen: String,
    /// All alternatives.
    pub of: Vec<String>,
}

/// What a block of a model is.
#[derive(Debug, Clone)]
pub enum Content {
    /// A block of the library or of a plug-in. Blocks that are written alike have all of it in common.
    Block {
        /// Parameters and functions.
        block: Arc<dyn Block>,
        /// Units of the parameters as written.
        units: Arc<ParamUnits>,
        /// Numbers of the parameters in SI by name, at most a few of each.
        numbers: Arc<Vec<(String, Vec<f64>)>>,
        /// Ports, as far as they do not depend on the inputs.
        interface: Arc<Interface>,
        /// Whether bare numbers of it have no unit, rather than an open one.
        plain: bool,
    },
    /// A subsystem.
    Diagram(Box<Model>),
    /// Something that could not be read: every port fits, so that one mistake shows once.
    Unknown,
}

/// What a name behind a block can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortKind {
    /// A signal input.
    Input,
    /// A signal output.
    Output,
    /// A conserving port.
    Conserving(Domain),
    /// Anything: the block, or what it offers, could not be read.
    Anything,
}

impl Model {
    /// A block by name.
    pub fn block(&self, name: &str) -> Option<&ModelBlock> {
        self.blocks.iter().find(|block| block.name == name)
    }

    /// Names of the signal inputs, those of its condition first.
    pub fn inputs(&self) -> impl Iterator<Item = &str> {
        let mut names: Vec<&str> = self.condition.iter().flat_map(Condition::inputs).collect();
        names.extend(self.ast.inputs.iter().map(|(name, _)| name.text.as_str()));
        names.into_iter()
    }

    /// The domain of a conserving port of this diagram, found at the block inside that it belongs to.
    pub fn port_domain(&self, port: &str) -> Option<Domain> {
        let (_, inside) = self.ast.ports.iter().find(|(name, _)| name.text == port)?;
        match self.block(&inside.block)?.port(&inside.port)? {
            PortKind::Conserving(domain) => Some(domain),
            _ => None,
        }
    }
}

impl ModelBlock {
    /// Names of the signal inputs.
    pub fn inputs(&self) -> Vec<String> {
        match &self.content {
            Content::Block { interface, .. } => {
                interface.inputs.iter().map(|input| input.name.clone()).collect()
            }
            Content::Diagram(model) => model.inputs().map(str::to_owned).collect(),
            Content::Unknown => Vec::new(),
        }
    }

    /// Names of the signal outputs.
    pub fn outputs(&self) -> Vec<String> {
        match &self.content {
            Content::Block { interface, .. } => {
                interface.outputs.iter().map(|output| output.name.clone()).collect()
            }
            Content::Diagram(model) => model.ast.outputs.iter().map(|(name, _)| name.text.clone()).collect(),
            Content::Unknown => Vec::new(),
        }
    }

    /// Names of the conserving ports.
    pub fn ports(&self) -> Vec<String> {
        match &self.content {
            Content::Block { interface, .. } => {
                interface.ports.iter().map(|port| port.name.clone()).collect()
            }
            Content::Diagram(model) => model.ast.ports.iter().map(|(name, _)| name.text.clone()).collect(),
            Content::Unknown => Vec::new(),
        }
    }

    /// What the port of this name is.
    pub fn port(&self, name: &str) -> Option<PortKind> {
        match &self.content {
            Content::Unknown => Some(PortKind::Anything),
            Content::Block { interface, .. } => {
                if interface.outputs.iter().any(|output| output.name == name) {
                    return Some(PortKind::Output);
                }
                if interface.inputs.iter().any(|input| input.name == name) {
                    return Some(PortKind::Input);
                }
                let port = interface.ports.iter().find(|port| port.name == name)?;
                Some(PortKind::Conserving(port.domain))
            }
            Content::Diagram(model) => {
                if model.ast.outputs.iter().any(|(output, _)| output.text == name) {
                    return Some(PortKind::Output);
                }
                if model.inputs().any(|input| input == name) {
                    return Some(PortKind::Input);
                }
                if !model.ast.ports.iter().any(|(port, _)| port.text == name) {
                    // Such a port may be written there, or the diagram itself misses it.
                    let is_known = model.ast.unread.interface() || model.ast.lacks_input(name);
                    return is_known.then_some(PortKind::Anything);
                }
                Some(model.port_domain(name).map_or(PortKind::Anything, PortKind::Conserving))
            }
        }
    }
}
