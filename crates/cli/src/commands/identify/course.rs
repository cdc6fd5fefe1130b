//! Set values of an experiment in the place of those of the move.

use std::fmt::Debug;
use std::sync::Arc;

use blocksim_block::{Block, Context, Scratch};
use blocksim_robotics::motion::Profile;

/// Set values of a joint over time.
pub trait Course: Debug + Send + Sync {
    /// Position, rad, speed, rad/s, and acceleration, rad/s², at a time, s.
    fn at(&self, t: f64) -> [f64; 3];

    /// Times at which the course is not smooth, in order.
    fn seams(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// A joint that stays where it is.
#[derive(Debug, Clone, Copy)]
pub struct Rest(pub f64);

impl Course for Rest {
    fn at(&self, _t: f64) -> [f64; 3] {
        [self.0, 0.0, 0.0]
    }
}

/// A joint that comes from rest to a constant speed.
#[derive(Debug, Clone, Copy)]
pub struct ConstantSpeed {
    /// Position at the start, rad.
    pub start: f64,
    /// Up to speed and on.
    pub profile: Profile,
}

impl Course for ConstantSpeed {
    fn at(&self, t: f64) -> [f64; 3] {
        [self.start + self.profile.position(t), self.profile.velocity(t), self.profile.acceleration(t)]
    }

    fn seams(&self) -> Vec<f64> {
        vec![0.0, self.profile.t_acc(), self.profile.t_dec(), self.profile.duration()]
    }
}

/// A course as a block with the ports of `JointMove`.
#[derive(Debug, Clone)]
pub struct SetValues(pub Arc<dyn Course>);

impl Block for SetValues {
    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        for (y, value) in y.iter_mut().zip(self.0.at(c.t)) {
            *y = value;
        }
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.0.seams().into_iter().find(|seam| *seam > c.t).unwrap_or(f64::INFINITY)
    }
}
