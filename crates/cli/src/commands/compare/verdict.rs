//! What is found about each signal.

use blocksim_analysis::{Comparison, Instants, Interpolation, Rule, Series, brought_together, compare};
use blocksim_recording::{ALWAYS, Column};
use blocksim_signal::Unit;

use crate::args::plot::{Between, CompareArgs, Sync};
use crate::failure::Failure;
use crate::signals::display::turn;
use crate::signals::other::other_values;
use crate::signals::traces::{Book, Trace};

/// What is said of a signal.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// No difference at all.
    Same,
    /// Within the tolerances.
    Within,
    /// Somewhere beyond the tolerances.
    Differs,
    /// The other recording covers only this part of the baseline, s.
    Short(f64, f64),
    /// The other recording has no such signal.
    Missing,
    /// It measures something else: its unit.
    OtherUnit(String),
    /// There is nothing to compare: no values, or no common time.
    Nothing,
}

impl Verdict {
    /// Whether the signals agree.
    pub fn agrees(&self) -> bool {
        matches!(self, Verdict::Same | Verdict::Within)
    }

    /// A word for programs.
    pub fn word(&self) -> &'static str {
        match self {
            Verdict::Same => "same",
            Verdict::Within => "within",
            Verdict::Differs => "differs",
            Verdict::Short(..) => "short",
            Verdict::Missing => "missing",
            Verdict::OtherUnit(_) => "other_unit",
            Verdict::Nothing => "nothing",
        }
    }
}

/// A signal of the baseline and what was found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Position in the baseline.
    pub at: usize,
    /// Position in the other recording.
    pub there: Option<usize>,
    /// Unit in which it is told.
    pub unit: Unit,
    /// The verdict.
    pub verdict: Verdict,
    /// Numbers in SI.
    pub comparison: Comparison,
}

/// Tolerances for a signal, in SI.
pub fn rule(args: &CompareArgs, trace: &Trace) -> Rule {
    let own = |dimension| trace.has_unit && dimension == trace.unit.dimension;
    let specific = args.absolute.iter().rev().find(|tolerance| tolerance.dimension.is_some_and(own));
    let absolute =
        specific.or_else(|| args.absolute.iter().rev().find(|tolerance| tolerance.dimension.is_none()));
    Rule {
        absolute: absolute.map_or(0.0, |tolerance| tolerance.value),
        relative: args.relative,
        range: args.range,
        instants: match args.sync {
            Sync::Union => Instants::Union,
            Sync::Intersection => Instants::Intersection,
        },
        time: args.time_tolerance,
        interpolation: match args.interpolation {
            Some(Between::Smooth) => Interpolation::Smooth,
            Some(Between::Linear) => Interpolation::Linear,
            Some(Between::Zoh) => Interpolation::Hold,
            None if trace.held => Interpolation::Hold,
            None => Interpolation::Smooth,
        },
    }
}

/// Compares a signal of the baseline with that of the same path.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn judge(args: &CompareArgs, books: &[Book; 2], at: usize, shift: f64) -> Result<Found, Failure> {
    let trace = &books[0].traces[at];
    let there = books[1].find(&trace.path);
    let mut found = Found {
        at,
        there,
        unit: trace.unit.clone(),
        verdict: Verdict::Missing,
        comparison: Comparison::default(),
    };
    let Some(there) = there else { return Ok(found) };
    let other = &books[1].traces[there];
    if trace.has_unit && other.has_unit && !trace.unit.dimension.compatible(other.unit.dimension) {
        found.verdict = Verdict::OtherUnit(other.unit.to_string());
        return Ok(found);
    }
    let a = books[0].read(at, &ALWAYS)?;
    let b = other_values(&books[1], there, trace, shift)?;
    let (a, b) = without_turns(a, b, trace);
    let (a, b) = (Series::new(&a.time, &a.values), Series::new(&b.time, &b.values));
    found.comparison = compare(a, b, &rule(args, trace));
    found.verdict = match (&found.comparison, short(a, b, args)) {
        (found, _) if found.points == 0 => Verdict::Nothing,
        (found, _) if found.outside > 0 => Verdict::Differs,
        (_, Some((from, to))) if !args.overlap => Verdict::Short(from, to),
        (found, _) if found.is_same() => Verdict::Same,
        _ => Verdict::Within,
    };
    Ok(found)
}

/// Two recordings of a signal in SI; of an angle that jumps by whole turns both go on, so that a turn is no difference.
pub fn without_turns(mut a: Column, mut b: Column, trace: &Trace) -> (Column, Column) {
    let is_angle = trace.has_unit && turn(&trace.unit).is_some();
    let series = (Series::new(&a.time, &a.values), Series::new(&b.time, &b.values));
    if let Some((first, second)) =
        is_angle.then(|| brought_together(series.0, series.1, std::f64::consts::TAU)).flatten()
    {
        (a.values, b.values) = (first, second);
    }
    (a, b)
}

/// What is covered, if that is less than the baseline by more than the time tolerance. Samples at equal distances cover what is left up to
/// the next one, if that would lie beyond the baseline.
fn short(a: Series, b: Series, args: &CompareArgs) -> Option<(f64, f64)> {
    let ((from, to), (begin, end)) = (a.span()?, b.span()?);
    let rounding = 1e-9 * (to - from).abs();
    let room = args.time_tolerance + rounding;
    let grid = even_step(b).map_or(0.0, |step| (step - rounding).max(0.0));
    let is_late = begin > from + room && begin - grid >= from;
    let is_early = end < to - room && end + grid <= to;
    (is_late || is_early).then_some((from.max(begin), to.min(end)))
}

/// The distance of samples that all have the same one.
fn even_step(series: Series) -> Option<f64> {
    let (first, last) = (series.time.first()?, series.time.last()?);
    let steps = series.time.len() - 1;
    let step = (last - first) / steps as f64;
    let is_even = |(k, t): (usize, &f64)| (t - first - k as f64 * step).abs() <= 1e-6 * step;
    (steps > 1 && series.time.iter().enumerate().all(is_even)).then_some(step)
}
