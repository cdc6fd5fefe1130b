use std::collections::BTreeMap;

use blocksim_law::Recorder;

use crate::laws::{Formulas, LawParameters, Part, TextLaw, name_fits, no_value};
use crate::math::elements::numbered;
use blocksim_block::prelude::*;

/// Chooses one of several conditional subsystems: the one of the first condition that holds.
///
/// Output `y1` is true while the first condition holds, `y2` while the second does and the first does not, and so on; `else` is true
/// while none holds. So exactly one output is true at any time. Connect each to the input `enable` of a subsystem (`enable: Held` or
/// `enable: Reset`), and the outputs of these subsystems to a `Merge`. An output that is not connected chooses nothing.
///
/// The conditions are texts as in an `Expression`, and every name that is not a parameter is an input, which is a scalar. Conditions are
/// chosen where the solver stops, and it stops where a comparison may change. A condition behind one that holds need not have a
/// value: with `"u == 0"` before `"1/u > 3"` nothing is divided by zero.
///
/// ```ron
/// IfElse(conditions: ["u < low", "u > 24"], parameters: { "low": 18 })
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Routing", symbol = Lines("if", "else"), builds = Choice)]
pub struct IfElse {
    /// Conditions in the order in which they count.
    #[block(not_empty, empty = "give a list of conditions, such as [\"u > 0\"]")]
    pub conditions: Vec<String>,
    /// Names with numbers, which may have units, or truth values.
    #[block(default = BTreeMap::new())]
    pub parameters: BTreeMap<String, ParamValue>,
}

/// What the texts mean.
#[derive(Debug, Clone)]
pub struct Choice {
    parameters: BTreeMap<String, ParamValue>,
    /// The conditions; one that is a mere name says that this is true or false.
    texts: Vec<String>,
    formulas: Formulas,
    law: TextLaw,
}

impl Choice {
    /// What the places of the law are in.
    fn text(&self) -> String {
        self.texts.join("\n")
    }
}

/// Most conditions.
const MOST: usize = 1000;

/// Names of the outputs for so many conditions.
fn outputs(conditions: usize) -> Vec<String> {
    let mut names = if conditions == 1 { vec!["y1".to_owned()] } else { numbered("y", conditions) };
    names.push("else".to_owned());
    names
}

