//! What the declaration of a parameter requires of its value: `#[block(positive)]`, `#[block(above = lower)]` ...
//!
//! Requirements are data. One function looks whether values meet them ([`check`]), whatever the kind; manual, editor and messages put
//! them into words ([`Requirements::range`]).

mod check;
mod inspect;

pub(crate) use check::check;
pub use inspect::Inspect;

use blocksim_signal::Unit;

use crate::ParameterInfo;

/// One thing that the value of a parameter must be, or all numbers of it where it is a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Requirement {
    /// A number that is neither infinite nor NaN.
    Finite,
    /// Not zero.
    NotZero,
    /// Greater than this.
    Above(Bound),
    /// At least this.
    AtLeast(Bound),
    /// Less than this.
    Below(Bound),
    /// At most this.
    AtMost(Bound),
    /// A list or a text with something in it.
    NotEmpty,
    /// A list whose numbers increase, each greater than the one before.
    Increasing,
    /// A list of as many elements as another parameter has.
    AsManyAs(&'static str),
    /// A text that names a unit.
    Unit,
    /// Numbers that are the components of a direction: not all of them zero.
    Direction,
}

/// Where a range ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// At a number, in SI.
    Number(f64),
    /// At the value of another parameter of the same block, where that has one.
    Parameter(&'static str),
}

/// All that is required of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirements {
    /// What its value must be.
    pub list: &'static [Requirement],
    /// What to do where it is something else; empty for the words that follow from the list.
    pub remedy: &'static str,
    /// What to do where it is exactly zero, or a list or text with nothing in it; empty for the same as elsewhere.
    pub at_nothing: &'static str,
}

impl Requirements {
    /// No requirements.
    pub const NONE: Requirements = Requirements { list: &[], remedy: "", at_nothing: "" };

    /// The values that are allowed, as a manual shows them: `> 0`, `0 to 1`, `> lower`, `increasing`; empty where all are. That numbers
    /// are finite goes without saying, as does that those are below infinity which may be infinite.
    pub fn range(&self, unit: &str) -> String {
        let unit = Shown::si(unit);
        use Requirement::{Above, AtLeast, AtMost, Below};
        let is_shown = |one: &Requirement| match one {
            Above(Bound::Number(end)) | Below(Bound::Number(end)) => end.is_finite(),
            _ => true,
        };
        let ends = |list: &[Requirement]| match list {
            [AtLeast(Bound::Number(lower)), AtMost(Bound::Number(upper))] => {
                Some(format!("{} to {}", unit.number(*lower), unit.value(*upper)))
            }
            _ => None,
        };
        if let Some(range) = ends(&self.without_finite()) {
            return range;
        }
        let shown = self.without_finite().into_iter().filter(is_shown);
        let words: Vec<String> = shown.map(|one| one.sign(unit)).collect();
        words.join(", ")
    }

    fn without_finite(&self) -> Vec<Requirement> {
        self.list.iter().copied().filter(|one| *one != Requirement::Finite).collect()
    }

    /// What must be, behind `but`: `must be positive`, `must be above 0 and at most 1`.
    pub(crate) fn demand(&self, unit: Shown) -> String {
        use Requirement::{Above, AtLeast, AtMost, Below, NotZero};
        let own: Vec<Requirement> =
            self.without_finite().into_iter().filter(Requirement::is_of_numbers).collect();
        match own[..] {
            [] => "must be finite".to_owned(),
            [Above(Bound::Number(0.0))] => "must be positive".to_owned(),
            [AtLeast(Bound::Number(0.0))] => "must not be negative".to_owned(),
            [Below(Bound::Number(0.0))] => "must be negative".to_owned(),
            [NotZero] => "must be finite and not 0".to_owned(),
            [AtLeast(Bound::Number(lower)), AtMost(Bound::Number(upper))] => {
                format!("must be from {} to {}", unit.number(lower), unit.value(upper))
            }
            _ => {
                let words: Vec<String> = own.iter().map(|one| one.words(unit)).collect();
                format!("must be {}", words.join(" and "))
            }
        }
    }
}

