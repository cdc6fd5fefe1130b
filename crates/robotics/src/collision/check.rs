//! All solids of a mechanism and of its surroundings.

use std::cell::RefCell;
use std::collections::HashMap;

use blocksim_multibody::Placement;
use blocksim_scene::{Scene, Shape};

use crate::collision::distance::{Distance, distance};
use crate::collision::solid::Solid;

/// Distance at rest up to which two solids count as touching, m.
const TOUCHING: f64 = 1e-3;
/// Parts that are nearer than this at rest are near by construction, m.
const CLOSE: f64 = 0.02;

/// A solid on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What it belongs to.
    pub name: String,
    /// Index of the body, 0 for the world; `None` of an obstacle, which is fixed in the world as well, but never may be
    /// touched.
    pub body: Option<usize>,
    /// The solid.
    pub solid: Solid,
    /// Where it is in the frame of the body.
    pub place: Placement,
}

/// Exceptions: pairs of names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rules {
    /// May touch.
    pub may_touch: Vec<[String; 2]>,
    /// May not touch, although they are neighbours or touch at rest.
    pub may_not_touch: Vec<[String; 2]>,
}

/// The nearest pair in a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// Names of both, the same as in [`Item::name`].
    pub names: [String; 2],
    /// How far they are from each other and where, in the world.
    pub distance: Distance,
}

/// All solids of a mechanism and of its surroundings, and which pairs of them are looked at.
#[derive(Debug, Clone)]
pub struct Check {
    pub(crate) items: Vec<Item>,
    pub(crate) reach: Vec<f64>,
    pub(crate) pairs: Vec<Pair>,
    left_out: Vec<[String; 2]>,
    unchecked: Vec<String>,
}

/// Two solids that are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pair {
    /// Indices.
    pub of: [usize; 2],
    /// Whether they are close at rest: then their distance says nothing of a pose, unless they touch.
    pub close: bool,
}

impl Pair {
    /// The distance from which on nothing is to be told of the pair, where only what is nearer than `bound` is.
    pub fn bound(&self, bound: f64) -> f64 {
        if self.close { bound.min(f64::MIN_POSITIVE) } else { bound }
    }
}

