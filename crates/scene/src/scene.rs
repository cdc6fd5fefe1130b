//! A mechanism as it can be drawn: bodies, their joints, and what is fixed to them.

use blocksim_multibody::Placement;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};

use crate::place;
use crate::shape::Shape;

/// A mechanism as it can be drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The bodies, parents before children. The first is the world.
    pub bodies: Vec<SceneBody>,
    /// What they look like.
    pub shapes: Vec<SceneShape>,
    /// Their masses.
    pub masses: Vec<Mass>,
    /// Named frames on them.
    pub frames: Vec<SceneFrame>,
    /// What drives their joints, as far as it is recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actuators: Vec<Actuator>,
}

/// What the actuators of a joint exert on its body: a recorded signal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Actuator {
    /// Index of the body that the joint moves.
    pub body: usize,
    /// The signal: torque about the axis of the joint, N·m, or force along it, N.
    pub signal: String,
}

/// A body and the joint that moves it. With the joint at zero the body is at `place` in its parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneBody {
    /// Path of the joint. A joint with several freedoms moves several bodies, of which the last one is meant.
    pub name: String,
    /// Index of the body that carries the joint; `None` of the world.
    pub parent: Option<usize>,
    /// Where the joint sits in the parent.
    #[serde(flatten, with = "place")]
    pub place: Placement,
    /// How the body moves there.
    pub motion: Motion,
    /// Positions at the start: rad, m, or a quaternion.
    pub start: Vec<f64>,
}

/// How a body moves, and the recorded signals that tell it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// Rotation.
    Turn {
        /// Unit vector of the axis.
        axis: [f64; 3],
        /// Signal of the angle, rad.
        signal: String,
    },
    /// Translation.
    Slide {
        /// Unit vector of the axis.
        axis: [f64; 3],
        /// Signal of the position, m.
        signal: String,
    },
    /// Any rotation.
    Ball {
        /// Signals of the quaternion: w, x, y, z.
        signals: [String; 4],
    },
}

/// A shape on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneShape {
    /// Index of the body.
    pub body: usize,
    /// Path of the block that it belongs to.
    pub owner: String,
    /// The shape, in the frame of the body.
    #[serde(flatten)]
    pub shape: Shape,
}

/// A mass on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mass {
    /// Index of the body.
    pub body: usize,
    /// Path of the block.
    pub owner: String,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the frame of the body, m.
    pub com: [f64; 3],
}

/// A named frame on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFrame {
    /// Index of the body.
    pub body: usize,
    /// Path of the block that leads to it.
    pub name: String,
    /// Where it is in the frame of the body.
    #[serde(flatten, with = "place")]
    pub place: Placement,
}

impl Motion {
    /// Names of the signals that tell the positions, in their order.
    pub fn signals(&self) -> &[String] {
        match self {
            Motion::Fixed => &[],
            Motion::Turn { signal, .. } | Motion::Slide { signal, .. } => std::slice::from_ref(signal),
            Motion::Ball { signals } => signals,
        }
    }

    /// How far positions move the body from where the joint sits. A quaternion need not have length one.
    fn moved(&self, positions: &[f64]) -> Placement {
        match (self, positions) {
            (Motion::Turn { axis, .. }, [angle]) => Placement::from_axis_angle([0.0; 3], *axis, *angle),
            (Motion::Slide { axis, .. }, [position]) => {
                Placement::from_translation(axis.map(|a| a * position))
            }
            (Motion::Ball { .. }, [w, x, y, z]) => {
                let turn = UnitQuaternion::from_quaternion(Quaternion::new(*w, *x, *y, *z));
                Placement { rotation: turn.to_rotation_matrix().into_inner(), ..Placement::identity() }
            }
            _ => Placement::identity(),
        }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Scene::new()
    }
}

