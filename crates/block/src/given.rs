//! What a block is told about its surroundings when it states its interface.

use std::sync::Arc;

use blocksim_signal::{Dimension, Kind, Shape};

use crate::{InterfaceError, PortType};

/// The dimensions of parameters as they were written in the diagram, open for bare numbers. A parameter that is not listed has
/// its default, which has no dimension.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParamUnits(Vec<(String, Dimension)>);

impl ParamUnits {
    /// Notes the dimension of a parameter.
    pub fn insert(&mut self, name: &str, dimension: Dimension) {
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, slot)) => *slot = dimension,
            None => self.0.push((name.to_owned(), dimension)),
        }
    }

    /// The dimension of a parameter.
    pub fn get(&self, name: &str) -> Dimension {
        self.written(name).unwrap_or(Dimension::NONE)
    }

    /// The dimension of a parameter that was written, open if as a bare number.
    pub fn written(&self, name: &str) -> Option<Dimension> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, dimension)| *dimension)
    }

    /// The dimension of a parameter of which a unit was said.
    pub fn find(&self, name: &str) -> Option<Dimension> {
        self.written(name).filter(|dimension| !dimension.is_open())
    }
}

/// What is known of the inputs and of the units of the parameters.
#[derive(Debug, Clone, Default)]
pub struct Given {
    inputs: Vec<(String, PortType)>,
    /// Units of the parameters as written.
    pub parameters: Arc<ParamUnits>,
}

impl Given {
    /// Nothing is known yet.
    pub fn nothing() -> Self {
        Self::default()
    }

    /// From types of inputs by name.
    pub fn new(inputs: Vec<(String, PortType)>, parameters: ParamUnits) -> Self {
        Self::sharing(inputs, Arc::new(parameters))
    }

    /// The same, with units that others have in common.
    pub fn sharing(inputs: Vec<(String, PortType)>, parameters: Arc<ParamUnits>) -> Self {
        Self { inputs, parameters }
    }

    /// Type of an input, if it is known.
    pub fn input(&self, name: &str) -> Option<PortType> {
        self.inputs.iter().find(|(known, _)| known == name).map(|(_, port_type)| *port_type)
    }

    /// Type of an input; a real scalar of unknown unit if nothing is known.
    pub fn input_or_unknown(&self, name: &str) -> PortType {
        self.input(name).unwrap_or(PortType::UNKNOWN)
    }

    /// The common shape of inputs (and of parameters, as lengths) that are combined element by element: scalars
    /// fit everything, all others must be equal.
    ///
    /// # Errors
    /// Two inputs of different shapes.
    pub fn common_shape(&self, names: &[&str], parameters: &[Shape]) -> Result<Shape, InterfaceError> {
        let mut common: (Shape, Option<&str>) = (Shape::Scalar, None);
        for shape in parameters.iter().filter(|shape| **shape != Shape::Scalar) {
            common.0 = *shape;
        }
        for name in names {
            let shape = self.input_or_unknown(name).shape;
            if shape == Shape::Scalar || shape == common.0 {
                continue;
            }
            if common.0 == Shape::Scalar {
                common = (shape, Some(name));
                continue;
            }
            let (other, ports) = match common.1 {
                Some(first) => (format!("`{first}` is a {}", common.0), vec![*name, first]),
                None => (format!("the parameters ask for a {}", common.0), vec![*name]),
            };
            return Err(InterfaceError::types(&ports, format!("`{name}` is a {shape}, but {other}"))
                .help("combine signals of one shape, or a scalar with anything"));
        }
        Ok(common.0)
    }

    /// The common kind of inputs of which one is passed; `None` if none is known.
    ///
    /// # Errors
    /// Two inputs of different kinds.
    pub fn common_kind(&self, names: &[&str]) -> Result<Option<Kind>, InterfaceError> {
        let mut common: Option<(Kind, &str)> = None;
        for name in names {
            let Some(input) = self.input(name) else { continue };
            match common {
                Some((kind, first)) if kind != input.kind => {
                    let message = format!("`{name}` is {}, but `{first}` is {kind}", input.kind);
                    return Err(InterfaceError::types(&[name, first], message));
                }
                _ => common = Some((input.kind, name)),
            }
        }
        Ok(common.map(|(kind, _)| kind))
    }

    /// The common dimension of inputs that are added or compared; `None` if none is known. What is said of one of them counts
    /// before what bare numbers leave open.
    ///
    /// # Errors
    /// Two inputs of different dimensions.
    pub fn common_dimension(&self, names: &[&str]) -> Result<Option<Dimension>, InterfaceError> {
        let mut common: Option<(Dimension, &str)> = None;
        for name in names {
            let Some(dimension) = self.input(name).and_then(|port_type| port_type.dimension) else {
                continue;
            };
            match common {
                None => common = Some((dimension, name)),
                Some((first, first_name)) => {
                    if let Some(met) = first.meet(dimension) {
                        // The first one of which a unit is said stands for all.
                        let named = if first.is_open() && !dimension.is_open() { name } else { first_name };
                        common = Some((met, named));
                        continue;
                    }
                    return Err(InterfaceError::units(
                        &[name, first_name],
                        format!("`{name}` is in {dimension}, but `{first_name}` is in {first}"),
                    )
                    .help(format!(
                        "insert `Gain(k: \"{}\")` before `{name}`, or correct the parameter that sets its unit",
                        first.factor_from(dimension)
                    )));
                }
            }
        }
        Ok(common.map(|(dimension, _)| dimension))
    }
}
