//! Rows of recorded values, and who gets them.

use blocksim_block::Resolution;
use blocksim_block::schedule::{OutputTimes, Schedule};

use crate::Counts;
use crate::rows::sides::Sides;
use crate::stepping::clock::{Grid, Hits};

/// Changes of a value at an event that are below this part of it, or of 0.001 SI units, come from rounding.
const ROUNDING: f64 = 1e-9;

/// Who is told what a simulation brings.
pub trait Observer {
    /// A row: time in s and one value, in SI units, for each entry of `Schedule::recorded`. Times do not decrease; two
    /// rows of one time stand around a jump: of a state, or of an output at a time event, a zero crossing or a sample hit.
    /// Of signals that are held (`Recorded::held`) a sample hit has only the row behind the jump.
    fn row(&mut self, t: f64, values: &[f64]);

    /// Something happened to the part at `path`: a guard crossed zero, a mode changed, the block jumped. `what` reads behind
    /// the path and begins with a verb: `switches on`, `touches the upper end (axis 2)`.
    fn event(&mut self, _t: f64, _path: &str, _what: &str) {}

    /// Whether the observer wants the run to stop here, at the end of a step. It is asked at the end of every step.
    fn is_waiting(&self, _t: f64) -> bool {
        false
    }

    /// Asked about every 256 steps whether to go on.
    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        Control::Go
    }
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Go,
    /// Stop here; the simulation may be continued later.
    Stop,
}

/// What is recorded, and when.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    source: Copies,
    /// The present row.
    pub values: Vec<f64>,
    /// The row at the time of an event, with the branches of before it.
    before: Vec<f64>,
    /// Whether `before` belongs to the instant at hand, and whether that is an event rather than a sample hit.
    is_before_known: bool,
    is_event: bool,
    /// Whether a value has jumped at the instant at hand.
    jumped: bool,
    sides: Sides,
    /// The grid, unless all major steps are recorded.
    pub grid: Option<Grid>,
}

impl Rows {
    pub fn new(schedule: &Schedule) -> Self {
        let cells: Vec<usize> = schedule.recorded.iter().map(|recorded| recorded.cell).collect();
        Self {
            values: vec![0.0; cells.len()],
            before: vec![0.0; cells.len()],
            is_before_known: false,
            is_event: false,
            jumped: false,
            sides: Sides::new(schedule),
            source: Copies::new(cells),
            grid: match schedule.settings.output {
                OutputTimes::Steps => None,
                OutputTimes::Every(spacing) => {
                    Some(Grid::new(spacing, Resolution::new(schedule.settings.stop_time)))
                }
            },
        }
    }

    /// Takes the present row from the signals; returns whether all of it is finite.
    pub fn take(&mut self, signals: &[f64]) -> bool {
        self.source.take(&mut self.values, signals)
    }

    /// Whether a sample hit at `t` may need rows on both sides.
    pub fn jump_at(&self, t: f64, hits: &Hits) -> bool {
        self.sides.rates.iter().enumerate().any(|(rate, &jumps)| jumps && hits.is_due(rate, t))
    }

    /// Takes the row just before an event or a sample hit. One that is not finite is none.
    pub fn take_before(&mut self, signals: &[f64], is_event: bool) {
        self.is_before_known = self.source.take(&mut self.before, signals);
        self.is_event = is_event;
    }

    /// Whether the row before the present instant is known.
    pub fn knows_before(&self) -> bool {
        self.is_before_known
    }

    /// Forgets the row before, where it is not to be recorded.
    pub fn forget_before(&mut self) {
        self.is_before_known = false;
    }

    /// The row just before this instant, once, if a value has jumped since; at a sample hit one that is not held, since
    /// of the others one row tells enough. What a kink changes by rounding is no jump.
    pub fn jumped_from(&mut self) -> Option<&[f64]> {
        if !std::mem::take(&mut self.is_before_known) {
            return None;
        }
        let mut told = false;
        for ((&a, &b), &held) in self.before.iter().zip(&self.values).zip(&self.sides.held) {
            let jumped = (a - b).abs() > ROUNDING * (1e-3 + a.abs().max(b.abs()));
            self.jumped |= jumped;
            told |= jumped && (self.is_event || !held);
        }
        told.then_some(&self.before)
    }

