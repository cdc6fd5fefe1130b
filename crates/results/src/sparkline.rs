//! A series in one line.

/// The course of `values` in `width` signs from `▁` to `█`, each the mean of its share of the values; a
/// share without any finite value is a space. A constant series is a low line.
pub fn sparkline(values: &[f64], width: usize) -> String {
    const SIGNS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let width = width.min(values.len());
    let mean = |column: usize| {
        let share = &values[column * values.len() / width..(column + 1) * values.len() / width];
        let finite: Vec<f64> = share.iter().copied().filter(|x| x.is_finite()).collect();
        // Divided before the sum, which could overflow.
        finite.iter().map(|x| x / finite.len() as f64).sum::<f64>() / f64::from(u8::from(!finite.is_empty()))
    };
    let means: Vec<f64> = (0..width).map(mean).collect();
    let low = means.iter().copied().fold(f64::INFINITY, f64::min);
    let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sign = |mean: &f64| {
        if !mean.is_finite() {
            return ' ';
        }
        let share = if high > low { (mean / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0) } else { 0.0 };
        SIGNS[((share * 8.0) as usize).min(7)]
    };
    means.iter().map(sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_rises_through_all_signs() {
        let ramp: Vec<f64> = (0..800).map(f64::from).collect();
        assert_eq!(sparkline(&ramp, 8), "▁▂▃▄▅▆▇█");
    }

    #[test]
    fn gaps_constants_and_extremes_are_drawn() {
        assert_eq!(sparkline(&[0.0, f64::NAN, 1.0], 3), "▁ █");
        assert_eq!(sparkline(&[3.0; 5], 3), "▁▁▁");
        assert_eq!(sparkline(&[f64::MIN, f64::MAX], 2), "▁█");
        assert_eq!(sparkline(&[], 10), "");
        assert_eq!(sparkline(&[1.0], 0), "");
    }
}
