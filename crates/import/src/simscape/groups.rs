//! Groups of welded instances, and the joints between them.

use std::collections::{BTreeMap, VecDeque};

use blocksim_multibody::Placement;
use nalgebra::Vector3;

use super::Ties;
use super::apart::SAME;
use super::framed::{Framed, sorted};
use super::frames::{at_body, clean, gap, z_to};
use super::freedom::{Left, Row, left};
use super::instances::Instances;
use super::joints::Stated;
use crate::mechanism::{Joint, Mechanism, Motion, Start, find};
use crate::names::Names;
use crate::urdf::TAKEN;

/// A joint between two groups, in the world.
struct Link {
    name: String,
    motion: Motion,
    between: [usize; 2],
    frames: [Placement; 2],
}

/// Adds welds and joints to the bodies.
pub(super) fn assemble(
    mechanism: &mut Mechanism,
    instances: &Instances,
    body_of: &[Option<usize>],
    ties: Ties,
    framed: Vec<Framed>,
) {
    let mut group: Vec<usize> = (0..instances.nodes.len()).collect();
    rigid(&mut group, instances, &ties);
    for stated in ties.stated.iter().filter(|stated| stated.motion == Motion::Weld) {
        join(&mut group, stated.between);
    }
    let pairs = merge(&mut group, &ties);
    // The body that speaks for a group: none for the world's.
    let mut speaker: BTreeMap<usize, usize> = BTreeMap::new();
    for (node, body) in body_of.iter().enumerate() {
        if body.is_some() {
            speaker.entry(find(&group, node)).or_insert(node);
        }
    }
    let mut links = Vec::new();
    for ([a, b], (names, left)) in &pairs {
        links.extend(link(*a, *b, names, *left, &mut mechanism.notes));
    }
    for stated in ties.stated.into_iter().filter(|stated| stated.motion != Motion::Weld) {
        let [base, follower] = stated.between.map(|node| find(&group, node));
        match base == follower {
            true => mechanism.notes.push(format!(
                "`{}` joins two instances that are held together, and is left out",
                stated.name
            )),
            false => links.push(stated_link(stated, instances)),
        }
    }
    let framed = sorted(framed, &group, &mut mechanism.notes);
    let mut writer =
        Writer { mechanism, instances, body_of, group: &group, speaker: &speaker, framed, names: taken() };
    writer.names.take(writer.mechanism.bodies.iter().map(|body| body.name.clone()));
    writer.welds();
    writer.joints(links);
}

fn taken() -> Names {
    Names::new(&TAKEN)
}

fn join(group: &mut [usize], [a, b]: [usize; 2]) {
    let [a, b] = [find(group, a), find(group, b)];
    // The smaller one speaks, so that the world does.
    group[a.max(b)] = a.min(b);
}

/// Welds what is grounded or in one rigid group, and all of an assembly that is held rigid or says nothing about its parts.
fn rigid(group: &mut [usize], instances: &Instances, ties: &Ties) {
    let nodes = &instances.nodes;
    let (mut held, mut within) = (vec![false; nodes.len()], vec![false; nodes.len()]);
    let mut first_of: BTreeMap<(usize, &str), usize> = BTreeMap::new();
    for (at, node) in nodes.iter().enumerate().skip(1) {
        if let Some(name) = node.rigid_group {
            join(group, [at, *first_of.entry((node.around, name)).or_insert(at)]);
        }
        // What is around comes first.
        within[at] = within[node.around] || nodes[node.around].rigid;
        if node.grounded || within[at] || !ties.flexible.contains(&node.around) {
            join(group, [at, node.around]);
            held[node.around] = true;
        }
    }
    // What ties a part to the origin of the assembly around it holds that assembly.
    let both = ties.constraints.iter().map(|constraint| constraint.between);
    for between in both.chain(ties.stated.iter().map(|stated| stated.between)) {
        for [inner, outer] in [between, [between[1], between[0]]] {
            let mut around = nodes[inner].around;
            while around != 0 && around != outer {
                around = nodes[around].around;
            }
            held[outer] |= inner != 0 && around == outer;
        }
    }
    // A flexible assembly within another one hangs on its first part if nothing else holds it.
    for (at, node) in nodes.iter().enumerate().skip(1) {
        if node.around != 0 && !held[node.around] {
            join(group, [at, node.around]);
            held[node.around] = true;
        }
    }
}

type Pairs = BTreeMap<[usize; 2], (Vec<String>, Left)>;

