//! Tables of other programs: measured values, exports of spreadsheets.

use std::collections::HashSet;
use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::csv::ReadLimits;
use crate::csv_record::Records;
use crate::error::{CsvError, ResultsError};
use crate::regular::open_regular;

/// Names of columns that hold the time, in lower case.
const TIMES: [&str; 7] = ["time", "t", "timestamp", "zeit", "temps", "tiempo", "aika"];
/// Columns named in a message.
const NAMED: usize = 12;

/// A table of signals as its file says it, in whatever units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Foreign {
    /// Times, in `time_unit`, never falling.
    pub time: Vec<f64>,
    /// Name of their column.
    pub time_name: String,
    /// Unit of the times, if the file says one.
    pub time_unit: Option<String>,
    /// All other columns. No two have the same name.
    pub columns: Vec<ForeignColumn>,
    /// What the reader should know of: columns that got other names, because several had the same.
    pub remarks: Vec<String>,
}

/// How a table of another program begins, as its file has it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Beginning {
    /// What stands between columns.
    pub delimiter: char,
    /// What stands before decimals, as far as the lines that were read have any.
    pub decimal: Option<char>,
    /// Name and unit of each column, as the first line has them.
    pub headings: Vec<(String, Option<String>)>,
    /// Which column is most likely the time.
    pub time: Option<usize>,
    /// The lines below.
    pub lines: Vec<Vec<String>>,
}

