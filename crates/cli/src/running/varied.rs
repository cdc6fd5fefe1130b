//! A model with other values of a parameter.

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Found, Sources, Target, WrittenUnit, find, targets};
use blocksim_signal::{Dimension, Unit};
use blocksim_sim::DISTANCES;

use super::solver;
use crate::args::model::{ModelArgs, SolverArgs};
use crate::args::sweep::number;
use crate::commands::params::table::unknown;
use crate::disk::{Disk, readable};
use crate::failure::Failure;
use crate::loaded::{Loaded, load};
use crate::trust::Purpose;

/// Distance over which a parameter is varied, as a part of it, or in its SI unit where it is zero.
const DISTANCE: f64 = 1e-3;

/// A parameter and its value.
pub struct Parameter {
    /// As for `--set`.
    pub name: String,
    /// In which its values are written.
    pub unit: Unit,
    /// Whether its values are written with the unit.
    says_unit: bool,
    /// In SI.
    pub value: f64,
    /// Over which it is varied, in SI.
    pub distance: f64,
}

/// A parameter by its name, with the value that it has in the model or that the command line gives it.
///
/// # Errors
/// An unknown name, several parameters of this name, or a value that is not a number.
pub fn parameter(model: &ModelArgs, name: &str) -> Result<Parameter, Failure> {
    readable(&model.model)?;
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, _) = targets(&sources, &model.model);
    let target: &Target = match find(&all, name) {
        Found::One(target) => target,
        Found::Several(several) => {
            let some: Vec<&str> = several.iter().take(5).map(|target| target.name.as_str()).collect();
            let said = format!("`{name}` holds several parameters");
            return Err(Failure::usage(said).help(format!("name one, such as {}", some.join(", "))));
        }
        Found::Nothing(help) => return Err(unknown(&model.model, name, &help)),
    };
    let no_number = |what: &str| {
        Failure::usage(format!("`{name}` is {what}, and there is no derivative by that"))
            .help("name a parameter that is a number; `blocksim params list MODEL` lists all")
    };
    let bare = match &target.written_unit {
        WrittenUnit::One(unit) => Some(unit.clone()),
        _ => None,
    };
    let given =
        model.set.iter().rev().find_map(|set| set.split_once('=').filter(|(known, _)| known.trim() == name));
    let (value, unit, says_unit) = match given {
        Some((_, text)) => {
            let text = text.trim().trim_matches('"');
            let (value, unit) = number(text).map_err(|_| no_number(&format!("`{text}`")))?;
            let unit = if unit.is_empty() { None } else { Unit::parse(unit).ok() };
            match unit.or(bare) {
                Some(unit) => (unit.to_si(value), unit, true),
                None => (value, Unit::si(Dimension::NONE), false),
            }
        }
        None => {
            let quantity = target.value.as_ref().and_then(|value| value.as_number());
            let quantity = quantity.ok_or_else(|| no_number(&format!("`{}`", target.written)))?;
            match (bare, &target.written_unit) {
                (Some(unit), _) => (quantity.value, unit, true),
                (None, WrittenUnit::Si) => (quantity.value, Unit::si(Dimension::NONE), false),
                _ => (quantity.value, Unit::si(quantity.dimension), true),
            }
        }
    };
    if !value.is_finite() {
        return Err(no_number("not finite"));
    }
    Ok(Parameter { name: name.to_owned(), unit, says_unit, value, distance: distance(value) })
}

fn distance(value: f64) -> f64 {
    if value == 0.0 { DISTANCE } else { DISTANCE * value.abs() }
}

impl Parameter {
    /// Takes another value, in SI.
    pub fn set(&mut self, value: f64) {
        self.value = value;
        self.distance = distance(value);
    }

    /// As `--set` takes it.
    pub fn written(&self, value: f64) -> String {
        match self.says_unit && self.unit.to_string() != "1" {
            true => format!("{}={} {}", self.name, self.unit.from_si(value), self.unit),
            false => format!("{}={}", self.name, self.unit.from_si(value)),
        }
    }

    /// Its SI unit in one of its own.
    pub fn scale(&self) -> f64 {
        self.unit.to_si(1.0) - self.unit.to_si(0.0)
    }

    /// The unit of a derivative: `V/rad`.
    pub fn per(&self, unit: &Unit) -> String {
        let (unit, own) = (unit.to_string(), self.unit.to_string());
        match (unit.as_str(), own.strip_prefix("1/")) {
            (unit, _) if own == "1" => unit.to_owned(),
            ("1", Some(own)) => own.to_owned(),
            (unit, Some(own)) => format!("{unit}*{own}"),
            (unit, None) if own.contains(['/', '*']) => format!("{unit}/({own})"),
            (unit, None) => format!("{unit}/{own}"),
        }
    }
}

/// The model with the values of the parameter around its own.
///
/// # Errors
/// If the model cannot be run with one of them.
pub fn variants(
    model: &ModelArgs,
    solver: &SolverArgs,
    parameter: &Parameter,
) -> Result<[Schedule; 5], Failure> {
    let one = |part: f64| -> Result<Schedule, Failure> {
        // The value itself may be an expression, which stays.
        let set = (part != 0.0).then(|| parameter.written(parameter.value + part * parameter.distance));
        match with(model, solver, set)? {
            Ok(schedule) => Ok(schedule),
            Err(refused) => {
                let value = parameter.written(parameter.value + part * parameter.distance);
                Err(Failure::usage(format!("the model cannot be run with {value}: {refused}"))
                    .help("a derivative needs values on both sides: choose another value with --set"))
            }
        }
    };
    let [a, b, c, d, e] = DISTANCES.map(one);
    Ok([a?, b?, c?, d?, e?])
}

/// The model with further values, or why it cannot be run with them.
///
/// # Errors
/// If the model cannot be read, or the options of the solver do not fit.
pub fn with(
    model: &ModelArgs,
    solver: &SolverArgs,
    set: impl IntoIterator<Item = String>,
) -> Result<Result<Schedule, String>, Failure> {
    let model = ModelArgs {
        model: model.model.clone(),
        set: model.set.iter().cloned().chain(set).collect(),
        plugins: model.plugins,
    };
    let mut loaded: Loaded = load(&model, Purpose::Run)?;
    let Some(mut schedule) = loaded.compiled.schedule.take() else { return Ok(Err(loaded.first_error())) };
    solver::apply(solver, &mut schedule.settings)?;
    Ok(Ok(schedule))
}
