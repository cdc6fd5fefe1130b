//! What stands around a robot, as a set in a diagram or in a file of its own.

use blocksim_block::in_unit;
use blocksim_block::prelude::*;

/// What stands around a robot and can be hit, in the world.
///
/// ```text
/// (
///     floor: "0 mm",
///     things: [
///         (name: Text("workbench"), shapes: [(kind: Text("box"), size: ["0.8 m", "1.2 m", "40 mm"], centre: ["1.3 m", 0, "0.68 m"])]),
///     ],
/// )
/// ```
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Height of the floor; none if it is not given.
    #[serde(default)]
    pub floor: Option<Height>,
    /// What stands there.
    #[serde(default)]
    pub things: Vec<Thing>,
    /// Pairs of names that may touch each other: things, parts of the robot, `floor`.
    #[serde(default)]
    pub may_touch: Vec<[String; 2]>,
}

/// A height, m.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Height {
    /// Above the origin of the world.
    #[serde(deserialize_with = "in_unit::length")]
    pub height: f64,
}

/// Something that can be hit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thing {
    /// What people call it.
    pub name: String,
    /// Its shapes in the world, written as in the block `Body`.
    pub shapes: Shapes,
}

impl Surroundings {
    /// As the planner wants it.
    ///
    /// # Errors
    /// A name that is empty or has another meaning, and a floor at no height, with their path below `param`.
    pub fn space(&self, param: &str) -> Result<blocksim_robotics::planner::Surroundings, ParamError> {
        let floor = self.floor.map(|floor| floor.height);
        floor
            .map_or(Ok(()), |height| finite("floor", height))
            .map_err(|error| ParamError { param: format!("{param}.floor"), ..error })?;
        for (i, thing) in self.things.iter().enumerate() {
            let taken = ["", "base", "tool", "floor"].contains(&thing.name.as_str());
            if taken {
                let message = format!("`{}` is not a valid name for a thing", thing.name);
                return Err(ParamError::new(format!("{param}.things[{i}].name"), message)
                    .help("base, tool and floor are names already; choose another"));
            }
        }
        let things = self.things.iter().map(|thing| (thing.name.clone(), thing.shapes.0.clone())).collect();
        Ok(blocksim_robotics::planner::Surroundings { floor, things })
    }
}
