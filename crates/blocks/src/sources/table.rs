//! Signals over time as text: comma-separated values with a header that names columns and units.

use blocksim_signal::{Dimension, Unit, closest};

use crate::math::elements::TIME;

/// Signals over time. Times do not decrease; two equal ones are a jump.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Table {
    /// Time stamps, s.
    pub times: Vec<f64>,
    /// Values in SI units, row after row.
    pub values: Vec<f64>,
    /// Names and dimensions of the columns.
    pub columns: Vec<(String, Dimension)>,
}

/// What is wrong with a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub message: String,
    pub help: Option<String>,
}

impl Fault {
    fn new(message: String, help: impl Into<String>) -> Self {
        Self { message, help: Some(help.into()) }
    }
}

/// Reads a table. The first line is a header: `time [s],name [unit],...`; a column without unit is a plain number.
/// Empty lines and lines that begin with `#` are passed over.
pub(super) fn parse(text: &str) -> Result<Table, Fault> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, header)) = lines.next() else {
        return Err(Fault::new("the file is empty".to_owned(), "begin with a header: time [s],name [unit]"));
    };
    if header.contains([';', '\t']) {
        let message = format!("line {number}: columns are separated by commas, not by semicolons or tabs");
        return Err(Fault::new(message, "export it again with commas between columns and points in numbers"));
    }
    let header = read_header(number, header)?;
    let mut table = Table {
        columns: header[1..].iter().map(|column| (column.name.clone(), column.unit.dimension)).collect(),
        ..Table::default()
    };
    for (number, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        if fields.len() != header.len() {
            let message = format!(
                "line {number} has {} values, but the header names {} columns",
                fields.len(),
                header.len()
            );
            let help = if fields.len() > header.len() {
                "decimal comma? write numbers with a point"
            } else {
                "each line has a value for each column"
            };
            return Err(Fault::new(message, help));
        }
        for (place, (field, column)) in fields.iter().zip(&header).enumerate() {
            let value = read_value(field).map_err(|(message, help)| Fault {
                message: format!("line {number}, column {} (`{}`): {message}", place + 1, column.name),
                help,
            })?;
            let value = column.unit.to_si(value);
            match place {
                0 if table.times.last().is_some_and(|last| value < *last) => {
                    let message = format!("line {number}, column 1 (`{}`): time runs backwards", column.name);
                    return Err(Fault::new(message, "sort the lines by time; two equal times are a jump"));
                }
                0 => table.times.push(value),
                _ => table.values.push(value),
            }
        }
    }
    if table.times.is_empty() {
        return Err(Fault::new(
            "there is no line behind the header".to_owned(),
            "give at least one line of values",
        ));
    }
    Ok(table)
}

struct Column {
    name: String,
    unit: Unit,
}

fn read_header(line: usize, text: &str) -> Result<Vec<Column>, Fault> {
    let mut header = Vec::new();
    for (place, field) in text.split(',').map(str::trim).enumerate() {
        let column = place + 1;
        if field.parse::<f64>().is_ok() {
            let message = format!(
                "line {line}, column {column}: `{field}` is a number, but this line must be a header"
            );
            return Err(Fault::new(message, "begin with a header: time [s],name [unit]"));
        }
        let (name, unit) = match field.split_once('[') {
            Some((name, unit)) => (name.trim(), unit.trim_end().trim_end_matches(']')),
            None => (field, "1"),
        };
        let unit = Unit::parse(unit).map_err(|error| Fault {
            message: format!("line {line}, column {column}: {}", error.message),
            help: error.help,
        })?;
        header.push(Column { name: name.to_owned(), unit });
    }
    match header.as_slice() {
        [time, ..] if !time.unit.dimension.compatible(TIME) => {
            let message = format!(
                "line {line}, column 1: `{}` is in {}, but must be a time",
                time.name, time.unit.dimension
            );
            Err(Fault::new(message, "name the first column `time [s]`"))
        }
        [_] => Err(Fault::new(
            format!("line {line}: there is no column behind the time"),
            "begin with a header: time [s],name [unit]",
        )),
        _ => Ok(header),
    }
}

fn read_value(field: &str) -> Result<f64, (String, Option<String>)> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err((
            format!("`{field}` is not finite"),
            Some("write a number, or leave out the line: values between two lines are found on a straight line".to_owned()),
        )),
        Err(_) if field.is_empty() => Err(("the value is missing".to_owned(), None)),
        Err(_) => Err((
            format!("`{field}` is not a number"),
            Some("units stand in the header; numbers have a decimal point".to_owned()),
        )),
    }
}

