//! How well a signal follows its set value.

use crate::series::Series;
use crate::smooth::refine;

/// Bounds of the rise, and of the band in which a signal has settled; shares of the step.
const RISE: (f64, f64) = (0.1, 0.9);
const BAND: f64 = 0.02;
/// A response that has stayed in the band for so many times as long as it took to get there is at rest; what drives it out
/// of the band after that is not the step.
const REST: f64 = 1.0;
/// Part of the time of rest in which a disturbance goes at least the second half of its way to the edge of the band. What takes longer
/// is a slow part of the response itself, on its way there all the time.
const SUDDEN: f64 = 0.25;
/// Share of the time, at its end, over which the remaining error is averaged.
const END: f64 = 0.02;

/// The numbers of a step response or of a move. Times are from when the set value begins to change; the step is the
/// way from the actual value at that instant to the last set value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metrics {
    /// When the set value begins to change, s.
    pub begin: f64,
    /// The step, in the unit of the signal.
    pub step: f64,
    /// Time from 10 % to 90 % of the step, s; none without a step or where it does not come so far.
    pub rise: Option<f64>,
    /// How far the signal goes beyond the last set value, share of the step; none without a step.
    pub overshoot: Option<f64>,
    /// Time after which the signal stays within 2 % of the step around the last set value, s; none without a step or
    /// where it is outside at the end.
    pub settling: Option<f64>,
    /// When something else, such as a load, has driven the signal out of the band after it had come to rest there, s. Rise,
    /// overshoot and settling are those of the time before. None without a step or where nothing has.
    pub disturbed: Option<f64>,
    /// Integral of the absolute error, unit times s.
    pub iae: f64,
    /// Integral of the squared error, squared unit times s.
    pub ise: f64,
    /// Mean error, set less actual, over the last 2 % of the time.
    pub steady_state_error: f64,
    /// Maximum absolute error.
    pub max_error: f64,
    /// When that was, s.
    pub max_error_at: f64,
}

/// Numbers of how `actual` follows `set`, which have the same times. Between their values signals follow a cubic where they are
/// smooth and are straight elsewhere. Rows with a value that is not finite are left out; `None` where fewer than two are left.
///
/// Without a `set` the signal is taken as the answer to a step, at its first instant, to its own last value.
pub fn metrics(time: &[f64], set: Option<&[f64]>, actual: &[f64]) -> Option<Metrics> {
    let last = *actual.iter().rfind(|x| x.is_finite())?;
    let rows: Vec<(f64, [f64; 2])> = time
        .iter()
        .zip(actual)
        .enumerate()
        .filter_map(|(n, (&t, &y))| Some((t, [set.map_or(Some(last), |set| set.get(n).copied())?, y])))
        .filter(|(t, [set, y])| t.is_finite() && set.is_finite() && y.is_finite())
        .collect();
    let rows: Vec<Row> = refine(&rows).into_iter().map(|(t, [set, y])| Row { t, set, y }).collect();
    let (first, end) = (*rows.first()?, *rows.last()?);
    if rows.len() < 2 {
        return None;
    }
    // The last row before the set value changes; a constant one was set at the beginning.
    let changes = rows.iter().position(|row| row.set != first.set).map_or(0, |at| at.saturating_sub(1));
    let begin = rows[changes];
    let step = end.set - begin.y;
    let scale = rows.iter().fold(0.0_f64, |a, row| a.max(row.y.abs()).max(row.set.abs()));
    let is_step = step.abs() > 1e-9 * scale;
    let after = &rows[changes..];
    let share = |row: &Row| (row.y - begin.y) / step;
    let disturbance = if is_step { disturbance(after, share) } else { None };
    let disturbed = disturbance.map(|at| after[at].t);
    let response = &after[..disturbance.unwrap_or(after.len())];
    let maximum =
        rows.iter().fold(first, |a, row| if row.error().abs() > a.error().abs() { *row } else { a });
    Some(Metrics {
        begin: begin.t,
        step,
        rise: if is_step { rise(response, share) } else { None },
        overshoot: is_step.then(|| (response.iter().map(share).fold(1.0, f64::max)) - 1.0),
        settling: if is_step { settled(response, share).map(|t| t - begin.t) } else { None },
        disturbed,
        iae: sum(&rows, absolute),
        ise: sum(&rows, |a, b| (a * a + a * b + b * b) / 3.0),
        steady_state_error: remaining(&rows),
        max_error: maximum.error().abs(),
        max_error_at: maximum.t,
    })
}

