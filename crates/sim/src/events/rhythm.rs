//! Events that come faster and faster and would come without end before some time: a ball whose hops shrink.
//!
//! Intervals d, r d, r^2 d ... with r < 1 add up to d / (1 - r). Simulated event by event the run never gets beyond that
//! sum; and once the hops are as small as the rounding of the state, the search for the event fails and the
//! state ends on the wrong side. (Zhang, Johansson, Lygeros, Sastry: Zeno hybrid systems, Int. J. Robust Nonlinear Control 11
//! (2001), doi 10.1002/rnc.592.)

/// Intervals in a row that must shrink.
const STREAK: u32 = 8;
/// Part of the time so far below which shrinking intervals have no end.
const SHORT: f64 = 1e-8;
/// What counts as shrinking.
const SHRINKS: f64 = 0.9999;
/// Part of the interval before, below which two events are one: an impact that ends a rounding below the floor crosses it
/// once more on its way up.
const ONE: f64 = 1e-3;

/// When each guard has fired lately.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rhythm {
    /// Time of the last event, the interval before it, and how many intervals have shrunk in a row.
    beats: Vec<(f64, f64, u32)>,
}

/// Events without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accumulation {
    /// Last interval, s.
    pub interval: f64,
    /// Part of the interval before.
    pub ratio: f64,
    /// Time that the events do not get beyond, s.
    pub end: f64,
}

impl Rhythm {
    pub fn new(guards: usize) -> Self {
        Self { beats: vec![(0.0, f64::INFINITY, 0); guards] }
    }

    /// Guard `i` fires at `t`. Returns what it comes to if that has no end.
    pub fn beat(&mut self, i: usize, t: f64) -> Option<Accumulation> {
        let (last, before, streak) = self.beats[i];
        let interval = t - last;
        if interval <= 0.0 || before.is_finite() && interval < ONE * before {
            return None;
        }
        let ratio = interval / before;
        let streak = if ratio < SHRINKS { streak + 1 } else { 0 };
        self.beats[i] = (t, interval, streak);
        let endless = streak > STREAK && interval < SHORT * t.abs();
        endless.then(|| Accumulation { interval, ratio, end: t + interval * ratio / (1.0 - ratio) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of events until the rhythm is said to have no end, and what it comes to.
    fn events(mut interval: f64, ratio: f64) -> Option<(u32, Accumulation)> {
        let (mut rhythm, mut t) = (Rhythm::new(1), 0.0);
        (0..2000).find_map(|k| {
            t += interval;
            interval *= ratio;
            rhythm.beat(0, t).map(|found| (k, found))
        })
    }

    #[test]
    fn the_sum_of_shrinking_intervals_is_foretold() {
        for ratio in [0.3, 0.8, 0.98] {
            let (_, found) = events(1.0, ratio).unwrap();
            assert!((found.ratio - ratio).abs() < 1e-4, "{found:?}");
            assert!((found.end - 1.0 / (1.0 - ratio)).abs() < 1e-8, "{found:?}");
        }
    }

    #[test]
    fn a_steady_rhythm_and_one_that_slows_down_have_no_end_in_sight() {
        assert_eq!(events(1e-12, 1.0), None);
        assert_eq!(events(1e-12, 1.01), None);
        assert_eq!(events(1.0, 0.9999), None);
    }
}
