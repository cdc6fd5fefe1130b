//! Speeds at the start.

use super::Rotation;
use crate::assembly::eliminate::{Form, Relations};
use crate::assembly::members::Members;
use crate::assembly::words::Words;
use crate::mechanics::frames::Frames;
use crate::problem::NetworkProblem;

/// A speed at the start that an inertia or a mass asks for.
pub(super) struct Start {
    pub node: usize,
    pub speed: f64,
    pub member: usize,
}

/// A speed that is given for the start, by a joint or by an inertia.
#[derive(Debug, Clone)]
pub(crate) struct Wish {
    pub member: usize,
    /// Over the independent speeds.
    pub form: Form,
    pub speed: f64,
    pub unit: &'static str,
}

/// What joints and inertias ask for, of those whose speed the sources do not prescribe.
pub(super) fn wishes(m: &Members, rotation: &Rotation, frames: &Frames, starts: &[Start]) -> Vec<Wish> {
    let joints = rotation.joints.iter().zip(&rotation.joints_prescribed).zip(&frames.speeds);
    let joints =
        joints.filter(|((_, prescribed), _)| prescribed.is_empty()).filter_map(|((form, _), joint)| {
            let unit = if joint.slides { "m/s" } else { "rad/s" };
            Some(Wish { member: joint.member, form: form.clone(), speed: joint.start?, unit })
        });
    let nodes = starts.iter().filter(|start| rotation.nodes_prescribed[start.node].is_empty());
    let nodes = nodes.map(|start| Wish {
        member: start.member,
        form: rotation.nodes[start.node].clone(),
        speed: start.speed,
        unit: Words::of(m.node_domain(start.node)).unit,
    });
    joints.chain(nodes).collect()
}

/// Speeds at the start that inertias ask for; joints bring their own. Independent speeds that nobody asks for are
/// zero.
pub(super) fn start(
    m: &Members,
    rotation: &Rotation,
    frames: &Frames,
    starts: &[Start],
) -> Result<Vec<f64>, Vec<NetworkProblem>> {
    let mut asked = Relations::new(rotation.free, 1);
    let mut ask = |form: &Form, speed: f64| {
        let terms: Vec<(usize, f64)> =
            form.terms().iter().map(|(k, factor)| (*k as usize, *factor)).collect();
        asked.add(&terms, &[(0, speed)]);
    };
    for (form, joint) in rotation.joints.iter().zip(&frames.speeds) {
        if let Some(speed) = joint.start {
            ask(form, speed);
        }
    }
    starts.iter().for_each(|start| ask(&rotation.nodes[start.node], start.speed));
    let v: Vec<f64> = asked.eliminate(|_| 0).over_given.iter().map(|row| row[0]).collect();
    // What sources add is not known before the run.
    let adds = |start: &Start| !rotation.nodes_prescribed[start.node].is_empty();
    let fits = |start: &&Start| {
        let form = &rotation.nodes[start.node];
        // Zero at a part that a source moves asks for nothing.
        let is_free = !adds(start) || start.speed == 0.0 && form.terms().is_empty();
        is_free && (form.of(&v) - start.speed).abs() <= 1e-9 * (1.0 + start.speed.abs())
    };
    let Some(wrong) = starts.iter().find(|start| !fits(start)) else { return Ok(v) };
    let unit = Words::of(m.node_domain(wrong.node)).unit;
    let problem = if adds(wrong) {
        NetworkProblem::new(
            "start_conflict",
            format!(
                "the speed of {} {unit} at the start follows from a source that prescribes speeds",
                wrong.speed
            ),
            "leave it out; where it follows from the start speed of another part as well, give one of the two",
        )
    } else {
        NetworkProblem::new(
            "start_conflict",
            format!(
                "the speed of {} {unit} at the start does not fit the parts it is coupled to",
                wrong.speed
            ),
            "give one part of a rigidly coupled train its start speed, or start values that fit the ratios",
        )
    };
    let form = &rotation.nodes[wrong.node];
    let coupled =
        |other: &&Start| rotation.nodes[other.node].terms().iter().any(|(k, _)| form.at(*k as usize) != 0.0);
    let others = starts.iter().filter(|other| other.member != wrong.member).filter(coupled);
    Err(vec![others.fold(problem.with(wrong.member, "asks for it"), |problem, other| {
        problem.with(other.member, "has a speed at the start, too")
    })])
}
