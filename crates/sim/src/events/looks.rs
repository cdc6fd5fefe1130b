//! Guards at the stages of a step: looks between its ends that cost no evaluation of the diagram.
//!
//! A stage of a Runge-Kutta method is near the solution, not on it, so a look is a hint. What it shows is checked
//! on the dense output before anything follows from it.

/// How near two times are that differ by rounding, as a share of them.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Looks that are kept: the last stages of the last trial step.
const KEPT: usize = 16;

/// Guards at the points where the solver has asked for derivatives lately.
#[derive(Debug, Clone, Default)]
pub(crate) struct Looks {
    /// Number of guards; zero where nobody looks.
    guards: usize,
    /// Where the step begins.
    start: f64,
    times: Vec<f64>,
    /// Row by row.
    values: Vec<f64>,
    /// Where the next one goes.
    next: usize,
    /// Numbers of those within a step, in the order of time.
    within: Vec<usize>,
}

impl Looks {
    pub fn new(guards: usize) -> Self {
        Self {
            guards,
            start: f64::NEG_INFINITY,
            times: vec![f64::NAN; KEPT],
            values: vec![0.0; KEPT * guards],
            next: 0,
            within: Vec::with_capacity(KEPT),
        }
    }

    /// Whether anybody looks.
    #[inline]
    pub fn is_on(&self) -> bool {
        self.guards > 0
    }

    /// Whether a look at `t` would show anything: the values at the start of a step are known, and nobody asks for them here.
    #[inline]
    pub fn shows(&self, t: f64) -> bool {
        t > self.start
    }

    /// Forgets all looks: a new step begins at `start`.
    #[inline]
    pub fn begin(&mut self, start: f64) {
        if !self.is_on() {
            return;
        }
        self.start = start;
        self.times.fill(f64::NAN);
        self.next = 0;
    }

    /// Room for the guards at `t`. Of several looks at one time the last one counts: an iteration comes nearer to the
    /// solution. Times that differ by rounding are one, or what lies between them would be taken for the way of a guard.
    pub fn row(&mut self, t: f64) -> &mut [f64] {
        let known = self.times.iter().position(|&time| (time - t).abs() <= ROUNDING * t.abs());
        let at = known.unwrap_or(self.next);
        if known.is_none() {
            self.next = (self.next + 1) % KEPT;
        }
        self.times[at] = t;
        &mut self.values[at * self.guards..][..self.guards]
    }

    /// Forgets the look at `t`.
    pub fn forget(&mut self, t: f64) {
        self.times.iter_mut().filter(|time| **time == t).for_each(|time| *time = f64::NAN);
    }

    /// Whether a guard had both signs at looks after `t0` and not after `t1`.
    pub fn straddle(&self, guard: usize, t0: f64, t1: f64) -> bool {
        let times = self.times.iter().enumerate().filter(|&(_, &time)| time > t0 && time <= t1);
        let values = || times.clone().map(|(i, _)| self.values[i * self.guards + guard]);
        values().any(|value| value < 0.0) && values().any(|value| value > 0.0)
    }

    /// Finds the looks between two times; returns how many there are.
    pub fn find_within(&mut self, t0: f64, t1: f64) -> usize {
        let Self { times, within, .. } = self;
        within.clear();
        within.extend((0..times.len()).filter(|&i| times[i] > t0 && times[i] < t1));
        within.sort_unstable_by(|&a, &b| times[a].total_cmp(&times[b]));
        within.len()
    }

    /// How many were found.
    pub fn len(&self) -> usize {
        self.within.len()
    }

    /// The `k`th of those that were found: time and guards.
    pub fn within(&self, k: usize) -> (f64, &[f64]) {
        let i = self.within[k];
        (self.times[i], &self.values[i * self.guards..][..self.guards])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_come_in_the_order_of_time_and_the_last_at_one_time_counts() {
        let mut looks = Looks::new(1);
        for (t, value) in [(0.5, 1.0), (0.25, 2.0), (0.5, 3.0), (2.0, 4.0), (0.0, 5.0)] {
            looks.row(t)[0] = value;
        }
        assert_eq!(looks.find_within(0.0, 1.0), 2);
        assert_eq!(looks.within(0), (0.25, [2.0].as_slice()));
        assert_eq!(looks.within(1), (0.5, [3.0].as_slice()));
        looks.forget(0.25);
        assert_eq!(looks.find_within(0.0, 1.0), 1);
        looks.begin(0.5);
        assert_eq!(looks.find_within(0.0, 9.0), 0);
        assert!(looks.shows(0.6) && !looks.shows(0.5));
    }

    #[test]
    fn a_guard_straddles_zero_within_the_times_that_are_meant() {
        let mut looks = Looks::new(2);
        for (t, values) in [(0.0, [-1.0, 1.0]), (0.5, [1.0, 1.0]), (1.0, [0.0, -1.0]), (2.0, [-1.0, 1.0])] {
            looks.row(t).copy_from_slice(&values);
        }
        assert!(!looks.straddle(0, 0.0, 1.0) && looks.straddle(0, 0.0, 2.0) && looks.straddle(1, 0.0, 1.0));
    }

    #[test]
    fn times_that_differ_by_rounding_are_one() {
        let mut looks = Looks::new(1);
        for (t, value) in [(0.5, 1.0), (0.5_f64.next_up(), 2.0), (0.500001, 3.0)] {
            looks.row(t)[0] = value;
        }
        assert_eq!(looks.find_within(0.0, 1.0), 2);
        assert_eq!((looks.within(0).1, looks.within(1).1), ([2.0].as_slice(), [3.0].as_slice()));
    }

    #[test]
    fn the_oldest_look_makes_room() {
        let mut looks = Looks::new(2);
        for k in 0..100 {
            looks.row(f64::from(k)).fill(f64::from(k));
        }
        assert_eq!(looks.find_within(-1.0, 200.0), KEPT);
        assert_eq!(looks.within(0).0, 84.0);
    }
}
