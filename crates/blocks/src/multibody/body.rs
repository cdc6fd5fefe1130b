use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;
use blocksim_scene::Form;

/// A rigid body fixed to a frame.
///
/// The inertia tensor is taken about the centre of mass, in axes parallel to the frame, with $I_{yz} = -\int
/// y z\,dm$ and so on: the products of inertia are the elements of the tensor as they stand. A tensor that no
/// distribution of mass has is refused when the mechanism is assembled.
///
/// `shapes` are drawn and take part in checks for collisions; they change nothing in a simulation, but where a mechanism
/// has shapes the positions of its joints are recorded. A shape is a set: `kind: Text("box")` with `size`;
/// `"cylinder"` or `"capsule"` with `radius` and `length` along z; `"sphere"` with `radius`; `"cone"` with `radius`,
/// `top` (radius above) and `length`; `"mesh"` with `file` (STL, beside the diagram) and `scale`, which makes metres of
/// its numbers. `centre` and `rpy` place it in the frame; `from` and `to`, two points, may stand for them and for
/// `length`. `colour` is red, green, blue and opacity, from 0 to 1. A shape with `use: Text("visual")` or
/// `use: Text("collision")` is for that alone. A body without mass is only looked at.
///
/// ```ron
/// Body(
///     mass: "5 kg", com: [0.1, 0.0, 0.2], moi: [0.05, 0.06, 0.02],
///     shapes: [
///         (kind: Text("cylinder"), radius: "60 mm", from: [0.0, 0.0, 0.0], to: [0.1, 0.0, 0.4], colour: [1.0, 0.4, 0.0]),
///         (kind: Text("sphere"), radius: "80 mm", centre: [0.1, 0.0, 0.4]),
///     ],
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Body)]
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
    /// What the body looks like: a list of boxes, cylinders, capsules, spheres, cones and meshes in the frame.
    #[block(default = None)]
    pub shapes: Option<Shapes>,
}

impl Block for Body {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        for shape in self.shapes.iter_mut().flat_map(|shapes| &mut shapes.0) {
            if let Form::Mesh { file, .. } = &mut shape.form {
                // Only who draws or measures it opens the file.
                *file = files.folder().join(&*file).to_string_lossy().into_owned();
            }
        }
        Ok(())
    }

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
        let shapes = self.shapes.iter().flat_map(|shapes| &shapes.0);
        let part = Part::new().port("frame", Domain::Frame, "the frame the body is fixed to");
        shapes.fold(part, |part, shape| part.shape(0, shape.clone())).element(Element::Body {
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
        let body = Body { mass: 1.0, com: [0.0; 3], moi: [0.1; 3], poi: [0.0; 3], shapes: None };
        assert_eq!(body.check(), Ok(()));
        assert_eq!(Body { mass: -1.0, ..body.clone() }.check().unwrap_err().param, "mass");
        assert_eq!(Body { moi: [0.1, -0.1, 0.1], ..body }.check().unwrap_err().param, "moi");
    }
}
