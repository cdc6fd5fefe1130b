//! A close look at guards that may have crossed zero within a step and back.
//!
//! The dense output is sampled at 4, 8, ... 64 parts of the step until between any two samples a parabola could not reach
//! zero: the chord lies no nearer to zero than its ends, and a parabola dips below it by an eighth of the second
//! difference. Twice that is asked for, because the guard is no parabola.

use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::events::guards::{Guards, Stride};

/// Halvings of the step, at most.
const DEPTH: usize = 6;
/// Parts of the step at the finest.
const PARTS: usize = 1 << DEPTH;
/// Part of the second difference by which a guard is taken to dip below its samples.
const DIP: f64 = 0.25;
/// Second differences that shrink by less than this from one halving to the next, late, are noise: a parabola's shrink by
/// four, those of a kink by two.
const NOISE: f64 = 0.75;
/// The halving from which noise is believed in; before, the guard may swing faster than it is sampled.
const LATE: usize = 5;

/// Guards at equal parts of a step, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Samples {
    values: Vec<f64>,
    /// Largest second difference of each guard at the last halving.
    roughness: Vec<f64>,
}

impl Samples {
    pub fn new(guards: usize) -> Self {
        Self { values: vec![0.0; (PARTS + 1) * guards], roughness: vec![0.0; guards] }
    }

    /// Whether guard `i` of `n` cannot have reached zero between the samples of this halving, from the first to `limit`; or
    /// whether nothing more can be learnt of it.
    fn is_settled(&mut self, i: usize, n: usize, depth: usize, limit: usize) -> bool {
        let step = PARTS >> depth;
        let value = |k: usize| self.values[k * n + i];
        let second = |k: usize| {
            let k = k.clamp(step, limit - step);
            (value(k - step) - 2.0 * value(k) + value(k + step)).abs()
        };
        let mut clear = true;
        let mut roughness = 0.0_f64;
        for k in (0..limit).step_by(step) {
            let (a, b) = (value(k), value(k + step));
            let dip = DIP * second(k).max(second(k + step));
            roughness = roughness.max(second(k));
            // Where it crosses, once is enough if it goes there straight.
            clear &= if a * b > 0.0 { a.abs().min(b.abs()) > dip } else { (a - b).abs() > dip };
        }
        let before = std::mem::replace(&mut self.roughness[i], roughness);
        clear || depth >= LATE && roughness > NOISE * before
    }
}

impl Guards {
    /// A time at which some guard has another sign than at the start, the first that is found, for the sake of those that are
    /// doubtful.
    pub(crate) fn scan(&mut self, diagram: &mut Diagram, stride: &Stride) -> Result<Option<f64>, Failed> {
        let (n, h) = (self.start.len(), stride.t1 - stride.t0);
        let time = |k: usize| stride.t0 + h * (k as f64 / PARTS as f64);
        self.samples.values[..n].copy_from_slice(&self.start);
        self.samples.values[PARTS * n..].copy_from_slice(&self.end);
        self.samples.roughness.fill(f64::INFINITY);
        let mut limit = PARTS;
        for depth in 1..=DEPTH {
            let step = PARTS >> depth;
            let mut k = step;
            while k < limit {
                self.at(time(k), diagram, stride)?;
                self.samples.values[k * n..][..n].copy_from_slice(&self.trial);
                if self.crossing(&self.trial, true).is_some() {
                    limit = k;
                }
                k += 2 * step;
            }
            let known = limit >= 2 * step;
            let Self { samples, doubtful, .. } = self;
            let settled = |i: usize| !doubtful[i] || samples.is_settled(i, n, depth, limit);
            if depth > 1 && known && (0..n).map(settled).fold(true, |all, one| all & one) {
                break;
            }
        }
        Ok((limit < PARTS).then(|| time(limit)))
    }
}
