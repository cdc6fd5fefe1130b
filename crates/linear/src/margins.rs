//! How far a loop is from its border of stability.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::{
    Channel, Delayed, Gain, LinearError, Response, frequencies, is_stable, poles, static_gain, zeros,
};

/// Halvings of an interval between two frequencies.
const HALVINGS: usize = 60;
/// Decades above the frequencies of poles and zeros in which a bandwidth is looked for.
const BEYOND: i32 = 40;
/// Part of the size of the fastest pole by which rounding moves one across the border of stability.
const BORDER: f64 = 1e-14;

/// A margin and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// A factor, rad or s.
    pub value: f64,
    /// rad/s.
    pub frequency: f64,
}

/// Margins of the loop that a negative feedback of 1 closes around a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Margins {
    /// Factors by which the gain may change until the loop is at its border, by frequency: where the phase is -180 degrees.
    pub gain: Vec<Margin>,
    /// By how much the phase may fall until then, rad within -pi and pi, by frequency: where the gain is 1.
    pub phase: Vec<Margin>,
    /// Delay that the loop may have besides, s; none if its gain is nowhere 1 or it is unstable anyway.
    pub delay: Option<Margin>,
    /// The largest factor by which the loop amplifies disturbances at its output, `sup |1 / (1 + L)|`; at an infinite frequency where it
    /// comes ever closer to it.
    pub sensitivity: Margin,
    /// Poles of the closed loop; nothing where a dead time makes infinitely many of them.
    pub closed: Vec<Complex<f64>>,
    /// How many of infinitely many poles grow; nothing where they are known, or infinitely many do.
    pub growing: Option<usize>,
    /// Whether all of them die out.
    pub stable: bool,
}

impl Margins {
    /// The gain margin that is nearest to 1.
    pub fn least_gain(&self) -> Option<Margin> {
        self.gain.iter().copied().min_by(|a, b| a.value.ln().abs().total_cmp(&b.value.ln().abs()))
    }

    /// The phase margin that is nearest to zero.
    pub fn least_phase(&self) -> Option<Margin> {
        self.phase.iter().copied().min_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
    }
}

/// The margins of a loop gain `L`, which is [`minimal`](crate::minimal), with the poles and zeros of `L`.
///
/// # Errors
/// [`LinearError`] of the eigenvalues; [`LinearError::Shape`] if the loop has no solution, as its gain is -1 at once.
pub fn margins(channel: &Channel) -> Result<Margins, LinearError> {
    let closed = channel.closed().ok_or_else(|| {
        LinearError::Shape("the loop passes -1 at once, so that it has no solution when closed".to_owned())
    })?;
    let open_poles = poles(&channel.a)?;
    let closed = poles(&closed.a)?;
    let stable = is_stable(&closed, channel.period)
        && !closed.iter().any(|pole| is_at_border(*pole, &closed, channel.period));
    let zeros = zeros(channel)?.unwrap_or_default();
    // Closed poles, too: the peak of the sensitivity is at them.
    let all: Vec<Complex<f64>> = open_poles.iter().chain(&closed).copied().collect();
    let grid = frequencies(&all, &zeros, channel.period);
    let response = Response::new(channel);
    let rest = static_gain(channel, &open_poles);
    Ok(of_response(
        |w| response.at(w),
        &grid,
        Ends { rest, through: channel.period.is_none().then_some(channel.d), fast: None },
        channel.period,
        Closed { poles: closed, growing: None, stable },
    ))
}

/// The margins of a loop gain with dead times in it.
///
/// # Errors
/// [`LinearError`] of the eigenvalues; [`LinearError::Shape`] if the loop has no solution, as its gain is -1 at once, if it is at its
/// border of stability, or if its stability cannot be decided.
pub fn margins_delayed(delayed: &Delayed) -> Result<Margins, LinearError> {
    let closed = delayed.closed().ok_or_else(|| {
        LinearError::Shape("the loop passes -1 at once, so that it has no solution when closed".to_owned())
    })?;
    let growing = closed.unstable()?;
    let grid = delayed.frequencies()?;
    let rest = delayed.static_gain()?;
    let closed = Closed { poles: Vec::new(), stable: growing == Some(0), growing };
    let ends = Ends { rest, through: None, fast: delayed.fast_sensitivity() };
    Ok(of_response(|w| delayed.at(w), &grid, ends, None, closed))
}

