//! Help for units that are not known.

use crate::{closest, unit_table};

/// What is said of an unknown symbol, and what is meant beyond doubt, if anything is.
struct Meant {
    hint: String,
    remedy: Option<String>,
}

impl Meant {
    fn surely(unit: &str) -> Self {
        Self { hint: format!("write `{unit}`"), remedy: Some(unit.to_owned()) }
    }

    fn perhaps(hint: String) -> Self {
        Self { hint, remedy: None }
    }
}

/// What may be meant by an unknown symbol: a word for a unit, a plural, a unit from elsewhere, other capitals, a power or a product
/// without sign, or a slip of the pen.
pub(crate) fn hint(symbol: &str) -> String {
    meant(symbol).hint
}

/// The unit that is meant beyond doubt, of those that [`hint`] speaks of. What replaces a unit in a text must not be another quantity or
/// another prefix.
pub(crate) fn remedy(symbol: &str) -> Option<String> {
    meant(symbol).remedy
}

const KNOWN: &str =
    "units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %";

/// Units that are written otherwise here.
const OTHERWISE: &[(&str, &str)] = &[
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("rps", "rev/s"),
    ("degK", "K"),
    ("psi", "lbf/in^2"),
    ("cfm", "ft^3/min"),
    ("inlb", "in*lbf"),
    ("ftlb", "ft*lbf"),
    ("inlbf", "in*lbf"),
    ("ftlbf", "ft*lbf"),
];

/// Units that are not known here, and what they are: B. N. Taylor, A. Thompson, NIST Special Publications 330 and 811 (2008).
const ELSEWHERE: &[(&str, &str)] = &[
    ("degF", "a temperature in degrees Fahrenheit is (value - 32) / 1.8 degC"),
    ("fahrenheit", "a temperature in degrees Fahrenheit is (value - 32) / 1.8 degC"),
    ("degR", "a temperature in degrees Rankine is value / 1.8 K"),
    ("grad", "a degree is `deg`, a gradian 0.9 deg"),
    ("mph", "1 mph is 0.44704 m/s"),
    ("mile", "1 mile is 1.609344 km"),
    ("mi", "1 mi is 1.609344 km"),
    ("knot", "1 knot is 1852 m/h"),
    ("kp", "1 kp is 9.80665 N"),
    ("kgf", "1 kgf is 9.80665 N"),
    ("oz", "1 oz is 28.349523125 g"),
    ("gpm", "1 gallon (US) a minute is 3.785411784 L/min"),
    ("gal", "1 gallon (US) is 3.785411784 L"),
    ("atm", "1 atm is 101325 Pa"),
    ("torr", "1 torr is 101325 Pa / 760"),
    ("mmHg", "1 mmHg is 133.3224 Pa"),
    ("cal", "1 cal is 4.184 J"),
    ("btu", "1 Btu is 1055.056 J"),
    ("dBm", "x dBm is 10^(x / 10) mW"),
    ("Mm", "1 Mm is 1000 km; a millimetre is `mm`"),
];

/// Words of which a plural is no product with the second.
const PLURAL: &[&str] = &["rad", "deg", "rev", "rpm", "min", "bar", "mol", "cycle", "ohm", "Ohm"];

/// What a time behind it is multiplied with.
const TIMES: &[&str] = &["V", "A", "W", "N", "J", "Nm", "VA", "Pa"];

fn meant(symbol: &str) -> Meant {
    let known = written_otherwise(symbol).or_else(|| without_sign(symbol)).or_else(|| misspelt(symbol));
    known.unwrap_or_else(|| guessed(symbol))
}

fn is_unit(text: &str) -> bool {
    unit_table::find(text).is_some()
}

fn same(a: &str, b: &str) -> bool {
    a.eq_ignore_ascii_case(b)
}

/// A word for a unit, a plural, a unit from elsewhere.
fn written_otherwise(symbol: &str) -> Option<Meant> {
    if symbol == unit_table::DECIBEL {
        let hint = "dB stands only directly behind the number of a whole literal, such as \"-3 dB\"";
        return Some(Meant::perhaps(hint.to_owned()));
    }
    let singular = symbol.strip_suffix('s').filter(|word| word.len() > 1).unwrap_or(symbol);
    let is_word = |word: &str| same(word, symbol) || same(word, singular);
    let here = unit_table::WORDS.iter().find(|(word, _)| is_word(word));
    let here = here.or_else(|| OTHERWISE.iter().find(|(word, _)| *word == symbol));
    let here = here.map(|(_, unit)| *unit).or_else(|| PLURAL.contains(&singular).then_some(singular));
    here.map(Meant::surely).or_else(|| {
        let is_it = |word: &str| word == symbol || word.len() > 2 && is_word(word);
        let elsewhere = ELSEWHERE.iter().find(|(word, _)| is_it(word));
        elsewhere.map(|(_, hint)| Meant::perhaps((*hint).to_owned()))
    })
}