/// Welds groups between which constraints leave nothing, until none is found; what is left between the others.
fn merge(group: &mut [usize], ties: &Ties) -> Pairs {
    loop {
        let mut rows: BTreeMap<[usize; 2], (Vec<String>, Vec<Row>)> = BTreeMap::new();
        for constraint in &ties.constraints {
            let [a, b] = constraint.between.map(|node| find(group, node));
            if a != b {
                let (names, all) = rows.entry([a.min(b), a.max(b)]).or_default();
                names.push(constraint.name.clone());
                all.extend(&constraint.rows);
            }
        }
        let found: Pairs =
            rows.into_iter().map(|(pair, (names, rows))| (pair, (names, left(&rows)))).collect();
        let welds: Vec<[usize; 2]> =
            found.iter().filter(|(_, (_, left))| *left == Left::Weld).map(|(pair, _)| *pair).collect();
        if welds.is_empty() {
            return found;
        }
        welds.into_iter().for_each(|pair| join(group, pair));
    }
}

fn link(a: usize, b: usize, names: &[String], left: Left, notes: &mut Vec<String>) -> Option<Link> {
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let at = |point: Vector3<f64>, axis: Vector3<f64>| Placement { rotation: z_to(axis), translation: point };
    let (motion, frame) = match left {
        Left::Revolute { point, axis } => (Motion::Revolute { axis: Z }, at(point, axis)),
        Left::Prismatic { axis } => (Motion::Prismatic { axis: Z }, at(Vector3::zeros(), axis)),
        Left::Cylindrical { point, axis } => (Motion::Cylindrical, at(point, axis)),
        Left::Planar { axis } => (Motion::Planar, at(Vector3::zeros(), axis)),
        Left::Spherical { point } => (Motion::Spherical, at(point, Vector3::z())),
        Left::Weld => return None,
        Left::Other(n) => {
            notes.push(format!(
                "the constraints {} leave {n} freedoms that no joint has, and are left out",
                names.join(", ")
            ));
            return None;
        }
    };
    Some(Link { name: String::new(), motion, between: [a, b], frames: [frame, frame] })
}

fn stated_link(stated: Stated, instances: &Instances) -> Link {
    let frames = [0, 1].map(|side| instances.nodes[stated.between[side]].place * stated.frames[side]);
    Link { name: stated.name, motion: stated.motion, between: stated.between, frames }
}

struct Writer<'w, 'a> {
    mechanism: &'w mut Mechanism,
    instances: &'w Instances<'a>,
    body_of: &'w [Option<usize>],
    group: &'w [usize],
    /// The instance that speaks for a group.
    speaker: &'w BTreeMap<usize, usize>,
    /// What a data file says of joints, by the groups between which they are.
    framed: BTreeMap<[usize; 2], Framed>,
    names: Names,
}

impl Writer<'_, '_> {
    /// The body of a group with its place; the world for its own group, `None` for groups without bodies.
    fn seat(&self, node: usize) -> Option<(Option<usize>, Placement)> {
        match find(self.group, node) {
            0 => Some((None, Placement::identity())),
            group => {
                let speaker = *self.speaker.get(&group)?;
                Some((self.body_of[speaker], self.instances.nodes[speaker].place))
            }
        }
    }

    /// Welds all bodies of a group to the one that speaks for it, or to the world.
    fn welds(&mut self) {
        for node in 1..self.instances.nodes.len() {
            let (Some(body), Some((base, place))) = (self.body_of[node], self.seat(node)) else { continue };
            if base == Some(body) {
                continue;
            }
            let name = self.names.give_joint(&format!("{}_weld", self.mechanism.bodies[body].name));
            let in_base = clean(place.inverse() * self.instances.nodes[node].place);
            self.push(name.clone(), name, Motion::Weld, (base, body), in_base, None, Start::Open);
        }
    }

    /// Joints outwards from the world; groups that hang on nothing fly.
    fn joints(&mut self, links: Vec<Link>) {
        let mut near: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (i, link) in links.iter().enumerate() {
            link.between.iter().for_each(|node| near.entry(find(self.group, *node)).or_default().push(i));
        }
        let (mut seen, mut done) = (vec![false; self.instances.nodes.len()], vec![false; links.len()]);
        let groups: Vec<usize> = std::iter::once(0).chain(self.speaker.keys().copied()).collect();
        for first in groups {
            if seen[first] {
                continue;
            }
            if first != 0 {
                self.fly(first);
            }
            seen[first] = true;
            let mut open = VecDeque::from([first]);
            while let Some(here) = open.pop_front() {
                for i in near.get(&here).into_iter().flatten() {
                    if std::mem::replace(&mut done[*i], true) {
                        continue;
                    }
                    let there = self.joint(&links[*i], here);
                    if !std::mem::replace(&mut seen[there], true) {
                        open.push_back(there);
                    }
                }
            }
        }
        if self.mechanism.has_loop() {
            self.mechanism
                .notes
                .push("joints close a loop; the positions at the start are found when the model runs".into());
        }
    }

