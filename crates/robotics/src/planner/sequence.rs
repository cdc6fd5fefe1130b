//! Moves behind each other, with rounded corners.

use std::fmt;
use std::sync::Arc;

use crate::robot::Robot;
use nalgebra::Vector3;

use crate::planner::arm::Arm;
use crate::planner::check::FEWEST;
use crate::planner::course::{Course, Narrow, Note, State, Way};

/// Positions that differ by less are the same, rad.
const SAME: f64 = 1e-6;

/// A corner counts as rounded less than was asked for where less than this share of its zone is used.
const SHORT: f64 = 0.99;

/// A move of a sequence.
#[derive(Debug)]
pub struct Step {
    /// The move.
    pub course: Arc<dyn Course>,
    /// Radius of the zone around its end in which the next move begins, m; 0 for a stop.
    pub zone: f64,
    /// How long the robot rests at its end, s.
    pub wait: f64,
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
    /// Corners that are rounded less than they may be.
    corners: Vec<Note>,
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
    /// A wait is negative or no number, or stands at the end of a move that does not stop.
    Wait {
        /// Index of the move.
        step: usize,
        /// Whether it has a zone, too.
        zone: bool,
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
            SequenceError::Wait { step, zone: true } => {
                write!(
                    f,
                    "move {} has a zone and a wait; leave out one, for in a zone nothing stops",
                    step + 1
                )
            }
            SequenceError::Wait { step, zone: false } => {
                write!(f, "move {}: the wait is negative or no number; give a time, such as 0.5 s", step + 1)
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
        for (step, Step { zone, wait, .. }) in steps.iter().enumerate() {
            let possible = *wait >= 0.0 && wait.is_finite();
            if !possible || (*wait > 0.0 && *zone > 0.0) {
                return Err(SequenceError::Wait { step, zone: possible });
            }
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
        let (mut begins, mut t, mut corners) = (vec![0.0], 0.0, Vec::new());
        for (step, pair) in steps.windows(2).enumerate() {
            let (by, reached) = overlap(&mut arm, &pair[0], &*pair[1].course);
            t += pair[0].course.duration() - by + pair[0].wait;
            begins.push(t);
            let zone = pair[0].zone;
            if reached < SHORT * zone {
                corners.push(Note::Corner { step, zone, reached, t });
            }
        }
        let duration = t + steps.last().map_or(0.0, |step| step.course.duration() + step.wait);
        if let Some(last) = steps.last().filter(|last| last.zone > 0.0) {
            corners.push(Note::LastZone { step: steps.len() - 1, zone: last.zone, t: duration });
        }
        Ok(Sequence { steps, begins, starts, duration, corners })
    }
}

/// For how long the next move may run along with the end of this one, s, and how far from the corner the tool then is at
/// most, m: while it is in the zone on both paths.
fn overlap(arm: &mut Arm, step: &Step, next: &dyn Course) -> (f64, f64) {
    if step.zone == 0.0 {
        return (0.0, 0.0);
    }
    let mut tip = |course: &dyn Course, t: f64| -> Vector3<f64> {
        arm.look(&course.positions(t));
        arm.tool.translation
    };
    let corner = tip(next, 0.0);
    let mut away = |course: &dyn Course, t: f64| (tip(course, t) - corner).norm();
    // at most half of each move, so that no three overlap
    let (first, second) = (step.course.duration(), next.duration());
    let most = 0.5 * first.min(second);
    let mut reach = |by: f64| away(&*step.course, first - by).max(away(next, by));
    const PARTS: usize = 200;
    let grid = |k: usize| most * k as f64 / PARTS as f64;
    let mut furthest = 0.0_f64;
    let mut outside = None;
    for k in 1..=PARTS {
        let reached = reach(grid(k));
        if reached > step.zone {
            outside = Some(k);
            break;
        }
        furthest = furthest.max(reached);
    }
    let Some(outside) = outside else { return (most, furthest) };
    let (mut low, mut high) = (grid(outside - 1), grid(outside));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if reach(middle) <= step.zone { low = middle } else { high = middle }
    }
    (low, step.zone)
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
        seams.push(self.duration);
        seams.sort_by(f64::total_cmp);
        seams.dedup();
        seams
    }

    /// Each move is divided as if it were alone: waiting must not make it a small part of the time.
    fn parts(&self, count: usize) -> Vec<f64> {
        let each = (count / self.steps.len().max(1)).max(FEWEST.min(count));
        let of = |(step, begin): (&Step, &f64)| -> Vec<f64> {
            step.course.parts(each).iter().map(|t| begin + t).collect()
        };
        let even = (0..=count).map(|k| self.duration * (k as f64 / count as f64));
        let moves = self.steps.iter().zip(&self.begins).flat_map(of);
        let mut times: Vec<f64> = even.chain(moves).filter(|t| *t <= self.duration).collect();
        times.sort_by(f64::total_cmp);
        times
    }

    fn begins(&self) -> &[f64] {
        &self.begins
    }

    fn step(&self, t: f64) -> Option<usize> {
        Some(self.begins.partition_point(|begin| *begin <= t).saturating_sub(1))
    }

    fn way(&self, t: f64) -> Option<Way> {
        let step = Course::step(self, t)?;
        self.steps[step].course.way(t - self.begins[step])
    }

    fn stretched(&self, t: f64) -> f64 {
        Course::step(self, t).map_or(1.0, |step| self.steps[step].course.stretched(t - self.begins[step]))
    }

    fn notes(&self) -> Vec<Note> {
        let of_step = |(i, (step, begin)): (usize, (&Step, &f64))| {
            let place = |note| match note {
                Note::Turning { velocity, allowed, turning, t, .. } => {
                    Note::Turning { step: Some(i), velocity, allowed, turning, t: t + begin }
                }
                corner @ (Note::Corner { .. } | Note::LastZone { .. }) => corner,
            };
            step.course.notes().into_iter().map(place).collect::<Vec<_>>()
        };
        let own = self.steps.iter().zip(&self.begins).enumerate().flat_map(of_step);
        let mut notes: Vec<Note> = own.chain(self.corners.iter().copied()).collect();
        notes.sort_by(|a, b| a.t().total_cmp(&b.t()));
        notes
    }

    fn narrowest(&self) -> Option<Narrow> {
        let of =
            |(step, begin): (&Step, &f64)| step.course.narrowest().map(|n| Narrow { t: n.t + begin, ..n });
        let all = self.steps.iter().zip(&self.begins).filter_map(of);
        all.min_by(|a, b| a.margin.total_cmp(&b.margin))
    }
}
