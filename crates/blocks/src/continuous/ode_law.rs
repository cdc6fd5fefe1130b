//! The text of a system of equations: rates of states and definitions.

use std::collections::BTreeMap;
use std::ops::Range;

use blocksim_block::{MOST_PORTS, ParamError, ParamErrors, ParamValue, count};
use blocksim_law::{Condition, Recorder};
use blocksim_signal::{Dimension, ExprError, Formula, NodeKind, closest};

use crate::laws::{LawParameters, Part, TextLaw, constants, in_text, name_fits, record};

/// One equation.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    /// The name in front of `'` or `=`.
    pub name: String,
    pub formula: Formula,
    /// Where the formula begins in the text.
    pub at: usize,
    /// The value of each node that never changes.
    pub constants: Vec<Option<f64>>,
    /// Whether it depends on an input.
    pub reads: bool,
}

/// What the text means.
#[derive(Debug, Clone)]
pub(super) struct System {
    /// Rates of states, in the order of the text.
    pub rates: Vec<Equation>,
    /// What is defined, in the order of the text.
    pub definitions: Vec<Equation>,
    /// Names of the inputs, and whether they are true or false.
    pub inputs: Vec<(String, bool)>,
    /// The definitions that depend on states alone and do not jump, by number, and their program.
    pub free: Vec<usize>,
    pub of_free: TextLaw,
    /// The other definitions, by number, and their program, which gives the rates behind them.
    pub bound: Vec<usize>,
    pub of_bound: TextLaw,
}

/// A line of the text: `name' = formula` or `name = formula`.
struct Line<'t> {
    name: &'t str,
    is_rate: bool,
    name_at: Range<usize>,
    formula: &'t str,
    at: usize,
}

const FORM: &str =
    "write the rate of a state as `x' = -2*x + u`, and what follows from states and inputs as `y = 3*x`";

fn wrong(span: Range<usize>, message: impl Into<String>) -> ParamError {
    ParamError::new("law", message).within(span)
}

/// The pieces of the text between line ends and semicolons that are not within parentheses, with where they begin.
fn pieces(text: &str) -> Vec<(usize, &str)> {
    let (mut depth, mut start, mut pieces) = (0_usize, 0, Vec::new());
    for (at, sign) in text.char_indices() {
        match sign {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '\n' | ';' if depth == 0 => {
                pieces.push((start, &text[start..at]));
                start = at + 1;
            }
            _ => {}
        }
    }
    pieces.push((start, &text[start..]));
    pieces.retain(|(_, piece)| !piece.trim().is_empty());
    pieces
}

/// Where the `=` of an equation is: the first that is not part of a comparison.
fn equals(piece: &str) -> Option<usize> {
    let bytes = piece.as_bytes();
    let is = |at: usize, signs: &[u8]| bytes.get(at).is_some_and(|sign| signs.contains(sign));
    (0..bytes.len()).find(|at| bytes[*at] == b'=' && !is(at + 1, b"=") && (*at == 0 || !is(at - 1, b"=<>!")))
}

fn line(at: usize, piece: &str) -> Result<Line<'_>, ParamError> {
    let indent = piece.len() - piece.trim_start().len();
    let whole = at + indent..at + piece.trim_end().len();
    let Some(equals) = equals(piece) else {
        return Err(wrong(whole, format!("`{}` is not an equation", piece.trim())).help(FORM));
    };
    let left = piece[..equals].trim();
    let (name, is_rate) = match left.strip_suffix('\'') {
        Some(name) => (name.trim_end(), true),
        None => (left, false),
    };
    let name_at = at + indent..at + indent + left.len();
    if let Err(error) = name_fits("law", name) {
        let error = error.within(name_at);
        return Err(if name.contains(|sign: char| !sign.is_ascii_alphanumeric() && sign != '_') {
            error.help(FORM)
        } else {
            error
        });
    }
    let formula = &piece[equals + 1..];
    if formula.trim().is_empty() {
        return Err(wrong(whole, format!("nothing stands behind the `=` of `{left}`")).help(FORM));
    }
    Ok(Line { name, is_rate, name_at, formula, at: at + equals + 1 })
}

