//! Dimensions as exponents of base units, and their names.

use crate::Unit;
use std::{fmt, sync::OnceLock};

/// Exponents of m, kg, s, A, K, mol, cd, cycle, rad.
///
/// `cycle` is counted so that a frequency in Hz (cycle/s) is not mistaken for one in rad/s. `rad` is kept for
/// display alone: checks ([`compatible`](Self::compatible), [`is_none`](Self::is_none)) ignore it, because
/// N*m*rad/s must equal W. `==` compares all nine, and whether anybody has said them.
///
/// The dimension of a signal may be open: a bare number went into it, which fits whatever it meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// The nine exponents in the order named above.
    pub exponents: [i8; 9],
    said: Said,
}

/// How far a dimension is one that somebody has said, least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
enum Said {
    /// Units were written.
    #[default]
    Yes,
    /// A number without unit is in it: the exponents hold unless something else is said.
    Open,
    /// Open ones have met that differ: it is anything.
    Nothing,
}

const BASE: [&str; 9] = ["m", "kg", "s", "A", "K", "mol", "cd", "cycle", "rad"];
/// The order in which base units are printed: kg*m^2, as in books.
const PRINTED: [usize; 9] = [1, 0, 2, 3, 4, 5, 6, 7, 8];
const METRE: usize = 0;
const KILOGRAM: usize = 1;
const AMPERE: usize = 3;
const CYCLE: usize = 7;
const RADIAN: usize = 8;
const TIME: Dimension = Dimension::of([0, 0, 1, 0, 0, 0, 0, 0, 0]);
const TIME_PER_CYCLE: Dimension = Dimension::of([0, 0, 1, 0, 0, 0, 0, -1, 0]);
const PER_SECOND: Dimension = Dimension::of([0, 0, -1, 0, 0, 0, 0, 0, 0]);

impl Dimension {
    /// The dimension of a plain number.
    pub const NONE: Self = Self::of([0; 9]);

    /// That of a bare number in a place without a fixed unit: of any unit, none as long as nothing else is said.
    pub const OPEN: Self = Self { exponents: [0; 9], said: Said::Open };

    /// The dimension of a plane angle.
    pub(crate) const RADIAN: Self = Self::of([0, 0, 0, 0, 0, 0, 0, 0, 1]);

    /// The dimension with these exponents, in the order of [`Dimension`].
    pub const fn of(exponents: [i8; 9]) -> Self {
        Self { exponents, said: Said::Yes }
    }

    /// Whether a bare number is in it, so that it fits whatever it meets.
    pub fn is_open(self) -> bool {
        self.said != Said::Yes
    }

    /// What two signals are in that are added or compared: what is said of one of them, or of both. `None` if that differs.
    pub fn meet(self, other: Self) -> Option<Self> {
        match (self.is_open(), other.is_open()) {
            (false, true) => Some(self),
            (true, false) => Some(other),
            (false, false) => self.compatible(other).then_some(self),
            (true, true) if self.exponents[..RADIAN] == other.exponents[..RADIAN] => {
                Some(Self { said: self.said.max(other.said), ..self })
            }
            (true, true) => Some(Self { exponents: [0; 9], said: Said::Nothing }),
        }
    }

    /// The factor, with its unit, that makes a quantity of this dimension of one in another: `1 V/A`. Of Hz it makes rad/s by a
    /// turn for each cycle.
    pub fn factor_from(self, other: Self) -> String {
        let unit = self.over(other);
        let turns = Self::RADIAN.over(Self::of([0, 0, 0, 0, 0, 0, 0, 1, 0]));
        let number = match unit {
            unit if unit == turns => "(2 * pi)",
            unit if unit == turns.power(-1) => "(0.5 / pi)",
            _ => "1",
        };
        format!("{number} {unit}")
    }

    /// The dimension that is left where nothing else is said; `None` where it may be anything.
    pub fn settled(self) -> Option<Self> {
        (self.said != Said::Nothing).then_some(Self::of(self.exponents))
    }

