use std::collections::BTreeMap;

use blocksim_block::prelude::*;
use blocksim_signal::{Quantity, Value as Written};

use super::ode_law::{Dimensions, System, meant};
use crate::laws::{LawParameters, no_value, number_named};

/// A system of differential equations that is written as text.
///
/// Each line of `law`, or each part between semicolons, is an equation: `x' = ...` gives the rate of a state `x`, and `y = ...`
/// defines something that follows from states and inputs. States and definitions are outputs of their names; every name that is
/// neither of them nor a parameter is an input. A definition stands before the definitions that use it. Formulas are those of
/// `Expression`: numbers with units, `if`, comparisons and functions; what jumps in them is an event.
///
/// Units must fit: the rate of a state is in its unit over s. That of a state is the unit of its start value, or follows from its
/// rate. A definition that depends on states alone has no direct feedthrough.
///
/// ```ron
/// OdeSystem(
///     law: "
///         x' = v
///         v' = (force - d*v - k*x) / m
///         power = force * v
///     ",
///     start: { "x": "0.1 m" },
///     parameters: { "m": "2 kg", "d": "3 N*s/m", "k": "50 N/m" },
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Lines("ẋ = f(x, u)","y = g(x, u)"), builds = Equations)]
pub struct OdeSystem {
    /// The equations.
    pub law: String,
    /// States at the start, which may have units; 0 for those that are not named.
    #[block(default = BTreeMap::new())]
    pub start: BTreeMap<String, ParamValue>,
    /// Names with numbers, which may have units, or truth values.
    #[block(default = BTreeMap::new())]
    pub parameters: BTreeMap<String, ParamValue>,
}

/// The system with what its text means.
#[derive(Debug, Clone)]
pub struct Equations {
    of: OdeSystem,
    system: System,
}

impl OdeSystem {
    fn validate(&self, errors: &mut ParamErrors) {
        LawParameters(&self.parameters).validate(errors);
        for (name, ParamValue(value)) in &self.start {
            number_named(("start", name), value, "must start at a number", errors);
        }
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Equations> {
        let system = System::read(&self.law, &self.parameters, errors)?;
        let states = || system.rates.iter().map(|rate| rate.name.as_str());
        for name in self.start.keys().filter(|name| !states().any(|state| state == *name)) {
            let error = ParamError::new(format!("start.{name}"), format!("`{name}` is not a state"));
            errors.add(match meant(name, states()) {
                Some(state) => error.help(format!("did you mean `{state}`?")),
                None => error.help(format!("the states are {}", states().collect::<Vec<_>>().join(", "))),
            });
        }
        // What does not fit whatever the inputs are.
        errors.take(self.dimensions(&system, &|_| None))?;
        Some(Equations { of: self, system })
    }

    fn start(&self, name: &str) -> Option<Quantity> {
        self.start.get(name).and_then(|value| Written::as_number(&value.0))
    }

    fn dimensions(
        &self,
        system: &System,
        input: &dyn Fn(&str) -> Option<Dimension>,
    ) -> Result<Dimensions, ParamError> {
        // A bare number says nothing of its unit.
        let start = |name: &str| {
            let start = self.start(name)?;
            Some(start.dimension).filter(|dimension| *dimension != Dimension::NONE)
        };
        system.dimensions(&start, input, LawParameters(&self.parameters))
    }
}

impl Block for Equations {
    /// Outputs: the states, the definitions that follow from them alone, all others. Discrete states: modes.
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let Self { of, system } = self;
        let input = |name: &str| given.input(name).and_then(|input| input.dimension);
        let known = of.dimensions(system, &input).map_err(|error| {
            let part = error.span.as_ref().and_then(|span| of.law.get(span.clone())).unwrap_or_default();
            let in_text = |(name, _): &&(String, bool)| part.contains(name.as_str());
            let guilty: Vec<&str> =
                system.inputs.iter().filter(in_text).map(|(name, _)| name.as_str()).collect();
            let wrong = InterfaceError::units(&guilty, format!("{} in `{part}`", error.message));
            match error.help {
                Some(help) => wrong.help(help),
                None => wrong,
            }
        })?;
        let mut interface = Interface::new();
        for (name, is_truth) in &system.inputs {
            let input = if *is_truth { Input::boolean(name) } else { Input::real(name) };
            interface = interface.input(input.scalar());
        }
        for (rate, dimension) in system.rates.iter().zip(&known.states) {
            let y = Output::like(&rate.name, PortType::UNKNOWN.of(*dimension));
            interface = interface.output(y);
            let start = of.start(&rate.name).map_or(0.0, |start| start.value);
            interface = interface.state_in(&rate.name, start, *dimension);
        }
        for i in system.free.iter().chain(&system.bound) {
            let definition = &system.definitions[*i];
            let y = match definition.formula.is_truth() {
                true => PortType::boolean(),
                false => PortType::UNKNOWN.of(known.definitions[*i]),
            };
            let y = Output::like(&definition.name, y);
            interface = interface.output(y);
        }
        interface = system.of_free.declare(interface, 1, &of.law);
        Ok(system.of_bound.declare(interface, 1, &of.law))
    }

    fn law(&self, l: &Recording) -> bool {
        let system = &self.system;
        l.x().iter().enumerate().for_each(|(port, x)| l.set(port, 0, *x));
        let free = system.of_free.record(l, 0, 0, 0);
        let bound = system.of_bound.record(l, 0, system.of_free.modes(), system.of_free.guards());
        let definitions = free.outputs.iter().chain(&bound.outputs);
        definitions.enumerate().for_each(|(i, value)| l.set(system.rates.len() + i, 0, *value));
        bound.derivatives.iter().enumerate().for_each(|(i, rate)| l.derive(i, *rate));
        true
    }

    fn no_value(&self, failure: &Failure, _c: &Context) -> Option<String> {
        Some(no_value(failure, &self.of.law))
    }
}

#[cfg(test)]
#[path = "ode_system_tests.rs"]
mod tests;
