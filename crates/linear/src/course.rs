//! The answer to a step over time.

use nalgebra::Complex;

use crate::system::held;
use crate::{Channel, Gain, LinearError, Mode, Response, is_stable, modes, poles, static_gain, zeros};

/// Times in s and the output after a step of 1 at the input, from rest, at `count` instants evenly up to `end`, s. Exact at
/// these, by the exponential of the matrix. Of a sampled channel all samples up to `end`, at most `count`.
pub fn step_response(channel: &Channel, end: f64, count: usize) -> Vec<(f64, f64)> {
    let count = count.max(2);
    let (dt, phi, gamma, count) = match channel.period {
        None => {
            let dt = end / (count - 1) as f64;
            let b = nalgebra::DMatrix::from_column_slice(channel.order(), 1, channel.b.as_slice());
            let (phi, gamma) = held(&channel.a, &b, dt);
            (dt, phi, gamma.column(0).into_owned(), count)
        }
        Some(period) => {
            let samples = (end / period).floor().min(count as f64 - 1.0) as usize + 1;
            (period, channel.a.clone(), channel.b.clone(), samples)
        }
    };
    let mut x = nalgebra::DVector::zeros(channel.order());
    let mut points = Vec::with_capacity(count);
    for k in 0..count {
        points.push((k as f64 * dt, (&channel.c * &x)[0] + channel.d));
        x = &phi * &x + &gamma;
    }
    points
}

/// How a step response comes to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepInfo {
    /// From 10 to 90 % of the end, s.
    pub rise: f64,
    /// By how much it goes beyond the end, relative to it.
    pub overshoot: f64,
    /// From when on it stays within 2 % of the end, s.
    pub settling: f64,
}

/// Time constants after which a mode has died out: less than a millionth is left.
const LASTS: f64 = 14.0;
/// Instants in the time in which a mode that is alive turns by a radian or falls to 1/e. Between them the response is a
/// cubic, which errs by 1e-6 of the mode at most.
const DENSE: f64 = 12.0;
/// Most instants.
const MOST: usize = 2_000_000;

/// How the step response of a [`minimal`](crate::minimal) and stable channel comes to its end: by its values and slopes from
/// partial fractions, or the exponential of the matrix, at instants as close as the fastest mode that is alive asks for. `None` if
/// it comes to no end, the end is zero, or there are too many instants, as little damped modes that are fast stand beside
/// slow ones.
///
/// # Errors
/// [`LinearError`] of the eigenvalues.
pub fn step_info(channel: &Channel) -> Result<Option<StepInfo>, LinearError> {
    let poles = poles(&channel.a)?;
    let Gain::Finite(end) = static_gain(channel, &poles) else { return Ok(None) };
    if end == 0.0 || poles.is_empty() || !is_stable(&poles, channel.period) {
        return Ok(None);
    }
    let modes = modes(&poles, channel.period);
    let curve = match channel.period {
        Some(period) => {
            let slowest = modes.iter().map(|mode| mode.time_constant).fold(0.0, f64::max);
            let count = (LASTS * slowest / period).ceil() + 2.0;
            if count > MOST as f64 {
                return Ok(None);
            }
            let points = step_response(channel, count * period, count as usize);
            points.into_iter().map(|(t, y)| Point { t, y: y / end, slope: None }).collect()
        }
        None => match curve(channel, &modes, end) {
            Some(curve) => curve,
            None => return Ok(None),
        },
    };
    Ok(info(&curve))
}

/// A point of a step response, relative to its end.
#[derive(Debug, Clone, Copy)]
struct Point {
    t: f64,
    y: f64,
    /// In continuous time, 1/s.
    slope: Option<f64>,
}

