//! Numbers that people wrote as text.

/// Reads a number with a decimal point or a decimal comma.
///
/// # Errors
/// What is wrong and what to do: thousands separators, a unit in the cell, no number at all. A text such as `1.500`
/// is refused, because it means 1500 in half of the world.
pub(crate) fn read(text: &str) -> Result<f64, (String, String)> {
    let fail = |what: &str, help: &str| Err((format!("`{text}` {what}"), help.to_owned()));
    let plain = text.trim().replace('\u{2212}', "-");
    let digits = plain.strip_prefix(['-', '+']).unwrap_or(&plain);
    let end = digits.find(|c: char| !(c.is_ascii_digit() || ".,'\u{2019} \u{a0}\u{202f}".contains(c)));
    let (mantissa, rest) = digits.split_at(end.unwrap_or(digits.len()));
    let exponent = rest.strip_prefix(['e', 'E']);
    let is_exponent = |text: &str| {
        let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
        !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    if !mantissa.bytes().any(|byte| byte.is_ascii_digit()) {
        return fail("is not a number", "write a number such as 0.25 or 0,25");
    }
    if !rest.is_empty() && !exponent.is_some_and(is_exponent) {
        return fail("has more than a number", "write only the number; the unit stands in the column Unit");
    }
    let mantissa = mantissa.trim_end();
    let separators: Vec<usize> =
        mantissa.bytes().enumerate().filter(|(_, b)| !b.is_ascii_digit()).map(|(at, _)| at).collect();
    let thousands = "write it without thousands separators: 1500 or 1500,5";
    match separators.as_slice() {
        [] => {}
        [at] if [b'.', b','].contains(&mantissa.as_bytes()[*at]) => {
            let (before, after) = (&mantissa[..*at], &mantissa[at + 1..]);
            let grouped = after.len() == 3 && (1..=3).contains(&before.len()) && !before.starts_with('0');
            if grouped && exponent.is_none() {
                let help = format!(
                    "type it as a number into a cell that is not formatted as text, or write {before}{after} or {before}.{after}0"
                );
                return Err((format!("`{text}` may have a thousands separator or three decimals"), help));
            }
        }
        _ => return fail("has thousands separators", thousands),
    }
    match plain.replace(',', ".").trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => fail("is too large", "write a number below 1.8e308"),
        Err(_) => fail("is not a number", "write a number such as 0.25 or 0,25"),
    }
}

/// Writes a number as a person would, with all its digits.
pub fn written(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{number:e}") } else { format!("{number}") }
}

/// Whether two numbers are the same in 15 significant digits, as many as spreadsheets keep.
pub(crate) fn same(a: f64, b: f64) -> bool {
    a == b || format!("{a:.14e}") == format!("{b:.14e}")
}

/// The number next to this one with at most 15 significant digits, which takes out the rounding of a conversion.
pub(crate) fn rounded(number: f64) -> f64 {
    format!("{number:.14e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_commas_are_read() {
        for (text, number) in [
            ("0,25", 0.25),
            ("0.25", 0.25),
            (" -12 ", -12.0),
            ("+1,5e-3", 1.5e-3),
            ("0,125", 0.125),
            ("1500,5", 1500.5),
            ("\u{2212}3", -3.0),
            ("8,8540", 8.854),
            ("1234,567", 1234.567),
            (",5", 0.5),
            ("2E6", 2e6),
            ("1.500e0", 1.5),
        ] {
            assert_eq!(read(text), Ok(number), "{text}");
        }
    }

    #[test]
    fn thousands_separators_units_and_words_are_refused() {
        for (text, part) in [
            ("1.500", "thousands"),
            ("12,345", "thousands"),
            ("1.234,5", "thousands"),
            ("1,234.5", "thousands"),
            ("1 500", "thousands"),
            ("1'500", "thousands"),
            ("1\u{a0}500", "thousands"),
            ("1.234.567", "thousands"),
            ("12 kg", "more than a number"),
            ("80%", "more than a number"),
            ("1e", "more than a number"),
            ("much", "not a number"),
            ("", "not a number"),
            ("NaN", "not a number"),
            ("inf", "not a number"),
            ("-", "not a number"),
            ("1e999", "too large"),
            ("1,,5", "thousands"),
            ("0x10", "more than a number"),
            ("12e3 kg", "more than a number"),
        ] {
            let (message, _) = read(text).expect_err(text);
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn numbers_are_written_with_all_digits_and_read_back() {
        for (number, text) in
            [(0.25, "0.25"), (121.0, "121"), (8.5e-5, "8.5e-5"), (0.0, "0"), (-4500.0, "-4500"), (1e7, "1e7")]
        {
            assert_eq!(written(number), text);
            assert_eq!(text.parse(), Ok(number));
        }
        assert!(same(0.1 + 0.2, 0.3) && !same(0.3, 0.3001));
    }
}
