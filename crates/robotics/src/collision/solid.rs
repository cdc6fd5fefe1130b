//! Simple shapes as convex cores with a skin.

use blocksim_scene::Form;
use nalgebra::Vector3;

/// A convex shape: a core, and all points within `margin` of it. Its axis is z, its centre the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    pub(crate) core: Core,
    /// m.
    pub(crate) margin: f64,
}

/// What a solid is without its skin; lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Core {
    Point,
    Segment {
        half: f64,
    },
    Box {
        half: Vector3<f64>,
    },
    Frustum {
        lower: f64,
        upper: f64,
        half: f64,
    },
    /// Everything with z <= 0.
    HalfSpace,
}

impl Solid {
    /// A sphere; radius in m.
    pub fn sphere(radius: f64) -> Self {
        Solid { core: Core::Point, margin: radius }
    }

    /// A capsule along z; radius and the length between the centres of its ends in m.
    pub fn capsule(radius: f64, length: f64) -> Self {
        Solid { core: Core::Segment { half: length / 2.0 }, margin: radius }
    }

    /// A box; edges along x, y and z in m.
    pub fn cuboid(size: [f64; 3]) -> Self {
        Solid { core: Core::Box { half: Vector3::from(size) / 2.0 }, margin: 0.0 }
    }

    /// A cylinder along z; radius and length in m.
    pub fn cylinder(radius: f64, length: f64) -> Self {
        Solid::cone(radius, radius, length)
    }

    /// A cone along z, cut off at the upper radius; radii and length in m.
    pub fn cone(lower: f64, upper: f64, length: f64) -> Self {
        Solid { core: Core::Frustum { lower, upper, half: length / 2.0 }, margin: 0.0 }
    }

    /// Everything below the plane z = 0: a floor.
    pub fn half_space() -> Self {
        Solid { core: Core::HalfSpace, margin: 0.0 }
    }

    /// The solid of a drawn shape; `None` of a mesh.
    pub fn of(form: &Form) -> Option<Self> {
        Some(match *form {
            Form::Box { size } => Solid::cuboid(size),
            Form::Cylinder { radius, length } => Solid::cylinder(radius, length),
            Form::Capsule { radius, length } => Solid::capsule(radius, length),
            Form::Sphere { radius } => Solid::sphere(radius),
            Form::Cone { radius, top, length } => Solid::cone(radius, top, length),
            Form::Mesh { .. } => return None,
        })
    }

    /// Radius of a sphere about the origin that holds the solid; infinite of a half-space.
    pub(crate) fn reach(&self) -> f64 {
        let core = match self.core {
            Core::Point => 0.0,
            Core::Segment { half } => half,
            Core::Box { half } => half.norm(),
            Core::Frustum { lower, upper, half } => lower.max(upper).hypot(half),
            Core::HalfSpace => f64::INFINITY,
        };
        core + self.margin
    }
}

impl Core {
    /// The point that lies farthest in a direction; of a half-space the origin.
    pub(crate) fn support(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Core::Point | Core::HalfSpace => Vector3::zeros(),
            Core::Segment { half } => Vector3::new(0.0, 0.0, half.copysign(direction.z)),
            Core::Box { half } => half.zip_map(direction, f64::copysign),
            Core::Frustum { lower, upper, half } => {
                let radial = direction.x.hypot(direction.y);
                let (x, y) =
                    if radial > 0.0 { (direction.x / radial, direction.y / radial) } else { (1.0, 0.0) };
                let ends = [(*lower, -half), (*upper, *half)];
                let [below, above] = ends.map(|(r, z)| radial * r + direction.z * z);
                let (r, z) = if above > below { ends[1] } else { ends[0] };
                Vector3::new(r * x, r * y, z)
            }
        }
    }
}
