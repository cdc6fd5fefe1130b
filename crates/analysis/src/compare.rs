//! Whether two signals are the same within tolerances.

use crate::bounds::Window;
use crate::series::{Interpolation, Series};

/// Times that differ by less than this share of the whole are one.
const SAME_TIME: f64 = 1e-9;
/// How many times that far from an instant is beside it.
const BESIDE: f64 = 3.0;

/// How much signals may differ, and how they are compared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rule {
    /// Absolute tolerance, in the unit of the values.
    pub absolute: f64,
    /// Relative tolerance, share of the baseline's size at each instant.
    pub relative: f64,
    /// Tolerance as a share of the range of the baseline, its maximum less its minimum: signals pass through zero, where a share of
    /// their size allows nothing.
    pub range: f64,
    /// Time tolerance, s: how much earlier or later a value may come.
    pub time: f64,
    /// What signals are between their values.
    pub interpolation: Interpolation,
    /// At which instants they are compared.
    pub instants: Instants,
}

impl Rule {
    /// The same with what is a share of the range of a signal as an absolute tolerance.
    pub fn over(&self, baseline: &Series) -> Rule {
        let finite = baseline.values.iter().copied().filter(|value| value.is_finite());
        let (low, high) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let allowed = self.range * (high - low);
        let allowed = if allowed.is_finite() { allowed } else { 0.0 };
        Rule { absolute: self.absolute.max(allowed), range: 0.0, ..*self }
    }
}

/// At which instants two signals are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instants {
    /// Where either has a value.
    #[default]
    Union,
    /// Where both have one.
    Intersection,
}

/// Values of both signals at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// When, s.
    pub time: f64,
    /// The baseline then.
    pub baseline: f64,
    /// The other signal then.
    pub compared: f64,
    /// What was allowed: the largest of the tolerances.
    pub tolerance: f64,
}

impl Deviation {
    /// The other signal less the baseline.
    pub fn difference(&self) -> f64 {
        // Infinities of one sign are the same.
        if self.compared == self.baseline { 0.0 } else { self.compared - self.baseline }
    }
}

/// What a comparison found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Comparison {
    /// First and last instant that both signals have, s; none where they do not overlap.
    pub span: Option<(f64, f64)>,
    /// Instants looked at.
    pub points: u64,
    /// Those of them with a difference beyond the tolerance.
    pub outside: u64,
    /// The first of those.
    pub first: Option<Deviation>,
    /// The maximum difference; one that is not a number beats all others.
    pub maximum: Option<Deviation>,
    /// Root of the mean square of the finite differences, over instants.
    pub rms: f64,
}

impl Comparison {
    /// Whether the signals overlap and differ nowhere by more than is allowed.
    pub fn is_within(&self) -> bool {
        self.points > 0 && self.outside == 0
    }

    /// Whether they do not differ at all.
    pub fn is_same(&self) -> bool {
        self.is_within() && self.maximum.is_some_and(|maximum| maximum.difference() == 0.0)
    }
}

/// Compares two signals at the instants of the rule, within what they both cover.
///
/// At each instant the tolerance is `max(absolute, relative * |baseline|, range * (max - min of the baseline))`; with a time tolerance the signal must lie
/// between the minimum and the maximum, widened by their tolerances, that the baseline has within that time. Where
/// both are NaN or the same infinity they agree; where only one is, they do not. Of a jump both values are compared,
/// unless values are held.
pub fn compare(baseline: Series, other: Series, rule: &Rule) -> Comparison {
    let mut found = Comparison::default();
    let rule = &rule.over(&baseline);
    let (Some(a), Some(b)) = (baseline.span(), other.span()) else { return found };
    let (from, to) = (a.0.max(b.0), a.1.min(b.1));
    let slack = SAME_TIME * (to - from).abs();
    if from > to + slack {
        return found;
    }
    found.span = Some((from, to.max(from)));
    let mut window = (rule.time > 0.0).then(|| Window::new(baseline, rule.interpolation, rule.time, slack));
    let mut squares = (0.0, 0_u64);
    let mut last = f64::NEG_INFINITY;
    // What is looked at around an instant changes also between rows: just behind the instant at which a value of the baseline is left out, and
    // just before one at which a value is added.
    let beside = (rule.time > 0.0 && rule.instants == Instants::Union).then_some(rule.time + BESIDE * slack);
    for (t, is_beside) in Times::new(baseline.time, other.time, from, to.max(from), beside) {
        let at = |series: &Series| series.at(t, rule.interpolation, slack);
        let both = || has_value(&baseline, t, slack) && has_value(&other, t, slack);
        // One instant that both have may differ in its last digits.
        if rule.instants == Instants::Intersection && (t - last <= slack || !both()) {
            continue;
        }
        last = t;
        let (Some(base), Some(new)) = (at(&baseline), at(&other)) else { continue };
        let around = window.as_mut().and_then(|window| window.around(t));
        if is_beside {
            // Counts where it says something new.
            let tolerance = tolerance(base.0, rule);
            let deviation = Deviation { time: t, baseline: base.0, compared: new.0, tolerance };
            if allowed(&deviation, size(&deviation), around, rule) {
                continue;
            }
        }
        found.points += 1;
        let mut is_outside = false;
        // Once where nothing jumps.
        let sides = if base.0 == base.1 && new.0 == new.1 { 1 } else { 2 };
        let ends = [(base.0, new.0), (base.1, new.1)].into_iter().rev().take(sides);
        let passed = match rule.interpolation {
            Interpolation::Hold => [&[][..]; 2],
            Interpolation::Linear | Interpolation::Smooth => [baseline.passed(t), other.passed(t)],
        };
        for (baseline, compared) in ends.chain(within(passed, base, new)) {
            let tolerance = tolerance(baseline, rule);
            let deviation = Deviation { time: t, baseline, compared, tolerance };
            let size = size(&deviation);
            if size.is_finite() {
                squares = (squares.0 + size * size, squares.1 + 1);
            }
            // `NaN` as a size means that one of both is not a number.
            if found.maximum.is_none_or(|maximum| ranked(size) > ranked(self::size(&maximum))) {
                found.maximum = Some(deviation);
            }
            if !allowed(&deviation, size, around, rule) {
                is_outside = true;
                found.first.get_or_insert(deviation);
            }
        }
        found.outside += u64::from(is_outside);
    }
    found.rms = if squares.1 > 0 { (squares.0 / squares.1 as f64).sqrt() } else { 0.0 };
    found
}

