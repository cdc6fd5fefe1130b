//! Modified nodal analysis of an island for one set of conducting valves.
//!
//! With the conductances `G`, the incidence `A` of all branches that prescribe a voltage (sources, capacitances, wires,
//! ideal contacts, transformers) and that of the branches whose current is given, `A_w`,
//!
//! ```text
//! | G  A' | | v |   | -A_w' i_w |      Kirchhoff's law at every node
//! | A -R  | | i | = |     e     |      prescribed voltages
//! ```
//!
//! with the resistances `R` of conducting valves, which may be zero: as conductances they would make currents out of the
//! rounding of potentials. So
//! every voltage and every current is a linear form over the given values `(e, i_w, 1)`. Parts of the circuit that
//! nothing but given currents connects to ground float: one of their nodes is held at zero here, through which no
//! current flows as long as the given currents obey Kirchhoff's law, and [`Floating`] finds the true potential.

use nalgebra::DMatrix;
use petgraph::unionfind::UnionFind;

use super::conducting::{Conducting, Unsolvable};
use super::floating::Floating;
use super::{Branch, Electrics, Island, TwoPin};
use crate::assembly::eliminate::{Form, Relations};

/// Voltages and currents of the two-pins of an island, in their order.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub voltages: Vec<Form>,
    pub currents: Vec<Form>,
    pub floating: Option<Floating>,
    /// Conducting valves whose current is zero because its way ends in a part that floats.
    pub idle: Conducting,
    /// No voltage follows from a current that components give.
    pub stiff: bool,
}

/// What a branch is while certain valves conduct.
#[derive(Debug, Clone, Copy)]
enum Now {
    /// Prescribes the voltage: index of a given value and its factor.
    Row(Option<(usize, f64)>),
    /// Resistance above zero, and the voltage that remains: index of a given value and its factor.
    Resistance(f64, Option<(usize, f64)>),
    Conductance(f64),
    Given(usize),
    Open,
    Primary(f64),
    Secondary,
}

fn now(branch: Branch, conducting: Conducting, one: usize) -> Now {
    match branch {
        Branch::Source(index) | Branch::Variable(index) => Now::Row(Some((index, 1.0))),
        Branch::Wire => Now::Row(None),
        Branch::Given(index) => Now::Given(index),
        Branch::Conductance(g) => Now::Conductance(g),
        Branch::Probe => Now::Open,
        Branch::Primary(ratio) => Now::Primary(ratio),
        Branch::Secondary => Now::Secondary,
        Branch::Valve { index, on_resistance, forward_voltage, off_conductance } => {
            // Both lines meet at the forward voltage and the leakage that flows there.
            let remains = forward_voltage * (1.0 - on_resistance * off_conductance);
            let forward = (remains != 0.0).then_some((one, remains));
            if conducting >> index & 1 == 0 {
                match off_conductance {
                    0.0 => Now::Open,
                    g => Now::Conductance(g),
                }
            } else if on_resistance == 0.0 {
                Now::Row(forward)
            } else {
                Now::Resistance(on_resistance, forward)
            }
        }
    }
}

