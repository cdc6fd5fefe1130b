//! The pictures of a run as its scopes define them, and how its set values are followed.

use blocksim_analysis::jumps;
use blocksim_numbers::format::fixed;
use blocksim_picture::{Theme, pretty_unit, svg};
use blocksim_recording::{ALWAYS, Column};
use blocksim_report::{Panel, PlanePicture, Report, Role, Rows, Series, telling_rows};
use blocksim_signal::Unit;

use super::numbers::{readable, shortest};
use super::titles::Titles;
use crate::args::plot::Layout;
use crate::commands::plot::curves::{Drawn, add_once, read};
use crate::commands::plot::groups::{Group, chosen, groups};
use crate::commands::plot::metrics::{Row, rows};
use crate::commands::plot::panels::{figure, panel};
use crate::failure::Failure;
use crate::signals::display::turn;
use crate::signals::traces::Book;

/// Most pictures in a page.
const PANELS: usize = 60;
/// Most pictures of what no scope shows, beside those of scopes; where there are more, each is made when it is asked for.
const OTHERS: usize = 12;

/// Width of the picture of one signal over another, dots.
const PLANE_WIDTH: u32 = 640;

/// Values of a signal beyond which only those that tell its peaks are kept.
const LONG: usize = 1 << 18;
/// Stretches of time of such a signal, whose first, last, least and largest values are kept.
const STRETCHES: usize = 20_000;

/// Adds pictures and metrics. `joints` are signals that the 3D view needs; they have pictures of their own only
/// where no other picture shows them.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn add(
    books: &[Book; 1],
    titles: &Titles,
    joints: &[String],
    report: &mut Report,
) -> Result<(), Failure> {
    let book = &books[0];
    // Without a pattern everything fits.
    let selected = chosen(book, &[]).unwrap_or_default();
    let mut groups = groups(book, &selected, Layout::Scopes);
    let block = |group: &Group| book.traces[group.traces[0]].block();
    groups.sort_by_key(|group| titles.rank(block(group)));
    let scopes = groups.iter().filter(|group| titles.is_scope(block(group))).count();
    if scopes > 0 && groups.len() - scopes > OTHERS {
        groups.retain(|group| titles.is_scope(block(group)));
    }
    if groups.len() > PANELS {
        report
            .warnings
            .push(format!("Only the first {PANELS} of {} pictures are in this page.", groups.len()));
    }
    let mut all: Vec<Drawn> = Vec::new();
    for group in groups.into_iter().take(PANELS) {
        if group.over.is_some() {
            report.planes.push(plane(read(group, books, &ALWAYS)?, books));
            continue;
        }
        let columns = book.together(&group.traces, &ALWAYS)?;
        let mut drawn = Drawn { columns, ..Drawn::new(group) };
        for (&at, column) in drawn.group.traces.iter().zip(&mut drawn.columns) {
            let trace = &book.traces[at];
            column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
            drawn.steps.push(trace.held);
        }
        if !report.full {
            shorten(&mut drawn);
        }
        let is_joint = drawn.group.traces.iter().all(|&at| joints.contains(&book.traces[at].path));
        let is_known = |column: &Column| all.iter().any(|other| is_shown(column, &drawn, other));
        if !is_joint || !drawn.columns.iter().all(is_known) {
            add_once(&mut all, drawn);
        }
    }
    for drawn in &all {
        report.panels.extend(panels(drawn, book, titles));
        report.warnings.extend(not_finite(drawn));
    }
    report.metrics = table(&rows(&all, books, &ALWAYS, false)?);
    Ok(())
}

/// The picture of one signal over another.
fn plane(drawn: Drawn, books: &[Book; 1]) -> PlanePicture {
    let panel = panel(&drawn, books, &ALWAYS);
    let title =
        if panel.title.is_empty() { "One signal over another".to_owned() } else { panel.title.clone() };
    let [light, dark] = [Theme::Light, Theme::Dark].map(|theme| {
        let panel = blocksim_picture::Panel { title: String::new(), ..panel.clone() };
        svg(&figure(vec![panel], String::new(), (0.0, 1.0), Some(1), PLANE_WIDTH), theme)
    });
    PlanePicture { title, light, dark }
}

