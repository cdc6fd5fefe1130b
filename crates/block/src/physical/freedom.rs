//! The motions that a joint allows.

/// One motion that a joint allows.
#[derive(Debug, Clone, PartialEq)]
pub enum Freedom {
    /// Rotation about an axis: rad, rad/s, N*m.
    Turn(Axis),
    /// Translation along an axis: m, m/s, N.
    Slide(Axis),
    /// Any rotation. Four positions: the quaternion (w, x, y, z) that turns `follower` against `base`; three speeds:
    /// the angular velocity of `follower` against `base` in the axes of `follower`, rad/s.
    Ball {
        /// Orientation at the start; any length but zero.
        orientation: Option<[f64; 4]>,
        /// Angular velocity at the start in the axes of `follower`, rad/s.
        velocity: Option<[f64; 3]>,
    },
}

/// An axis of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Names of the states: position and speed.
    pub names: [&'static str; 2],
    /// Unit vector in the frame that the freedoms before it have moved.
    pub direction: [f64; 3],
    /// Rod and case of the drive side, two rotational ports (translational ones of a slide): `w_r - w_c` is the
    /// speed of the axis.
    pub drive: Option<(usize, usize)>,
    /// Position at the start; where nothing is given it is zero, or in a closed loop what closes it.
    pub position: Option<f64>,
    /// Speed at the start; as for the position.
    pub velocity: Option<f64>,
}

impl Axis {
    /// An axis without a drive side and without start values.
    pub fn new(names: [&'static str; 2], direction: [f64; 3]) -> Self {
        Self { names, direction, drive: None, position: None, velocity: None }
    }

    /// With a drive side.
    pub fn driven(mut self, r: usize, c: usize) -> Self {
        self.drive = Some((r, c));
        self
    }

    /// With start values.
    pub fn starting(mut self, position: Option<f64>, velocity: Option<f64>) -> Self {
        (self.position, self.velocity) = (position, velocity);
        self
    }
}

impl Freedom {
    /// Number of speeds.
    pub fn speeds(&self) -> usize {
        if matches!(self, Freedom::Ball { .. }) { 3 } else { 1 }
    }

    /// The axis that it turns about or slides along; `None` of a ball.
    pub fn axis(&self) -> Option<&Axis> {
        match self {
            Freedom::Turn(axis) | Freedom::Slide(axis) => Some(axis),
            Freedom::Ball { .. } => None,
        }
    }
}
