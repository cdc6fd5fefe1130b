use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Differential: the drive shaft turns with the mean of two output shafts and divides its torque equally.
///
/// $$ w_D = \frac{i}{2}(w_L + w_R), \qquad \tau_L = \tau_R = \frac{i}{2} \tau_D $$
///
/// Positive torques pass from the drive to the outputs. It has no losses and no inertia; the housing stands
/// still (an implied ground).
///
/// ```ron
/// Differential(ratio: 4.1)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Differential)]
pub struct Differential {
    /// Speed of the drive shaft over the mean speed of the outputs, $i$; negative when it reverses.
    #[block(default = 1.0)]
    pub ratio: f64,
}

impl Block for Differential {
    fn check(&self) -> Result<(), ParamError> {
        finite("ratio", self.ratio)?;
        if self.ratio == 0.0 {
            return Err(ParamError::new("ratio", "`ratio` is 0, so the drive shaft would never turn")
                .help("write 1.0 for a differential without a final drive"));
        }
        Ok(())
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Differential {
    fn part(&self, _given: &Given) -> Part {
        let half = 0.5 * self.ratio;
        Part::new()
            .port("drive", Domain::Rotational, "drive shaft")
            .port("left", Domain::Rotational, "one output shaft")
            .port("right", Domain::Rotational, "the other output shaft")
            .element(Element::Coupling { terms: vec![(0, 1.0), (1, -half), (2, -half)] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_of_zero_is_refused() {
        let error = Differential { ratio: 0.0 }.check().unwrap_err();
        assert_eq!(error.param, "ratio");
        assert!(error.help.is_some());
        assert!(Differential { ratio: f64::NAN }.check().is_err());
        assert_eq!(Differential { ratio: -3.0 }.check(), Ok(()));
    }
}