/// Whether rounding decides on which side of the border of stability a pole lies.
pub fn is_at_border(pole: Complex<f64>, all: &[Complex<f64>], period: Option<f64>) -> bool {
    match period {
        None => pole.re.abs() <= BORDER * all.iter().map(|pole| pole.norm()).fold(0.0, f64::max),
        Some(_) => (pole.norm() - 1.0).abs() <= BORDER,
    }
}

/// What is known of the closed loop.
struct Closed {
    poles: Vec<Complex<f64>>,
    growing: Option<usize>,
    stable: bool,
}

/// What is known of a loop beyond the frequencies that are looked at.
struct Ends {
    rest: Gain,
    /// Gain at an infinite frequency.
    through: Option<f64>,
    /// Largest sensitivity at high frequencies, where it does not follow from that.
    fast: Option<f64>,
}

/// The margins of a response, over frequencies between which nothing happens.
fn of_response(
    at: impl Fn(f64) -> Complex<f64>,
    grid: &[f64],
    Ends { rest, through, fast }: Ends,
    period: Option<f64>,
    closed: Closed,
) -> Margins {
    let values: Vec<Complex<f64>> = grid.iter().map(|&w| at(w)).collect();
    let mut gain = Vec::new();
    let mut phase = Vec::new();
    if let Gain::Finite(rest) = rest
        && rest < 0.0
    {
        gain.push(Margin { value: -1.0 / rest, frequency: 0.0 });
    }
    for (n, pair) in values.windows(2).enumerate() {
        let ends = (grid[n], grid[n + 1]);
        if (pair[0].norm() > 1.0) != (pair[1].norm() > 1.0) {
            let frequency = halved(ends, |w| at(w).norm() > 1.0);
            // From -pi to pi: the phase of L beyond -180 degrees.
            let value = wrapped(at(frequency).arg() - PI);
            phase.push(Margin { value, frequency });
        }
        if (pair[0].im > 0.0) != (pair[1].im > 0.0) {
            let frequency = halved(ends, |w| at(w).im > 0.0);
            let l = at(frequency);
            // At a pole on the axis the sign changes through infinity.
            if l.re < 0.0 && l.im.abs() < 1e-6 * l.re.abs() {
                gain.push(Margin { value: -1.0 / l.re, frequency });
            }
        }
    }
    // At half of the rate L is real.
    if let (Some(period), Some(last)) = (period, values.last())
        && last.re < 0.0
        && gain.last().is_none_or(|margin| margin.frequency < (1.0 - 1e-9) * PI / period)
    {
        gain.push(Margin { value: -1.0 / last.re, frequency: PI / period });
    }
    if let Some(through) = through.filter(|through| *through < 0.0) {
        gain.push(Margin { value: -1.0 / through, frequency: f64::INFINITY });
    }
    let delays = phase.iter().map(|margin: &Margin| Margin {
        value: margin.value.rem_euclid(TAU) / margin.frequency,
        frequency: margin.frequency,
    });
    // What comes back at once and undiminished grows by any delay.
    let at_once = through.filter(|through| through.abs() >= 1.0);
    let at_once = at_once.map(|_| Margin { value: 0.0, frequency: f64::INFINITY });
    let delay = delays.chain(at_once).min_by(|a, b| a.value.total_cmp(&b.value)).filter(|_| closed.stable);
    let mut sensitivity = peak(grid, |w| 1.0 / (1.0 + at(w)).norm());
    let slow = match rest {
        Gain::Finite(rest) => Some(1.0 / (1.0 + rest).abs()),
        Gain::Infinite => None,
    };
    let fast = fast.or(through.map(|through| 1.0 / (1.0 + through).abs()));
    for (limit, frequency) in [(slow, 0.0), (fast, f64::INFINITY)] {
        if let Some(value) = limit.filter(|limit| *limit > sensitivity.value) {
            sensitivity = Margin { value, frequency };
        }
    }
    let Closed { poles, growing, stable } = closed;
    Margins { gain, phase, delay, sensitivity, closed: poles, growing, stable }
}

