//! Pictures and movement as numbers of the page.

use serde_json::{Value, json};

use crate::data::{Animation, Contact, Effort, Panel, Role, Series};
use crate::pack::Pack;
use crate::thin;

/// Instants of the movement.
const FRAMES: usize = 1200;
/// Share of its range that the mean of a signal may be off before the page says so.
const ROUGH: f64 = 0.005;

/// Data of a picture. Where there are a set and an actual value, the difference is kept instead of the actual value:
/// so it keeps all its digits.
pub fn picture(panel: &Panel, full: bool, columns: usize, pack: &mut Pack) -> Value {
    let own = panel.series.iter().map(|series| series.values.as_slice());
    let others = panel.series.iter().filter_map(|series| series.other.as_deref());
    let signals: Vec<&[f64]> = own.chain(others).collect();
    let rows: Vec<usize> =
        if full { (0..panel.time.len()).collect() } else { thin::rows(&panel.time, &signals, columns) };
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    // All values with all digits.
    let put = |values: &[f64], pack: &mut Pack| if full { pack.wide(values) } else { pack.narrow(values) };
    // Of several pairs there is no one difference to keep.
    let find = |role: Role| {
        let mut all = (0..panel.series.len()).filter(|&at| panel.series[at].role == role);
        all.next().filter(|_| all.next().is_none())
    };
    let pair = find(Role::Set).zip(find(Role::Actual));
    let series: Vec<Value> = panel
        .series
        .iter()
        .enumerate()
        .map(|(at, series)| {
            let role = match series.role {
                Role::Plain => "plain",
                Role::Set => "set",
                Role::Actual => "actual",
            };
            let mut entry =
                json!({ "name": series.name, "path": series.path, "role": role, "held": series.held });
            match pair {
                Some((set, actual)) if actual == at => {
                    let off = panel.series[set].values.iter().zip(&series.values).map(|(s, a)| s - a);
                    entry["error"] = put(&pick(&off.collect::<Vec<f64>>()), pack);
                }
                _ => entry["values"] = put(&pick(&series.values), pack),
            }
            if is_rough(panel, series, &rows) {
                entry["rough"] = true.into();
            }
            if let Some(other) = &series.other {
                entry["other"] = put(&pick(other), pack);
            }
            entry
        })
        .collect();
    json!({
        "group": panel.group, "title": panel.title, "unit": panel.unit, "turn": panel.turn,
        "pair": pair.map(|(set, actual)| [set, actual]),
        "time": pack.wide(&pick(&panel.time)), "series": series,
    })
}

/// Whether mean or root mean square of the rows that are kept tell little of those of all.
fn is_rough(panel: &Panel, series: &Series, rows: &[usize]) -> bool {
    if rows.len() == panel.time.len() {
        return false;
    }
    let finite = || series.values.iter().copied().filter(|x| x.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let all = thin::means(&panel.time, &series.values, series.held, 0..panel.time.len());
    let kept = thin::means(&panel.time, &series.values, series.held, rows.iter().copied());
    (all.0 - kept.0).abs().max((all.1 - kept.1).abs()) > ROUGH * range
}

/// Data of the mechanism and of its movement, at instants that a screen can show.
pub fn movement(animation: &Animation, pack: &mut Pack) -> Value {
    let rows = frames(&animation.time);
    let pick = |values: &Vec<f64>| {
        rows.iter().map(|&row| values.get(row).copied().unwrap_or(0.0)).collect::<Vec<f64>>()
    };
    let time = pack.wide(&pick(&animation.time));
    let positions: Vec<Value> = animation.positions.iter().map(|values| pack.narrow(&pick(values))).collect();
    let set: Option<Vec<Value>> =
        animation.set.as_ref().map(|set| set.iter().map(|values| pack.narrow(&pick(values))).collect());
    let effort = |effort: &Effort, pack: &mut Pack| {
        json!({
            "body": effort.body, "signal": effort.signal, "largest": effort.largest,
            "values": pack.narrow(&pick(&effort.values)),
        })
    };
    let efforts: Vec<Value> = animation.efforts.iter().map(|one| effort(one, pack)).collect();
    let surfaces: Vec<Value> = animation.surfaces.iter().map(|surface| surface.data(pack)).collect();
    let contact = |contact: &Contact| {
        json!([contact.from, contact.to, contact.names[0], contact.names[1], contact.depth])
    };
    let contacts: Vec<Value> = animation.contacts.iter().map(contact).collect();
    json!({
        "scene": animation.scene, "contacts": contacts, "unlooked": animation.unlooked, "time": time, "positions": positions, "set": set,
        "surfaces": surfaces, "efforts": efforts,
    })
}

/// Rows at about equal distances in time.
fn frames(time: &[f64]) -> Vec<usize> {
    let (Some(&begin), Some(&end)) = (time.first(), time.last()) else { return Vec::new() };
    if time.len() <= FRAMES {
        return (0..time.len()).collect();
    }
    let at = |frame: usize| begin + (end - begin) * frame as f64 / (FRAMES - 1) as f64;
    let mut rows: Vec<usize> =
        (0..FRAMES).map(|frame| time.partition_point(|&t| t < at(frame)).min(time.len() - 1)).collect();
    rows.dedup();
    rows
}
