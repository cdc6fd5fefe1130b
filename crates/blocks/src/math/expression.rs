use std::collections::BTreeMap;

use blocksim_law::{Condition, Recorder};
use blocksim_signal::{Formula, NodeKind};

use crate::laws::{LawParameters, Part, Runner, constants, in_text, name_fits, record};
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
#[block(category = "Math", symbol = Value("law"))]
pub struct Expression {
    /// The law; its names are inputs or parameters.
    pub law: String,
    /// Names with numbers, which may have units, or truth values.
    #[block(default = BTreeMap::new())]
    pub parameters: BTreeMap<String, ParamValue>,
    /// What the text means.
    #[block(skip)]
    built: Option<Result<Built, ParamError>>,
}

/// What the text means.
#[derive(Debug, Clone)]
struct Built {
    formula: Formula,
    /// Names of the inputs, and whether they are true or false.
    inputs: Vec<(String, bool)>,
    /// The value of each node that never changes.
    constants: Vec<Option<f64>>,
    runner: Runner,
}

impl Expression {
    /// A law with parameters.
    pub fn new(law: &str, parameters: BTreeMap<String, ParamValue>) -> Self {
        let mut expression = Self { law: law.to_owned(), parameters, built: None };
        expression.built = Some(expression.build());
        expression
    }

    fn build(&self) -> Result<Built, ParamError> {
        let parameters = LawParameters(&self.parameters);
        parameters.check()?;
        let read = |names: &[&str]| Formula::parse(&self.law, names).map_err(|error| in_text("law", error));
        let first = read(&parameters.names())?;
        // A word that is an input in one place is no unit in another: both `m` of `m * a + 2 N/kg * m` are the input.
        let inputs = first.names().into_iter().map(|(name, _)| name);
        let formula = read(&parameters.names().into_iter().chain(inputs).collect::<Vec<_>>())?;
        let names = formula.names();
        parameters.are_used(&names.iter().map(|(name, _)| *name).collect::<Vec<_>>())?;
        let mut inputs = Vec::new();
        for (name, is_truth) in &names {
            let is_number = self.parameters.get(*name).map(|value| value.0.as_bool().is_none());
            match is_number {
                Some(is_number) if is_number == *is_truth => {
                    let (is, wanted) =
                        if is_number { ("a number", "true or false") } else { ("true or false", "a number") };
                    let message = format!("`{name}` is {is}, but the law needs {wanted}");
                    return Err(ParamError::new("parameters", message));
                }
                Some(_) => {}
                None => {
                    name_fits("law", name)?;
                    if *name == "y" {
                        return Err(ParamError::new(
                            "law",
                            "an input cannot have the name of the output, `y`",
                        )
                        .help("write another name, such as u1; the law is the value itself"));
                    }
                    inputs.push(((*name).to_owned(), *is_truth));
                }
            }
        }
        count("inputs", inputs.len(), 0, MOST_PORTS)
            .map_err(|error| ParamError { param: "law".into(), ..error })?;
        let constants = constants(&formula, parameters);
        let recorder = Recorder::new();
        let ports: Vec<(&str, Part)> = inputs
            .iter()
            .map(|(name, is_truth)| {
                let value = recorder.input(name);
                let part = if *is_truth { Part::Truth(Condition::of(value)) } else { Part::Number(value) };
                (name.as_str(), part)
            })
            .collect();
        let given: Vec<(&str, Part)> = parameters
            .names()
            .into_iter()
            .filter_map(|name| match (parameters.number(name), parameters.truth(name)) {
                (Some(value), _) => Some((name, Part::Number(recorder.parameter(name, value)))),
                (None, Some(truth)) => Some((name, Part::Truth(recorder.fixed(truth)))),
                (None, None) => None,
            })
            .collect();
        let known = |word: &str| {
            let found = given.iter().chain(&ports).find(|(name, _)| *name == word);
            found.map(|(_, part)| *part)
        };
        match record(&formula, &recorder, &known, &|node| constants[node], 0) {
            Part::Number(value) => recorder.output("y", value),
            Part::Truth(condition) => recorder.output_truth("y", condition),
        }
        let runner = Runner::new(&recorder.finish(), "law", &self.law)?;
        Ok(Built { inputs, constants, runner, formula })
    }

    fn built(&self) -> Option<&Built> {
        self.built.as_ref().and_then(|built| built.as_ref().ok())
    }
}

impl Block for Expression {
    fn load(&mut self, _files: &dyn Files) -> Result<(), LoadError> {
        self.built = Some(self.build());
        Ok(())
    }

    fn check(&self) -> Result<(), ParamError> {
        match &self.built {
            Some(built) => built.as_ref().map(|_| ()).map_err(Clone::clone),
            None => self.build().map(|_| ()),
        }
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let Some(Built { formula, inputs, constants, runner }) = self.built() else {
            return Ok(Interface::new());
        };
        let names: Vec<&str> = inputs.iter().map(|(name, _)| name.as_str()).collect();
        let shape = given.common_shape(&names, &[])?;
        let parameters = LawParameters(&self.parameters);
        let of = |name: &str| match self.parameters.contains_key(name) {
            true => parameters.dimension(name),
            false => given.input(name).and_then(|input| input.dimension),
        };
        let dimension = formula.dimension(&of, &|node| constants[node]).map_err(|error| {
            let part = self.law.get(error.span.clone()).unwrap_or(&self.law);
            let guilty: Vec<&str> = formula
                .nodes()
                .iter()
                .filter(|node| error.span.start <= node.span.start && node.span.end <= error.span.end)
                .filter_map(|node| match &node.kind {
                    NodeKind::Name(name) => names.iter().find(|input| *input == name).copied(),
                    _ => None,
                })
                .collect();
            let wrong = InterfaceError::units(&guilty, format!("{} in `{part}`", error.message));
            match error.help {
                Some(help) => wrong.help(help),
                None => wrong,
            }
        })?;
        let y = if formula.is_truth() { PortType::boolean() } else { PortType::UNKNOWN.of(dimension) };
        let mut interface = inputs.iter().fold(Interface::new(), |interface, (name, is_truth)| {
            interface.input(if *is_truth { Input::boolean(name) } else { Input::real(name) })
        });
        interface = interface.output(Output::like("y", y.shaped(shape)));
        interface = runner.declare(interface, shape.len(), &self.law);
        Ok(if inputs.is_empty() { interface.constant() } else { interface })
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(vec![0.0; self.built().map_or(0, |built| built.runner.numbers())])
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        if let Some(built) = self.built() {
            built.runner.settle(c, d, c.output(0).len());
        }
    }

    fn outputs(&self, _group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let (Some(built), Some(space)) = (self.built(), w.get::<Vec<f64>>()) else { return };
        for (i, y) in y.iter_mut().enumerate() {
            if let Some(failure) = built.runner.values(c, i, space, |_, value| *y = value) {
                c.fail(built.runner.reason(&failure, &self.law));
            }
        }
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let (Some(built), Some(space)) = (self.built(), w.get::<Vec<f64>>()) else { return };
        built.runner.guards(c, g, c.output(0).len(), space);
    }
}

#[cfg(test)]
#[path = "expression_tests.rs"]
mod tests;