impl Check {
    /// Solids on bodies. `parents` are those of the bodies, the world first; `rest` are the placements of the bodies in a
    /// pose without collision, which tells what may touch.
    ///
    /// Pairs on one body and on neighbours are left out: a body and the next one towards the world that has solids. What
    /// stands in the world is a neighbour where it touches the body at rest, as the base of a robot does. Other pairs that
    /// are within 1 mm at rest are left out as well, obstacles excepted. Of those within 20 mm at rest collisions are told, but
    /// no distances: they would hide all others.
    pub fn new(items: Vec<Item>, parents: &[Option<usize>], rest: &[Placement], rules: &Rules) -> Self {
        let check = Check {
            reach: items.iter().map(|item| item.solid.reach()).collect(),
            items,
            pairs: Vec::new(),
            left_out: Vec::new(),
            unchecked: Vec::new(),
        };
        let places = check.places(rest);
        // Each pair is measured once, and only where their spheres leave that open.
        let known = RefCell::new(HashMap::new());
        let at_rest = |i: usize, k: usize| {
            let centres = (places[i].translation - places[k].translation).norm();
            let bound = centres - check.reach[i] - check.reach[k];
            if bound > 2.0 * CLOSE {
                return bound;
            }
            let measure = || check.between([i, k], [&places[i], &places[k]]).distance;
            *known.borrow_mut().entry([i.min(k), i.max(k)]).or_insert_with(measure)
        };
        let touches = |i: usize, k: usize| at_rest(i, k) <= TOUCHING;
        // In the world: a base, of which any solid touches the body.
        let is_base = |i: usize, k: usize| {
            let base = |other: &Item| other.body == Some(0) && other.name == check.items[i].name;
            let on_body = |other: &Item| other.body == check.items[k].body;
            let of = |which: &dyn Fn(&Item) -> bool| -> Vec<usize> {
                (0..check.items.len()).filter(|n| which(&check.items[*n])).collect()
            };
            let bodies = of(&on_body);
            of(&base).iter().any(|a| bodies.iter().any(|b| touches(*a, *b)))
        };
        let listed = |pairs: &[[String; 2]], i: usize, k: usize| {
            let (a, b) = (&check.items[i].name, &check.items[k].name);
            pairs.iter().any(|[x, y]| (x == a && y == b) || (x == b && y == a))
        };
        let (mut pairs, mut left_out) = (Vec::new(), Vec::new());
        for k in 0..check.items.len() {
            for i in 0..k {
                let look = match (check.items[i].body, check.items[k].body) {
                    (None | Some(0), None | Some(0)) => false,
                    (Some(a), Some(b)) if a == b => false,
                    _ if listed(&rules.may_not_touch, i, k) => true,
                    _ if listed(&rules.may_touch, i, k) => false,
                    (None, _) | (_, None) => true,
                    (Some(a), Some(b)) => {
                        let neighbours =
                            check.before(parents, a) == Some(b) || check.before(parents, b) == Some(a);
                        let joined = match (a, b) {
                            (0, _) => neighbours && is_base(i, k),
                            (_, 0) => neighbours && is_base(k, i),
                            _ => neighbours,
                        };
                        let touching = !joined && touches(i, k);
                        if touching {
                            left_out.push([check.items[i].name.clone(), check.items[k].name.clone()]);
                        }
                        !joined && !touching
                    }
                };
                if look {
                    let own = check.items[i].body.is_some() && check.items[k].body.is_some();
                    let close = own && at_rest(i, k) <= CLOSE;
                    pairs.push(Pair { of: [i, k], close });
                }
            }
        }
        left_out.sort();
        left_out.dedup();
        Check { pairs, left_out, ..check }
    }

    /// The solids of a scene, at rest as it starts, and obstacles in the world: name and shape. Meshes are not looked at;
    /// [`Check::unchecked`] names them.
    pub fn of_scene(scene: &Scene, obstacles: &[(String, Shape)], rules: &Rules) -> Self {
        let on_bodies = scene.shapes.iter().map(|shape| (Some(shape.body), &shape.owner, &shape.shape));
        let around = obstacles.iter().map(|(name, shape)| (None, name, shape));
        let (mut items, mut unchecked) = (Vec::new(), Vec::new());
        for (body, name, shape) in on_bodies.chain(around).filter(|(_, _, shape)| shape.collides()) {
            match Solid::of(&shape.form) {
                Some(solid) => items.push(Item { name: name.clone(), body, solid, place: shape.place }),
                None => unchecked.push(name.clone()),
            }
        }
        unchecked.dedup();
        let parents: Vec<Option<usize>> = scene.bodies.iter().map(|body| body.parent).collect();
        Check { unchecked, ..Check::new(items, &parents, &scene.poses(&scene.start()), rules) }
    }

    /// Pairs of names that touch at rest and are therefore not looked at, each once.
    pub fn left_out(&self) -> &[[String; 2]] {
        &self.left_out
    }

    /// Names of what cannot be looked at, because it is a mesh.
    pub fn unchecked(&self) -> &[String] {
        &self.unchecked
    }

    /// The same of some of its pairs: obstacles with bodies, or bodies among themselves.
    pub fn with_obstacles(&self, obstacles: bool) -> Check {
        let is_one = |pair: &Pair| pair.of.iter().any(|i| self.items[*i].body.is_none());
        let pairs = self.pairs.iter().copied().filter(|pair| is_one(pair) == obstacles).collect();
        Check { pairs, ..self.clone() }
    }