/// The step response until its slowest mode has died out; none if that takes too many instants.
fn curve(channel: &Channel, modes: &[Mode], end: f64) -> Option<Vec<Point>> {
    let a = &channel.a;
    let b = nalgebra::DMatrix::from_column_slice(channel.order(), 1, channel.b.as_slice());
    let parts = fractions(channel, modes, end);
    // Until when each mode lives, and how close the instants are until then; the fastest to die first.
    let mut lives: Vec<(f64, f64)> =
        modes.iter().map(|mode| (LASTS * mode.time_constant, 1.0 / (DENSE * mode.frequency))).collect();
    lives.sort_by(|a, b| a.0.total_cmp(&b.0));
    for n in (1..lives.len()).rev() {
        lives[n - 1].1 = lives[n - 1].1.min(lives[n].1);
    }
    let mut x = nalgebra::DVector::zeros(channel.order());
    let mut from = 0.0;
    let mut points = Vec::new();
    let point = |t: f64, x: &nalgebra::DVector<f64>| Point {
        t,
        y: ((&channel.c * x)[0] + channel.d) / end,
        slope: Some((&channel.c * (a * x + &channel.b))[0] / end),
    };
    points.push(point(0.0, &x));
    for (to, spacing) in lives {
        let count = ((to - from) / spacing).ceil();
        if count < 1.0 {
            continue;
        }
        if points.len() as f64 + count > MOST as f64 {
            return None;
        }
        let dt = (to - from) / count;
        if let Some(parts) = &parts {
            points.extend((1..=count as usize).map(|k| of_parts(parts, from + k as f64 * dt)));
            from = to;
            continue;
        }
        let (phi, gamma) = held(a, &b, dt);
        for k in 1..=count as usize {
            x = &phi * &x + gamma.column(0);
            points.push(point(from + k as f64 * dt, &x));
        }
        from = to;
    }
    Some(points)
}

/// Poles and residues of the step response, relative to its end: `y = 1 + sum r exp(p t)`. Exact however far apart the poles
/// are, where the powers of the exponential of the matrix lose as many digits as they are apart; but none where poles are
/// so close that their residues cancel each other.
fn fractions(channel: &Channel, modes: &[Mode], end: f64) -> Option<Vec<(Complex<f64>, Complex<f64>)>> {
    let zeros = zeros(channel).ok()??;
    let response = Response::new(channel);
    let poles: Vec<Complex<f64>> = modes.iter().map(|mode| mode.pole).collect();
    // Sums of logarithms, as products of many poles leave the range of numbers.
    let factors = |s: Complex<f64>, all: &[Complex<f64>]| -> Complex<f64> {
        all.iter().map(|root| (s - root).ln()).sum()
    };
    let middle = Complex::new(0.0, modes[modes.len() / 2].frequency);
    let gain = (response.at(middle.im) / end).ln() + factors(middle, &poles) - factors(middle, &zeros);
    let residue = |(n, &pole): (usize, &Complex<f64>)| {
        let others: Vec<Complex<f64>> = [&poles[..n], &poles[n + 1..]].concat();
        (pole, (gain + factors(pole, &zeros) - factors(pole, &others)).exp() / pole)
    };
    let parts: Vec<(Complex<f64>, Complex<f64>)> = poles.iter().enumerate().map(residue).collect();
    let sum: Complex<f64> = parts.iter().map(|part| part.1).sum();
    let size: f64 = parts.iter().map(|part| part.1.norm()).sum();
    // At the beginning there is what passes at once.
    let fits = (sum + 1.0 - channel.d / end).norm() <= 1e-8 * (1.0 + size);
    (size <= LARGEST && fits).then_some(parts)
}

/// Largest sum of residues, of which rounding leaves enough digits.
const LARGEST: f64 = 1e5;

fn of_parts(parts: &[(Complex<f64>, Complex<f64>)], t: f64) -> Point {
    let mut point = Point { t, y: 1.0, slope: Some(0.0) };
    for (pole, residue) in parts {
        let now = residue * (pole * t).exp();
        point.y += now.re;
        point.slope = point.slope.map(|slope| slope + (now * pole).re);
    }
    point
}

