//! A diagram as it is written: names, raw parameters, places. No block is known yet.

mod connection;
mod panel;
mod parse;
mod record;

use std::ops::Range;

use blocksim_block::problem::{FileId, Place};

use blocksim_syntax::{Name, Node};

pub use panel::{PanelAst, PanelWord};
pub(crate) use parse::parse;

/// A file that holds a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Ast {
    /// The file.
    pub file: FileId,
    /// Title, if it has one.
    pub title: Option<String>,
    /// Parameters with their defaults.
    pub parameters: Vec<(Name, Node)>,
    /// `simulation: (...)`.
    pub simulation: Option<Node>,
    /// Signal inputs when used as a subsystem.
    pub inputs: Vec<(Name, Node)>,
    /// Signal outputs when used as a subsystem.
    pub outputs: Vec<(Name, Reference)>,
    /// Conserving ports when used as a subsystem.
    pub ports: Vec<(Name, Reference)>,
    /// Blocks in the order of the file.
    pub blocks: Vec<BlockAst>,
    /// Connections in the order of the file.
    pub connections: Vec<ConnectionAst>,
    /// Signals to record.
    pub record: Vec<RecordAst>,
    /// What changes and shows the model while it runs.
    pub panel: Vec<PanelAst>,
    /// Sections of which something could not be read.
    pub unread: Unread,
    /// The word `Diagram`, for problems of the whole.
    pub span: Range<usize>,
}

/// Sections of which something could not be read, and was reported: what is not found in them may well be written there, so that
/// it is no further problem.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Unread {
    /// `parameters`.
    pub parameters: bool,
    /// `inputs`.
    pub inputs: bool,
    /// `outputs`.
    pub outputs: bool,
    /// `ports`.
    pub ports: bool,
    /// `blocks`.
    pub blocks: bool,
    /// `connections`.
    pub connections: bool,
}

impl Unread {
    /// Whether the diagram may have ports that were not read.
    pub fn interface(self) -> bool {
        self.inputs || self.outputs || self.ports
    }

    fn mark(&mut self, section: &str) {
        match section {
            "parameters" => self.parameters = true,
            "inputs" => self.inputs = true,
            "outputs" => self.outputs = true,
            "ports" => self.ports = true,
            "blocks" => self.blocks = true,
            "connections" => self.connections = true,
            _ => {}
        }
    }
}

/// A block as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockAst {
    /// Name.
    pub name: Name,
    /// Kind.
    pub kind: Name,
    /// Text for drawings.
    pub label: Option<String>,
    /// Parameters.
    pub parameters: Vec<(Name, Node)>,
    /// The whole value.
    pub span: Range<usize>,
}

/// Signals to record: `"arm/**"`, or `(signals: ["arm/**"], every: "10 ms")`.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordAst {
    /// Patterns of their names.
    pub signals: Vec<Name>,
    /// Which rows are kept: a word of [`RATES`] and its value; all without.
    pub rate: Option<(Name, Node)>,
}

/// The words for which rows are kept.
pub const RATES: [&str; 3] = ["every", "rows", "minmax"];

/// A port of a block, or an element of a bus behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Block, or `in` for the inputs of the diagram.
    pub block: String,
    /// Port.
    pub port: String,
    /// Path within the bus.
    pub elements: Vec<String>,
    /// Place of the text.
    pub span: Range<usize>,
}

/// A connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConnectionAst {
    /// One output to inputs.
    Signal(Reference, Vec<Reference>),
    /// Conserving ports joined.
    Conserving(Vec<Reference>),
}

impl ConnectionAst {
    /// All that it joins.
    pub fn references(&self) -> impl Iterator<Item = &Reference> {
        let (source, rest) = match self {
            Self::Signal(source, targets) => (Some(source), targets),
            Self::Conserving(joined) => (None, joined),
        };
        source.into_iter().chain(rest)
    }
}

impl Ast {
    /// Inputs of the diagram that its connections and outputs take and that are not declared, which is a problem of this file.
    fn undeclared(&self) -> impl Iterator<Item = &str> {
        let used = self.connections.iter().flat_map(ConnectionAst::references);
        let used = used.chain(self.outputs.iter().map(|(_, reference)| reference));
        let is_declared = |name: &str| self.inputs.iter().any(|(input, _)| input.text == name);
        used.filter(|reference| reference.block == "in")
            .map(|reference| reference.port.as_str())
            .filter(move |name| !is_declared(name))
    }

    /// Whether an input of this name is used and not declared.
    pub fn lacks_input(&self, name: &str) -> bool {
        self.undeclared().any(|other| other == name)
    }

    /// Whether any input is used and not declared: one that is declared may be meant.
    pub fn lacks_inputs(&self) -> bool {
        self.undeclared().next().is_some()
    }

    /// A place in this file.
    pub fn place(&self, span: &Range<usize>) -> Place {
        Place { file: self.file, span: span.clone() }
    }
}
