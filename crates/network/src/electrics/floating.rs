//! Parts of a circuit that nothing but currents of inductances connects to the rest.
//!
//! Their potentials `phi` follow from the derivative of Kirchhoff's law: with the incidence `W` of the windings that
//! cross the border of each part, `W' i = 0` must stay, and `di/dt = Gamma (v - u)` with the voltages
//! `v = v_0 + W phi`, so
//!
//! ```text
//! (W' Gamma W) phi = W' Gamma (u - v_0)
//! ```
//!
//! An ideal transformer ties potentials of such parts to each other: what remains free are coordinates over which the
//! potential of each part is a linear form, mostly the potential of one part each; below a part means such a coordinate.
//!
//! Where a current source `j` leads into such parts, the law is `W' i + Q' j = 0`, and `- Q' j'` is added on the right; the
//! currents then depend on that of the source (`cuts.rs`).
//!
//! Where only open valves connect a group of such parts to ground, their leakage decides, however small it is: the
//! potential at which the squares of the voltages over these valves have the least sum.

use nalgebra::DMatrix;
use petgraph::unionfind::UnionFind;

use super::conducting::{Conducting, Unsolvable};
use super::{Branch, Electrics, GivenBy, Island, Joined, TwoPin};
use crate::assembly::eliminate::{Eliminated, Relations};

/// Sums of whole numbers, or of ratios of transformers, that are zero but for rounding.
const ROUNDING: f64 = 1e-9;

/// The windings of a member that cross borders.
#[derive(Debug, Clone)]
pub(crate) struct Crossing {
    pub member: usize,
    /// `W` in the coordinates of [`reluctance`](blocksim_block::physical::Component::reluctance), by rows: one row for
    /// each coordinate, one column for each part.
    pub border: Vec<f64>,
    /// Power over the product of voltage and current, for each coordinate.
    pub weights: Vec<f64>,
    /// Whether the law leaves its currents no other value than the one that they have: nothing but open valves leads on.
    pub is_still: bool,
}

/// Parts that float while certain valves conduct.
#[derive(Debug, Clone)]
pub(crate) struct Floating {
    /// Number of parts.
    pub parts: usize,
    pub crossing: Vec<Crossing>,
    /// Given currents that leave each part: indices of given values with signs.
    pub leaving: Vec<Vec<(usize, f64)>>,
    /// Two-pins of the island (their position) whose voltage changes with the potential of a part: part and sign.
    pub shifts: Vec<(usize, Vec<(usize, f64)>)>,
    /// Nodes whose potentials are these coordinates.
    pub nodes: Vec<usize>,
    /// The parts of each group that windings do not connect to the rest, and how far each moves with its potential.
    pub groups: Vec<Vec<(usize, f64)>>,
    /// Open valves between groups or to the rest: position of the two-pin, and its sign for each group.
    pub leaks: Vec<(usize, Vec<f64>)>,
    /// Inverse of `Z'Z` of the leaks, by rows.
    pub leak_inverse: Vec<f64>,
    /// `Q`: currents of sources that leave each part, indices of given values with signs.
    pub driven: Vec<Vec<(usize, f64)>>,
    /// The parts that sources lead into, directly or through windings.
    pub cut: Vec<bool>,
}

