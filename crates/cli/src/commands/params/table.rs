//! Parameters as lines.

use std::path::Path;

use blocksim_block::problem::Place;
use blocksim_diagram::{Origin, Target, WrittenUnit};
use blocksim_signal::{Quantity, Unit, Value};
use blocksim_terminal::{Align, Table};
use serde_json::json;

use crate::failure::Failure;
use crate::terminal::places::Texts;

/// A row for each parameter, with a heading if asked for.
pub fn rows(targets: &[&Target], texts: &Texts, has_heading: bool) -> String {
    let headings = if has_heading { ["parameter", "value", "unit", "from"] } else { [""; 4] };
    let aligned = [Align::Left, Align::Right, Align::Left, Align::Left];
    let columns: Vec<(&str, Align)> = headings.into_iter().zip(aligned).collect();
    let mut table = Table::new(&columns);
    for target in targets {
        let (value, unit, _) = shown(target);
        table.row([target.name.clone(), value, unit, from(target, texts)]);
    }
    let text = table.render();
    if has_heading { text } else { text.trim_start_matches('\n').trim_start().to_owned() }
}

/// A value with its unit, and whether it stands so in the text.
pub fn shown(target: &Target) -> (String, String, bool) {
    let written = unquoted(&target.written);
    let end = written.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c))).unwrap_or(written.len());
    let (number, unit) = (&written[..end], written[end..].trim());
    let is_number = number.parse::<f64>().is_ok();
    if is_number && (unit.is_empty() || Unit::parse(unit).is_ok()) {
        let unit = if unit.is_empty() { &target.unit } else { unit };
        return (number.to_owned(), unit.to_owned(), true);
    }
    match &target.value {
        Some(Value::Number(quantity)) => {
            if let WrittenUnit::One(unit) = &target.written_unit {
                // Without the dust of the conversion.
                let number = format!("{:.14e}", unit.from_si(quantity.value)).parse().unwrap_or(f64::NAN);
                return (Quantity::plain(number).display(), unit.text.clone(), false);
            }
            let text = quantity.display();
            let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
            (number.to_owned(), unit.to_owned(), false)
        }
        Some(Value::Set(members)) => (format!("set of {}", members.len()), String::new(), false),
        _ => (short(written), String::new(), true),
    }
}

/// Where it comes from, with the expression if it is one.
fn from(target: &Target, texts: &Texts) -> String {
    let (_, _, is_written) = shown(target);
    let told = if is_written { String::new() } else { format!("  {}", short(unquoted(&target.written))) };
    match &target.origin {
        Origin::Text(place) => format!("{}{told}", located(place, texts)),
        Origin::Declared(place) => format!("default, {}{told}", located(place, texts)),
        Origin::Kind(kind) => format!("default of {kind}"),
    }
}

fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
}

/// One line of a few signs.
fn short(text: &str) -> String {
    const MOST: usize = 30;
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
}

/// `file:line:column`.
pub fn located(place: &Place, texts: &Texts) -> String {
    let Some((path, line, column)) = counted(place, texts) else { return String::new() };
    format!("{path}:{line}:{column}")
}

fn counted(place: &Place, texts: &Texts) -> Option<(String, usize, usize)> {
    let (file, line, column) = texts.located(place)?;
    Some((file.path.display().to_string(), line, column))
}

/// As a line of JSON; the value in SI.
pub fn data(target: &Target, texts: &Texts) -> String {
    let (origin, place) = match &target.origin {
        Origin::Text(place) => ("text", Some(place)),
        Origin::Declared(place) => ("declared", Some(place)),
        Origin::Kind(_) => ("default", None),
    };
    let counted = place.and_then(|place| counted(place, texts));
    let plain = |value: &Value| match value {
        Value::Number(quantity) => (json!(quantity.value), json!(quantity.dimension.to_string())),
        Value::Bool(value) => (json!(value), json!(null)),
        Value::Text(text) => (json!(text), json!(null)),
        other => (json!(other.to_string()), json!(null)),
    };
    let (value, unit) = target.value.as_ref().map_or((json!(null), json!(null)), plain);
    let line = json!({
        "v": 1,
        "type": "parameter",
        "name": target.name,
        "written": target.written,
        "value": value,
        "unit": unit,
        "origin": origin,
        "file": counted.as_ref().map(|(file, ..)| file),
        "line": counted.as_ref().map(|(_, line, _)| line),
        "column": counted.as_ref().map(|(.., column)| column),
        "sharers": target.sharers,
    });
    format!("{line}\n")
}

/// That nothing has this name.
pub fn unknown(model: &Path, target: &str, help: &str) -> Failure {
    Failure::usage(format!("`{}` has no parameter `{target}`", model.display())).help(help)
}
