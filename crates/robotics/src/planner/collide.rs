//! Whether a robot hits itself or what stands around it on a move, and how near it comes.

use std::fmt;

use crate::collision::{Check, Clearance, Item, Rules, Solid, Walk};
use crate::robot::Robot;
use blocksim_multibody::{Data, Placement, forward_kinematics};
use blocksim_scene::Shape;
use nalgebra::Vector3;

use crate::planner::check::FEWEST;
use crate::planner::course::{Course, Spot};
use crate::planner::error::short;

/// Shapes of the parts of a robot, each in the frame of its part. Those that are only drawn take no part.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RobotShapes {
    /// On the base, which stands still.
    pub base: Vec<Shape>,
    /// On each link.
    pub links: Vec<Vec<Shape>>,
    /// On the flange: tool and load.
    pub tool: Vec<Shape>,
}

/// What stands around a robot, in the world.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surroundings {
    /// Height of the floor, m, if there is one.
    pub floor: Option<f64>,
    /// Things with their names and shapes.
    pub things: Vec<(String, Vec<Shape>)>,
}

/// A robot among what surrounds it: which pairs of solids are looked at.
///
/// Left out are pairs on one part, on neighbours (parts that a joint connects), of parts of the robot that are within 1 mm
/// of each other where it starts, and pairs that may touch by `rules`. Of parts that are within 20 mm of each other where
/// the robot starts, collisions are told, but no distances. Of the surroundings nothing is left out unless by `rules`.
#[derive(Debug, Clone)]
pub struct Space {
    own: Check,
    around: Check,
    unchecked: Vec<String>,
}

/// A place on a move where two parts touch, or are nearest to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Encounter {
    /// Names of both.
    pub names: [String; 2],
    /// Where on the move.
    pub spot: Spot,
    /// Positions of the axes, rad or m.
    pub q: Vec<f64>,
    /// Distance, m; zero or less where they touch: then the depth, with a minus.
    pub distance: f64,
    /// The point of the first part that is nearest to the second, or deepest in it, m, in the world.
    pub point: Vector3<f64>,
}

/// What was found on a move.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Encounters {
    /// Where something touches first.
    pub first: Option<Encounter>,
    /// Where parts of the robot are nearest to each other, or deepest in each other. `None` if no pair is looked at.
    pub own: Option<Encounter>,
    /// The same of a part of the robot and something of the surroundings.
    pub around: Option<Encounter>,
    /// Poses that were looked at.
    pub poses: usize,
}

/// Name of the floor.
const FLOOR: &str = "floor";
/// Name of the base.
const BASE: &str = "base";
/// Name of what the flange carries.
const TOOL: &str = "tool";

impl Space {
    /// A robot with shapes and what surrounds it.
    pub fn new(robot: &Robot, shapes: &RobotShapes, around: &Surroundings, rules: &Rules) -> Space {
        let flange = robot.parts().flange;
        let last = robot.axes();
        let mut items = Vec::new();
        let mut unchecked = Vec::new();
        let mut add = |name: &str, body: Option<usize>, frame: Placement, shapes: &[Shape]| {
            for shape in shapes.iter().filter(|shape| shape.collides()) {
                match Solid::of(&shape.form) {
                    Some(solid) => {
                        let place = frame * shape.place;
                        items.push(Item { name: name.to_owned(), body, solid, place });
                    }
                    None => unchecked.push(name.to_owned()),
                }
            }
        };
        add(BASE, Some(0), robot.parts().base, &shapes.base);
        for (i, shapes) in shapes.links.iter().enumerate().take(last) {
            add(&name(robot, i), Some(i + 1), Placement::identity(), shapes);
        }
        add(TOOL, Some(last), flange, &shapes.tool);
        for (name, shapes) in &around.things {
            add(name, None, Placement::identity(), shapes);
        }
        if let Some(height) = around.floor {
            let place = Placement::from_translation([0.0, 0.0, height]);
            items.push(Item { name: FLOOR.to_owned(), body: None, solid: Solid::half_space(), place });
        }
        unchecked.dedup();
        let parents: Vec<Option<usize>> = (0..=last).map(|body: usize| body.checked_sub(1)).collect();
        let mut poses = Poses::new(robot);
        let mut rules = rules.clone();
        rules.may_touch.push([BASE.to_owned(), name(robot, 0)]);
        let check = Check::new(items, &parents, poses.at(&robot.start()), &rules);
        Space { own: check.with_obstacles(false), around: check.with_obstacles(true), unchecked }
    }

    /// Pairs of parts that touch where the robot starts and are therefore not looked at.
    pub fn left_out(&self) -> &[[String; 2]] {
        self.own.left_out()
    }

    /// Names of parts that have a mesh, which is not looked at.
    pub fn unchecked(&self) -> &[String] {
        &self.unchecked
    }

    /// Number of pairs of solids that are looked at.
    pub fn pairs(&self) -> usize {
        self.own.pairs() + self.around.pairs()
    }

    /// All names of parts and things.
    pub fn names(&self) -> Vec<&str> {
        self.own.names()
    }
}

/// What people call a link.
fn name(robot: &Robot, link: usize) -> String {
    match robot.parts().links[link].name.as_str() {
        "" => format!("link{}", link + 1),
        name => name.to_owned(),
    }
}

