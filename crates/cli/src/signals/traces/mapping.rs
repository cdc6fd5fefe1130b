//! What the columns of a foreign table are called here, and in which units they are.

use std::path::Path;

use blocksim_recording::{MOST_TEXT, limited_text};

use crate::failure::Failure;

/// One column: `q1 = axis1.angle [deg]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mapping {
    /// Name of the column in the table.
    pub column: String,
    /// Path of the signal, or `time`.
    pub path: String,
    /// Unit of the column, if it is said.
    pub unit: Option<String>,
}

/// Reads `--map`: a mapping, or the name of a file with one in each line; lines that begin with `#` are comments.
pub fn mappings(texts: &[String]) -> Result<Vec<Mapping>, Failure> {
    let mut all = Vec::new();
    for text in texts {
        if text.contains('=') {
            all.push(mapping(text)?);
            continue;
        }
        let file = limited_text(Path::new(text), MOST_TEXT).map_err(|error| {
            let reason = crate::disk::reason(&error);
            Failure::usage(format!("cannot read the mappings in `{text}`: {reason}"))
                .help("write a mapping as 'COLUMN=PATH[unit]'")
        })?;
        for (n, line) in file.lines().enumerate() {
            let line = line.trim().trim_start_matches('\u{feff}');
            if !line.is_empty() && !line.starts_with('#') {
                all.push(
                    mapping(line).map_err(|failure| failure.note(format!("in `{text}`, line {}", n + 1)))?,
                );
            }
        }
    }
    Ok(all)
}

fn mapping(text: &str) -> Result<Mapping, Failure> {
    let wrong = || {
        Failure::usage(format!("`{}` is not a mapping", text.trim()))
            .help("write 'COLUMN=PATH[unit]', such as 'q1=control/joint1/scope.actual[deg]'")
    };
    let (column, rest) = text.rsplit_once('=').ok_or_else(wrong)?;
    let (column, rest) = (column.trim(), rest.trim());
    // `arm.q[2]` ends in the number of an element.
    let unit = rest.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')).filter(|(_, unit)| {
        !unit.trim().chars().all(|sign| sign.is_ascii_digit()) || unit.trim() == "1" && rest.contains(" [")
    });
    let (path, unit) = unit.map_or((rest, None), |(path, unit)| (path.trim(), Some(unit.trim().to_owned())));
    if column.is_empty() || path.is_empty() {
        return Err(wrong());
    }
    Ok(Mapping { column: column.to_owned(), path: path.to_owned(), unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapping_has_a_column_a_path_and_perhaps_a_unit() {
        let read =
            |text: &str| mapping(text).map(|m| (m.column, m.path, m.unit)).map_err(|failure| failure.text());
        let owned =
            |a: &str, b: &str, unit: Option<&str>| Ok((a.to_owned(), b.to_owned(), unit.map(str::to_owned)));
        assert_eq!(read("q1=axis1.angle[deg]"), owned("q1", "axis1.angle", Some("deg")));
        assert_eq!(read(" t ms = time [ms] "), owned("t ms", "time", Some("ms")));
        assert_eq!(read("q=arm.q[2]"), owned("q", "arm.q[2]", None));
        assert_eq!(read("q=arm.q[2][rad]"), owned("q", "arm.q[2]", Some("rad")));
        assert_eq!(read("ratio=gear.ratio [1]"), owned("ratio", "gear.ratio", Some("1")));
        for wrong in ["=a", "a=", "q1"] {
            assert!(read(wrong).unwrap_err().contains("COLUMN=PATH[unit]"));
        }
    }

    #[test]
    fn a_file_that_is_not_there_is_told() {
        let error = mappings(&["no-such-file.txt".to_owned()]).unwrap_err().text();
        assert!(error.starts_with("cannot read the mappings in `no-such-file.txt`: the file does not exist"));
    }
}
