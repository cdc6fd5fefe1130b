//! `blocksim identify parameters`: parameters of any model with which its runs come closest to a measurement.

use std::path::Path;

use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_diagram::SourceFile;
use blocksim_identify::{Fitted, IdentifyError, Model, Signal, Stopped, fit_signals};
use blocksim_recording::ALWAYS;
use blocksim_signal::{Kind, Unit};
use blocksim_sim::{Control, Course, SimError, course, sensitivity_on, tangent_on};
use nalgebra::{DMatrix, DVector};

use super::super::plot::open;
use super::parameters_report::{self as report, Found};
use crate::args::identify::ParametersArgs;
use crate::args::model::ModelArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::load;
use crate::running::blame::{failure, reason};
use crate::running::varied::{Parameter, parameter, variants, with};
use crate::running::{interrupt, solver};
use crate::signals::display::display_unit;
use crate::signals::measured::assignment;
use crate::signals::naming::fits;
use crate::signals::traces::mappings;
use crate::terminal::console::Console;
use crate::trust::Purpose;

/// Most rows of a signal that are compared; of more every second, third and so on is taken.
const ROWS: usize = 5000;
/// Intervals of a run where the times of the measurement are on no grid: this many for each row, at least and at most.
const PER_ROW: usize = 8;
const FEWEST: usize = 10_000;
const MOST: usize = 40_000;
/// How far a time may be beside a grid, as a part of its spacing.
const BESIDE: f64 = 1e-6;

/// A measured signal that the model records.
pub struct Compared {
    /// Which of the recorded ones.
    number: usize,
    /// Its path.
    pub path: String,
    /// In which it is shown.
    pub unit: Unit,
    /// Times within the run, s.
    times: Vec<f64>,
    /// Values in SI.
    pub values: Vec<f64>,
    /// Rows that are not compared: before or behind the run, or of more than can be compared.
    pub left_out: usize,
    /// The size of its changes, relative to which signals of different units are compared before their noise is known.
    size: f64,
}

/// Finds parameters and reports them.
///
/// # Errors
/// What is wrong with the command line, the model or the measurement, or why nothing was found.
pub fn parameters(args: &ParametersArgs, console: Console) -> Outcome {
    let mut first = load(&args.model, Purpose::Run)?;
    let mut schedule = first.take_schedule("nothing was run", console)?;
    if let Some(understood) = first.understood() {
        console.say(&understood);
    }
    let parameters: Vec<Parameter> =
        args.of.iter().map(|name| parameter(&args.model, name)).collect::<Result<_, _>>()?;
    if let Some(twice) = (1..args.of.len()).find(|&at| args.of[..at].contains(&args.of[at])) {
        return Err(Failure::usage(format!("`{}` is to be found twice", args.of[twice])).help("name it once"));
    }
    solver::apply(&args.solver, &mut schedule.settings)?;
    let stop_time = schedule.settings.stop_time;
    let compared = compared(args, &schedule.recorded, stop_time)?;
    let values: Vec<f64> = compared.iter().flat_map(|signal| &signal.values).copied().collect();
    let signals: Vec<Signal> =
        compared.iter().map(|signal| Signal { values: signal.values.len(), size: signal.size }).collect();
    let start: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
    interrupt::take_over();
    let mut runs = Runs {
        args,
        console,
        files: &first.files,
        compared: &compared,
        intervals: intervals(&compared, stop_time),
        ways: parameters.iter().map(|_| Way::Unknown).collect(),
        parameters,
        made: 0,
        refused: None,
        slopes: DMatrix::zeros(0, 0),
    };
    let fitted = fit_signals(&values, &signals, &start, args.steps, &mut runs);
    if console.live && !args.json {
        console.rewrite("");
    }
    let fitted = fitted.map_err(|stopped| runs.stopped(stopped))?;
    let text = report(&runs, &compared, &fitted, &start, args.json);
    console.data(&text)?;
    Ok(Exit::Done)
}