/// Rise, overshoot and settling of a curve that ends at 1.
fn info(curve: &[Point]) -> Option<StepInfo> {
    let reaches = |level: f64| {
        let at = curve.iter().position(|point| point.y >= level)?;
        Some(if at == 0 { curve[0].t } else { crossing(&curve[at - 1], &curve[at], level) })
    };
    let rise = reaches(0.9)? - reaches(0.1)?;
    let pairs = || curve.windows(2).map(|pair| highest(&pair[0], &pair[1]));
    let overshoot = pairs().fold(1.0, f64::max) - 1.0;
    let outside = |y: f64| (y - 1.0).abs() > BAND;
    let settling = match curve.iter().rposition(|point| outside(point.y)) {
        None => curve[0].t,
        Some(last) if last + 1 == curve.len() => return None,
        Some(last) => {
            let level = if curve[last].y > 1.0 { 1.0 + BAND } else { 1.0 - BAND };
            crossing(&curve[last], &curve[last + 1], level)
        }
    };
    Some(StepInfo { rise, overshoot, settling })
}

/// Share of the end within which a response has settled.
const BAND: f64 = 0.02;

/// Value at the share `s` of the way between two points: a cubic by values and slopes. Of samples the earlier one holds.
fn between(a: &Point, b: &Point, s: f64) -> f64 {
    let (Some(da), Some(db)) = (a.slope, b.slope) else { return if s < 1.0 { a.y } else { b.y } };
    let h = b.t - a.t;
    let rest = 1.0 - s;
    rest * rest * ((1.0 + 2.0 * s) * a.y + s * h * da) + s * s * ((3.0 - 2.0 * s) * b.y - rest * h * db)
}

/// When the curve passes a level between two points on different sides of it.
fn crossing(a: &Point, b: &Point, level: f64) -> f64 {
    if a.slope.is_none() {
        return b.t;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if (between(a, b, middle) >= level) == (a.y >= level) { low = middle } else { high = middle }
    }
    a.t + high * (b.t - a.t)
}

