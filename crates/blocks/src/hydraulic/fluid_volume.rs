use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::VACUUM;

/// The fluid.
const FLUID: Handle = Handle::new("fluid");

/// A volume of fluid that yields a little: $\frac{V}{\beta} \frac{dp}{dt} = q$. Its pressure is a state.
///
/// The bulk modulus $\beta$ is that of the fluid together with what encloses it: 1.4e9 Pa for mineral oil in rigid pipes, less with
/// hoses or air. Volumes at one node have one pressure. Cavitation is not modelled: a pressure that has fallen below that of a vacuum,
/// -101 325 Pa, is named at the end of the run.
///
/// ```ron
/// FluidVolume(volume: "0.5 L", p0: "20 bar")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapters 2 and 3.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Capacitor)]
pub struct FluidVolume {
    /// Volume, positive.
    #[block(unit = "m^3", positive, zero = "without volume it stores nothing: leave it out")]
    pub volume: f64,
    /// Bulk modulus $\beta$, positive.
    #[block(unit = "Pa", positive, default = 1.4e9)]
    pub bulk_modulus: f64,
    /// Pressure at the start. Where none is given it follows from given pressures at the same node, else it is zero.
    #[block(unit = "Pa", finite, default = None)]
    pub p0: Option<f64>,
}

impl FluidVolume {
    /// m^3/Pa.
    fn capacity(&self) -> f64 {
        self.volume / self.bulk_modulus
    }
}

/// A typical pressure of hydraulics, Pa: tolerances follow it.
pub(super) const TYPICAL_PRESSURE: f64 = 1e5;

impl Component for FluidVolume {
    fn part(&self, _given: &Given) -> Part {
        let (p, n) = (Pin::Port(0), Pin::Ground);
        Part::new()
            .port("a", Domain::Hydraulic, "hydraulic port")
            .nominal_state("p", self.p0.unwrap_or(0.0), TYPICAL_PRESSURE)
            .floor(VACUUM)
            .named(
                FLUID,
                Element::Capacitance { p, n, capacitance: self.capacity(), state: 0, start: self.p0 },
            )
            .voltage_is(Gives::State(0))
            .reads("p", "Pa", Reading::State(0), "pressure")
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.current(FLUID) / self.capacity();
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::stored(0.5 * self.capacity() * c.x[0] * c.x[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_that_are_none_are_refused() {
        let volume = FluidVolume { volume: 1e-3, bulk_modulus: 1.4e9, p0: None };
        assert_eq!(volume.errors()[..], []);
        assert!(FluidVolume { volume: 0.0, ..volume }.errors()[0].help.is_some());
        assert_eq!(FluidVolume { bulk_modulus: 0.0, ..volume }.errors()[0].param, "bulk_modulus");
    }
}
