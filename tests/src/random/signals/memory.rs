//! What nodes of the interpreter remember.

use super::model::Edge;

/// On which side of zero a trigger is, and whether it stands on zero.
///
/// A trigger that reaches zero has crossed it; when it leaves to the far side it does not cross again. Where it stands at
/// the start is no crossing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Trigger {
    /// 1 or -1; 0 before the first look, or while it has been zero since the start.
    side: i8,
    on_zero: bool,
    seen: bool,
}

impl Trigger {
    fn next(self, value: f64) -> Trigger {
        let on_zero = value == 0.0;
        let side = match (on_zero, value > 0.0) {
            (false, true) => 1,
            (false, false) => -1,
            // It counts as crossed when it arrives.
            (true, _) if self.seen && !self.on_zero => -self.side,
            (true, _) => self.side,
        };
        Trigger { side, on_zero, seen: true }
    }

    /// Looks at the trigger; whether that sets something off.
    pub fn look(&mut self, value: f64, edge: Edge) -> bool {
        let before = std::mem::replace(self, self.next(value));
        let rises = before.seen && before.side <= 0 && self.side > 0;
        let falls = before.seen && before.side >= 0 && self.side < 0;
        match edge {
            Edge::Rising => rises,
            Edge::Falling => falls,
            Edge::Either => rises || falls,
            Edge::Level => value > 0.0,
        }
    }

    /// Whether [`look`](Self::look) would set something off, or a level let go.
    pub fn would(self, value: f64, edge: Edge) -> bool {
        let mut copy = self;
        let fires = copy.look(value, edge);
        if edge == Edge::Level { fires != (self.side > 0 && !self.on_zero) } else { fires }
    }

    /// Whether the trigger was positive at the last look.
    pub fn is_high(self) -> bool {
        self.side > 0 && !self.on_zero
    }
}

/// The past of a signal: times and values, two at a jump.
#[derive(Debug, Clone, Default)]
pub struct History(Vec<(f64, f64)>);

impl History {
    /// Notes a value; a second one at the same time, if it differs, is a jump. Returns whether it is.
    pub fn note(&mut self, t: f64, value: f64) -> bool {
        match self.0.last() {
            Some(&(last, old)) if last == t && old == value => false,
            Some(&(last, _)) => {
                self.0.push((t, value));
                last == t
            }
            None => {
                self.0.push((t, value));
                false
            }
        }
    }

    /// The value at `t`, on the side of jumps on which `within` is; none before the start. It lies between two noted ones where
    /// nothing jumps: what goes round in a loop without loss would grow if straight pieces were prolonged.
    pub fn at(&self, t: f64, within: f64) -> Option<f64> {
        let (first, _) = *self.0.first()?;
        if within < first {
            return None;
        }
        let mut next = self.0.partition_point(|(time, _)| *time <= within);
        let time = |k: usize| self.0.get(k).map(|(time, _)| *time);
        while time(next).is_some_and(|end| end < t) && time(next + 1) > time(next) {
            next += 1;
        }
        while next > 1 && self.0[next - 1].0 > t && time(next - 2) < time(next - 1) {
            next -= 1;
        }
        let Some(&(t1, v1)) = self.0.get(next) else { return self.0.last().map(|(_, value)| *value) };
        let (t0, v0) = self.0[next - 1];
        Some(v0 + (v1 - v0) * (t - t0) / (t1 - t0))
    }
}
