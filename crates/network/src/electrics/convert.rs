//! Transformers whose ratio changes while a network runs.
//!
//! The solution of a circuit takes the primary voltage `e` and the secondary current `j` of each of them as given, so that
//! it holds for all ratios. Both follow from the rest of the circuit,
//!
//! ```text
//! e = r v2,    j = -r i1
//! ```
//!
//! where `v2` and `i1` are linear forms over all given values, `e` and `j` among them. At each instant that is a small
//! system of linear equations, mostly a trivial one: the voltage of a capacitor depends on no current.

use blocksim_block::Context;

use crate::electrics::currents::Faulty;
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::Convert;

/// Pivots below this, relative to the largest entry, are zero.
const SINGULAR: f64 = 1e-12;

impl Network {
    /// Finds the given values of the variable transformers of an island.
    pub(crate) fn convert(&self, island: usize, c: &Context, w: &mut Work) -> Result<(), Faulty> {
        let circuit = &self.electrics.islands[island];
        if circuit.transformers.is_empty() {
            return Ok(());
        }
        let mut room = std::mem::take(&mut w.convert);
        self.ratios(island, c, &mut room.ratio);
        self.assemble(island, w, &mut room);
        let solved = solve(&mut room.matrix, &mut room.right);
        for (k, (_, number)) in circuit.transformers.iter().enumerate() {
            let transformer = &self.electrics.transformers[*number];
            w.given[transformer.voltage] = room.right[2 * k];
            w.given[transformer.current] = room.right[2 * k + 1];
        }
        w.convert = room;
        if solved {
            return Ok(());
        }
        let members = circuit.transformers.iter().map(|(position, _)| circuit.two_pins[*position].member);
        let mut names: Vec<&str> = members.map(|i| self.seats[i].member.path.as_str()).collect();
        names.dedup();
        c.fail(format!(
            "at {} s the ratios of `{}` leave voltages and currents undetermined: connect a capacitor to its DC side, or \
             a resistance in series",
            c.t,
            names.join("`, `")
        ));
        Err(Faulty)
    }

    /// Ratios of the variable transformers of an island, by the number of a transformer.
    pub(crate) fn ratios(&self, island: usize, c: &Context, ratio: &mut [f64]) {
        for member in &self.electrics.islands[island].members {
            let own = &mut ratio[self.electrics.places[*member].transformers.clone()];
            let seat = &self.seats[*member];
            if let Some(component) = seat.member.block.component().filter(|_| !own.is_empty()) {
                component.ratios(&self.known_law(c, seat), own);
            }
        }
    }

    fn assemble(&self, island: usize, w: &mut Work, room: &mut Convert) {
        let circuit = &self.electrics.islands[island];
        let n = 2 * circuit.transformers.len();
        room.matrix.clear();
        room.matrix.resize(n * n, 0.0);
        room.right.clear();
        for (_, number) in &circuit.transformers {
            let transformer = &self.electrics.transformers[*number];
            w.given[transformer.voltage] = 0.0;
            w.given[transformer.current] = 0.0;
        }
        let solved = w.circuits[island].now();
        for (k, (position, number)) in circuit.transformers.iter().enumerate() {
            let r = room.ratio[*number];
            let rows = [(&solved.voltages[position + 1], r), (&solved.currents[*position], -r)];
            for (row, (form, factor)) in rows.into_iter().enumerate() {
                let row = 2 * k + row;
                room.right.push(factor * form.of(&w.given));
                for (column, (_, other)) in circuit.transformers.iter().enumerate() {
                    let other = &self.electrics.transformers[*other];
                    room.matrix[row * n + 2 * column] = -factor * form.at(other.voltage);
                    room.matrix[row * n + 2 * column + 1] = -factor * form.at(other.current);
                }
                room.matrix[row * n + row] += 1.0;
            }
        }
    }
}

/// Solves `A x = b` for a matrix stored by rows, by elimination with the largest pivot of each column; returns whether there
/// was one. What is not a number stays so.
fn solve(a: &mut [f64], b: &mut [f64]) -> bool {
    let n = b.len();
    let scale = a.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for k in 0..n {
        let size = |i: usize, a: &[f64]| a[i * n + k].abs();
        let best = (k + 1..n).fold(k, |best, i| if size(i, a) > size(best, a) { i } else { best });
        if size(best, a) <= SINGULAR * scale {
            return false;
        }
        if best != k {
            (0..n).for_each(|j| a.swap(k * n + j, best * n + j));
            b.swap(k, best);
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            if factor != 0.0 {
                (k..n).for_each(|j| a[i * n + j] -= factor * a[k * n + j]);
                b[i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - rest) / a[k * n + k];
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_systems_are_solved_in_any_order_of_their_rows() {
        let mut b = vec![3.0, 1.0, 4.0];
        assert!(solve(&mut [0.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, -1.0], &mut b));
        // x = 1, 2 y + z = 3, y - z = 4.
        for (found, expected) in b.iter().zip([1.0, 7.0 / 3.0, -5.0 / 3.0]) {
            assert!((found - expected).abs() < 1e-15, "{b:?}");
        }
        assert!(!solve(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0, 1.0]));
    }
}
