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

impl Movement {
    /// The part within a time, with its ends: between rows positions go straight. Empty where the movement does not reach it.
    pub fn within(&self, [from, to]: [f64; 2]) -> Self {
        let rows: Vec<usize> =
            (0..self.time.len()).filter(|row| (from..=to).contains(&self.time[*row])).collect();
        let at_end = |at: f64| {
            let next = self.time.iter().position(|time| *time > at)?;
            let before = next.checked_sub(1).filter(|before| self.time[*before] < at)?;
            let part = (at - self.time[before]) / (self.time[next] - self.time[before]);
            let between = |all: &Vec<f64>| all[before] + (all[next] - all[before]) * part;
            let positions: Vec<f64> = self.positions.iter().map(between).collect();
            positions.iter().all(|position| position.is_finite()).then_some((at, positions))
        };
        let row = |row: &usize| (self.time[*row], self.positions.iter().map(|all| all[*row]).collect());
        let ends = [at_end(from), at_end(to).filter(|_| to > from)];
        let [first, last] = ends;
        let all: Vec<(f64, Vec<f64>)> = first.into_iter().chain(rows.iter().map(row)).chain(last).collect();
        let positions = (0..self.positions.len()).map(|body| all.iter().map(|(_, at)| at[body]).collect());
        Self { positions: positions.collect(), time: all.iter().map(|(time, _)| *time).collect() }
    }
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
