//! Formulas in texts, over inputs and parameters.

use blocksim_block::{Given, InterfaceError, MOST_PORTS, ParamError, ParamErrors};
use blocksim_law::{Condition, Recorder};
use blocksim_signal::{Dimension, Formula, NodeKind};

use super::{LawParameters, Part, constants, in_text, name_fits, record};

/// Formulas with the inputs that they have in common: every name that is not a parameter.
#[derive(Debug, Clone)]
pub(crate) struct Formulas {
    all: Vec<Text>,
    /// Names of the inputs in the order of the texts, and whether they are true or false.
    pub inputs: Vec<(String, bool)>,
}

#[derive(Debug, Clone)]
struct Text {
    formula: Formula,
    /// The value of each node that never changes.
    constants: Vec<Option<f64>>,
    /// Where the text begins among all.
    begin: usize,
}

/// What names stand for while a law is recorded.
pub(crate) type Known<'t, 'r> = Vec<(&'t str, Part<'r>)>;

impl Formulas {
    /// Reads texts, each with the name of its parameter; `outputs` are names that no input may have. All that is wrong is reported.
    pub fn read(
        texts: &[(String, &str)],
        parameters: LawParameters,
        outputs: &[&str],
        errors: &mut ParamErrors,
    ) -> Option<Self> {
        let mut read = |names: &[&str]| -> Option<Vec<Formula>> {
            let parse =
                |(param, text): &(String, &str)| Formula::parse(text, names).map_err(|e| in_text(param, e));
            // All of them are read, also behind one that cannot be.
            let formulas: Vec<Option<Formula>> = texts.iter().map(|text| errors.take(parse(text))).collect();
            formulas.into_iter().collect()
        };
        let first = read(&parameters.names())?;
        // A word that is an input in one place is no unit in another: both `m` of `m * a + 2 N/kg * m` are the input.
        let words = first.iter().flat_map(Formula::names).map(|(name, _)| name);
        let formulas = read(&parameters.names().into_iter().chain(words).collect::<Vec<_>>())?;
        let used: Vec<&str> = formulas.iter().flat_map(Formula::names).map(|(name, _)| name).collect();
        parameters.are_used(&used, errors);
        let mut inputs: Vec<(String, bool)> = Vec::new();
        for (formula, (param, _)) in formulas.iter().zip(texts) {
            for (name, is_truth) in formula.names() {
                let known = match parameters.0.get(name) {
                    Some(value) => Some((value.0.as_bool().is_some(), format!("parameters.{name}"))),
                    None => {
                        let input = inputs.iter().find(|(input, _)| input == name);
                        input.map(|(_, truth)| (*truth, param.clone()))
                    }
                };
                match known {
                    Some((truth, guilty)) if truth != is_truth => {
                        let word = |truth| if truth { "true or false" } else { "a number" };
                        let message =
                            format!("`{name}` is {}, but the law needs {}", word(truth), word(is_truth));
                        errors.add(ParamError::new(guilty, message));
                    }
                    Some(_) => {}
                    None => {
                        errors.take(name_fits(param, name));
                        if outputs.contains(&name) {
                            let message = format!("an input cannot have the name of the output, `{name}`");
                            let error = ParamError::new(param, message);
                            errors.add(
                                error.help("write another name, such as u1; the law is the value itself"),
                            );
                        }
                        inputs.push((name.to_owned(), is_truth));
                    }
                }
            }
        }
        if let (true, Some((param, _))) = (inputs.len() > MOST_PORTS, texts.first()) {
            let message = format!("there are {} inputs, but at most {MOST_PORTS} are possible", inputs.len());
            errors.add(ParamError::new(param, message).help("pass vectors"));
        }
        if !errors.is_empty() {
            return None;
        }
        let mut begin = 0;
        let text = |(formula, (_, text)): (Formula, &(String, &str))| {
            let made = Text { constants: constants(&formula, parameters), formula, begin };
            // A line for each.
            begin += text.len() + 1;
            made
        };
        Some(Self { all: formulas.into_iter().zip(texts).map(text).collect(), inputs })
    }

    /// Whether a formula is true or false rather than a number.
    pub fn is_truth(&self, i: usize) -> bool {
        self.all[i].formula.is_truth()
    }

    /// The formula that a byte of the lines of all belongs to, and where that begins.
    pub fn line_of(&self, byte: usize) -> (usize, usize) {
        let line = self.all.iter().rposition(|text| text.begin <= byte).unwrap_or(0);
        (line, self.all.get(line).map_or(0, |text| text.begin))
    }

    /// Adds inputs and parameters to a law.
    pub fn known<'t, 'r>(&'t self, recorder: &'r Recorder, parameters: LawParameters<'t>) -> Known<'t, 'r> {
        let input = |(name, is_truth): &'t (String, bool)| {
            let value = recorder.input(name);
            let part = if *is_truth { Part::Truth(Condition::of(value)) } else { Part::Number(value) };
            (name.as_str(), part)
        };
        let mut known: Known = self.inputs.iter().map(input).collect();
        known.extend(parameters.names().into_iter().filter_map(|name| {
            match (parameters.number(name), parameters.truth(name)) {
                (Some(value), _) => Some((name, Part::Number(recorder.parameter(name, value)))),
                (None, Some(truth)) => Some((name, Part::Truth(recorder.fixed(truth)))),
                (None, None) => None,
            }
        }));
        known
    }

    /// Records a formula.
    pub fn record<'r>(&self, i: usize, recorder: &'r Recorder, known: &Known<'_, 'r>) -> Part<'r> {
        let Text { formula, constants, begin } = &self.all[i];
        let find = |word: &str| known.iter().find(|(name, _)| *name == word).map(|(_, part)| *part);
        record(formula, recorder, &find, &|node| constants[node], *begin)
    }

    /// The dimension of a formula; nothing where it does not follow from those that are known.
    ///
    /// # Errors
    /// What does not fit, with the inputs that are part of it.
    pub fn dimension(
        &self,
        i: usize,
        text: &str,
        given: &Given,
        parameters: LawParameters,
    ) -> Result<Option<Dimension>, InterfaceError> {
        let Text { formula, constants, .. } = &self.all[i];
        let of = |name: &str| match parameters.0.contains_key(name) {
            true => parameters.dimension(name),
            false => given.input(name).and_then(|input| input.dimension),
        };
        formula.dimension(&of, &|node| constants[node]).map_err(|error| {
            let part = text.get(error.span.clone()).unwrap_or(text);
            let guilty: Vec<&str> = formula
                .nodes()
                .iter()
                .filter(|node| error.span.start <= node.span.start && node.span.end <= error.span.end)
                .filter_map(|node| match &node.kind {
                    NodeKind::Name(name) => self.inputs.iter().find(|(input, _)| input == name),
                    _ => None,
                })
                .map(|(name, _)| name.as_str())
                .collect();
            let wrong = InterfaceError::units(&guilty, format!("{} in `{part}`", error.message));
            match error.help {
                Some(help) => wrong.help(help),
                None => wrong,
            }
        })
    }
}