impl Table {
    /// Only these columns, in this order; all if none is named.
    pub fn select(self, names: &[String]) -> Result<Self, Fault> {
        if names.is_empty() {
            return Ok(self);
        }
        let known = || self.columns.iter().map(|(name, _)| name.as_str());
        let mut places = Vec::new();
        for name in names {
            if known().filter(|known| known == name).count() > 1 {
                let message = format!("there is more than one column `{name}`");
                return Err(Fault::new(
                    message,
                    "give each column that is read a name of its own in the header",
                ));
            }
            places.push(known().position(|known| known == name).ok_or_else(|| {
                let help = match closest(name, known()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("the columns are: {}", known().collect::<Vec<_>>().join(", ")),
                };
                Fault::new(format!("there is no column `{name}`"), help)
            })?);
        }
        let rows = self.values.chunks(self.columns.len());
        Ok(Self {
            values: rows.flat_map(|row| places.iter().map(|place| row[*place])).collect(),
            columns: places.iter().map(|place| self.columns[*place].clone()).collect(),
            times: self.times,
        })
    }

    /// The dimension that all columns have in common.
    pub fn dimension(&self) -> Result<Option<Dimension>, Fault> {
        let Some((first, dimension)) = self.columns.first() else { return Ok(None) };
        match self.columns.iter().find(|(_, other)| !other.compatible(*dimension)) {
            Some((other, unit)) => Err(Fault::new(
                format!("column `{other}` is in {unit}, but `{first}` is in {dimension}"),
                "name columns of one unit; use another block for the others",
            )),
            None => Ok(Some(*dimension)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;

    #[test]
    fn units_of_the_header_are_turned_into_si() {
        let table =
            parse("\u{feff}# measured\ntime [ms], q [deg], on\r\n0,0,1\r\n\r\n500,180,0\r\n").unwrap();
        assert_eq!(table.times, [0.0, 0.5]);
        assert_eq!(table.values, [0.0, 1.0, std::f64::consts::PI, 0.0]);
        assert_eq!(table.columns, [("q".to_owned(), dimension("rad")), ("on".to_owned(), Dimension::NONE)]);
    }

    #[test]
    fn every_fault_says_where_it_is() {
        for (text, message) in [
            ("", "the file is empty"),
            ("time [s],q [deg]\n", "there is no line behind the header"),
            ("time [s];q [deg]\n0;1\n", "line 1: columns are separated by commas"),
            ("0,1\n", "line 1, column 1: `0` is a number, but this line must be a header"),
            ("time [s],q [degg]\n0,1\n", "line 1, column 2: "),
            ("q [deg],time [s]\n0,1\n", "line 1, column 1: `q` is in rad, but must be a time"),
            ("time [s]\n0\n", "line 1: there is no column behind the time"),
            ("time [s],q\n0,1\n0,5,1,5\n", "line 3 has 4 values, but the header names 2 columns"),
            ("time [s],q\n0,1\n\n1,x\n", "line 4, column 2 (`q`): `x` is not a number"),
            ("time [s],q\n0,\n", "line 2, column 2 (`q`): the value is missing"),
            ("time [s],q\n0,NaN\n", "line 2, column 2 (`q`): `NaN` is not finite"),
            ("time [s],q\n1,0\n0,0\n", "line 3, column 1 (`time`): time runs backwards"),
        ] {
            let fault = parse(text).unwrap_err();
            assert!(fault.message.starts_with(message), "{text:?}: {}", fault.message);
        }
    }

    #[test]
    fn a_decimal_comma_is_suspected() {
        let fault = parse("time [s],q\n0,5,1,5\n").unwrap_err();
        assert_eq!(fault.help.as_deref(), Some("decimal comma? write numbers with a point"));
    }

    #[test]
    fn columns_are_selected_by_name_and_share_a_unit() {
        let table = parse("time [s],a [V],b [A],c [mV]\n0,1,2,3\n1,4,5,6\n").unwrap();
        assert_eq!(table.dimension().unwrap_err().message, "column `b` is in A, but `a` is in V");
        let chosen = table.clone().select(&["c".to_owned(), "a".to_owned()]).unwrap();
        assert_eq!(chosen.values, [0.003, 1.0, 0.006, 4.0]);
        assert_eq!(chosen.dimension(), Ok(Some(dimension("V"))));
        assert_eq!(table.select(&["d".to_owned()]).unwrap_err().message, "there is no column `d`");
        let twice = parse("time [s],a,a,b\n0,1,2,3\n").unwrap();
        assert_eq!(twice.clone().select(&["b".to_owned()]).unwrap().values, [3.0]);
        assert_eq!(twice.select(&["a".to_owned()]).unwrap_err().message, "there is more than one column `a`");
    }
}
