use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Planetary gear: sun, planet carrier and ring turn, and two speeds give the third.
///
/// $$ w_S + g\,w_R = (1 + g)\,w_C, \qquad g = \frac{n_R}{n_S} $$
///
/// It has no losses and no inertia; torques into the three ports have fixed proportions and add up to zero,
/// $\tau_S : \tau_R : \tau_C = 1 : g : -(1 + g)$. The housing stands still (an implied ground). With a fixed ring
/// the sun turns $1 + g$ times as fast as the carrier; with a fixed carrier the ring turns backwards,
/// $w_S = -g\,w_R$.
///
/// ```ron
/// PlanetaryGear(ring_teeth: 72, sun_teeth: 24)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Planetary)]
pub struct PlanetaryGear {
    /// Teeth of the ring $n_R$, more than the sun has.
    pub ring_teeth: u32,
    /// Teeth of the sun $n_S$.
    pub sun_teeth: u32,
}

impl PlanetaryGear {
    /// Teeth of the ring over teeth of the sun.
    fn ratio(&self) -> f64 {
        f64::from(self.ring_teeth) / f64::from(self.sun_teeth)
    }
}

impl Block for PlanetaryGear {
    fn check(&self) -> Result<(), ParamError> {
        if self.sun_teeth == 0 {
            return Err(ParamError::new("sun_teeth", "`sun_teeth` is 0, but a wheel has teeth"));
        }
        if self.ring_teeth <= self.sun_teeth {
            return Err(ParamError::new(
                "ring_teeth",
                format!(
                    "`ring_teeth` ({}) must be greater than `sun_teeth` ({})",
                    self.ring_teeth, self.sun_teeth
                ),
            )
            .help("the planets run between the sun and the ring around it: are the two exchanged?"));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for PlanetaryGear {
    fn part(&self, _given: &Given) -> Part {
        let g = self.ratio();
        Part::new()
            .port("sun", Domain::Rotational, "sun wheel")
            .port("carrier", Domain::Rotational, "carrier of the planets")
            .port("ring", Domain::Rotational, "ring gear")
            .element(Element::Coupling { terms: vec![(0, 1.0), (1, -(1.0 + g)), (2, g)] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_equal_speeds_fit_the_relation() {
        let part = PlanetaryGear { ring_teeth: 71, sun_teeth: 23 }.part(&Given::nothing());
        let Element::Coupling { terms } = &part.elements[0] else { panic!("a coupling") };
        assert!(terms.iter().map(|(_, factor)| factor).sum::<f64>().abs() < 1e-15);
    }

    #[test]
    fn a_ring_without_more_teeth_than_the_sun_is_refused() {
        let error = PlanetaryGear { ring_teeth: 24, sun_teeth: 72 }.check().unwrap_err();
        assert_eq!(error.param, "ring_teeth");
        assert!(error.help.is_some());
        assert_eq!(PlanetaryGear { ring_teeth: 24, sun_teeth: 0 }.check().unwrap_err().param, "sun_teeth");
        assert_eq!(PlanetaryGear { ring_teeth: 72, sun_teeth: 24 }.check(), Ok(()));
    }
}
