//! Where a frame lies on a body.

use blocksim_block::physical::FrameMotion;
use blocksim_multibody::{BodyId, Data, Motion, Placement};
use nalgebra::{Matrix3, Vector3};

/// A frame fixed to a body, or to the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// `None` is the world.
    pub body: Option<BodyId>,
    /// Of the frame in the body.
    pub placement: Placement,
}

impl Place {
    /// A frame that `step` leads to from this one.
    pub(crate) fn then(&self, step: Placement) -> Self {
        Self { body: self.body, placement: self.placement * step }
    }

    /// Of the frame in the world, from the current placements of the bodies.
    pub(crate) fn in_world(&self, data: &Data) -> Placement {
        match self.body {
            Some(body) => *data.placement(body) * self.placement,
            None => self.placement,
        }
    }

    /// Angular velocity and velocity of the origin in world axes.
    pub(crate) fn velocity(&self, data: &Data) -> Motion {
        self.body.map_or_else(Motion::default, |body| data.world_velocity(body, &self.placement.translation))
    }

    /// Angular acceleration and acceleration of the origin in world axes.
    pub(crate) fn acceleration(&self, data: &Data) -> Motion {
        self.body
            .map_or_else(Motion::default, |body| data.world_acceleration(body, &self.placement.translation))
    }

    /// Pose and velocity, for components.
    pub(crate) fn motion(&self, data: &Data) -> FrameMotion {
        let (at, velocity) = (self.in_world(data), self.velocity(data));
        FrameMotion {
            rotation: rows(&at.rotation),
            position: at.translation.into(),
            angular: velocity.angular.into(),
            velocity: velocity.linear.into(),
        }
    }
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| m[(row, column)]))
}

/// The vector along which a rotation turns, as long as its angle (rad, at most pi).
pub(crate) fn rotation_vector(r: &Matrix3<f64>) -> Vector3<f64> {
    let sine = Vector3::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12) * 0.5;
    let (length, cosine) = (sine.norm(), 0.5 * (r.trace() - 1.0));
    let angle = length.atan2(cosine);
    if length > 1e-8 {
        sine * (angle / length)
    } else if cosine > 0.0 {
        sine
    } else {
        // half a turn: R = 2 n n' - 1; the column of the largest diagonal entry has n
        let k = (0..3).fold(0, |best, i| if r[(i, i)] > r[(best, best)] { i } else { best });
        let column = (r + Matrix3::identity()).column(k).into_owned();
        column.normalize() * angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rotation_vector_is_axis_times_angle() {
        let axis = Vector3::new(0.6, 0.0, -0.8);
        for angle in [0.0, 1e-12, 1e-6, 0.5, 3.0, std::f64::consts::PI] {
            let r = Placement::from_axis_angle([0.0; 3], axis, angle).rotation;
            let found = rotation_vector(&r);
            let off = (found - axis * angle).norm().min((found + axis * angle).norm());
            assert!(off < 1e-8, "{angle}: {found}");
        }
    }
}
