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

    /// Makes a step from `x`, of size `h`: `derive` takes the number of a stage and the states at it (none at the first, at which they are
    /// in their places), and gives the signals with the derivatives, or nothing where there are none. Writes the states at the end to
    /// `x`, if all are finite; returns whether there are such.
    #[inline]
    pub fn step(&mut self, h: f64, x: &mut [f64], derive: impl Derive) -> bool {
        let Self { rows, fours } = self;
        match &mut fours[..] {
            // Of a known number all loops over them are gone, and most systems are as small.
            [four] => step(std::array::from_mut(four), rows, h, x, derive),
            fours => step(fours, rows, h, x, derive),
        }
    }
}

/// Finds derivatives.
pub(crate) trait Derive {
    /// Puts states where derivatives are found from them.
    fn place<'f>(&mut self, stage: usize, states: impl Iterator<Item = &'f [f64; 4]>);

    /// The signals with the derivatives at a stage whose states are in their places.
    fn signals(&mut self) -> Option<&[f64]>;
}

#[inline(always)]
fn step(fours: &mut [Four], rows: &[Row], h: f64, x: &mut [f64], mut derive: impl Derive) -> bool {
    begin(fours, x);
    for (stage, row) in rows.iter().enumerate() {
        if stage > 0 {
            derive.place(stage, fours.iter().map(|four| &four.to));
        }
        let Some(signals) = derive.signals() else { return false };
        add(fours, row, stage, h, signals);
    }
    end(fours, x)
}

/// Begins a step at `x`.
#[inline(always)]
fn begin(fours: &mut [Four], x: &[f64]) {
    let (whole, rest) = x.as_chunks::<4>();
    fours.iter_mut().zip(whole).for_each(|(four, x)| four.from = *x);
    for four in fours.get_mut(whole.len()..).into_iter().flatten() {
        four.from.iter_mut().zip(rest).for_each(|(from, x)| *from = *x);
    }
}

/// Takes the derivatives of a stage and adds up what follows it.
#[inline(always)]
fn add(fours: &mut [Four], row: &Row, stage: usize, h: f64, signals: &[f64]) {
    let Row { first, before, last } = *row;
    let last = h * last;
    // Of known length the sum is a line of code, and most rows are short.
    match *before {
        [] => sum(fours, stage, first, [], last, signals),
        [a] => sum(fours, stage, first, [h * a], last, signals),
        [a, b] => sum(fours, stage, first, [h * a, h * b], last, signals),
        [a, b, c] => sum(fours, stage, first, [h * a, h * b, h * c], last, signals),
        [a, b, c, d] => sum(fours, stage, first, [h * a, h * b, h * c, h * d], last, signals),
        [a, b, c, d, e] => sum(fours, stage, first, [h * a, h * b, h * c, h * d, h * e], last, signals),
        _ => unreachable!("a method has no more than {MOST} stages"),
    }
}

/// The same with the weights of the stages from `first` on.
#[inline(always)]
fn sum<const N: usize>(
    fours: &mut [Four],
    stage: usize,
    first: usize,
    weights: [f64; N],
    last: f64,
    signals: &[f64],
) {
    for Four { cells, from, to, k } in fours {
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

/// Writes the states at the end to `x`, if all are finite; returns whether they are.
#[inline(always)]
fn end(fours: &[Four], x: &mut [f64]) -> bool {
    let finite = fours.iter().all(|four| are_finite(&four.to));
    if finite {
        let (whole, rest) = x.as_chunks_mut::<4>();
        let count = whole.len();
        whole.iter_mut().zip(fours).for_each(|(x, four)| *x = four.to);
        for four in fours.iter().skip(count) {
            rest.iter_mut().zip(&four.to).for_each(|(x, to)| *x = *to);
        }
    }
    finite
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
            let Stages { mut fours, rows: own } = Stages::new(weights, &cells, 0);
            let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let (mut k, mut next, mut wanted) = (Vec::new(), vec![0.0; n], vec![0.0; n]);
            begin(&mut fours, &x);
            let rows = weights.stages.iter().skip(1).chain([&weights.result]);
            for (stage, row) in rows.enumerate() {
                let signals: Vec<f64> = (0..n).map(|i| ((i + 7 * stage) as f64).cos()).collect();
                k.push(cells.iter().map(|cell| signals[*cell as usize]).collect::<Vec<_>>());
                add(&mut fours, &own[stage], stage, 0.1, &signals);
                assert!(end(&fours, &mut next));
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
            let Stages { mut fours, rows } = Stages::new(weights, &[0, 1, 2, 3, 4, 5], 0);
            begin(&mut fours, &[0.0; 6]);
            add(&mut fours, &rows[0], 0, 1.0, &signals);
            let mut x = [0.0; 6];
            assert!(!end(&fours, &mut x), "state {at}");
            assert_eq!(x, [0.0; 6]);
        }
    }
}