/// Values that one of two signals has for no time at all, between those that it comes from and goes to, each beside the nearest that the
/// other has meanwhile.
fn within(
    passed: [&[f64]; 2],
    base: (f64, f64),
    new: (f64, f64),
) -> impl Iterator<Item = (f64, f64)> + use<'_> {
    let range = |ends: (f64, f64), passed: &[f64]| {
        let all = passed.iter().copied().chain([ends.0, ends.1]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (of_base, of_new) = (range(base, passed[0]), range(new, passed[1]));
    let nearest = |x: f64, (low, high): (f64, f64)| x.min(high).max(low);
    let bases = passed[0].iter().map(move |x| (*x, nearest(*x, of_new)));
    bases.chain(passed[1].iter().map(move |x| (nearest(*x, of_base), *x)))
}

/// Whether a signal has a value at a time, but for rounding.
fn has_value(series: &Series, t: f64, slack: f64) -> bool {
    let next = series.time.partition_point(|&x| x < t - slack);
    series.time.get(next).is_some_and(|&x| x <= t + slack)
}

fn tolerance(baseline: f64, rule: &Rule) -> f64 {
    let relative = rule.relative * baseline.abs();
    if relative.is_finite() { rule.absolute.max(relative) } else { rule.absolute }
}

/// Size of a difference; 0 where both are NaN, NaN where one is.
fn size(deviation: &Deviation) -> f64 {
    if deviation.baseline.is_nan() && deviation.compared.is_nan() {
        0.0
    } else {
        deviation.difference().abs()
    }
}

fn ranked(size: f64) -> f64 {
    if size.is_nan() { f64::INFINITY } else { size }
}

fn allowed(deviation: &Deviation, size: f64, around: Option<(f64, f64)>, rule: &Rule) -> bool {
    if size <= deviation.tolerance {
        return true;
    }
    let Some((low, high)) = around else { return false };
    let within = |x: f64| x >= low - tolerance(low, rule) && x <= high + tolerance(high, rule);
    within(deviation.compared)
}

/// Times at which two signals are compared, within a range in order, each once.
struct Times<'a> {
    /// Times of the baseline, of the other signal, and those of the baseline moved to where they enter or leave a window around an instant.
    lists: [(&'a [f64], f64); 4],
    next: [usize; 4],
    to: f64,
    last: f64,
    ends: [Option<f64>; 2],
}

impl<'a> Times<'a> {
    /// `beside`: half of the width of the window, if there is one.
    fn new(baseline: &'a [f64], other: &'a [f64], from: f64, to: f64, beside: Option<f64>) -> Times<'a> {
        let (moved, by) = beside.map_or((&[][..], 0.0), |by| (baseline, by));
        let lists = [(baseline, 0.0), (other, 0.0), (moved, by), (moved, -by)];
        let next = lists.map(|(list, by)| list.partition_point(|&t| t + by < from));
        Times { lists, next, to, last: f64::NEG_INFINITY, ends: [Some(from), Some(to)] }
    }
}

impl Iterator for Times<'_> {
    /// A time, and whether neither signal has a row there.
    type Item = (f64, bool);

    fn next(&mut self) -> Option<(f64, bool)> {
        if let Some(from) = self.ends[0].take() {
            self.last = from;
            return Some((from, false));
        }
        loop {
            let head = |n: usize| {
                let (list, by) = self.lists[n];
                list.get(self.next[n]).map_or(f64::INFINITY, |t| t + by)
            };
            let heads = [0, 1, 2, 3].map(head);
            // Of equal ones the first.
            let n = (1..4).fold(0, |best, n| if heads[n] < heads[best] { n } else { best });
            let t = heads[n];
            if t >= self.to {
                let end = self.ends[1].take()?;
                return (end > self.last).then_some((end, false));
            }
            self.next[n] += 1;
            if t > self.last {
                self.last = t;
                return Some((t, n > 1));
            }
        }
    }
}

#[cfg(test)]
#[path = "compare_tests.rs"]
mod tests;
