//! The result of a comparison: to people, to programs, as a drawing.

use blocksim_analysis::{Deviation, Interpolation, Series, refined, together};
use blocksim_numbers::format::{count, significant};
use blocksim_picture::{Figure, Line, Panel, Strip, Style, thinned};
use blocksim_recording::{ALWAYS, Column};
use blocksim_report::{Compared, Rows};
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::verdict::{Found, Verdict, rule, without_turns};
use crate::args::plot::CompareArgs;
use crate::failure::Failure;
use crate::signals::other::other_values;
use crate::signals::traces::Book;
use crate::terminal::format::short_time;
use crate::terminal::render::plural;

/// Most signals in the table and in the drawing.
const ROWS: usize = 60;
const PANELS: usize = 24;
/// Headings of the table; the first two are words.
const COLUMNS: [&str; 8] = [
    "signal",
    "verdict",
    "maximum difference",
    "at [s]",
    "first beyond, at [s]",
    "baseline",
    "compared",
    "allowed",
];
/// Columns of a screen to which courses are thinned.
const SCREEN: usize = 1600;

/// All that is found.
pub struct Comparison<'a> {
    /// Command line.
    pub args: &'a CompareArgs,
    /// Baseline and other recording.
    pub books: &'a [Book; 2],
    /// What the picture is called.
    pub title: String,
    /// The signals of the baseline.
    pub found: Vec<Found>,
    /// What was added to the times of the other recording, s.
    pub shift: f64,
    /// Signals that only the other recording has.
    pub extra: Vec<String>,
}