    /// The dimension of a product. Exponents stay within -128..=127.
    pub fn times(self, other: Self) -> Self {
        self.zip(other, i8::saturating_add)
    }

    /// The dimension of a quotient. Exponents stay within -128..=127.
    pub fn over(self, other: Self) -> Self {
        self.zip(other, i8::saturating_sub)
    }

    /// The dimension of the n-th power. Exponents stay within -128..=127.
    pub fn power(self, n: i8) -> Self {
        Self { exponents: self.exponents.map(|e| e.saturating_mul(n)), ..self }
    }

    /// The dimension of the n-th root; none if an exponent cannot be divided by n, or n is 0.
    /// An odd radian is dropped instead, for it is a plain number.
    pub fn root(self, n: i8) -> Option<Self> {
        let mut exponents = self.exponents;
        for (place, e) in exponents.iter_mut().enumerate() {
            *e = match e.checked_rem(n)? {
                0 => e.checked_div(n)?,
                _ if place == RADIAN => 0,
                _ if self.is_open() => return Some(Self { exponents: [0; 9], said: Said::Nothing }),
                _ => return None,
            };
        }
        Some(Self { exponents, ..self })
    }

    /// Whether two quantities of these dimensions may be added: equal but for rad, or one of them open.
    pub fn compatible(self, other: Self) -> bool {
        self.is_open() || other.is_open() || self.exponents[..RADIAN] == other.exponents[..RADIAN]
    }

    /// Whether a value of the other dimension may stand where one of this is wanted: a compatible one, or the period of a
    /// frequency, `1 / fs` in s/cycle, for a time.
    pub fn takes(self, other: Self) -> bool {
        self.compatible(other) || self == TIME && other == TIME_PER_CYCLE
    }

    /// Whether this is the dimension of a plain number or a plane angle.
    pub fn is_none(self) -> bool {
        self.exponents[..RADIAN] == Self::NONE.exponents[..RADIAN]
    }

    /// Whether an exponent has reached the end of its range, so that it may be wrong.
    pub(crate) fn is_saturated(self) -> bool {
        self.exponents.iter().any(|&e| e == i8::MAX || e <= -i8::MAX)
    }

    /// With cycles turned into radians, and how many there are: cycle/s becomes rad/s with 1. None without cycles.
    pub(crate) fn cycles_to_radians(self) -> Option<(Self, i8)> {
        let n = self.exponents[CYCLE];
        (n != 0).then(|| (self.exchange(CYCLE, RADIAN, n), n))
    }

    /// With radians turned into cycles, and how many there are: rad/s becomes cycle/s with 1. A mere 1/s counts as
    /// rad/s, for radians vanish in laws such as sqrt(k/m). None without radians.
    pub(crate) fn radians_to_cycles(self) -> Option<(Self, i8)> {
        let mut marked = self;
        if self == PER_SECOND {
            marked.exponents[RADIAN] = 1;
        }
        let n = marked.exponents[RADIAN];
        (n != 0).then(|| (marked.exchange(RADIAN, CYCLE, n), n))
    }

    fn exchange(mut self, from: usize, to: usize, n: i8) -> Self {
        self.exponents[from] = self.exponents[from].saturating_sub(n);
        self.exponents[to] = self.exponents[to].saturating_add(n);
        self
    }

    fn zip(self, other: Self, f: fn(i8, i8) -> i8) -> Self {
        let exponents = std::array::from_fn(|i| f(self.exponents[i], other.exponents[i]));
        match self.said.max(other.said) {
            Said::Nothing => Self { exponents: [0; 9], said: Said::Nothing },
            said => Self { exponents, said },
        }
    }

    fn size(self) -> u32 {
        self.exponents.iter().map(|e| u32::from(e.unsigned_abs())).sum()
    }