/// The largest value between two points.
fn highest(a: &Point, b: &Point) -> f64 {
    let ends = a.y.max(b.y);
    let (Some(da), Some(db)) = (a.slope, b.slope) else { return ends };
    if !(da > 0.0 && db < 0.0) {
        return ends;
    }
    // The slope of the cubic falls through zero once.
    let (mut low, mut high) = (0.0, 1.0);
    let h = b.t - a.t;
    let slope = |s: f64| {
        let straight = 6.0 * s * (1.0 - s) * (b.y - a.y) / h;
        straight + (1.0 - s) * (1.0 - 3.0 * s) * da + s * (3.0 * s - 2.0) * db
    };
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    ends.max(between(a, b, low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::tests::{transfer, transformed};

    #[test]
    fn steps_of_lags_and_of_oscillations_are_those_of_the_formulas() {
        let lag = transfer(&[2.0], &[0.5, 1.0]);
        for (t, y) in step_response(&lag, 3.0, 31) {
            assert!((y - 2.0 * (1.0 - (-t / 0.5).exp())).abs() < 1e-13, "{y} at {t}");
        }
        let (w, z) = (8.0_f64, 0.25_f64);
        let fast = w * (1.0 - z * z).sqrt();
        let system = transfer(&[w * w], &[1.0, 2.0 * z * w, w * w]);
        for (t, y) in step_response(&transformed(&system, 10.0), 2.0, 201) {
            let exact = 1.0 - (-z * w * t).exp() * ((fast * t).cos() + z * w / fast * (fast * t).sin());
            assert!((y - exact).abs() < 1e-10, "{y} is not {exact} at {t}");
        }
    }

    #[test]
    fn overshoot_and_settling_are_those_of_the_formulas() {
        let (w, z) = (8.0_f64, 0.25_f64);
        let info = step_info(&transfer(&[3.0 * w * w], &[1.0, 2.0 * z * w, w * w])).unwrap().unwrap();
        let overshoot = (-std::f64::consts::PI * z / (1.0 - z * z).sqrt()).exp();
        assert!((info.overshoot - overshoot).abs() < 1e-6, "{info:?}");
        let lag = step_info(&transfer(&[-2.0], &[0.5, 1.0])).unwrap().unwrap();
        assert!((lag.rise - 0.5 * 9.0_f64.ln()).abs() < 1e-6 && lag.overshoot < 1e-9);
        assert!((lag.settling - 0.5 * 50.0_f64.ln()).abs() < 1e-6);
        assert_eq!(step_info(&transfer(&[1.0], &[1.0, 0.0])), Ok(None));
        assert_eq!(step_info(&transfer(&[1.0], &[1.0, -1.0])), Ok(None));
    }

    /// 0.6 of the answer comes with 1 s, 0.4 with `fast`: y = 1 - 0.6 exp(-t) - 0.4 exp(-t / fast).
    #[test]
    fn fast_parts_beside_slow_ones_count() {
        for fast in [1e-3, 1e-6, 1e-9] {
            let (slow, quick) = (1.0, 1.0 / fast);
            let numerator = [0.6 * slow + 0.4 * quick, slow * quick];
            let channel = transfer(&numerator, &[1.0, slow + quick, slow * quick]);
            let info = step_info(&channel).unwrap().unwrap();
            // The fast part alone brings it to 10 %, the slow one to 90 and 98 %.
            let tenth = root(|t| 1.0 - 0.6 * (-t * slow).exp() - 0.4 * (-t * quick).exp() - 0.1, fast);
            assert!((info.rise - (6.0_f64.ln() - tenth)).abs() < 1e-6, "{fast}: {info:?}");
            assert!((info.settling - 30.0_f64.ln()).abs() < 1e-6, "{fast}: {info:?}");
        }
    }

    /// Where a rising function passes zero between 0 and `end`.
    fn root(f: impl Fn(f64) -> f64, end: f64) -> f64 {
        let (mut low, mut high) = (0.0, end);
        for _ in 0..80 {
            let middle = (low + high) / 2.0;
            if f(middle) < 0.0 { low = middle } else { high = middle }
        }
        low
    }

    #[test]
    fn a_fast_ringing_on_a_slow_rise_is_seen() {
        // 1 - exp(-t) and a ringing of 1000 rad/s with a damping of 0.01, whose first peak is at pi / 1000.
        let (w, z) = (1000.0_f64, 0.01_f64);
        let ring = [1.0, 2.0 * z * w, w * w];
        // 0.5 / (s + 1) + 0.5 w^2 / (s^2 + 2 z w s + w^2).
        let numerator = [0.5, z * w + 0.5 * w * w, 0.5 * w * w + 0.5 * w * w];
        let denominator = [1.0, ring[1] + 1.0, ring[2] + ring[1], ring[2]];
        let info = step_info(&transfer(&numerator, &denominator)).unwrap().unwrap();
        let damped = w * (1.0 - z * z).sqrt();
        let y = |t: f64| {
            let ringing = (-z * w * t).exp() * ((damped * t).cos() + z * w / damped * (damped * t).sin());
            1.0 - 0.5 * (-t).exp() - 0.5 * ringing
        };
        let tenth = root(|t| y(t) - 0.1, 1.5e-3);
        let nine = root(|t| y(t) - 0.9, 3e-3);
        assert!((info.rise - (nine - tenth)).abs() < 1e-8, "{info:?} {}", nine - tenth);
    }

    #[test]
    fn a_sampled_channel_has_its_samples() {
        let sum = Channel { period: Some(0.5), ..transfer(&[1.0], &[1.0, -1.0]) };
        assert_eq!(step_response(&sum, 1.6, 100), [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.5, 3.0)]);
    }
}
