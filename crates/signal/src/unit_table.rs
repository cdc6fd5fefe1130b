//! The units that are known, and the prefixes they take.

use crate::Dimension;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A unit, or a product of units: the value in SI is `number * above / below + offset`. Both sides of the scale are
/// kept apart so that powers of ten stay exact: 9 ms is 9 / 1000 s, which `9 * 0.001` misses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Factor {
    pub above: f64,
    pub below: f64,
    pub offset: f64,
    pub dimension: Dimension,
}

impl Factor {
    pub const ONE: Self = Self { above: 1.0, below: 1.0, offset: 0.0, dimension: Dimension::NONE };

    pub fn scale(self) -> f64 {
        self.above / self.below
    }

    pub fn times(self, other: Self) -> Self {
        let (above, below) = (self.above * other.above, self.below * other.below);
        Self { above, below, offset: 0.0, dimension: self.dimension.times(other.dimension) }
    }

    /// The n-th power, n from -127 to 127.
    pub fn power(self, n: i8) -> Self {
        let size = i32::from(n).abs();
        let (above, below) = (self.above.powi(size), self.below.powi(size));
        let (above, below) = if n < 0 { (below, above) } else { (above, below) };
        Self { above, below, offset: 0.0, dimension: self.dimension.power(n) }
    }
}

struct Entry {
    symbols: &'static [&'static str],
    above: f64,
    below: f64,
    exponents: [i8; 9],
    prefixes: &'static str,
}

const fn entry(
    symbols: &'static [&'static str],
    above: f64,
    below: f64,
    exponents: [i8; 9],
    prefixes: &'static str,
) -> Entry {
    Entry { symbols, above, below, exponents, prefixes }
}

/// `u` stands for all spellings of micro.
const ENGINEERING: &str = "pnumkMG";

const W: [i8; 9] = [2, 1, -3, 0, 0, 0, 0, 0, 0];
const PLAIN: [i8; 9] = [0; 9];
const ANGLE: [i8; 9] = [0, 0, 0, 0, 0, 0, 0, 0, 1];
const TIME: [i8; 9] = [0, 0, 1, 0, 0, 0, 0, 0, 0];
const OHM: [i8; 9] = [2, 1, -3, -2, 0, 0, 0, 0, 0];

