//! What all planned moves have in common.

use std::fmt;

use crate::motion::JointMove;

use crate::planner::error::short;

/// Position (rad or m), speed and acceleration of an axis.
pub type State = [f64; 3];

/// A place on a move where axes lose a direction, or nearly do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrow {
    /// Smallest singular value of what is prescribed, m and rad.
    pub margin: f64,
    /// Time, s.
    pub t: f64,
}

/// How far the tool is on its path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Length of the path, m; of a turn on the spot its angle, rad.
    pub length: f64,
    /// How much of it is done.
    pub done: f64,
    /// Whether it is a turn on the spot.
    pub turn: bool,
}

impl Way {
    /// The start of a path that is not known yet.
    pub(crate) const START: Way = Way { length: 0.0, done: 0.0, turn: false };

    /// What is done, with its unit.
    pub fn text(&self) -> String {
        match self.turn {
            true => format!("{} deg turned", short(self.done.to_degrees())),
            false => format!("s = {} mm", short(1e3 * self.done)),
        }
    }
}

/// A place on a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Time, s.
    pub t: f64,
    /// Share of the time of the whole move.
    pub share: f64,
    /// Where the tool is on its path, if it follows one.
    pub way: Option<Way>,
    /// Index of the move that began last, in a sequence.
    pub step: Option<usize>,
}

impl Spot {
    /// The place after `t` s.
    pub fn of(course: &dyn Course, t: f64) -> Spot {
        let share = if course.duration() > 0.0 { t / course.duration() } else { 0.0 };
        Spot { t, share, way: course.way(t), step: course.step(t) }
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (time, percent) = (short(self.t), short(100.0 * self.share));
        if let Some(step) = self.step {
            write!(f, "in move {}, ", step + 1)?;
        }
        match self.way {
            Some(way) => write!(
                f,
                "at {} % of the path ({}, t = {time} s, {percent} % of the time)",
                short(100.0 * way.done / way.length),
                way.text()
            ),
            None => write!(f, "at {percent} % of the time (t = {time} s)"),
        }
    }
}

/// Where a move is not quite what was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Note {
    /// A corner between two moves of a sequence is rounded less than it may be.
    Corner {
        /// Index of the move before it.
        step: usize,
        /// Radius of the zone that was asked for, m.
        zone: f64,
        /// How far from the corner the tool is at most where the moves overlap, m.
        reached: f64,
        /// When the next move begins, s.
        t: f64,
    },
    /// A zone behind the last move, where the tool stops all the same.
    LastZone {
        /// Index of the move.
        step: usize,
        /// Radius of the zone that was asked for, m.
        zone: f64,
        /// When the move ends, s.
        t: f64,
    },
    /// The tool goes slower along its path, because its orientation must not turn faster.
    Turning {
        /// Index of the move in a sequence.
        step: Option<usize>,
        /// Speed that was asked for, m/s.
        velocity: f64,
        /// Speed that the turn allows, m/s.
        allowed: f64,
        /// Angular velocity that bounds it, rad/s.
        turning: f64,
        /// When the move begins, s.
        t: f64,
    },
}

impl Note {
    /// A word for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Note::Corner { .. } => "corner_shortened",
            Note::LastZone { .. } => "zone_at_the_end",
            Note::Turning { .. } => "slowed_by_turning",
        }
    }

    /// When it is, s.
    pub fn t(&self) -> f64 {
        match self {
            Note::Corner { t, .. } | Note::LastZone { t, .. } | Note::Turning { t, .. } => *t,
        }
    }

    /// What was asked for and what came of it, SI.
    pub fn values(&self) -> [f64; 2] {
        match *self {
            Note::Corner { zone, reached, .. } => [zone, reached],
            Note::LastZone { zone, .. } => [zone, 0.0],
            Note::Turning { velocity, allowed, .. } => [velocity, allowed],
        }
    }

    /// What helps.
    pub fn help(&self) -> &'static str {
        match self {
            Note::Corner { .. } => "lengthen the shorter of the two moves, or make the zone smaller",
            Note::LastZone { .. } => "leave the zone out, or add the move that follows",
            Note::Turning { .. } => "raise `rotation_velocity`, or turn the tool over a longer path",
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Note::Corner { step, zone, reached, .. } => write!(
                f,
                "the corner behind move {} is rounded within {} mm of a zone of {} mm: the moves overlap for half of the \
                 shorter one at most",
                step + 1,
                short(1e3 * reached),
                short(1e3 * zone)
            ),
            Note::LastZone { step, zone, .. } => write!(
                f,
                "the zone of {} mm behind move {} has no effect, because no move follows: the tool stops there",
                short(1e3 * zone),
                step + 1
            ),
            Note::Turning { step, velocity, allowed, turning, .. } => {
                if let Some(step) = step {
                    write!(f, "in move {}, ", step + 1)?;
                }
                write!(
                    f,
                    "the tool moves with at most {} mm/s of {} mm/s, because it turns on the way, with at most {} deg/s",
                    short(1e3 * allowed),
                    short(1e3 * velocity),
                    short(turning.to_degrees())
                )
            }
        }
    }
}

/// A planned move of all axes from rest to rest.
pub trait Course: std::fmt::Debug + Send + Sync {
    /// Number of axes.
    fn axes(&self) -> usize;

    /// Time from rest to rest, s.
    fn duration(&self) -> f64;

    /// An axis after `t` s; at rest before the start and after the end.
    ///
    /// # Panics
    /// Beyond the last axis.
    fn at(&self, axis: usize, t: f64) -> State;

    /// Times at which the acceleration or its slope jumps, in ascending order, from 0 to the end.
    fn seams(&self) -> Vec<f64>;

    /// How far the tool is on its path after `t` s, where it follows one.
    fn way(&self, _t: f64) -> Option<Way> {
        None
    }

    /// When each of several moves begins, s; a single move begins at once.
    fn begins(&self) -> &[f64] {
        &[0.0]
    }

    /// Which of several moves began last, after `t` s.
    fn step(&self, _t: f64) -> Option<usize> {
        None
    }

    /// How many times longer the part of a move that runs after `t` s takes than its velocity asks for, because of another limit.
    fn stretched(&self, _t: f64) -> f64 {
        1.0
    }

    /// Where the move is not quite what was asked for, though it keeps all limits.
    fn notes(&self) -> Vec<Note> {
        Vec::new()
    }

    /// The ends of `count` equal parts of the time, in ascending order.
    fn parts(&self, count: usize) -> Vec<f64> {
        (0..=count).map(|k| self.duration() * (k as f64 / count as f64)).collect()
    }

    /// The same with the seams.
    fn times(&self, count: usize) -> Vec<f64> {
        let mut times = self.parts(count);
        times.extend(self.seams());
        times.sort_by(f64::total_cmp);
        times
    }

    /// Where the axes are nearest to a singular pose, if the tool follows a path.
    fn narrowest(&self) -> Option<Narrow> {
        None
    }

    /// Positions of all axes after `t` s.
    fn positions(&self, t: f64) -> Vec<f64> {
        (0..self.axes()).map(|axis| self.at(axis, t)[0]).collect()
    }
}

impl Course for JointMove {
    fn axes(&self) -> usize {
        JointMove::axes(self)
    }

    fn duration(&self) -> f64 {
        JointMove::duration(self)
    }

    fn at(&self, axis: usize, t: f64) -> State {
        JointMove::at(self, axis, t).into()
    }

    fn stretched(&self, _t: f64) -> f64 {
        self.stretch()
    }

    fn seams(&self) -> Vec<f64> {
        vec![0.0, self.t_acc(), self.t_dec(), JointMove::duration(self)]
    }
}