fn report(runs: &Runs, compared: &[Compared], fitted: &Fitted, start: &[f64], as_json: bool) -> String {
    let ways: Vec<Option<&str>> = runs
        .ways
        .iter()
        .map(|way| if let Way::Differences(why) = way { Some(why.as_str()) } else { None })
        .collect();
    let found = Found {
        model: &runs.args.model.model,
        set: &runs.args.model.set,
        parameters: &runs.parameters,
        start,
        ways: &ways,
        compared,
        fitted,
        edge: runs.refused.as_deref().filter(|_| fitted.at_edge),
        runs: runs.made,
    };
    if as_json { report::json(&found) } else { report::text(&found) }
}

/// What is both measured and recorded.
fn compared(args: &ParametersArgs, recorded: &[Recorded], stop: f64) -> Result<Vec<Compared>, Failure> {
    let numbers: Vec<(usize, &Recorded)> =
        recorded.iter().enumerate().filter(|(_, recorded)| recorded.kind == Kind::Real).collect();
    if numbers.is_empty() {
        return Err(Failure::usage("the model records no real number that could be compared")
            .help("add a Scope, or `record: [\"...\"]` to the diagram"));
    }
    let is_meant =
        |path: &str| args.signals.is_empty() || args.signals.iter().any(|pattern| fits(path, pattern));
    let mut found = Vec::new();
    let measured = measured(args)?;
    for (number, recorded) in &numbers {
        let Some((_, unit, times, values)) = measured.iter().find(|(path, ..)| *path == recorded.path) else {
            continue;
        };
        if !is_meant(&recorded.path) {
            continue;
        }
        let shown = display_unit(recorded);
        let values: Vec<f64> = match unit {
            Some(unit)
                if recorded.dimension.is_some_and(|dimension| !dimension.compatible(unit.dimension)) =>
            {
                let said =
                    format!("`{}` is measured in {unit}, but the model has it in {shown}", recorded.path);
                return Err(Failure::usage(said).help("give the unit in which it was measured, with --map"));
            }
            Some(_) => values.clone(),
            // What has no unit is in that in which the signal is shown.
            None => values.iter().map(|value| shown.to_si(*value)).collect(),
        };
        let measured_rows = times.len();
        let inside: Vec<(f64, f64)> =
            times.iter().copied().zip(values).filter(|(t, _)| (0.0..=stop).contains(t)).collect();
        if let Some((t, value)) = inside.iter().find(|(_, value)| !value.is_finite()) {
            let said = format!("`{}` is {value} at t = {t} s", recorded.path);
            return Err(Failure::unreadable(said).help("leave such rows out of the table"));
        }
        if inside.is_empty() {
            let said =
                format!("no row of `{}` is between 0 and {stop} s, where the model runs", recorded.path);
            return Err(
                Failure::usage(said).help("shift its times, or let the model run longer with --until")
            );
        }
        // Of two rows at one time, before and behind a jump, the model keeps the later one, too.
        let is_last = |at: usize| inside.get(at + 1).is_none_or(|next| next.0 > inside[at].0);
        let inside: Vec<(f64, f64)> =
            (0..inside.len()).filter(|at| is_last(*at)).map(|at| inside[at]).collect();
        let step = inside.len().div_ceil(ROWS);
        let (times, values): (Vec<f64>, Vec<f64>) = inside.into_iter().step_by(step).unzip();
        let (size, left_out) = (size(&values), measured_rows - times.len());
        found.push(Compared {
            number: *number,
            path: recorded.path.clone(),
            unit: shown,
            times,
            values,
            left_out,
            size,
        });
    }
    if found.is_empty() {
        let list = |names: Vec<&str>| {
            let some: Vec<String> = names.iter().take(6).map(|name| format!("`{name}`")).collect();
            format!("{}{}", some.join(", "), if names.len() > some.len() { ", ..." } else { "" })
        };
        let said = format!(
            "none of the measured signals {} is one that the model records",
            list(measured.iter().map(|(path, ..)| path.as_str()).collect())
        );
        return Err(Failure::usage(said).help(format!(
            "--map 'COLUMN=SIGNAL[UNIT]' connects them; recorded are {}",
            list(numbers.iter().map(|(_, recorded)| recorded.path.as_str()).collect())
        )));
    }
    Ok(found)
}

