//! What the scopes of a model show: the same pictures as those of the page of a run, before there is a run.

use blocksim_block::schedule::Schedule;
use blocksim_diagram::PanelItem;
use blocksim_picture::pretty_unit;
use blocksim_report::{Panel, Role, Series};
use blocksim_signal::Unit;
use serde_json::{Value, json};

use super::panel::alone;
use crate::args::plot::Layout;
use crate::commands::plot::groups::{Group, chosen, groups};
use crate::signals::display::{layout, turn};
use crate::signals::traces::Book;

/// Most signals that are shown while a run runs.
const MOST: usize = 96;

/// A picture to come.
pub struct Scope {
    /// The picture without values.
    pub panel: Panel,
    /// For each of its series the position among what is recorded, and the unit that it is shown in.
    pub sources: Vec<(usize, Unit)>,
}

/// The pictures of a model, in the order of the page of a run, without those of signals that its panel shows alone.
pub fn scopes(schedule: &Schedule, panel: &[PanelItem]) -> Vec<Scope> {
    let book = Book::to_come(&layout(&schedule.recorded).signals);
    let Ok(mut shown) = chosen(&book, &[]) else { return Vec::new() };
    let alone = alone(panel);
    shown.retain(|&at| !alone.contains(&book.traces[at].path.as_str()));
    let mut scopes = Vec::new();
    let mut left = MOST;
    // What is drawn over another signal than time is seen when the run is over.
    for group in groups(&book, &shown, Layout::Scopes).into_iter().filter(|group| group.over.is_none()) {
        left = match left.checked_sub(group.traces.len()) {
            Some(left) => left,
            None => break,
        };
        scopes.push(scope(&group, &book));
    }
    scopes
}

fn scope(group: &Group, book: &Book) -> Scope {
    let series = group.traces.iter().enumerate().map(|(n, &at)| {
        let trace = &book.traces[at];
        let role = match group.pairs.iter().find(|pair| [pair.0, pair.1].contains(&n)) {
            Some(pair) if pair.0 == n => Role::Set,
            Some(_) => Role::Actual,
            None => Role::Plain,
        };
        let name = if group.names[n].is_empty() { trace.port() } else { &group.names[n] };
        let (name, path) = (name.to_owned(), trace.path.clone());
        Series { name, path, role, held: trace.held, values: Vec::new(), other: None }
    });
    let first = &book.traces[group.traces[0]];
    let panel = Panel {
        group: String::new(),
        title: if group.title.is_empty() { first.path.clone() } else { group.title.clone() },
        unit: pretty_unit(&group.unit),
        time: Vec::new(),
        turn: Unit::parse(&group.unit).ok().and_then(|unit| turn(&unit)),
        series: series.collect(),
    };
    Scope { panel, sources: group.traces.iter().map(|&at| (at, book.traces[at].unit.clone())).collect() }
}

/// Pictures as the page takes them; each series has a column, counted through all of them.
pub fn panels_json(scopes: &[Scope]) -> Value {
    let mut column = 0;
    let panels = scopes.iter().map(|Scope { panel, .. }| {
        let series = panel.series.iter().map(|series| {
            column += 1;
            let role = match series.role {
                Role::Plain => "plain",
                Role::Set => "set",
                Role::Actual => "actual",
            };
            json!({ "name": series.name, "path": series.path, "role": role, "held": series.held, "column": column - 1 })
        });
        json!({
            "group": panel.group, "title": panel.title, "unit": panel.unit, "turn": panel.turn,
            "series": series.collect::<Vec<_>>(),
        })
    });
    panels.collect()
}
