use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Load of a fan, a pump or a propeller: torque with the square of the speed $w = w_r - w_c$, always against it.
///
/// $$ \tau = \tau_n \frac{w\,|w|}{w_n^2} $$
///
/// ```ron
/// QuadraticLoad(torque: "40 N*m", speed: "1450 rpm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Torque)]
pub struct QuadraticLoad {
    /// Torque $\tau_n$ at the nominal speed; zero is allowed.
    #[block(unit = "N*m", not_negative)]
    pub torque: f64,
    /// Nominal speed $w_n$.
    #[block(
        unit = "rad/s",
        positive,
        remedy = "`speed` is where the load takes `torque`; the load brakes in both directions"
    )]
    pub speed: f64,
}

impl Component for QuadraticLoad {
    fn part(&self, _given: &Given) -> Part {
        Part::new().rod_and_case().element(Element::Branch { r: 0, c: 1 })
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        let w = c.speed[0];
        let k = self.torque / (self.speed * self.speed);
        tau[0] = Torque { value: k * w * w.abs(), slope: 2.0 * k * w.abs() };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let w = c.speed[0].abs();
        Energy::dissipated(self.torque / (self.speed * self.speed) * w * w * w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_torque_grows_with_the_square_of_the_speed_and_brakes_both_ways() {
        let load = QuadraticLoad { torque: 40.0, speed: 100.0 };
        for (w, value, slope) in [(100.0, 40.0, 0.8), (50.0, 10.0, 0.4), (-50.0, -10.0, 0.4), (0.0, 0.0, 0.0)]
        {
            let mut tau = [Torque::default()];
            load.torques(&Seen { speed: &[w], ..law() }.loaded(), &mut tau);
            assert!((tau[0].value - value).abs() < 1e-13 && (tau[0].slope - slope).abs() < 1e-15, "{w}");
        }
    }

    #[test]
    fn a_nominal_speed_of_zero_is_refused() {
        assert_eq!(QuadraticLoad { torque: 1.0, speed: 0.0 }.errors()[0].param, "speed");
        assert_eq!(QuadraticLoad { torque: -1.0, speed: 1.0 }.errors()[0].param, "torque");
    }
}