impl Floating {
    /// Finds the floating parts; `part` tells the part of each node, 0 being the one with ground, and `always` that while all valves
    /// conduct.
    pub(super) fn find(
        electrics: &Electrics,
        island: &Island,
        conducting: Conducting,
        part: &[usize],
        always: &[usize],
    ) -> Result<Option<Self>, Unsolvable> {
        let all = part.iter().max().copied().unwrap_or(0);
        if all == 0 {
            return Ok(None);
        }
        let Eliminated { free, over_free, .. } = tied(island, part, all);
        let parts = free.len();
        if parts == 0 {
            return Ok(None);
        }
        let nodes = free.iter().map(|i| part.iter().position(|p| *p == i + 1).unwrap_or(0)).collect();
        // The change of the voltage of a two-pin with the potential of each part.
        let signs = |pin: &TwoPin| -> Vec<f64> {
            let mut signs = vec![0.0; parts];
            for (node, sign) in [(pin.p, 1.0), (pin.n, -1.0)] {
                if let Some(at) = node.and_then(|node| part[node].checked_sub(1)) {
                    signs.iter_mut().zip(&over_free[at]).for_each(|(to, by)| *to += sign * by);
                }
            }
            signs
        };
        let mut leaving = vec![Vec::new(); parts];
        let mut driven = vec![Vec::new(); parts];
        let mut joined = Relations::new(parts, 0);
        // Parts that belong together by windings.
        let mut together = UnionFind::new(parts);
        let mut sources = Vec::new();
        for (position, pin) in island.two_pins.iter().enumerate() {
            if matches!(pin.branch, Branch::Characteristic(..)) && signs(pin).iter().any(|sign| *sign != 0.0)
            {
                return Err(Unsolvable::Cut(vec![position]));
            }
            let Branch::Given(index) = pin.branch else { continue };
            let signs: Vec<(usize, f64)> =
                signs(pin).into_iter().enumerate().filter(|(_, sign)| *sign != 0.0).collect();
            if signs.is_empty() {
                continue;
            }
            match electrics.windings[index - electrics.sources] {
                GivenBy::State => {
                    joined.add(&signs, &[]);
                    signs.windows(2).for_each(|pair| _ = together.union(pair[0].0, pair[1].0));
                }
                GivenBy::Input => {
                    sources.push(position);
                    signs.iter().for_each(|(i, sign)| driven[*i].push((index, *sign)));
                }
                // It follows from the potential that is looked for.
                GivenBy::Voltage | GivenBy::Ratio | GivenBy::Characteristic | GivenBy::Heat => {
                    return Err(Unsolvable::Cut(vec![position]));
                }
            }
            signs.into_iter().for_each(|(i, sign)| leaving[i].push((index, sign)));
        }
        // A machine has its windings on both axes at once, and a member its coils coupled.
        for member in &island.members {
            let windings =
                island.two_pins.iter().filter(|pin| pin.member == *member && is_state(electrics, pin));
            let of_member: Vec<usize> = windings
                .flat_map(|pin| signs(pin).into_iter().enumerate().filter(|(_, sign)| *sign != 0.0))
                .map(|(i, _)| i)
                .collect();
            of_member.windows(2).for_each(|pair| _ = together.union(pair[0], pair[1]));
        }
        let cut: Vec<bool> =
            (0..parts).map(|i| (0..parts).any(|k| !driven[k].is_empty() && together.equiv(i, k))).collect();
        // What no winding sees.
        let loose = joined.eliminate(|_| 0);
        let group = |g: usize| -> Vec<(usize, f64)> {
            let moved = loose.over_free.iter().enumerate().map(|(i, by)| (i, by[g]));
            moved.filter(|(_, by)| *by != 0.0).collect()
        };
        let groups: Vec<Vec<(usize, f64)>> = (0..loose.free.len()).map(group).collect();
        // A source that no winding answers has no path, nor has one that valves have cut off from what it had.
        let through = |group: &[(usize, f64)], source: usize| -> f64 {
            let of = |(i, by): &(usize, f64)| {
                let own = driven[*i].iter().filter(|(index, _)| *index == source);
                by * own.map(|(_, sign)| sign).sum::<f64>()
            };
            group.iter().map(of).sum()
        };
        let given = |position: &usize| match island.two_pins[*position].branch {
            Branch::Given(index) => index,
            _ => 0,
        };
        let unanswered = groups.iter().any(|g| sources.iter().any(|j| through(g, given(j)).abs() > ROUNDING));
        let cut_off = || {
            let new = part.iter().max() != always.iter().max();
            let of_valves = |i: usize| {
                let own = |node: &usize| part[*node] == free[i] + 1;
                let before = (0..part.len()).find(own).map_or(0, |node| always[node]);
                before == 0 || (0..part.len()).any(|node| always[node] == before && !own(&node))
            };
            new && (parts < all || (0..parts).any(|i| cut[i] && of_valves(i)))
        };
        let machine = |pin: &&TwoPin| {
            electrics.places[pin.member].machine.is_some()
                && signs(pin).iter().zip(&cut).any(|(sign, cut)| *sign != 0.0 && *cut)
        };
        if !sources.is_empty() && (unanswered || cut_off() || island.two_pins.iter().any(|pin| machine(&pin)))
        {
            return Err(Unsolvable::Cut(sources));
        }

        let is_open =
            |branch: &Branch| matches!(branch, Branch::Valve { index, .. } if conducting >> index & 1 == 0);
        let mut leaks: Vec<(usize, Vec<f64>)> = Vec::new();
        for (position, pin) in island.two_pins.iter().enumerate().filter(|(_, pin)| is_open(&pin.branch)) {
            let signs = signs(pin);
            let of_groups: Vec<f64> =
                groups.iter().map(|group| group.iter().map(|(i, by)| signs[*i] * by).sum()).collect();
            if of_groups.iter().any(|sign: &f64| *sign != 0.0) {
                leaks.push((position, of_groups));
            }
        }
        let g = groups.len();
        let square = DMatrix::from_fn(g, g, |i, j| leaks.iter().map(|(_, z)| z[i] * z[j]).sum::<f64>());
        let leak_inverse = match square.clone().cholesky() {
            Some(factor) => factor.inverse().transpose().iter().copied().collect(),
            None => {
                let lost = (0..g).find(|i| square[(*i, *i)] == 0.0).unwrap_or(0);
                let moves = |node: &usize| {
                    let at = part[*node].checked_sub(1);
                    at.is_some_and(|at| groups[lost].iter().any(|(i, by)| over_free[at][*i] * by != 0.0))
                };
                return Err(Unsolvable::Floating((0..part.len()).filter(moves).collect()));
            }
        };
        let shifts = island.two_pins.iter().enumerate().filter_map(|(position, pin)| {
            let signs: Vec<(usize, f64)> =
                signs(pin).into_iter().enumerate().filter(|(_, sign)| *sign != 0.0).collect();
            (!signs.is_empty()).then_some((position, signs))
        });
        let shifts = shifts.collect();
        let crossing = island.members.iter().filter_map(|member| {
            let border = border(electrics, island, *member, &signs, parts)?;
            Some(Crossing { member: *member, border: border.0, weights: border.1, is_still: false })
        });
        let mut crossing: Vec<Crossing> = crossing.collect();
        if sources.is_empty() {
            find_still(electrics, &mut crossing, parts);
        }
        Ok(Some(Self { parts, nodes, crossing, leaving, shifts, groups, leaks, leak_inverse, driven, cut }))
    }

