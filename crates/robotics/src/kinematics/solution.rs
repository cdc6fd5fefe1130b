//! Solutions of the closed form and what distinguishes them.

use crate::kinematics::range::JointRange;

/// On which side of axis 1 the wrist is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shoulder {
    /// The arm is turned towards the wrist.
    Front,
    /// The arm is turned away and reaches over itself.
    Back,
}

/// To which side the arm is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Elbow {
    /// The elbow is above the line from axis 2 to the wrist, where the wrist is ahead of axis 2 (behind it for
    /// [`Shoulder::Back`]).
    Up,
    /// The elbow is on the other side of that line.
    Down,
}

/// Which way the hand is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrist {
    /// θ₅ ≥ 0.
    Plain,
    /// θ₅ < 0, axis 4 half a turn away from [`Wrist::Plain`].
    Flipped,
}

/// Which of the up to eight solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Configuration {
    /// Front or back.
    pub shoulder: Shoulder,
    /// Up or down.
    pub elbow: Elbow,
    /// Plain or flipped.
    pub wrist: Wrist,
}

/// What is singular at a solution: there the speed of a joint may grow without bound along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Singular {
    /// The wrist centre is on axis 1, whose angle is then free, or as near to it as the arm allows.
    pub shoulder: bool,
    /// The arm is stretched or folded: elbow up and down are one.
    pub elbow: bool,
    /// Axes 4 and 6 are in line: one of their angles is free.
    pub wrist: bool,
}

/// One set of joint positions for a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint positions, rad.
    pub q: [f64; 6],
    /// Which solution this is.
    pub configuration: Configuration,
    /// Which singularities it is at.
    pub singular: Singular,
}

impl Solution {
    /// Sum of the squared distances to another pose, rad².
    pub(crate) fn distance(&self, near: &[f64; 6]) -> f64 {
        self.q.iter().zip(near).map(|(a, b)| (a - b) * (a - b)).sum()
    }

    /// The same pose with each joint in its range, as few turns as possible from `near`; else the joint that has no
    /// turn in its range, and by how much it misses it.
    pub(crate) fn turned(&self, ranges: &[JointRange; 6], near: &[f64; 6]) -> Result<Solution, (usize, f64)> {
        let mut q = self.q;
        for i in 0..6 {
            q[i] = ranges[i].nearest(q[i], near[i]).ok_or_else(|| {
                let turn = std::f64::consts::TAU;
                let excess = |k: f64| ranges[i].excess(q[i] + k * turn);
                let middle = ((ranges[i].lower + ranges[i].upper) / 2.0 - q[i]) / turn;
                (i, excess(middle.floor()).min(excess(middle.ceil())))
            })?;
        }
        Ok(Solution { q, ..*self })
    }
}

/// Up to eight solutions, without allocation; reads as a slice.
#[derive(Debug, Clone, Copy)]
pub struct Solutions {
    entries: [Solution; 8],
    count: usize,
}

impl Solutions {
    pub(crate) fn none() -> Self {
        let configuration =
            Configuration { shoulder: Shoulder::Front, elbow: Elbow::Up, wrist: Wrist::Plain };
        let empty = Solution { q: [0.0; 6], configuration, singular: Singular::default() };
        Solutions { entries: [empty; 8], count: 0 }
    }

    pub(crate) fn push(&mut self, solution: Solution) {
        self.entries[self.count] = solution;
        self.count += 1;
    }

    /// The solutions that have all joints within `ranges`, each with the turns that are nearest to `near`. All turns
    /// of one joint are those of [`JointRange::turns`].
    pub fn within(&self, ranges: &[JointRange; 6], near: &[f64; 6]) -> impl Iterator<Item = Solution> {
        self.iter().filter_map(|solution| solution.turned(ranges, near).ok())
    }
}

impl std::ops::Deref for Solutions {
    type Target = [Solution];

    fn deref(&self) -> &[Solution] {
        &self.entries[..self.count]
    }
}
