//! What a file says about a mechanism, as plain data in SI units.

use blocksim_multibody::{Inertia, Placement};

/// Bodies and joints between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// Name as the file gives it.
    pub name: String,
    /// Bodies and frames, in the order of the file.
    pub bodies: Vec<Body>,
    /// Joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// What was left out or taken for granted, in words for the user.
    pub notes: Vec<String>,
}

/// A rigid body, or a frame if it has no mass.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of block and parameters: letters, digits and `_`, each once in a mechanism.
    pub name: String,
    /// Name in the file.
    pub original: String,
    /// Mass, centre of mass and inertia in the frame of the body.
    pub inertia: Option<Inertia>,
    /// What it looks like.
    pub shapes: Vec<Shape>,
}

/// How a body moves against another one.
///
/// The joint has a frame on each side. With the joint at zero both coincide.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name of block and parameters: letters, digits and `_`, each once in a mechanism.
    pub name: String,
    /// Name in the file.
    pub original: String,
    /// How it moves.
    pub motion: Motion,
    /// The body that carries it, an index; `None` for the world.
    pub base: Option<usize>,
    /// The body that moves, an index.
    pub follower: usize,
    /// Frame of the joint in `base`.
    pub in_base: Placement,
    /// Frame of the joint in `follower`; `None` where it is the frame of the follower itself.
    pub in_follower: Option<Placement>,
    /// Where the motion starts: the frame on the follower's side against the one on the base's side.
    pub start: Start,
    /// Least and largest position, rad or m.
    pub range: Option<[f64; 2]>,
    /// Largest speed, rad/s or m/s.
    pub speed: Option<f64>,
    /// Largest torque or force, N m or N.
    pub effort: Option<f64>,
    /// Viscous damping, N m s/rad or N s/m.
    pub damping: f64,
}

/// Kinds of joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// None.
    Weld,
    /// Rotation about an axis.
    Revolute {
        /// Direction of the axis in the frame of the joint.
        axis: [f64; 3],
    },
    /// Translation along an axis.
    Prismatic {
        /// Direction of the axis in the frame of the joint.
        axis: [f64; 3],
    },
    /// Rotation about z and translation along it.
    Cylindrical,
    /// Translation in the x-y plane and rotation about z.
    Planar,
    /// Any rotation.
    Spherical,
    /// Everything.
    Free,
}

/// Where a joint starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// A position of a joint with one axis, rad or m.
    Position(f64),
    /// A placement of a joint with more freedoms.
    Placement(Placement),
    /// Nothing is said: both frames coincide, or what closes a loop.
    Open,
}

/// A shape fixed to a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// What it is for.
    pub role: Role,
    /// Where it sits in the frame of the body.
    pub place: Placement,
    /// What it is.
    pub form: Form,
    /// Red, green, blue and opacity, 0 to 1.
    pub colour: Option<[f64; 4]>,
}

/// What a shape is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// To be looked at.
    Visual,
    /// To find collisions.
    Collision,
}

/// Kinds of shape; axes as in URDF, the centre at the origin.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// Edges along x, y and z, m.
    Box {
        /// Lengths of the edges, m.
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Length, m.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
    },
    /// Triangles in a file.
    Mesh {
        /// The file as named.
        file: String,
        /// Factors along x, y and z that make metres of its numbers.
        scale: [f64; 3],
        /// Line that names it, from 1.
        line: u32,
    },
}

impl Mechanism {
    /// Whether joints close a loop: then the positions of some follow from those of others.
    pub fn has_loop(&self) -> bool {
        // Bodies that hang together so far; the world is one more.
        let mut group: Vec<usize> = (0..=self.bodies.len()).collect();
        for joint in &self.joints {
            let [a, b] = [joint.base.map_or(0, |i| i + 1), joint.follower + 1].map(|i| find(&group, i));
            if a == b {
                return true;
            }
            group[a] = b;
        }
        false
    }
}

/// Who speaks for the group of `i`.
pub(crate) fn find(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}
