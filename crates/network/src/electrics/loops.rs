//! Loops of branches that prescribe voltages, closed by capacitances: their voltages depend on each other.
//!
//! Let `B y = D e` be Kirchhoff's law of these loops, with the voltages `y` of the capacitances and `e` of the sources in
//! them. A current `j` flows in each loop that is not known from voltages: `y' = (i + B' j) / C` with the currents `i` that
//! the rest of the circuit has. The law holds for ever, so
//!
//! ```text
//! (B C^-1 B') j = D e' - B C^-1 i
//! ```
//!
//! which stands among the equations of the nodal analysis, one line for the capacitance that closes each loop
//! ([`Solved`](super::Solved)). It asks for the slopes `e'` of the sources. The states do not: what they hold is
//!
//! ```text
//! x = y - S e,    S = C^-1 B' (B C^-1 B')^-1 D
//! ```
//!
//! the voltages without the charge that the sources have pushed through the loops. `B x = 0`, and `x'` is `y'` for `e' = 0`.
//! So a source may jump, or be a signal whose slope nobody knows; only the current through it is unknown then, which is
//! told where somebody looks at it. `S` is that of the loops that are there whatever valves do; where ideal valves close
//! others, slopes must be known, and charges divide when that happens (`charges.rs`).

use nalgebra::{DMatrix, DVector};
use petgraph::unionfind::UnionFind;

use super::{Branch, Capacitance, Electrics, Island, Shift};
use crate::assembly::eliminate::Form;

/// Coefficients below this part of the largest of their row are rounding.
const ZERO: f64 = 1e-11;

/// A loop that a capacitance closes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loop {
    /// Position of the two-pin of the capacitance.
    pub chord: usize,
    /// Its voltage is the sum of these voltages, two-pins with factors.
    pub others: Vec<(usize, f64)>,
}

/// The loops of the branches for which `closed` holds, all of which prescribe voltages, and of the transformers.
///
/// # Errors
/// Positions of the two-pins of a loop that no capacitance closes, or that a transformer of variable ratio belongs to, with the factors
/// with which their voltages add up to zero.
pub(crate) fn find(
    electrics: &Electrics,
    island: &Island,
    closed: impl Fn(usize) -> bool,
) -> Result<Vec<Loop>, Vec<(usize, f64)>> {
    let is_capacitance = |i: usize| electrics.capacitance(&island.two_pins[i].branch).is_some();
    let all = || (0..island.two_pins.len()).filter(|i| closed(*i));
    // Capacitances come last, so that they close the loops.
    let order: Vec<usize> =
        all().filter(|i| !is_capacitance(*i)).chain(all().filter(|i| is_capacitance(*i))).collect();
    let transformers = island.two_pins.iter().any(|pin| matches!(pin.branch, Branch::Primary(_)));
    let loops = if transformers { by_elimination(island, &order) } else { by_tree(island, &order) };
    for l in &loops {
        let variable = |(i, _): &(usize, f64)| matches!(island.two_pins[*i].branch, Branch::Variable(_));
        if !is_capacitance(l.chord) || l.others.iter().any(variable) {
            return Err(l.others.iter().copied().chain([(l.chord, -1.0)]).collect());
        }
    }
    Ok(loops)
}

/// By way of a spanning forest.
fn by_tree(island: &Island, order: &[usize]) -> Vec<Loop> {
    let ground = island.nodes.len();
    let ends = |i: usize| {
        let pin = &island.two_pins[i];
        (pin.p.unwrap_or(ground), pin.n.unwrap_or(ground))
    };
    let mut joined = UnionFind::new(ground + 1);
    let mut beside: Vec<Vec<(usize, usize, f64)>> = vec![Vec::new(); ground + 1];
    let mut loops = Vec::new();
    for &i in order {
        let (p, n) = ends(i);
        if joined.union(p, n) {
            // From p to n the potential falls by the voltage.
            beside[p].push((n, i, 1.0));
            beside[n].push((p, i, -1.0));
        } else {
            loops.push(Loop { chord: i, others: way(&beside, p, n) });
        }
    }
    loops
}

/// The branches on the way between two nodes of a forest.
fn way(beside: &[Vec<(usize, usize, f64)>], from: usize, to: usize) -> Vec<(usize, f64)> {
    let mut came: Vec<Option<(usize, usize, f64)>> = vec![None; beside.len()];
    let mut open = vec![from];
    while let Some(node) = open.pop() {
        if node == to {
            break;
        }
        for &(other, branch, sign) in &beside[node] {
            if other != from && came[other].is_none() {
                came[other] = Some((node, branch, sign));
                open.push(other);
            }
        }
    }
    let mut way = Vec::new();
    let mut node = to;
    while let Some((before, branch, sign)) = came[node].filter(|_| node != from) {
        way.push((branch, sign));
        node = before;
    }
    way.reverse();
    way
}

