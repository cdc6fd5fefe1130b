//! Signals of runs and of foreign tables alike: found by path, read in SI, shown in their units.

mod mapping;
mod table;

pub use mapping::{Mapping, mappings};

use std::ops::RangeInclusive;
use std::path::Path;

use blocksim_analysis::{Interpolation, cut};
use blocksim_recording::{Column, Kind, Run, SignalInfo};
use blocksim_signal::Unit;

use crate::failure::Failure;

/// Most values of a signal that are read for a picture; of more the extremes are enough.
const PICTURE: u64 = 1 << 18;

/// A signal.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Its path, or the name of a column that nobody mapped to one.
    pub path: String,
    /// Unit to show it in.
    pub unit: Unit,
    /// Whether the unit is known, rather than taken for SI.
    pub has_unit: bool,
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Whether it keeps its value until the next one, as what is sampled does.
    pub held: bool,
    /// Labels of its scope and of the subsystems around it, the outermost first; empty without.
    pub title: Vec<String>,
    /// What the diagram calls it in legends, if it does.
    pub legend: Option<String>,
    /// Path of the signal over which the diagram has it drawn; over time without.
    pub over: Option<String>,
}

impl Trace {
    /// Path of the block, without port and element.
    pub fn block(&self) -> &str {
        self.path.split_once('.').map_or("", |(block, _)| block)
    }

    /// Port and element, without the block.
    pub fn port(&self) -> &str {
        self.path.split_once('.').map_or(&self.path, |(_, port)| port)
    }
}

impl Trace {
    /// A signal of a recording.
    fn of(info: &SignalInfo) -> Trace {
        let si = Unit::parse(&info.unit).ok();
        let display = info.display.as_deref().and_then(|text| Unit::parse(text).ok());
        Trace {
            path: info.path.clone(),
            unit: shown_in(si.clone(), display),
            has_unit: si.is_some(),
            kind: info.kind,
            held: info.held || info.kind != Kind::Real,
            title: info.title.clone(),
            legend: info.legend.clone(),
            over: info.over.clone(),
        }
    }
}

/// All signals of a run or a table.
#[derive(Debug)]
pub struct Book {
    /// Name of folder or file.
    pub name: String,
    /// What it is called in pictures: its name, unless [`tell_apart`](super::differences::tell_apart) knows better.
    pub label: String,
    /// Whether it is a run, not a table.
    pub is_run: bool,
    /// Its signals.
    pub traces: Vec<Trace>,
    /// Why something is missing at the end.
    pub shortfall: Option<String>,
    /// What a reader should know of, such as columns that got other names.
    pub remarks: Vec<String>,
    source: Source,
}

#[derive(Debug)]
enum Source {
    Run(Box<Run>),
    Table(table::Table),
}

