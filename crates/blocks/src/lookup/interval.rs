//! Where a value lies among breakpoints.

use blocksim_block::prelude::*;

use crate::math::elements::ROUNDING;

/// What stands beyond the first and the last breakpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Extrapolation {
    /// The value at the end.
    Clip,
    /// The tangent at the end.
    Linear,
}

/// Reports breakpoints that are too few: one alone is enough only if nothing is extrapolated.
pub(super) fn enough(
    name: &str,
    breakpoints: &[f64],
    extrapolation: Extrapolation,
    errors: &mut ParamErrors,
) {
    if breakpoints.len() == 1 && extrapolation != Extrapolation::Clip {
        let error = ParamError::new(name, format!("`{name}` has 1 value, but needs at least 2"));
        errors.add(error.help("one alone is enough with `extrapolation: Clip`"));
    }
}

/// The interval `i`, from breakpoint `i` to the next, in which `u` lies or which is nearest; 0 if there is only
/// one breakpoint. A breakpoint belongs to the interval above it, the last one to the one below.
pub(super) fn interval(breakpoints: &[f64], u: f64) -> usize {
    below(breakpoints, u).saturating_sub(1).min(breakpoints.len().saturating_sub(2))
}

/// How many breakpoints lie at or below `u`.
pub(super) fn below(breakpoints: &[f64], u: f64) -> usize {
    breakpoints.partition_point(|breakpoint| *breakpoint <= u)
}

/// Whether two slopes at breakpoint `i`, where the value is `y`, differ by more than rounding.
pub(super) fn bends(before: f64, after: f64, breakpoints: &[f64], i: usize, y: f64) -> bool {
    let width = |pair: &[f64]| pair[1] - pair[0];
    let around = &breakpoints[i.saturating_sub(1)..(i + 2).min(breakpoints.len())];
    let narrow = around.windows(2).map(width).fold(f64::INFINITY, f64::min);
    let rounding = ROUNDING * (y.abs() / narrow + before.abs() + after.abs());
    (before - after).abs() > rounding
}

/// The breakpoints at which a table has a kink. Between two instants the solver looks for the nearest one above and below
/// the place of the last instant: however many lie within a step, the first of them is found.
pub(super) struct Kinks<'a, F: Fn(usize) -> bool> {
    pub breakpoints: &'a [f64],
    /// Whether there is a kink at a breakpoint.
    pub is_kink: F,
}

impl<F: Fn(usize) -> bool> Kinks<'_, F> {
    /// Whether there are any.
    pub fn any(&self) -> bool {
        (0..self.breakpoints.len()).any(&self.is_kink)
    }

    /// The next breakpoints with a kink above and below a place with `at` breakpoints at or below it.
    pub fn next(&self, at: usize) -> [Option<usize>; 2] {
        let above = (at..self.breakpoints.len()).find(|&i| (self.is_kink)(i));
        let below = (0..at).rev().find(|&i| (self.is_kink)(i));
        [above, below]
    }

    /// How far `u` is beyond the next kink above and the next below a place with `at` breakpoints at or below it. Without a
    /// kink there, a value that keeps its sign.
    pub fn around(&self, at: usize, u: f64) -> [f64; 2] {
        let [above, below] = self.next(at);
        [above.map_or(-1.0, |i| u - self.breakpoints[i]), below.map_or(1.0, |i| u - self.breakpoints[i])]
    }

    /// The same of a place that is not known before a run.
    pub fn recorded<'r>(&self, l: &Recording<'r>, u: Value<'r>, at: Value<'r>) -> [Value<'r>; 2] {
        let none = [-1.0, 1.0].map(|number| l.constant(number));
        (0..=self.breakpoints.len()).fold(none, |[above, below], place| {
            let here = at.live(Relation::Equal, l.constant(place as f64));
            let distance = |side: usize| {
                let kink = self.next(place)[side];
                kink.map_or(none[side], |i| u - self.breakpoints[i])
            };
            [here.select(distance(0), above), here.select(distance(1), below)]
        })
    }
}

/// Records how many breakpoints lie at or below `u`.
pub(super) fn recorded_below<'r>(l: &Recording<'r>, breakpoints: &[f64], u: Value<'r>) -> Value<'r> {
    breakpoints.iter().fold(l.constant(0.0), |below, breakpoint| {
        below + u.live(Relation::GreaterEqual, l.constant(*breakpoint)).number()
    })
}

/// Of values for each interval, records that of the one in which `u` lies or which is nearest. There must be one.
pub(super) fn in_interval<'r>(
    l: &Recording<'r>,
    breakpoints: &[f64],
    u: Value<'r>,
    value: impl Fn(usize) -> Value<'r>,
) -> Value<'r> {
    (1..breakpoints.len() - 1).fold(value(0), |before, i| {
        u.live(Relation::GreaterEqual, l.constant(breakpoints[i])).select(value(i), before)
    })
}

/// Records how far `u` is through its interval, see [`share`].
pub(super) fn recorded_share<'r>(
    l: &Recording<'r>,
    breakpoints: &[f64],
    u: Value<'r>,
    extrapolation: Extrapolation,
) -> Value<'r> {
    let [start, end] =
        [0, 1].map(|side| in_interval(l, breakpoints, u, |i| l.constant(breakpoints[i + side])));
    let share = (u - start) / (end - start);
    match extrapolation {
        Extrapolation::Clip => share.clamp(l.constant(0.0), l.constant(1.0)),
        Extrapolation::Linear => share,
    }
}

/// Records a value between two, see [`mix`].
pub(super) fn recorded_mix<'r>(a: Value<'r>, b: Value<'r>, share: Value<'r>) -> Value<'r> {
    share.live(Relation::Equal, share.zero() + 1.0).select(b, a + share * (b - a))
}

/// The interval of `u`, and how far `u` is through it: 0 at its start, 1 at its end, beyond that only when it is
/// to be extrapolated.
pub(super) fn share(breakpoints: &[f64], u: f64, extrapolation: Extrapolation) -> (usize, f64) {
    let i = interval(breakpoints, u);
    let Some(end) = breakpoints.get(i + 1) else {
        return (i, if u.is_nan() { u } else { 0.0 });
    };
    let share = (u - breakpoints[i]) / (end - breakpoints[i]);
    (i, if extrapolation == Extrapolation::Clip { share.clamp(0.0, 1.0) } else { share })
}

/// From `a` to `b`; exactly these at the shares 0 and 1.
pub(super) fn mix(a: f64, b: f64, share: f64) -> f64 {
    if share == 1.0 { b } else { a + share * (b - a) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_find_their_interval() {
        let breakpoints = [0.0, 1.0, 3.0];
        for (u, expected) in [(-1.0, 0), (0.0, 0), (0.5, 0), (1.0, 1), (2.9, 1), (3.0, 1), (9.0, 1)] {
            assert_eq!(interval(&breakpoints, u), expected, "{u}");
        }
        assert_eq!(interval(&[5.0], 7.0), 0);
    }
}
