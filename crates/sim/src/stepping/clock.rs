//! Sample hits on the integer clock, the grid of fixed steps, and the earliest of times.

use blocksim_block::Resolution;
use blocksim_block::schedule::{Clock, Ticks};

/// When the rates are hit next.
#[derive(Debug, Clone)]
pub(crate) struct Hits {
    clock: Clock,
    resolution: Resolution,
    /// Tick of the next hit of each rate.
    pub next: Vec<u64>,
    /// The same in seconds.
    times: Vec<f64>,
    /// The rates that are hit at the present major step.
    pub due: Vec<bool>,
}

impl Hits {
    pub fn new(clock: &Clock, resolution: Resolution) -> Self {
        let mut hits = Self {
            resolution,
            next: clock.rates.iter().map(|rate| rate.offset).collect(),
            times: vec![0.0; clock.rates.len()],
            due: vec![false; clock.rates.len()],
            clock: clock.clone(),
        };
        hits.tell_times();
        hits
    }

    /// Follows a change of `next` from outside.
    pub fn tell_times(&mut self) {
        for (time, &tick) in self.times.iter_mut().zip(&self.next) {
            *time = self.clock.time(tick);
        }
    }

    /// Times of the next hits, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether the next hit of a rate is at `t` or before.
    pub fn is_due(&self, rate: usize, t: f64) -> bool {
        self.times[rate] <= t + self.resolution.same(t)
    }

    /// Marks the rates that are hit at `t` and returns how many there are.
    pub fn strike(&mut self, t: f64) -> u64 {
        let mut count = 0;
        for (i, rate) in self.clock.rates.iter().enumerate() {
            self.due[i] = self.is_due(i, t);
            if self.due[i] {
                self.next[i] += rate.period;
                self.times[i] = self.clock.time(self.next[i]);
                count += 1;
            }
        }
        count
    }
}

/// Multiples of a step, as exact as those of a clock.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    ticks: Ticks,
    resolution: Resolution,
    /// Number of the first point that has not been passed.
    next: u64,
    /// Its time, s.
    time: f64,
}

impl Grid {
    pub fn new(step: f64, resolution: Resolution) -> Self {
        let ticks = Ticks::new(step);
        Self { ticks, resolution, next: 0, time: ticks.time(0) }
    }

    /// Number of the first point that has not been passed.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Has `next` be the first point that has not been passed.
    pub fn go_to(&mut self, next: u64) {
        (self.next, self.time) = (next, self.ticks.time(next));
    }

    /// Time of the first point that has not been passed, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Passes all points up to and including `t`; returns whether there was one.
    pub fn pass(&mut self, t: f64) -> bool {
        let before = self.next;
        while self.time <= t + self.resolution.same(t) {
            self.go_to(self.next + 1);
        }
        self.next > before
    }
}

/// The earliest of several times, together with those that are meant to be equal to it: the latest of these.
pub(crate) fn earliest(times: impl Iterator<Item = f64> + Clone, resolution: Resolution) -> f64 {
    let first = times.clone().fold(f64::INFINITY, f64::min);
    times.filter(|&t| t <= first + resolution.same(first)).fold(first, f64::max)
}

/// An instant, or the latest of the pending times behind it that are meant to be equal to it.
pub(crate) fn at_pending(t: f64, pending: &[f64], resolution: Resolution) -> f64 {
    let same = t + resolution.same(t);
    pending.iter().copied().filter(|&time| time <= same).fold(t, f64::max)
}

#[cfg(test)]
mod tests {
    use blocksim_block::schedule::Rate;

    use super::*;

    fn hits(tick: f64, periods: &[u64]) -> Hits {
        let rates = periods.iter().map(|&period| Rate { period, offset: 0 }).collect();
        Hits::new(&Clock { tick, rates }, Resolution::default())
    }

    #[test]
    fn a_million_hits_do_not_drift() {
        let mut hits = hits(1e-3, &[1]);
        for k in 0..1_000_000_u64 {
            let t = earliest(hits.times().iter().copied(), Resolution::default());
            assert_eq!(t, k as f64 / 1000.0);
            assert_eq!(hits.strike(t), 1);
        }
    }

    #[test]
    fn two_rates_meet_at_each_fifth_hit() {
        let mut hits = hits(1e-3, &[1, 5]);
        for k in 0..1000 {
            let t = earliest(hits.times().iter().copied(), Resolution::default());
            hits.strike(t);
            assert_eq!(hits.due, [true, k % 5 == 0], "hit {k}");
        }
    }

    #[test]
    fn times_that_differ_by_rounding_are_one() {
        let sum = 0.1 + 0.2;
        assert!(sum > 0.3);
        assert_eq!(earliest([0.5, 0.3, sum].into_iter(), Resolution::default()), sum);
        assert_eq!(earliest([0.5, f64::INFINITY].into_iter(), Resolution::default()), 0.5);
        assert_eq!(earliest([0.5, 0.5 + 1e-9].into_iter(), Resolution::default()), 0.5);
        assert_eq!(earliest(std::iter::empty(), Resolution::default()), f64::INFINITY);
        // In a run of a nanosecond a femtosecond is long.
        let short = Resolution::new(1e-9);
        assert_eq!(earliest([0.3e-9, 0.3e-9 + 1e-15].into_iter(), short), 0.3e-9);
        assert_eq!(earliest([0.3e-9, 1e-9 * sum].into_iter(), short), 1e-9 * sum);
    }

    #[test]
    fn an_instant_is_that_of_what_is_pending_there_but_for_rounding() {
        let sum = 0.1 + 0.2;
        let at = |pending: &[f64]| at_pending(0.3, pending, Resolution::default());
        assert_eq!(at(&[sum, f64::INFINITY]), sum);
        assert_eq!([at(&[]), at(&[0.3_f64.next_down()]), at(&[0.3 + 1e-9]), at(&[0.1])], [0.3; 4]);
    }

    #[test]
    fn a_grid_is_passed_point_by_point() {
        let mut grid = Grid::new(0.1, Resolution::default());
        assert!(grid.pass(0.0));
        assert!(!grid.pass(0.05));
        assert_eq!(grid.time(), 0.1);
        assert!(grid.pass(0.3));
        assert_eq!(grid.time(), 0.4);
    }
}
