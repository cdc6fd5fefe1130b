//! Numbers for people. Files get all digits.

/// A number as the place in a row: `1st`, `2nd`, `3rd`, `4th`, `11th`, `21st`.
pub fn ordinal(n: u64) -> String {
    let ending = match (n % 10, n % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{}{ending}", count(n))
}

/// A fixed number of decimals, never `-0.00`; `NaN` and infinities as words.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        _ => text,
    }
}

/// A number of significant digits; plain from 0.001 to 99999, else with an exponent that is a multiple of
/// three: `12.3e-6`.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    // Rounding may carry (9.996 to 10.00), so the exponent is that of the rounded number.
    let rounded = format!("{value:.*e}", digits - 1);
    let exponent: i32 = rounded.rsplit_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let decimals = |shift: i32| usize::try_from(digits as i32 - 1 - shift).unwrap_or(0);
    if (-3..5).contains(&exponent) {
        return fixed(value, decimals(exponent));
    }
    let thousands = exponent.div_euclid(3) * 3;
    // In two factors, for 1e-324 is not a number.
    let half = thousands / 2;
    let mantissa = value / 10_f64.powi(half) / 10_f64.powi(thousands - half);
    format!("{}e{thousands}", fixed(mantissa, decimals(exponent - thousands)))
}

/// As many digits as make sense for a unit: angles in deg with 2 decimals, mm with 1, s with 3, torques with
/// 4 significant digits, all else with 5.
pub fn with_unit(value: f64, unit: &str) -> String {
    let number = match unit {
        "deg" => fixed(value, 2),
        "mm" => fixed(value, 1),
        "s" => fixed(value, 3),
        "N*m" => significant(value, 4),
        _ => significant(value, 5),
    };
    if unit == "1" { number } else { format!("{number} {unit}") }
}

/// An angle given in rad, shown in degrees with so many decimals, without the unit.
pub fn degrees(angle: f64, decimals: usize) -> String {
    fixed(angle.to_degrees(), decimals)
}

/// A time in s with so many decimals; three significant digits of one that would have none or one of them.
pub fn seconds(t: f64, decimals: usize) -> String {
    let least = 10_f64.powi(1 - decimals as i32);
    if t != 0.0 && t.abs() < least { significant(t, 3) } else { fixed(t, decimals) }
}

/// A simulated time with its unit: `2.000 s`, `0.200 ms`.
pub fn simulated(t: f64) -> String {
    match t {
        t if t > 0.0 && t < 1e-5 => format!("{} us", significant(1e6 * t, 3)),
        t if t > 0.0 && t < 0.01 => format!("{} ms", significant(1e3 * t, 3)),
        t => format!("{} s", fixed(t, 3)),
    }
}

/// A duration: `1.6 ms`, `0.42 s`, `7.62 s`, from a minute on `2:03.4`, from an hour on `1:02:03`.
pub fn duration(seconds: f64) -> String {
    if seconds > 0.0 && seconds < 0.00995 {
        return format!("{} ms", significant(1e3 * seconds, 2));
    }
    if !seconds.is_finite() || seconds < 59.995 {
        return format!("{} s", fixed(seconds, 2));
    }
    if seconds < 3599.95 {
        let tenths = (seconds * 10.0).round() as u64;
        return format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10);
    }
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}

/// A count with a space between groups of three digits: `4 183`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

fn not_finite(value: f64) -> String {
    (if value.is_nan() {
        "NaN"
    } else if value > 0.0 {
        "infinite"
    } else {
        "-infinite"
    })
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(fixed(-0.0, 2), "0.00");
        assert_eq!(fixed(-0.004, 2), "0.00");
        assert_eq!(fixed(-0.006, 2), "-0.01");
        assert_eq!(fixed(-0.3, 0), "0");
        assert_eq!(significant(-0.0, 3), "0");
        assert_eq!(degrees(-1e-6, 3), "0.000");
        assert_eq!(degrees(std::f64::consts::PI, 3), "180.000");
    }

    #[test]
    fn significant_digits_hold_over_all_magnitudes() {
        for (value, expected) in [
            (1.0, "1.000"),
            (-12.3456, "-12.35"),
            (9.9996, "10.00"),
            (99_999.6, "100.0e3"),
            (12_345.0, "12345"),
            (123_456.0, "123.5e3"),
            (0.001_234_5, "0.001234"),
            (0.000_012_34, "12.34e-6"),
            (5e-324, "4.941e-324"),
            (f64::MAX, "179.8e306"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-infinite"),
        ] {
            assert_eq!(significant(value, 4), expected);
        }
    }

    #[test]
    fn units_choose_their_digits() {
        assert_eq!(with_unit(90.0, "deg"), "90.00 deg");
        assert_eq!(with_unit(412.34, "mm"), "412.3 mm");
        assert_eq!(with_unit(1.22449, "s"), "1.224 s");
        assert_eq!(with_unit(1061.2, "N*m"), "1061 N*m");
        assert_eq!(with_unit(0.5, "1"), "0.50000");
    }

    #[test]
    fn durations_and_counts_read_well() {
        assert_eq!([0.0, 0.0016, 0.42].map(duration), ["0.00 s", "1.6 ms", "0.42 s"]);
        assert_eq!(duration(59.999), "1:00.0");
        assert_eq!(duration(123.44), "2:03.4");
        assert_eq!(duration(3599.97), "1:00:00");
        assert_eq!(duration(3723.2), "1:02:03");
        assert_eq!([2.0, 2e-4, 3e-6, 0.0].map(simulated), ["2.000 s", "0.200 ms", "3.00 us", "0.000 s"]);
        assert_eq!(
            [0.5, 0.012, 0.0012, 1.2e-5, 0.0].map(|t| seconds(t, 3)),
            ["0.500", "0.012", "0.00120", "12.0e-6", "0.000"]
        );
        assert_eq!([0, 96, 4183, 1_234_567].map(count), ["0", "96", "4 183", "1 234 567"]);
    }
}
