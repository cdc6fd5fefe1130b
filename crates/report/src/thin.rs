//! Rows that a screen can show.

/// Positions of the rows that show all signals as all rows would: of each of `columns` equally long stretches of time
/// the first and the last row, and those with the least and the largest value of each signal.
pub fn rows(time: &[f64], signals: &[&[f64]], columns: usize) -> Vec<usize> {
    let (Some(&begin), Some(&end)) = (time.first(), time.last()) else { return Vec::new() };
    if time.len() <= columns || end <= begin {
        return (0..time.len()).collect();
    }
    let width = (end - begin) / columns.max(1) as f64;
    let column = |row: usize| (((time[row] - begin) / width) as usize).min(columns - 1);
    let mut kept = Vec::new();
    let mut from = 0;
    while from < time.len() {
        let here = column(from);
        let to = from
            + time[from..]
                .iter()
                .take_while(|&&t| ((t - begin) / width) as usize <= here || here == columns - 1)
                .count();
        let to = to.max(from + 1);
        let mut chosen = vec![from, to - 1];
        for values in signals {
            let finite = || (from..to).filter(|&row| values[row].is_finite());
            chosen.extend(finite().min_by(|&a, &b| values[a].total_cmp(&values[b])));
            chosen.extend(finite().max_by(|&a, &b| values[a].total_cmp(&values[b])));
            // A gap stays a gap.
            chosen.extend((from..to).find(|&row| !values[row].is_finite()));
        }
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen);
        from = to;
    }
    kept
}

/// Mean and root mean square over time of a course of which some rows are kept: straight between them, or held.
pub fn means(time: &[f64], values: &[f64], held: bool, rows: impl Iterator<Item = usize>) -> (f64, f64) {
    let (mut known, mut area, mut square) = (0.0, 0.0, 0.0);
    let mut before = None;
    for row in rows {
        if let Some(last) = before.replace(row) {
            let wide: f64 = time[row] - time[last];
            let (a, b): (f64, f64) = (values[last], if held { values[last] } else { values[row] });
            if wide > 0.0 && a.is_finite() && b.is_finite() {
                known += wide;
                area += (a + b) / 2.0 * wide;
                square += (a * a + a * b + b * b) / 3.0 * wide;
            }
        }
    }
    if known > 0.0 { (area / known, (square / known).sqrt()) } else { (0.0, 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_spike_and_no_gap_is_lost_and_ends_stay() {
        let n = 2_000_000;
        let time: Vec<f64> = (0..n).map(|k| f64::from(k) * 1e-6).collect();
        let mut values = vec![0.0; n as usize];
        values[1_234_567] = 9.0;
        values[777_777] = f64::NAN;
        let rows = rows(&time, &[&values], 500);
        assert!(rows.len() <= 5 * 500, "{}", rows.len());
        for row in [0, 777_777, 1_234_567, n as usize - 1] {
            assert!(rows.contains(&row), "{row}");
        }
        assert!(rows.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn means_of_lines_are_exact_and_gaps_do_not_count() {
        let (mean, rms) = means(&[0.0, 3.0], &[0.0, 6.0], false, 0..2);
        assert!((mean - 3.0).abs() < 1e-12 && (rms - 12.0_f64.sqrt()).abs() < 1e-12, "{mean} {rms}");
        assert_eq!(means(&[0.0, 1.0, 2.0], &[2.0, f64::NAN, 5.0], true, 0..3).0, 2.0);
        assert_eq!(means(&[0.0, 1.0], &[f64::NAN; 2], false, 0..2), (0.0, 0.0));
    }

    #[test]
    fn few_rows_and_rows_of_one_instant_stay_as_they_are() {
        assert_eq!(rows(&[0.0, 0.0, 1.0], &[&[1.0, 2.0, 3.0]], 10), [0, 1, 2]);
        assert_eq!(rows(&[1.0; 5], &[&[0.0; 5]], 2), [0, 1, 2, 3, 4]);
        assert!(rows(&[], &[], 10).is_empty());
    }
}
