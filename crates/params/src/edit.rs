//! New numbers in the texts of a set or a model.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::compare::Change;
use crate::numeral::written;
use crate::quantity::{Content, Quantity, SetError};

/// The texts that hold these quantities with the numerals of the changes replaced; everything else stays, byte for byte.
///
/// # Errors
/// The texts lack one of the numbers.
pub fn edited(texts: &[&str], quantities: &[Quantity], changes: &[Change]) -> Result<Vec<String>, SetError> {
    let by_path: BTreeMap<&str, _> =
        quantities.iter().map(|quantity| (quantity.path.as_str(), quantity)).collect();
    let mut places: Vec<Vec<(Range<usize>, f64)>> = vec![Vec::new(); texts.len()];
    for change in changes {
        let missing = || {
            SetError::new(format!("cannot change `{}`: the set has no such number", change.path), None, 0..0)
        };
        let quantity = by_path.get(change.path.as_str()).ok_or_else(missing)?;
        let places = places.get_mut(quantity.text).ok_or_else(missing)?;
        match (&quantity.content, change.new) {
            (Content::Number { numeral, .. }, Some(new)) => places.push((numeral.clone(), new)),
            _ => return Err(missing()),
        }
    }
    Ok(texts.iter().zip(places).map(|(text, places)| replaced(text, places)).collect())
}

fn replaced(text: &str, mut places: Vec<(Range<usize>, f64)>) -> String {
    places.sort_by_key(|(numeral, _)| numeral.start);
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for (numeral, new) in places {
        out.push_str(&text[at..numeral.start]);
        out.push_str(&written(new));
        at = numeral.end;
    }
    out.push_str(&text[at..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::quantities;

    #[test]
    fn only_numerals_change() {
        let text = "(\n    // kept 12\n    mass: (value: \"12 kg\", source: \"12\"), n: 2, /* end */ tcp: [1, \" 2.50  mm\"],\n)";
        let change = |path: &str, new| Change {
            path: path.to_owned(),
            cell: None,
            old: None,
            new: Some(new),
            unit: String::new(),
        };
        let found = quantities(text).expect("a set");
        let changes = [change("tcp[1]", 1e-9), change("mass", 13.5), change("n", 3.0)];
        assert_eq!(
            edited(&[text], &found, &changes).expect("a set"),
            [text.replace("\"12 kg\"", "\"13.5 kg\"").replace("n: 2,", "n: 3,").replace("2.50", "1e-9")]
        );
        assert!(edited(&[text], &found, &[change("m", 1.0)]).is_err());
    }
}
