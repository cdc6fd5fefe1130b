//! The mechanism of a run and how it moved.

use std::fs;
use std::path::Path;

use blocksim_blocks::robotics::Surroundings;
use blocksim_report::Animation;
use blocksim_results::{ALWAYS, Run};
use blocksim_scene::Scene;
use serde_json::Value;

use super::meshes::surfaces;
use super::surroundings;

/// What moves, and where it is over time; `None` where the run has no mechanism. Parts that cannot be drawn become
/// `warnings`.
///
/// # Errors
/// Why there is a mechanism that cannot be shown, in words.
pub fn read(
    folder: &Path,
    run: &Run,
    around: &Surroundings,
    full: bool,
    warnings: &mut Vec<String>,
) -> Result<Option<Animation>, String> {
    let Ok(text) = fs::read_to_string(folder.join("scene.json")) else { return Ok(None) };
    let mut scene: Value = serde_json::from_str(&text).map_err(|error| format!("scene.json: {error}"))?;
    let list = |name: &str| scene[name].as_array().is_some();
    if !["bodies", "shapes", "masses", "frames"].iter().all(|name| list(name)) {
        return Err("scene.json is no scene".to_owned());
    }
    let paths = signals(&scene)?;
    let places: Result<Vec<usize>, String> = paths
        .iter()
        .map(|path| run.find(path).map_err(|_| format!("the run has no signal `{path}`")))
        .collect();
    let places = places?;
    if places.is_empty() {
        return Ok(None);
    }
    let recording = run.read_together(&places, &ALWAYS).map_err(|error| error.reason())?;
    let positions: Vec<Vec<f64>> = recording.signals.into_iter().map(|signal| signal.values).collect();
    let set = set_values(run, &positions);
    let mechanism =
        serde_json::from_value::<Scene>(scene.clone()).ok().filter(|scene| scene.flaw().is_none());
    surroundings::draw(around, &mut scene);
    let surfaces = surfaces(&mut scene, folder, full, warnings);
    let mut animation =
        Animation { scene, surfaces, time: recording.time, positions, set, contacts: Vec::new() };
    if let Some(mechanism) = mechanism {
        animation.contacts = surroundings::contacts(&mechanism, around, &animation);
    }
    Ok(Some(animation))
}

/// Signals that the view in space of a run needs; none where it has none.
pub fn joints(folder: &Path) -> Vec<String> {
    let scene = fs::read_to_string(folder.join("scene.json")).ok();
    let scene: Option<Value> = scene.and_then(|text| serde_json::from_str(&text).ok());
    scene.and_then(|scene| signals(&scene).ok()).unwrap_or_default()
}

/// Signals of all joints in the order of the bodies.
fn signals(scene: &Value) -> Result<Vec<String>, String> {
    let mut paths = Vec::new();
    for body in scene["bodies"].as_array().into_iter().flatten() {
        let motion = &body["motion"];
        let named: Vec<&Value> = match motion["kind"].as_str() {
            Some("turn" | "slide") => vec![&motion["signal"]],
            Some("ball") => motion["signals"].as_array().into_iter().flatten().collect(),
            _ => Vec::new(),
        };
        for name in named {
            paths.push(name.as_str().ok_or("a joint of scene.json names no signal")?.to_owned());
        }
    }
    Ok(paths)
}

/// Set values of the joints: those of the scope whose actual value is the joint's position; the position itself where
/// there is no such scope. `None` if there is none for any joint.
fn set_values(run: &Run, positions: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let mut found: Vec<Option<Vec<f64>>> = vec![None; positions.len()];
    for signal in run.signals() {
        let Some(block) = signal.path.strip_suffix(".actual") else { continue };
        let Ok(set) = run.find(&format!("{block}.set")) else { continue };
        let Ok(actual) = run.find(&signal.path).and_then(|at| run.read(at, &ALWAYS)) else { continue };
        for (found, position) in found.iter_mut().zip(positions) {
            if found.is_none() && *position == actual.values {
                *found = run.read(set, &ALWAYS).ok().map(|column| column.values);
            }
        }
    }
    if found.iter().all(Option::is_none) {
        return None;
    }
    Some(found.into_iter().zip(positions).map(|(set, here)| set.unwrap_or_else(|| here.clone())).collect())
}
