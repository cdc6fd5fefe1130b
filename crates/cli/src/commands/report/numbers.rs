//! Numbers as a page shows them: without raw exponents, with a true minus sign.

use blocksim_numbers::format::significant;

/// A number with so many significant digits.
pub fn readable(x: f64, digits: usize) -> String {
    match format!("{x:.*e}", digits.max(1) - 1).rsplit_once('e') {
        Some((front, exponent)) if x != 0.0 => split(front, exponent.parse().unwrap_or(0)),
        // Zero, and what is no finite number.
        _ => significant(x, digits),
    }
}

/// A number with as many digits as it has, six at most.
pub fn shortest(x: f64) -> String {
    let text = format!("{x:.5e}");
    match text.rsplit_once('e') {
        Some((front, exponent)) if x != 0.0 => {
            let front = front.trim_end_matches('0').trim_end_matches('.');
            split(front, exponent.parse().unwrap_or(0))
        }
        _ => significant(x, 6),
    }
}

/// A number of its digits, `-1.5`, and the power of ten that they are multiplied with.
fn split(front: &str, exponent: i32) -> String {
    let minus = if front.starts_with('-') { "−" } else { "" };
    let front = front.trim_start_matches('-');
    if !(-5..7).contains(&exponent) {
        let raised: String = exponent.to_string().chars().map(raised).collect();
        return format!("{minus}{front}·10{raised}");
    }
    let digits: String = front.chars().filter(|sign| *sign != '.').collect();
    if exponent < 0 {
        return format!("{minus}0.{}{digits}", "0".repeat(exponent.unsigned_abs() as usize - 1));
    }
    let whole = exponent.unsigned_abs() as usize + 1;
    match digits.get(whole..) {
        Some("") | None => format!("{minus}{digits:0<whole$}"),
        Some(rest) => format!("{minus}{}.{rest}", &digits[..whole]),
    }
}

fn raised(sign: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    sign.to_digit(10).and_then(|digit| DIGITS.get(digit as usize).copied()).unwrap_or('⁻')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_have_no_raw_exponents() {
        let shown = [733e-6, -188e-6, 96.2e-6, 7.4e-8, -893.84, 1550.2, 60.0, 1.5e9, 0.0, 9.9999]
            .map(|x| readable(x, 3));
        let expected = [
            "0.000733",
            "−0.000188",
            "0.0000962",
            "7.40·10⁻⁸",
            "−894",
            "1550",
            "60.0",
            "1.50·10⁹",
            "0",
            "10.0",
        ];
        assert_eq!(shown, expected);
        assert_eq!(readable(f64::NAN, 3), significant(f64::NAN, 3));
    }

    #[test]
    fn numbers_have_as_many_digits_as_they_need() {
        let shown = [3.0, 0.1 + 0.2, -2.5e-7, 150_000.0, 1.0 / 3.0, 4e12, 0.0].map(shortest);
        assert_eq!(shown, ["3", "0.3", "−2.5·10⁻⁷", "150000", "0.333333", "4·10¹²", "0"]);
        assert_eq!(shortest(f64::INFINITY), significant(f64::INFINITY, 6));
    }
}