#[derive(Debug, Clone, Copy)]
struct Row {
    t: f64,
    set: f64,
    y: f64,
}

impl Row {
    fn error(&self) -> f64 {
        self.set - self.y
    }
}

/// Instant at which the share passes `level` between two rows.
fn crossing(rows: &[Row], share: impl Fn(&Row) -> f64, level: f64) -> f64 {
    let (a, b) = (share(&rows[0]), share(&rows[1]));
    let part = if b == a { 0.0 } else { (level - a) / (b - a) };
    rows[0].t + part.clamp(0.0, 1.0) * (rows[1].t - rows[0].t)
}

fn rise(rows: &[Row], share: impl Fn(&Row) -> f64 + Copy) -> Option<f64> {
    let reaches = |level: f64| {
        let at = rows.iter().position(|row| share(row) >= level)?;
        Some(if at == 0 { rows[0].t } else { crossing(&rows[at - 1..=at], share, level) })
    };
    Some(reaches(RISE.1)? - reaches(RISE.0)?)
}

/// The first row outside the band behind a time of rest, with the set value in the band for good, too.
fn disturbance(rows: &[Row], share: impl Fn(&Row) -> f64 + Copy) -> Option<usize> {
    let begin = rows.first()?.t;
    let is_on_its_way = |row: &Row| (share(&Row { y: row.set, ..*row }) - 1.0).abs() > BAND;
    let set = rows.iter().rposition(is_on_its_way).map_or(0, |at| at + 1);
    let mut entered = None;
    for (at, row) in rows.iter().enumerate().skip(set) {
        if (share(row) - 1.0).abs() <= BAND {
            entered.get_or_insert(at);
        } else if let Some(first) = entered.take() {
            let since = rows[first].t;
            let rest = rows[at - 1].t - since;
            if since > begin && rest >= REST * (since - begin) && is_sudden(&rows[first..at], share, row) {
                return Some(at);
            }
        }
    }
    None
}

/// Whether what was at rest goes out of the band, in the row `out`, all at once.
fn is_sudden(rest: &[Row], share: impl Fn(&Row) -> f64, out: &Row) -> bool {
    let [Row { t: begin, .. }, .., Row { t: end, .. }] = *rest else { return true };
    // Where it rested: the mean over the first half of that time.
    let mut area = (0.0, 0.0);
    for pair in rest.windows(2).take_while(|pair| pair[0].t < begin + 0.5 * (end - begin)) {
        let long = pair[1].t - pair[0].t;
        area = (area.0 + long, area.1 + 0.5 * long * (share(&pair[0]) + share(&pair[1])));
    }
    let level = if area.0 > 0.0 { area.1 / area.0 } else { share(&rest[0]) };
    let edge = if share(out) > 1.0 { 1.0 + BAND } else { 1.0 - BAND };
    let is_near = |row: &&Row| (share(row) - level) / (edge - level) <= 0.5;
    let left = rest.iter().rfind(is_near).map_or(begin, |row| row.t);
    end - left <= SUDDEN * (end - begin)
}

/// Instant from which on the share stays within the band around 1.
fn settled(rows: &[Row], share: impl Fn(&Row) -> f64 + Copy) -> Option<f64> {
    let outside = |row: &Row| (share(row) - 1.0).abs() > BAND;
    let Some(at) = rows.iter().rposition(outside) else { return Some(rows[0].t) };
    if at + 1 == rows.len() {
        return None;
    }
    let level = if share(&rows[at]) > 1.0 { 1.0 + BAND } else { 1.0 - BAND };
    Some(crossing(&rows[at..=at + 1], share, level))
}

