//! A recording of a run or a CSV file as what identification asks for, and the robot that it is of.

use std::ops::RangeInclusive;

use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_identify::on_grid;
use blocksim_recording::ALWAYS;
use blocksim_signal::{Unit, closest};

use super::super::plot::open;
use crate::args::identify::Common;
use crate::disk::Disk;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::signals::naming::fits;
use crate::signals::traces::Book;

/// Stands for the number of an axis in the name of a signal.
const NUMBER: &str = "{}";

/// Fewest instants of a recording.
const FEWEST: usize = 10;

/// Most instants that are kept.
const MOST: usize = 4_000_000;

/// A description with the robot that it makes.
pub struct Arm {
    /// As it is written.
    pub description: RobotDescription,
    /// Assembled.
    pub robot: blocksim_robotics::robot::Robot,
}

/// The robot of the diagram, by its description.
///
/// # Errors
/// If it cannot be read.
pub fn arm(common: &Common) -> Result<Arm, Failure> {
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let read: Result<RobotDescription, _> =
        parameter(&sources, &super::model(common)?, &common.set, "manipulator");
    let description = read.map_err(|problems| Failure::of(Exit::Model, problems, sources.all()))?;
    let robot = description.robot("manipulator").map_err(|error| Failure::parameter(&error))?;
    Ok(Arm { description, robot })
}

/// A recording with the instants at which it is looked at.
pub struct Table {
    book: Book,
    /// First instant, s.
    from: f64,
    /// Time between two instants, s.
    pub step: f64,
    /// Number of instants.
    pub count: usize,
}

impl Table {
    /// Opens a run or a CSV file and looks at it at the instants of its own step: the median one.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn open(name: &str) -> Result<Table, Failure> {
        let book = open(name, &[])?;
        let none = || Failure::unreadable(format!("`{name}` has no values")).help("run the model again");
        let (from, to) = book.span().ok_or_else(none)?;
        let time = match book.traces.is_empty() {
            true => return Err(none()),
            false => book.read(0, &range())?.time,
        };
        let mut steps: Vec<f64> =
            time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        let step = steps.get(steps.len() / 2).copied().ok_or_else(none)?;
        let count = ((to - from) / step + 1e-6) as usize + 1;
        if !(FEWEST..=MOST).contains(&count) {
            let said = format!("`{name}` has {count} instants, {step} s apart");
            return Err(Failure::unreadable(said).help(format!("{FEWEST} to {MOST} can be evaluated")));
        }
        Ok(Table { book, from, step, count })
    }

    /// The signals of all axes whose names follow a pattern; `{}` in it stands for the number of the axis.
    ///
    /// # Errors
    /// The signal that is missing, ambiguous or of another unit, and a remedy.
    pub fn signals(&self, flag: &str, pattern: &str, units: &[&str]) -> Result<Vec<Vec<f64>>, Failure> {
        (1..).zip(units).map(|(axis, unit)| self.signal(flag, pattern, axis, unit)).collect()
    }

    /// Whether there is a signal of the first axis.
    pub fn has(&self, pattern: &str) -> bool {
        let wanted = pattern.replace(NUMBER, "1");
        self.book.traces.iter().any(|trace| whole(&trace.path, &wanted))
    }

    fn signal(&self, flag: &str, pattern: &str, axis: usize, unit: &str) -> Result<Vec<f64>, Failure> {
        let wanted = pattern.replace(NUMBER, &axis.to_string());
        let all = || self.book.traces.iter().enumerate();
        let found: Vec<usize> =
            all().filter(|(_, trace)| whole(&trace.path, &wanted)).map(|(at, _)| at).collect();
        let &[at] = &found[..] else {
            let is_in = |dimension| Unit::parse(unit).is_ok_and(|unit| unit.dimension.compatible(dimension));
            let could_be = all().filter(|(_, trace)| !trace.has_unit || is_in(trace.unit.dimension));
            let paths = could_be.map(|(_, trace)| trace.path.as_str());
            let help = match (found.len(), closest(&wanted, paths.clone())) {
                (0, Some(meant)) => format!(
                    "did you mean `{meant}`? {flag} names the signals, {NUMBER} stands for the number of the axis"
                ),
                (0, None) => format!(
                    "name the signals with {flag}, {NUMBER} for the number of the axis; there are {}",
                    paths.take(8).map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ")
                ),
                _ => format!(
                    "choose one of {}",
                    found
                        .iter()
                        .take(4)
                        .map(|at| format!("`{}`", self.book.traces[*at].path))
                        .collect::<Vec<_>>()
                        .join(", ")
                ),
            };
            let how_many = if found.is_empty() { "no signal" } else { "more than one signal" };
            let said = format!("`{}` has {how_many} `{wanted}` for axis {axis}", self.book.name);
            return Err(Failure::usage(said).help(help));
        };
        let trace = &self.book.traces[at];
        let fits = Unit::parse(unit).is_ok_and(|unit| unit.dimension.compatible(trace.unit.dimension));
        if trace.has_unit && !fits {
            let said = format!("`{}` is in {}, but {flag} is for signals in {unit}", trace.path, trace.unit);
            return Err(Failure::usage(said).help("name another signal"));
        }
        let column = self.book.read(at, &range())?;
        if let Some(at) = column.values.iter().position(|value| !value.is_finite()) {
            let said = format!("`{}` is {} at t = {} s", trace.path, column.values[at], column.time[at]);
            return Err(Failure::unreadable(said).help("leave such rows out of the table"));
        }
        Ok(on_grid(&column.time, &column.values, self.from, self.step, self.count))
    }
}

/// A name, or a pattern with `*`; unlike elsewhere a part of a name is not enough.
fn whole(path: &str, pattern: &str) -> bool {
    if pattern.contains('*') { fits(path, pattern) } else { path == pattern }
}

fn range() -> RangeInclusive<f64> {
    ALWAYS
}