/// Both units of each product that the symbol may be.
fn products(symbol: &str) -> Vec<(&str, &str)> {
    let splits = symbol.char_indices().skip(1).map(|(i, _)| symbol.split_at(i));
    splits.filter(|(a, b)| is_unit(a) && is_unit(b)).collect()
}

/// A power or a product with a time without its sign: `mm2`, and `mAs` with a prefix, but not `N*ms` for `Nms`. Before a product comes a letter
/// that was typed twice, as in `mss`; but `Nmm` is one.
fn without_sign(symbol: &str) -> Option<Meant> {
    let power = symbol.split_at_checked(symbol.len().saturating_sub(1));
    if let Some((unit, power)) = power.filter(|(unit, power)| matches!(*power, "2" | "3") && is_unit(unit)) {
        return Some(Meant::surely(&format!("{unit}^{power}")));
    }
    let products = products(symbol);
    if let Some(unit) = typed_once(symbol, |letter| products.is_empty() || letter == 's') {
        return Some(Meant { hint: format!("did you mean `{unit}`?"), remedy: Some(unit) });
    }
    let times =
        |left: &str, unit: &str| left.strip_suffix(unit).is_some_and(|prefix| prefix.chars().count() < 2);
    let with_time = products
        .iter()
        .find(|(left, right)| matches!(*right, "s" | "h") && TIMES.iter().any(|unit| times(left, unit)));
    with_time.map(|(left, right)| Meant::surely(&format!("{left}*{right}")))
}

/// The unit that is left where a letter that stands twice stands once.
fn typed_once(symbol: &str, may: impl Fn(char) -> bool) -> Option<String> {
    let letters: Vec<char> = symbol.chars().collect();
    if letters.len() < 3 {
        return None;
    }
    let twice = (1..letters.len()).filter(|i| letters[*i] == letters[i - 1] && may(letters[*i]));
    let without = |at: usize| -> String {
        letters.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, letter)| *letter).collect()
    };
    twice.map(without).find(|once| is_unit(once))
}

/// Other capitals, or the letters of a unit in another order behind the first.
fn misspelt(symbol: &str) -> Option<Meant> {
    let symbols = unit_table::symbols();
    let first = |text: &str| text.chars().next();
    let spelt: Vec<&String> = symbols.iter().filter(|known| same(known, symbol)).collect();
    if let [only] = spelt[..] {
        // A capital makes a million of a thousandth, and a letter alone is as well a prefix.
        let is_prefix =
            first(symbol) != first(only) && matches!(first(symbol), Some('M' | 'm' | 'P' | 'p' | 'G' | 'g'));
        let remedy = (!is_prefix && symbol.chars().count() > 1).then(|| only.clone());
        return Some(Meant { hint: format!("did you mean `{only}`?"), remedy });
    }
    let sorted = |text: &str| {
        let mut letters: Vec<char> = text.chars().collect();
        letters.sort_unstable();
        letters
    };
    let is_turned = |known: &&String| first(known) == first(symbol) && sorted(known) == sorted(symbol);
    let turned: Vec<&String> = symbols.iter().filter(is_turned).collect();
    match turned[..] {
        [only] if symbol.chars().count() > 2 => {
            Some(Meant { hint: format!("did you mean `{only}`?"), remedy: Some(only.clone()) })
        }
        _ => None,
    }
}

/// What is like it, if anything is.
fn guessed(symbol: &str) -> Meant {
    let symbols = unit_table::symbols();
    let near = closest(symbol, symbols.iter().map(String::as_str));
    let near = near.filter(|near| same(near, symbol) || symbol.chars().count() > 3);
    match (near, &products(symbol)[..]) {
        (Some(near), _) => Meant::perhaps(format!("did you mean `{near}`?")),
        (None, [(left, right)]) => Meant::perhaps(format!("did you mean `{left}*{right}`?")),
        (None, _) => Meant::perhaps(KNOWN.to_owned()),
    }
}
