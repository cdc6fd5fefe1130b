//! Numbers as text, for files of which they are nearly all.

/// Most digits that tell a number from all others.
const DIGITS: usize = 17;

/// The shorter of the two forms `0.001` and `1e-3` with the fewest digits that read back to the same bits; the plain one where they are
/// as long. `NaN`, `Inf` and `-Inf` are words.
pub(crate) fn push_number(text: &mut String, value: f64) {
    if !value.is_finite() {
        text.push_str(match value {
            _ if value.is_nan() => "NaN",
            _ if value > 0.0 => "Inf",
            _ => "-Inf",
        });
        return;
    }
    if value.is_sign_negative() {
        text.push('-');
    }
    if value == 0.0 {
        text.push('0');
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let printed = buffer.format_finite(value.abs());
    // Most numbers: with digits behind the point, and none to save by a power of ten.
    if (1e-2..1e15).contains(&value.abs()) && !printed.ends_with(".0") {
        text.push_str(printed);
        return;
    }
    let mut digits = [b'0'; DIGITS];
    let (count, exponent) = decimal(printed, &mut digits);
    let Ok(digits) = std::str::from_utf8(&digits[..count]) else { return };
    // Before the point `exponent + 1` digits in the plain form, one in the other.
    let plain = match usize::try_from(exponent) {
        Ok(whole) if whole + 1 >= count => whole + 1,
        Ok(_) => count + 1,
        Err(_) => count + 1 + exponent.unsigned_abs() as usize,
    };
    let power =
        exponent.unsigned_abs().checked_ilog10().unwrap_or(0) as usize + 1 + usize::from(exponent < 0);
    if count + usize::from(count > 1) + 1 + power < plain {
        push_scientific(text, digits, exponent);
    } else {
        push_plain(text, digits, exponent);
    }
}

/// The digits of a positive number without zeros at their ends, their count, and the power of ten of the first one, from one of the forms
/// `12.5`, `0.00125` and `1.25e-7`.
fn decimal(printed: &str, digits: &mut [u8; DIGITS]) -> (usize, i32) {
    let (mantissa, power) = printed.split_once('e').unwrap_or((printed, "0"));
    let (mut count, mut last) = (0, 0);
    // The place of the first digit that is not zero, from the left.
    let mut first = None;
    for (at, byte) in mantissa.bytes().filter(|byte| *byte != b'.').enumerate() {
        if byte != b'0' && first.is_none() {
            first = Some(at);
        }
        if first.is_some() && count < DIGITS {
            digits[count] = byte;
            count += 1;
            if byte != b'0' {
                last = count;
            }
        }
    }
    let before = mantissa.find('.').unwrap_or(mantissa.len()) as i32;
    (last, before - 1 - first.unwrap_or(0) as i32 + power.parse().unwrap_or(0))
}

fn push_scientific(text: &mut String, digits: &str, exponent: i32) {
    let (first, rest) = digits.split_at(1);
    text.push_str(first);
    if !rest.is_empty() {
        text.push('.');
        text.push_str(rest);
    }
    text.push('e');
    if exponent < 0 {
        text.push('-');
    }
    let power = exponent.unsigned_abs();
    for unit in [100, 10, 1].into_iter().skip_while(|unit| *unit > power && *unit > 1) {
        text.push(char::from(b'0' + (power / unit % 10) as u8));
    }
}

fn push_plain(text: &mut String, digits: &str, exponent: i32) {
    let Ok(whole) = usize::try_from(exponent) else {
        text.push_str("0.");
        text.extend(std::iter::repeat_n('0', exponent.unsigned_abs() as usize - 1));
        text.push_str(digits);
        return;
    };
    match digits.split_at_checked(whole + 1).filter(|(_, behind)| !behind.is_empty()) {
        Some((before, behind)) => {
            text.push_str(before);
            text.push('.');
            text.push_str(behind);
        }
        None => {
            text.push_str(digits);
            text.extend(std::iter::repeat_n('0', whole + 1 - digits.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(value: f64) -> String {
        let mut text = String::new();
        push_number(&mut text, value);
        text
    }

    #[test]
    fn numbers_take_the_shorter_form() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (0.1, "0.1"),
            (100.0, "100"),
            (1e6, "1e6"),
            (1234567.0, "1234567"),
            (1e-7, "1e-7"),
            (-1.25e-7, "-1.25e-7"),
            (f64::MAX, "1.7976931348623157e308"),
            (5e-324, "5e-324"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "Inf"),
            (f64::NEG_INFINITY, "-Inf"),
        ] {
            assert_eq!(text(value), expected);
        }
    }

    /// The forms of the standard library, of which the shorter one is taken. Half-way between two texts (1658206780088562.25) it rounds
    /// up, and here the even one is taken; both read back to the number.
    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = || {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            bits
        };
        let compare = |value: f64| {
            if value.is_finite() {
                let (plain, scientific) = (format!("{value}"), format!("{value:e}"));
                let shorter = if scientific.len() < plain.len() { scientific } else { plain };
                let text = text(value);
                assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
                assert_eq!(text.len(), shorter.len(), "{text} and {shorter}");
                let is_half_way = (1e13..1e16).contains(&value.abs());
                assert!(text == shorter || is_half_way, "{text} and {shorter}");
            }
        };
        for power in -320..=308 {
            let ten: f64 = format!("1e{power}").parse().expect("a number");
            for factor in [1.0, 1.5, 9.0, 123.0, -0.1] {
                compare(ten * factor);
            }
        }
        for _ in 0..100_000 {
            let random = next();
            // All numbers, such as occur in results, and those with few digits.
            compare(f64::from_bits(random));
            compare((random >> 11) as f64 / (1_u64 << 53) as f64 * 200.0 - 100.0);
            compare((random >> 44) as f64 / 1e3);
        }
    }
}
