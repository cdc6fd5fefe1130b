//! What a block looks like from outside: ports, states, dependencies. Pure data.

use blocksim_signal::{Dimension, Kind, SampleTime, Shape, Unit};

use crate::physical::PhysicalPort;

/// What travels over a connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PortType {
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Scalar, vector or matrix.
    pub shape: Shape,
    /// Dimension in SI base units, if it is known.
    pub dimension: Option<Dimension>,
}

impl PortType {
    /// A real scalar of unknown unit.
    pub const UNKNOWN: Self = Self { kind: Kind::Real, shape: Shape::Scalar, dimension: None };

    /// A real scalar without unit.
    pub fn scalar() -> Self {
        Self { dimension: Some(Dimension::NONE), ..Self::UNKNOWN }
    }

    /// A truth value.
    pub fn boolean() -> Self {
        Self { kind: Kind::Bool, ..Self::scalar() }
    }

    /// A real vector without unit.
    pub fn vector(n: usize) -> Self {
        Self { shape: Shape::Vector(n), ..Self::scalar() }
    }

    /// The same with another dimension.
    pub fn of(self, dimension: Option<Dimension>) -> Self {
        Self { dimension, ..self }
    }

    /// The same with another shape.
    pub fn shaped(self, shape: Shape) -> Self {
        Self { shape, ..self }
    }
}

/// An input port.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Name in the diagram.
    pub name: String,
    /// Required kind; `None` accepts every kind.
    pub kind: Option<Kind>,
    /// Required shape; `None` accepts every shape.
    pub shape: Option<Shape>,
    /// Required dimension; `None` accepts every one.
    pub dimension: Option<Dimension>,
    /// Value of an input that is not connected; `None` means that it must be.
    pub default: Option<f64>,
    /// One sentence for the manual.
    pub doc: &'static str,
}

impl Input {
    /// A real input of any shape and unit.
    pub fn real(name: impl Into<String>) -> Self {
        Self { kind: Some(Kind::Real), ..Self::any(name) }
    }

    /// An input that takes everything.
    pub fn any(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: None, shape: None, dimension: None, default: None, doc: "" }
    }

    /// A Bool input (a real one is refused).
    pub fn boolean(name: impl Into<String>) -> Self {
        Self { kind: Some(Kind::Bool), ..Self::any(name) }
    }

    /// Only scalars.
    pub fn scalar(self) -> Self {
        Self { shape: Some(Shape::Scalar), ..self }
    }

    /// Only this shape.
    pub fn shape(self, shape: Shape) -> Self {
        Self { shape: Some(shape), ..self }
    }

    /// Only signals of this unit's dimension (values are SI in any case).
    pub fn unit(self, unit: &str) -> Self {
        self.dimension(dimension_of(unit))
    }

    /// Only signals of this dimension.
    pub fn dimension(self, dimension: Option<Dimension>) -> Self {
        Self { dimension, ..self }
    }

    /// May stay unconnected and then has this value.
    pub fn default(self, value: f64) -> Self {
        Self { default: Some(value), ..self }
    }

    /// One sentence for the manual.
    pub fn doc(self, doc: &'static str) -> Self {
        Self { doc, ..self }
    }
}

/// An output port.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name in the diagram.
    pub name: String,
    /// What it carries.
    pub port_type: PortType,
    /// One sentence for the manual.
    pub doc: &'static str,
}

impl Output {
    /// A real scalar without unit.
    pub fn real(name: impl Into<String>) -> Self {
        Self::like(name, PortType::scalar())
    }

    /// A Bool scalar.
    pub fn boolean(name: impl Into<String>) -> Self {
        Self::like(name, PortType::boolean())
    }

    /// Of this type.
    pub fn like(name: impl Into<String>, port_type: PortType) -> Self {
        Self { name: name.into(), port_type, doc: "" }
    }

    /// With this unit.
    pub fn unit(mut self, unit: &str) -> Self {
        self.port_type.dimension = dimension_of(unit);
        self
    }

    /// With this dimension.
    pub fn dimension(mut self, dimension: Option<Dimension>) -> Self {
        self.port_type.dimension = dimension;
        self
    }

    /// With this shape.
    pub fn shape(mut self, shape: Shape) -> Self {
        self.port_type.shape = shape;
        self
    }

    /// One sentence for the manual.
    pub fn doc(self, doc: &'static str) -> Self {
        Self { doc, ..self }
    }
}

/// The dimension of a unit written in the source of a block; an unknown unit there is a mistake of ours that
/// the registry test finds, and means "any" here.
fn dimension_of(unit: &str) -> Option<Dimension> {
    Unit::parse(unit).ok().map(|unit| unit.dimension)
}

/// One continuous state.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Name below the block, for messages: `x`, `psi_ds` ...
    pub name: String,
    /// Value at the start.
    pub initial: f64,
}

/// One discrete state: a sampled state, a mode or a cell of a memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// Name below the block, for messages.
    pub name: String,
    /// Value at the start.
    pub initial: f64,
}

/// What a recording block wants recorded: all its inputs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorded {
    /// Unit to show them in; SI when absent.
    pub display: Option<String>,
    /// What each input is called in legends; empty where the names of the inputs do.
    pub legend: Vec<String>,
}

