//! Speeds that contradict each other, loads that cannot be known, cases that nothing holds.

use blocksim_block::physical::{Element, Freedom};

use super::Rotation;
use crate::assembly::eliminate::Relations;
use crate::assembly::members::Members;
use crate::assembly::words::Words;
use crate::problem::NetworkProblem;

/// What a row of the relations stands for.
pub(super) enum Reason {
    Gear { member: usize },
    Coupling { member: usize },
    Reference { member: usize },
    Rigid { member: usize },
    Source { member: usize },
    Joint { member: usize },
}

impl Reason {
    fn member(&self) -> usize {
        match self {
            Reason::Gear { member }
            | Reason::Coupling { member }
            | Reason::Reference { member }
            | Reason::Rigid { member }
            | Reason::Source { member }
            | Reason::Joint { member } => *member,
        }
    }

    fn what(&self) -> &'static str {
        match self {
            Reason::Gear { .. } | Reason::Coupling { .. } => "couples these speeds",
            Reason::Reference { .. } => "holds the speed at zero",
            Reason::Rigid { .. } => "couples these speeds",
            Reason::Source { .. } => "prescribes the speed",
            Reason::Joint { .. } => "couples the drive side to the joint",
        }
    }
}

/// Two relations of which one follows from the others, or contradicts them.
pub(super) fn over_determined(
    reason: &Reason,
    fights: bool,
    reasons: &[Reason],
    relations: &Relations,
    row: usize,
) -> NetworkProblem {
    let shares = |other: usize| {
        let (a, b) = (relations.row(row), relations.row(other));
        a.iter().zip(b).any(|(a, b)| *a != 0.0 && *b != 0.0)
    };
    let problem = if fights {
        NetworkProblem::new(
            "speed_conflict",
            "two parts prescribe the same speed",
            "remove one of them, or put a spring, a damper or a clutch between them",
        )
    } else {
        NetworkProblem::new(
            "indeterminate_torque",
            "this coupling is rigid twice over: how the load divides cannot be known",
            "remove one of the couplings, or make one of them elastic with a spring",
        )
    };
    let mut problem = problem.with(reason.member(), reason.what());
    for (index, other) in reasons.iter().enumerate() {
        if index != row && other.member() != reason.member() && shares(index) {
            problem = problem.with(other.member(), other.what());
        }
    }
    problem
}

/// Loads that divide in a way that rigid parts do not tell.
pub(super) fn indeterminate(reasons: &[Reason]) -> NetworkProblem {
    let problem = NetworkProblem::new(
        "indeterminate_torque",
        "the loads inside this network cannot be known: parts are rigidly coupled twice over",
        "remove one of the couplings, or make one of them elastic with a spring",
    );
    reasons.iter().take(4).fold(problem, |problem, reason| problem.with(reason.member(), reason.what()))
}

/// Cases that nothing holds: without inertia and reference they would follow whatever pushes them.
pub(super) fn free_cases(m: &Members, rotation: &Rotation) -> Vec<NetworkProblem> {
    let mut only_case = vec![None; rotation.nodes.len()];
    let mut other = vec![false; rotation.nodes.len()];
    // A sensor of torques passes on what is joined to its case, and nothing where it is alone there.
    let (mut cases, mut rigid) = (vec![0; rotation.nodes.len()], vec![false; rotation.nodes.len()]);
    for (member, element) in m.elements() {
        match *element {
            Element::Rigid { r, c } => {
                only_case[m.node(member, c)] = Some(member);
                other[m.node(member, r)] = true;
                cases[m.node(member, c)] += 1;
                rigid[m.node(member, c)] = true;
            }
            Element::Branch { r, c }
            | Element::Friction { r, c }
            | Element::SpeedSource { r, c }
            | Element::SpeedProbe { r, c } => {
                only_case[m.node(member, c)] = Some(member);
                other[m.node(member, r)] = true;
                cases[m.node(member, c)] += 1;
            }
            Element::Joint { ref freedoms, .. } => {
                for (r, c) in freedoms.iter().filter_map(Freedom::axis).filter_map(|axis| axis.drive) {
                    if !(m.alone(member, r) && m.alone(member, c)) {
                        only_case[m.node(member, c)] = Some(member);
                        other[m.node(member, r)] = true;
                        cases[m.node(member, c)] += 1;
                    }
                }
            }
            Element::Inertia { port, .. } | Element::MechanicalReference { port } => {
                other[m.node(member, port)] = true
            }
            Element::Coupling { ref terms } => {
                terms.iter().for_each(|(port, _)| other[m.node(member, *port)] = true);
            }
            Element::Gear { base, follower, .. } => {
                other[m.node(member, base)] = true;
                other[m.node(member, follower)] = true;
            }
            _ => {}
        }
    }
    only_case
        .iter()
        .enumerate()
        .filter(|(node, _)| !(other[*node] || rigid[*node] && cases[*node] > 1))
        .filter(|(node, _)| !rotation.nodes[*node].is_empty())
        .filter_map(|(node, member)| {
            let reference = Words::of(m.node_domain(node)).reference;
            let problem = NetworkProblem::new(
                "missing_reference",
                format!("nothing holds the case at `{}`", m.node_name(node)),
                format!("connect it to a {reference}, or to the part that it is mounted on"),
            );
            member.map(|member| problem.with(member, "would move its case instead of its rod"))
        })
        .collect()
}