impl Requirement {
    /// Whether each number alone meets it or not.
    pub(crate) fn is_of_numbers(&self) -> bool {
        use Requirement::{Above, AtLeast, AtMost, Below, Finite, NotZero};
        matches!(
            self,
            Finite
                | NotZero
                | Above(Bound::Number(_))
                | AtLeast(Bound::Number(_))
                | Below(Bound::Number(_))
                | AtMost(Bound::Number(_))
        )
    }

    /// Whether a number meets it. NaN meets none.
    fn allows(&self, value: f64, bound: impl Fn(Bound) -> f64) -> bool {
        match *self {
            Requirement::Finite => value.is_finite(),
            Requirement::NotZero => value != 0.0 && !value.is_nan(),
            Requirement::Above(than) => value > bound(than),
            Requirement::AtLeast(than) => value >= bound(than),
            Requirement::Below(than) => value < bound(than),
            Requirement::AtMost(than) => value <= bound(than),
            Requirement::NotEmpty
            | Requirement::Increasing
            | Requirement::AsManyAs(_)
            | Requirement::Unit
            | Requirement::Direction => true,
        }
    }

    /// The other parameter that it is about.
    pub fn other(&self) -> Option<&'static str> {
        match *self {
            Requirement::AsManyAs(other) => Some(other),
            Requirement::Above(Bound::Parameter(other))
            | Requirement::AtLeast(Bound::Parameter(other))
            | Requirement::Below(Bound::Parameter(other))
            | Requirement::AtMost(Bound::Parameter(other)) => Some(other),
            _ => None,
        }
    }

    fn sign(&self, unit: Shown) -> String {
        let with = |sign: &str, bound: Bound| format!("{sign} {}", bound.shown(unit));
        match *self {
            Requirement::Finite => "finite".to_owned(),
            Requirement::NotZero => "not 0".to_owned(),
            Requirement::Above(bound) => with(">", bound),
            Requirement::AtLeast(bound) => with(">=", bound),
            Requirement::Below(bound) => with("<", bound),
            Requirement::AtMost(bound) => with("<=", bound),
            Requirement::NotEmpty => "not empty".to_owned(),
            Requirement::Increasing => "increasing".to_owned(),
            Requirement::AsManyAs(other) => format!("as many as `{other}`"),
            Requirement::Unit => "a unit".to_owned(),
            Requirement::Direction => "not all 0".to_owned(),
        }
    }

    fn words(&self, unit: Shown) -> String {
        let with = |words: &str, bound: Bound| format!("{words} {}", bound.shown(unit));
        match *self {
            Requirement::NotZero => "not 0".to_owned(),
            Requirement::Above(bound) => with("above", bound),
            Requirement::AtLeast(bound) => with("at least", bound),
            Requirement::Below(bound) => with("below", bound),
            Requirement::AtMost(bound) => with("at most", bound),
            _ => self.sign(unit),
        }
    }
}

impl Bound {
    fn shown(self, unit: Shown) -> String {
        match self {
            Bound::Number(value) => unit.value(value),
            Bound::Parameter(name) => format!("`{name}`"),
        }
    }
}

impl ParameterInfo {
    /// The values that are allowed, see [`Requirements::range`].
    pub fn range(&self) -> String {
        self.requires.range(self.unit)
    }
}

/// The unit in which numbers of a parameter are shown.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'u> {
    /// That of the parameter in SI.
    si: &'u str,
    /// The one in which its value is written.
    written: Option<&'u Unit>,
}

impl<'u> Shown<'u> {
    pub fn si(unit: &'u str) -> Self {
        Self { si: unit, written: None }
    }

    pub fn written(self, written: Option<&'u Unit>) -> Self {
        Self { written, ..self }
    }

    /// A number with its unit. Zero has none, where it is zero in every unit, and whole degrees are shown as such.
    pub fn value(self, value: f64) -> String {
        let unit = match (self.written, self.si) {
            (Some(unit), _) if value != 0.0 || unit.offset != 0.0 => unit.text.as_str(),
            (None, "rad") if value != 0.0 && in_degrees(value).is_some() => "deg",
            (None, "" | "1") => "",
            _ if value == 0.0 => "",
            (_, unit) => unit,
        };
        let number = self.number(value);
        if unit.is_empty() { number } else { format!("{number} {unit}") }
    }