    /// Whether a row is due at a major step, for the sake of its time or of a jump.
    pub fn are_due(&mut self, t: f64) -> bool {
        let jumped = std::mem::take(&mut self.jumped);
        self.grid.as_mut().is_none_or(|grid| grid.pass(t)) || jumped
    }

    /// The next point of the grid, if it lies before `end` (or at it).
    pub fn next_before(&self, end: f64) -> Option<f64> {
        self.grid.as_ref().map(Grid::time).filter(|&t| t <= end)
    }
}

/// Where the values of a row come from.
#[derive(Debug, Clone)]
enum Copies {
    /// Cell by cell.
    Cells(Vec<usize>),
    /// Neighbouring cells at once: first cell and number.
    Spans(Vec<(usize, usize)>),
}

impl Copies {
    /// Fewest values of a span that make copying it at once worth its while.
    const LONG: usize = 4;
    /// Most values of a row that is not worth eight sums.
    const SHORT: usize = 8;

    fn new(cells: Vec<usize>) -> Copies {
        let spans: Vec<(usize, usize)> =
            cells.chunk_by(|a, b| a + 1 == *b).map(|span| (span[0], span.len())).collect();
        if spans.len() * Self::LONG <= cells.len() { Copies::Spans(spans) } else { Copies::Cells(cells) }
    }

    /// Copies the values; returns whether all are finite.
    #[inline]
    fn take(&self, row: &mut [f64], signals: &[f64]) -> bool {
        match self {
            // Of a short row each value is looked at while it is at hand.
            Copies::Cells(cells) if cells.len() <= Self::SHORT => {
                let mut sum = 0.0;
                for (value, &cell) in row.iter_mut().zip(cells) {
                    *value = signals[cell];
                    sum += 0.0 * *value;
                }
                return sum == 0.0;
            }
            Copies::Cells(cells) => {
                for (value, &cell) in row.iter_mut().zip(cells) {
                    *value = signals[cell];
                }
            }
            Copies::Spans(spans) => {
                let mut rest = &mut *row;
                for &(first, length) in spans {
                    let (span, behind) = rest.split_at_mut(length);
                    span.copy_from_slice(&signals[first..first + length]);
                    rest = behind;
                }
            }
        }
        are_finite(row)
    }
}

/// Whether all values are finite: zero times any other one is NaN. Eight sums of long rows go abreast, without a branch.
#[inline]
pub(crate) fn are_finite(values: &[f64]) -> bool {
    let (eights, rest) = values.as_chunks::<8>();
    let mut sum = rest.iter().fold(0.0, |sum, value| sum + 0.0 * value);
    if !eights.is_empty() {
        let mut sums = [0.0; 8];
        for eight in eights {
            sums.iter_mut().zip(eight).for_each(|(sum, value)| *sum += 0.0 * value);
        }
        sum = sums.iter().fold(sum, |all, sum| all + sum);
    }
    sum == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_the_same_whether_cells_are_neighbours_or_not() {
        let signals: Vec<f64> = (0..100).map(f64::from).collect();
        let apart: Vec<usize> = (0..50).map(|n| 2 * n % 49).collect();
        let together: Vec<usize> = (20..60).chain(5..30).chain([99]).collect();
        for cells in [apart, together, Vec::new()] {
            let mut row = vec![0.0; cells.len()];
            assert!(Copies::new(cells.clone()).take(&mut row, &signals));
            assert!(row.iter().zip(&cells).all(|(value, &cell)| *value == signals[cell]));
        }
    }

    #[test]
    fn one_value_that_is_not_finite_is_seen_wherever_it_is() {
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in 0..19 {
                let mut values = vec![f64::MAX; 19];
                assert!(are_finite(&values));
                values[at] = odd;
                assert!(!are_finite(&values), "{odd} at {at}");
            }
        }
    }
}
