//! Round numbers for axes.

use crate::format::fixed;

/// A range of numbers, `low < high`, both finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

impl Range {
    /// The range of the finite values among these; widened where they are (nearly) all the same. `None`
    /// where there is no finite value.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Range> {
        let finite = values.filter(|x| x.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if low > high {
            return None;
        }
        // Below this, what differs is rounding and would be drawn as noise over the whole height.
        let size = low.abs().max(high.abs());
        if high - low <= (1e-12 * size).max(f64::MIN_POSITIVE) {
            let room = if size == 0.0 { 1.0 } else { (0.1 * size).max(4.0 * f64::MIN_POSITIVE) };
            return Some(Range { low: (low - room).max(f64::MIN), high: (high + room).min(f64::MAX) });
        }
        Some(Range { low, high })
    }

    /// Where `x` lies: 0 at `low`, 1 at `high`. Halves, for the width of the range may overflow.
    pub fn share(&self, x: f64) -> f64 {
        (x / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0)
    }

    /// The round step, 1, 2 or 5 times a power of ten, that divides the range into at most `parts`.
    pub fn step(&self, parts: usize) -> f64 {
        let rough = ((self.high / 2.0 - self.low / 2.0) / (parts.max(1) as f64 / 2.0)).min(f64::MAX);
        let power = 10_f64.powf(rough.log10().floor()).max(f64::MIN_POSITIVE);
        let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= rough * (1.0 - 1e-9)).unwrap_or(10.0);
        // Rounding up may pass the largest number there is.
        if (factor * power).is_finite() { factor * power } else { power }
    }

    /// The range widened to multiples of `step`, where those are finite.
    pub fn widened(&self, step: f64) -> Range {
        // A limit that is a multiple up to rounding stays.
        let low = ((self.low / step) + 1e-9).floor() * step;
        let high = ((self.high / step) - 1e-9).ceil() * step;
        let usable = low.is_finite() && high.is_finite() && low < high;
        if usable { Range { low: low.min(self.low), high: high.max(self.high) } } else { *self }
    }

    /// The multiples of `step` within the range, at most 1000.
    pub fn ticks(&self, step: f64) -> Vec<f64> {
        let first = (self.low / step - 1e-9).ceil();
        let multiples = (0..1000).map(|k| (first + f64::from(k)) * step);
        multiples.take_while(|x| *x <= self.high + 1e-9 * step && x.is_finite()).collect()
    }
}

/// Labels for multiples of `step` that differ from each other by no more digits than needed, with a common
/// exponent where the numbers are very large or small.
pub fn labels(ticks: &[f64], step: f64) -> Vec<String> {
    let size = ticks.iter().fold(step, |a, x| a.max(x.abs()));
    let exponent = if (1e-3..1e5).contains(&size) { 0 } else { (size.log10() / 3.0).floor() as i32 * 3 };
    // In two factors, for a power of ten may be no number where the tick is one.
    let half = exponent / 2;
    let scaled = |x: f64| x / 10_f64.powi(half) / 10_f64.powi(exponent - half);
    let decimals = (-(scaled(step).log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize;
    let label = |x: &f64| match (fixed(scaled(*x), decimals), exponent) {
        (number, 0) => number,
        (number, _) if number.bytes().all(|b| b == b'0' || b == b'.') => "0".to_owned(),
        (number, e) => format!("{number}e{e}"),
    };
    ticks.iter().map(label).collect()
}

/// Labels of a logarithmic axis for whole exponents of ten: `0.01`, `100`, `1e6`.
pub fn powers(exponents: &[f64]) -> Vec<String> {
    let label = |exponent: &f64| match exponent.round() as i32 {
        e @ 0..=4 => format!("{}", 10_i64.pow(e.unsigned_abs())),
        e @ -3..=-1 => fixed(10_f64.powi(e), e.unsigned_abs() as usize),
        e => format!("1e{e}"),
    };
    exponents.iter().map(label).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Range {
        Range::of(values.iter().copied()).unwrap()
    }

    #[test]
    fn steps_are_round_and_fit() {
        for (low, high, parts, step) in
            [(0.0, 10.0, 5, 2.0), (0.0, 1.0, 3, 0.5), (-75.0, 90.0, 4, 50.0), (0.0, 7e-7, 4, 2e-7)]
        {
            let found = of(&[low, high]).step(parts);
            assert!((found / step - 1.0).abs() < 1e-12, "{found} is not {step}");
        }
    }

    #[test]
    fn labels_have_the_digits_they_need() {
        let text = |low: f64, high: f64| {
            let range = of(&[low, high]);
            let step = range.step(4);
            labels(&range.ticks(step), step)
        };
        assert_eq!(text(0.0, 10.0), ["0", "5", "10"]);
        assert_eq!(text(-0.3, 0.3), ["-0.2", "0.0", "0.2"]);
        assert_eq!(text(0.0, 4e-6), ["0", "1e-6", "2e-6", "3e-6", "4e-6"]);
        assert_eq!(text(1e6, 1.3e6), ["1.0e6", "1.1e6", "1.2e6", "1.3e6"]);
    }

    #[test]
    fn powers_of_ten_are_written_out_where_they_are_short() {
        assert_eq!(
            powers(&[-4.0, -3.0, -1.0, 0.0, 2.0, 4.0, 5.0]),
            ["1e-4", "0.001", "0.1", "1", "100", "10000", "1e5"]
        );
    }

    #[test]
    fn constants_and_extremes_have_a_range() {
        assert_eq!(of(&[0.0, -0.0]), Range { low: -1.0, high: 1.0 });
        assert_eq!(of(&[f64::NAN, 5.0]), Range { low: 4.5, high: 5.5 });
        assert_eq!(Range::of([f64::NAN, f64::INFINITY].into_iter()), None);
        for extreme in [of(&[f64::MIN, f64::MAX]), of(&[f64::MAX]), of(&[0.0, 5e-324]), of(&[5e-324])] {
            assert!(extreme.low < extreme.high && extreme.low.is_finite() && extreme.high.is_finite());
            let step = extreme.step(4);
            let wide = extreme.widened(step);
            assert!(wide.low < wide.high && !labels(&wide.ticks(step), step).is_empty());
        }
    }
}