impl Scene {
    /// The world alone.
    pub fn new() -> Self {
        let world = SceneBody {
            name: "world".to_owned(),
            parent: None,
            place: Placement::identity(),
            motion: Motion::Fixed,
            start: Vec::new(),
        };
        Scene {
            bodies: vec![world],
            shapes: Vec::new(),
            masses: Vec::new(),
            frames: Vec::new(),
            actuators: Vec::new(),
        }
    }

    /// Names of the signals that tell where everything is, in the order of [`Scene::poses`].
    pub fn signals(&self) -> Vec<&str> {
        self.bodies.iter().flat_map(|body| body.motion.signals()).map(String::as_str).collect()
    }

    /// Positions at the start, in the order of [`Scene::signals`].
    pub fn start(&self) -> Vec<f64> {
        self.bodies.iter().flat_map(|body| body.start.iter().copied()).collect()
    }

    /// Where each body is in the world. `positions` in the order of [`Scene::signals`]; what is missing counts as the
    /// start.
    pub fn poses(&self, positions: &[f64]) -> Vec<Placement> {
        let mut poses: Vec<Placement> = Vec::with_capacity(self.bodies.len());
        let mut next = 0;
        for body in &self.bodies {
            let end = next + body.motion.signals().len();
            let at = body.motion.moved(positions.get(next..end).unwrap_or(&body.start));
            next = end;
            let carrier = body.parent.and_then(|parent| poses.get(parent)).copied();
            poses.push(carrier.unwrap_or_else(Placement::identity) * body.place * at);
        }
        poses
    }

    /// What makes no sense in a scene that was read from a file: in words, `None` if all is well. What is said of such a
    /// scene is never out of bounds.
    pub fn flaw(&self) -> Option<String> {
        let world = self.bodies.first().filter(|body| body.parent.is_none() && body.motion == Motion::Fixed);
        if world.is_none() {
            return Some("its first body is not the world".to_owned());
        }
        for (index, body) in self.bodies.iter().enumerate().skip(1) {
            if body.parent.is_none_or(|parent| parent >= index)
                || body.start.len() != body.motion.signals().len()
            {
                return Some(format!("body {index} has no place on one before it"));
            }
        }
        let on = self.shapes.iter().map(|shape| shape.body).chain(self.masses.iter().map(|mass| mass.body));
        let mut on = on
            .chain(self.frames.iter().map(|frame| frame.body))
            .chain(self.actuators.iter().map(|actuator| actuator.body));
        on.find(|body| *body >= self.bodies.len()).map(|body| format!("there is no body {body}"))
    }