impl Book {
    /// Opens a run (its folder or its recording) or a table (any other file), whose columns may be mapped.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn open(path: &Path, maps: &[Mapping]) -> Result<Book, Failure> {
        if path.is_dir() || path.extension().is_some_and(|ending| ending == "rec") {
            let run = Run::open(path).map_err(|error| Failure::of_run(&error))?;
            let traces = run.signals().iter().map(Trace::of).collect();
            let (name, shortfall) = (run.name(), run.shortfall());
            let source = Source::Run(Box::new(run));
            let label = name.clone();
            return Ok(Book { name, label, is_run: true, traces, shortfall, remarks: Vec::new(), source });
        }
        let (table, traces, remarks) = table::Table::open(path, maps)?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let label = name.clone();
        Ok(Book {
            name,
            label,
            is_run: false,
            traces,
            shortfall: None,
            remarks,
            source: Source::Table(table),
        })
    }

    /// Signals of a run that is to come, which have no values yet.
    pub fn to_come(signals: &[SignalInfo]) -> Book {
        Book {
            name: String::new(),
            label: String::new(),
            is_run: true,
            traces: signals.iter().map(Trace::of).collect(),
            shortfall: None,
            remarks: Vec::new(),
            source: Source::Table(table::Table::default()),
        }
    }

    /// The run, if it is one.
    pub fn run(&self) -> Option<&Run> {
        match &self.source {
            Source::Run(run) => Some(run),
            Source::Table(_) => None,
        }
    }

    /// What to tell of the book before its signals are looked at.
    pub fn warnings(&self) -> Vec<String> {
        let shortfall =
            self.shortfall.iter().map(|why| format!("warning: `{}` is not whole: {why}", self.name));
        let remarks = self.remarks.iter().map(|remark| format!("note: in `{}` {remark}", self.name));
        shortfall.chain(remarks).collect()
    }

    /// Whether a signal can be read; the unit of a column of a table may not be known.
    pub fn is_readable(&self, trace: usize) -> bool {
        match &self.source {
            Source::Run(_) => true,
            Source::Table(table) => table.is_known(trace),
        }
    }

    /// First and last instant, s; none where there are no values.
    pub fn span(&self) -> Option<(f64, f64)> {
        match &self.source {
            Source::Run(run) => run.span(),
            Source::Table(table) => Some((*table.time.first()?, *table.time.last()?)),
        }
    }

    /// Position of the signal of this path.
    pub fn find(&self, path: &str) -> Option<usize> {
        self.traces.iter().position(|trace| trace.path == path)
    }

    /// A signal in SI, with the values at both ends of the range of time.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn read(&self, trace: usize, range: &RangeInclusive<f64>) -> Result<Column, Failure> {
        let column = match &self.source {
            Source::Run(run) => run
                .around(trace, range)
                .and_then(|wide| run.read(trace, &wide))
                .map_err(|error| Failure::of_run(&error))?,
            Source::Table(table) => table.column(trace)?,
        };
        if is_within(&column.time, range) {
            return Ok(column);
        }
        let (time, mut values) =
            cut(&column.time, &[(&column.values, between(self.traces[trace].kind))], range);
        Ok(Column { time, values: values.pop().unwrap_or_default() })
    }

    /// Signals in SI, those of one time base on common times: where one of them is held, all have a row on both sides of
    /// its jumps. They have their values at both ends of the range of time.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn together(&self, traces: &[usize], range: &RangeInclusive<f64>) -> Result<Vec<Column>, Failure> {
        let Source::Run(run) = &self.source else {
            return traces.iter().map(|&trace| self.read(trace, range)).collect();
        };
        let mut columns = vec![Column::default(); traces.len()];
        for base in 0..run.rates().len() {
            let places: Vec<usize> =
                (0..traces.len()).filter(|&at| run.signals()[traces[at]].base == base).collect();
            let signals: Vec<usize> = places.iter().map(|&at| traces[at]).collect();
            let Some(&first) = signals.first() else { continue };
            let read = run.around(first, range).and_then(|wide| run.read_together(&signals, &wide));
            let read = read.map_err(|error| Failure::of_run(&error))?;
            if is_within(&read.time, range) {
                for (at, signal) in places.into_iter().zip(read.signals) {
                    columns[at] = Column { time: read.time.clone(), values: signal.values };
                }
                continue;
            }
            let all: Vec<(&[f64], Interpolation)> =
                read.signals.iter().map(|signal| (&signal.values[..], between(signal.kind))).collect();
            let (time, all) = cut(&read.time, &all, range);
            for (at, values) in places.into_iter().zip(all) {
                columns[at] = Column { time: time.clone(), values };
            }
        }
        Ok(columns)
    }

    /// Whether a signal has so many rows that a picture needs only some of them.
    fn is_long(&self, trace: usize) -> bool {
        matches!(&self.source, Source::Run(run) if run.rows(run.signals()[trace].base) > PICTURE)
    }

    /// Signals in SI as a picture needs them: those of one time base on common times or, where there are very many rows,
    /// the extremes of short stretches.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn pictures(&self, traces: &[usize], range: &RangeInclusive<f64>) -> Result<Vec<Column>, Failure> {
        if traces.iter().any(|&trace| self.is_long(trace)) {
            return traces.iter().map(|&trace| self.picture(trace, range)).collect();
        }
        self.together(traces, range)
    }

    /// A signal in SI as a picture needs it: all values or, of very many, the extremes of short stretches.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn picture(&self, trace: usize, range: &RangeInclusive<f64>) -> Result<Column, Failure> {
        match &self.source {
            Source::Run(run) if self.is_long(trace) => {
                run.overview(trace, range, PICTURE as usize).map_err(|error| Failure::of_run(&error))
            }
            _ => self.read(trace, range),
        }
    }

    /// The column of a table that a mapping is about, by the name that it has there.
    fn has_column(&self, name: &str) -> bool {
        match &self.source {
            Source::Run(_) => false,
            Source::Table(table) => table.columns.iter().any(|column| column == name),
        }
    }

    /// Shows all signals of the dimensions of these units in them.
    pub fn show_in(&mut self, units: &[Unit]) {
        for trace in &mut self.traces {
            let fits = |unit: &&Unit| trace.has_unit && unit.dimension == trace.unit.dimension;
            if let Some(unit) = units.iter().rev().find(fits) {
                trace.unit = unit.clone();
            }
        }
    }
}

/// What a signal is between its rows. What is held has both values at each jump.
fn between(kind: Kind) -> Interpolation {
    if kind == Kind::Real { Interpolation::Smooth } else { Interpolation::Hold }
}

/// Whether nothing is beyond a range of time.
fn is_within(time: &[f64], range: &RangeInclusive<f64>) -> bool {
    time.first().is_none_or(|first| first >= range.start())
        && time.last().is_none_or(|last| last <= range.end())
}

/// Tells a mapping of a column that no table has.
///
/// # Errors
/// Why it cannot be read.
pub fn check_mappings(maps: &[Mapping], books: &[Book]) -> Result<(), Failure> {
    let Some(lost) = maps.iter().find(|map| !books.iter().any(|book| book.has_column(&map.column))) else {
        return Ok(());
    };
    let Some(book) = books.iter().find(|book| !book.is_run) else {
        let said = format!("there is no table with the column `{}`", lost.column);
        return Err(Failure::usage(said).help("mappings are for tables; a run has its own names"));
    };
    let columns: &[String] = match &book.source {
        Source::Run(_) => &[],
        Source::Table(table) => &table.columns,
    };
    let help = match blocksim_signal::closest(&lost.column, columns.iter().map(String::as_str)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!(
            "its columns are {}",
            columns.iter().take(12).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
        ),
    };
    Err(Failure::usage(format!("there is no column `{}` in `{}`", lost.column, book.name)).help(help))
}

/// The unit asked for if it fits; else degrees for angles and SI for all else.
fn shown_in(si: Option<Unit>, asked: Option<Unit>) -> Unit {
    let Some(si) = si else { return asked.unwrap_or_else(|| Unit::si(blocksim_signal::Dimension::NONE)) };
    let fits = |unit: &Unit| unit.dimension.compatible(si.dimension);
    let degrees = || Unit::parse("deg").ok().filter(|unit| unit.dimension == si.dimension);
    asked.filter(fits).or_else(degrees).unwrap_or(si)
}
