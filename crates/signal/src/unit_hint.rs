//! Help for units that are not known.

use crate::{closest, surely, unit_table};

/// What may be meant by an unknown symbol: a word for a unit, a plural, other capitals, a product without sign, or a
/// slip of the pen.
pub(crate) fn hint(symbol: &str) -> String {
    if symbol == unit_table::DECIBEL {
        return "dB stands only directly behind the number of a whole literal, such as \"-3 dB\"".to_owned();
    }
    let is_unit = |text: &str| unit_table::find(text).is_some();
    let singular = symbol.strip_suffix('s').filter(|word| word.len() > 1).unwrap_or(symbol);
    let same = |a: &str, b: &str| a.eq_ignore_ascii_case(b);
    let word = unit_table::WORDS.iter().find(|(word, _)| same(word, symbol) || same(word, singular));
    if let Some((_, short)) = word {
        return format!("write `{short}`");
    }
    if is_unit(singular) {
        return format!("write `{singular}`");
    }
    let symbols = unit_table::symbols();
    let split = || {
        symbol.char_indices().skip(1).map(|(i, _)| symbol.split_at(i)).find(|(a, b)| is_unit(a) && is_unit(b))
    };
    match closest(symbol, symbols.iter().map(String::as_str)) {
        Some(near) if same(near, symbol) => format!("did you mean `{near}`?"),
        near => match (split(), near) {
            (Some((left, right)), _) => format!("write `{left}*{right}`"),
            (None, Some(near)) => format!("did you mean `{near}`?"),
            (None, None) => KNOWN.to_string(),
        },
    }
}

/// The unit that is meant beyond doubt, of those that [`hint`] speaks of.
pub(crate) fn remedy(symbol: &str) -> Option<String> {
    let said = hint(symbol);
    let named = said.strip_prefix("write `").and_then(|rest| rest.strip_suffix('`'));
    // Capitals and prefixes tell units apart, so a symbol must be alone among those that are spelt like it.
    let symbols = || unit_table::symbols();
    let near = || surely(symbol, symbols().iter().map(String::as_str)).map(str::to_owned);
    named.map(str::to_owned).or_else(near)
}

const KNOWN: &str =
    "units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %";