    /// The number alone, as it stands in [`value`](Self::value).
    pub fn number(self, value: f64) -> String {
        let value = match (self.written, self.si) {
            (Some(unit), _) => rounded(unit.from_si(value)),
            (None, "rad" | "deg") => in_degrees(value).unwrap_or(value),
            _ => value,
        };
        let number = format!("{value:?}");
        number.strip_suffix(".0").unwrap_or(&number).to_owned()
    }
}

/// Without what conversion from SI leaves in the last digits.
fn rounded(value: f64) -> f64 {
    let short: f64 = format!("{value:.13e}").parse().unwrap_or(value);
    if format!("{short:?}").len() < format!("{value:?}").len() { short } else { value }
}

/// An angle in degrees, where these are a whole number.
fn in_degrees(value: f64) -> Option<f64> {
    let degrees = value.to_degrees();
    ((degrees - degrees.round()).abs() < 1e-12 * degrees.abs()).then(|| degrees.round())
}

#[cfg(test)]
mod tests {
    use super::*;
    use Bound::Number;
    use Requirement::{Above, AsManyAs, AtLeast, AtMost, Below, Finite, Increasing, NotEmpty, NotZero};

    #[test]
    fn ranges_and_demands_are_short() {
        for (list, unit, range, demand) in [
            (&[][..], "s", "", "must be finite"),
            (&[Finite], "s", "", "must be finite"),
            (&[Finite, Above(Number(0.0))], "s", "> 0", "must be positive"),
            (&[Finite, AtLeast(Number(0.0))], "s", ">= 0", "must not be negative"),
            (&[Finite, Below(Number(0.0))], "1/s", "< 0", "must be negative"),
            (&[Finite, NotZero], "", "not 0", "must be finite and not 0"),
            (&[AtLeast(Number(0.0)), AtMost(Number(1.0))], "", "0 to 1", "must be from 0 to 1"),
            (
                &[Finite, Above(Number(0.0)), AtMost(Number(1.0))],
                "1",
                "> 0, <= 1",
                "must be above 0 and at most 1",
            ),
            (
                &[Above(Number(0.0)), Below(Number(std::f64::consts::FRAC_PI_2))],
                "rad",
                "> 0, < 90 deg",
                "must be above 0 and below 90 deg",
            ),
            (
                &[AtLeast(Number(16.0)), AtMost(Number(1e6))],
                "",
                "16 to 1000000",
                "must be from 16 to 1000000",
            ),
            (&[Above(Bound::Parameter("lower"))], "m", "> `lower`", "must be finite"),
            (
                &[Above(Number(f64::NEG_INFINITY)), Below(Bound::Parameter("upper"))],
                "m",
                "< `upper`",
                "must be above -inf m",
            ),
            (
                &[NotEmpty, Increasing, AsManyAs("rows")],
                "",
                "not empty, increasing, as many as `rows`",
                "must be finite",
            ),
        ] {
            let requirements = Requirements { list, ..Requirements::NONE };
            assert_eq!(
                (requirements.range(unit).as_str(), requirements.demand(Shown::si(unit)).as_str()),
                (range, demand)
            );
        }
    }

    #[test]
    fn numbers_are_shown_in_the_unit_that_is_written() {
        let list = &[AtLeast(Number(0.0)), AtMost(Number(1.0))];
        let requirements = Requirements { list, ..Requirements::NONE };
        for (unit, si, value, shown, demand) in [
            ("ms", "s", -0.05, "-50 ms", "must be from 0 to 1000 ms"),
            ("deg", "rad", 0.1_f64.to_radians(), "0.1 deg", "must be from 0 to 57.295779513082 deg"),
            ("degC", "K", 0.0, "-273.15 degC", "must be from -273.15 to -272.15 degC"),
            ("km", "m", 0.0, "0", "must be from 0 to 0.001 km"),
            ("km", "m", f64::INFINITY, "inf km", "must be from 0 to 0.001 km"),
        ] {
            let unit = Unit::parse(unit).unwrap();
            let written = Shown::si(si).written(Some(&unit));
            assert_eq!(
                (written.value(value).as_str(), requirements.demand(written).as_str()),
                (shown, demand)
            );
        }
    }
}
