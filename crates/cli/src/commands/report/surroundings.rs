//! What stands around a mechanism, and when something touches.

use std::path::Path;

use blocksim_blocks::robotics::Surroundings;
use blocksim_collision::{Check, Rules};
use blocksim_diagram::{Sources, has_parameter, parameter};
use blocksim_multibody::Placement;
use blocksim_report::{Animation, Contact};
use blocksim_scene::{Form, Purpose, Scene, SceneShape, Shape};
use serde_json::{Value, json};

use super::model::Text;
use super::numbers::readable;
use crate::disk::Disk;

/// Name of the parameter of a diagram, as `blocksim plan` knows it.
const NAME: &str = "surroundings";
/// Name of the floor.
const FLOOR: &str = "floor";
/// Thickness and width of the floor as something that can be hit, m.
const SLAB: [f64; 2] = [1.0, 200.0];
/// Instants at which contacts are looked for.
const INSTANTS: usize = 1000;
/// Pairs of solids that are looked at, over all instants.
const MOST: usize = 2_000_000;
/// Contacts that are told.
const TOLD: usize = 50;

/// Surroundings from a file, or as the diagram of a run names them.
///
/// # Errors
/// Why they cannot be read, in words.
pub fn read(file: Option<&Path>, model: Option<(&Text, &Sources)>) -> Result<Option<Surroundings>, String> {
    let said = |problems: Vec<blocksim_block::problem::Problem>| {
        problems.first().map_or_else(|| "they cannot be read".to_owned(), |problem| problem.message.clone())
    };
    if let Some(file) = file {
        let disk = Disk::default();
        return parameter(&Sources::new(&disk), file, &[], NAME).map(Some).map_err(said);
    }
    let Some((text, sources)) = model else { return Ok(None) };
    if !has_parameter(sources, &text.root, NAME) {
        return Ok(None);
    }
    parameter(sources, &text.root, &text.overrides, NAME).map(Some).map_err(said)
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

/// When parts of a mechanism touch each other or what stands around; neighbours and what touches at the start are left
/// out, and meshes are not looked at.
pub fn contacts(scene: &Scene, around: &Surroundings, animation: &Animation) -> Vec<Contact> {
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
    let rules = Rules { may_touch: may_touch.collect(), ..Rules::default() };
    let check = Check::of_scene(scene, &obstacles, &rules);
    let most = (MOST / check.pairs().max(1)).clamp(2, INSTANTS);
    let rows = animation.time.len();
    let stride = rows.div_ceil(most).max(1);
    let mut found: Vec<Contact> = Vec::new();
    let mut touched = false;
    for row in (0..rows).step_by(stride) {
        let positions: Vec<f64> = animation.positions.iter().map(|all| all[row]).collect();
        let touch = check.touches(&scene.poses(&positions));
        let time = animation.time[row];
        let Some(touch) = touch else {
            touched = false;
            continue;
        };
        // Other parts may touch by now; what touched first says where to look.
        if touched && let Some(last) = found.last_mut() {
            last.to = time;
        } else if found.len() < TOLD {
            found.push(Contact { from: time, to: time, names: touch.names });
            touched = true;
        }
    }
    found
}

/// The first contact in words.
pub fn told(animation: &Animation) -> Option<String> {
    let Contact { from, names: [one, other], .. } = animation.contacts.first()?;
    let more = match animation.contacts.len() {
        1 => String::new(),
        n => format!(", and {} more contacts follow", n - 1),
    };
    Some(format!("{one} touches {other} at {} s{more}.", readable(*from, 4)))
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
mod tests {
    use super::*;
    use blocksim_scene::{Motion, SceneBody};

    /// A mast that slides along x with a ball of 0.1 m at 1 m of height.
    fn mast() -> Scene {
        let mut scene = Scene::new();
        scene.bodies.push(SceneBody {
            name: "slide".to_owned(),
            parent: Some(0),
            place: Placement::from_translation([0.0, 0.0, 1.0]),
            motion: Motion::Slide { axis: [1.0, 0.0, 0.0], signal: "slide.q".to_owned() },
            start: vec![0.0],
        });
        let form = Form::Sphere { radius: 0.1 };
        let shape = Shape { purpose: Purpose::Both, form, place: Placement::identity(), colour: None };
        scene.shapes.push(SceneShape { body: 1, owner: "mast".to_owned(), shape });
        scene
    }

    /// It goes 1 m along x in 1 s and back again.
    fn there_and_back() -> Animation {
        let time: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 2e-3).collect();
        let positions = vec![time.iter().map(|t| 1.0 - (t - 1.0).abs()).collect()];
        let scene = serde_json::to_value(mast()).unwrap();
        Animation { scene, time, positions, set: None, surfaces: Vec::new(), contacts: Vec::new() }
    }

    fn around(text: &str) -> Surroundings {
        let folder =
            std::env::temp_dir().join(format!("blocksim-around-{}-{}", std::process::id(), text.len()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("around.ron");
        std::fs::write(&file, text).unwrap();
        let read = read(Some(&file), None).unwrap().unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        read
    }

    const WALL: &str = r#"(kind: Text("box"), size: ["0.2 m", "1 m", "1 m"], centre: ["0.9 m", 0, "1 m"])"#;

    #[test]
    fn a_contact_lasts_as_long_as_the_ball_is_at_the_wall() {
        let around =
            around(&format!(r#"(floor: "0.2 m", things: [(name: Text("wall"), shapes: [{WALL}])])"#));
        let found = contacts(&mast(), &around, &there_and_back());
        // The wall begins at 0.8 m, the ball reaches it at 0.7 m.
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].from - 0.7).abs() < 5e-3 && (found[0].to - 1.3).abs() < 5e-3, "{found:?}");
        let mut names = found[0].names.clone();
        names.sort();
        assert_eq!(names, ["mast", "wall"]);
    }

    #[test]
    fn what_may_touch_is_no_contact_and_the_floor_can_be_touched() {
        let allowed = format!(
            r#"(things: [(name: Text("wall"), shapes: [{WALL}])], may_touch: [[Text("tool"), Text("wall")]])"#
        );
        assert!(contacts(&mast(), &around(&allowed), &there_and_back()).is_empty());
        let high = contacts(&mast(), &around(r#"(floor: "0.95 m")"#), &there_and_back());
        assert_eq!((high.len(), high[0].from, high[0].to), (1, 0.0, 2.0));
    }

    #[test]
    fn things_become_shapes_of_the_world_and_the_floor_its_height() {
        let mut scene = serde_json::to_value(mast()).unwrap();
        draw(
            &around(&format!(r#"(floor: "-0.3 m", things: [(name: Text("wall"), shapes: [{WALL}])])"#)),
            &mut scene,
        );
        assert_eq!(scene["floor"], json!(-0.3));
        let wall = &scene["shapes"][1];
        assert_eq!(
            (&wall["owner"], &wall["body"], &wall["around"]),
            (&json!("wall"), &json!(0), &json!(true))
        );
        assert_eq!(wall["size"], json!([0.2, 1.0, 1.0]));
    }
}
