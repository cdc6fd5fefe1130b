//! A number with its dimension.

use crate::Dimension;
use std::fmt;

/// A number in SI units with its dimension.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quantity {
    /// The number in SI base units.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
}

impl Quantity {
    /// A quantity from its value in SI units.
    pub const fn new(value: f64, dimension: Dimension) -> Self {
        Self { value, dimension }
    }

    /// A number without dimension.
    pub const fn plain(value: f64) -> Self {
        Self { value, dimension: Dimension::NONE }
    }

    /// The shortest text that reads back as this quantity; see [`si_text`].
    pub fn display(&self) -> String {
        si_text(self.value, self.dimension)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.display())
    }
}

/// The shortest decimal that reads back as the same `f64`, with the SI unit: `0.05 kg*m^2`, `1e-12 F`, `3`.
pub fn si_text(value: f64, dimension: Dimension) -> String {
    let number = format!("{value:?}");
    let number = number.strip_suffix(".0").unwrap_or(&number);
    match dimension.to_string().as_str() {
        "1" => number.to_string(),
        unit => format!("{number} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    #[test]
    fn numbers_print_short_with_their_unit() {
        let dimension = |text: &str| Unit::parse(text).unwrap().dimension;
        for (value, unit, text) in [
            (5000.0, "W", "5000 W"),
            (0.05, "kg*m^2", "0.05 kg*m^2"),
            (1e-12, "F", "1e-12 F"),
            (1e300, "m", "1e300 m"),
            (0.1 + 0.2, "1", "0.30000000000000004"),
            (-3.0, "rad", "-3 rad"),
        ] {
            assert_eq!(si_text(value, dimension(unit)), text);
            assert_eq!(Quantity::new(value, dimension(unit)).to_string(), text);
        }
    }
}
