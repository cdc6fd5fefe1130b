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
//! Where only open valves connect a group of such parts to ground, their leakage decides, however small it is: the
//! potential at which the squares of the voltages over these valves have the least sum.

use nalgebra::DMatrix;
use petgraph::unionfind::UnionFind;

use super::conducting::{Conducting, Unsolvable};
use super::{Branch, Electrics, GivenBy, Island, Joined, TwoPin};

/// The windings of a member that cross borders.
#[derive(Debug, Clone)]
pub(crate) struct Crossing {
    pub member: usize,
    /// `W` in the coordinates of [`reluctance`](blocksim_block::physical::Component::reluctance), by rows: one row for
    /// each coordinate, one column for each part.
    pub border: Vec<f64>,
    /// Power over the product of voltage and current, for each coordinate.
    pub weights: Vec<f64>,
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
    /// The parts of each group that windings do not connect to the rest.
    pub groups: Vec<Vec<usize>>,
    /// Open valves between groups or to the rest: position of the two-pin, and its sign for each group.
    pub leaks: Vec<(usize, Vec<f64>)>,
    /// Inverse of `Z'Z` of the leaks, by rows.
    pub leak_inverse: Vec<f64>,
}

impl Floating {
    /// Finds the floating parts; `part` tells the part of each node, 0 being the one with ground.
    pub(super) fn find(
        electrics: &Electrics,
        island: &Island,
        conducting: Conducting,
        part: &[usize],
    ) -> Result<Option<Self>, Unsolvable> {
        let parts = part.iter().max().copied().unwrap_or(0);
        if parts == 0 {
            return Ok(None);
        }
        let of = |node: Option<usize>| node.map_or(0, |node| part[node]);
        // The change of the voltage of a two-pin with the potential of each part.
        let signs = |pin: &TwoPin| -> Vec<f64> {
            let mut signs = vec![0.0; parts + 1];
            signs[of(pin.p)] += 1.0;
            signs[of(pin.n)] -= 1.0;
            signs.split_off(1)
        };
        let mut leaving = vec![Vec::new(); parts];
        let mut joined = UnionFind::new(parts + 1);
        let mut cut = Vec::new();
        for (position, pin) in island.two_pins.iter().enumerate() {
            let Branch::Given(index) = pin.branch else { continue };
            if of(pin.p) == of(pin.n) {
                continue;
            }
            if electrics.windings[index - electrics.sources] == GivenBy::State {
                joined.union(of(pin.p), of(pin.n));
            } else {
                cut.push(position);
            }
            for (i, sign) in signs(pin).into_iter().enumerate().filter(|(_, sign)| *sign != 0.0) {
                leaving[i].push((index, sign));
            }
        }
        if !cut.is_empty() {
            return Err(Unsolvable::Cut(cut));
        }
        let rest = joined.find(0);
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for i in 1..=parts {
            if joined.find(i) == rest {
                continue;
            }
            match groups.iter_mut().find(|group| joined.find(group[0] + 1) == joined.find(i)) {
                Some(group) => group.push(i - 1),
                None => groups.push(vec![i - 1]),
            }
        }

        let is_open =
            |branch: &Branch| matches!(branch, Branch::Valve { index, .. } if conducting >> index & 1 == 0);
        let mut leaks: Vec<(usize, Vec<f64>)> = Vec::new();
        for (position, pin) in island.two_pins.iter().enumerate().filter(|(_, pin)| is_open(&pin.branch)) {
            let signs = signs(pin);
            let of_groups: Vec<f64> =
                groups.iter().map(|group| group.iter().map(|i| signs[*i]).sum()).collect();
            if of_groups.iter().any(|sign| *sign != 0.0) {
                leaks.push((position, of_groups));
            }
        }
        let g = groups.len();
        let square = DMatrix::from_fn(g, g, |i, j| leaks.iter().map(|(_, z)| z[i] * z[j]).sum::<f64>());
        let leak_inverse = match square.clone().cholesky() {
            Some(factor) => factor.inverse().transpose().iter().copied().collect(),
            None => {
                let lost = (0..g).find(|i| square[(*i, *i)] == 0.0).unwrap_or(0);
                let in_group = |node: &usize| {
                    part[*node].checked_sub(1).is_some_and(|part| groups[lost].contains(&part))
                };
                return Err(Unsolvable::Floating((0..part.len()).filter(in_group).collect()));
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
            Some(Crossing { member: *member, border: border.0, weights: border.1 })
        });
        let crossing = crossing.collect();
        Ok(Some(Self { parts, crossing, leaving, shifts, groups, leaks, leak_inverse }))
    }
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
        .filter(|pin| pin.member == member)
        .filter(|pin| match pin.branch {
            Branch::Given(index) => electrics.windings[index - electrics.sources] == GivenBy::State,
            _ => false,
        })
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
        (Joined::Inside, [a, b]) => {
            // Against their mean: v_a - v_c and v_b - v_c less a third of their sum.
            let mean = (a + b) / 3.0;
            blocksim_block::physical::space_vector([a - mean, b - mean, -mean])
        }
        (Joined::Outside, [a, b, c]) => blocksim_block::physical::space_vector([*a, *b, *c]),
        _ => [0.0; 3],
    }
}
