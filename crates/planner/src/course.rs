//! What all planned moves have in common.

use blocksim_motion::JointMove;

/// Position (rad), speed (rad/s) and acceleration (rad/s²) of an axis.
pub type State = [f64; 3];

/// A place on a move where axes lose a direction, or nearly do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrow {
    /// Smallest singular value of what is prescribed, m and rad.
    pub margin: f64,
    /// Time, s.
    pub t: f64,
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

    /// Length of the path and way along it after `t` s, m, where the tool follows one.
    fn way(&self, _t: f64) -> Option<(f64, f64)> {
        None
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
