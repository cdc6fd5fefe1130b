//! Numbers in texts: finite, with a decimal point.

use crate::fault::shown;

/// Exactly `N` finite numbers with white space between them; otherwise reason and remedy.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], (String, String)> {
    let mut values = [0.0; N];
    let mut words = text.split_whitespace();
    for (i, value) in values.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| count::<N>(text, i))?;
        *value = number(word)?;
    }
    match words.next() {
        None => Ok(values),
        Some(_) => Err(count::<N>(text, N + 1 + words.count())),
    }
}

fn count<const N: usize>(text: &str, found: usize) -> (String, String) {
    let wanted = if N == 1 { "one number is".to_owned() } else { format!("{N} numbers are") };
    (
        format!("{wanted} expected, `{}` has {found}", shown(text)),
        "separate numbers by spaces, without units".to_owned(),
    )
}

/// One finite number; otherwise reason and remedy.
pub(crate) fn number(word: &str) -> Result<f64, (String, String)> {
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err((format!("`{}` is not finite", shown(word)), "write a finite number".to_owned())),
        Err(_) if word.contains(',') => Err((
            format!("`{}` is not a number", shown(word)),
            "write a decimal point, and spaces between numbers".to_owned(),
        )),
        Err(_) => Err((
            format!("`{}` is not a number", shown(word)),
            "write a number such as 0.25 or 1e-3".to_owned(),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_numbers_are_three_numbers() {
        assert_eq!(numbers::<3>(" 1  -2.5\n3e-2 "), Ok([1.0, -2.5, 0.03]));
        for (wrong, word) in [
            ("1 2", "has 2"),
            ("1 2 3 4 5", "has 5"),
            ("1 2 nan", "not finite"),
            ("1 2 1e999", "not finite"),
            ("1,5 2 3", "not a number"),
            ("1 2 x", "not a number"),
        ] {
            let (reason, _) = numbers::<3>(wrong).unwrap_err();
            assert!(reason.contains(word), "{reason}");
        }
    }
}
