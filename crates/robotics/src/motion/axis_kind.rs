//! How an axis moves, and its numbers for people.

/// How an axis moves, and so in which units its positions are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisKind {
    /// It turns; rad.
    #[default]
    Turning,
    /// It slides; m.
    Sliding,
}

impl AxisKind {
    /// SI unit of a position.
    pub fn si(self) -> &'static str {
        match self {
            AxisKind::Turning => "rad",
            AxisKind::Sliding => "m",
        }
    }

    /// Unit of a position for people; `/s` and `/s^2` behind it make those of speed and acceleration.
    pub fn unit(self) -> &'static str {
        match self {
            AxisKind::Turning => "deg",
            AxisKind::Sliding => "mm",
        }
    }

    /// A position, speed or acceleration in the unit for people.
    pub fn shown(self, value: f64) -> f64 {
        match self {
            AxisKind::Turning => value.to_degrees(),
            AxisKind::Sliding => 1e3 * value,
        }
    }

    /// The same as text, with at most three decimals and no unit.
    pub fn text(self, value: f64) -> String {
        short(self.shown(value))
    }
}

/// At most three decimals, no zeros at the end; numbers that would vanish in this are written in full.
pub(crate) fn short(value: f64) -> String {
    let rounded = format!("{value:.3}");
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e15) {
        return format!("{value:.3e}");
    }
    let trimmed = rounded.trim_end_matches('0').trim_end_matches('.');
    (if trimmed.is_empty() || trimmed == "-0" { "0" } else { trimmed }).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_vanish() {
        let cases = [(0.0, "0"), (-0.0, "0"), (60.0, "60"), (-7.5, "-7.5"), (1.23456, "1.235")];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
        assert_eq!(short(1e-7), "1.000e-7");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(f64::INFINITY), "inf");
    }
}