    /// Without the radians of an arc: rad * m is m, and so N*m*rad/s is W. `rad`, `rad/s` and `N*m/rad` keep theirs.
    fn without_arc(mut self) -> Self {
        if self.exponents[RADIAN] > 0 && self.exponents[METRE] > 0 {
            self.exponents[RADIAN] = 0;
        }
        self
    }
}

/// Forms that are printed as they stand when they fit exactly. The first of equal dimension wins.
const FORMS: [&str; 24] = [
    "Hz",
    "N",
    "Pa",
    "W",
    "C",
    "V",
    "F",
    "Ohm",
    "S",
    "Wb",
    "T",
    "H",
    "N*m",
    "N*m/rad",
    "N*m*s/rad",
    "N*s/m",
    "V*s/rad",
    "V/Hz",
    "W/m^2",
    "W/(m*K)",
    "W/(m^2*K)",
    "J/K",
    "J/(kg*K)",
    "J/mol",
];

fn forms() -> &'static [(Dimension, &'static str)] {
    static PARSED: OnceLock<Vec<(Dimension, &'static str)>> = OnceLock::new();
    PARSED.get_or_init(|| {
        let parsed = FORMS.iter().filter_map(|text| Some((Unit::parse(text).ok()?.dimension, *text)));
        parsed.collect()
    })
}

fn named(text: &str) -> Option<Dimension> {
    forms().iter().find(|(_, name)| *name == text).map(|(dimension, _)| *dimension)
}

/// Named units that may stand in a product with base units, by what the dimension contains. Motion alone is
/// printed in base units: m/s^2, not N/kg.
fn helpers(dimension: Dimension) -> &'static [&'static str] {
    let mass = dimension.exponents[KILOGRAM] != 0;
    let current = dimension.exponents[AMPERE] != 0;
    match (mass, current, dimension.exponents[CYCLE] != 0) {
        (true, true, false) => &["V", "Ohm", "N", "W", "Pa", "F", "H", "Wb", "T", "S"],
        (true, false, false) => &["N", "W", "Pa"],
        (false, true, false) => &["C"],
        (_, _, true) => &["Hz"],
        (false, false, false) => &[],
    }
}

impl fmt::Display for Dimension {
    /// The SI unit in ASCII: a named unit if one fits, else the shortest product of one named unit and base units.
    /// [`Unit::parse`] reads it back with scale 1.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = self.without_arc();
        if dimension == Self::NONE {
            return f.write_str("1");
        }
        if let Some((_, text)) = forms().iter().find(|(form, _)| *form == dimension) {
            return f.write_str(text);
        }
        let mut best = (dimension.size(), None, dimension);
        for name in helpers(dimension) {
            let Some(helper) = named(name) else { continue };
            for n in [1, -1, 2, -2] {
                let rest = dimension.over(helper.power(n));
                let size = rest.size() + u32::from(n.unsigned_abs());
                if size < best.0 {
                    best = (size, Some((*name, n)), rest);
                }
            }
        }
        let (_, helper, rest) = best;
        let base = PRINTED.map(|place| (BASE[place], rest.exponents[place]));
        f.write_str(&fraction(helper.into_iter().chain(base)))
    }
}

