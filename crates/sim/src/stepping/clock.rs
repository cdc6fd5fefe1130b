//! Sample hits on the integer clock, the grid of fixed steps, and times that are meant to be equal.

use blocksim_block::schedule::{Clock, Ticks};

/// Times closer to `t` than this are the same time: a sum of periods and the product of the same are.
pub(crate) fn same(t: f64) -> f64 {
    1e-12 * t.abs().max(1.0)
}

/// When the rates are hit next.
#[derive(Debug, Clone)]
pub(crate) struct Hits {
    clock: Clock,
    /// Tick of the next hit of each rate.
    pub next: Vec<u64>,
    /// The same in seconds.
    times: Vec<f64>,
    /// The rates that are hit at the present major step.
    pub due: Vec<bool>,
}

impl Hits {
    pub fn new(clock: &Clock) -> Self {
        let mut hits = Self {
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

    /// Marks the rates that are hit at `t` and returns how many there are.
    pub fn strike(&mut self, t: f64) -> u64 {
        let mut count = 0;
        for (i, rate) in self.clock.rates.iter().enumerate() {
            self.due[i] = self.times[i] <= t + same(t);
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
    /// Number of the first point that has not been passed.
    next: u64,
    /// Its time, s.
    time: f64,
}

impl Grid {
    pub fn new(step: f64) -> Self {
        let ticks = Ticks::new(step);
        Self { ticks, next: 0, time: ticks.time(0) }
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
        while self.time <= t + same(t) {
            self.go_to(self.next + 1);
        }
        self.next > before
    }
}

/// The earliest of several times, together with those that are meant to be equal to it: the latest of these.
pub(crate) fn earliest(times: impl Iterator<Item = f64> + Clone) -> f64 {
    let first = times.clone().fold(f64::INFINITY, f64::min);
    times.filter(|&t| t <= first + same(first)).fold(first, f64::max)
}

#[cfg(test)]
mod tests {
    use blocksim_block::schedule::Rate;

    use super::*;

    fn hits(tick: f64, periods: &[u64]) -> Hits {
        let rates = periods.iter().map(|&period| Rate { period, offset: 0 }).collect();
        Hits::new(&Clock { tick, rates })
    }

    #[test]
    fn a_million_hits_do_not_drift() {
        let mut hits = hits(1e-3, &[1]);
        for k in 0..1_000_000_u64 {
            let t = earliest(hits.times().iter().copied());
            assert_eq!(t, k as f64 / 1000.0);
            assert_eq!(hits.strike(t), 1);
        }
    }

    #[test]
    fn two_rates_meet_at_each_fifth_hit() {
        let mut hits = hits(1e-3, &[1, 5]);
        for k in 0..1000 {
            let t = earliest(hits.times().iter().copied());
            hits.strike(t);
            assert_eq!(hits.due, [true, k % 5 == 0], "hit {k}");
        }
    }

    #[test]
    fn times_that_differ_by_rounding_are_one() {
        let sum = 0.1 + 0.2;
        assert!(sum > 0.3);
        assert_eq!(earliest([0.5, 0.3, sum].into_iter()), sum);
        assert_eq!(earliest([0.5, f64::INFINITY].into_iter()), 0.5);
        assert_eq!(earliest([0.5, 0.5 + 1e-9].into_iter()), 0.5);
        assert_eq!(earliest(std::iter::empty()), f64::INFINITY);
    }

    #[test]
    fn a_grid_is_passed_point_by_point() {
        let mut grid = Grid::new(0.1);
        assert!(grid.pass(0.0));
        assert!(!grid.pass(0.05));
        assert_eq!(grid.time(), 0.1);
        assert!(grid.pass(0.3));
        assert_eq!(grid.time(), 0.4);
    }
}