/// Path, unit if there is one, times and values, in SI where there is a unit.
type MeasuredSignal = (String, Option<Unit>, Vec<f64>, Vec<f64>);

fn measured(args: &ParametersArgs) -> Result<Vec<MeasuredSignal>, Failure> {
    let file = Path::new(&args.from);
    if file.extension().is_some_and(|ending| ending == "ron") {
        if !args.map.is_empty() {
            let said = format!("`{}` has signals for its columns already, so --map has no place", args.from);
            return Err(Failure::usage(said).help("leave --map out, or change the columns in the file"));
        }
        let (assigned, folder) = assignment(file)?;
        let measurement = assigned.read(&folder, &args.from).map_err(|troubles| {
            let first = troubles.into_iter().next();
            let (message, help) = first.map(|trouble| (trouble.message, trouble.help)).unwrap_or_default();
            Failure::unreadable(format!("`{}`: {message}", args.from)).help(help)
        })?;
        let signals = measurement.signals.into_iter();
        return Ok(signals.map(|one| (one.path, one.unit, measurement.time.clone(), one.values)).collect());
    }
    let maps = mappings(&args.map)?;
    let book = open(&args.from, &maps)?;
    crate::signals::traces::check_mappings(&maps, std::slice::from_ref(&book))?;
    let mut all = Vec::new();
    for (at, trace) in book.traces.iter().enumerate() {
        let column = book.read(at, &ALWAYS)?;
        all.push((
            trace.path.clone(),
            trace.has_unit.then(|| trace.unit.clone()),
            column.time,
            column.values,
        ));
    }
    Ok(all)
}

/// The size of the changes of a signal, or of its values where it is constant; 1 where it is zero.
fn size(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let largest = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    match (spread > 1e-9 * largest, largest > 0.0) {
        (true, _) => spread,
        (false, true) => largest,
        (false, false) => 1.0,
    }
}

/// Into how many equal parts a run is divided, so that all times of the measurement are ends of them, or close to some.
fn intervals(compared: &[Compared], stop: f64) -> usize {
    let times = || compared.iter().flat_map(|signal| &signal.times);
    let gaps = compared.iter().flat_map(|signal| signal.times.windows(2)).map(|pair| pair[1] - pair[0]);
    let spacing = gaps.filter(|gap| *gap > 0.0).fold(f64::INFINITY, f64::min);
    let is_on_grid = |t: f64| (t / spacing - (t / spacing).round()).abs() < BESIDE * (t / spacing).max(1.0);
    if spacing.is_finite() && stop / spacing <= MOST as f64 && times().copied().chain([stop]).all(is_on_grid)
    {
        return (stop / spacing).round().max(1.0) as usize;
    }
    let rows = compared.iter().map(|signal| signal.times.len()).max().unwrap_or(0);
    (PER_ROW * rows).clamp(FEWEST, MOST)
}

/// How the slopes by a parameter are found.
enum Way {
    Unknown,
    /// By the tangent of the laws, which has agreed with differences at the start.
    Tangent,
    /// By differences of runs, as there is no tangent.
    Differences(String),
}

/// The model as a function of its parameters.
struct Runs<'a> {
    args: &'a ParametersArgs,
    console: Console,
    /// Texts that the places of problems refer to.
    files: &'a [SourceFile],
    compared: &'a [Compared],
    intervals: usize,
    parameters: Vec<Parameter>,
    ways: Vec<Way>,
    /// Runs that were made.
    made: usize,
    /// Why the last values were none.
    refused: Option<String>,
    /// The last slopes.
    slopes: DMatrix<f64>,
}

