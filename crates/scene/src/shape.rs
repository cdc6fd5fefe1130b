//! Shapes fixed to a body.

use blocksim_multibody::Placement;
use serde::{Deserialize, Serialize};

use crate::place;

/// A shape fixed to a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// What it is for.
    #[serde(rename = "use")]
    pub purpose: Purpose,
    /// What it is; its centre is at the origin, its axis along z.
    #[serde(flatten)]
    pub form: Form,
    /// Where it sits in the frame of the body.
    #[serde(flatten, with = "place")]
    pub place: Placement,
    /// Red, green, blue and opacity, 0 to 1; `None` leaves it to who draws.
    pub colour: Option<[f64; 4]>,
}

/// What a shape is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Purpose {
    /// To be looked at and to find collisions.
    Both,
    /// To be looked at.
    Visual,
    /// To find collisions.
    Collision,
}

/// Kinds of shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Form {
    /// Edges along x, y and z.
    Box {
        /// Lengths of the edges, m.
        size: [f64; 3],
    },
    /// A cylinder.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Length, m.
        length: f64,
    },
    /// A cylinder with half a sphere on each end.
    Capsule {
        /// Radius, m.
        radius: f64,
        /// Length of the cylinder alone, m.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
    },
    /// A cone, or what is left of it when the tip is cut off.
    Cone {
        /// Radius at the lower end, z = -length/2, m.
        radius: f64,
        /// Radius at the upper end, m; zero is a tip.
        top: f64,
        /// Length, m.
        length: f64,
    },
    /// Triangles in a file.
    Mesh {
        /// The file.
        file: String,
        /// Factors along x, y and z that make metres of its numbers.
        scale: [f64; 3],
    },
}

impl Shape {
    /// Whether it is to be looked at.
    pub fn is_visual(&self) -> bool {
        self.purpose != Purpose::Collision
    }

    /// Whether it takes part in collisions.
    pub fn collides(&self) -> bool {
        self.purpose != Purpose::Visual
    }
}