/// What a block looks like from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Interface {
    /// Input ports in the order of `Context::inputs`.
    pub inputs: Vec<Input>,
    /// Output ports in the order of `Context::outputs`.
    pub outputs: Vec<Output>,
    /// Output group of each output.
    pub group_of: Vec<usize>,
    /// The inputs that each output group reads; `None` stands for all.
    pub groups: Vec<Option<Vec<usize>>>,
    /// Conserving ports.
    pub ports: Vec<PhysicalPort>,
    /// Continuous states.
    pub states: Vec<State>,
    /// Discrete states.
    pub discrete: Vec<Discrete>,
    /// Names of the guards.
    pub guards: Vec<String>,
    /// When the block samples; `None` means continuous or as its inputs.
    pub sample_time: Option<SampleTime>,
    /// The outputs change with time even when inputs and states do not.
    pub uses_time: bool,
    /// Has `settle`.
    pub settles: bool,
    /// Has `jump`.
    pub jumps: bool,
    /// Has `accept`.
    pub accepts: bool,
    /// Has `next_event`.
    pub time_events: bool,
    /// Has `prepare` and `solve`.
    pub implicit: bool,
    /// Largest step that the block allows, s.
    pub max_step: Option<f64>,
    /// The block records its inputs.
    pub recorded: Option<Recorded>,
}

impl Interface {
    /// No ports, no states.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an input.
    pub fn input(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds an output that depends on all inputs at the same instant.
    pub fn output(self, output: Output) -> Self {
        self.output_in(None, output)
    }

    /// Adds an output that depends on no input at the same instant: it breaks algebraic loops.
    pub fn output_from_state(self, output: Output) -> Self {
        self.output_in(Some(Vec::new()), output)
    }

    /// Adds an output that depends on these inputs at the same instant.
    pub fn output_reading(self, inputs: &[usize], output: Output) -> Self {
        self.output_in(Some(inputs.to_vec()), output)
    }

    /// Outputs that read the same inputs form one group; groups are numbered as they appear.
    fn output_in(mut self, reads: Option<Vec<usize>>, output: Output) -> Self {
        let group = self.groups.iter().position(|known| *known == reads).unwrap_or_else(|| {
            self.groups.push(reads);
            self.groups.len() - 1
        });
        self.outputs.push(output);
        self.group_of.push(group);
        self
    }

    /// Adds a continuous state.
    pub fn state(mut self, name: impl Into<String>, initial: f64) -> Self {
        self.states.push(State { name: name.into(), initial });
        self
    }

    /// Adds a discrete state.
    pub fn discrete(mut self, name: impl Into<String>, initial: f64) -> Self {
        self.discrete.push(Discrete { name: name.into(), initial });
        self
    }

    /// Adds `n` discrete states of one name.
    pub fn memory(mut self, name: &str, n: usize, initial: f64) -> Self {
        self.discrete.extend((0..n).map(|i| Discrete { name: format!("{name}[{i}]"), initial }));
        self
    }

    /// Adds a guard.
    pub fn guard(mut self, name: impl Into<String>) -> Self {
        self.guards.push(name.into());
        self
    }

    /// Samples with this period, s.
    pub fn sampled(mut self, period: f64) -> Self {
        self.sample_time = Some(SampleTime::Discrete { period, offset: 0.0 });
        self
    }

    /// Never changes.
    pub fn constant(mut self) -> Self {
        self.sample_time = Some(SampleTime::Constant);
        self
    }

    /// The outputs depend on time.
    pub fn uses_time(mut self) -> Self {
        self.uses_time = true;
        self
    }

    /// Has `settle`.
    pub fn settles(mut self) -> Self {
        self.settles = true;
        self
    }

    /// Has `jump`.
    pub fn jumps(mut self) -> Self {
        self.jumps = true;
        self
    }

    /// Has `accept`.
    pub fn accepts(mut self) -> Self {
        self.accepts = true;
        self
    }

    /// Has `next_event`.
    pub fn time_events(mut self) -> Self {
        self.time_events = true;
        self
    }

    /// Has `prepare` and `solve`.
    pub fn implicit(mut self) -> Self {
        self.implicit = true;
        self
    }

    /// Steps may not be longer than this, s.
    pub fn max_step(mut self, step: f64) -> Self {
        self.max_step = Some(step);
        self
    }

    /// Records all inputs.
    pub fn records(mut self, recorded: Recorded) -> Self {
        self.recorded = Some(recorded);
        self
    }

    /// Adds a conserving port.
    pub fn port(mut self, port: PhysicalPort) -> Self {
        self.ports.push(port);
        self
    }

    /// Whether output group `group` reads input `input` at the same instant.
    pub fn reads(&self, group: usize, input: usize) -> bool {
        self.groups[group].as_ref().is_none_or(|inputs| inputs.contains(&input))
    }
}

/// The inputs do not fit the block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterfaceError {
    /// A word for the manual: `unit_mismatch`, `type_mismatch`, `parameter`.
    pub code: &'static str,
    /// The ports that disagree, most guilty first.
    pub ports: Vec<String>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl InterfaceError {
    /// Shapes or kinds that do not fit.
    pub fn types(ports: &[&str], message: impl Into<String>) -> Self {
        Self::new("type_mismatch", ports, message)
    }

    /// Units that do not fit.
    pub fn units(ports: &[&str], message: impl Into<String>) -> Self {
        Self::new("unit_mismatch", ports, message)
    }

    fn new(code: &'static str, ports: &[&str], message: impl Into<String>) -> Self {
        Self {
            code,
            ports: ports.iter().map(ToString::to_string).collect(),
            message: message.into(),
            help: None,
        }
    }

    /// The same with advice.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}
