//! The mechanism of a run and where its joints were.

use std::path::Path;

use blocksim_recording::{ALWAYS, MOST_TEXT, Run, limited_text};
use blocksim_scene::Scene;
use serde_json::Value;

/// Where the joints of a mechanism were over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Movement {
    /// Times, s.
    pub time: Vec<f64>,
    /// Positions over time, in the order of the bodies: rad, m, or parts of quaternions.
    pub positions: Vec<Vec<f64>>,
}

/// What the run says of its mechanism, as it stands in `scene.json`; `None` where it has none.
///
/// # Errors
/// Why it cannot be used, in words.
pub fn scene(folder: &Path) -> Result<Option<Value>, String> {
    let Ok(text) = limited_text(&folder.join("scene.json"), MOST_TEXT) else { return Ok(None) };
    let scene: Value = serde_json::from_str(&text).map_err(|error| format!("scene.json: {error}"))?;
    let list = |name: &str| scene[name].as_array().is_some();
    if !["bodies", "shapes", "masses", "frames"].iter().all(|name| list(name)) {
        return Err("scene.json is not a scene".to_owned());
    }
    Ok(Some(scene))
}

/// The mechanism itself, where all of it makes sense.
///
/// # Errors
/// What makes none, in words.
pub fn mechanism(scene: &Value) -> Result<Scene, String> {
    let scene: Scene =
        serde_json::from_value(scene.clone()).map_err(|error| format!("scene.json: {error}"))?;
    scene.flaw().map_or(Ok(scene), |flaw| Err(format!("scene.json: {flaw}")))
}

/// Where the joints of a scene were; `None` where nothing moves.
///
/// # Errors
/// A signal that the run does not have, or that cannot be read, in words.
pub fn movement(run: &Run, scene: &Value) -> Result<Option<Movement>, String> {
    let find = |path: &String| run.find(path).map_err(|_| format!("the run has no signal `{path}`"));
    let places = signals(scene)?.iter().map(find).collect::<Result<Vec<usize>, String>>()?;
    if places.is_empty() {
        return Ok(None);
    }
    let recording = run.read_together(&places, &ALWAYS).map_err(|error| error.reason())?;
    let positions = recording.signals.into_iter().map(|signal| signal.values).collect();
    Ok(Some(Movement { time: recording.time, positions }))
}

/// Signals of all joints in the order of the bodies.
///
/// # Errors
/// A joint without a signal.
pub fn signals(scene: &Value) -> Result<Vec<String>, String> {
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
