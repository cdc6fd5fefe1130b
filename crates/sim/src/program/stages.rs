//! What an explicit method of Runge and Kutta adds up over derivatives that lie among the signals, see [`Weights`].
//!
//! Four states go abreast: most systems have few, and a loop over them for each stage would cost more than its sums. Behind the last
//! state others are made up, so that there is no rest.

use blocksim_solve::Weights;

use crate::rows::record::are_finite;

/// Most stages of a method.
pub(crate) const MOST: usize = 6;

/// States and derivatives of a step on its way.
#[derive(Debug)]
pub(crate) struct Stages {
    /// The weights behind each stage.
    rows: Vec<Row>,
    fours: Vec<Four>,
}

/// Weights of the stages up to one.
#[derive(Debug)]
struct Row {
    /// The first stage whose weight is not 0.
    first: usize,
    /// From there to the last but one.
    before: &'static [f64],
    last: f64,
}

/// Four states.
#[derive(Debug, Clone, Default)]
struct Four {
    /// Where their derivatives are.
    cells: [u32; 4],
    /// What they are at the beginning of the step.
    from: [f64; 4],
    /// What they are at the next stage, or at the end.
    to: [f64; 4],
    /// The derivatives at all stages.
    k: [[f64; 4]; MOST],
}

impl Row {
    fn new(weights: &'static [f64]) -> Self {
        let first = weights.iter().take_while(|weight| **weight == 0.0).count();
        match weights[first..].split_last() {
            Some((last, before)) => Self { first, before, last: *last },
            // The sum of nothing, which no method has behind a stage.
            None => Self { first: 0, before: &[], last: 0.0 },
        }
    }
}

impl Stages {
    /// Steps of the states whose derivatives are in these cells; what stands in cell `finite` is always finite.
    ///
    /// # Panics
    /// Panics if the method has more than [`MOST`] stages.
    pub fn new(Weights { stages, result, .. }: Weights, derivatives: &[u32], finite: u32) -> Self {
        assert!(result.len() <= MOST, "a method of {} stages", result.len());
        let four = |cells: &[u32]| {
            let mut four = Four { cells: [finite; 4], ..Four::default() };
            four.cells[..cells.len()].copy_from_slice(cells);
            four
        };
        let rows = stages.iter().skip(1).copied().chain([result]).map(Row::new);
        Self { rows: rows.collect(), fours: derivatives.chunks(4).map(four).collect() }
    }

    /// Begins a step at `x`.
    #[inline]
    pub fn begin(&mut self, x: &[f64]) {
        let (fours, rest) = x.as_chunks::<4>();
        self.fours.iter_mut().zip(fours).for_each(|(four, x)| four.from = *x);
        for four in self.fours.get_mut(fours.len()..).into_iter().flatten() {
            four.from.iter_mut().zip(rest).for_each(|(from, x)| *from = *x);
        }
    }

    /// Takes the derivatives of a stage and adds up what follows it.
    #[inline]
    pub fn add(&mut self, stage: usize, h: f64, signals: &[f64]) {
        let Row { first, before, last } = self.rows[stage];
        // Of known length the sum is a line of code, and most rows are short.
        match *before {
            [] => self.sum(stage, first, [], h * last, signals),
            [a] => self.sum(stage, first, [h * a], h * last, signals),
            [a, b] => self.sum(stage, first, [h * a, h * b], h * last, signals),
            [a, b, c] => self.sum(stage, first, [h * a, h * b, h * c], h * last, signals),
            [a, b, c, d] => self.sum(stage, first, [h * a, h * b, h * c, h * d], h * last, signals),
            [a, b, c, d, e] => {
                self.sum(stage, first, [h * a, h * b, h * c, h * d, h * e], h * last, signals);
            }
            _ => unreachable!("a method has no more than {MOST} stages"),
        }
    }

    /// The same with the weights of the stages from `first` on.
    #[inline]
    fn sum<const N: usize>(
        &mut self,
        stage: usize,
        first: usize,
        weights: [f64; N],
        last: f64,
        signals: &[f64],
    ) {
        for Four { cells, from, to, k } in &mut self.fours {
            let new = cells.map(|cell| signals[cell as usize]);
            let mut sums = *from;
            let Some(known) = k[first..].first_chunk::<N>() else { return };
            for (weight, k) in weights.iter().zip(known) {
                sums.iter_mut().zip(k).for_each(|(sum, k)| *sum += weight * k);
            }
            sums.iter_mut().zip(&new).for_each(|(sum, k)| *sum += last * k);
            (k[stage], *to) = (new, sums);
        }
    }

    /// The states at the next stage, or at the end; behind the last one are some that were made up.
    #[inline]
    pub fn states(&self) -> impl Iterator<Item = &[f64; 4]> {
        self.fours.iter().map(|four| &four.to)
    }

    /// Writes the states at the end to `x`, if all are finite; returns whether they are.
    #[inline]
    pub fn end(&self, x: &mut [f64]) -> bool {
        let are_finite = self.states().all(|to| are_finite(to));
        if are_finite {
            let (fours, rest) = x.as_chunks_mut::<4>();
            let count = fours.len();
            fours.iter_mut().zip(self.states()).for_each(|(x, to)| *x = *to);
            for to in self.states().skip(count) {
                rest.iter_mut().zip(to).for_each(|(x, to)| *x = *to);
            }
        }
        are_finite
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_solve::{FixedStep, add_stages};

    #[test]
    fn sums_are_those_of_the_method_for_any_number_of_states() {
        let methods = [FixedStep::ode1, FixedStep::ode2, FixedStep::ode3, FixedStep::ode4, FixedStep::ode5];
        for (weights, n) in
            methods.map(|method| method(1, 1.0).weights()).into_iter().zip(1..20).cycle().take(95)
        {
            let cells: Vec<u32> = (0..n as u32).rev().collect();
            let mut stages = Stages::new(weights, &cells, 0);
            let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let (mut k, mut next, mut wanted) = (Vec::new(), vec![0.0; n], vec![0.0; n]);
            stages.begin(&x);
            let rows = weights.stages.iter().skip(1).chain([&weights.result]);
            for (stage, row) in rows.enumerate() {
                let signals: Vec<f64> = (0..n).map(|i| ((i + 7 * stage) as f64).cos()).collect();
                k.push(cells.iter().map(|cell| signals[*cell as usize]).collect::<Vec<_>>());
                stages.add(stage, 0.1, &signals);
                assert!(stages.end(&mut next));
                add_stages(&mut wanted, &x, 0.1, row, &k);
                assert_eq!(next, wanted, "{n} states, stage {stage}");
            }
        }
    }

    #[test]
    fn a_state_that_is_not_finite_is_seen_wherever_it_is() {
        let weights = FixedStep::ode1(1, 1.0).weights();
        for at in 0..6 {
            let mut signals = [1.0; 6];
            signals[at] = f64::INFINITY;
            let mut stages = Stages::new(weights, &[0, 1, 2, 3, 4, 5], 0);
            stages.begin(&[0.0; 6]);
            stages.add(0, 1.0, &signals);
            let mut x = [0.0; 6];
            assert!(!stages.end(&mut x), "state {at}");
            assert_eq!(x, [0.0; 6]);
        }
    }
}
