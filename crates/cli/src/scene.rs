//! What is seen of a model, for programs that draw it.

use std::collections::HashMap;
use std::path::Path;

use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_scene::{Actuator, Form, Motion, Scene, SceneBody};
use serde_json::{Map, Value};

/// A scene as JSON, a line for each body, shape, mass and frame. What is `kept` of the files of its meshes, by file, stands
/// beside their names.
pub fn json(scene: &Scene, kept: &HashMap<String, String>) -> String {
    let mut lists: Map<String, Value> = match serde_json::to_value(scene) {
        Ok(Value::Object(lists)) => lists,
        // Plain data always becomes an object.
        _ => Map::new(),
    };
    for shape in lists.get_mut("shapes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(name) = shape["file"].as_str().and_then(|file| kept.get(file)) {
            shape["kept"] = name.as_str().into();
        }
    }
    let lists: Vec<String> = lists
        .iter()
        .map(|(name, list)| {
            let lines: Vec<String> =
                list.as_array().into_iter().flatten().map(|item| format!("\n    {item}")).collect();
            format!("  \"{name}\": [{}\n  ]", lines.join(","))
        })
        .collect();
    format!("{{\n{}\n}}\n", lists.join(",\n"))
}

/// The same scene with what drives its joints: recorded signals that are, to the cell, what the joint measures of its actuators,
/// whatever scope they are recorded by. `recorded` are those that are kept of a run.
pub fn with_actuators<'a>(
    scene: &Scene,
    schedule: &Schedule,
    recorded: impl Iterator<Item = &'a Recorded> + Clone,
) -> Scene {
    let actuator = |(body, moved): (usize, &SceneBody)| {
        let measured = match &moved.motion {
            Motion::Turn { signal, .. } => format!("{}.tau", signal.strip_suffix(".q")?),
            Motion::Slide { signal, .. } => format!("{}.f", signal.strip_suffix(".x")?),
            Motion::Ball { .. } | Motion::Fixed => return None,
        };
        let cell = schedule.signals.iter().find(|signal| signal.path == measured)?.offset;
        let found = recorded.clone().find(|recorded| recorded.cell == cell)?;
        Some(Actuator { body, signal: found.path.clone() })
    };
    let actuators = scene.bodies.iter().enumerate().filter_map(actuator).collect();
    Scene { actuators, ..scene.clone() }
}

/// Meshes that are not where the model says, each once.
pub fn missing_meshes(scene: &Scene) -> Vec<&str> {
    let mut missing = Vec::new();
    for shape in &scene.shapes {
        if let Form::Mesh { file, .. } = &shape.shape.form
            && !missing.contains(&file.as_str())
            && !Path::new(file).is_file()
        {
            missing.push(file);
        }
    }
    missing
}
