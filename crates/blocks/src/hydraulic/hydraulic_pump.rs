use blocksim_block::physical::{Characteristics, Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is displaced.
const CHAMBERS: Handle = Handle::new("chambers");

/// Pump or motor with a fixed displacement $D$: rotation to volume flow and back.
///
/// $$ q = D w - G\,(p_b - p_a), \qquad \tau = D\,(p_b - p_a) + d\,w, \qquad w = w_r - w_c $$
///
/// It takes fluid in at `a` and gives it out at `b` while the shaft `r` turns forward against the housing `c`; $q$ is the flow from `a` to
/// `b`, $\tau$ the torque that the shaft takes. $G$ is the leakage from the high to the low pressure, $d$ the friction of the fluid. Driven
/// by a pressure it is a motor. It has no inertia.
///
/// With `heat_port: true` the heat of leakage and friction leaves by the thermal port `h`.
///
/// ```ron
/// HydraulicPump(displacement: "16 cm^3/rev", leakage: "1.5e-12 m^3/(s*Pa)", damping: "0.01 N*m*s/rad")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967), chapter 4.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Pump)]
pub struct HydraulicPump {
    /// Volume that an angle displaces $D$, positive: `cm^3/rev` for a turn.
    #[block(unit = "m^3/rad", positive)]
    pub displacement: f64,
    /// Leakage $G$ over the pressure difference; zero is allowed.
    #[block(unit = "m^3/(s*Pa)", not_negative, default = 0.0)]
    pub leakage: f64,
    /// Friction $d$ of shaft and fluid; zero is allowed.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for HydraulicPump {
    fn part(&self, _given: &Given) -> Part {
        let (p, n, conductance) = (Pin::Port(0), Pin::Port(1), self.leakage);
        Part::new()
            .port("a", Domain::Hydraulic, "inlet")
            .port("b", Domain::Hydraulic, "outlet")
            .port("r", Domain::Rotational, "shaft")
            .port("c", Domain::Rotational, "housing")
            .named(CHAMBERS, Element::Characteristic { p, n, conductance, guess: 0.0 })
            .element(Element::Branch { r: 2, c: 3 })
            .measures("q", "m^3/s", Needs::Electrics, "volume flow from a to b")
            .measures("dp", "Pa", Needs::Electrics, "pressure at b above that at a")
            .heat_port(self.heat_port)
    }

    fn characteristics(&self, c: &Moving, curves: &mut Characteristics) {
        curves.current(CHAMBERS, self.displacement * c.speed[0] + self.leakage * curves.voltage(CHAMBERS));
        curves.slope(CHAMBERS, CHAMBERS, self.leakage);
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let value = self.damping * c.speed[0] - self.displacement * c.voltage(CHAMBERS);
        tau[0] = Torque { value, slope: self.damping };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let (w, dp) = (c.speed[0], c.voltage(CHAMBERS));
        Energy::dissipated(self.damping * w * w + self.leakage * dp * dp)
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(&[c.current(CHAMBERS), -c.voltage(CHAMBERS)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::places;
    use crate::mechanics::testing::Seen;

    const PUMP: HydraulicPump =
        HydraulicPump { displacement: 2.5e-6, leakage: 1e-12, damping: 0.01, heat_port: false };

    #[test]
    fn the_shaft_gives_the_power_that_the_fluid_takes_and_the_losses() {
        let places = places(&PUMP);
        let (v, mut q, mut slope) = ([-1e7], [0.0], [0.0]);
        let law = Seen { speed: &[150.0], voltage: &v, places: &places, ..Seen::NOTHING }.loaded();
        PUMP.characteristics(&law, &mut Characteristics::new(&places, &v, &mut q, &mut slope));
        assert!((q[0] - (3.75e-4 - 1e-5)).abs() < 1e-18, "{q:?}");
        let mut tau = [Torque::default()];
        PUMP.torques(&law, &mut tau);
        assert!((tau[0].value - 26.5).abs() < 1e-12);
        let lost = tau[0].value * 150.0 - 1e7 * q[0];
        assert!((PUMP.energy(&law).dissipated - lost).abs() < 1e-9, "{lost}");
    }

    #[test]
    fn a_pump_that_displaces_nothing_is_refused() {
        assert_eq!(HydraulicPump { displacement: 0.0, ..PUMP }.errors()[0].param, "displacement");
        assert_eq!(HydraulicPump { leakage: -1.0, ..PUMP }.errors()[0].param, "leakage");
    }
}