impl Runs<'_> {
    fn take(&mut self, x: &[f64]) {
        self.parameters.iter_mut().zip(x).for_each(|(parameter, x)| parameter.set(*x));
    }

    /// The model with the present values.
    fn model(&self) -> ModelArgs {
        let written = self.parameters.iter().map(|parameter| parameter.written(parameter.value));
        ModelArgs {
            model: self.args.model.model.clone(),
            set: self.args.model.set.iter().cloned().chain(written).collect(),
            plugins: self.args.model.plugins,
        }
    }

    fn count(&mut self, more: usize) {
        self.made += more;
        if self.console.live && !self.args.json {
            self.console.rewrite(&format!("  {} runs", self.made));
        }
    }

    /// Values of the compared signals, one behind the other, from those of all recorded ones on the grid.
    fn picked(&self, values: &[Vec<f64>], stop: f64) -> Vec<f64> {
        let spacing = stop / self.intervals as f64;
        let at = |column: &[f64], t: f64| {
            let place = t / spacing;
            let before = (place.floor() as usize).min(column.len() - 1);
            let after = (before + 1).min(column.len() - 1);
            let share = place - before as f64;
            match share {
                share if share < BESIDE => column[before],
                share if share > 1.0 - BESIDE => column[after],
                share => (1.0 - share) * column[before] + share * column[after],
            }
        };
        let signals = self.compared.iter();
        signals.flat_map(|signal| signal.times.iter().map(move |t| at(&values[signal.number], *t))).collect()
    }

    /// Runs the model to its end, or gives the reason why it does not get there.
    fn run(&mut self, schedule: &Schedule) -> Result<Result<Course, String>, Failure> {
        let is_there = |signal: &Compared| {
            schedule.recorded.get(signal.number).is_some_and(|recorded| recorded.path == signal.path)
        };
        if let Some(lost) = self.compared.iter().find(|signal| !is_there(signal)) {
            return Ok(Err(format!("the model does not record `{}` any more", lost.path)));
        }
        self.count(1);
        match course(schedule, self.intervals, &mut go_on) {
            Ok(Some(course)) if course.times.len() == self.intervals + 1 => Ok(Ok(course)),
            Ok(Some(course)) => {
                let end = course.times.last().copied().unwrap_or(0.0);
                Ok(Err(format!("the run ends at {end} s already")))
            }
            Ok(None) => Err(Failure::interrupted("nothing was found")),
            Err(error) => Ok(Err(reason(&error))),
        }
    }

    /// The slopes by one parameter.
    fn column(&mut self, number: usize) -> Result<Vec<f64>, Failure> {
        let parameter = &self.parameters[number];
        let distance = parameter.distance;
        let variants = variants(&self.model(), &self.args.solver, parameter)?;
        let stop = variants[2].settings.stop_time;
        let failed = |error: &SimError| {
            Failure::of(Exit::Failed, vec![failure(error, &variants[2])], self.files.to_vec())
        };
        let interrupted = || Failure::interrupted("nothing was found");
        if let Way::Tangent = self.ways[number] {
            self.count(1);
            let found = tangent_on(&variants, distance, self.intervals, &mut go_on);
            // Without a result the differences are taken instead: they name what is wrong.
            if let Ok(Some(values)) = found
                && values.iter().all(|column| column.len() == self.intervals + 1)
            {
                return Ok(self.picked(&values, stop));
            }
            if interrupt::is_requested() {
                return Err(interrupted());
            }
        }
        if let Way::Differences(_) = self.ways[number] {
            let mut both = Vec::with_capacity(2);
            for variant in [&variants[1], &variants[3]] {
                let course = self.run(variant)?.map_err(|why| Failure::new(Exit::Failed, "identify", why))?;
                both.push(self.picked(&course.values, stop));
            }
            return Ok(both[0]
                .iter()
                .zip(&both[1])
                .map(|(below, above)| (above - below) / distance)
                .collect());
        }
        self.count(5);
        let found = sensitivity_on(&variants, distance, self.intervals, &mut go_on);
        let found = found.map_err(|error| failed(&error))?.ok_or_else(interrupted)?;
        if found.times.len() <= self.intervals {
            let said = "a run ends before its time, so that there is nothing to compare";
            return Err(Failure::new(Exit::Failed, "identify", said).help("shorten it with --until"));
        }
        self.ways[number] = match &found.by_differences {
            None => Way::Tangent,
            Some(why) => Way::Differences(why.clone()),
        };
        Ok(self.picked(&found.values, stop))
    }

    /// What is said where a fit was stopped.
    fn stopped(&self, stopped: Stopped<Failure>) -> Failure {
        let failed = |said: String| Failure::new(Exit::Failed, "identify", said);
        match stopped {
            Stopped::Model(failure) => failure,
            Stopped::NoStart => {
                let why = self.refused.clone().unwrap_or_default();
                failed(format!("the model has no run with the values at the start: {why}"))
                    .help("give others with --set")
            }
            Stopped::Numbers(IdentifyError::Dependent { .. }) => {
                let (a, b) = self.most_alike();
                failed(format!(
                    "the measurement cannot separate `{a}` and `{b}`: both change the signals in the same way"
                ))
                .help("leave one of them out of --of, or measure another signal")
            }
            Stopped::Numbers(IdentifyError::NotSettled { steps }) => {
                let now: Vec<String> =
                    self.parameters.iter().map(|parameter| parameter.written(parameter.value)).collect();
                failed(format!("the fit has not settled after {steps} steps; the last values are {}", now.join(", ")))
                    .help("begin closer, with --set, find fewer parameters at a time, or allow more steps with --steps")
            }
            Stopped::Numbers(other) => failed(other.to_string()),
        }
    }

    /// The two parameters that change the signals most alike.
    fn most_alike(&self) -> (&str, &str) {
        let weights: Vec<f64> =
            self.compared.iter().flat_map(|signal| vec![1.0 / signal.size; signal.values.len()]).collect();
        let columns: Vec<DVector<f64>> = self
            .slopes
            .column_iter()
            .map(|column| {
                DVector::from_iterator(
                    column.len(),
                    column.iter().zip(&weights).map(|(x, weight)| x * weight),
                )
                .normalize()
            })
            .collect();
        let pairs = (0..columns.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let alike = |&(i, j): &(usize, usize)| columns[i].dot(&columns[j]).abs();
        let (i, j) = pairs.max_by(|a, b| alike(a).total_cmp(&alike(b))).unwrap_or((0, 0));
        (&self.parameters[j].name, &self.parameters[i].name)
    }
}