/// Mean of the absolute value of what goes straight from `a` to `b`.
fn absolute(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 { (a.abs() + b.abs()) / 2.0 } else { (a * a + b * b) / (2.0 * (a - b).abs()) }
}

/// Integral over time of what `mean` makes of the errors at both ends of a stretch.
fn sum(rows: &[Row], mean: impl Fn(f64, f64) -> f64) -> f64 {
    rows.windows(2).map(|w| (w[1].t - w[0].t) * mean(w[0].error(), w[1].error())).sum()
}

/// Mean error over the end of the time.
fn remaining(rows: &[Row]) -> f64 {
    let (first, end) = (rows[0], rows[rows.len() - 1]);
    let from = end.t - END * (end.t - first.t);
    let times: Vec<f64> = rows.iter().map(|row| row.t).collect();
    let errors: Vec<f64> = rows.iter().map(Row::error).collect();
    let Some((_, start)) = Series::new(&times, &errors).at(from, crate::Interpolation::Linear, 0.0) else {
        return end.error();
    };
    let begin = times.partition_point(|&t| t <= from);
    let points = std::iter::once((from, start))
        .chain(times[begin..].iter().copied().zip(errors[begin..].iter().copied()));
    let points: Vec<(f64, f64)> = points.collect();
    let area: f64 = points.windows(2).map(|w| (w[1].0 - w[0].0) * (w[0].1 + w[1].1) / 2.0).sum();
    if end.t > from { area / (end.t - from) } else { end.error() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Answer of a signal to a step of height `h` at t = 1 s, over `end` s in steps of 0.1 ms, and the set value.
    fn response(h: f64, end: f64, y: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let n = (end / 1e-4) as u32;
        let mut time: Vec<f64> = (0..=10_000).map(|k| f64::from(k) * 1e-4).collect();
        let mut set = vec![2.0; time.len()];
        let mut actual = set.clone();
        for k in 0..=n {
            let t = f64::from(k) * 1e-4;
            time.push(1.0 + t);
            set.push(2.0 + h);
            actual.push(2.0 + h * y(t));
        }
        (time, set, actual)
    }

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    #[test]
    fn a_first_order_lag_has_its_closed_form_numbers() {
        // y = 1 - exp(-t / tau): rise tau ln 9, settling tau ln 50, IAE h tau, ISE h^2 tau / 2, no overshoot.
        for (tau, h) in [(0.1, 3.0), (0.3, -0.5)] {
            let (time, set, actual) = response(h, 30.0 * tau, |t| 1.0 - (-t / tau).exp());
            let m = metrics(&time, Some(&set), &actual).unwrap();
            near(m.begin, 1.0, 1e-12);
            near(m.step, h, 1e-12);
            near(m.rise.unwrap(), tau * 9_f64.ln(), 1e-6);
            near(m.settling.unwrap(), tau * 50_f64.ln(), 1e-6);
            near(m.overshoot.unwrap(), 0.0, 1e-12);
            near(m.iae, h.abs() * tau, 1e-6);
            near(m.ise, h * h * tau / 2.0, 1e-6);
            near(m.steady_state_error, 0.0, 1e-9);
            near(m.max_error, h.abs(), 1e-12);
            near(m.max_error_at, 1.0, 1e-12);
        }
    }

    /// Unit step response of `w^2 / (s^2 + 2 d w s + w^2)` for d < 1.
    fn second_order(w: f64, d: f64, t: f64) -> f64 {
        let root = (1.0 - d * d).sqrt();
        1.0 - (-d * w * t).exp() / root * (w * root * t + d.acos()).sin()
    }

    /// Zero of `f` between `a` and `b`, where it changes sign, by halving.
    fn zero(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
        for _ in 0..100 {
            let middle = (a + b) / 2.0;
            if (f(a) > 0.0) == (f(middle) > 0.0) { a = middle } else { b = middle }
        }
        a
    }

    #[test]
    fn a_second_order_system_has_its_closed_form_numbers() {
        for (w, d) in [(10.0, 0.3), (5.0, 0.5), (20.0, 0.7)] {
            let h = 60.0;
            let y = |t: f64| second_order(w, d, t);
            let (time, set, actual) = response(h, 20.0 / (d * w), y);
            let m = metrics(&time, Some(&set), &actual).unwrap();
            let root = (1.0 - d * d).sqrt();
            let peak = PI / (w * root);
            // Ogata, Modern Control Engineering, section 5-3.
            near(m.overshoot.unwrap(), (-d * PI / root).exp(), 1e-6);
            near(m.rise.unwrap(), zero(|t| y(t) - 0.9, 0.0, peak) - zero(|t| y(t) - 0.1, 0.0, peak), 1e-6);
            // Integral of the squared error of this system: (1 + 4 d^2) / (4 d w).
            near(m.ise, h * h * (1.0 + 4.0 * d * d) / (4.0 * d * w), 1e-3);
            // Each half wave between crossings of 1 adds its area; the error is -exp(-d w t) sin(..) / root.
            let primitive = |t: f64| {
                let (a, b, phase) = (d * w, w * root, d.acos());
                -(-a * t).exp() * (a * (b * t + phase).sin() + b * (b * t + phase).cos())
                    / (root * (a * a + b * b))
            };
            let crossing = |n: i32| (f64::from(n) * PI - d.acos()) / (w * root);
            let mut iae = primitive(crossing(1)) - primitive(0.0);
            for n in 1..60 {
                iae += (primitive(crossing(n + 1)) - primitive(crossing(n))).abs();
            }
            near(m.iae, h * iae, 1e-3);
            // The last time the answer leaves the band lies before an extreme of size below 2 %.
            let extreme = |n: i32| f64::from(n) * peak;
            let n = (1..).find(|&n| (y(extreme(n)) - 1.0).abs() < BAND).unwrap();
            let side = (y(extreme(n - 1)) - 1.0).signum();
            let expected = zero(|t| (y(t) - 1.0) * side - BAND, extreme(n - 1), crossing(n));
            near(m.settling.unwrap(), expected, 1e-5);
        }
    }

    #[test]
    fn a_remaining_error_is_that_of_the_end() {
        // A lag of gain 0.95 settles 5 % below and never comes into the band.
        let (time, set, actual) = response(1.0, 5.0, |t| 0.95 * (1.0 - (-t / 0.1).exp()));
        let m = metrics(&time, Some(&set), &actual).unwrap();
        near(m.steady_state_error, 0.05, 1e-9);
        assert_eq!(m.settling, None);
        assert!(m.rise.is_some());
    }

    #[test]
    fn a_load_step_does_not_spoil_the_numbers_of_the_response_before_it() {
        // A lag of 0.1 s; after 2 s a load takes 30 % away, which a slower lag makes good.
        let load = |t: f64| if t < 2.0 { 0.0 } else { 0.3 * ((2.0 - t) / 0.4).exp() };
        let y = |t: f64| 1.0 - (-t / 0.1_f64).exp();
        let (time, set, actual) = response(3.0, 5.0, |t| y(t) - load(t));
        let m = metrics(&time, Some(&set), &actual).unwrap();
        near(m.settling.unwrap(), 0.1 * 50_f64.ln(), 1e-6);
        near(m.rise.unwrap(), 0.1 * 9_f64.ln(), 1e-6);
        near(m.overshoot.unwrap(), 0.0, 1e-12);
        near(m.disturbed.unwrap(), 3.0, 1e-3);
        // The errors are those of all the time.
        near(m.iae, 3.0 * (0.1 + 0.3 * 0.4 * (1.0 - (-3.0 / 0.4_f64).exp())), 1e-4);
        // A load that goes the other way is no overshoot.
        let (time, set, actual) = response(3.0, 5.0, |t| y(t) + load(t));
        assert!(metrics(&time, Some(&set), &actual).unwrap().overshoot.unwrap() < 1e-9);
        // A set value that only creeps to its end, as behind a filter, makes no difference.
        let creeping: Vec<f64> =
            time.iter().map(|t| if *t < 1.0 { 2.0 } else { 5.0 - 3.0 * ((1.0 - t) / 0.1).exp() }).collect();
        let m = metrics(&time, Some(&creeping), &actual).unwrap();
        near(m.disturbed.unwrap(), 3.0, 1e-3);
        // One that comes before the response is at rest cannot be told from it.
        let (time, set, actual) =
            response(3.0, 5.0, |t| y(t) - if t < 0.5 { 0.0 } else { 0.3 * ((0.5 - t) / 0.4).exp() });
        let m = metrics(&time, Some(&set), &actual).unwrap();
        assert!(m.disturbed.is_none() && m.settling.unwrap() > 1.0, "{m:?}");
    }

    /// `y = 1 - exp(-t/0.02) + 0.08 t exp(-t/2)`: fast at first, and a slow part that is largest after 2 s.
    #[test]
    fn a_slow_part_of_the_response_is_no_disturbance() {
        let (time, set, actual) =
            response(1.0, 40.0, |t| 1.0 - (-t / 0.02_f64).exp() + 0.08 * t * (-t / 2.0).exp());
        let m = metrics(&time, Some(&set), &actual).unwrap();
        assert_eq!(m.disturbed, None, "{m:?}");
        near(m.overshoot.unwrap(), 0.16 / std::f64::consts::E, 1e-4);
        // Where 0.08 t exp(-t/2) is 0.02 for the second time.
        near(m.settling.unwrap(), 6.523, 1e-2);
    }

    #[test]
    fn an_oscillation_is_no_disturbance() {
        for d in [0.02, 0.05, 0.1, 0.3, 0.6, 0.77] {
            let (time, set, actual) = response(1.0, 8.0 / (d * 10.0), |t| second_order(10.0, d, t));
            assert_eq!(metrics(&time, Some(&set), &actual).unwrap().disturbed, None, "{d}");
        }
    }

    #[test]
    fn without_a_step_the_errors_remain() {
        let time = [0.0, 1.0, 2.0];
        let m = metrics(&time, Some(&[0.0; 3]), &[0.0, 1.0, 0.0]).unwrap();
        assert_eq!((m.rise, m.overshoot, m.settling), (None, None, None));
        assert_eq!((m.iae, m.max_error, m.max_error_at), (1.0, 1.0, 1.0));
        near(m.ise, 2.0 / 3.0, 1e-12);
    }

    #[test]
    fn without_a_set_value_the_last_value_is_the_aim() {
        let time: Vec<f64> = (0..=10_000).map(|k| f64::from(k) * 1e-3).collect();
        let y: Vec<f64> = time.iter().map(|t| 1.0 - (-t).exp()).collect();
        let m = metrics(&time, None, &y).unwrap();
        near(m.rise.unwrap(), 9_f64.ln(), 1e-3);
    }

    #[test]
    fn rows_that_are_no_numbers_are_left_out() {
        let m = metrics(&[0.0, 1.0, 2.0], Some(&[1.0; 3]), &[1.0, f64::NAN, 1.0]).unwrap();
        assert_eq!(m.max_error, 0.0);
        assert_eq!(metrics(&[], Some(&[]), &[]), None);
        assert_eq!(metrics(&[0.0], Some(&[1.0]), &[1.0]), None);
        assert_eq!(metrics(&[0.0, 1.0], Some(&[1.0]), &[f64::NAN; 2]), None);
    }

    #[test]
    fn errors_that_change_sign_have_the_area_of_both_triangles() {
        near(absolute(1.0, -1.0), 0.5, 1e-15);
        near(absolute(3.0, -1.0), (3.0 * 0.75 + 0.25) / 2.0, 1e-15);
        near(absolute(-2.0, -1.0), 1.5, 1e-15);
    }
}
