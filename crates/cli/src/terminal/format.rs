//! Columns of numbers.

use blocksim_numbers::format::{fixed, significant};

/// A heading with its unit, where all rows have the same one; plain numbers need none.
pub fn headed(name: &str, units: &[&str]) -> String {
    match units.first() {
        Some(&"1") => name.to_owned(),
        Some(unit) if units.iter().all(|other| other == unit) => format!("{name} [{unit}]"),
        _ => name.to_owned(),
    }
}

/// Numbers of a column with the same decimals, so that the points stand below each other; four significant
/// digits for the largest one, or five, if the smallest has less than two otherwise. `-` where there is none. Where the units, one for each number that there is, differ, each
/// number carries its own.
pub fn column(values: &[Option<f64>], units: &[&str]) -> Vec<String> {
    let same = units.first().is_none_or(|unit| units.iter().all(|other| other == unit));
    let finite = values.iter().flatten().filter(|x| x.is_finite());
    let largest = finite.fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let plain = largest == 0.0 || (1e-4..1e6).contains(&largest);
    let sizes = values.iter().flatten().map(|x| x.abs()).filter(|x| x.is_finite() && *x > 0.0);
    let smallest = sizes.fold(largest, f64::min);
    let place = |x: f64| x.log10().floor();
    let wanted = (1.0 - place(smallest)).clamp(3.0 - place(largest), 4.0 - place(largest));
    let decimals = if largest == 0.0 { 0.0 } else { wanted.clamp(0.0, 6.0) } as usize;
    let mut units = units.iter();
    let cell = |value: &Option<f64>| {
        let Some(x) = value else { return "-".to_owned() };
        let number = if plain && same { fixed(*x, decimals) } else { significant(*x, 4) };
        match units.next() {
            Some(unit) if !same => format!("{number} {unit}"),
            _ => number,
        }
    };
    values.iter().map(cell).collect()
}

/// How many digits are right where a relative error is so large: `9 digits`.
pub fn digits(accuracy: f64) -> String {
    match accuracy {
        a if a < 1e-15 => "all digits".to_owned(),
        a if a < 1e-2 => format!("{} digits", (-a.log10()).floor()),
        a => format!("{} %", significant(100.0 * a, 1)),
    }
}

/// A time in s with at most seven digits and no zeros behind them: `0.135`, `2`, `1.5e-6`.
pub fn short_time(t: f64) -> String {
    let text = significant(t, 7);
    let (number, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    let number =
        if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number };
    format!("{number}{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stand_below_each_other() {
        assert_eq!(column(&[Some(1.5), Some(12.25), None], &["m", "m"]), ["1.50", "12.25", "-"]);
        assert_eq!(column(&[Some(0.5), Some(0.0003)], &["deg"]), ["0.50000", "0.00030"]);
        assert_eq!(column(&[Some(1061.2), Some(-3.0)], &["N*m"]), ["1061.2", "-3.0"]);
        assert_eq!(column(&[Some(0.0), Some(-0.0)], &[]), ["0", "0"]);
        assert_eq!(column(&[Some(1.5e-9), Some(2e-9)], &["m"]), ["1.500e-9", "2.000e-9"]);
        assert_eq!(column(&[Some(1.5), None, Some(2.0)], &["m", "deg"]), ["1.500 m", "-", "2.000 deg"]);
        assert_eq!(column(&[Some(f64::NAN), Some(1.0)], &["m"]), ["NaN", "1.000"]);
    }

    #[test]
    fn times_have_no_idle_zeros() {
        let all = [0.135, 2.0, 0.0, 1.5e-6, 0.1 + 0.2, 100_000.0, 10.0].map(short_time);
        assert_eq!(all, ["0.135", "2", "0", "1.5e-6", "0.3", "100e3", "10"]);
    }

    #[test]
    fn a_heading_has_the_unit_that_all_share() {
        assert_eq!(headed("error", &["deg", "deg"]), "error [deg]");
        assert_eq!(headed("error", &["deg", "m"]), "error");
        assert_eq!(headed("error", &[]), "error");
    }
}
