//! A foreign table as signals in SI.

use std::path::Path;

use blocksim_recording::{Column, Kind, read_foreign_file};
use blocksim_signal::{Dimension, Unit};

use super::{Mapping, Trace, shown_in};
use crate::failure::Failure;

/// Times in s and values in SI.
#[derive(Debug, Default)]
pub struct Table {
    /// Times, never falling.
    pub time: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// Why a column cannot be used.
    troubles: Vec<Option<UnknownUnit>>,
    /// All columns by the names that they have in the file.
    pub columns: Vec<String>,
}

impl Table {
    /// Reads a table and names its columns.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn open(path: &Path, maps: &[Mapping]) -> Result<(Table, Vec<Trace>, Vec<String>), Failure> {
        let time_maps = || maps.iter().filter(|map| map.path == "time");
        let names: Vec<&str> = time_maps().map(|map| map.column.as_str()).collect();
        let foreign = read_foreign_file(path, &names).map_err(|error| Failure::of_run(&error))?;
        if foreign.columns.is_empty() {
            let said = format!("`{}` has times, but no signals", path.display());
            return Err(
                Failure::unreadable(said).help("export the table again with a column for each signal")
            );
        }
        let time_map = time_maps().find(|map| map.column == foreign.time_name);
        let mut columns = vec![foreign.time_name];
        let place = path.display();
        let second = time_map.and_then(|map| map.unit.clone()).or(foreign.time_unit);
        let time_unit = unit(second.as_deref().unwrap_or("s"), "the time", (path, &columns[0], "time[UNIT]"))
            .map_err(|trouble| trouble.failure())?;
        if Unit::parse("s").is_ok_and(|second| second.dimension != time_unit.dimension) {
            let said = format!("the time in `{place}` is in {time_unit}, which is not a time");
            return Err(Failure::unreadable(said).help("give its unit, such as --map 'COLUMN=time[ms]'"));
        }
        let time = foreign.time.iter().map(|&t| time_unit.to_si(t)).collect();

        let mut table = Table { time, values: Vec::new(), troubles: Vec::new(), columns: Vec::new() };
        let mut traces = Vec::new();
        for column in foreign.columns {
            let map = maps.iter().find(|map| map.column == column.name);
            let (kind, said) = match map.and_then(|map| map.unit.clone()).or(column.unit) {
                Some(unit) if unit == "bool" => (Kind::Bool, None),
                Some(unit) if unit == "int" => (Kind::Int, None),
                unit => (Kind::Real, unit),
            };
            let example = format!("{}[UNIT]", map.map_or(&column.name, |map| &map.path));
            let place = (path, column.name.as_str(), example.as_str());
            let found = said.as_deref().map(|text| unit(text, &format!("column `{}`", column.name), place));
            // What nobody asks for may be in any unit.
            let (found, trouble) = match (found.transpose(), map) {
                (Ok(found), _) => (found, None),
                (Err(trouble), Some(map)) if map.unit.is_some() => return Err(trouble.failure()),
                (Err(trouble), _) => (None, Some(trouble)),
            };
            columns.push(column.name.clone());
            let path = map.map_or(column.name, |map| map.path.clone());
            let values = match &found {
                Some(unit) => column.values.iter().map(|&value| unit.to_si(value)).collect(),
                None => column.values,
            };
            // Whole and truth values have no unit; of others nothing is known.
            let has_unit = found.is_some() || kind != Kind::Real;
            let si = found.as_ref().map(|unit| Unit::si(unit.dimension));
            let unit = shown_in(si.or_else(|| has_unit.then(|| Unit::si(Dimension::NONE))), found);
            traces.push(Trace {
                path,
                unit,
                has_unit,
                kind,
                held: kind != Kind::Real,
                title: Vec::new(),
                legend: None,
                over: None,
            });
            table.values.push(values);
            table.troubles.push(trouble);
        }
        Ok((Table { columns, ..table }, traces, foreign.remarks))
    }

    /// Whether the unit of a column is known, or none is said.
    pub fn is_known(&self, at: usize) -> bool {
        self.troubles[at].is_none()
    }

    /// A column.
    ///
    /// # Errors
    /// If its unit is not known.
    pub fn column(&self, at: usize) -> Result<Column, Failure> {
        if let Some(trouble) = &self.troubles[at] {
            return Err(trouble.failure());
        }
        Ok(Column { time: self.time.clone(), values: self.values[at].clone() })
    }
}

/// Why a column cannot be used, which is told only if somebody asks for it.
#[derive(Debug, Clone)]
struct UnknownUnit {
    message: String,
    help: String,
}

impl UnknownUnit {
    fn failure(&self) -> Failure {
        Failure::unreadable(&self.message).help(&self.help)
    }
}

/// A unit of a column; `place` is the file, the name of the column, and what it could be mapped to.
fn unit(text: &str, of: &str, (path, column, example): (&Path, &str, &str)) -> Result<Unit, UnknownUnit> {
    // As it is written in other programs.
    let plain = text.replace('·', "*").replace('²', "^2").replace('³', "^3");
    Unit::parse(&plain).map_err(|error| {
        let help = error.help.map_or(String::new(), |help| format!("{help}, or "));
        UnknownUnit {
            message: format!("the unit of {of} in `{}` is not known: {}", path.display(), error.message),
            help: format!("{help}give it with --map '{column}={example}'"),
        }
    })
}
