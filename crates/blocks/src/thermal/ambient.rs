use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is given.
const GIVEN: Handle = Handle::new("given");

/// Surroundings of a constant temperature, whatever heat flows into them.
///
/// ```ron
/// Ambient(t: "25 degC")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Value("t"))]
pub struct Ambient {
    /// Temperature, not below absolute zero.
    #[block(unit = "K", not_negative, default = 293.15)]
    pub t: f64,
}

impl Component for Ambient {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("h", Domain::Thermal, "thermal port")
            .holds()
            .named(GIVEN, Element::VoltageSource { p: Pin::Port(0), n: Pin::Ground })
            .reads("q", "W", Reading::Current(GIVEN), "heat flow into the surroundings")
    }

    fn voltages(&self, _c: &Moving, v: &mut [f64]) {
        v[0] = self.t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_colder_than_absolute_zero() {
        assert_eq!(Ambient { t: -1.0 }.errors()[0].param, "t");
        assert_eq!(Ambient { t: 0.0 }.errors()[..], []);
    }
}