/// The lowest frequency, rad/s, at which a [`minimal`](crate::minimal) channel has lost 3 dB (a factor of the root of 2) against rest. None if it
/// integrates, differentiates, or never loses them.
///
/// # Errors
/// [`LinearError`] of the eigenvalues.
pub fn bandwidth(channel: &Channel) -> Result<Option<f64>, LinearError> {
    let poles = poles(&channel.a)?;
    let Gain::Finite(rest) = static_gain(channel, &poles) else { return Ok(None) };
    let border = rest.abs() / 2.0_f64.sqrt();
    if border == 0.0 {
        return Ok(None);
    }
    let zeros = zeros(channel)?.unwrap_or_default();
    let mut grid = frequencies(&poles, &zeros, channel.period);
    let response = Response::new(channel);
    let passes = |w: f64| response.at(w).norm() > border;
    // A zero among the poles carries it far beyond them.
    if channel.period.is_none() && channel.d.abs() < border {
        let beyond = (0..BEYOND).map(|k| grid[grid.len() - 1] * 10_f64.powi(k + 1));
        let beyond: Vec<f64> = beyond.take_while(|w| passes(*w / 10.0)).collect();
        grid.extend(beyond);
    }
    Ok(lost(&grid, passes))
}

/// The same of a system with dead times in it.
///
/// # Errors
/// [`LinearError`] of the eigenvalues.
pub fn bandwidth_delayed(delayed: &Delayed) -> Result<Option<f64>, LinearError> {
    let Gain::Finite(rest) = delayed.static_gain()? else { return Ok(None) };
    let border = rest.abs() / 2.0_f64.sqrt();
    if border == 0.0 {
        return Ok(None);
    }
    Ok(lost(&delayed.frequencies()?, |w| delayed.at(w).norm() > border))
}

/// The first frequency from which on something no longer passes.
fn lost(grid: &[f64], passes: impl Fn(f64) -> bool) -> Option<f64> {
    let found = grid.windows(2).find(|pair| passes(pair[0]) && !passes(pair[1]));
    found.map(|pair| halved((pair[0], pair[1]), passes))
}

/// Where something changes between two frequencies.
fn halved((mut low, mut high): (f64, f64), is: impl Fn(f64) -> bool) -> f64 {
    let first = is(low);
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if is(middle) == first { low = middle } else { high = middle }
    }
    (low * high).sqrt()
}

/// The largest value over a grid, between its points as well.
fn peak(grid: &[f64], of: impl Fn(f64) -> f64) -> Margin {
    let values: Vec<f64> = grid.iter().map(|&w| of(w)).collect();
    let best = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(n, _)| n);
    let mut low = grid[best.saturating_sub(1)];
    let mut high = grid[(best + 1).min(grid.len() - 1)];
    for _ in 0..HALVINGS {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if of(left) < of(right) { low = left } else { high = right }
    }
    let between = Margin { value: of(low), frequency: low };
    if between.value > values[best] { between } else { Margin { value: values[best], frequency: grid[best] } }
}