    /// Adds another mechanism in the same world.
    pub fn append(&mut self, other: Scene) {
        let before = self.bodies.len() - 1;
        let moved = |body: usize| if body == 0 { 0 } else { body + before };
        let bodies = other.bodies.into_iter().skip(1);
        self.bodies.extend(bodies.map(|body| SceneBody { parent: body.parent.map(moved), ..body }));
        self.shapes
            .extend(other.shapes.into_iter().map(|shape| SceneShape { body: moved(shape.body), ..shape }));
        self.masses.extend(other.masses.into_iter().map(|mass| Mass { body: moved(mass.body), ..mass }));
        self.frames
            .extend(other.frames.into_iter().map(|frame| SceneFrame { body: moved(frame.body), ..frame }));
        let actuators = other.actuators.into_iter();
        self.actuators.extend(actuators.map(|one| Actuator { body: moved(one.body), ..one }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Form, Purpose};
    use std::f64::consts::FRAC_PI_2;

    /// A turn about z at (0, 0, 1), a slide along its x, and a ball on that.
    fn crane() -> Scene {
        let mut scene = Scene::new();
        let body = |name: &str, parent, place, motion: Motion, start: &[f64]| SceneBody {
            name: name.to_owned(),
            parent: Some(parent),
            place,
            motion,
            start: start.to_vec(),
        };
        let lifted = Placement::from_translation([0.0, 0.0, 1.0]);
        let turn = Motion::Turn { axis: [0.0, 0.0, 1.0], signal: "mast.q".to_owned() };
        let slide = Motion::Slide { axis: [1.0, 0.0, 0.0], signal: "trolley.x".to_owned() };
        let ball = Motion::Ball { signals: ["w", "x", "y", "z"].map(|e| format!("hook.{e}")) };
        scene.bodies.push(body("mast", 0, lifted, turn, &[0.0]));
        scene.bodies.push(body("trolley", 1, Placement::identity(), slide, &[2.0]));
        scene.bodies.push(body("hook", 2, Placement::identity(), ball, &[1.0, 0.0, 0.0, 0.0]));
        let shape = Shape {
            purpose: Purpose::Both,
            form: Form::Sphere { radius: 0.1 },
            place: Placement::from_translation([0.0, 0.0, -0.5]),
            colour: None,
        };
        scene.shapes.push(SceneShape { body: 3, owner: "load".to_owned(), shape });
        scene
    }

    #[test]
    fn poses_follow_from_positions_joint_by_joint() {
        let scene = crane();
        assert_eq!(scene.signals(), ["mast.q", "trolley.x", "hook.w", "hook.x", "hook.y", "hook.z"]);
        let start = scene.poses(&scene.start());
        assert_eq!(start, scene.poses(&[]), "what is missing is at its start");
        assert!((start[3].translation - nalgebra::Vector3::new(2.0, 0.0, 1.0)).norm() < 1e-15);
        // A quarter turn of the mast, 3 m out, the hook turned half about its x.
        let poses = scene.poses(&[FRAC_PI_2, 3.0, 0.0, 2.0, 0.0, 0.0]);
        let load = poses[3].point(&scene.shapes[0].shape.place.translation);
        assert!((load - nalgebra::Vector3::new(0.0, 3.0, 1.5)).norm() < 1e-15, "{load}");
    }

    #[test]
    fn a_second_mechanism_keeps_its_own_bodies_and_shares_the_world() {
        let mut both = crane();
        let mut other = crane();
        other.shapes[0].body = 0;
        both.append(other.clone());
        both.append(crane());
        assert_eq!(both.bodies.len(), 10);
        assert_eq!(both.shapes.iter().map(|shape| shape.body).collect::<Vec<_>>(), [3, 0, 9]);
        let (alone, together) = (other.poses(&[]), both.poses(&[]));
        assert_eq!(alone[1..4], together[4..7]);
    }

    #[test]
    fn a_scene_that_names_bodies_which_are_not_there_has_a_flaw() {
        assert_eq!(crane().flaw(), None);
        let flaw = |change: fn(&mut Scene)| {
            let mut scene = crane();
            change(&mut scene);
            scene.flaw()
        };
        assert_eq!(flaw(|scene| scene.shapes[0].body = 4), Some("there is no body 4".to_owned()));
        let placeless = Some("body 2 has no place on one before it".to_owned());
        assert_eq!(flaw(|scene| scene.bodies[2].parent = Some(3)), placeless);
        assert_eq!(flaw(|scene| scene.bodies[2].start.clear()), placeless);
        assert_eq!(flaw(|scene| scene.bodies.clear()), Some("its first body is not the world".to_owned()));
    }

    #[test]
    fn a_scene_is_written_flat() {
        let scene = serde_json::to_value(crane()).expect("JSON");
        let shape = &scene["shapes"][0];
        assert_eq!(
            (&shape["body"], &shape["kind"], &shape["use"]),
            (&3.into(), &"sphere".into(), &"both".into())
        );
        assert_eq!(shape["translation"][2], -0.5);
        assert_eq!(scene["bodies"][1]["motion"]["signal"], "mast.q");
        assert_eq!(serde_json::from_value::<Scene>(scene.clone()).expect("a scene"), crane());
        assert_eq!(scene["bodies"][1]["rotation"][2], serde_json::json!([0.0, 0.0, 1.0]));
    }
}