impl Model for Runs<'_> {
    type Error = Failure;

    fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, Failure> {
        self.take(x);
        let course = match with(&self.model(), &self.args.solver, [])? {
            Ok(schedule) => {
                let stop = schedule.settings.stop_time;
                self.run(&schedule)?.map(|course| self.picked(&course.values, stop))
            }
            Err(why) => Err(why),
        };
        match course {
            Ok(values) => Ok(Some(values)),
            Err(why) => {
                self.refused = Some(why);
                Ok(None)
            }
        }
    }

    fn slopes(&mut self, x: &[f64]) -> Result<DMatrix<f64>, Failure> {
        self.take(x);
        let mut columns = Vec::with_capacity(x.len());
        for number in 0..x.len() {
            let column = self.column(number)?;
            if column.iter().all(|slope| *slope == 0.0) {
                let name = &self.parameters[number].name;
                let said = format!("`{name}` changes none of the compared signals");
                return Err(Failure::new(Exit::Failed, "identify", said)
                    .help("leave it out of --of, or compare a signal that depends on it"));
            }
            columns.push(DVector::from_vec(column));
        }
        self.slopes = DMatrix::from_columns(&columns);
        Ok(self.slopes.clone())
    }
}

fn go_on() -> Control {
    if interrupt::is_requested() { Control::Stop } else { Control::Go }
}