    /// The names of all solids, each once.
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.items.iter().map(|item| item.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Number of pairs that are looked at.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// The nearest pair when the bodies are at `poses`, the world first; `None` where there is no pair.
    pub fn clearance(&self, poses: &[Placement]) -> Option<Clearance> {
        self.nearer(poses, f64::INFINITY)
    }

    /// What touches when the bodies are at `poses`, with the least distance; `None` where nothing does.
    pub fn touches(&self, poses: &[Placement]) -> Option<Clearance> {
        self.nearer(poses, f64::MIN_POSITIVE)
    }

    /// The nearest pair, if it is nearer than a bound.
    fn nearer(&self, poses: &[Placement], mut bound: f64) -> Option<Clearance> {
        let places = self.places(poses);
        let mut best = None;
        for pair in &self.pairs {
            let [i, k] = pair.of;
            let centres = (places[i].translation - places[k].translation).norm();
            if centres - self.reach[i] - self.reach[k] >= pair.bound(bound) {
                continue;
            }
            let found = self.between([i, k], [&places[i], &places[k]]);
            if found.distance < pair.bound(bound) {
                bound = found.distance;
                best = Some((pair.of, found));
            }
        }
        best.map(|(pair, distance)| self.clearance_of(pair, distance))
    }

    pub(crate) fn clearance_of(&self, pair: [usize; 2], distance: Distance) -> Clearance {
        Clearance { names: pair.map(|i| self.items[i].name.clone()), distance }
    }

    pub(crate) fn between(&self, [i, k]: [usize; 2], [a, b]: [&Placement; 2]) -> Distance {
        distance(&self.items[i].solid, a, &self.items[k].solid, b)
    }

    /// Where all solids are in the world.
    pub(crate) fn places(&self, poses: &[Placement]) -> Vec<Placement> {
        (0..self.items.len()).map(|item| self.place(item, poses)).collect()
    }

    /// Where a solid is in the world.
    pub(crate) fn place(&self, item: usize, poses: &[Placement]) -> Placement {
        let item = &self.items[item];
        match item.body.and_then(|body| poses.get(body)) {
            Some(pose) => *pose * item.place,
            None => item.place,
        }
    }

    /// The next body towards the world that has solids.
    fn before(&self, parents: &[Option<usize>], body: usize) -> Option<usize> {
        let parent = |body: &usize| parents.get(*body).copied().flatten();
        let mut ancestors = std::iter::successors(parent(&body), parent);
        ancestors.find(|body| self.items.iter().any(|item| item.body == Some(*body)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_scene::{Form, Purpose};
    use blocksim_scene::{Motion, SceneBody, SceneShape};

    /// Three links in the x-y plane, each 1 m long and turning about z, as capsules of radius 0.1 m on a post.
    fn arm() -> Scene {
        let mut scene = Scene::new();
        let capsule = |owner: &str, body: usize| SceneShape {
            body,
            owner: owner.to_owned(),
            shape: Shape {
                purpose: Purpose::Both,
                form: Form::Capsule { radius: 0.1, length: 0.7 },
                place: Placement::from_rpy([0.5, 0.0, 0.0], [0.0, std::f64::consts::FRAC_PI_2, 0.0]),
                colour: None,
            },
        };
        let mut post = capsule("post", 0);
        post.shape.form = Form::Cylinder { radius: 0.2, length: 2.0 };
        post.shape.place = Placement::from_translation([0.0, 0.0, -1.1005]);
        scene.shapes.push(post);
        for body in 1..=3 {
            let x = if body == 1 { 0.0 } else { 1.0 };
            scene.bodies.push(SceneBody {
                name: format!("joint{body}"),
                parent: Some(body - 1),
                place: Placement::from_translation([x, 0.0, 0.0]),
                motion: Motion::Turn { axis: [0.0, 0.0, 1.0], signal: format!("q{body}") },
                start: vec![0.0],
            });
            scene.shapes.push(capsule(&format!("link{body}"), body));
        }
        scene
    }

    fn table(z: f64) -> (String, Shape) {
        let place = Placement::from_translation([2.0, 1.0, z - 0.05]);
        let shape =
            Shape { purpose: Purpose::Both, form: Form::Box { size: [1.0, 1.0, 0.1] }, place, colour: None };
        ("table".to_owned(), shape)
    }

    #[test]
    fn an_arm_that_folds_touches_itself_and_the_first_pose_is_told() {
        let scene = arm();
        let check = Check::of_scene(&scene, &[], &Rules::default());
        assert!(check.left_out().is_empty() && check.unchecked().is_empty());
        let stretched = check.clearance(&scene.poses(&[0.0; 3])).expect("a pair");
        // Link 2 begins 1.05 m out, the post ends 0.2 m out and 0.1005 m below.
        let expected = 0.95_f64.hypot(0.1005) - 0.1;
        assert!((stretched.distance.distance - expected).abs() < 1e-12, "{stretched:?}");
        // Both elbows fold: at 120 degrees each the links form a triangle, and link 3 meets link 1.
        let way: Vec<Vec<Placement>> = (0..=120)
            .map(|degrees| {
                scene.poses(&[0.0, f64::from(degrees).to_radians(), f64::from(degrees).to_radians()])
            })
            .collect();
        let course = check.along(&way);
        let (first, clearance) = course.first.expect("a collision");
        assert_eq!(clearance.names, ["link1", "link3"]);
        let before = check.clearance(&way[first - 1]).expect("a pair");
        assert!(
            before.distance.distance > 0.0 && clearance.distance.distance <= 0.0 && first > 90,
            "{first}"
        );
        assert!(course.least.expect("a pair").1.distance.distance <= clearance.distance.distance);
    }

    #[test]
    fn obstacles_are_never_excused_and_neighbours_only_by_the_rules() {
        let scene = arm();
        let over = Check::of_scene(&scene, &[table(-0.3)], &Rules::default());
        let way: Vec<Vec<Placement>> =
            (0..=90).map(|degrees| scene.poses(&[f64::from(degrees).to_radians(), 0.0, 0.0])).collect();
        let course = over.along(&way);
        assert_eq!(course.first, None);
        let (_, least) = course.least.expect("a pair");
        assert!(
            least.names.contains(&"table".to_owned()) && (least.distance.distance - 0.2).abs() < 1e-9,
            "{least:?}"
        );
        let through = Check::of_scene(&scene, &[table(0.0)], &Rules::default()).along(&way);
        assert!(through.first.is_some_and(|(row, hit)| row > 0 && hit.names.contains(&"table".to_owned())));
        let pair = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
        let rules = Rules {
            may_touch: vec![pair("table", "link3"), pair("link2", "table")],
            may_not_touch: Vec::new(),
        };
        assert_eq!(Check::of_scene(&scene, &[table(0.0)], &rules).along(&way).first, None);
        let strict = Rules { may_touch: Vec::new(), may_not_touch: vec![pair("link1", "link2")] };
        let strict =
            Check::of_scene(&scene, &[], &strict).clearance(&scene.poses(&[0.0; 3])).expect("a pair");
        assert_eq!(strict.names, pair("link1", "link2"));
    }

    #[test]
    fn what_touches_at_rest_is_left_out_and_told() {
        let mut scene = arm();
        // A box on link 1 reaches to link 3.
        let mut shape = scene.shapes[1].clone();
        shape.owner = "cover".to_owned();
        shape.shape.form = Form::Box { size: [0.1, 0.1, 4.0] };
        scene.shapes.push(shape);
        let check = Check::of_scene(&scene, &[], &Rules::default());
        assert_eq!(check.left_out(), [["link3".to_owned(), "cover".to_owned()]]);
        scene.shapes[3].shape.form = Form::Mesh { file: "a.stl".to_owned(), scale: [1.0; 3] };
        assert_eq!(Check::of_scene(&scene, &[], &Rules::default()).unchecked(), ["link3"]);
    }
}