/// Solves an island while certain valves conduct.
pub(crate) fn solve(
    electrics: &Electrics,
    island: &Island,
    conducting: Conducting,
) -> Result<Solved, Unsolvable> {
    let (nodes, given) = (island.nodes.len(), electrics.given());
    let branches: Vec<Now> =
        island.two_pins.iter().map(|pin| now(pin.branch, conducting, given - 1)).collect();
    let part = parts(island, &branches);
    let floating = Floating::find(electrics, island, conducting, &part)?;

    let rows =
        branches.iter().filter(|b| matches!(b, Now::Row(_) | Now::Resistance(..) | Now::Primary(_))).count();
    let size = nodes + rows;
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let mut right = DMatrix::<f64>::zeros(size, given);
    let mut row_of = vec![None; branches.len()];
    let mut row = nodes;
    for (i, (pin, branch)) in island.two_pins.iter().zip(&branches).enumerate() {
        match *branch {
            Now::Row(value) | Now::Resistance(_, value) => {
                couple(&mut matrix, row, pin, 1.0);
                if let Now::Resistance(r, _) = *branch {
                    matrix[(row, row)] = -r;
                }
                if let Some((index, factor)) = value {
                    right[(row, index)] += factor;
                }
                row_of[i] = Some((row, 1.0));
                row += 1;
            }
            Now::Primary(ratio) => {
                couple(&mut matrix, row, pin, 1.0);
                couple(&mut matrix, row, &island.two_pins[i + 1], -ratio);
                row_of[i] = Some((row, 1.0));
                row_of[i + 1] = Some((row, -ratio));
                row += 1;
            }
            Now::Conductance(g) => {
                for (a, sign_a) in ends(pin) {
                    for (b, sign_b) in ends(pin) {
                        matrix[(a, b)] += g * sign_a * sign_b;
                    }
                }
            }
            Now::Given(index) => ends(pin).for_each(|(node, sign)| right[(node, index)] -= sign),
            Now::Open | Now::Secondary => {}
        }
    }
    for node in floating.iter().flat_map(|floating| &floating.nodes) {
        matrix[(*node, *node)] += 1.0;
    }
    let Some(solution) = matrix.clone().lu().solve(&right).filter(|s| well(&matrix, s, &right)) else {
        let closed = |b: &Now| matches!(b, Now::Row(_) | Now::Primary(_) | Now::Secondary);
        let all = island.two_pins.iter().zip(&branches).enumerate();
        return Err(Unsolvable::Loop(all.filter(|(_, (_, b))| closed(b)).map(|(i, _)| i).collect()));
    };

    let potential = |node: Option<usize>, k: usize| node.map_or(0.0, |node| solution[(node, k)]);
    // The voltage of a branch that gives it; as a difference of potentials it would be rounding where it is zero.
    let known = |i: usize, k: usize| {
        let (drop, given) = match branches[i] {
            Now::Resistance(r, given) => (row_of[i].map_or(0.0, |(row, _)| r * solution[(row, k)]), given),
            Now::Row(given) => (0.0, given),
            _ => (0.0, None),
        };
        drop + given.filter(|(index, _)| *index == k).map_or(0.0, |(_, factor)| factor)
    };
    let mut solved = Solved { voltages: Vec::new(), currents: Vec::new(), floating, idle: 0, stiff: false };
    for (i, (pin, branch)) in island.two_pins.iter().zip(&branches).enumerate() {
        let voltage: Vec<f64> = match closed_beside(island, &branches, i) {
            Some((closed, sign)) => (0..given).map(|k| sign * known(closed, k)).collect(),
            None => (0..given).map(|k| potential(pin.p, k) - potential(pin.n, k)).collect(),
        };
        let current: Vec<f64> = match (*branch, row_of[i]) {
            (_, Some((row, factor))) => (0..given).map(|k| factor * solution[(row, k)]).collect(),
            (Now::Conductance(g), _) => voltage.iter().map(|v| g * v).collect(),
            (Now::Given(index), _) => {
                let mut unit = vec![0.0; given];
                unit[index] = 1.0;
                unit
            }
            _ => vec![0.0; given],
        };
        solved.voltages.push(form(&voltage));
        solved.currents.push(form(&current));
    }
    solved.idle = idle(island, &branches, &solved, given);
    let of_sources = |form: &Form| {
        form.terms().iter().all(|(i, _)| (*i as usize) < electrics.sources || *i as usize == given - 1)
    };
    solved.stiff = solved.floating.is_none() && solved.voltages.iter().all(of_sources);
    Ok(solved)
}

