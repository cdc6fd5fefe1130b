use std::collections::BTreeMap;

use blocksim_law::Recorder;

use crate::laws::{Formulas, LawParameters, Part, TextLaw, no_value};
use blocksim_block::prelude::*;

/// A law that is written as text: $y = f(u_1, u_2, \ldots)$, element by element.
///
/// Every name in `law` that is not a parameter is an input of that name, in the order of the text. The law is made of numbers
/// with units, `+ - * / ^`, parentheses, `pi`, comparisons (`< <= > >= == !=`) and the functions `sqrt abs sign sin cos tan
/// asin acos atan atan2 sinh cosh tanh exp ln log10 hypot min max floor ceil round mod if and or not`. `if(condition, a, b)` is
/// `a` where the condition holds, else `b`; `mod(a, b)` has the sign of `b`. A law that compares has a truth value as its
/// output, and a name where a condition is needed is an input that is true or false.
///
/// Units are those of the inputs and parameters, and must fit as in an expression: `u1 + 1` is refused where `u1` is a
/// voltage, `u1 + 1 V` is not. Zero fits every unit, and so does a parameter without one.
///
/// The solver steps onto the kinks of `abs`, `min` and `max`. Comparisons, `sign`, `floor`, `ceil`, `round`, `mod` and the cut of
/// `atan2` change where the solver stops, and it stops where they may change; in between they are held. Where the law has no
/// value (`ln` of nothing positive, a division by zero) the simulation stops; in a branch that is not taken, nothing needs a
/// value. An angle that makes many turns is best an input of its own, as in `sin(u1)`: then no step goes beyond an eighth of a
/// turn where that matters.
///
/// ```ron
/// Expression(law: "sin(u1) * u2 + p", parameters: { "p": "3 N" })
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("law"), builds = Law)]
pub struct Expression {
    /// The law; its names are inputs or parameters.
    pub law: String,
    /// Names with numbers, which may have units, or truth values.
    #[block(default = BTreeMap::new())]
    pub parameters: BTreeMap<String, ParamValue>,
}

/// What the text means.
#[derive(Debug, Clone)]
pub struct Law {
    of: Expression,
    formulas: Formulas,
    law: TextLaw,
}

impl Expression {
    fn validate(&self, errors: &mut ParamErrors) {
        LawParameters(&self.parameters).validate(errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Law> {
        let parameters = LawParameters(&self.parameters);
        let formulas = Formulas::read(&[("law".to_owned(), &self.law)], parameters, &["y"], errors)?;
        let recorder = Recorder::new();
        match formulas.record(0, &recorder, &formulas.known(&recorder, parameters)) {
            Part::Number(value) => recorder.output("y", value),
            Part::Truth(condition) => recorder.output_truth("y", condition),
        }
        let law = errors.take(TextLaw::new(&recorder.finish(), "law", &self.law))?;
        Some(Law { of: self, formulas, law })
    }
}

impl Block for Law {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let Self { of, formulas, law } = self;
        let inputs = &formulas.inputs;
        let names: Vec<&str> = inputs.iter().map(|(name, _)| name.as_str()).collect();
        let shape = given.common_shape(&names, &[])?;
        let dimension = formulas.dimension(0, &of.law, given, LawParameters(&of.parameters))?;
        let y = if formulas.is_truth(0) { PortType::boolean() } else { PortType::UNKNOWN.of(dimension) };
        let mut interface = inputs.iter().fold(Interface::new(), |interface, (name, is_truth)| {
            interface.input(if *is_truth { Input::boolean(name) } else { Input::real(name) })
        });
        interface = interface.output(Output::like("y", y.shaped(shape)));
        law.fits(shape.len())?;
        interface = law.declare(interface, shape.len(), &of.law);
        Ok(if inputs.is_empty() { interface.constant() } else { interface })
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| self.law.record(l, i, 0, 0).outputs[0]);
        true
    }

    fn no_value(&self, failure: &Failure, _c: &Context) -> Option<String> {
        Some(no_value(failure, &self.of.law))
    }
}

#[cfg(test)]
#[path = "expression_tests.rs"]
mod tests;