/// Exponents in the order m, kg, s, A, K, mol, cd, cycle, rad. A unit takes the prefixes that are in use with it,
/// which also keeps `min` a minute, `h` an hour, `Pa` a pascal and `cd` a candela.
const TABLE: &[Entry] = &[
    entry(&["m"], 1.0, 1.0, [1, 0, 0, 0, 0, 0, 0, 0, 0], "pnumcdk"),
    entry(&["g"], 1.0, 1000.0, [0, 1, 0, 0, 0, 0, 0, 0, 0], "numk"),
    entry(&["s"], 1.0, 1.0, TIME, "pnum"),
    entry(&["A"], 1.0, 1.0, [0, 0, 0, 1, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["K"], 1.0, 1.0, [0, 0, 0, 0, 1, 0, 0, 0, 0], "um"),
    entry(&["mol"], 1.0, 1.0, [0, 0, 0, 0, 0, 1, 0, 0, 0], "numk"),
    entry(&["cd"], 1.0, 1.0, [0, 0, 0, 0, 0, 0, 1, 0, 0], "mk"),
    entry(&["N"], 1.0, 1.0, [1, 1, -2, 0, 0, 0, 0, 0, 0], "pnumckMG"),
    entry(&["J"], 1.0, 1.0, [2, 1, -2, 0, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["W"], 1.0, 1.0, W, ENGINEERING),
    entry(&["VA"], 1.0, 1.0, W, "mkMG"),
    entry(&["var"], 1.0, 1.0, W, "mkMG"),
    entry(&["V"], 1.0, 1.0, [2, 1, -3, -1, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["Ohm", "ohm", "Ω", "\u{2126}"], 1.0, 1.0, OHM, ENGINEERING),
    entry(&["F"], 1.0, 1.0, [-2, -1, 4, 2, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["H"], 1.0, 1.0, [2, 1, -2, -2, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["Wb"], 1.0, 1.0, [2, 1, -2, -1, 0, 0, 0, 0, 0], "num"),
    entry(&["T"], 1.0, 1.0, [0, 1, -2, -1, 0, 0, 0, 0, 0], "pnumk"),
    entry(&["S"], 1.0, 1.0, [-2, -1, 3, 2, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["Pa"], 1.0, 1.0, [-1, 1, -2, 0, 0, 0, 0, 0, 0], "pnumhkMG"),
    entry(&["Hz"], 1.0, 1.0, [0, 0, -1, 0, 0, 0, 0, 1, 0], "umkMG"),
    entry(&["C"], 1.0, 1.0, [0, 0, 1, 1, 0, 0, 0, 0, 0], ENGINEERING),
    entry(&["rad"], 1.0, 1.0, ANGLE, "um"),
    entry(&["deg", "°"], PI, 180.0, ANGLE, ""),
    entry(&["rev"], 2.0 * PI, 1.0, ANGLE, ""),
    entry(&["rpm"], 2.0 * PI, 60.0, [0, 0, -1, 0, 0, 0, 0, 0, 1], ""),
    entry(&["cycle"], 1.0, 1.0, [0, 0, 0, 0, 0, 0, 0, 1, 0], ""),
    entry(&["min"], 60.0, 1.0, TIME, ""),
    entry(&["h"], 3600.0, 1.0, TIME, ""),
    entry(&["bar"], 1e5, 1.0, [-1, 1, -2, 0, 0, 0, 0, 0, 0], "m"),
    entry(&["L"], 1.0, 1000.0, [3, 0, 0, 0, 0, 0, 0, 0, 0], "umcdh"),
    entry(&["t"], 1000.0, 1.0, [0, 1, 0, 0, 0, 0, 0, 0, 0], ""),
    entry(&["Wh"], 3600.0, 1.0, [2, 1, -2, 0, 0, 0, 0, 0, 0], "mkMG"),
    entry(&["Ah"], 3600.0, 1.0, [0, 0, 1, 1, 0, 0, 0, 0, 0], "umk"),
    entry(&["%"], 1.0, 100.0, PLAIN, ""),
    entry(&["Nm"], 1.0, 1.0, [2, 1, -2, 0, 0, 0, 0, 0, 0], "mkM"),
    entry(&["in"], 254.0, 10_000.0, [1, 0, 0, 0, 0, 0, 0, 0, 0], ""),
    entry(&["ft"], 3048.0, 10_000.0, [1, 0, 0, 0, 0, 0, 0, 0, 0], ""),
    // The international pound, the force of one under 9.80665 m/s^2, and 550 ft*lbf/s: NIST Special Publication 811 (2008),
    // appendix B.8.
    entry(&["lb"], 0.453_592_37, 1.0, [0, 1, 0, 0, 0, 0, 0, 0, 0], ""),
    entry(&["lbf"], 4.448_221_615_260_5, 1.0, [1, 1, -2, 0, 0, 0, 0, 0, 0], ""),
    entry(&["hp"], 745.699_871_582_270_2, 1.0, W, ""),
    entry(&["gauss"], 1.0, 10_000.0, [0, 1, -2, -1, 0, 0, 0, 0, 0], "k"),
];

/// Degrees Celsius: the one unit with an offset, fit for whole literals only.
pub(crate) fn is_celsius(symbol: &str) -> bool {
    matches!(symbol, "degC" | "°C")
}

/// The decibel of an amplitude: x dB is the ratio 10^(x / 20). It is no factor, and fit for whole literals only.
pub(crate) const DECIBEL: &str = "dB";

/// The unit of a symbol with or without prefix.
pub(crate) fn find(symbol: &str) -> Option<Factor> {
    if is_celsius(symbol) {
        let kelvin = find("K")?;
        return Some(Factor { offset: 273.15, ..kelvin });
    }
    static SYMBOLS: LazyLock<HashMap<&str, &Entry>> = LazyLock::new(|| {
        TABLE.iter().flat_map(|entry| entry.symbols.iter().map(move |symbol| (*symbol, entry))).collect()
    });
    if let Some(entry) = SYMBOLS.get(symbol) {
        return Some(factor(entry, 1.0, 1.0));
    }
    let prefix = symbol.chars().next()?;
    let rest = &symbol[prefix.len_utf8()..];
    let prefix = if matches!(prefix, 'µ' | 'μ') { 'u' } else { prefix };
    let entry = SYMBOLS.get(rest).filter(|entry| entry.prefixes.contains(prefix))?;
    let (above, below) = prefix_scale(prefix);
    Some(factor(entry, above, below))
}

fn factor(entry: &Entry, above: f64, below: f64) -> Factor {
    let (mut above, mut below) = (entry.above * above, entry.below * below);
    if above == below {
        (above, below) = (1.0, 1.0);
    }
    Factor { above, below, offset: 0.0, dimension: Dimension::of(entry.exponents) }
}

fn prefix_scale(prefix: char) -> (f64, f64) {
    match prefix {
        'p' => (1.0, 1e12),
        'n' => (1.0, 1e9),
        'u' => (1.0, 1e6),
        'm' => (1.0, 1e3),
        'c' => (1.0, 1e2),
        'd' => (1.0, 1e1),
        'h' => (1e2, 1.0),
        'k' => (1e3, 1.0),
        'M' => (1e6, 1.0),
        'G' => (1e9, 1.0),
        _ => (1.0, 1.0),
    }
}

/// All symbols with all their prefixes, for spelling help and tests.
pub(crate) fn symbols() -> Vec<String> {
    let mut all = vec!["degC".to_string(), "°C".to_string()];
    for entry in TABLE {
        for symbol in entry.symbols {
            all.push(symbol.to_string());
            all.extend(entry.prefixes.chars().map(|prefix| format!("{prefix}{symbol}")));
        }
    }
    all
}

/// Words people write for units, each with the symbol that is meant.
pub(crate) const WORDS: &[(&str, &str)] = &[
    ("metre", "m"),
    ("meter", "m"),
    ("gram", "g"),
    ("kilogram", "kg"),
    ("second", "s"),
    ("sec", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("ampere", "A"),
    ("amp", "A"),
    ("kelvin", "K"),
    ("celsius", "degC"),
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("pound", "lb"),
    ("lbs", "lb"),
    ("horsepower", "hp"),
    ("decibel", "dB"),
    ("Gs", "gauss"),
    ("newton", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("volt", "V"),
    ("farad", "F"),
    ("henry", "H"),
    ("weber", "Wb"),
    ("tesla", "T"),
    ("siemens", "S"),
    ("pascal", "Pa"),
    ("hertz", "Hz"),
    ("coulomb", "C"),
    ("radian", "rad"),
    ("degree", "deg"),
    ("turn", "rev"),
    ("revolution", "rev"),
    ("litre", "L"),
    ("liter", "L"),
    ("l", "L"),
    ("tonne", "t"),
    ("percent", "%"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn no_symbol_has_two_meanings() {
        let mut seen = BTreeMap::new();
        for symbol in symbols() {
            let factor = find(&symbol).unwrap();
            assert_eq!(seen.insert(symbol.clone(), factor), None, "{symbol}");
        }
        assert!(seen.len() > 150, "{}", seen.len());
    }

    #[test]
    fn short_symbols_mean_what_the_field_means() {
        let same = |a: &str, b: &str| assert_eq!(find(a), find(b), "{a} {b}");
        same("µm", "um");
        same("\u{3bc}F", "uF");
        same("kΩ", "kohm");
        same("°", "deg");
        for (symbol, scale) in [
            ("m", 1.0),
            ("min", 60.0),
            ("h", 3600.0),
            ("kg", 1.0),
            ("mm", 1e-3),
            ("Pa", 1.0),
            ("t", 1e3),
            ("mg", 1e-6),
        ] {
            assert_eq!(find(symbol).unwrap().scale(), scale, "{symbol}");
        }
        for unknown in ["d", "G", "kmin", "mh", "l", "x", "µ", "", "kk", "kdegC", "mkg"] {
            assert_eq!(find(unknown), None, "{unknown}");
        }
    }
}