/// The same mistake in the whole text.
fn moved(error: ExprError, at: usize) -> ParamError {
    let span = error.span.start + at..error.span.end + at;
    in_text("law", ExprError { span, ..error })
}

impl System {
    /// Reads the text; all that is wrong is reported with its place.
    pub fn read(text: &str, given: &BTreeMap<String, ParamValue>, errors: &mut ParamErrors) -> Option<Self> {
        let parameters = LawParameters(given);
        let lines: Vec<Line> =
            pieces(text).into_iter().filter_map(|(at, piece)| errors.take(line(at, piece))).collect();
        if !errors.is_empty() {
            return None;
        }
        if !lines.iter().any(|line| line.is_rate) {
            errors.add(ParamError::new("law", "there is no equation for the rate of a state").help(FORM));
        }
        errors.take(count("law", lines.len(), 0, MOST_PORTS));
        for (i, Line { name, name_at, .. }) in lines.iter().enumerate() {
            if lines[..i].iter().any(|before| before.name == *name) {
                let error = wrong(name_at.clone(), format!("there are two equations for `{name}`"));
                errors.add(error.help("give one of them another name; a state is an output by itself"));
            }
            if given.contains_key(*name) {
                let error = wrong(name_at.clone(), format!("`{name}` is a parameter as well"));
                errors.add(error.help("give one of them another name"));
            }
        }
        let own: Vec<&str> =
            parameters.names().into_iter().chain(lines.iter().map(|line| line.name)).collect();
        let mut read = |names: &[&str]| {
            let formula =
                |line: &Line| Formula::parse(line.formula, names).map_err(|error| moved(error, line.at));
            // All of them are read, also behind one that cannot be.
            let formulas: Vec<Option<Formula>> =
                lines.iter().map(|line| errors.take(formula(line))).collect();
            formulas.into_iter().collect::<Option<Vec<Formula>>>()
        };
        let first = read(&own)?;
        // A word that is an input in one place is no unit in another.
        let words = first.iter().flat_map(|formula| formula.names()).map(|(name, _)| name);
        let formulas = read(&own.iter().copied().chain(words).collect::<Vec<_>>())?;
        let inputs = inputs(&lines, &formulas, parameters, errors);
        let used: Vec<&str> =
            formulas.iter().flat_map(|formula| formula.names()).map(|(name, _)| name).collect();
        parameters.are_used(&used, errors);
        if !errors.is_empty() {
            return None;
        }
        errors.take(Self::of(text, &lines, formulas, inputs, parameters))
    }

