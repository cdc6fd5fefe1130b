//! Values over time between given points, with what follows the last of them.

use blocksim_block::Interface;
use blocksim_block::law::Recording;
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

/// Discrete states: the times between which the straight line of the moment lies, then its values at both, column by column.
const FROM: usize = 0;
const TO: usize = 1;
const VALUES: usize = 2;

/// A place in the table: `passed` lines of the cycle are not later than now.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    cycle: f64,
    passed: usize,
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
    fn time(&self, cycle: f64, line: usize) -> f64 {
        self.shifted(cycle, self.table.times[line])
    }

    fn place(&self, t: f64) -> Place {
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

    /// Keeps the straight line that holds from `t` on: the times between which it lies, then the values there, column by column.
    pub fn keep(&self, t: f64, d: &mut [f64]) {
        let place = self.place(t);
        let last = self.table.times.len() - 1;
        // From the line before to the one behind; both are the same where the value is constant.
        let lines = match place.passed {
            0 => Some([0, 0]),
            passed if passed <= last && self.held => Some([passed - 1; 2]),
            passed if passed <= last => Some([passed - 1, passed]),
            _ => match self.after {
                After::Zero => None,
                // The last straight line of what is held is the last value.
                After::Extrapolate if last > 0 && !self.held => Some([last - 1, last]),
                _ => Some([last; 2]),
            },
        };
        let times = lines.map_or([0.0; 2], |lines| lines.map(|line| self.time(place.cycle, line)));
        // A jump has no line of its own: the value behind it holds.
        let (times, lines) = match lines {
            Some([_, to]) if times[1] <= times[0] => ([0.0, 1.0], Some([to; 2])),
            None => ([0.0, 1.0], None),
            lines => (times, lines),
        };
        d[FROM..VALUES].copy_from_slice(&times);
        for (column, pair) in d[VALUES..].chunks_exact_mut(2).enumerate() {
            let values = lines.map_or([0.0; 2], |lines| lines.map(|line| self.line(line)[column]));
            pair.copy_from_slice(&values);
        }
    }

    /// The interface with the discrete states for a straight line of `n` columns.
    pub fn declare(interface: Interface, n: usize) -> Interface {
        interface
            .discrete("from", 0.0)
            .discrete("to", 1.0)
            .memory("values", 2 * n, 0.0)
            .uses_time()
            .settles()
            .time_events()
    }

    /// The law of the straight line that is kept.
    pub fn record(l: &Recording) {
        let (d, t) = (l.d(), l.time());
        let share = (t - d[FROM]) / (d[TO] - d[FROM]);
        l.each(0, |column| {
            let (v0, v1) = (d[VALUES + 2 * column], d[VALUES + 2 * column + 1]);
            v0 + (v1 - v0) * share
        });
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