/// Where the bodies of a robot are in the world, the world first.
struct Poses<'r> {
    robot: &'r Robot,
    data: Data,
    poses: Vec<Placement>,
}

impl<'r> Poses<'r> {
    fn new(robot: &'r Robot) -> Self {
        let poses = vec![Placement::identity(); robot.axes() + 1];
        Poses { robot, data: robot.model().data(), poses }
    }

    fn at(&mut self, q: &[f64]) -> &[Placement] {
        forward_kinematics(self.robot.model(), &mut self.data, q);
        for (pose, body) in self.poses[1..].iter_mut().zip(self.robot.model().bodies()) {
            *pose = *self.data.placement(body);
        }
        &self.poses
    }
}

/// One of so many poses is looked at first: how near these come leaves little to measure in the others.
const COARSE: usize = 16;

/// Looks for collisions at the seams of a move and at `waypoints` times at least, equally distant; the first one is found
/// to a millionth of the time between two of them.
pub fn encounters(robot: &Robot, course: &dyn Course, space: &Space, waypoints: usize) -> Encounters {
    // Nothing jumps where the parts are: seams matter where they are few, and are many where a course has one at each knot.
    let count = waypoints.max(FEWEST);
    let times = if course.seams().len() > count { course.parts(count) } else { course.times(count) };
    let mut found = Encounters { poses: times.len(), ..Encounters::default() };
    let mut poses = Poses::new(robot);
    let mut walks = [Walk::new(&space.own), Walk::new(&space.around)];
    for t in times.iter().step_by(COARSE) {
        let at = poses.at(&course.positions(*t));
        walks.iter_mut().for_each(|walk| drop(walk.step(at)));
    }
    let [near, near_around] = walks.map(|walk| walk.least());
    let (mut own, mut around) = (Follow::new(&space.own, near), Follow::new(&space.around, near_around));
    for t in times {
        let at = poses.at(&course.positions(t));
        own.step(t, at);
        around.step(t, at);
    }
    let first = [own.first(robot, course), around.first(robot, course)].into_iter().flatten();
    found.first = first.min_by(|a, b| a.spot.t.total_cmp(&b.spot.t));
    (found.own, found.around) = (own.least(course), around.least(course));
    found
}

/// What is found of some pairs on the way.
struct Follow<'s> {
    check: &'s Check,
    walk: Walk<'s>,
    before: f64,
    /// The time before something touches, that at which it does, and what.
    first: Option<(f64, f64, Clearance)>,
    least: Option<(f64, Clearance)>,
}

impl<'s> Follow<'s> {
    /// Before a way of which some poses were looked at: what comes nearest in these is `least` away, m.
    fn new(check: &'s Check, least: f64) -> Self {
        Follow { check, walk: Walk::down_to(check, least), before: 0.0, first: None, least: None }
    }

    fn step(&mut self, t: f64, poses: &[Placement]) {
        if let Some(found) = self.walk.step(poses) {
            if found.distance.distance <= 0.0 && self.first.is_none() {
                self.first = Some((self.before, t, found.clone()));
            }
            self.least = Some((t, found));
        }
        self.before = t;
    }

    fn first(&self, robot: &Robot, course: &dyn Course) -> Option<Encounter> {
        let (mut free, mut hit, mut found) = self.first.clone()?;
        let mut poses = Poses::new(robot);
        for _ in 0..20 {
            let middle = 0.5 * (free + hit);
            match self.check.touches(poses.at(&course.positions(middle))) {
                Some(touching) => (hit, found) = (middle, touching),
                None => free = middle,
            }
        }
        Some(encounter(course, hit, &found))
    }

    fn least(&self, course: &dyn Course) -> Option<Encounter> {
        self.least.as_ref().map(|(t, found)| encounter(course, *t, found))
    }
}

fn encounter(course: &dyn Course, t: f64, found: &Clearance) -> Encounter {
    Encounter {
        names: found.names.clone(),
        spot: Spot::of(course, t),
        q: course.positions(t),
        distance: found.distance.distance,
        point: found.distance.points[0],
    }
}

impl Encounter {
    /// Its place on the move.
    pub fn place(&self) -> String {
        self.spot.to_string()
    }

    /// The point in mm, in the world.
    pub fn point_text(&self) -> String {
        let [x, y, z] = [self.point.x, self.point.y, self.point.z].map(|x| format!("{:.1} mm", 1e3 * x));
        format!("x = {x}, y = {y}, z = {z}")
    }

    /// The axes in degrees.
    pub fn axes_text(&self) -> String {
        let all: Vec<String> =
            self.q.iter().map(|q| short((q.to_degrees() * 100.0).round() / 100.0)).collect();
        format!("{} deg", all.join(", "))
    }

    /// What helps against a collision.
    pub fn help(&self) -> &'static str {
        match self.spot.t > 0.0 {
            true => {
                "go round it by another point, start in another configuration, or list the two under `may_touch` where they \
                 may"
            }
            false => "start where nothing touches, or list the two under `may_touch` where they may",
        }
    }
}

impl fmt::Display for Encounter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        match self.distance > 0.0 {
            true => write!(
                f,
                "{} mm between `{a}` and `{b}` {}",
                short((1e4 * self.distance).round() / 10.0),
                self.place()
            ),
            false => write!(f, "{} `{a}` meets `{b}`", self.place()),
        }
    }
}