    /// A group that nothing ties to the world.
    fn fly(&mut self, group: usize) {
        let Some((Some(body), place)) = self.seat(group) else { return };
        let original = self.mechanism.bodies[body].original.clone();
        self.mechanism.notes.push(format!("nothing ties `{original}` to the world: it flies (FreeJoint)"));
        let name = self.names.give_joint(&format!("{}_flight", self.mechanism.bodies[body].name));
        let start = Start::Placement(clean(place));
        self.push(name.clone(), name, Motion::Free, (None, body), Placement::identity(), None, start);
    }

    /// Adds a joint, its base towards `here`; returns the group on the other side.
    fn joint(&mut self, link: &Link, here: usize) -> usize {
        let forward = find(self.group, link.between[0]) == here;
        let there = find(self.group, link.between[usize::from(forward)]);
        // A joint that is stated has a direction of its own, unless it would carry the world.
        let stated = !link.name.is_empty() && find(self.group, link.between[1]) != 0;
        let [a, b] = if forward || stated { [0, 1] } else { [1, 0] };
        let (Some((base, base_place)), Some((Some(follower), follower_place))) =
            (self.seat(link.between[a]), self.seat(link.between[b]))
        else {
            let [one, other] = link.between.map(|node| &*self.instances.nodes[node].name);
            self.mechanism.notes.push(format!(
                "the joint between `{one}` and `{other}` is left out, as no part stands on one side of it: what it holds may \
                 come loose"
            ));
            return there;
        };
        let base_name = base.map_or("world", |base| &self.mechanism.bodies[base].name);
        let own = format!("{base_name}_to_{}", self.mechanism.bodies[follower].name);
        let original = if link.name.is_empty() { own } else { link.name.clone() };
        let name = self.names.give_joint(&original);
        let sides = [a, b].map(|side| find(self.group, link.between[side]));
        let from_data =
            self.framed.get(&[sides[0].min(sides[1]), sides[0].max(sides[1])]).and_then(|framed| {
                framed.of(sides, link.motion, &link.frames[a], self.group, &mut self.mechanism.notes)
            });
        let (motion, frames, given) = match from_data {
            Some((frames, given)) => (link.motion, frames, given),
            None if link.name.is_empty() => {
                let (motion, frame) = at_body(link.motion, &link.frames[b], &follower_place);
                (motion, [frame, frame], None)
            }
            None => (link.motion, [link.frames[a], link.frames[b]], None),
        };
        let in_base = clean(base_place.inverse() * frames[0]);
        let in_follower = clean(follower_place.inverse() * frames[1]);
        let now = frames[0].inverse() * frames[1];
        let drawn = match motion {
            _ if frames[0] == frames[1] && !one_axis(link.motion) => Start::Open,
            Motion::Revolute { .. } => Start::Position(now.rotation[(1, 0)].atan2(now.rotation[(0, 0)])),
            Motion::Prismatic { .. } => Start::Position(now.translation.z),
            _ => Start::Placement(now),
        };
        if let (Some(Start::Position(given)), Start::Position(drawn)) = (given, drawn)
            && gap(motion, given - drawn) > SAME
        {
            self.mechanism.notes.push(format!(
                "`{name}` starts at {given:.6} by the data file and was drawn at {drawn:.6}; the data file counts"
            ));
        }
        let start = given.unwrap_or(drawn);
        let in_follower = (in_follower != Placement::identity()).then_some(in_follower);
        self.push(name, original, motion, (base, follower), in_base, in_follower, start);
        there
    }

    #[allow(clippy::too_many_arguments)]
    fn push(
        &mut self,
        name: String,
        original: String,
        motion: Motion,
        (base, follower): (Option<usize>, usize),
        in_base: Placement,
        in_follower: Option<Placement>,
        start: Start,
    ) {
        self.mechanism.joints.push(Joint {
            name,
            original,
            motion,
            base,
            follower,
            in_base,
            in_follower,
            start,
            range: None,
            speed: None,
            effort: None,
            damping: 0.0,
        });
    }
}

fn one_axis(motion: Motion) -> bool {
    matches!(motion, Motion::Revolute { .. } | Motion::Prismatic { .. })
}
