//! Values over time between given points, with what follows the last of them.

use serde::Deserialize;

use super::table::Table;

/// What follows the last line of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum After {
    /// The last values.
    #[default]
    Hold,
    /// The last straight line goes on.
    Extrapolate,
    /// Zero.
    Zero,
    /// The table again, from the first line.
    Cyclic,
}

/// A place in the table: `passed` lines of the cycle are not later than now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub cycle: f64,
    pub passed: usize,
}

/// A table with what lies between and behind its lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Course {
    pub table: Table,
    pub after: After,
    /// Whether values hold until the next line, rather than lie on straight lines.
    pub held: bool,
}

impl Course {
    fn period(&self) -> f64 {
        match self.table.times[..] {
            [first, .., last] if self.after == After::Cyclic => last - first,
            _ => 0.0,
        }
    }

    /// A time of the table in a cycle. Events and places use this one expression, so they agree to the last bit; the
    /// end of a cycle is the start of the next.
    fn shifted(&self, cycle: f64, time: f64) -> f64 {
        match (self.table.times.first(), self.table.times.last(), self.period()) {
            (Some(first), Some(last), period) if period > 0.0 && time == *last => {
                first + (cycle + 1.0) * period
            }
            (_, _, period) => time + cycle * period,
        }
    }

    /// Time of a line.
    pub fn time(&self, cycle: f64, line: usize) -> f64 {
        self.shifted(cycle, self.table.times[line])
    }

    pub fn place(&self, t: f64) -> Place {
        let (times, period) = (&self.table.times, self.period());
        let mut cycle = 0.0;
        if period > 0.0 && t >= times[0] {
            // The quotient may be off by a rounding.
            cycle = ((t - times[0]) / period).floor().max(0.0);
            if self.time(cycle + 1.0, 0) <= t {
                cycle += 1.0;
            } else if self.time(cycle, 0) > t {
                cycle -= 1.0;
            }
        }
        Place { cycle, passed: times.partition_point(|time| self.shifted(cycle, *time) <= t) }
    }

    /// Values of one line.
    fn line(&self, line: usize) -> &[f64] {
        let n = self.table.columns.len();
        &self.table.values[line * n..(line + 1) * n]
    }

    /// The value at `t` on the branch of `place`, which may be the one before `t`.
    pub fn value(&self, place: Place, t: f64, column: usize) -> f64 {
        let last = self.table.times.len() - 1;
        let on_line = |from: usize| {
            let (t0, t1) = (self.time(place.cycle, from), self.time(place.cycle, from + 1));
            if self.held {
                return self.line(from)[column];
            }
            let (v0, v1) = (self.line(from)[column], self.line(from + 1)[column]);
            if t1 > t0 { v0 + (v1 - v0) * ((t - t0) / (t1 - t0)) } else { v1 }
        };
        match place.passed {
            0 => self.line(0)[column],
            passed if passed <= last => on_line(passed - 1),
            _ => match self.after {
                After::Zero => 0.0,
                After::Extrapolate if last > 0 => on_line(last - 1),
                _ => self.line(last)[column],
            },
        }
    }

    /// When the next line comes; never behind the last one.
    pub fn next(&self, t: f64) -> f64 {
        let place = self.place(t);
        if place.passed < self.table.times.len() {
            self.time(place.cycle, place.passed)
        } else {
            f64::INFINITY
        }
    }
}