/// Valves whose current is a sum of currents that leave floating parts, which are zero.
fn idle(island: &Island, branches: &[Now], solved: &Solved, given: usize) -> Conducting {
    if island.valves.is_empty() {
        return 0;
    }
    let mut ended = Relations::new(given, 0);
    for leaving in solved.floating.iter().flat_map(|floating| &floating.leaving) {
        ended.add(leaving, &[]);
    }
    let ended = ended.eliminate(|_| 0);
    let is_zero = |form: &Form| {
        let mut rest = vec![0.0; ended.free.len()];
        let mut size = 0.0_f64;
        for (i, factor) in form.terms() {
            size = size.max(factor.abs());
            rest.iter_mut().zip(&ended.over_free[*i as usize]).for_each(|(to, by)| *to += factor * by);
        }
        rest.iter().all(|rest| rest.abs() <= 1e-9 * size)
    };
    let valves = island.two_pins.iter().zip(branches).zip(&solved.currents);
    valves.fold(0, |idle, ((pin, now), current)| match pin.branch {
        Branch::Valve { index, .. } if !matches!(now, Now::Open | Now::Conductance(_)) => {
            idle | Conducting::from(is_zero(current)) << index
        }
        _ => idle,
    })
}

/// The first branch between the nodes of a two-pin that gives the voltage there, the two-pin itself if it does, and whether
/// it points the same way.
fn closed_beside(island: &Island, branches: &[Now], i: usize) -> Option<(usize, f64)> {
    let gives = |k: usize| matches!(branches[k], Now::Row(_) | Now::Resistance(..));
    let pin = &island.two_pins[i];
    let sign = |other: &TwoPin| match (other.p, other.n) {
        ends if ends == (pin.p, pin.n) => Some(1.0),
        ends if ends == (pin.n, pin.p) => Some(-1.0),
        _ => None,
    };
    if gives(i) {
        return Some((i, 1.0));
    }
    (0..branches.len()).filter(|k| gives(*k)).find_map(|k| Some((k, sign(&island.two_pins[k])?)))
}

/// The ends of a two-pin that are no ground, with the sign of the current into the two-pin.
fn ends(pin: &TwoPin) -> impl Iterator<Item = (usize, f64)> + use<> {
    [(pin.p, 1.0), (pin.n, -1.0)].into_iter().filter_map(|(node, sign)| node.map(|node| (node, sign)))
}

fn couple(matrix: &mut DMatrix<f64>, row: usize, pin: &TwoPin, factor: f64) {
    for (node, sign) in ends(pin) {
        matrix[(row, node)] += sign * factor;
        matrix[(node, row)] += sign * factor;
    }
}

/// Whether a solution satisfies its equations: elimination of a singular matrix may end with garbage.
fn well(matrix: &DMatrix<f64>, solution: &DMatrix<f64>, right: &DMatrix<f64>) -> bool {
    let scale = right.amax() + matrix.amax() * 1e-3;
    let error = matrix * solution - right;
    solution.iter().all(|v| v.is_finite()) && error.amax() <= 1e-8 * scale
}

/// Rounding must not make one part of a circuit depend on another.
pub(super) fn form(row: &[f64]) -> Form {
    let scale = row.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    Form::from_dense(&row.iter().map(|v| if v.abs() < 1e-12 * scale { 0.0 } else { *v }).collect::<Vec<_>>())
}

/// The part of the circuit that each node belongs to: 0 is what is connected to ground by voltages or conductances;
/// transformers connect nothing.
fn parts(island: &Island, branches: &[Now]) -> Vec<usize> {
    let ground = island.nodes.len();
    let mut joined = UnionFind::new(ground + 1);
    for (pin, branch) in island.two_pins.iter().zip(branches) {
        if !matches!(branch, Now::Given(_) | Now::Open | Now::Primary(_) | Now::Secondary) {
            joined.union(pin.p.unwrap_or(ground), pin.n.unwrap_or(ground));
        }
    }
    let mut roots = vec![joined.find(ground)];
    (0..ground)
        .map(|node| {
            let root = joined.find(node);
            roots.iter().position(|known| *known == root).unwrap_or_else(|| {
                roots.push(root);
                roots.len() - 1
            })
        })
        .collect()
}
