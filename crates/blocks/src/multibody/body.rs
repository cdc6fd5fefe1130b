use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// A rigid body fixed to a frame.
///
/// The inertia tensor is taken about the centre of mass, in axes parallel to the frame, with $I_{yz} = -\int
/// y z\,dm$ and so on: the products of inertia are the elements of the tensor as they stand. A tensor that no
/// distribution of mass has is refused when the mechanism is assembled.
///
/// ```ron
/// Body(mass: "5 kg", com: [0.1, 0.0, 0.2], moi: [0.05, 0.06, 0.02])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody")]
pub struct Body {
    /// Mass.
    #[block(unit = "kg")]
    pub mass: f64,
    /// Centre of mass in the frame: x, y, z.
    #[block(unit = "m", default = [0.0, 0.0, 0.0])]
    pub com: [f64; 3],
    /// Moments of inertia Ixx, Iyy, Izz about the centre of mass.
    #[block(unit = "kg*m^2", default = [0.0, 0.0, 0.0])]
    pub moi: [f64; 3],
    /// Products of inertia Iyz, Izx, Ixy about the centre of mass.
    #[block(unit = "kg*m^2", default = [0.0, 0.0, 0.0])]
    pub poi: [f64; 3],
}

impl Block for Body {
    fn check(&self) -> Result<(), ParamError> {
        not_negative("mass", self.mass)?;
        self.com.iter().try_for_each(|x| finite("com", *x))?;
        self.moi.iter().try_for_each(|i| not_negative("moi", *i))?;
        self.poi.iter().try_for_each(|i| finite("poi", *i))
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Body {
    fn part(&self, _given: &Given) -> Part {
        Part::new().port("frame", Domain::Frame, "the frame the body is fixed to").element(Element::Body {
            frame: 0,
            mass: self.mass,
            com: self.com,
            moi: self.moi,
            poi: self.poi,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_masses_and_moments_of_inertia_are_refused() {
        let body = Body { mass: 1.0, com: [0.0; 3], moi: [0.1; 3], poi: [0.0; 3] };
        assert_eq!(body.check(), Ok(()));
        assert_eq!(Body { mass: -1.0, ..body.clone() }.check().unwrap_err().param, "mass");
        assert_eq!(Body { moi: [0.1, -0.1, 0.1], ..body }.check().unwrap_err().param, "moi");
    }
}
