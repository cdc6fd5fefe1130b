//! Signal ports: what goes in and comes out of a block.

use blocksim_signal::{Dimension, Kind, Shape, Unit};

/// Name of the input by which a block inside of a conditional subsystem asks whether it runs, and of the output that says so; no
/// block has a port of its own of that name.
pub const CONDITION: &str = "(condition)";

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
    /// The input of the same block whose derivative by time this one is. Where it is not connected, that one must not vary.
    pub rate_of: Option<usize>,
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
        Self {
            name: name.into(),
            kind: None,
            shape: None,
            dimension: None,
            default: None,
            rate_of: None,
            doc: "",
        }
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

    /// The derivative by time of another input, which does not vary if this one stays unconnected.
    pub fn rate_of(self, input: usize) -> Self {
        Self { rate_of: Some(input), ..self.default(0.0) }
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