/// Leaves of very long signals the rows that tell all of their peaks, for memory's sake. Those with common times keep
/// common times.
fn shorten(drawn: &mut Drawn) {
    let mut done = vec![false; drawn.columns.len()];
    for first in 0..drawn.columns.len() {
        if done[first] || drawn.columns[first].time.len() <= LONG {
            continue;
        }
        let common = |at: &usize| drawn.columns[*at].time == drawn.columns[first].time;
        let same: Vec<usize> = (first..drawn.columns.len()).filter(common).collect();
        let values: Vec<&[f64]> = same.iter().map(|&at| drawn.columns[at].values.as_slice()).collect();
        let rows = telling_rows(&drawn.columns[first].time, &values, STRETCHES);
        for at in same {
            let Column { time, values } = &mut drawn.columns[at];
            *time = rows.iter().map(|&row| time[row]).collect();
            *values = rows.iter().map(|&row| values[row]).collect();
            done[at] = true;
        }
    }
}

/// Whether a picture shows these values already.
fn is_shown(column: &Column, drawn: &Drawn, other: &Drawn) -> bool {
    let same = |known: &Column| known.time == column.time && known.values == column.values;
    other.group.unit == drawn.group.unit && other.columns.iter().any(same)
}

/// A picture for each time base of a group.
fn panels(drawn: &Drawn, book: &Book, titles: &Titles) -> Vec<Panel> {
    let group = &drawn.group;
    let mut panels: Vec<Panel> = Vec::new();
    for (n, column) in drawn.columns.iter().enumerate() {
        let trace = &book.traces[group.traces[n]];
        let role = match group.pairs.iter().find(|pair| [pair.0, pair.1].contains(&n)) {
            Some(pair) if pair.0 == n => Role::Set,
            Some(_) => Role::Actual,
            None => Role::Plain,
        };
        let name = if group.names[n].is_empty() { trace.port() } else { &group.names[n] };
        let series = Series {
            name: name.to_owned(),
            path: trace.path.clone(),
            role,
            held: drawn.steps[n],
            values: column.values.clone(),
            other: None,
        };
        match panels.iter_mut().find(|panel| panel.time == column.time) {
            Some(panel) => panel.series.push(series),
            None => panels.push(Panel {
                group: titles.parent(trace.block()).unwrap_or(parent(trace.block())).to_owned(),
                title: if group.title.is_empty() { trace.path.clone() } else { group.title.clone() },
                unit: pretty_unit(&group.unit),
                time: column.time.clone(),
                turn: None,
                series: vec![series],
            }),
        }
    }
    let turn = Unit::parse(&group.unit).ok().and_then(|unit| turn(&unit));
    for panel in &mut panels {
        let has_jumped = |series: &Series, turn: f64| !jumps(&panel.time, &series.values, turn).is_empty();
        let jump = |turn: &f64| panel.series.iter().any(|series| has_jumped(series, *turn));
        panel.turn = turn.filter(jump);
    }
    panels
}

/// Path of the subsystem that a scope stands in.
///
/// That a scope is called `scope` tells nothing; it counts as its subsystem.
fn parent(block: &str) -> &str {
    let block = block.strip_suffix("/scope").unwrap_or(block);
    block.rsplit_once('/').map_or("", |(parent, _)| parent)
}

/// Says where a signal is not a number for the first time.
fn not_finite(drawn: &Drawn) -> Vec<String> {
    let named = drawn.columns.iter().zip(&drawn.group.names);
    named
        .filter_map(|(column, name)| {
            let at = column.values.iter().position(|x| !x.is_finite())?;
            let path = format!("{} {name}", drawn.group.title);
            let at = shortest(column.time[at]);
            Some(format!("{} has values that are no finite numbers, first at {at} s.", path.trim()))
        })
        .collect()
}

fn table(rows: &[Row]) -> Rows {
    let head = [
        "signal",
        "unit",
        "step",
        "rise [s]",
        "overshoot",
        "settling [s]",
        "IAE",
        "final error",
        "maximum error",
        "at [s]",
    ];
    // Those of fast circuits are far below a second.
    let time = |t: f64| if t != 0.0 && t.abs() < 0.01 { readable(t, 3) } else { fixed(t, 3) };
    let seconds = |t: Option<f64>| t.map_or_else(|| "–".to_owned(), time);
    let row = |Row { name, unit, metrics: m, .. }: &Row| {
        vec![
            name.clone(),
            pretty_unit(unit),
            readable(m.step, 4),
            seconds(m.rise),
            m.overshoot.map_or_else(|| "–".to_owned(), |x| format!("{} %", fixed(100.0 * x, 2))),
            seconds(m.settling),
            readable(m.iae, 4),
            readable(m.steady_state_error, 3),
            readable(m.max_error, 3),
            time(m.max_error_at),
        ]
    };
    Rows { head: head.map(str::to_owned).to_vec(), rows: rows.iter().map(row).collect() }
}