/// Reads the first `count` lines of a table below its headings, whatever they say.
///
/// # Errors
/// [`ResultsError`] where the file cannot be read, or is no table.
pub fn beginning(path: &Path, count: usize) -> Result<Beginning, ResultsError> {
    let file = open_regular(path).map_err(|error| ResultsError::io("read", path, error))?;
    let read = || {
        let mut records = Records::of_any_delimiter(BufReader::new(file), ReadLimits::default().line);
        if !records.advance()? {
            return Err(records.error(None, "the file is empty; the first line must name the columns"));
        }
        let headings: Vec<ForeignColumn> = records.fields().iter().map(|heading| column(heading)).collect();
        let mut lines = Vec::new();
        while lines.len() < count && records.advance()? {
            lines.push(records.fields().iter().map(|field| printable(field)).collect::<Vec<String>>());
        }
        let delimiter = records.delimiter();
        let has = |sign: char| {
            let mut numbers = lines.iter().flatten().filter(|field| is_number(field));
            numbers.any(|field| field.contains(sign))
        };
        let decimal = if delimiter != ',' && has(',') { Some(',') } else { Some('.').filter(|_| has('.')) };
        let time = time_column(&headings, &[]).ok();
        let headings = headings.into_iter().map(|column| (column.name, column.unit)).collect();
        Ok(Beginning { delimiter, decimal, headings, time, lines })
    };
    read().map_err(|source| ResultsError::Csv { path: path.to_owned(), source })
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ForeignColumn {
    /// Its name, without the unit.
    pub name: String,
    /// Its unit, if the file says one.
    pub unit: Option<String>,
    /// As many values as there are times; NaN where a field is empty.
    pub values: Vec<f64>,
}

/// Reads a table of another program. See [`read_foreign`].
///
/// # Errors
/// [`ResultsError`] with the file, and for its content with line and column.
pub fn read_foreign_file(path: &Path, time: &[&str]) -> Result<Foreign, ResultsError> {
    let file = open_regular(path).map_err(|error| ResultsError::io("read", path, error))?;
    read_foreign(BufReader::new(file), time, ReadLimits::default())
        .map_err(|source| ResultsError::Csv { path: path.to_owned(), source })
}

/// Reads a table: one line with the names of the columns, then numbers.
///
/// Lines before it that begin with `#` are passed over. Columns are separated by semicolons, tabs or commas, whichever of them the first line has; where that is not the
/// comma, numbers may have a decimal comma, but not some a comma and some a point. Units stand behind names,
/// `angle [deg]` or `angle (deg)`, or in a line of their own below them. The column with the time is the first of
/// those that `time` names; where there is none of them, that called `time`, `t`, `timestamp` and the like.
///
/// # Errors
/// [`CsvError`] with line and column where the text is no such table or exceeds the limits.
pub fn read_foreign(source: impl BufRead, time: &[&str], limits: ReadLimits) -> Result<Foreign, CsvError> {
    let mut records = Records::of_any_delimiter(source, limits.line);
    if !records.advance()? {
        return Err(records.error(None, "the file is empty; the first line must name the columns"));
    }
    if records.fields().iter().all(|field| is_number(field)) {
        let problem = "the first line has numbers; it must name the columns, such as `time [s]`";
        return Err(records.error(None, problem));
    }
    let mut columns: Vec<ForeignColumn> = records.fields().iter().map(|heading| column(heading)).collect();
    let at = time_column(&columns, time).map_err(|problem| records.error(None, problem))?;
    let remarks = tell_apart(&mut columns, at);
    let comma = records.delimiter() != ',';
    let mut decimal = Decimal { sign: if comma { None } else { Some('.') } };
    let mut rows = 0_usize;
    let mut last = f64::NEG_INFINITY;
    while records.advance()? {
        while records.count > columns.len() && records.fields[records.count - 1].trim().is_empty() {
            records.count -= 1;
        }
        if records.count != columns.len() {
            return Err(records.error(None, wrong_count(records.count, columns.len(), comma)));
        }
        if rows == 0 && records.fields().iter().all(|field| !is_number(field)) && records.count > 1 {
            for (column, field) in columns.iter_mut().zip(records.fields()) {
                column.unit = column.unit.take().or_else(|| unit(field));
            }
            continue;
        }
        rows += 1;
        if rows.saturating_mul(columns.len()) > limits.values {
            let problem = format!("the file has more than {} numbers, which is the limit", limits.values);
            return Err(records.error(None, problem));
        }
        for (n, column) in columns.iter_mut().enumerate() {
            let value = decimal.read(&records.fields[n]);
            column.values.push(value.map_err(|problem| records.error(Some(n), problem.told(n == at)))?);
        }
        let now = columns[at].values[rows - 1];
        let ordered = now >= last && now.is_finite();
        if !ordered {
            let problem = match now {
                now if now.is_nan() => "there is no time in this line".to_owned(),
                now if now.is_infinite() => "the time is infinite".to_owned(),
                now => format!("the time {now} follows {last}; times must not fall"),
            };
            return Err(records.error(Some(at), problem));
        }
        last = now;
    }
    let time = columns.remove(at);
    // A delimiter at the end of each line makes a column of nothing.
    columns.retain(|column| !column.name.is_empty() || column.values.iter().any(|x| !x.is_nan()));
    for (n, column) in columns.iter_mut().enumerate().filter(|(_, column)| column.name.is_empty()) {
        column.name = format!("column {}", n + 1 + usize::from(n >= at));
    }
    Ok(Foreign { time: time.values, time_name: time.name, time_unit: time.unit, columns, remarks })
}

/// Gives columns of the same name numbers, `q` and `q (2)`; what to tell of it. The column of the time, at `time`, may have
/// the name of another.
fn tell_apart(columns: &mut [ForeignColumn], time: usize) -> Vec<String> {
    let mut known: HashSet<String> = HashSet::new();
    let mut remarks = Vec::new();
    for (n, column) in
        columns.iter_mut().enumerate().filter(|(n, column)| *n != time && !column.name.is_empty())
    {
        if known.insert(column.name.clone()) {
            continue;
        }
        let numbered = (2_u32..).map(|k| format!("{} ({k})", column.name)).find(|name| !known.contains(name));
        let name = numbered.unwrap_or_default();
        remarks.push(format!(
            "`{}` stands above several columns; column {} is `{name}` here",
            column.name,
            n + 1
        ));
        known.insert(name.clone());
        column.name = name;
    }
    remarks
}

fn wrong_count(found: usize, expected: usize, comma: bool) -> String {
    let hint = match found < expected {
        true => "; was the line cut off?",
        false if !comma => "; are there decimal commas? then write ; between columns",
        false => "",
    };
    let plural = if found == 1 { "" } else { "s" };
    format!("{found} column{plural}, but the first line names {expected}{hint}")
}

/// A heading as a column without values.
fn column(heading: &str) -> ForeignColumn {
    let heading = printable(heading.trim());
    let split = [(" [", ']'), (" (", ')')].into_iter().find_map(|(open, close)| {
        let (name, unit) = heading.strip_suffix(close)?.rsplit_once(open)?;
        Some((name.trim(), unit.trim()))
    });
    let (name, unit) = split.map_or((heading.as_str(), None), |(name, unit)| (name, Some(unit.to_owned())));
    ForeignColumn { name: name.to_owned(), unit: unit.filter(|unit| !unit.is_empty()), values: Vec::new() }
}

/// A text without signs that would steer a terminal.
fn printable(text: &str) -> String {
    text.chars().map(|sign| if sign.is_control() { '\u{fffd}' } else { sign }).collect()
}

/// A field of the line of units.
fn unit(field: &str) -> Option<String> {
    let field = printable(field);
    let unit = field.trim().trim_matches(['[', ']', '(', ')']).trim();
    (!unit.is_empty() && unit != "-").then(|| unit.to_owned())
}

/// Position of the column with the time.
fn time_column(columns: &[ForeignColumn], asked: &[&str]) -> Result<usize, String> {
    let find = |fits: &dyn Fn(&str) -> bool| columns.iter().position(|column| fits(&column.name));
    let named = asked.iter().find_map(|name| find(&|known| known == *name));
    named.or_else(|| find(&|name| TIMES.contains(&name.to_lowercase().as_str()))).ok_or_else(|| {
        let names: Vec<String> =
            columns.iter().take(NAMED).map(|column| format!("`{}`", column.name)).collect();
        let more = if columns.len() > NAMED { " and more" } else { "" };
        format!(
            "which column is the time? the columns are {}{more}; name it, such as `--map 'COLUMN=time[s]'`",
            names.join(", ")
        )
    })
}

fn is_number(field: &str) -> bool {
    let field = field.trim();
    field.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// Reads numbers with one sign before the decimals throughout a file.
struct Decimal {
    sign: Option<char>,
}

/// Why a field is not a number.
struct NoNumber {
    shown: String,
    /// What is wrong with the signs in it, if that is it.
    signs: Option<&'static str>,
}

impl NoNumber {
    /// In words; `is_time` where a time should stand.
    fn told(&self, is_time: bool) -> String {
        let shown = &self.shown;
        match self.signs {
            Some(signs) => format!("`{shown}` {signs}"),
            None if is_time => {
                format!("`{shown}` is not a number; write times as numbers, such as seconds from the start")
            }
            None => format!("`{shown}` is not a number; leave the field empty for a missing one"),
        }
    }
}

impl Decimal {
    fn read(&mut self, field: &str) -> Result<f64, NoNumber> {
        let field = field.trim();
        if field.is_empty() || field == "-" {
            return Ok(f64::NAN);
        }
        let refuse =
            |signs| NoNumber { shown: printable(&field.chars().take(40).collect::<String>()), signs };
        let [points, commas] = ['.', ','].map(|sign| field.matches(sign).count());
        let is_plain = |sign: char| field.replacen(sign, "", 1).bytes().all(|b| b.is_ascii_digit());
        if points > 0 && commas > 0 {
            return Err(refuse(Some("has both `.` and `,`; write no marks between thousands")));
        }
        let found = if commas > 0 { Some(',') } else { Some('.').filter(|_| points > 0) };
        if let Some(found) = found
            && let known = *self.sign.get_or_insert(found)
            && found != known
        {
            return Err(refuse(Some(match known {
                '.' if commas == 1 => {
                    "has a decimal comma where others have a point; export the table with one of both"
                }
                '.' => {
                    "has a `,` where others have a `.` before the decimals; write no marks between thousands"
                }
                _ if is_plain('.') || points > 1 => {
                    "has a `.` where others have a `,` before the decimals; write no marks between thousands"
                }
                _ => {
                    "has a `.` where others have a `,` before the decimals; export the table with one of both"
                }
            })));
        }
        let with_point = if found == Some(',') { field.replacen(',', ".", 1) } else { field.to_owned() };
        with_point.parse().map_err(|_| refuse(None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Foreign, CsvError> {
        read_foreign(text.as_bytes(), &[], ReadLimits::default())
    }

    #[test]
    fn a_table_with_semicolons_and_decimal_commas_is_read() {
        let table = read("Zeit (ms);q1 [deg];Strom;\r\n0;1,5;;\r\n0,5;-2;3e-1;\r\n").unwrap();
        assert_eq!((table.time, table.time_unit.as_deref()), (vec![0.0, 0.5], Some("ms")));
        assert_eq!(table.columns.len(), 2);
        assert_eq!((table.columns[0].name.as_str(), table.columns[0].unit.as_deref()), ("q1", Some("deg")));
        assert_eq!(table.columns[0].values, [1.5, -2.0]);
        assert!(table.columns[1].values[0].is_nan() && table.columns[1].values[1] == 0.3);
        assert_eq!(table.columns[1].unit, None);
    }

    #[test]
    fn tabs_commas_and_a_line_of_units_are_understood() {
        let table = read("q\tt\n[rad]\ts\n1\t0\n2\t0\n").unwrap();
        assert_eq!((table.time, table.time_unit.as_deref()), (vec![0.0, 0.0], Some("s")));
        assert_eq!(table.columns[0].unit.as_deref(), Some("rad"));
        let table = read("time [s],\"a, b\",arm.q[2]\n0,NaN,1.5\n").unwrap();
        assert_eq!([&table.columns[0].name, &table.columns[1].name], ["a, b", "arm.q[2]"]);
        assert_eq!(table.columns[1].unit, None, "an index is not a unit");
        let named = read_foreign(&b"x,y\n1,2\n"[..], &["z", "y"], ReadLimits::default()).unwrap();
        assert_eq!((named.time, named.columns[0].values.clone()), (vec![2.0], vec![1.0]));
    }

    #[test]
    fn mistakes_are_named_with_line_and_column() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(message(""), "line 1: the file is empty; the first line must name the columns");
        assert_eq!(
            message("0,1\n1,2\n"),
            "line 1: the first line has numbers; it must name the columns, such as `time [s]`"
        );
        assert_eq!(
            message("x;y\n1;2\n"),
            "line 1: which column is the time? the columns are `x`, `y`; name it, such as `--map \
             'COLUMN=time[s]'`"
        );
        assert_eq!(message("t;a\n1;2\n0;2\n"), "line 3, column 1: the time 0 follows 1; times must not fall");
        assert_eq!(message("t;a\n1;2\n;2\n"), "line 3, column 1: there is no time in this line");
        assert_eq!(
            message("t;a\n0;1,5\n1;1.5\n"),
            "line 3, column 2: `1.5` has a `.` where others have a `,` before the decimals; write no marks \
             between thousands"
        );
        assert_eq!(
            message("t;a\n0;1.5\n1;1,5\n"),
            "line 3, column 2: `1,5` has a decimal comma where others have a point; export the table with one \
             of both"
        );
        assert_eq!(
            message("t;a\n0;1.234,5\n"),
            "line 2, column 2: `1.234,5` has both `.` and `,`; write no marks between thousands"
        );
        assert_eq!(
            message("t,a\n0,1,5\n"),
            "line 2: 3 columns, but the first line names 2; are there decimal commas? then write ; between \
             columns"
        );
        assert_eq!(
            message("t;a\n0\n"),
            "line 2: 1 column, but the first line names 2; was the line cut off?"
        );
        assert_eq!(message("t;a\n0;1\ninf;1\n"), "line 3, column 1: the time is infinite");
        assert_eq!(
            message("t;a\n18:00:01;1\n"),
            "line 2, column 1: `18:00:01` is not a number; write times as numbers, such as seconds from the start"
        );
        assert_eq!(
            message("t;a\n0;1\u{1b}[31m\n"),
            "line 2, column 2: `1\u{fffd}[31m` is not a number; leave the field empty for a missing one"
        );
        assert_eq!(
            message("t;a\n0;x\n"),
            "line 2, column 2: `x` is not a number; leave the field empty for a missing one"
        );
    }

    #[test]
    fn columns_of_the_same_name_are_told_apart() {
        let table = read("time [s],time [ms],q,q [deg],q (2),q\n0,0,1,2,3,4\n").unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["time", "q", "q (2)", "q (3)", "q (4)"]);
        assert_eq!(table.remarks[0], "`q` stands above several columns; column 4 is `q (2)` here");
        assert_eq!(table.columns[2].unit.as_deref(), Some("deg"));
    }

    #[test]
    fn a_table_without_rows_is_empty_and_memory_is_bounded() {
        assert_eq!(read("t;a\n").unwrap().time.len(), 0);
        let limits = ReadLimits { line: 100, values: 6 };
        let text = format!("t,a\n{}", "0,0\n".repeat(4));
        assert!(read_foreign(text.as_bytes(), &[], limits).is_err());
    }
}
