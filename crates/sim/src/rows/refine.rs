//! Rows within steps, where a straight line from end to end would be seen to be wrong.
//!
//! Who records every step of a method of high order gets rows that are far apart. Readers go straight from row to row, so a
//! step is divided by its dense output until the line is near enough: for the eye, and for the numbers taken from rows.

use blocksim_block::schedule::{OutputTimes, Recorded, Schedule, Solver};
use blocksim_signal::Kind;

use crate::{Observer, Simulation};

/// How far a straight line may be beside a signal, as a share of the range that the signal has had.
const VISIBLE: f64 = 5e-4;
/// Most parts of a step.
const MOST: f64 = 12.0;
/// Least range, as a share of the size of a signal: what varies by less is constant but for rounding.
const LEAST: f64 = 1e-6;
/// Least range, in the unit of a signal: what has hardly left zero, and grows by powers of ten, is not looked at so closely.
const NOTHING: f64 = 1e-12;

/// What is known of the recorded signals, to divide steps.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refine {
    /// Cells of the recorded signals that go on between rows; empty where rows are on a grid.
    cells: Vec<usize>,
    /// Values of each of them at the beginning of the step, after a third, after two thirds and at its end.
    values: Vec<[f64; 4]>,
    /// Least and largest value of each so far.
    ranges: Vec<(f64, f64)>,
}

impl Refine {
    pub fn new(schedule: &Schedule) -> Self {
        // Who chooses the steps chooses the rows.
        let chosen = matches!(schedule.settings.solver, Solver::Fixed { .. });
        let wanted = schedule.settings.output == OutputTimes::Steps && !chosen;
        let goes_on = |recorded: &&Recorded| wanted && !recorded.held && recorded.kind == Kind::Real;
        let cells: Vec<usize> =
            schedule.recorded.iter().filter(goes_on).map(|recorded| recorded.cell).collect();
        Self {
            values: vec![[0.0; 4]; cells.len()],
            ranges: vec![(f64::INFINITY, f64::NEG_INFINITY); cells.len()],
            cells,
        }
    }

    /// Takes the signals at the beginning of a step.
    pub fn begin(&mut self, signals: &[f64]) {
        self.take(0, signals);
    }

    fn take(&mut self, place: usize, signals: &[f64]) {
        for (values, &cell) in self.values.iter_mut().zip(&self.cells) {
            values[place] = signals[cell];
        }
    }

    /// Into how many parts the step is to be divided.
    fn parts(&mut self) -> usize {
        let mut worst: f64 = 0.0;
        for (&[a, b, c, d], range) in self.values.iter().zip(&mut self.ranges) {
            *range = [a, b, c, d].iter().fold(*range, |(low, high), &y| (low.min(y), high.max(y)));
            let off = (b - a - (d - a) / 3.0).abs().max((c - d - (a - d) / 3.0).abs());
            let size = range.0.abs().max(range.1.abs());
            let scale = (range.1 - range.0).max(LEAST * size).max(NOTHING);
            if off > VISIBLE * scale {
                worst = worst.max(off / scale);
            }
        }
        // A third from the end a parabola is 8/9 as far from the line as in the middle, which falls with the square of the
        // number of parts. A value that is not finite is told elsewhere.
        let parts = (worst * 9.0 / 8.0 / VISIBLE).sqrt().min(MOST);
        if parts <= 1.0 { 1 } else { 3 * (parts / 3.0).ceil() as usize }
    }
}

impl Simulation {
    /// Records rows within the step that began at `start`, as many as it takes. Where the diagram cannot be evaluated there,
    /// or something is not finite, none: that is told at the end of a step.
    pub(crate) fn record_between(&mut self, start: f64, observer: &mut dyn Observer) {
        if self.refine.cells.is_empty() || self.t <= start {
            return;
        }
        self.sharpen_rows();
        for third in 1..=3 {
            if !self.within(start, f64::from(third as u8) / 3.0) {
                return;
            }
            self.refine.take(third, &self.diagram.signals);
        }
        let parts = self.refine.parts();
        for part in 1..parts {
            let evaluated = self.within(start, part as f64 / parts as f64);
            if !evaluated || !self.rows.take(&self.diagram.signals) {
                return;
            }
            observer.row(self.diagram.now.t, &self.rows.values);
        }
    }

    /// Makes rows within the last step about as exact as its end.
    pub(crate) fn sharpen_rows(&mut self) {
        self.stepper.iter_mut().for_each(|stepper| stepper.sharpen_rows(&mut self.diagram));
        // A failure comes again at the row.
        self.diagram.failure = None;
    }

    /// Evaluates the diagram after a share of the step; returns whether that was possible.
    fn within(&mut self, start: f64, share: f64) -> bool {
        let t = if share == 1.0 { self.t } else { start + share * (self.t - start) };
        let plan = &self.diagram.plan;
        let evaluated = match &self.stepper {
            Some(stepper) if t < self.t => {
                stepper.interpolate(t, &mut self.guards.x);
                self.diagram.for_row(t, &self.guards.x)
            }
            // Others will ask for the whole of it.
            _ if plan.every_step || !plan.remembering.is_empty() => self.diagram.continuous(t, &self.x),
            _ => self.diagram.for_row(t, &self.x),
        };
        if evaluated.is_err() {
            self.diagram.failure = None;
        }
        evaluated.is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(values: [f64; 4], range: (f64, f64)) -> usize {
        let mut refine = Refine { cells: vec![0], values: vec![values], ranges: vec![range] };
        refine.parts()
    }

    #[test]
    fn a_step_is_divided_by_how_far_a_line_is_from_the_signal() {
        let parabola = |h: f64| [0.0, 1.0, 2.0, 3.0].map(|third| (h * third / 3.0).powi(2));
        assert_eq!(parts([0.0, 1.0, 2.0, 3.0], (0.0, 3.0)), 1);
        // A line is h^2 / 4 beside h^2 s^2 in the middle, and a quarter of that beside half of it.
        assert_eq!(parts(parabola(1.0), (0.0, 1.0)), 12);
        assert_eq!(parts(parabola(0.1), (0.0, 1.0)), 3);
        assert_eq!(parts(parabola(0.04), (0.0, 1.0)), 1);
    }

    #[test]
    fn rounding_and_what_is_not_finite_divide_nothing() {
        assert_eq!(parts([1.0, 1.0 + 1e-15, 1.0, 1.0], (1.0, 1.0)), 1);
        assert_eq!(parts([f64::NAN, 1.0, 1.0, f64::NAN], (0.0, 1.0)), 1);
        assert_eq!(parts([0.0, 1e-119, 8e-119, 27e-119], (0.0, 0.0)), 1);
    }
}