/// By elimination of the potentials, where transformers tie some to others.
fn by_elimination(island: &Island, order: &[usize]) -> Vec<Loop> {
    let nodes = island.nodes.len();
    let primaries = (0..island.two_pins.len())
        .filter(|i| matches!(island.two_pins[*i].branch, Branch::Primary(_)) && !order.contains(i));
    let rows: Vec<usize> = primaries.chain(order.iter().copied()).collect();
    let mut done: Vec<(usize, Vec<f64>, Vec<f64>)> = Vec::new();
    let mut loops = Vec::new();
    for (r, &i) in rows.iter().enumerate() {
        let mut row = vec![0.0; nodes];
        let mut put = |node: Option<usize>, value: f64| node.into_iter().for_each(|node| row[node] += value);
        let pin = &island.two_pins[i];
        put(pin.p, 1.0);
        put(pin.n, -1.0);
        if let Branch::Primary(ratio) = pin.branch {
            let other = &island.two_pins[i + 1];
            put(other.p, -ratio);
            put(other.n, ratio);
        }
        let scale = row.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let mut of = vec![0.0; rows.len()];
        of[r] = 1.0;
        for (pivot, other, other_of) in &done {
            let factor = row[*pivot];
            if factor != 0.0 {
                row.iter_mut().zip(other).for_each(|(to, from)| *to -= factor * from);
                of.iter_mut().zip(other_of).for_each(|(to, from)| *to -= factor * from);
            }
        }
        let largest = (0..nodes).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs()).then(b.cmp(a)));
        match largest.filter(|pivot| row[*pivot].abs() > ZERO * scale) {
            Some(pivot) => {
                let inverse = 1.0 / row[pivot];
                row.iter_mut().chain(&mut of).for_each(|value| *value *= inverse);
                done.push((pivot, row, of));
            }
            None => {
                let others = rows.iter().zip(&of).take(r).filter(|(_, factor)| factor.abs() > ZERO);
                loops.push(Loop { chord: i, others: others.map(|(i, factor)| (*i, -factor)).collect() });
            }
        }
    }
    loops
}

/// The law of loops over the capacitances and the other voltages in them.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    /// Positions of the capacitances, and of all other branches in the loops.
    pub capacitances: Vec<usize>,
    pub others: Vec<usize>,
    /// Which of the capacitances closes each loop.
    pub chords: Vec<usize>,
    /// `B` and `D`, by loops.
    pub b: DMatrix<f64>,
    pub d: DMatrix<f64>,
    /// `1 / C` of each capacitance.
    pub elastance: Vec<f64>,
}

impl Law {
    pub(crate) fn of(electrics: &Electrics, island: &Island, loops: &[Loop]) -> Self {
        let capacitance = |i: usize| electrics.capacitance(&island.two_pins[i].branch);
        let mut all: Vec<usize> = loops.iter().flat_map(|l| l.others.iter().map(|(i, _)| *i)).collect();
        all.extend(loops.iter().map(|l| l.chord));
        all.sort_unstable();
        all.dedup();
        let (capacitances, others): (Vec<usize>, Vec<usize>) =
            all.into_iter().partition(|i| capacitance(*i).is_some());
        let factor = |l: &Loop, i: usize| -> f64 {
            l.others.iter().filter(|(other, _)| *other == i).map(|(_, factor)| factor).sum()
        };
        let b = DMatrix::from_fn(loops.len(), capacitances.len(), |l, k| {
            f64::from(u8::from(loops[l].chord == capacitances[k])) - factor(&loops[l], capacitances[k])
        });
        let d = DMatrix::from_fn(loops.len(), others.len(), |l, k| factor(&loops[l], others[k]));
        let elastance =
            capacitances.iter().map(|i| capacitance(*i).map_or(0.0, |c| 1.0 / c.capacitance)).collect();
        let chords = loops.iter().filter_map(|l| capacitances.iter().position(|i| *i == l.chord)).collect();
        Self { capacitances, others, chords, b, d, elastance }
    }

    /// `B C^-1`.
    fn yielding(&self, elastance: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.b.nrows(), self.b.ncols(), |l, k| self.b[(l, k)] * elastance[k])
    }

    /// `S`: what each other voltage adds to that of each capacitance.
    fn shift(&self) -> Option<DMatrix<f64>> {
        let yielding = self.yielding(&self.elastance);
        let inverse = (&yielding * self.b.transpose()).cholesky()?;
        Some(yielding.transpose() * inverse.solve(&self.d))
    }

    /// Charges through the capacitances that close the loops, after which the law holds: `(B C^-1 B')^-1 r`.
    pub(crate) fn charges(&self, missing: &DVector<f64>) -> DVector<f64> {
        let yielding = self.yielding(&self.elastance);
        let matrix = &yielding * self.b.transpose();
        matrix.cholesky().map_or_else(|| DVector::zeros(missing.len()), |factor| factor.solve(missing))
    }

    /// The nearest voltages that obey the law, in the sense of the charge that they take; those that are given stay.
    /// Returns them and by how much each loop still misses.
    pub(crate) fn fit(
        &self,
        y: &DVector<f64>,
        e: &DVector<f64>,
        given: &[bool],
    ) -> (DVector<f64>, DVector<f64>) {
        let elastance: Vec<f64> =
            self.elastance.iter().zip(given).map(|(s, given)| if *given { 0.0 } else { *s }).collect();
        let yielding = self.yielding(&elastance);
        let matrix = &yielding * self.b.transpose();
        let missing = &self.d * e - &self.b * y;
        let largest = matrix.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let charges =
            matrix.svd(true, true).solve(&missing, 1e-12 * largest).unwrap_or_else(|_| missing.clone());
        let y = y + yielding.transpose() * charges;
        let left = &self.d * e - &self.b * &y;
        (y, left)
    }
}

/// What the sources in the loops that are always there add to the voltages of capacitances.
pub(super) fn shifts(electrics: &Electrics, island: &Island, law: &Law) -> Vec<Shift> {
    let Some(s) = law.shift() else { return Vec::new() };
    let mut shifts = Vec::new();
    for (row, position) in law.capacitances.iter().enumerate() {
        let Some(&Capacitance { source, member, state, .. }) =
            electrics.capacitance(&island.two_pins[*position].branch)
        else {
            continue;
        };
        let terms = law.others.iter().enumerate().filter_map(|(k, i)| match island.two_pins[*i].branch {
            Branch::Source(index) if s[(row, k)].abs() > ZERO => Some((index as u32, s[(row, k)])),
            _ => None,
        });
        let by = Form::from_terms(terms);
        if !by.is_empty() {
            shifts.push(Shift { source, member, state, by });
        }
    }
    shifts
}
