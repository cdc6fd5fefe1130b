//! Values that are given for the start and are not those with which a run starts: positions that do not close a loop of bodies,
//! speeds that do not keep it closed or do not fit what couples the joints.

use blocksim_multibody::forward_kinematics;

use crate::assembly::members::Members;
use crate::mechanics::frames::Frames;
use crate::mechanics::rotation::Rotation;
use crate::problem::NetworkProblem;

/// What digits that are written down leave, rad, or relative to the size of the mechanism or to the speed. The largest error of a value
/// of three digits is half of this.
const DIGITS: f64 = 1e-2;
/// Speeds below this part of the fastest are zero.
const ZERO: f64 = 1e-9;

/// One warning for each value that is given and not kept.
pub(crate) fn moved(m: &Members, frames: &Frames, rotation: &Rotation) -> Vec<NetworkProblem> {
    let mut found = positions(m, frames);
    found.extend(speeds(m, rotation));
    found.extend(prescribed(m, frames, rotation));
    found
}

fn positions(m: &Members, frames: &Frames) -> Vec<NetworkProblem> {
    let (Some(model), false) = (frames.model.as_ref(), frames.loops.is_empty()) else { return Vec::new() };
    let mut data = model.data();
    forward_kinematics(model, &mut data, &frames.position);
    let reach = model.bodies().map(|body| data.placement(body).translation.norm()).fold(0.0_f64, f64::max);
    let mut found = Vec::new();
    let mut warn = |member: usize, what: String| {
        let path = m.path(member);
        let problem = NetworkProblem::new(
            "start_moved",
            format!("`{path}` {what}, as its loop does not close otherwise"),
            "leave out `position` or `orientation` of the joints that follow from the others, or give values with which the loop closes",
        );
        found.push(problem.with(member, "is given another start"));
    };
    for speed in frames.speeds.iter().filter(|speed| speed.given) {
        let Some(i) = speed.position else { continue };
        let (given, taken) = (frames.asked[i], frames.position[i]);
        let way = (taken - given).abs();
        if speed.slides && way > DIGITS * reach.max(given.abs()) {
            warn(
                speed.member,
                format!(
                    "starts at {} mm in the place of {} mm",
                    five_digits(1e3 * taken),
                    five_digits(1e3 * given)
                ),
            );
        } else if !speed.slides && way > DIGITS {
            let (taken, given) = (taken.to_degrees(), given.to_degrees());
            warn(speed.member, format!("starts at {taken:.2} deg in the place of {given:.2} deg"));
        }
    }
    for ball in frames.balls.iter().filter(|ball| frames.speeds[ball.speed].given) {
        let places = ball.position..ball.position + 4;
        let cosine: f64 = places.map(|i| frames.asked[i] * frames.position[i]).sum();
        let turned = 2.0 * cosine.abs().min(1.0).acos();
        if turned > DIGITS {
            warn(
                ball.member,
                format!("starts turned by {:.2} deg from its `orientation`", turned.to_degrees()),
            );
        }
    }
    found
}

/// Whatever the size: a slow speed is no zero.
fn five_digits(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

/// Joints that a source moves: what it prescribes at the start is not known before the run.
fn prescribed(m: &Members, frames: &Frames, rotation: &Rotation) -> Vec<NetworkProblem> {
    let joints = frames.speeds.iter().zip(&rotation.joints_prescribed);
    let given = joints.filter(|(joint, by)| !by.is_empty() && joint.start.is_some_and(|speed| speed != 0.0));
    let warning = |member: usize| {
        let message = format!(
            "the start speed of `{}` has no effect: a source prescribes how fast this joint moves",
            m.path(member)
        );
        NetworkProblem::new("start_moved", message, "leave it out: the joint begins as the source does")
            .with(member, "moves as the source does")
    };
    given.map(|(joint, _)| warning(joint.member)).collect()
}

fn speeds(m: &Members, rotation: &Rotation) -> Vec<NetworkProblem> {
    let fastest = rotation.start.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let wishes = rotation.wishes.iter().map(|wish| (wish, wish.form.of(&rotation.start)));
    let missed = wishes.filter(|(wish, taken)| {
        (taken - wish.speed).abs() > (DIGITS * taken.abs().max(wish.speed.abs())).max(ZERO * fastest)
    });
    let mut found: Vec<NetworkProblem> = Vec::new();
    for (wish, taken) in missed {
        // The speed of a ball has three parts.
        if found.iter().any(|other| other.members[0].0 == wish.member) {
            continue;
        }
        let message = format!(
            "`{}` starts at {} {unit} in the place of {} {unit}, as the parts that it is coupled to allow nothing else",
            m.path(wish.member),
            five_digits(taken),
            five_digits(wish.speed),
            unit = wish.unit
        );
        let help = "leave out the speeds at the start that follow from the others, or give values that fit";
        found.push(
            NetworkProblem::new("start_moved", message, help).with(wish.member, "is given another speed"),
        );
    }
    found
}
