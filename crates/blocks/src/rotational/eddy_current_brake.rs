use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Eddy-current brake: a disc that turns in the field of a magnet. The torque has a maximum $\tau_k$ at the critical speed $w_k$, and
/// always acts against the speed $w = w_r - w_c$.
///
/// $$ \tau = e^2\, \frac{2 \tau_k}{w/w_k + w_k/w} $$
///
/// Below the critical speed the brake damps like a `RotationalDamper` of $2 \tau_k/w_k$; above it the currents keep the field out of the
/// disc and the torque falls. The input `excitation` is the field over that at which $\tau_k$ holds; not connected, it is 1, as for a
/// permanent magnet.
///
/// With `heat_port: true` the heat leaves by the thermal port `h`.
///
/// ```ron
/// EddyCurrentBrake(torque: "40 N*m", speed: "900 rpm")
/// ```
///
/// Source: J. H. Wouterse, *Critical torque and speed of eddy current brake with widely separated soft iron poles*, IEE Proceedings B
/// 138 (1991).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Brake)]
pub struct EddyCurrentBrake {
    /// Largest torque $\tau_k$; zero is allowed.
    #[block(unit = "N*m", not_negative)]
    pub torque: f64,
    /// Critical speed $w_k$, positive.
    #[block(
        unit = "rad/s",
        positive,
        remedy = "`speed` is where the torque has its maximum; the brake acts in both directions"
    )]
    pub speed: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl EddyCurrentBrake {
    /// Torque and its slope at an excitation and a speed.
    fn torque(&self, excitation: f64, w: f64) -> (f64, f64) {
        let s = w / self.speed;
        let (most, under) = (2.0 * self.torque * excitation * excitation, 1.0 + s * s);
        (most * s / under, most / self.speed * (1.0 - s * s) / (under * under))
    }
}

impl Component for EddyCurrentBrake {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .rod_and_case()
            .input(
                Input::real("excitation")
                    .scalar()
                    .unit("1")
                    .default(1.0)
                    .doc("field over that of the given torque"),
            )
            .reads("tau", "N*m", Reading::Torque(0), "torque from r to c")
            .element(Element::Branch { r: 0, c: 1 })
            .heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let (value, slope) = self.torque(c.scalar(0), c.speed[0]);
        // Beyond the maximum the torque falls; an implicit step damps only where it rises.
        tau[0] = Torque { value, slope: slope.max(0.0) };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(self.torque(c.scalar(0), c.speed[0]).0 * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BRAKE: EddyCurrentBrake = EddyCurrentBrake { torque: 40.0, speed: 90.0, heat_port: false };

    #[test]
    fn the_torque_has_its_maximum_at_the_critical_speed() {
        assert_eq!(BRAKE.torque(1.0, 90.0), (40.0, 0.0));
        assert_eq!(BRAKE.torque(1.0, -90.0).0, -40.0);
        assert_eq!(BRAKE.torque(0.5, 90.0).0, 10.0);
        assert!((1..300).all(|k| BRAKE.torque(1.0, f64::from(k)).0 <= 40.0));
        assert!((BRAKE.torque(1.0, 1e-6).0 - 80.0 / 90.0 * 1e-6).abs() < 1e-18);
        assert_eq!(BRAKE.torque(1.0, 0.0), (0.0, 80.0 / 90.0));
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_torque() {
        for w in [-200.0, -20.0, 0.0, 50.0, 130.0] {
            let difference = (BRAKE.torque(0.8, w + 1e-4).0 - BRAKE.torque(0.8, w - 1e-4).0) / 2e-4;
            assert!((difference - BRAKE.torque(0.8, w).1).abs() < 1e-8, "{difference} at {w} rad/s");
        }
    }

    #[test]
    fn a_critical_speed_of_zero_is_refused() {
        assert!(EddyCurrentBrake { speed: 0.0, ..BRAKE }.errors()[0].help.is_some());
        assert_eq!(EddyCurrentBrake { torque: -1.0, ..BRAKE }.errors()[0].param, "torque");
    }
}
