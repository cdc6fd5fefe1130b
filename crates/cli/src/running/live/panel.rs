//! The panel of a model as the page takes it, and the signals that it shows while a run goes on.

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{PanelAction, PanelItem};
use blocksim_picture::pretty_unit;
use blocksim_signal::Unit;
use serde_json::{Value, json};

use crate::signals::display::layout;
use crate::signals::traces::Book;

/// A signal that a gauge or a lamp shows.
pub struct Shown {
    /// Its name.
    pub path: String,
    /// Its position among what is recorded, and the unit that it is shown in.
    pub source: (usize, Unit),
}

/// The signals that a panel shows, in its order.
pub fn shown(items: &[PanelItem], schedule: &Schedule) -> Vec<Shown> {
    let book = Book::to_come(&layout(&schedule.recorded).signals);
    let of_item = |item: &PanelItem| {
        let PanelAction::Shows { recorded, unit, .. } = &item.action else { return None };
        let usual = &book.traces.get(*recorded)?.unit;
        let unit = unit.clone().unwrap_or_else(|| usual.clone());
        Some(Shown { path: item.name.clone(), source: (*recorded, unit) })
    };
    items.iter().filter_map(of_item).collect()
}

/// Signals that are recorded for a panel alone: scopes leave them to it.
pub fn alone(items: &[PanelItem]) -> Vec<&str> {
    let is_alone = |item: &&PanelItem| matches!(item.action, PanelAction::Shows { alone: true, .. });
    items.iter().filter(is_alone).map(|item| item.name.as_str()).collect()
}

/// What the controls of a panel stand at with what is set. A page whose model has been changed since finds its own by their units and
/// values.
pub fn standing(items: &[PanelItem]) -> Value {
    let data = |item: &PanelItem| match &item.action {
        PanelAction::Number { now, unit, .. } => {
            Some(json!({ "name": item.name, "unit": unit, "value": now }))
        }
        PanelAction::Two { off, on, is_on_now, .. } => {
            Some(json!({ "name": item.name, "off": off, "on": on, "isOn": is_on_now }))
        }
        PanelAction::Shows { .. } => None,
    };
    items.iter().filter_map(data).collect()
}

/// A panel for the page; signals are those of [`shown`], one after the other.
pub fn json(items: &[PanelItem], schedule: Option<&Schedule>) -> Value {
    let signals = schedule.map(|schedule| shown(items, schedule)).unwrap_or_default();
    let mut signals = signals.into_iter();
    let data = |item: &PanelItem| {
        let mut data = json!({ "kind": item.word.name(), "name": item.name, "label": item.label });
        match &item.action {
            PanelAction::Number { range, value, unit, .. } => {
                (data["range"], data["value"], data["unit"]) = (json!(range), json!(value), json!(unit));
                data["shown"] = pretty_unit(unit).into();
            }
            PanelAction::Two { off, on, is_on, .. } => {
                (data["off"], data["on"], data["isOn"]) = (json!(off), json!(on), json!(is_on));
            }
            PanelAction::Shows { range, .. } => {
                let unit = signals.next().map(|shown| pretty_unit(&shown.source.1.text));
                (data["range"], data["unit"]) = (json!(range), json!(unit.unwrap_or_default()));
            }
        }
        data
    };
    items.iter().map(data).collect()
}
