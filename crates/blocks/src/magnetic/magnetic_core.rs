use blocksim_block::physical::{Characteristics, Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::{MU_0, poles};

/// The iron.
const IRON: Handle = Handle::new("iron");

/// Path of the flux through iron that saturates, without hysteresis.
///
/// $$ B = \mu_0 H + J_s \tanh\frac{\mu_0 (\mu_r - 1) H}{J_s}, \qquad \Phi = A B, \qquad V_m = l H $$
///
/// For small fields the relative permeability is $\mu_r$; far beyond the knee only that of empty space is left, and the polarisation is
/// $J_s$. The field stores $\int V_m\,d\Phi$. Losses in the iron are a resistance across the winding.
///
/// ```ron
/// MagneticCore(length: "0.2 m", area: "4 cm^2", mu_r: 2000.0, saturation: "1.6 T")
/// ```
///
/// Source: the anhysteretic curve with a hyperbolic tangent, as in D. C. Jiles, *Introduction to Magnetism and Magnetic Materials*
/// (2015), for a material of two orientations.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Varistor)]
pub struct MagneticCore {
    /// Length of the path, positive.
    #[block(unit = "m", positive)]
    pub length: f64,
    /// Cross-section, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
    /// Relative permeability for small fields, above 1.
    #[block(finite, above = 1.0, remedy = "iron has more than 1; for air use a Reluctance")]
    pub mu_r: f64,
    /// Polarisation of saturation $J_s$, positive.
    #[block(unit = "T", positive)]
    pub saturation: f64,
}

impl MagneticCore {
    /// Flux density over the polarisation at a field: the argument of the hyperbolic tangent.
    fn knee(&self, v: f64) -> f64 {
        MU_0 * (self.mu_r - 1.0) * v / (self.length * self.saturation)
    }

    /// Flux at a potential difference and its slope.
    fn flux(&self, v: f64) -> (f64, f64) {
        let tanh = self.knee(v).tanh();
        let air = MU_0 * self.area / self.length;
        (air * v + self.area * self.saturation * tanh, air * (1.0 + (self.mu_r - 1.0) * (1.0 - tanh * tanh)))
    }
}

impl Component for MagneticCore {
    fn part(&self, _given: &Given) -> Part {
        let (p, n, conductance) = (Pin::Port(0), Pin::Port(1), self.flux(0.0).1);
        poles()
            .named(IRON, Element::Characteristic { p, n, conductance, guess: 0.0 })
            .measures("flux", "Wb", Needs::Electrics, "flux from p to n")
            .measures("b", "T", Needs::Electrics, "flux density")
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let (flux, slope) = self.flux(curves.voltage(IRON));
        curves.current(IRON, flux);
        curves.slope(IRON, IRON, slope);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        // The integral of V over the flux is V flux less that of the flux over V.
        let v = c.voltage(IRON);
        let x = self.knee(v).abs();
        // ln cosh x, without overflow.
        let ln_cosh = x + (-2.0 * x).exp().ln_1p() - std::f64::consts::LN_2;
        let volume = self.area * self.length;
        let coenergy = 0.5 * MU_0 * self.area / self.length * v * v
            + volume * self.saturation * self.saturation / (MU_0 * (self.mu_r - 1.0)) * ln_cosh;
        Energy::stored(v * self.flux(v).0 - coenergy)
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        let flux = c.current(IRON);
        y.copy_from_slice(&[flux, flux / self.area]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, places, slopes_are_exact};
    use crate::mechanics::testing::Seen;

    const CORE: MagneticCore = MagneticCore { length: 0.2, area: 4e-4, mu_r: 2000.0, saturation: 1.6 };

    #[test]
    fn small_fields_see_the_permeability_and_large_ones_the_saturation() {
        let (flux, _) = characteristic(&CORE, &[], &[1e-3]);
        let linear = 2000.0 * MU_0 * 4e-4 / 0.2 * 1e-3;
        assert!((flux[0] / linear - 1.0).abs() < 1e-6, "{flux:?}");
        let (flux, _) = characteristic(&CORE, &[], &[1e5]);
        let saturated = 4e-4 * (1.6 + MU_0 * 1e5 / 0.2);
        assert!((flux[0] / saturated - 1.0).abs() < 1e-12, "{flux:?}");
        [-3e3, -100.0, 0.0, 40.0, 200.0, 5e3].iter().for_each(|v| slopes_are_exact(&CORE, &[], &[*v]));
    }

    /// Against the sum of many thin slices.
    #[test]
    fn the_energy_is_the_integral_of_the_potential_over_the_flux() {
        let places = places(&CORE);
        let at =
            |v: f64| CORE.energy(&Seen { voltage: &[v], places: &places, ..Seen::NOTHING }.loaded()).stored;
        for end in [50.0, 400.0, -900.0] {
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|k| {
                    let (a, b) = (end * k as f64 / n as f64, end * (k + 1) as f64 / n as f64);
                    0.5 * (a + b) * (CORE.flux(b).0 - CORE.flux(a).0)
                })
                .sum();
            assert!((at(end) / sum - 1.0).abs() < 1e-6, "{} for {sum} at {end} A", at(end));
        }
        assert_eq!(at(0.0), 0.0);
    }

    #[test]
    fn what_is_no_iron_is_refused() {
        assert!(MagneticCore { mu_r: 1.0, ..CORE }.errors()[0].help.is_some());
        assert_eq!(MagneticCore { saturation: 0.0, ..CORE }.errors()[0].param, "saturation");
        assert_eq!(CORE.errors()[..], []);
    }
}
