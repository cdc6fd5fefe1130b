use blocksim_block::physical::{Characteristics, Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// The electrical and the magnetic side.
const COIL: Handle = Handle::new("coil");
const CORE: Handle = Handle::new("core");

/// Winding around a magnetic path, without losses but for its resistance: from electrical to magnetic circuits.
///
/// $$ v = R i + N \frac{d\Phi}{dt}, \qquad V_m = N i $$
///
/// The flux $\Phi$ that leaves at the pole `mp` and comes back at `mn` is a state; $V_m$ is the magnetic potential difference from `mp`
/// to `mn`, which the magnetic circuit gives for this flux. On a path of the reluctance $R_m$ the winding is an inductance $N^2/R_m$.
/// Several windings on one path are a transformer; each then needs a `Reluctance` in parallel for its leakage, as the fluxes of
/// windings without leakage are no states of their own.
///
/// The current follows from the magnetic circuit and needs a path at every instant: a valve or a contact in series needs a `g_off`, and where
/// the winding meets nothing but another one, an inductor, a motor or a current source, connect a resistance from there to the other side.
///
/// With `heat_port: true` the heat of the resistance leaves by the thermal port `h`.
///
/// ```ron
/// MagneticWinding(turns: 200.0, r: "0.8 ohm")
/// ```
///
/// Source: H. C. Roters, *Electromagnetic Devices* (1941).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Transformer)]
pub struct MagneticWinding {
    /// Number of turns $N$, positive.
    #[block(positive)]
    pub turns: f64,
    /// Resistance of the winding; zero is allowed.
    #[block(unit = "ohm", not_negative, default = 0.0)]
    pub r: f64,
    /// Flux at the start.
    #[block(unit = "Wb", finite, default = 0.0)]
    pub flux0: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for MagneticWinding {
    fn part(&self, _given: &Given) -> Part {
        let side =
            |p, n| Element::Characteristic { p: Pin::Port(p), n: Pin::Port(n), conductance: 0.0, guess: 0.0 };
        Part::new()
            .pins()
            .port("mp", Domain::Magnetic, "magnetic pole that the flux leaves by")
            .port("mn", Domain::Magnetic, "magnetic pole that it comes back by")
            .state_in("flux", self.flux0, "Wb")
            .named(COIL, side(0, 1))
            .named(CORE, side(2, 3))
            .measures("flux", "Wb", Needs::State, "flux of the winding")
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .heat_port(self.heat_port)
    }

    fn characteristics(&self, c: &Moving, curves: &mut Characteristics) {
        curves.current(COIL, curves.voltage(CORE) / self.turns);
        curves.slope(COIL, CORE, 1.0 / self.turns);
        curves.current(CORE, -c.x[0]);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = (c.voltage(COIL) - self.r * c.current(COIL)) / self.turns;
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let i = c.current(COIL);
        Energy::dissipated(self.r * i * i)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[1] = c.current(COIL);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, places, slopes_are_exact};
    use crate::mechanics::testing::Seen;

    const WINDING: MagneticWinding = MagneticWinding { turns: 200.0, r: 0.8, flux0: 0.0, heat_port: false };

    #[test]
    fn the_current_follows_from_the_magnetic_potential_and_the_flux_from_the_voltage() {
        let (i, _) = characteristic(&WINDING, &[3e-3], &[12.0, 500.0]);
        assert!((i[0] - 2.5).abs() < 1e-14 && i[1] == -3e-3, "{i:?}");
        slopes_are_exact(&WINDING, &[3e-3], &[12.0, 500.0]);
        let places = places(&WINDING);
        let law = Seen { x: &[3e-3], voltage: &[12.0, 500.0], current: &i, places: &places, ..Seen::NOTHING }
            .loaded();
        let mut dx = [0.0];
        Component::derivatives(&WINDING, &law, &mut dx);
        assert!((dx[0] - 0.05).abs() < 1e-15);
    }

    #[test]
    fn windings_that_are_none_are_refused() {
        assert_eq!(MagneticWinding { turns: 0.0, ..WINDING }.errors()[0].param, "turns");
        assert_eq!(MagneticWinding { r: -1.0, ..WINDING }.errors()[0].param, "r");
    }
}