    fn of(
        text: &str,
        lines: &[Line],
        formulas: Vec<Formula>,
        inputs: Vec<(String, bool)>,
        parameters: LawParameters,
    ) -> Result<Self, ParamError> {
        let (mut rates, mut definitions): (Vec<Equation>, Vec<Equation>) = (Vec::new(), Vec::new());
        for (line, formula) in lines.iter().zip(formulas) {
            let reads = formula.names().into_iter().any(|(name, _)| {
                inputs.iter().any(|(input, _)| input == name)
                    || definitions.iter().any(|definition| definition.name == name && definition.reads)
            });
            let constants = constants(&formula, parameters);
            let equation = Equation { name: line.name.to_owned(), formula, at: line.at, constants, reads };
            if line.is_rate { rates.push(equation) } else { definitions.push(equation) }
        }
        let all: Vec<usize> = (0..definitions.len()).collect();
        let build = |wanted: &[usize], with_rates: bool| {
            let recorder = Recorder::new();
            let mut known: Vec<(String, Part)> = Vec::new();
            for (name, is_truth) in &inputs {
                let value = recorder.input(name);
                let part = if *is_truth { Part::Truth(Condition::of(value)) } else { Part::Number(value) };
                known.push((name.clone(), part));
            }
            for name in parameters.names() {
                known.push((
                    name.to_owned(),
                    match (parameters.number(name), parameters.truth(name)) {
                        (Some(value), _) => Part::Number(recorder.parameter(name, value)),
                        (None, truth) => Part::Truth(recorder.fixed(truth == Some(true))),
                    },
                ));
            }
            let states: Vec<_> = rates.iter().map(|rate| recorder.state(&rate.name, 0.0)).collect();
            known.extend(rates.iter().zip(&states).map(|(rate, x)| (rate.name.clone(), Part::Number(*x))));
            // Only what is needed: what jumps elsewhere is no business of this program.
            let mut names: Vec<&str> = Vec::new();
            if with_rates {
                names.extend(rates.iter().flat_map(|rate| rate.formula.names()).map(|(name, _)| name));
            }
            let mut needed = vec![false; definitions.len()];
            for (i, definition) in definitions.iter().enumerate().rev() {
                needed[i] = wanted.contains(&i) || names.contains(&definition.name.as_str());
                if needed[i] {
                    names.extend(definition.formula.names().into_iter().map(|(name, _)| name));
                }
            }
            for (i, definition) in definitions.iter().enumerate().filter(|(i, _)| needed[*i]) {
                let part = part_of(definition, &recorder, &known);
                if wanted.contains(&i) {
                    match part {
                        Part::Number(value) => recorder.output(&definition.name, value),
                        Part::Truth(condition) => recorder.output_truth(&definition.name, condition),
                    }
                }
                known.push((definition.name.clone(), part));
            }
            if with_rates {
                for (rate, x) in rates.iter().zip(&states) {
                    if let Part::Number(value) = part_of(rate, &recorder, &known) {
                        recorder.derive(*x, value);
                    }
                }
            }
            recorder.finish().optimised()
        };
        // What jumps is chosen with all inputs known.
        let free: Vec<usize> = all
            .iter()
            .copied()
            .filter(|i| !definitions[*i].reads && build(&[*i], false).modes.is_empty())
            .collect();
        let bound: Vec<usize> = all.iter().copied().filter(|i| !free.contains(i)).collect();
        let of_free = TextLaw::new(&build(&free, false), "law", text)?;
        let of_bound = TextLaw::new(&build(&bound, true), "law", text)?;
        Ok(Self { rates, definitions, inputs, free, of_free, bound, of_bound })
    }

    /// The dimensions of states and of definitions, as far as they follow from those of inputs, parameters and start values.
    ///
    /// # Errors
    /// The place of what does not fit, in the text, with the reason.
    pub fn dimensions(
        &self,
        start: &dyn Fn(&str) -> Option<Dimension>,
        input: &dyn Fn(&str) -> Option<Dimension>,
        parameters: LawParameters,
    ) -> Result<Dimensions, ParamError> {
        let second = super::units::SECOND;
        let mut known = Dimensions {
            states: self.rates.iter().map(|rate| start(&rate.name)).collect(),
            definitions: vec![None; self.definitions.len()],
        };
        // Each round finds at least one more dimension, or it is the last.
        for _ in 0..=self.rates.len() + self.definitions.len() {
            let before = known.clone();
            for (i, definition) in self.definitions.iter().enumerate() {
                known.definitions[i] = self.dimension_of(definition, &known, input, parameters)?;
            }
            for (i, rate) in self.rates.iter().enumerate() {
                let Some(dimension) = self.dimension_of(rate, &known, input, parameters)? else { continue };
                let own = dimension.times(second);
                match known.states[i] {
                    // Bare numbers say nothing of units.
                    None if dimension.is_open() || dimension == Dimension::NONE => {
                        known.states[i] = Some(Dimension::OPEN);
                    }
                    None => known.states[i] = Some(own),
                    Some(state) if state.is_open() || dimension.is_open() || state.compatible(own) => {}
                    Some(state) => {
                        let Equation { name, formula, at, .. } = rate;
                        let message = format!(
                            "the rate of `{name}` is in {dimension}, but `{name}` is in {state}, so it must be in {}",
                            state.over(second)
                        );
                        let text = formula.text();
                        let indent = text.len() - text.trim_start().len();
                        return Err(wrong(at + indent..at + text.trim_end().len(), message)
                            .help("correct the equation, or the unit of the start value or of a parameter"));
                    }
                }
            }
            if known == before {
                break;
            }
        }
        Ok(known)
    }