/// `a*b^2/(c*d)` from names with exponents.
fn fraction<'a>(factors: impl Iterator<Item = (&'a str, i8)>) -> String {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (name, exponent) in factors.filter(|(_, exponent)| *exponent != 0) {
        let side = if exponent > 0 { &mut above } else { &mut below };
        side.push(match exponent.unsigned_abs() {
            1 => name.to_string(),
            n => format!("{name}^{n}"),
        });
    }
    let above = if above.is_empty() { "1".to_string() } else { above.join("*") };
    match below.len() {
        0 => above,
        1 => format!("{above}/{}", below[0]),
        _ => format!("{above}/({})", below.join("*")),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_open_fits_everything_and_yields_to_what_is_said() {
        let of = |unit: &str| Unit::parse(unit).unwrap().dimension;
        let open = |unit: &str| of(unit).times(Dimension::OPEN);
        assert!(open("V").compatible(of("A")) && of("A").compatible(open("V")));
        assert!(open("V").is_open() && !of("V").is_open() && open("V") != of("V"));
        assert_eq!(of("V").meet(of("A")), None);
        assert_eq!(of("V").meet(open("A")), Some(of("V")));
        assert_eq!(open("A").meet(of("V")), Some(of("V")));
        assert_eq!(open("A").meet(open("A")).and_then(Dimension::settled), Some(of("A")));
        // Open ones that differ are anything, and so is all that is made of them.
        let anything = open("A").meet(open("V")).unwrap();
        assert_eq!(anything.times(of("s")).power(2).settled(), None);
        assert_eq!(anything.meet(of("s")), Some(of("s")));
        assert_eq!(anything.times(of("s")), anything, "else a loop of signals would never come to an end");
        assert_eq!(open("m/s").over(of("m")).settled(), Some(of("1/s")));
        assert_eq!(open("s").root(2).and_then(Dimension::settled), None);
        assert_eq!(of("s").root(2), None);
        assert!(Dimension::OPEN.is_none() && !open("s").is_none());
    }

    #[test]
    fn a_factor_leads_from_one_dimension_to_another() {
        let of = |unit: &str| Unit::parse(unit).unwrap().dimension;
        for (to, from, factor) in [
            ("V", "A", "1 Ohm"),
            ("V", "1", "1 V"),
            ("1", "s", "1 1/s"),
            ("rad/s", "Hz", "(2 * pi) rad/cycle"),
            ("Hz", "rad/s", "(0.5 / pi) cycle/rad"),
        ] {
            assert_eq!(of(to).factor_from(of(from)), factor);
        }
    }

    use super::*;

    fn dimension(text: &str) -> Dimension {
        Unit::parse(text).unwrap().dimension
    }

    #[test]
    fn every_form_is_a_unit_that_prints_as_itself() {
        assert_eq!(forms().len(), FORMS.len());
        for form in FORMS {
            assert_eq!(dimension(form).to_string(), form);
        }
    }

    #[test]
    fn names_are_those_of_the_field() {
        for (text, printed) in [
            ("%", "1"),
            ("rpm", "rad/s"),
            ("1/min", "1/s"),
            ("J", "N*m"),
            ("N*m*rad/s", "W"),
            ("m*rad", "m"),
            ("rad^2", "rad^2"),
            ("kg*m^2", "kg*m^2"),
            ("m/s^2", "m/s^2"),
            ("m^2/s^2", "m^2/s^2"),
            ("N/m", "N/m"),
            ("N*s/m", "N*s/m"),
            ("W/(rad/s)", "N*m/rad"),
            ("V*s/rad", "V*s/rad"),
            ("V^2", "V^2"),
            ("V/m", "V/m"),
            ("A/s", "A/s"),
            ("K/W", "K/W"),
            ("W/K", "W/K"),
            ("Hz/s", "Hz/s"),
            ("rad/(V*s)", "rad/Wb"),
            ("kg/m^3", "kg/m^3"),
            ("kg/(m*s)", "Pa*s"),
            ("mol*cd", "mol*cd"),
        ] {
            assert_eq!(dimension(text).to_string(), printed, "{text}");
        }
    }

    #[test]
    fn roots_undo_powers_and_drop_odd_radians() {
        assert_eq!(dimension("V").power(2).root(2), Some(dimension("V")));
        assert_eq!(dimension("V").root(2), None);
        assert_eq!(dimension("rad").root(2), Some(Dimension::NONE));
        assert_eq!(dimension("m^-3").root(-3), Some(dimension("m")));
        assert_eq!(dimension("m").root(0), None);
        assert_eq!(Dimension::of([-128; 9]).root(-1), None);
    }

    #[test]
    fn exponents_end_at_their_range() {
        let far = dimension("m").power(127);
        assert!(far.times(far).is_saturated() && far.power(-2).is_saturated());
        assert!(!dimension("kg*m^2/s^3").is_saturated());
    }
}
