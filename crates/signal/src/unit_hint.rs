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
    if symbol == unit_table::DECIBEL {
        let hint = "dB stands only directly behind the number of a whole literal, such as \"-3 dB\"";
        return Meant::perhaps(hint.to_owned());
    }
    let is_unit = |text: &str| unit_table::find(text).is_some();
    let singular = symbol.strip_suffix('s').filter(|word| word.len() > 1).unwrap_or(symbol);
    let same = |a: &str, b: &str| a.eq_ignore_ascii_case(b);
    let is_word = |word: &str| same(word, symbol) || same(word, singular);
    if let Some((_, short)) = unit_table::WORDS.iter().find(|(word, _)| is_word(word)) {
        return Meant::surely(short);
    }
    if PLURAL.contains(&singular) {
        return Meant::surely(singular);
    }
    if let Some((_, unit)) = OTHERWISE.iter().find(|(word, _)| *word == symbol) {
        return Meant::surely(unit);
    }
    let elsewhere = ELSEWHERE.iter().find(|(word, _)| *word == symbol || word.len() > 2 && is_word(word));
    if let Some((_, hint)) = elsewhere {
        return Meant::perhaps((*hint).to_owned());
    }
    if let Some((unit, power)) = symbol.split_at_checked(symbol.len().saturating_sub(1))
        && matches!(power, "2" | "3")
        && is_unit(unit)
    {
        return Meant::surely(&format!("{unit}^{power}"));
    }
    let splits = symbol.char_indices().skip(1).map(|(i, _)| symbol.split_at(i));
    let splits: Vec<(&str, &str)> = splits.filter(|(a, b)| is_unit(a) && is_unit(b)).collect();
    // A letter that was typed twice; but `Nmm` is a product.
    let letters: Vec<char> = symbol.chars().collect();
    let once = (1..letters.len())
        .filter(|i| letters[*i] == letters[i - 1] && (splits.is_empty() || letters[*i] == 's'))
        .map(|twice| {
            letters
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != twice)
                .map(|(_, letter)| *letter)
                .collect::<String>()
        });
    if let Some(unit) = once.filter(|_| letters.len() > 2).find(|once| is_unit(once)) {
        return Meant { hint: format!("did you mean `{unit}`?"), remedy: Some(unit) };
    }
    // `mAs` with a prefix, and not `N*ms` for `Nms`.
    let is_product = |(left, right): &&(&str, &str)| {
        let times = |unit: &str| left.strip_suffix(unit).is_some_and(|prefix| prefix.chars().count() < 2);
        matches!(*right, "s" | "h") && TIMES.iter().copied().any(times)
    };
    if let Some((left, right)) = splits.iter().find(is_product) {
        return Meant::surely(&format!("{left}*{right}"));
    }
    let symbols = unit_table::symbols();
    let spelt: Vec<&String> = symbols.iter().filter(|known| same(known, symbol)).collect();
    if let [only] = spelt[..] {
        // A capital makes a million of a thousandth.
        let first = |text: &str| text.chars().next();
        let is_prefix =
            first(symbol) != first(only) && matches!(first(symbol), Some('M' | 'm' | 'P' | 'p' | 'G' | 'g'));
        // A letter alone is as well a prefix.
        let remedy = (!is_prefix && symbol.chars().count() > 1).then(|| only.clone());
        return Meant { hint: format!("did you mean `{only}`?"), remedy };
    }
    let sorted = |text: &str| {
        let mut letters: Vec<char> = text.chars().collect();
        letters.sort_unstable();
        letters
    };
    let is_turned =
        |known: &&String| known.chars().next() == symbol.chars().next() && sorted(known) == sorted(symbol);
    let turned: Vec<&String> = symbols.iter().filter(is_turned).collect();
    if let ([only], true) = (&turned[..], symbol.chars().count() > 2) {
        return Meant { hint: format!("did you mean `{only}`?"), remedy: Some((*only).clone()) };
    }
    let near = closest(symbol, symbols.iter().map(String::as_str));
    let is_like = |near: &&str| same(near, symbol) || symbol.chars().count() > 3;
    match (near.filter(is_like), &splits[..]) {
        (Some(near), _) => Meant::perhaps(format!("did you mean `{near}`?")),
        (None, [(left, right)]) => Meant::perhaps(format!("did you mean `{left}*{right}`?")),
        (None, _) => Meant::perhaps(KNOWN.to_owned()),
    }
}