    /// Members whose windings lead to parts that sources lead into.
    pub(super) fn in_cuts(&self) -> impl Iterator<Item = usize> + '_ {
        let crosses = |crossing: &&Crossing| {
            let k = self.parts;
            crossing.border.iter().enumerate().any(|(i, w)| *w != 0.0 && self.cut[i % k])
        };
        self.crossing.iter().filter(crosses).map(|crossing| crossing.member)
    }
}

/// Finds the members whose currents `W' i = 0` leaves no freedom: those of which each unit vector is a combination of columns of `W`.
fn find_still(electrics: &Electrics, crossing: &mut [Crossing], parts: usize) {
    let rows: Vec<&[f64]> = crossing.iter().flat_map(|own| own.border.chunks(parts)).collect();
    if rows.is_empty() {
        return;
    }
    let w = DMatrix::from_fn(rows.len(), parts, |i, k| rows[i][k]);
    let Ok(inverse) = w.clone().pseudo_inverse(ROUNDING) else { return };
    let onto = &w * inverse;
    let mut row = 0;
    for own in crossing {
        let count = own.weights.len();
        let is_held = |i: usize| (onto[(i, i)] - 1.0).abs() < ROUNDING;
        own.is_still = electrics.places[own.member].machine.is_none() && (row..row + count).all(is_held);
        row += count;
    }
}

fn is_state(electrics: &Electrics, pin: &TwoPin) -> bool {
    match pin.branch {
        Branch::Given(index) => electrics.windings[index - electrics.sources] == GivenBy::State,
        _ => false,
    }
}

/// Potentials of the parts over those that ideal transformers leave free.
fn tied(island: &Island, part: &[usize], parts: usize) -> Eliminated {
    let mut relations = Relations::new(parts, 0);
    let place = |node: Option<usize>, factor: f64| {
        node.and_then(|node| part[node].checked_sub(1)).map(|at| (at, factor))
    };
    for (position, pin) in island.two_pins.iter().enumerate() {
        let Branch::Primary(ratio) = pin.branch else { continue };
        let other = &island.two_pins[position + 1];
        let ends = [(pin.p, 1.0), (pin.n, -1.0), (other.p, -ratio), (other.n, ratio)];
        let terms: Vec<(usize, f64)> =
            ends.into_iter().filter_map(|(node, factor)| place(node, factor)).collect();
        relations.add(&terms, &[]);
    }
    relations.eliminate(|_| 0)
}

/// `W` of a member in the coordinates of its reluctance, with the weights of the coordinates; `None` if none of its
/// windings crosses a border.
fn border(
    electrics: &Electrics,
    island: &Island,
    member: usize,
    signs: &impl Fn(&TwoPin) -> Vec<f64>,
    parts: usize,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let windings: Vec<Vec<f64>> = island
        .two_pins
        .iter()
        .filter(|pin| pin.member == member && is_state(electrics, pin))
        .map(signs)
        .collect();
    if windings.iter().flatten().all(|sign| *sign == 0.0) {
        return None;
    }
    let column = |k: usize| -> Vec<f64> { windings.iter().map(|row| row[k]).collect() };
    let Some(joined) = electrics.places[member].machine else {
        let weights = vec![1.0; windings.len()];
        return Some((windings.concat(), weights));
    };
    let mut border = vec![0.0; 3 * parts];
    for k in 0..parts {
        for (row, value) in coordinates(joined, &column(k)).into_iter().enumerate() {
            border[row * parts + k] = value;
        }
    }
    Some((border, MACHINE_WEIGHTS.to_vec()))
}

/// Power over the product of amplitude invariant space vectors: 3/2, and 3 for the zero sequence.
pub(crate) const MACHINE_WEIGHTS: [f64; 3] = [1.5, 1.5, 3.0];

/// Space vector and zero sequence of the winding voltages of a machine.
#[inline]
pub(crate) fn coordinates(joined: Joined, v: &[f64]) -> [f64; 3] {
    match (joined, v) {
        (Joined::Inside, [a, b, ..]) => {
            // Against their mean: v_a - v_c and v_b - v_c less a third of their sum.
            let mean = (a + b) / 3.0;
            blocksim_block::physical::space_vector([a - mean, b - mean, -mean])
        }
        (Joined::Outside, [a, b, c, ..]) => blocksim_block::physical::space_vector([*a, *b, *c]),
        _ => [0.0; 3],
    }
}
