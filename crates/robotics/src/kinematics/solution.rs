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
    /// Sense of joint 6 against that of joint 4, 1 or -1.
    pub(crate) sense: f64,
}

impl Solution {
    /// Sum of the squared distances to another pose, rad².
    pub(crate) fn distance(&self, near: &[f64; 6]) -> f64 {
        self.q.iter().zip(near).map(|(a, b)| (a - b) * (a - b)).sum()
    }

    /// The same pose with each joint in its range, as few turns as possible from `near`; else the joint that has no
    /// turn in its range, and by how much it misses it. Where axes 4 and 6 are in line joint 4 stays, as long as joint 6 can take the turn.
    pub(crate) fn turned(&self, ranges: &[JointRange; 6], near: &[f64; 6]) -> Result<Solution, (usize, f64)> {
        self.turned_with(ranges, near, &[]).or_else(|missed| self.shared(ranges, near).ok_or(missed))
    }

    /// Where axes 4 and 6 are in line only the sum of their turns, $q_4 + s q_6$, is given: both in their ranges and nearest to `near`.
    pub(crate) fn shared(&self, ranges: &[JointRange; 6], near: &[f64; 6]) -> Option<Solution> {
        if !self.singular.wrist {
            return None;
        }
        /// Turns either way that are tried where a range has no end.
        const TURNS: f64 = 2.0;
        let other = self.turned_with(ranges, near, &[3, 5]).ok()?;
        let away = |i: usize| [ranges[i].lower - near[i], ranges[i].upper - near[i]];
        let [low, high] = away(3);
        let [low_6, high_6] = match (self.sense > 0.0, away(5)) {
            (true, ends) => ends,
            (false, [low, high]) => [-high, -low],
        };
        let sum = (self.q[3] - near[3]) + self.sense * (self.q[5] - near[5]);
        let in_turns = |angle: f64| angle / std::f64::consts::TAU;
        let nearest = -in_turns(sum).round();
        let first = in_turns(low + low_6 - sum).ceil().max(nearest - TURNS);
        let last = in_turns(high + high_6 - sum).floor().min(nearest + TURNS);
        let turns = (0..).map(|k| first + f64::from(k)).take_while(|k| *k <= last);
        let solution = |k: f64| {
            let sum = sum + std::f64::consts::TAU * k;
            let share = (0.5 * sum).max(low).max(sum - high_6).min(high).min(sum - low_6);
            let mut q = other.q;
            q[3] = ranges[3].clamp(near[3] + share);
            q[5] = ranges[5].clamp(near[5] + self.sense * (sum - share));
            Solution { q, ..*self }
        };
        turns.map(solution).min_by(|a, b| a.distance(near).total_cmp(&b.distance(near)))
    }

    /// Each joint by itself, but for some that stay as they are.
    fn turned_with(
        &self,
        ranges: &[JointRange; 6],
        near: &[f64; 6],
        without: &[usize],
    ) -> Result<Solution, (usize, f64)> {
        let mut q = self.q;
        for i in (0..6).filter(|i| !without.contains(i)) {
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
        let empty = Solution { q: [0.0; 6], configuration, singular: Singular::default(), sense: 1.0 };
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
