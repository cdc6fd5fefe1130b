//! The table of a sweep: to people, as CSV, as data.

use blocksim_numbers::format::significant;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::measure::{Lost, Measured};
use super::{Row, runs};
use crate::args::sweep::{Metric, Over};
use crate::terminal::format::column;

/// Most columns of which the best run is told.
const BEST: usize = 6;

/// A row for each run: values of the parameters, then numbers.
pub struct Sheet<'a> {
    /// Whether each run has a name, under which it is kept.
    is_kept: bool,
    targets: Vec<&'a str>,
    columns: Vec<Column<'a>>,
    lines: Vec<Line<'a>>,
}

/// One number of all runs.
struct Column<'a> {
    metric: Metric,
    path: &'a str,
    name: &'a str,
    unit: &'a str,
}

/// One run.
struct Line<'a> {
    name: String,
    values: Vec<&'a str>,
    /// In the order of the columns; none where this run has no such number.
    cells: Vec<Option<f64>>,
    /// Why it has none at all.
    failed: Option<String>,
}

impl<'a> Sheet<'a> {
    /// The sheet of these runs. Variants may have different signals, so the columns are those of all runs.
    pub fn of(over: &'a [Over], rows: &'a [Row], is_kept: bool) -> Sheet<'a> {
        let mut columns: Vec<Column> = Vec::new();
        for measured in rows.iter().flat_map(|row| row.outcome.iter().flatten()) {
            if !columns.iter().any(|column| column.is_of(measured)) {
                let Measured { metric, path, name, unit, .. } = measured;
                columns.push(Column { metric: *metric, path, name, unit });
            }
        }
        let line = |(n, row): (usize, &'a Row)| Line {
            name: runs::name(n, rows.len()),
            values: row.values.clone(),
            cells: columns
                .iter()
                .map(|column| row.outcome.as_ref().ok()?.iter().find(|m| column.is_of(m))?.value)
                .collect(),
            failed: match &row.outcome {
                Ok(_) => None,
                Err(Lost::Interrupted) => Some("interrupted".to_owned()),
                Err(Lost::Simulation(reason)) => reason.lines().next().map(str::to_owned),
                Err(Lost::Usage(problems)) => problems.first().map(|problem| problem.message.clone()),
            },
        };
        let lines = rows.iter().enumerate().map(line).collect();
        Sheet { is_kept, targets: over.iter().map(|over| over.target.as_str()).collect(), columns, lines }
    }

    /// The table, then the runs that follow best. Where a line of it would be longer than `width`, runs stand beside each
    /// other and numbers below each other.
    ///
    /// Of runs with random values the spread of each number is told, too.
    pub fn text(&self, width: usize, is_random: bool) -> String {
        let is_wide = |text: &str| text.lines().any(|line| line.chars().count() > width);
        let upright = self.upright();
        let table = match is_wide(&upright).then(|| self.lying()).filter(|lying| !is_wide(lying)) {
            Some(lying) => lying,
            None => upright,
        };
        let spread = if is_random { self.spread() } else { String::new() };
        let parts = [table, spread, self.best()];
        let told: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        told.join("\n")
    }

    /// A line for each run.
    fn upright(&self) -> String {
        let headings: Vec<String> = self.columns.iter().map(Column::heading).collect();
        let has_failed = self.lines.iter().any(|line| line.failed.is_some());
        let mut all: Vec<(&str, Align)> = Vec::new();
        all.extend(self.is_kept.then_some(("run", Align::Right)));
        all.extend(self.targets.iter().map(|target| (*target, Align::Right)));
        all.extend(headings.iter().map(|heading| (heading.as_str(), Align::Right)));
        if has_failed {
            all.push(("failed", Align::Left));
        }
        let numbers: Vec<Vec<String>> = (0..self.columns.len())
            .map(|n| column(&self.lines.iter().map(|line| line.cells[n]).collect::<Vec<_>>(), &[]))
            .collect();
        let mut table = Table::new(&all);
        for (n, line) in self.lines.iter().enumerate() {
            let values = line.values.iter().map(|value| (*value).to_owned());
            let failed = has_failed.then(|| line.failed.clone().unwrap_or_default());
            let name = self.is_kept.then(|| line.name.clone());
            table.row(
                name.into_iter()
                    .chain(values)
                    .chain(numbers.iter().map(|column| column[n].clone()))
                    .chain(failed),
            );
        }
        table.render()
    }

    /// A column for each run.
    fn lying(&self) -> String {
        let mut all = vec![("", Align::Left)];
        all.extend(self.lines.iter().map(|_| ("", Align::Right)));
        let mut table = Table::new(&all);
        if self.is_kept {
            table.row(std::iter::once("run").chain(self.lines.iter().map(|line| line.name.as_str())));
        }
        for (n, target) in self.targets.iter().enumerate() {
            let values = self.lines.iter().map(|line| line.values[n]);
            table.row(std::iter::once(*target).chain(values));
        }
        for (n, number) in self.columns.iter().enumerate() {
            let cells = column(&self.lines.iter().map(|line| line.cells[n]).collect::<Vec<_>>(), &[]);
            table.row(std::iter::once(number.heading()).chain(cells));
        }
        if self.lines.iter().any(|line| line.failed.is_some()) {
            let failed = self.lines.iter().map(|line| line.failed.as_deref().unwrap_or_default());
            table.row(std::iter::once("failed").chain(failed));
        }
        table.render()
    }

    /// How far each number differs from run to run.
    fn spread(&self) -> String {
        let headings = ["", "minimum", "5 %", "median", "95 %", "maximum", "mean", "deviation"];
        let aligned = |(n, heading): (usize, &&'static str)| {
            (*heading, if n == 0 { Align::Left } else { Align::Right })
        };
        let mut table = Table::new(&headings.iter().enumerate().map(aligned).collect::<Vec<_>>());
        for (n, number) in self.columns.iter().enumerate() {
            let mut all: Vec<f64> =
                self.lines.iter().filter_map(|line| line.cells[n]).filter(|x| x.is_finite()).collect();
            all.sort_by(f64::total_cmp);
            let Some(last) = all.len().checked_sub(1).filter(|last| *last > 0) else { continue };
            let share = |share: f64| {
                let at = share * last as f64;
                let low = at.floor() as usize;
                all[low] + (all[(low + 1).min(last)] - all[low]) * (at - low as f64)
            };
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            let deviation = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / last as f64).sqrt();
            let told = [all[0], share(0.05), share(0.5), share(0.95), all[last], mean, deviation];
            let cells = column(&told.map(Some), &[]);
            table.row(std::iter::once(number.heading()).chain(cells));
        }
        table.render()
    }

    /// For each number that should be small the run in which it is least.
    fn best(&self) -> String {
        let mut table = Table::new(&[("", Align::Left), ("", Align::Right), ("", Align::Left)]);
        let small = self.columns.iter().enumerate().filter(|(_, column)| column.metric.needs_set_value());
        for (n, column) in small.take(BEST) {
            let size = |line: &Line| line.cells[n].map(f64::abs).filter(|x| x.is_finite());
            let sizes = || self.lines.iter().filter_map(|line| Some((size(line)?, line)));
            let least = sizes().min_by(|a, b| a.0.total_cmp(&b.0));
            // Where all are alike none is the best.
            let Some((least, line)) = least.filter(|(least, _)| sizes().any(|(size, _)| size > *least))
            else {
                continue;
            };
            let unit = if column.unit == "1" { "" } else { column.unit };
            let number = format!("{} {unit}", significant(least, 4)).trim_end().to_owned();
            table.row([
                format!("lowest {}", column.words()),
                number,
                format!("at {}", self.set(line).join(", ")),
            ]);
        }
        table.render()
    }

    /// `pid.kp=4`.
    fn set(&self, line: &Line) -> Vec<String> {
        self.targets.iter().zip(&line.values).map(|(target, value)| format!("{target}={value}")).collect()
    }

    /// Columns as in the table, numbers with all their digits; cells without a number are empty.
    pub fn csv(&self) -> String {
        let run = self.is_kept.then(|| "run".to_owned());
        let headings = run.into_iter().chain(self.targets.iter().map(|target| (*target).to_owned()));
        let headings = headings.chain(self.columns.iter().map(Column::heading)).chain(["failed".to_owned()]);
        let lines = self.lines.iter().map(|line| {
            let numbers = line.cells.iter().map(|cell| cell.map_or_else(String::new, |x| x.to_string()));
            let values = line.values.iter().map(|value| (*value).to_owned());
            let name = self.is_kept.then(|| line.name.clone());
            joined(
                name.into_iter()
                    .chain(values)
                    .chain(numbers)
                    .chain([line.failed.clone().unwrap_or_default()]),
            )
        });
        std::iter::once(joined(headings)).chain(lines).collect()
    }

    /// The same as data.
    pub fn json(&self) -> Value {
        let row = |line: &Line| {
            let set: serde_json::Map<String, Value> = self
                .targets
                .iter()
                .zip(&line.values)
                .map(|(target, value)| ((*target).to_owned(), json!(value)))
                .collect();
            let numbers = self.columns.iter().zip(&line.cells).map(|(column, value)| {
                // People read per cent, programs a share as everywhere.
                let (unit, size) = if column.unit == "%" { ("1", 0.01) } else { (column.unit, 1.0) };
                let value = value.map(|value| size * value);
                json!({ "metric": column.metric.name(), "signal": column.path, "unit": unit, "value": value })
            });
            let mut row =
                json!({ "set": set, "metrics": numbers.collect::<Vec<_>>(), "failed": line.failed });
            if self.is_kept {
                row["run"] = json!(line.name);
            }
            row
        };
        json!({ "v": 3, "type": "sweep", "runs": self.lines.iter().map(row).collect::<Vec<_>>() })
    }
}

