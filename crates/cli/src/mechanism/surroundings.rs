//! What stands around a mechanism.

use std::path::Path;

use blocksim_block::problem::Problem;
use blocksim_blocks::robotics::Surroundings;
use blocksim_diagram::{Sources, has_parameter, parameter};
use blocksim_multibody::Placement;
use blocksim_robotics::collision::{Check, Rules};
use blocksim_scene::{Form, Purpose, Scene, SceneShape, Shape};
use serde_json::{Value, json};

use super::text::Text;
use crate::disk::Disk;

/// Name of the parameter of a diagram, as `blocksim plan` knows it.
const NAME: &str = "surroundings";
/// Name of the floor.
const FLOOR: &str = "floor";
/// Thickness and width of the floor as something that can be hit, m.
const SLAB: [f64; 2] = [20.0, 200.0];

/// Surroundings from a file, or as the diagram of a run names them.
///
/// # Errors
/// Why they cannot be read, in words.
pub fn read(file: Option<&Path>, model: Option<(&Text, &Sources)>) -> Result<Option<Surroundings>, String> {
    if let Some(file) = file {
        let disk = Disk::default();
        return parameter(&Sources::new(&disk), file, &[], NAME).map(Some).map_err(said);
    }
    let Some((text, sources)) = model else { return Ok(None) };
    of_model(sources, &text.root, &text.overrides)
}

/// Surroundings as a diagram names them, if it does; `overrides` as of `--set`.
///
/// # Errors
/// Why they cannot be read, in words.
pub fn of_model(
    sources: &Sources,
    root: &Path,
    overrides: &[String],
) -> Result<Option<Surroundings>, String> {
    if !has_parameter(sources, root, NAME) {
        return Ok(None);
    }
    parameter(sources, root, overrides, NAME).map(Some).map_err(said)
}

fn said(problems: Vec<Problem>) -> String {
    problems.first().map_or_else(|| "they cannot be read".to_owned(), |problem| problem.message.clone())
}

/// Adds them to a scene.
pub fn draw(around: &Surroundings, scene: &mut Value) {
    if let Some(floor) = around.floor {
        scene["floor"] = json!(floor.height);
    }
    let Some(shapes) = scene["shapes"].as_array_mut() else { return };
    for thing in &around.things {
        for shape in thing.shapes.0.iter().filter(|shape| shape.is_visual()) {
            let shape = SceneShape { body: 0, owner: thing.name.clone(), shape: shape.clone() };
            if let Ok(mut shape) = serde_json::to_value(shape) {
                shape["around"] = json!(true);
                shapes.push(shape);
            }
        }
    }
}

/// The solids of a mechanism and of what stands around, and which pairs of them are looked at: neighbours and what touches
/// at the start are left out, and meshes are not looked at.
pub fn check(scene: &Scene, around: &Surroundings) -> Check {
    let scene = &told_apart(scene);
    let named = |thing: &blocksim_blocks::robotics::Thing| {
        let name = thing.name.clone();
        thing.shapes.0.iter().map(move |shape| (name.clone(), shape.clone())).collect::<Vec<_>>()
    };
    let mut obstacles: Vec<(String, Shape)> = around.things.iter().flat_map(named).collect();
    obstacles.extend(around.floor.map(|floor| slab(floor.height)));
    let may_touch = around.may_touch.iter().flat_map(|[a, b]| {
        let others = owners(scene, b);
        owners(scene, a)
            .into_iter()
            .flat_map(move |a| others.clone().into_iter().map(move |b| [a.clone(), b]))
    });
    Check::of_scene(scene, &obstacles, &Rules { may_touch: may_touch.collect(), ..Rules::default() })
}

/// The same with names that tell the bodies of one block from each other, as a whole arm has them: `arm link2`.
fn told_apart(scene: &Scene) -> Scene {
    let is_several = |owner: &str| {
        let mut bodies = scene.shapes.iter().filter(|shape| shape.owner == owner).map(|shape| shape.body);
        let first = bodies.next();
        bodies.any(|body| Some(body) != first)
    };
    let mut told = scene.clone();
    for shape in told.shapes.iter_mut().filter(|shape| is_several(&shape.owner)) {
        let own = |body: &usize| *body > 0 && scene.bodies[*body].name == shape.owner;
        let link = (0..scene.bodies.len()).filter(own).position(|body| body == shape.body);
        shape.owner = match link {
            Some(link) => format!("{} link{}", shape.owner, link + 1),
            None if shape.body == 0 => format!("{} base", shape.owner),
            None => format!("{} {}", shape.owner, shape.body),
        };
    }
    told
}

/// What a name of [`Surroundings::may_touch`] is called in a scene: there, links are numbered from the base on and the
/// last one has the tool.
fn owners(scene: &Scene, name: &str) -> Vec<String> {
    let body = match name {
        "base" => Some(0),
        "tool" => scene.bodies.len().checked_sub(1),
        _ => name.strip_prefix("link").and_then(|number| number.parse().ok()),
    };
    let on = |shape: &&SceneShape| Some(shape.body) == body;
    let mut owners: Vec<String> = scene.shapes.iter().filter(on).map(|shape| shape.owner.clone()).collect();
    owners.dedup();
    owners.push(name.to_owned());
    owners
}

/// The floor as something that can be hit.
fn slab(height: f64) -> (String, Shape) {
    let [thick, wide] = SLAB;
    let place = Placement::from_translation([0.0, 0.0, height - thick / 2.0]);
    let form = Form::Box { size: [wide, wide, thick] };
    (FLOOR.to_owned(), Shape { purpose: Purpose::Collision, form, place, colour: None })
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Surroundings as a file says them.
    pub fn around(text: &str) -> Surroundings {
        let folder =
            std::env::temp_dir().join(format!("blocksim-around-{}-{}", std::process::id(), text.len()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("around.ron");
        std::fs::write(&file, text).unwrap();
        let read = read(Some(&file), None).unwrap().unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        read
    }

    #[test]
    fn things_become_shapes_of_the_world_and_the_floor_its_height() {
        const WALL: &str =
            r#"(kind: Text("box"), size: ["0.2 m", "1 m", "1 m"], centre: ["0.9 m", 0, "1 m"])"#;
        let mut scene = serde_json::to_value(Scene::new()).unwrap();
        draw(
            &around(&format!(r#"(floor: "-0.3 m", things: [(name: Text("wall"), shapes: [{WALL}])])"#)),
            &mut scene,
        );
        assert_eq!(scene["floor"], json!(-0.3));
        let wall = &scene["shapes"][0];
        assert_eq!(
            (&wall["owner"], &wall["body"], &wall["around"]),
            (&json!("wall"), &json!(0), &json!(true))
        );
        assert_eq!(wall["size"], json!([0.2, 1.0, 1.0]));
    }
}
