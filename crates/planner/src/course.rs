//! What all planned moves have in common.

use blocksim_motion::JointMove;

use crate::error::short;

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
    /// What is done, with its unit.
    pub fn text(&self) -> String {
        match self.turn {
            true => format!("{} deg turned", short(self.done.to_degrees())),
            false => format!("s = {} mm", short(1e3 * self.done)),
        }
    }
}

/// A place on a move in words.
pub(crate) fn place(t: f64, share: f64, way: Option<Way>) -> String {
    let (time, percent) = (short(t), short(100.0 * share));
    match way {
        Some(way) => format!(
            "at {} % of the path ({}, t = {time} s, {percent} % of the time)",
            short(100.0 * way.done / way.length),
            way.text()
        ),
        None => format!("at {percent} % of the time (t = {time} s)"),
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

    /// The seams and `count` equal parts of the time, in ascending order.
    fn times(&self, count: usize) -> Vec<f64> {
        let even = (0..=count).map(|k| self.duration() * (k as f64 / count as f64));
        let mut times: Vec<f64> = even.chain(self.seams()).collect();
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

    fn seams(&self) -> Vec<f64> {
        vec![0.0, self.t_acc(), self.t_dec(), JointMove::duration(self)]
    }
}
