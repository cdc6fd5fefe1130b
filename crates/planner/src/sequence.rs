//! Moves behind each other, with rounded corners.

use std::fmt;

use blocksim_robot::Robot;
use nalgebra::Vector3;

use crate::arm::Arm;
use crate::course::{Course, Narrow, State};

/// Positions that differ by less are the same, rad.
const SAME: f64 = 1e-6;

/// A move of a sequence.
#[derive(Debug)]
pub struct Step {
    /// The move.
    pub course: Box<dyn Course>,
    /// Radius of the zone around its end in which the next move begins, m; 0 for a stop.
    pub zone: f64,
}

/// Moves behind each other. Where the tool comes into the zone of a corner, the next move begins while the present one
/// ends, and their motions add up: position, speed and acceleration are as continuous as those of the moves. Outside
/// of the zones the tool is on its paths.
#[derive(Debug)]
pub struct Sequence {
    steps: Vec<Step>,
    /// When each begins, s.
    begins: Vec<f64>,
    /// Positions at the start of each.
    starts: Vec<Vec<f64>>,
    duration: f64,
}

/// Why moves make no sequence.
#[derive(Debug, Clone, PartialEq)]
pub enum SequenceError {
    /// There is no move.
    Empty,
    /// A zone is negative or no number.
    Zone {
        /// Index of the move.
        step: usize,
    },
    /// A move does not begin where the one before ends.
    Gap {
        /// Index of the move.
        step: usize,
        /// Index of the axis.
        axis: usize,
        /// By how much, rad.
        gap: f64,
    },
}

impl std::error::Error for SequenceError {}

impl fmt::Display for SequenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SequenceError::Empty => write!(f, "the sequence has no moves; give at least one"),
            SequenceError::Zone { step } => {
                write!(
                    f,
                    "move {}: the zone is negative or no number; give a radius, or 0 mm for a stop",
                    step + 1
                )
            }
            SequenceError::Gap { step, axis, gap } => write!(
                f,
                "move {}: axis {} starts {:.4} deg away from where the move before ends; leave out its start",
                step + 1,
                axis + 1,
                gap.to_degrees()
            ),
        }
    }
}

impl Sequence {
    /// Joins moves.
    ///
    /// # Errors
    /// [`SequenceError`] names the move.
    pub fn join(robot: &Robot, steps: Vec<Step>) -> Result<Sequence, SequenceError> {
        if steps.is_empty() {
            return Err(SequenceError::Empty);
        }
        if let Some(step) = steps.iter().position(|step| !(step.zone >= 0.0 && step.zone.is_finite())) {
            return Err(SequenceError::Zone { step });
        }
        let starts: Vec<Vec<f64>> = steps.iter().map(|step| step.course.positions(0.0)).collect();
        for (i, pair) in steps.windows(2).enumerate() {
            let end = pair[0].course.positions(pair[0].course.duration());
            for (axis, (a, b)) in end.iter().zip(&starts[i + 1]).enumerate() {
                let gap = b - a;
                let same = gap.abs() < SAME;
                if !same {
                    return Err(SequenceError::Gap { step: i + 1, axis, gap });
                }
            }
        }
        let mut arm = Arm::new(robot);
        let (mut begins, mut t) = (vec![0.0], 0.0);
        for pair in steps.windows(2) {
            t += pair[0].course.duration() - overlap(&mut arm, &pair[0], &*pair[1].course);
            begins.push(t);
        }
        let duration = t + steps.last().map_or(0.0, |step| step.course.duration());
        Ok(Sequence { steps, begins, starts, duration })
    }

    /// When each move begins, s.
    pub fn begins(&self) -> &[f64] {
        &self.begins
    }
}

/// For how long the next move may run along with the end of this one: while the tool is in the zone on both paths.
fn overlap(arm: &mut Arm, step: &Step, next: &dyn Course) -> f64 {
    if step.zone == 0.0 {
        return 0.0;
    }
    let mut tip = |course: &dyn Course, t: f64| -> Vector3<f64> {
        arm.look(&course.positions(t));
        arm.tool.translation
    };
    let corner = tip(next, 0.0);
    let mut inside = |course: &dyn Course, t: f64| (tip(course, t) - corner).norm() <= step.zone;
    // at most half of each move, so that no three overlap
    let (first, second) = (step.course.duration(), next.duration());
    let most = 0.5 * first.min(second);
    let fits = &mut |by: f64| inside(&*step.course, first - by) && inside(next, by);
    const PARTS: usize = 200;
    let grid = |k: usize| most * k as f64 / PARTS as f64;
    let Some(outside) = (1..=PARTS).find(|k| !fits(grid(*k))) else {
        return most;
    };
    let (mut low, mut high) = (grid(outside - 1), grid(outside));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    low
}

impl Course for Sequence {
    fn axes(&self) -> usize {
        self.starts[0].len()
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, axis: usize, t: f64) -> State {
        let mut sum = [self.starts[0][axis], 0.0, 0.0];
        for ((step, begin), start) in self.steps.iter().zip(&self.begins).zip(&self.starts) {
            if t <= *begin {
                break;
            }
            let [q, v, a] = step.course.at(axis, t - begin);
            sum = [sum[0] + q - start[axis], sum[1] + v, sum[2] + a];
        }
        sum
    }

    fn seams(&self) -> Vec<f64> {
        let of = |(step, begin): (&Step, &f64)| -> Vec<f64> {
            step.course.seams().iter().map(|seam| begin + seam).collect()
        };
        let mut seams: Vec<f64> = self.steps.iter().zip(&self.begins).flat_map(of).collect();
        seams.sort_by(f64::total_cmp);
        seams.dedup();
        seams
    }

    fn narrowest(&self) -> Option<Narrow> {
        let of =
            |(step, begin): (&Step, &f64)| step.course.narrowest().map(|n| Narrow { t: n.t + begin, ..n });
        let all = self.steps.iter().zip(&self.begins).filter_map(of);
        all.min_by(|a, b| a.margin.total_cmp(&b.margin))
    }
}