impl Comparison<'_> {
    /// Whether all signals agree; missing ones are passed over where only common ones are asked for.
    pub fn agrees(&self) -> bool {
        self.found.iter().all(|found| self.counts_as_agreeing(found))
    }

    fn counts_as_agreeing(&self, found: &Found) -> bool {
        found.verdict.agrees() || (self.args.common && found.verdict == Verdict::Missing)
    }

    /// Table and summary.
    pub fn text(&self) -> String {
        let side = |head: &&'static str| {
            (*head, if COLUMNS[..2].contains(head) { Align::Left } else { Align::Right })
        };
        let mut table = Table::new(&COLUMNS.iter().map(side).collect::<Vec<_>>());
        let rows = self.worst_first(&|found| found.verdict != Verdict::Same);
        for found in rows.iter().take(ROWS) {
            table.row(self.row(found));
        }
        let mut text = if rows.is_empty() { String::new() } else { format!("{}\n", table.render()) };
        if rows.len() > ROWS {
            text.push_str(&format!("and {} more\n", rows.len() - ROWS));
        }
        text.push_str(&self.summary());
        text
    }

    /// The signals that are wanted, those that do not agree first.
    fn worst_first(&self, wanted: &dyn Fn(&Found) -> bool) -> Vec<&Found> {
        let told = || self.found.iter().filter(|found| wanted(found));
        let mut rows: Vec<&Found> = told().filter(|found| !self.counts_as_agreeing(found)).collect();
        rows.extend(told().filter(|found| self.counts_as_agreeing(found)));
        rows
    }

    /// A line of the table.
    fn row(&self, found: &Found) -> [String; 8] {
        let unit = found.unit.to_string();
        // However small it is, it is not shown as none.
        let difference = |d: &Deviation| {
            let number = significant(d.difference() / found.unit.scale, 4);
            if unit == "1" { number } else { format!("{number} {unit}") }
        };
        let value = |x: f64| significant(found.unit.from_si(x), 6);
        let dash = || "-".to_owned();
        let cell =
            |d: Option<Deviation>, show: &dyn Fn(&Deviation) -> String| d.as_ref().map_or_else(dash, show);
        let (maximum, first) = (found.comparison.maximum, found.comparison.first);
        [
            self.books[0].traces[found.at].path.clone(),
            words(&found.verdict),
            cell(maximum, &difference),
            cell(maximum, &|d| short_time(d.time)),
            cell(first, &|d| short_time(d.time)),
            cell(first, &|d| value(d.baseline)),
            cell(first, &|d| value(d.compared)),
            cell(first, &|d| significant(d.tolerance / found.unit.scale, 3)),
        ]
    }

    /// The same for a page.
    pub fn compared(&self) -> Compared {
        let told = self.worst_first(&|_| true);
        let first = |(row, found): (usize, &&Found)| {
            let first = found.comparison.first?;
            Some((row, self.books[0].traces[found.at].path.clone(), first.time))
        };
        let mut marks: Vec<(usize, String, f64)> = told.iter().enumerate().filter_map(first).collect();
        marks.sort_by(|a, b| a.2.total_cmp(&b.2));
        Compared {
            name: self.books[1].label.clone(),
            summary: self.summary().lines().collect::<Vec<_>>().join("; "),
            rows: Rows {
                head: COLUMNS.map(str::to_owned).to_vec(),
                rows: told.iter().map(|found| self.row(found).to_vec()).collect(),
            },
            marks,
        }
    }

    fn summary(&self) -> String {
        let of = |fits: &dyn Fn(&Found) -> bool| self.found.iter().filter(|found| fits(found)).count();
        let wrong = of(&|found| !self.counts_as_agreeing(found));
        let (same, within) = (of(&|f| f.verdict == Verdict::Same), of(&|f| f.verdict == Verdict::Within));
        let mut lines = Vec::new();
        if self.shift != 0.0 {
            lines.push(format!("`{}` is shifted by {} s", self.books[1].name, short_time(self.shift)));
        }
        let name = &self.books[1].name;
        let verb = |n: usize| if n == 1 { "is" } else { "are" };
        let missing = of(&|f| f.verdict == Verdict::Missing);
        if self.args.common && missing > 0 {
            lines.push(format!(
                "{} of the baseline {} missing in `{name}`",
                plural(missing, "signal"),
                verb(missing)
            ));
        }
        if !self.extra.is_empty() {
            let n = self.extra.len();
            lines.push(format!("{} {} in `{name}` alone", plural(n, "signal"), verb(n)));
        }
        lines.push(match wrong {
            0 => format!(
                "{} {}: {} exactly, {} within the tolerances",
                plural(same + within, "signal"),
                if same + within == 1 { "agrees" } else { "agree" },
                count(same as u64),
                count(within as u64)
            ),
            1 => format!("1 of {} does not agree", plural(self.found.len(), "signal")),
            n => format!("{n} of {} do not agree", plural(self.found.len(), "signal")),
        });
        if wrong > 0 && self.found.iter().all(|found| self.counts_as_agreeing(found) || is_rounding(found)) {
            lines.push(
                "they differ by rounding alone, as units and times bring it; `--rel 1e-9` allows that"
                    .to_owned(),
            );
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// The same as data; numbers in the units named.
    pub fn json(&self) -> Value {
        let deviation = |found: &Found, d: Option<Deviation>| {
            let unit = &found.unit;
            d.map(|d| {
                json!({
                    "time": d.time,
                    "baseline": unit.from_si(d.baseline),
                    "compared": unit.from_si(d.compared),
                    "difference": d.difference() / unit.scale,
                    "tolerance": d.tolerance / unit.scale,
                })
            })
        };
        let signal = |found: &Found| {
            let comparison = &found.comparison;
            json!({
                "signal": self.books[0].traces[found.at].path,
                "unit": found.unit.to_string(),
                "verdict": found.verdict.word(),
                "agrees": self.counts_as_agreeing(found),
                "span": comparison.span.map(|(from, to)| [from, to]),
                "points": comparison.points,
                "outside": comparison.outside,
                "rms": comparison.rms / found.unit.scale,
                "maximum": deviation(found, comparison.maximum),
                "first": deviation(found, comparison.first),
            })
        };
        json!({
            "v": 2,
            "type": "comparison",
            "baseline": self.books[0].name,
            "other": self.books[1].name,
            "agrees": self.agrees(),
            "shift": self.shift,
            "signals": self.found.iter().map(signal).collect::<Vec<_>>(),
            "only_in_other": self.extra,
        })
    }

    /// Both signals and their difference with its limits: those that differ, or all if none does.
    ///
    /// # Errors
    /// What to tell the person at the keyboard.
    pub fn figure(&self) -> Result<Figure, Failure> {
        let drawable =
            || self.found.iter().filter(|found| found.there.is_some() && found.comparison.span.is_some());
        let mut chosen: Vec<&Found> = drawable().filter(|found| !found.verdict.agrees()).collect();
        if chosen.is_empty() {
            chosen = drawable().collect();
        }
        let spans = drawable().filter_map(|found| found.comparison.span);
        let time = spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 1.0));
        let panels: Result<Vec<Panel>, Failure> =
            chosen.iter().take(PANELS).map(|found| self.panel(found, time)).collect();
        let panels = panels?;
        let columns = if panels.len() > 2 { 2 } else { 1 };
        let title = self.title.clone();
        Ok(Figure { title, panels, columns, time, width: 960.0, ..Figure::default() })
    }

    fn panel(&self, found: &Found, time: (f64, f64)) -> Result<Panel, Failure> {
        let trace = &self.books[0].traces[found.at];
        let (unit, range) = (&found.unit, time.0..=time.1);
        let mut rule = rule(self.args, trace);
        rule.absolute /= unit.scale;
        let held = rule.interpolation == Interpolation::Hold;
        let mut a = self.books[0].read(found.at, &ALWAYS)?;
        let mut b = match found.there {
            Some(there) => other_values(&self.books[1], there, trace, self.shift)?,
            None => Column::default(),
        };
        (a, b) = without_turns(a, b, trace);
        for column in [&mut a, &mut b] {
            column.values.iter_mut().for_each(|value| *value = unit.from_si(*value));
        }
        let rule = rule.over(&Series::new(&a.time, &a.values));
        let lines = [(&a, 0, &self.books[0]), (&b, 1, &self.books[1])].map(|(column, colour, book)| Line {
            name: book.label.clone(),
            colour,
            style: if book.is_run { Style::Solid } else { Style::Dotted },
            thin: colour > 0 && book.is_run,
            courses: thinned(&column.time, &column.values, &range, SCREEN, held),
        });
        // Where both have rows of their own, lines between them would make a difference of their own.
        let (of_a, of_b) = match rule.interpolation != Interpolation::Smooth || a.time == b.time {
            true => ((a.time.clone(), a.values.clone()), (b.time.clone(), b.values.clone())),
            false => (refined(&a.time, &a.values), refined(&b.time, &b.values)),
        };
        let (of_a, of_b) = (Series::new(&of_a.0, &of_a.1), Series::new(&of_b.0, &of_b.1));
        let (time_of, base, there) = match held {
            false => together(of_a, of_b),
            true => at_times_of(of_b, of_a),
        };
        let difference: Vec<f64> = base.iter().zip(&there).map(|(base, there)| there - base).collect();
        let limit = |base: &f64| rule.absolute.max(rule.relative * base.abs());
        let limit: Vec<f64> = base.iter().map(limit).collect();
        let limits = |sign: f64| {
            let values: Vec<f64> = limit.iter().map(|x| sign * x).collect();
            let courses = thinned(&time_of, &values, &range, SCREEN, held);
            Line { style: Style::Limit, courses, ..Line::default() }
        };
        let drawn = Line {
            colour: 1,
            courses: thinned(&time_of, &difference, &range, SCREEN, held),
            ..Line::default()
        };
        let strip = Strip { name: "difference".to_owned(), lines: vec![drawn, limits(1.0), limits(-1.0)] };
        Ok(Panel {
            title: trace.path.clone(),
            unit: unit.to_string(),
            lines: lines.into(),
            strip: Some(strip),
            plane: None,
            notes: Vec::new(),
        })
    }
}