impl Column<'_> {
    fn is_of(&self, measured: &Measured) -> bool {
        (self.metric, self.path, self.unit) == (measured.metric, &*measured.path, &*measured.unit)
    }

    /// `maximum error joint1`.
    fn words(&self) -> String {
        format!("{} {}", self.metric.heading(), self.name).trim_end().to_owned()
    }

    /// `maximum error joint1 [deg]`.
    fn heading(&self) -> String {
        if self.unit == "1" { self.words() } else { format!("{} [{}]", self.words(), self.unit) }
    }
}

/// A line of CSV; what holds a comma or a quote is quoted.
fn joined(cells: impl Iterator<Item = String>) -> String {
    let cell = |cell: String| match cell.contains([',', '"', '\n']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell,
    };
    format!("{}\n", cells.map(cell).collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::sweep::Values;
    use expect_test::expect;

    fn measured(metric: Metric, path: &str, unit: &str, value: Option<f64>) -> Measured {
        Measured { metric, path: path.into(), name: String::new(), unit: unit.into(), value }
    }

    fn over() -> Vec<Over> {
        let values = vec!["4".to_owned(), "8 mH".to_owned(), "[1, 2]".to_owned()];
        vec![Over { target: "pid.kp".into(), values: Values::Listed(values) }]
    }

    fn rows(over: &[Over]) -> Vec<Row<'_>> {
        let row = |n: usize, outcome| Row { values: vec![over[0].listed()[n].as_str()], outcome };
        let good = |error, overshoot| {
            vec![
                measured(Metric::MaximumError, "angle", "deg", Some(error)),
                measured(Metric::Overshoot, "angle", "%", overshoot),
            ]
        };
        vec![
            row(0, Ok(good(1.25, Some(10.5)))),
            row(1, Ok(good(0.5, None))),
            row(2, Err(Lost::Simulation("step size below 1e-12 s, \"x\"".into()))),
        ]
    }

    #[test]
    fn a_sweep_is_told_like_this() {
        let over = over();
        let rows = rows(&over);
        let sheet = Sheet::of(&over, &rows, false);
        expect![[r#"
            pid.kp  maximum error [deg]  overshoot [%]  failed
                 4                1.250          10.50
              8 mH                0.500              -
            [1, 2]                    -              -  step size below 1e-12 s, "x"

            lowest maximum error  0.5000 deg  at pid.kp=8 mH
        "#]]
        .assert_eq(&sheet.text(100, false));
        expect![[r#"
            pid.kp,maximum error [deg],overshoot [%],failed
            4,1.25,10.5,
            8 mH,0.5,,
            "[1, 2]",,,"step size below 1e-12 s, ""x"""
        "#]]
        .assert_eq(&sheet.csv());
        let data = sheet.json();
        assert_eq!(data["runs"][1]["set"]["pid.kp"], "8 mH");
        assert_eq!(data["runs"][0]["metrics"][1]["value"], 0.105);
        assert_eq!(data["runs"][0]["metrics"][1]["unit"], "1");
        assert!(data["runs"][1]["metrics"][1]["value"].is_null() && data["runs"][1]["failed"].is_null());
    }

    #[test]
    fn runs_stand_beside_each_other_where_lines_would_be_too_long() {
        let over = over();
        let row = |n: usize| Row {
            values: vec![over[0].listed()[n].as_str()],
            outcome: Ok(["a/scope", "b/scope", "c/scope"]
                .map(|path| Measured {
                    name: path.into(),
                    ..measured(Metric::MaximumError, path, "deg", Some(n as f64 + 0.5))
                })
                .to_vec()),
        };
        let rows = [row(0), row(1)];
        expect![[r#"
            pid.kp                           4   8 mH
            maximum error a/scope [deg]  0.500  1.500
            maximum error b/scope [deg]  0.500  1.500
            maximum error c/scope [deg]  0.500  1.500

            lowest maximum error a/scope  0.5000 deg  at pid.kp=4
            lowest maximum error b/scope  0.5000 deg  at pid.kp=4
            lowest maximum error c/scope  0.5000 deg  at pid.kp=4
        "#]]
        .assert_eq(&Sheet::of(&over, &rows, false).text(80, false));
    }

    #[test]
    fn runs_that_are_kept_have_names_and_random_ones_a_spread() {
        let over = over();
        let row = |n: usize| Row {
            values: vec![over[0].listed()[n].as_str()],
            outcome: Ok(vec![measured(Metric::Peak, "motor.i", "A", Some([1.0, 3.0, 2.0][n]))]),
        };
        let rows = [row(0), row(1), row(2)];
        expect![[r#"
            run  pid.kp  peak [A]
              1       4     1.000
              2    8 mH     3.000
              3  [1, 2]     2.000

                      minimum    5 %  median   95 %  maximum   mean  deviation
            peak [A]    1.000  1.100   2.000  2.900    3.000  2.000      1.000
        "#]]
        .assert_eq(&Sheet::of(&over, &rows, true).text(100, true));
        assert!(Sheet::of(&over, &rows, true).csv().starts_with("run,pid.kp,peak [A],failed\n1,4,1,"));
    }

    #[test]
    fn variants_with_other_signals_share_one_table() {
        let over = over();
        let row = |n: usize, path| Row {
            values: vec![over[0].listed()[n].as_str()],
            outcome: Ok(vec![measured(Metric::Peak, path, "1", Some(n as f64))]),
        };
        let rows = [row(0, "dc.i"), row(1, "asm.i")];
        let sheet = Sheet::of(&over, &rows, false);
        assert_eq!(
            sheet.lines.iter().map(|line| line.cells.clone()).collect::<Vec<_>>(),
            [[Some(0.0), None], [None, Some(1.0)]]
        );
    }
}
