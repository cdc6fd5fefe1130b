//! What is seen of a mechanism: bodies, joints, shapes, masses and frames as plain data.

use blocksim_block::Output;
use blocksim_block::physical::Element;
use blocksim_multibody::Joint;
use blocksim_scene::{Mass, Motion, Scene, SceneBody, SceneFrame, SceneShape};

use crate::assembly::members::Members;
use crate::mechanics::frames::Frames;
use crate::mechanics::place::Place;

/// The scene of a mechanism whose start positions are known; `places` are those of the frame nodes.
pub(crate) fn build(m: &Members, places: &[Option<Place>], frames: &Frames) -> Scene {
    let mut scene = Scene::new();
    let Some(model) = &frames.model else { return scene };
    for body in model.bodies() {
        let range = model.positions(body);
        scene.bodies.push(SceneBody {
            name: m.path(frames.body_members[body.index()]).to_owned(),
            parent: Some(model.parent(body).map_or(0, |parent| parent.index() + 1)),
            place: *model.joint_placement(body),
            motion: motion(model.joint(body), &frames.signals[range.clone()]),
            start: frames.position[range].to_vec(),
        });
    }
    let at = |member: usize, port: usize| places[m.node(member, port)];
    let index = |place: &Place| place.body.map_or(0, |body| body.index() + 1);
    for (member, part) in m.list.iter().enumerate().map(|(member, listed)| (member, &listed.part)) {
        for (port, shape) in &part.shapes {
            let Some(place) = at(member, *port) else { continue };
            let mut shape = shape.clone();
            shape.place = place.placement * shape.place;
            scene.shapes.push(SceneShape { body: index(&place), owner: m.path(member).to_owned(), shape });
        }
    }
    for (member, element) in m.elements() {
        match element {
            Element::Body { frame, mass, com, .. } if *mass > 0.0 => {
                let Some(place) = at(member, *frame) else { continue };
                let com = place.placement.point(&(*com).into()).into();
                scene.masses.push(Mass {
                    body: index(&place),
                    owner: m.path(member).to_owned(),
                    mass: *mass,
                    com,
                });
            }
            Element::Transform { follower, .. } => {
                let Some(place) = at(member, *follower) else { continue };
                let name = m.path(member).to_owned();
                scene.frames.push(SceneFrame { body: index(&place), name, place: place.placement });
            }
            _ => {}
        }
    }
    scene
}

fn motion(joint: &Joint, signals: &[String]) -> Motion {
    match (joint, signals) {
        (Joint::Revolute { axis }, [signal]) => Motion::Turn { axis: (*axis).into(), signal: signal.clone() },
        (Joint::Prismatic { axis }, [signal]) => {
            Motion::Slide { axis: (*axis).into(), signal: signal.clone() }
        }
        (Joint::Spherical, [w, x, y, z]) => Motion::Ball { signals: [w, x, y, z].map(String::clone) },
        _ => Motion::Fixed,
    }
}

/// Outputs with the positions of all joints, for recordings; none where nothing is to be seen.
pub(crate) fn outputs(frames: &Frames) -> Vec<Output> {
    if frames.scene.shapes.is_empty() {
        return Vec::new();
    }
    let mut outputs = Vec::new();
    for body in &frames.scene.bodies {
        let unit = match body.motion {
            Motion::Turn { .. } => "rad",
            Motion::Slide { .. } => "m",
            Motion::Ball { .. } | Motion::Fixed => "1",
        };
        outputs.extend(body.motion.signals().iter().map(|name| Output::real(name.clone()).unit(unit)));
    }
    outputs
}
