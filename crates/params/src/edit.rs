//! New numbers in the text of a set.

use std::collections::BTreeMap;

use crate::compare::Change;
use crate::numeral::written;
use crate::quantity::{Content, SetError, quantities};

/// The text with the numerals of these changes replaced; everything else stays, byte for byte.
///
/// # Errors
/// The text is no set, or it lacks one of the numbers.
pub fn edited(text: &str, changes: &[Change]) -> Result<String, SetError> {
    let found = quantities(text)?;
    let by_path: BTreeMap<&str, _> =
        found.iter().map(|quantity| (quantity.path.as_str(), quantity)).collect();
    let mut places = Vec::new();
    for change in changes {
        match (by_path.get(change.path.as_str()).map(|quantity| &quantity.content), change.new) {
            (Some(Content::Number { numeral, .. }), Some(new)) => places.push((numeral.clone(), new)),
            _ => {
                return Err(SetError {
                    message: format!("there is no number `{}` to replace", change.path),
                    help: None,
                    place: 0..0,
                });
            }
        }
    }
    places.sort_by_key(|(numeral, _)| numeral.start);
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for (numeral, new) in places {
        out.push_str(&text[at..numeral.start]);
        out.push_str(&written(new));
        at = numeral.end;
    }
    out.push_str(&text[at..]);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let out =
            edited(text, &[change("tcp[1]", 1e-9), change("mass", 13.5), change("n", 3.0)]).expect("a set");
        assert_eq!(
            out,
            text.replace("\"12 kg\"", "\"13.5 kg\"").replace("n: 2,", "n: 3,").replace("2.50", "1e-9")
        );
        assert!(edited(text, &[change("m", 1.0)]).is_err());
    }
}
