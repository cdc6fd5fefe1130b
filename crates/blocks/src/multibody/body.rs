use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;
use blocksim_scene::Form;

use super::mass_properties::MassProperties;

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
    /// Its mass and how that is spread.
    #[block(group)]
    pub properties: MassProperties,
    /// What the body looks like: a list of boxes, cylinders, capsules, spheres, cones and meshes in the frame.
    #[block(default = None)]
    pub shapes: Option<Shapes>,
}

impl Component for Body {
    fn locate(&mut self, files: &dyn Files) {
        for shape in self.shapes.iter_mut().flat_map(|shapes| &mut shapes.0) {
            if let Form::Mesh { file, .. } = &mut shape.form {
                // Only who draws or measures it opens the file.
                *file = files.folder().join(&*file).to_string_lossy().into_owned();
            }
        }
    }

    fn part(&self, _given: &Given) -> Part {
        let shapes = self.shapes.iter().flat_map(|shapes| &shapes.0);
        let MassProperties { mass, com, moi, poi } = self.properties;
        let part = Part::new().port("frame", Domain::Frame, "the frame the body is fixed to");
        shapes.fold(part, |part, shape| part.shape(0, shape.clone())).element(Element::Body {
            frame: 0,
            mass,
            com,
            moi,
            poi,
        })
    }
}
