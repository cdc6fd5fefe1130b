//! The mechanism of a run and how it moved.

use std::path::Path;

use blocksim_analysis::{Interpolation, Series};
use blocksim_blocks::robotics::Surroundings;
use blocksim_recording::{ALWAYS, Column, Run};
use blocksim_report::{Animation, Contact, Effort};
use serde_json::Value;

use super::meshes::{MeshSources, surfaces};
use super::numbers::readable;
use crate::mechanism::recorded::{Movement, mechanism, movement, scene, signals};
use crate::mechanism::surroundings;
use crate::mechanism::touching::look;

/// Contacts that a page has.
const TOLD: usize = 50;

/// What moves, and where it is over time; `None` where the run has no mechanism. Parts that cannot be drawn become
/// `warnings`.
///
/// # Errors
/// Why there is a mechanism that cannot be shown, in words.
pub fn read(
    folder: &Path,
    run: &Run,
    (around, reads_others): (&Surroundings, bool),
    full: bool,
    warnings: &mut Vec<String>,
) -> Result<Option<Animation>, String> {
    let Some(mut scene) = scene(folder)? else { return Ok(None) };
    let Some(movement) = movement(run, &scene)? else { return Ok(None) };
    let set = set_values(run, &movement);
    let efforts = efforts(run, &scene, &movement)?;
    let mechanism = mechanism(&scene).ok();
    let of_run = scene["shapes"].as_array().map_or(0, Vec::len);
    surroundings::draw(around, &mut scene);
    let sources = MeshSources { folder, of_run, reads_others };
    let surfaces = surfaces(&mut scene, sources, full, warnings);
    let mut contacts = Vec::new();
    let mut unlooked = Vec::new();
    if let Some(mechanism) = mechanism {
        let check = surroundings::check(&mechanism, around);
        let found = look(&check, &mechanism, &movement);
        contacts = found.history.contacts.into_iter().take(TOLD).map(contact).collect();
        unlooked = check.unchecked().to_vec();
    }
    let Movement { time, positions } = movement;
    Ok(Some(Animation { scene, surfaces, time, positions, set, efforts, contacts, unlooked }))
}

fn contact(found: blocksim_robotics::collision::Contact) -> Contact {
    let depth = -found.deepest.distance.distance;
    Contact { from: found.from, to: found.to, names: found.names, depth }
}

/// The first contact in words.
pub fn told(animation: &Animation) -> Option<String> {
    let Contact { from, names: [one, other], .. } = animation.contacts.first()?;
    let more = match animation.contacts.len() {
        1 => String::new(),
        n if n < TOLD => format!(", and {} more contacts follow", n - 1),
        _ => ", and many more contacts follow".to_owned(),
    };
    Some(format!("{one} touches {other} at {} s{more}.", readable(*from, 4)))
}

/// Signals that the 3D view of a run needs; none where it has none.
pub fn joints(folder: &Path) -> Vec<String> {
    let scene = scene(folder).ok().flatten();
    scene.and_then(|scene| signals(&scene).ok()).unwrap_or_default()
}

/// Set values of the joints: those of the scope whose actual value is the joint's position; the position itself where
/// there is no such scope. `None` if there is none for any joint.
fn set_values(run: &Run, movement: &Movement) -> Option<Vec<Vec<f64>>> {
    let Movement { time, positions } = movement;
    let mut found: Vec<Option<Vec<f64>>> = vec![None; positions.len()];
    for signal in run.signals() {
        let Some(block) = signal.path.strip_suffix(".actual") else { continue };
        let Ok(set) = run.find(&format!("{block}.set")) else { continue };
        let Ok(actual) = run.find(&signal.path).and_then(|at| run.read(at, &ALWAYS)) else { continue };
        for (found, position) in found.iter_mut().zip(positions) {
            if found.is_none() && *position == actual.values && *time == actual.time {
                *found = run.read(set, &ALWAYS).ok().map(|column| at_times(&column, time));
            }
        }
    }
    if found.iter().all(Option::is_none) {
        return None;
    }
    Some(found.into_iter().zip(positions).map(|(set, here)| set.unwrap_or_else(|| here.clone())).collect())
}

/// What the actuators of the joints exert, as far as the scene names signals for it.
fn efforts(run: &Run, scene: &Value, movement: &Movement) -> Result<Vec<Effort>, String> {
    let Some(list) = scene["actuators"].as_array() else { return Ok(Vec::new()) };
    let read = |one: &Value| {
        let body = one["body"].as_u64().and_then(|body| usize::try_from(body).ok());
        let (Some(body), Some(signal)) = (body, one["signal"].as_str()) else {
            return Err("an actuator of scene.json has no body or no signal".to_owned());
        };
        let at = run.find(signal).map_err(|_| format!("the run has no signal `{signal}`"))?;
        let column = run.read(at, &ALWAYS).map_err(|error| error.reason())?;
        let finite = column.values.iter().filter(|x| x.is_finite());
        let largest = finite.fold(0.0_f64, |most, x| most.max(x.abs()));
        Ok(Effort { body, signal: signal.to_owned(), values: at_times(&column, &movement.time), largest })
    };
    list.iter().map(read).collect()
}

/// The values of a signal at these times, behind its jumps.
fn at_times(column: &Column, time: &[f64]) -> Vec<f64> {
    let series = Series::new(&column.time, &column.values);
    time.iter().map(|&t| series.at(t, Interpolation::Linear, 0.0).map_or(f64::NAN, |at| at.1)).collect()
}