impl IfElse {
    fn validate(&self, errors: &mut ParamErrors) {
        errors.take(count("conditions", self.conditions.len(), 1, MOST));
        LawParameters(&self.parameters).validate(errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Choice> {
        let parameters = LawParameters(&self.parameters);
        let param = |i: usize| format!("conditions[{i}]");
        let is_name = |text: &str| name_fits("conditions", text).is_ok();
        let texts: Vec<String> = self
            .conditions
            .iter()
            .map(|text| if is_name(text.trim()) { format!("and({text}, {text})") } else { text.clone() })
            .collect();
        let named: Vec<(String, &str)> =
            texts.iter().enumerate().map(|(i, text)| (param(i), text.as_str())).collect();
        let outputs = outputs(texts.len());
        let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
        let formulas = Formulas::read(&named, parameters, &outputs, errors)?;
        for (i, text) in self.conditions.iter().enumerate().filter(|(i, _)| !formulas.is_truth(*i)) {
            let message = format!("`{text}` is a number, but must be true or false");
            let help = "compare it, as in `u > 0`; a truth value is its own condition";
            errors.add(ParamError::new(param(i), message).help(help));
        }
        let recorder = Recorder::new();
        let known = formulas.known(&recorder, parameters);
        let mut none_before = recorder.fixed(true);
        for (i, name) in outputs.iter().take(texts.len()).enumerate() {
            recorder.enter(none_before);
            // One that is a number has been reported.
            let Part::Truth(holds) = formulas.record(i, &recorder, &known) else { return None };
            recorder.leave();
            recorder.output_truth(name, none_before.and(holds));
            none_before = none_before.and(!holds);
        }
        recorder.output_truth("else", none_before);
        let law = TextLaw::new(&recorder.finish(), "conditions", &texts.join("\n"));
        let law = errors.take(law.map_err(|mut error| {
            if let Some(span) = &mut error.span {
                let (line, begin) = formulas.line_of(span.start);
                *span = span.start - begin..span.end - begin;
                error.param = param(line);
            }
            error
        }))?;
        Some(Choice { parameters: self.parameters, texts, formulas, law })
    }
}

impl Block for Choice {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let Self { parameters, texts, formulas, law } = self;
        for (i, text) in texts.iter().enumerate() {
            formulas.dimension(i, text, given, LawParameters(parameters))?;
        }
        let interface = formulas.inputs.iter().fold(Interface::new(), |interface, (name, is_truth)| {
            interface.input(if *is_truth { Input::boolean(name) } else { Input::real(name) }.scalar())
        });
        let interface = outputs(texts.len())
            .iter()
            .fold(interface, |interface, name| interface.output(Output::like(name, PortType::boolean())));
        Ok(law.declare(interface, 1, &self.text()))
    }

    fn law(&self, l: &Recording) -> bool {
        let outputs = self.law.record(l, 0, 0, 0).outputs;
        outputs.iter().enumerate().for_each(|(port, value)| l.set(port, 0, *value));
        true
    }

    fn no_value(&self, failure: &Failure, _c: &Context) -> Option<String> {
        Some(no_value(failure, &self.text()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::given;
    use blocksim_block::testing::Bench;

    fn choice(conditions: &[&str]) -> IfElse {
        let conditions = conditions.iter().map(ToString::to_string).collect();
        IfElse { conditions, parameters: BTreeMap::new() }
    }

    #[test]
    fn the_first_condition_that_holds_is_chosen() {
        let mut bench = Bench::new(choice(&["u < 1", "u < 2", "on"]));
        let names: Vec<_> = bench.interface.outputs.iter().map(|output| output.name.clone()).collect();
        assert_eq!(names, ["y1", "y2", "y3", "else"]);
        for (u, on, chosen) in [(0.5, 1.0, 0), (1.5, 1.0, 1), (2.5, 1.0, 2), (2.5, 0.0, 3), (1.0, 0.0, 1)] {
            let y = bench.set(0, &[u]).set(1, &[on]).major();
            let expected: Vec<f64> = (0..4).map(|k| f64::from(k == chosen)).collect();
            assert_eq!(y, expected, "{u} {on}");
        }
        // Between major steps the choice is held, while the guards see the crossing.
        assert_eq!(bench.set(0, &[0.5]).minor(), [0.0, 1.0, 0.0, 0.0]);
        assert!(bench.guards()[0] < 0.0);
    }

    #[test]
    fn what_stands_behind_a_condition_that_holds_needs_no_value() {
        let mut bench = Bench::new(choice(&["u == 0", "1/u > 3"]));
        assert_eq!(bench.set(0, &[0.0]).major(), [1.0, 0.0, 0.0]);
        assert_eq!(bench.set(0, &[0.25]).major(), [0.0, 1.0, 0.0]);
        let mut bench = Bench::new(choice(&["1/u > 3"]));
        let failure = bench.set(0, &[0.0]).failure().unwrap();
        assert!(failure.starts_with("division by zero in `1/u`"), "{failure}");
    }

    #[test]
    fn conditions_that_make_no_sense_are_refused() {
        for (conditions, param) in [
            (&[][..], "conditions"),
            (&["u > 0", "u + 1"], "conditions[1]"),
            (&["u > 0", "u >"], "conditions[1]"),
            (&["u > 0", "not(u)"], "conditions[1]"),
            (&["y1 > 0"], "conditions[0]"),
            (&["u > 1/0", "u > 0"], "conditions[0]"),
        ] {
            assert_eq!(choice(conditions).try_build().unwrap_err()[0].param, param, "{conditions:?}");
        }
        let error = &choice(&["u > 0", "u > lnn(2)"]).try_build().unwrap_err()[0];
        assert_eq!((error.param.as_str(), error.span.clone()), ("conditions[1]", Some(4..7)));
    }

    #[test]
    fn units_must_fit_in_each_condition() {
        let block = choice(&["u > 1 V", "w > u"]).built();
        assert!(block.interface(&given(&[("u", "V"), ("w", "mV")], &[])).is_ok());
        let error = block.interface(&given(&[("u", "V"), ("w", "A")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports.len()), ("unit_mismatch", 2));
    }
}
