//! How many events a run can bear: each leaves a row, and a run that gets on by next to nothing between them would fill
//! the disk before it ends.

/// Events that are counted together.
const MANY: u32 = 300_000;

/// Share of the run that they must take at least; at less, the whole run would have more than 3e8 of them.
const LEAST: f64 = 1e-3;

/// Events since some time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Pace {
    since: f64,
    count: u32,
}

/// Events that come too fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flood {
    /// How many there were.
    pub count: u32,
    /// Within which time, s.
    pub within: f64,
}

impl Pace {
    /// Counts an event at `t` of a run that ends at `stop`, s. Tells when they are too many.
    pub fn count(&mut self, t: f64, stop: f64) -> Option<Flood> {
        self.count += 1;
        if self.count < MANY {
            return None;
        }
        let within = t - self.since;
        *self = Self { since: t, count: 0 };
        (within < LEAST * stop).then_some(Flood { count: MANY, within })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of the event, each `interval` after the last, at which a run of 1 s is ended, if it is.
    fn ended(interval: f64) -> Option<u32> {
        let mut pace = Pace::default();
        (1..=1_000_000).find(|&k| pace.count(f64::from(k) * interval, 1.0).is_some())
    }

    #[test]
    fn a_run_is_ended_when_it_would_have_hundreds_of_millions_of_events() {
        assert_eq!(ended(3e-9), Some(MANY));
        assert_eq!(ended(4e-9), None);
    }
}
