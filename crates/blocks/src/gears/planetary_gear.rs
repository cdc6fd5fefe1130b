use blocksim_block::physical::{Domain, DryMesh, Element};
use blocksim_block::prelude::*;

use super::mesh::BothWays;

/// Planetary gear: sun, planet carrier and ring turn, and two speeds give the third.
///
/// $$ w_S + g\,w_R = (1 + g)\,w_C, \qquad g = \frac{n_R}{n_S} $$
///
/// Without losses the torques into the three ports have fixed proportions, $\tau_S : \tau_R : \tau_C = 1 : g : -(1 + g)$.
/// They always add up to zero; there is no inertia. The housing stands still (an implied ground). With a fixed ring
/// the sun turns $1 + g$ times as fast as the carrier; with a fixed carrier the ring turns backwards,
/// $w_S = -g\,w_R$.
///
/// `efficiency` is that of the two meshes from sun to ring, as with a fixed carrier ($\eta_0$). Only teeth that roll lose
/// something: with a fixed ring $(1 + g\,\eta_0)/(1 + g)$ of the power gets from the sun to the carrier and
/// $(1 + g)/(1 + g/\eta_0)$ back; as a coupling, with three equal speeds, nothing is lost. Losses act as in a
/// `CycloidalDrive`, with the sun against the carrier as the base.
///
/// ```ron
/// PlanetaryGear(ring_teeth: 72, sun_teeth: 24, efficiency: 0.97)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Planetary)]
pub struct PlanetaryGear {
    /// Teeth of the ring $n_R$, more than the sun has.
    #[block(
        above = sun_teeth,
        remedy = "the planets run between the sun and the ring around it: are the two exchanged?",
    )]
    pub ring_teeth: u32,
    /// Teeth of the sun $n_S$.
    #[block(at_least = 1, zero = "a wheel has teeth")]
    pub sun_teeth: u32,
    /// Its losses.
    #[block(group)]
    pub losses: BothWays,
}

impl PlanetaryGear {
    /// Teeth of the ring over teeth of the sun.
    fn ratio(&self) -> f64 {
        f64::from(self.ring_teeth) / f64::from(self.sun_teeth)
    }
}

impl Component for PlanetaryGear {
    fn part(&self, _given: &Given) -> Part {
        let g = self.ratio();
        let part = Part::new()
            .port("sun", Domain::Rotational, "sun wheel")
            .port("carrier", Domain::Rotational, "carrier of the planets")
            .port("ring", Domain::Rotational, "ring gear")
            .heat_port(self.losses.onset.heat_port);
        let Some(loss) = self.losses.mesh().element() else {
            return part.element(Element::Coupling { terms: vec![(0, 1.0), (1, -(1.0 + g)), (2, g)] });
        };
        // Seen from the carrier it is a pair of wheels.
        let (sun, ring) = (part.ports.len(), part.ports.len() + 1);
        part.inner("sun_on_carrier", Domain::Rotational)
            .inner("ring_on_carrier", Domain::Rotational)
            .element(Element::Coupling { terms: vec![(sun, 1.0), (0, -1.0), (1, 1.0)] })
            .element(Element::Coupling { terms: vec![(ring, 1.0), (2, -1.0), (1, 1.0)] })
            .element(Element::Gear { base: sun, follower: ring, ratio: -1.0 / g, loss: Some(loss) })
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.losses.mesh().dry());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gear(ring_teeth: u32, sun_teeth: u32) -> PlanetaryGear {
        PlanetaryGear { ring_teeth, sun_teeth, losses: BothWays::NONE }
    }

    #[test]
    fn three_equal_speeds_fit_the_relation() {
        let part = gear(71, 23).part(&Given::nothing());
        let Element::Coupling { terms } = &part.elements[0] else { panic!("a coupling") };
        assert!(terms.iter().map(|(_, factor)| factor).sum::<f64>().abs() < 1e-15);
    }

    #[test]
    fn a_ring_without_more_teeth_than_the_sun_is_refused() {
        let error = gear(24, 72).errors()[0].clone();
        assert_eq!(error.param, "ring_teeth");
        assert!(error.help.is_some());
        assert_eq!(gear(24, 0).errors()[0].param, "sun_teeth");
        assert_eq!(gear(72, 24).errors()[..], []);
        let lossy = PlanetaryGear { losses: BothWays { efficiency: 1.1, ..BothWays::NONE }, ..gear(72, 24) };
        assert_eq!(lossy.errors()[0].param, "efficiency");
    }
}
