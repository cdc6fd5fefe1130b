//! Speeds: independent ones, and how all others follow from them.

use blocksim_block::physical::{Axis, Element, Freedom, MeshLoss};
use nalgebra::DMatrix;

use crate::assembly::eliminate::{Form, Relations};
use crate::assembly::members::Members;
use crate::assembly::words::Words;
use crate::mechanics::frames::Frames;
use crate::problem::NetworkProblem;

/// Relations of which less than this part (of the square) does not follow from others are dependent.
const DEPENDENT: f64 = 1e-10;

/// A place where a speed is seen: branch, rigid coupling, speed source or probe.
#[derive(Debug, Clone)]
pub(crate) struct Pin {
    /// Speed over the independent speeds.
    pub speed: Form,
    /// Speed over the prescribed speeds.
    pub prescribed: Form,
    /// Torque from `r` to `c` over the residuals of the nodes; only of rigid couplings and speed sources.
    pub reaction: Form,
    /// Index among the branches, if it is one.
    pub branch: Option<usize>,
}

/// A gear with losses.
#[derive(Debug, Clone)]
pub(crate) struct LossyGear {
    pub loss: MeshLoss,
    /// Speed of the base over the independent and the prescribed speeds.
    pub base: Form,
    pub base_prescribed: Form,
    pub base_node: usize,
    /// Lossless torque into the base over the derivatives of the independent speeds ...
    pub by_acceleration: Form,
    /// ... of the prescribed speeds ...
    pub by_prescribed: Form,
    /// ... over the torques of the branches ...
    pub by_torque: Form,
    /// ... and over the losses of all lossy meshes.
    pub by_loss: Vec<f64>,
}

/// The rotational side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rotation {
    /// Number of independent speeds.
    pub free: usize,
    /// Number of prescribed speeds.
    pub sources: usize,
    /// Speed of each joint over the independent and the prescribed speeds.
    pub joints: Vec<Form>,
    pub joints_prescribed: Vec<Form>,
    /// The independent speeds begin with all joints, and nothing is prescribed to them.
    pub joints_are_free: bool,
    /// Speed of each node over the independent and the prescribed speeds.
    pub nodes: Vec<Form>,
    pub nodes_prescribed: Vec<Form>,
    /// Moment of inertia of each node.
    pub inertia: Vec<f64>,
    /// `T'JT` over the independent speeds, row-major.
    pub reflected: Vec<f64>,
    pub pins: Vec<Pin>,
    /// Index of the pin of each branch; those of dry friction come last.
    pub branches: Vec<usize>,
    /// Number of branches that are not dry friction.
    pub smooth: usize,
    /// Nodes `r` and `c` of each branch.
    pub branch_nodes: Vec<(usize, usize)>,
    pub gears: Vec<LossyGear>,
    /// For each gear of all members, in order: torque through it over residuals, and its index among the lossy.
    pub all_gears: Vec<(Form, Option<usize>)>,
    /// Torque of the drive side on each joint over the residuals of the nodes.
    pub drives: Vec<Form>,
    /// Start values of the independent speeds.
    pub start: Vec<f64>,
    /// Reactions are forms over the residuals of the nodes and of the joints, not of the nodes alone.
    pub needs_joint_balance: bool,
    /// Names of the independent speeds for messages: joint index or node.
    pub names: Vec<String>,
}

