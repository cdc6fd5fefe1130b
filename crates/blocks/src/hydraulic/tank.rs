use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is given.
const GIVEN: Handle = Handle::new("given");

/// Tank: a constant pressure, whatever flows into it. Pressures are above that of the atmosphere, which an open tank has: 0.
///
/// ```ron
/// Tank
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Tank)]
pub struct Tank {
    /// Pressure.
    #[block(unit = "Pa", finite, default = 0.0)]
    pub p: f64,
}

impl Component for Tank {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Hydraulic, "hydraulic port")
            .holds()
            .named(GIVEN, Element::VoltageSource { p: Pin::Port(0), n: Pin::Ground })
            .reads("q", "m^3/s", Reading::Current(GIVEN), "volume flow into the tank")
    }

    fn voltages(&self, _c: &Moving, v: &mut [f64]) {
        v[0] = self.p;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pressure_is_a_number() {
        assert_eq!(Tank { p: f64::NAN }.errors()[0].param, "p");
        assert_eq!(Tank { p: 2e5 }.errors()[..], []);
    }
}
