//! What is said of contacts and distances: to people, as data.

use blocksim_numbers::format::fixed;
use blocksim_robotics::collision::Nearest;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::Looked;
use crate::terminal::format::short_time;

/// Contacts that are listed.
const CONTACTS: usize = 20;
/// Distances that are listed.
const DISTANCES: usize = 8;

/// For people.
pub fn text(looked: &Looked, all: bool) -> String {
    let history = &looked.found.history;
    let [from, to] = looked.span.map(short_time);
    let mut text = format!(
        "{} poses from {from} s to {to} s, parts move at most {} mm from one to the next\n",
        history.poses,
        fixed(1e3 * looked.found.stride, 1)
    );
    if looked.pairs == 0 {
        return text + "nothing can touch: no two parts with shapes are neither neighbours nor on one body\n";
    }
    let most = |usual: usize| if all { usize::MAX } else { usual };
    if history.contacts.is_empty() {
        text += "nothing touches\n";
    } else {
        let mut table = headed(&["from [s]", "to [s]", "deepest [mm]", "at [s]"], "", "touches");
        for contact in history.contacts.iter().take(most(CONTACTS)) {
            let depth = fixed(-1e3 * contact.deepest.distance.distance, 1);
            let numbers =
                [short_time(contact.from), short_time(contact.to), depth, short_time(contact.deepest.time)];
            let [one, other] = contact.names.clone();
            table.row(numbers.into_iter().chain([place(&contact.deepest), one, other]));
        }
        text += &format!("\n{}", table.render());
        text += &more(history.contacts.len(), most(CONTACTS), "contacts");
    }
    if !history.nearest.is_empty() {
        let mut table = headed(&["distance [mm]", "at [s]"], "nearest", "to");
        for ([one, other], nearest) in history.nearest.iter().take(most(DISTANCES)) {
            let numbers = [fixed(1e3 * nearest.distance.distance, 1), short_time(nearest.time)];
            table.row(numbers.into_iter().chain([place(nearest), one.clone(), other.clone()]));
        }
        text += &format!("\n{}", table.render());
        text += &more(history.nearest.len(), most(DISTANCES), "pairs that never touch");
    }
    text
}

fn headed(numbers: &[&str], one: &str, other: &str) -> Table {
    let numbers = numbers.iter().map(|heading| (*heading, Align::Right));
    let names = [("x, y, z [mm]", Align::Right), (one, Align::Left), (other, Align::Left)];
    Table::new(&numbers.chain(names).collect::<Vec<_>>())
}

fn place(nearest: &Nearest) -> String {
    let point = nearest.distance.points[0];
    [point.x, point.y, point.z].map(|x| fixed(1e3 * x, 0)).join(", ")
}

fn more(all: usize, told: usize, what: &str) -> String {
    match all.saturating_sub(told) {
        0 => String::new(),
        1 => format!("and one more of the {what}; --all lists it\n"),
        n => format!("and {n} more of the {what}; --all lists them\n"),
    }
}

/// What the reader must know.
pub fn notes(looked: &Looked) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    for [one, other] in &looked.left_out {
        notes.push(format!("note: `{one}` and `{other}` touch at the start and are not checked"));
    }
    for name in &looked.meshes {
        notes.push(format!(
            "note: the mesh of `{name}` is not checked\n  = help: give it simple shapes with `use: Text(\"collision\")`"
        ));
    }
    let found = &looked.found;
    if found.unknown > 0 {
        notes.push(format!(
            "note: at {} times the position is not a number; they are left out",
            found.unknown
        ));
    }
    if found.every > 1 {
        notes.push(format!(
            "note: one in {} recorded times was checked\n  = help: --from and --to look closer",
            found.every
        ));
    }
    notes
}

/// For programs; SI units.
pub fn data(looked: &Looked) -> Value {
    let history = &looked.found.history;
    let point = |nearest: &Nearest| <[f64; 3]>::from(nearest.distance.points[0]);
    let contacts: Vec<Value> = history
        .contacts
        .iter()
        .map(|contact| {
            json!({
                "names": contact.names, "from": contact.from, "to": contact.to,
                "depth": -contact.deepest.distance.distance, "time": contact.deepest.time, "point": point(&contact.deepest),
            })
        })
        .collect();
    let distances: Vec<Value> = history
        .nearest
        .iter()
        .map(|(names, nearest)| {
            json!({
                "names": names, "distance": nearest.distance.distance, "time": nearest.time, "point": point(nearest),
            })
        })
        .collect();
    json!({
        "v": 1, "type": "collisions", "contacts": contacts, "distances": distances, "from": looked.span[0], "to": looked.span[1],
        "poses": history.poses, "stride": looked.found.stride, "pairs": looked.pairs, "left_out": looked.left_out,
        "meshes": looked.meshes, "unknown": looked.found.unknown, "every": looked.found.every,
    })
}
