//! How far a place is out of reach, whatever the limits of the axes.
//!
//! The wrist centre of an arm of six axes lies between two distances from axis 2, which goes round on a circle about
//! axis 1. Where the orientation of the tool is free the tip is as far from there as the hand is long; where the tool may
//! turn about its axis, the wrist centre lies on a circle about it. Any other arm is within a ball whose radius is the sum of
//! its lengths; a slide adds half of its stroke to each side of its middle.

use std::f64::consts::TAU;

use crate::kinematics::{ClosedForm, OrthoParallel};
use crate::motion::{AxisKind, AxisLimits};
use crate::robot::{Link, Robot};
use blocksim_multibody::Placement;
use nalgebra::Vector3;

use crate::planner::task::Task;

/// Turns about the axis of the tool that are tried.
const TURNS: usize = 72;

/// Where the arm can be.
pub(crate) enum Workspace<'r> {
    /// Of six axes with a wrist: the reference in the world, and the wrist centre in the tool.
    Wrist { arm: &'r ClosedForm, reference: Placement, centre: Vector3<f64> },
    /// Of any other: the middle of where link 1 can be, in the reference, and the sum of all lengths and half strokes from
    /// there to the tip, m.
    Ball { centre: Vector3<f64>, radius: f64 },
}

impl<'r> Workspace<'r> {
    pub fn of(robot: &'r Robot) -> Self {
        let reference = robot.reference().placement;
        if let Some(arm) = robot.closed_form() {
            let centre = arm.end.inverse().point(&Vector3::new(0.0, 0.0, -arm.geometry.c4));
            return Workspace::Wrist { arm, reference, centre };
        }
        let parts = robot.parts();
        let tip = (parts.flange * parts.tool).translation.norm();
        // From the origin of the link before to the middle of where the origin of a link can be, in the frame of the link
        // before, and how far it goes from there. A turn of an axis leaves its own origin where it is.
        let seat = |link: &Link| match stroke(link) {
            Some([low, high]) => {
                (link.origin.point(&(slide(link) * (0.5 * (low + high)))), 0.5 * (high - low))
            }
            None => (link.origin.translation, 0.0),
        };
        let (first, half) = parts.links.first().map_or((Vector3::zeros(), 0.0), seat);
        let rest: f64 = parts.links.iter().skip(1).map(seat).map(|(middle, half)| middle.norm() + half).sum();
        let centre = reference.inverse().point(&parts.base.point(&first));
        Workspace::Ball { centre, radius: tip + half + rest }
    }

    /// By how much the arm does not reach a place of the tool in the reference, m; at most zero where it does.
    pub fn shortage(&self, task: &Task, place: &Placement) -> f64 {
        match self {
            Workspace::Ball { centre, radius } => (place.translation - centre).norm() - radius,
            Workspace::Wrist { arm, reference, centre } => {
                let in_arm = arm.base.inverse() * *reference;
                let outside = |point: &Vector3<f64>| outside(&arm.geometry, &in_arm.point(point));
                match task {
                    Task::Pose => outside(&place.point(centre)),
                    Task::Point => outside(&place.translation) - centre.norm(),
                    Task::Axis(z, [u, v]) => {
                        let middle = place.translation + z * centre.z;
                        let radius = centre.x.hypot(centre.y);
                        let at =
                            |angle: f64| outside(&(middle + (u * angle.cos() + v * angle.sin()) * radius));
                        let all = (0..TURNS).map(|k| at(TAU * k as f64 / TURNS as f64));
                        all.fold(f64::INFINITY, f64::min)
                    }
                }
            }
        }
    }
}

/// Unit vector along which a link slides, in its frame.
fn slide(link: &Link) -> Vector3<f64> {
    Vector3::from(link.axis).normalize()
}

/// From where to where a link slides, m; `None` where it turns.
fn stroke(link: &Link) -> Option<[f64; 2]> {
    let AxisLimits { kind, lower, upper, .. } = link.limits;
    let end = |value: f64| value.clamp(-ENDLESS, ENDLESS);
    (kind == AxisKind::Sliding).then_some([end(lower), end(upper)])
}

/// How far a slide without a limit goes, m.
const ENDLESS: f64 = 1e9;

/// How far a wrist centre is outside of where it can be, in the frame of the arm.
fn outside(arm: &OrthoParallel, centre: &Vector3<f64>) -> f64 {
    let radius = centre.x.hypot(centre.y);
    let (upper, fore) = (arm.c2, arm.a2.hypot(arm.c3));
    let ahead = (radius * radius - arm.b * arm.b).max(0.0).sqrt();
    let of_side = |side: f64| {
        let distance = (side * ahead - arm.a1).hypot(centre.z - arm.c1);
        (distance - upper - fore).max((upper - fore).abs() - distance)
    };
    of_side(1.0).min(of_side(-1.0)).max(arm.b.abs() - radius)
}
