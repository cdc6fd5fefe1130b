//! Speeds: independent ones, and how all others follow from them.

mod faults;
mod relate;
mod start;

use blocksim_block::physical::{Element, MeshLoss};
use nalgebra::DMatrix;

use self::faults::{free_cases, indeterminate, over_determined};
use self::relate::{Geared, Related, Seen, relate};
pub(crate) use self::start::Wish;
use self::start::{start, wishes};
use crate::assembly::eliminate::Form;
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
    /// Speeds that are given for the start.
    pub wishes: Vec<Wish>,
    /// Reactions are forms over the residuals of the nodes and of the joints, not of the nodes alone.
    pub needs_joint_balance: bool,
    /// Names of the independent speeds for messages: joint index or node.
    pub names: Vec<String>,
}

impl Rotation {
    /// Whether anything with inertia, or a joint, is accelerated by a prescribed speed.
    pub(crate) fn moves_masses(&self, source: usize) -> bool {
        let nodes = self.inertia.iter().zip(&self.nodes_prescribed);
        let mut nodes = nodes.filter(|(inertia, _)| **inertia != 0.0).map(|(_, form)| form);
        nodes.any(|form| form.at(source) != 0.0)
            || self.joints_prescribed.iter().any(|form| form.at(source) != 0.0)
    }
}

/// Finds the independent speeds of all members and everything that is constant about the others.
pub(crate) fn build(m: &Members, frames: &Frames) -> Result<Rotation, Vec<NetworkProblem>> {
    let nodes = m.rotational_nodes;
    let joints = frames.speeds.len();
    let sources = m.count(|element| matches!(element, Element::SpeedSource { .. }));
    let Related {
        relations,
        reasons,
        inertia,
        pins,
        branches,
        branch_nodes,
        smooth,
        gears,
        drive_rows,
        starts,
    } = relate(m, frames, sources);
    let mut rotation = Rotation { sources, inertia, branches, branch_nodes, smooth, ..Rotation::default() };

    // Where sources add to the speeds of others, a speed that is given for the start is exact as one of the independent ones only.
    let is_given = |unknown: usize| sources > 0 && starts.iter().any(|start| start.node == unknown);
    let eliminated = relations.eliminate(|unknown| match unknown {
        joint if joint >= nodes => 2,
        node => u32::from(is_given(node)),
    });
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
    let lossless = gears.iter().all(|gear| gear.loss.is_none());
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

    let difference = |forms: &dyn Fn(usize) -> Vec<f64>, r: usize, c: Option<usize>| -> Form {
        let Some(c) = c else { return Form::from_dense(&forms(r)) };
        let (r, c) = (forms(r), forms(c));
        Form::from_dense(&r.iter().zip(&c).map(|(r, c)| r - c).collect::<Vec<_>>())
    };
    for (index, Seen { r, c, row }) in pins.iter().enumerate() {
        rotation.pins.push(Pin {
            speed: difference(&over_free, *r, *c),
            prescribed: difference(&|node| eliminated.over_given[node].clone(), *r, *c),
            reaction: row.map_or_else(Form::default, |row| reaction(row, -1.0)),
            branch: rotation.branches.iter().position(|pin| *pin == index),
        });
    }
    for Geared { base, row, ratio, loss } in &gears {
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
    rotation.wishes = wishes(m, &rotation, frames, &starts);
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

/// Rounding of the inverse must not couple drives that have nothing to do with each other.
fn clean(value: f64) -> f64 {
    if value.abs() < 1e-12 { 0.0 } else { value }
}