/// Two held signals at the times of the first, as far as the second covers them.
fn at_times_of(b: Series, a: Series) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (from, to) = a.span().unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    let mut rows = (Vec::new(), Vec::new(), Vec::new());
    for (&t, &there) in b.time.iter().zip(b.values).filter(|(t, _)| (from..=to).contains(*t)) {
        if let Some((_, base)) = a.at(t, Interpolation::Hold, 0.0) {
            rows.0.push(t);
            rows.1.push(base);
            rows.2.push(there);
        }
    }
    rows
}

fn words(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Same => "same".to_owned(),
        Verdict::Within => "within".to_owned(),
        Verdict::Differs => "DIFFERS".to_owned(),
        Verdict::Short(from, to) => format!("SHORT, only {} s to {} s", short_time(*from), short_time(*to)),
        Verdict::Missing => "MISSING".to_owned(),
        Verdict::OtherUnit(unit) => format!("in {unit}, another UNIT"),
        Verdict::Nothing => "NO COMMON TIME".to_owned(),
    }
}

/// Whether the maximum difference of a signal is nothing beside its value there.
fn is_rounding(found: &Found) -> bool {
    let is_small = |d: Deviation| {
        let difference = d.difference().abs();
        difference.is_finite() && difference <= 1e-9 * d.baseline.abs().max(d.compared.abs())
    };
    found.verdict == Verdict::Differs && found.comparison.maximum.is_some_and(is_small)
}
