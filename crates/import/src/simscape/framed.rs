//! Frames of joints as a data file has them, held against what the assembly leaves.

use std::collections::BTreeMap;

use blocksim_multibody::Placement;

use super::apart::{SAME, apart, distance};
use crate::mechanism::{Motion, Start, find};
use crate::smidata::JointStart;

/// Frames of a joint as the data file has them, in the world, and where the joint starts.
#[derive(Debug, Clone)]
pub(super) struct Framed {
    pub id: String,
    pub between: [usize; 2],
    pub frames: [Placement; 2],
    pub start: Option<JointStart>,
    /// Where the first number stands, `data.m:12`.
    pub at: String,
}

/// The frames of the data file by the groups that they join; what holds welded bodies is compared with the assembly.
pub(super) fn sorted(
    framed: Vec<Framed>,
    group: &[usize],
    notes: &mut Vec<String>,
) -> BTreeMap<[usize; 2], Framed> {
    let mut found = BTreeMap::new();
    for framed in framed {
        let [a, b] = framed.between.map(|node| find(group, node));
        if a != b {
            found.entry([a.min(b), a.max(b)]).or_insert(framed);
        } else if let Some(apart) = apart(&framed.frames[0], &framed.frames[1]) {
            let Framed { id, at, .. } = framed;
            notes.push(format!(
                "{at}: `{id}` holds its parts {apart} from where they stand in the assembly, which counts: export both \
                 files again"
            ));
        }
    }
    found
}

impl Framed {
    /// Frames of a joint on the sides of the groups `a` and `b`, and where it starts. `drawn` is the frame that the
    /// assembly leaves, in the world. `None` with a note if the data file has a joint of another kind.
    pub(super) fn of(
        &self,
        [a, b]: [usize; 2],
        motion: Motion,
        drawn: &Placement,
        group: &[usize],
        notes: &mut Vec<String>,
    ) -> Option<([Placement; 2], Option<Start>)> {
        let Framed { id, at, .. } = self;
        let kind = kind(motion);
        if let Some(start) = &self.start
            && start.kind != kind
        {
            notes.push(format!("{at}: `{id}` is a {}, by the assembly a {kind}, which counts", start.kind));
            return None;
        }
        let along = find(group, self.between[0]) == a && find(group, self.between[1]) == b;
        let frames = if along { self.frames } else { [self.frames[1], self.frames[0]] };
        let far = frames
            .iter()
            .map(|frame| off(motion, drawn, frame))
            .fold([0.0, 0.0], |x: [f64; 2], y| [x[0].max(y[0]), x[1].max(y[1])]);
        if far[0] > SAME || far[1] > SAME {
            notes.push(format!(
                "{at}: the axis of `{id}` is {} from where the constraints of the assembly put it; the data file counts",
                distance(far[0], far[1])
            ));
        }
        let start = self.start.as_ref().and_then(|start| started(motion, start.coordinates, along));
        Some((frames, start))
    }
}

/// What data files call a joint.
fn kind(motion: Motion) -> &'static str {
    match motion {
        Motion::Weld => "WeldJoint",
        Motion::Revolute { .. } => "RevoluteJoint",
        Motion::Prismatic { .. } => "PrismaticJoint",
        Motion::Cylindrical => "CylindricalJoint",
        Motion::Planar => "PlanarJoint",
        Motion::Spherical => "SphericalJoint",
        Motion::Free => "SixDofJoint",
    }
}

/// Gap and angle between two frames, without what the joint leaves free.
fn off(motion: Motion, drawn: &Placement, frame: &Placement) -> [f64; 2] {
    let gap = frame.translation - drawn.translation;
    let (z, axis) = (drawn.rotation.column(2).into_owned(), frame.rotation.column(2).into_owned());
    // An axis that points the other way is the same line.
    let turn = axis.cross(&z).norm().atan2(axis.dot(&z).abs());
    match motion {
        Motion::Revolute { .. } | Motion::Cylindrical => [gap.cross(&z).norm(), turn],
        Motion::Prismatic { .. } | Motion::Planar => [0.0, turn],
        Motion::Spherical => [gap.norm(), 0.0],
        Motion::Weld | Motion::Free => [0.0, 0.0],
    }
}

/// The start that coordinates give; `along` if the joint points as in the data file.
fn started(motion: Motion, [px, py, pz, rz]: [Option<f64>; 4], along: bool) -> Option<Start> {
    let one = |x: Option<f64>| x.map(|x| Start::Position(if along { x } else { -x }));
    let placed = |x: f64, y: f64, z: f64, angle: f64| {
        let place = Placement::from_rpy([x, y, z], [0.0, 0.0, angle]);
        Start::Placement(if along { place } else { place.inverse() })
    };
    match motion {
        Motion::Revolute { .. } => one(rz),
        Motion::Prismatic { .. } => one(pz),
        Motion::Cylindrical => Some(placed(0.0, 0.0, pz?, rz?)),
        Motion::Planar => Some(placed(px?, py?, 0.0, rz?)),
        Motion::Spherical | Motion::Free | Motion::Weld => None,
    }
}