/// What a row of the relations stands for.
enum Reason {
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

/// Finds the independent speeds of all members and everything that is constant about the others.
#[allow(clippy::too_many_lines)] // One pass over the elements, then one section for each result.
pub(crate) fn build(m: &Members, frames: &Frames) -> Result<Rotation, Vec<NetworkProblem>> {
    let nodes = m.rotational_nodes;
    let joints = frames.speeds.len();
    let mut rotation = Rotation { inertia: vec![0.0; nodes], ..Rotation::default() };
    rotation.sources = m.count(|element| matches!(element, Element::SpeedSource { .. }));
    let mut relations = Relations::new(nodes + joints, rotation.sources);
    let mut reasons = Vec::new();
    let mut pins: Vec<(usize, usize, Option<usize>)> = Vec::new(); // r, c, row of the reaction
    let mut gears: Vec<(usize, usize, f64, Option<MeshLoss>, usize)> = Vec::new();
    let mut drive_rows: Vec<Option<usize>> = vec![None; joints];
    let mut starts: Vec<Start> = Vec::new();
    let mut source = 0;
    let mut frictions = Vec::new();
    let mut freedoms_before = vec![0; m.list.len()];
    for (member, element) in m.elements() {
        let node = |port: usize| m.node(member, port);
        match *element {
            Element::Inertia { port, inertia, speed } => {
                rotation.inertia[node(port)] += inertia;
                if speed != 0.0 {
                    starts.push(Start { node: node(port), speed, member });
                }
            }
            Element::Branch { r, c } => {
                rotation.branches.push(pins.len());
                rotation.branch_nodes.push((node(r), node(c)));
                pins.push((node(r), node(c), None));
            }
            Element::Friction { r, c } => {
                frictions.push((pins.len(), (node(r), node(c))));
                pins.push((node(r), node(c), None));
            }
            Element::SpeedProbe { r, c } => pins.push((node(r), node(c), None)),
            Element::Rigid { r, c } => {
                let row = relations.add(&[(node(r), 1.0), (node(c), -1.0)], &[]);
                reasons.push(Reason::Rigid { member });
                pins.push((node(r), node(c), Some(row)));
            }
            Element::SpeedSource { r, c } => {
                let row = relations.add(&[(node(r), 1.0), (node(c), -1.0)], &[(source, 1.0)]);
                reasons.push(Reason::Source { member });
                pins.push((node(r), node(c), Some(row)));
                source += 1;
            }
            Element::Gear { base, follower, ratio, loss } => {
                let row = relations.add(&[(node(follower), 1.0), (node(base), -ratio)], &[]);
                reasons.push(Reason::Gear { member });
                gears.push((node(base), row, ratio, loss, member));
            }
            Element::Coupling { ref terms } => {
                let row: Vec<(usize, f64)> =
                    terms.iter().map(|(port, factor)| (node(*port), *factor)).collect();
                relations.add(&row, &[]);
                reasons.push(Reason::Coupling { member });
            }
            Element::MechanicalReference { port } => {
                relations.add(&[(node(port), 1.0)], &[]);
                reasons.push(Reason::Reference { member });
            }
            Element::Joint { ref freedoms, .. } => {
                let first = freedoms_before[member];
                freedoms_before[member] += freedoms.len();
                for (k, axis) in axes(freedoms) {
                    let (Some((r, c)), Some(joint)) = (axis.drive, frames.speed_of(member, first + k)) else {
                        continue;
                    };
                    if m.alone(member, r) && m.alone(member, c) {
                        // A drive side that nothing is connected to stands still, so that it is no free part.
                        for port in [r, c] {
                            relations.add(&[(node(port), 1.0)], &[]);
                            reasons.push(Reason::Joint { member });
                        }
                        continue;
                    }
                    let row = relations.add(&[(node(r), 1.0), (node(c), -1.0), (nodes + joint, -1.0)], &[]);
                    reasons.push(Reason::Joint { member });
                    drive_rows[joint] = Some(row);
                }
            }
            _ => {}
        }
    }

    rotation.smooth = rotation.branches.len();
    for (pin, nodes) in frictions {
        rotation.branches.push(pin);
        rotation.branch_nodes.push(nodes);
    }

    let eliminated = relations.eliminate(|unknown| u32::from(unknown >= nodes));
    let mut problems = Vec::new();
    for (row, fights) in &eliminated.dependent {
        problems.push(over_determined(&reasons[*row], *fights, &reasons, &relations, *row));
    }

    // Independent speeds: joints first, then nodes.
    let mut order: Vec<usize> = (0..eliminated.free.len()).collect();
    order.sort_by_key(|k| {
        let unknown = eliminated.free[*k];
        if unknown >= nodes { unknown - nodes } else { joints + unknown }
    });
    let over_free =
        |unknown: usize| -> Vec<f64> { order.iter().map(|k| eliminated.over_free[unknown][*k]).collect() };
    let free: Vec<usize> = order.iter().map(|k| eliminated.free[*k]).collect();
    rotation.free = free.len();
    rotation.nodes = (0..nodes).map(|node| Form::from_dense(&over_free(node))).collect();
    rotation.nodes_prescribed =
        (0..nodes).map(|node| Form::from_dense(&eliminated.over_given[node])).collect();
    rotation.joints = (0..joints).map(|joint| Form::from_dense(&over_free(nodes + joint))).collect();
    rotation.joints_prescribed =
        (0..joints).map(|joint| Form::from_dense(&eliminated.over_given[nodes + joint])).collect();
    rotation.joints_are_free = (0..joints).all(|joint| free.get(joint) == Some(&(nodes + joint)))
        && rotation.joints_prescribed.iter().all(Form::is_empty);
    rotation.names = free
        .iter()
        .map(|unknown| match unknown.checked_sub(nodes) {
            Some(joint) => frames.speeds[joint].name.clone(),
            None => format!("{}.{}", m.node_name(*unknown), Words::of(m.node_domain(*unknown)).speed),
        })
        .collect();

    rotation.reflected = vec![0.0; rotation.free * rotation.free];
    for (node, inertia) in rotation.inertia.iter().enumerate() {
        rotation.nodes[node].square_to(*inertia, &mut rotation.reflected, rotation.free);
    }
    for (k, unknown) in free.iter().enumerate().filter(|(_, unknown)| **unknown < nodes) {
        if rotation.reflected[k * rotation.free + k] == 0.0 {
            problems.push(m.no_inertia(*unknown));
        }
    }

    if problems.is_empty() {
        problems.extend(free_cases(m, &rotation));
    }

    // Reactions: residuals = A' lambda, so lambda = (A A')^-1 A residuals, with A the relations. The columns of the
    // nodes are enough unless a speed is prescribed to a joint: then the joint's own balance is needed as well.
    let inverse_over = |columns: usize| {
        let a = DMatrix::from_fn(relations.len(), columns, |row, column| relations.row(row)[column]);
        let gram = &a * a.transpose();
        let factor = gram.clone().cholesky()?;
        // What is left of a row that follows from those before it is rounding, of either sign.
        let l = factor.l_dirty();
        let independent = (0..gram.nrows()).all(|i| l[(i, i)].powi(2) > DEPENDENT * gram[(i, i)]);
        independent.then(|| factor.solve(&a))
    };
    let lossless = gears.iter().all(|(_, _, _, loss, _)| loss.is_none());
    let over_nodes = inverse_over(nodes);
    rotation.needs_joint_balance = over_nodes.is_none() && lossless;
    let columns = if rotation.needs_joint_balance { nodes + joints } else { nodes };
    let Some(left_inverse) = over_nodes.or_else(|| lossless.then(|| inverse_over(columns)).flatten()) else {
        if problems.is_empty() {
            problems.push(indeterminate(&reasons));
        }
        return Err(problems);
    };
    if !problems.is_empty() {
        return Err(problems);
    }
    let reaction = |row: usize, factor: f64| -> Form {
        let dense: Vec<f64> = (0..columns).map(|i| clean(left_inverse[(row, i)]) * factor).collect();
        Form::from_dense(&dense)
    };

    let difference = |forms: &dyn Fn(usize) -> Vec<f64>, r: usize, c: usize| -> Form {
        let (r, c) = (forms(r), forms(c));
        Form::from_dense(&r.iter().zip(&c).map(|(r, c)| r - c).collect::<Vec<_>>())
    };
    for (index, (r, c, row)) in pins.iter().enumerate() {
        rotation.pins.push(Pin {
            speed: difference(&over_free, *r, *c),
            prescribed: difference(&|node| eliminated.over_given[node].clone(), *r, *c),
            reaction: row.map_or_else(Form::default, |row| reaction(row, -1.0)),
            branch: rotation.branches.iter().position(|pin| *pin == index),
        });
    }
    for (base, row, ratio, loss, _) in &gears {
        let through = reaction(*row, *ratio);
        let lossy = loss.map(|loss| {
            rotation.gears.push(LossyGear {
                loss,
                base: rotation.nodes[*base].clone(),
                base_prescribed: rotation.nodes_prescribed[*base].clone(),
                base_node: *base,
                by_acceleration: Form::default(),
                by_prescribed: Form::default(),
                by_torque: Form::default(),
                by_loss: Vec::new(),
            });
            rotation.gears.len() - 1
        });
        rotation.all_gears.push((through, lossy));
    }
    pass_through(&mut rotation);
    rotation.drives =
        drive_rows.iter().map(|row| row.map_or_else(Form::default, |row| reaction(row, -1.0))).collect();
    rotation.start = start(m, &rotation, frames, &starts)?;
    Ok(rotation)
}

/// Writes the torque through every lossy gear as forms over accelerations, torques and losses: the residual of a
/// node is `J dw` plus the torques of the branches that leave it plus the losses of the meshes at their bases.
fn pass_through(rotation: &mut Rotation) {
    let nodes = rotation.nodes.len();
    let bases: Vec<usize> = rotation.gears.iter().map(|gear| gear.base_node).collect();
    let over_nodes: Vec<Form> = rotation
        .all_gears
        .iter()
        .filter(|(_, lossy)| lossy.is_some())
        .map(|(through, _)| through.clone())
        .collect();
    for (gear, through) in rotation.gears.iter_mut().zip(over_nodes) {
        let mut weight = vec![0.0; nodes];
        through.add_to(1.0, &mut weight);
        let mut acceleration = vec![0.0; rotation.free];
        let mut prescribed = vec![0.0; rotation.sources];
        for (node, weight) in weight.iter().enumerate() {
            let factor = weight * rotation.inertia[node];
            rotation.nodes[node].add_to(factor, &mut acceleration);
            rotation.nodes_prescribed[node].add_to(factor, &mut prescribed);
        }
        let torque: Vec<f64> = rotation.branch_nodes.iter().map(|(r, c)| weight[*r] - weight[*c]).collect();
        gear.by_acceleration = Form::from_dense(&acceleration);
        gear.by_prescribed = Form::from_dense(&prescribed);
        gear.by_torque = Form::from_dense(&torque);
        gear.by_loss = bases.iter().map(|base| weight[*base]).collect();
    }
}

/// Cases that nothing holds: without inertia and reference they would follow whatever pushes them.
fn free_cases(m: &Members, rotation: &Rotation) -> Vec<NetworkProblem> {
    let mut only_case = vec![None; rotation.nodes.len()];
    let mut other = vec![false; rotation.nodes.len()];
    for (member, element) in m.elements() {
        match *element {
            Element::Branch { r, c }
            | Element::Friction { r, c }
            | Element::Rigid { r, c }
            | Element::SpeedSource { r, c }
            | Element::SpeedProbe { r, c } => {
                only_case[m.node(member, c)] = Some(member);
                other[m.node(member, r)] = true;
            }
            Element::Joint { ref freedoms, .. } => {
                for (r, c) in axes(freedoms).filter_map(|(_, axis)| axis.drive) {
                    if !(m.alone(member, r) && m.alone(member, c)) {
                        only_case[m.node(member, c)] = Some(member);
                        other[m.node(member, r)] = true;
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
        .filter(|(node, _)| !other[*node] && !rotation.nodes[*node].is_empty())
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

/// Speeds at the start that inertias ask for; joints bring their own. Independent speeds that nobody asks for are
/// zero.
fn start(
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
    let fits = |start: &&Start| {
        (rotation.nodes[start.node].of(&v) - start.speed).abs() <= 1e-9 * (1.0 + start.speed.abs())
    };
    let Some(wrong) = starts.iter().find(|start| !fits(start)) else { return Ok(v) };
    let problem = NetworkProblem::new(
        "start_conflict",
        format!(
            "the speed of {} {} at the start does not fit the parts it is coupled to",
            wrong.speed,
            Words::of(m.node_domain(wrong.node)).unit
        ),
        "give one part of a rigidly coupled train its start speed, or start values that fit the ratios",
    );
    let form = &rotation.nodes[wrong.node];
    let coupled =
        |other: &&Start| rotation.nodes[other.node].terms().iter().any(|(k, _)| form.at(*k as usize) != 0.0);
    let others = starts.iter().filter(|other| other.member != wrong.member).filter(coupled);
    Err(vec![others.fold(problem.with(wrong.member, "asks for it"), |problem, other| {
        problem.with(other.member, "has a speed at the start, too")
    })])
}

/// A speed at the start that an inertia or a mass asks for.
struct Start {
    node: usize,
    speed: f64,
    member: usize,
}

/// The axes among freedoms, with their index.
fn axes(freedoms: &[Freedom]) -> impl Iterator<Item = (usize, &Axis)> {
    freedoms.iter().enumerate().filter_map(|(k, freedom)| match freedom {
        Freedom::Turn(axis) | Freedom::Slide(axis) => Some((k, axis)),
        Freedom::Ball { .. } => None,
    })
}

/// Rounding of the inverse must not couple drives that have nothing to do with each other.
fn clean(value: f64) -> f64 {
    if value.abs() < 1e-12 { 0.0 } else { value }
}

fn over_determined(
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

fn indeterminate(reasons: &[Reason]) -> NetworkProblem {
    let problem = NetworkProblem::new(
        "indeterminate_torque",
        "the loads inside this network cannot be known: parts are rigidly coupled twice over",
        "remove one of the couplings, or make one of them elastic with a spring",
    );
    reasons.iter().take(4).fold(problem, |problem, reason| problem.with(reason.member(), reason.what()))
}