/// An angle within -pi and pi.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::tests::transfer;
    use crate::{StateSpace, minimal};

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-6 * b.abs().max(1e-3), "{a} is not {b}");
    }

    #[test]
    fn three_equal_lags_have_a_gain_margin_of_eight() {
        // L = 1 / (s + 1)^3: phase -180 at sqrt 3, where the gain is 1/8.
        let l = transfer(&[1.0], &[1.0, 3.0, 3.0, 1.0]);
        let found = margins(&l).unwrap();
        near(found.least_gain().unwrap().value, 8.0);
        near(found.least_gain().unwrap().frequency, 3.0_f64.sqrt());
        assert!(found.phase.is_empty() && found.delay.is_none() && found.stable);
        // At the border neither side is known.
        assert!(!margins(&l.clone().scaled(8.0)).unwrap().stable);
        assert!(!margins(&l.clone().scaled(8.1)).unwrap().stable);
        assert!(margins(&l.scaled(7.9)).unwrap().stable);
    }

    #[test]
    fn a_second_order_loop_has_the_phase_margin_of_the_books() {
        // L = w^2 / (s (s + 2 z w)); crossover w sqrt(sqrt(1 + 4 z^4) - 2 z^2), margin atan(2 z w / crossover).
        let (w, z) = (30.0_f64, 0.4_f64);
        let found = margins(&transfer(&[w * w], &[1.0, 2.0 * z * w, 0.0])).unwrap();
        let crossover = w * ((1.0 + 4.0 * z.powi(4)).sqrt() - 2.0 * z * z).sqrt();
        let margin = (2.0 * z * w / crossover).atan();
        let least = found.least_phase().unwrap();
        near(least.frequency, crossover);
        near(least.value, margin);
        near(found.delay.unwrap().value, margin / crossover);
        assert!(found.gain.is_empty() && found.stable);
        // Closed: frequency w and damping z; the peak of the sensitivity from its formula over a fine grid.
        let peak = (1..200_000)
            .map(|k| {
                let s = Complex::new(0.0, 1e-3 * f64::from(k));
                (s * (s + 2.0 * z * w) / (s * s + 2.0 * z * w * s + w * w)).norm()
            })
            .fold(0.0, f64::max);
        near(found.sensitivity.value, peak);
    }

    #[test]
    fn a_double_integrator_needs_its_phase_and_an_unstable_plant_its_gain() {
        let double = margins(&transfer(&[2.0], &[1.0, 0.0, 0.0])).unwrap();
        near(double.phase[0].value.abs() + 1.0, 1.0);
        assert!(!double.stable);
        // L = k (s + 1) / s^2 with k = 2: |L| = 1 at sqrt(2 + 2 sqrt 2).
        let led = margins(&transfer(&[2.0, 2.0], &[1.0, 0.0, 0.0])).unwrap();
        let crossover = (2.0 + 2.0 * 2.0_f64.sqrt()).sqrt();
        near(led.phase[0].frequency, crossover);
        near(led.phase[0].value, crossover.atan());
        // L = 3 / (s - 1) may lose two thirds of its gain: the margin lies at frequency 0.
        let unstable = margins(&transfer(&[3.0], &[1.0, -1.0])).unwrap();
        assert!(unstable.stable);
        assert_eq!(unstable.gain, [Margin { value: 1.0 / 3.0, frequency: 0.0 }]);
    }

    #[test]
    fn a_sharp_resonance_is_not_stepped_over() {
        // 0.05 / s around a resonance with a peak of 1 / (2 z) = 500.
        let (w, z) = (200.0_f64, 1e-3);
        let l = transfer(&[0.5 * w * w], &[1.0, 2.0 * z * w, w * w, 0.0]);
        let found = margins(&l).unwrap();
        // At the resonance L = -0.5 / (2 z w), phase -180.
        near(found.least_gain().unwrap().value, 2.0 * z * w / 0.5);
        assert_eq!(found.phase.len(), 3);
        assert!(!found.stable);
    }

    #[test]
    fn a_sampled_loop_has_the_margin_that_its_hold_leaves() {
        // An integrator k / s, sampled: z - 1 + k T = 0 is stable up to k T = 2.
        let m = |x: f64| nalgebra::DMatrix::from_element(1, 1, x);
        let plant = StateSpace::new(m(0.0), m(1.0), m(1.0), m(0.0), None).unwrap().sampled(0.1);
        let found = margins(&minimal(&plant.channel(0, 0)).scaled(5.0)).unwrap();
        assert!(found.stable);
        near(found.least_gain().unwrap().value, 4.0);
        near(found.least_gain().unwrap().frequency, PI / 0.1);
        // |L| = 1 where sin(w T / 2) = k T / 2; the phase there is -90 degrees - w T / 2.
        let crossover = 2.0 * 0.25_f64.asin() / 0.1;
        near(found.phase[0].frequency, crossover);
        near(found.phase[0].value, PI / 2.0 - crossover * 0.05);
    }

    #[test]
    fn a_sensitivity_may_be_largest_at_rest_or_come_ever_closer_to_its_bound() {
        let of = |channel: Channel| margins(&channel).expect("margins").sensitivity;
        // S = (s + 1) / (s + 2), (s + 1) / (s + 0.1), (s + 1) / (0.5 s + 1.2), and the first one sampled: (z - 0.5) / (z - 0.4).
        assert_eq!(of(transfer(&[1.0], &[1.0, 1.0])), Margin { value: 1.0, frequency: f64::INFINITY });
        let found = of(transfer(&[-0.9], &[1.0, 1.0]));
        assert!((found.value - 10.0).abs() < 1e-12 && found.frequency == 0.0, "{found:?}");
        let found = of(transfer(&[-0.5, 0.2], &[1.0, 1.0]));
        assert!((found.value - 2.0).abs() < 1e-12 && found.frequency == f64::INFINITY, "{found:?}");
        let sampled = Channel { period: Some(0.1), ..transfer(&[0.1], &[1.0, -0.5]) };
        let found = of(sampled);
        assert!(
            (found.value - 1.5 / 1.4).abs() < 1e-6 && (found.frequency * 0.1 - PI).abs() < 1e-6,
            "{found:?}"
        );
    }

    /// `L = (1 - s / 2) / (s + 1)` closed by a gain g has its pole at `-(1 + g) / (1 - g / 2)`, `L = -(2 s + 3) / (s + 1)` at
    /// `-(1 - 3 g) / (1 - 2 g)`, and `(2 s + 3) / (s + 1)` passes twice of what comes at once.
    #[test]
    fn what_passes_at_once_has_margins_at_an_infinite_frequency() {
        let of = |channel: Channel| margins(&channel).expect("margins");
        let found = of(transfer(&[-0.5, 1.0], &[1.0, 1.0]));
        assert_eq!(found.least_gain(), Some(Margin { value: 2.0, frequency: f64::INFINITY }));
        let found = of(transfer(&[-2.0, -3.0], &[1.0, 1.0]));
        let gains: Vec<f64> = found.gain.iter().map(|margin| margin.value).collect();
        assert!(found.stable && (gains[0] - 1.0 / 3.0).abs() < 1e-12 && gains[1] == 0.5, "{found:?}");
        assert_eq!(found.delay, Some(Margin { value: 0.0, frequency: f64::INFINITY }));
        let found = of(transfer(&[2.0, 3.0], &[1.0, 1.0]));
        assert_eq!(found.delay, Some(Margin { value: 0.0, frequency: f64::INFINITY }));
        assert_eq!(of(transfer(&[0.9, 3.0], &[1.0, 1.0])).delay.map(|delay| delay.value > 0.0), Some(true));
    }

    #[test]
    fn bandwidth_is_where_three_decibels_are_lost() {
        // |20 j w + 1|^2 = (1 + w^2)^2 / 2.
        let exact = (399.0 + (399.0_f64.powi(2) + 1.0).sqrt()).sqrt();
        near(bandwidth(&transfer(&[20.0, 1.0], &[1.0, 2.0, 1.0])).unwrap().unwrap(), exact);
        // With the zero nine decades below the poles; and what never loses them, as 0.8 of it passes at once.
        near(bandwidth(&transfer(&[1e9, 1.0], &[1.0, 2.0, 1.0])).unwrap().unwrap(), 2.0_f64.sqrt() * 1e9);
        assert_eq!(bandwidth(&transfer(&[0.8, 1.0], &[1.0, 1.0])), Ok(None));
        near(bandwidth(&transfer(&[10.0], &[1.0, 5.0])).unwrap().unwrap(), 5.0);
        assert_eq!(bandwidth(&transfer(&[1.0], &[1.0, 0.0])), Ok(None));
        let (w, z) = (7.0_f64, 0.3_f64);
        let exact = w * ((1.0 - 2.0 * z * z) + ((1.0 - 2.0 * z * z).powi(2) + 1.0).sqrt()).sqrt();
        near(bandwidth(&transfer(&[w * w], &[1.0, 2.0 * z * w, w * w])).unwrap().unwrap(), exact);
    }
}