    fn dimension_of(
        &self,
        equation: &Equation,
        known: &Dimensions,
        input: &dyn Fn(&str) -> Option<Dimension>,
        parameters: LawParameters,
    ) -> Result<Option<Dimension>, ParamError> {
        let of = |name: &str| {
            if let Some(i) = self.rates.iter().position(|rate| rate.name == name) {
                return known.states[i];
            }
            if let Some(i) = self.definitions.iter().position(|definition| definition.name == name) {
                return known.definitions[i];
            }
            if parameters.0.contains_key(name) { parameters.dimension(name) } else { input(name) }
        };
        let dimension = equation.formula.dimension(&of, &|node| equation.constants[node]);
        dimension.map_err(|error| moved(error, equation.at))
    }
}

/// Records an equation, of which these names are known.
fn part_of<'r>(equation: &Equation, recorder: &'r Recorder, known: &[(String, Part<'r>)]) -> Part<'r> {
    let find = |word: &str| known.iter().find(|(name, _)| name == word).map(|(_, part)| *part);
    record(&equation.formula, recorder, &find, &|node| equation.constants[node], equation.at)
}

/// Dimensions of states and definitions, where they are known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dimensions {
    pub states: Vec<Option<Dimension>>,
    pub definitions: Vec<Option<Dimension>>,
}

/// The names that are neither states, definitions nor parameters, in the order of the text.
fn inputs(
    lines: &[Line],
    formulas: &[Formula],
    parameters: LawParameters,
    errors: &mut ParamErrors,
) -> Vec<(String, bool)> {
    let mut inputs: Vec<(String, bool)> = Vec::new();
    for (i, (line, formula)) in lines.iter().zip(formulas).enumerate() {
        let place = |name: &str| {
            let is =
                |node: &&blocksim_signal::Node| matches!(&node.kind, NodeKind::Name(word) if word == name);
            let span = formula.nodes().iter().find(is).map_or(0..0, |node| node.span.clone());
            span.start + line.at..span.end + line.at
        };
        if line.is_rate && formula.is_truth() {
            let message = format!("the rate of `{}` is true or false, but must be a number", line.name);
            errors.add(wrong(line.name_at.clone(), message).help("write if(..., 1, 0)"));
        }
        for (name, is_truth) in formula.names() {
            let kinds = |is: bool| if is { "true or false" } else { "a number" };
            let mut is_other = |is: bool| {
                let message = format!("`{name}` is {}, but {} is needed here", kinds(is), kinds(is_truth));
                errors.add(wrong(place(name), message));
            };
            if let Some(defined) = lines.iter().position(|line| line.name == name) {
                let is = !lines[defined].is_rate && formulas[defined].is_truth();
                if !lines[defined].is_rate && defined >= i && !line.is_rate {
                    let error = wrong(place(name), format!("`{name}` is used before it is defined"));
                    errors.add(error.help("move its equation up; a loop of definitions has no order"));
                } else if is != is_truth {
                    is_other(is);
                }
                continue;
            }
            if let Some(value) = parameters.0.get(name) {
                if value.0.as_bool().is_some() != is_truth {
                    is_other(value.0.as_bool().is_some());
                }
                continue;
            }
            match inputs.iter().find(|(known, _)| known == name) {
                Some((_, known)) if *known != is_truth => is_other(*known),
                Some(_) => {}
                None => {
                    errors.take(name_fits("law", name).map_err(|error| error.within(place(name))));
                    inputs.push((name.to_owned(), is_truth));
                }
            }
        }
    }
    inputs
}

/// The name among these that is meant by another.
pub(super) fn meant<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    closest(name, names.collect::<Vec<_>>())
}
