//! What the general solver is asked for.

use crate::kinematics::error::SolveError;
use blocksim_multibody::{Frame, Model, Placement};
use nalgebra::{Matrix3, Vector3};

/// A wish about where frames are. Each is fulfilled within its tolerance (m, rad); weights decide between wishes that
/// cannot all be fulfilled. `reference` is the frame in which a target is written: [`Frame::ground`], the base, a work
/// object, or a frame on another body.
#[derive(Debug, Clone, PartialEq)]
pub enum Constraint {
    /// The origin of a frame is at a point.
    Position {
        /// Frame to be moved.
        frame: Frame,
        /// Frame of the target.
        reference: Frame,
        /// The point, m.
        target: Vector3<f64>,
        /// Distance that is good enough, m.
        tolerance: f64,
        /// Weight.
        weight: f64,
    },
    /// A frame has an orientation.
    Orientation {
        /// Frame to be moved.
        frame: Frame,
        /// Frame of the target.
        reference: Frame,
        /// Rotation matrix.
        target: Matrix3<f64>,
        /// Angle that is good enough, rad.
        tolerance: f64,
        /// Weight.
        weight: f64,
    },
    /// A frame is at a placement.
    Pose {
        /// Frame to be moved.
        frame: Frame,
        /// Frame of the target.
        reference: Frame,
        /// The placement.
        target: Placement,
        /// Distance (m) and angle (rad) that are good enough.
        tolerances: [f64; 2],
        /// Weights of position and orientation.
        weights: [f64; 2],
    },
    /// The z axis of a frame points at a point. The turn about z is free. Fulfilled where the origin is within a
    /// micrometre of the point, which then is in no direction.
    Aiming {
        /// Frame to be moved.
        frame: Frame,
        /// Frame of the target.
        reference: Frame,
        /// The point, m.
        target: Vector3<f64>,
        /// Angle that is good enough, rad.
        tolerance: f64,
        /// Weight.
        weight: f64,
    },
    /// The origin of a frame is in a box.
    CartesianBounds {
        /// Frame to be moved.
        frame: Frame,
        /// Frame of the target.
        reference: Frame,
        /// Frame of the box in the reference.
        target: Placement,
        /// Lower corner, m; may be infinite.
        lower: Vector3<f64>,
        /// Upper corner, m; may be infinite.
        upper: Vector3<f64>,
        /// Weights along the axes of the box.
        weights: Vector3<f64>,
    },
    /// Joint positions are within bounds. One entry per joint, rad or m. Unlike the ranges of the solver, which always
    /// hold, this is weighed against the other constraints.
    JointBounds {
        /// Lower bounds; may be infinite.
        lower: Vec<f64>,
        /// Upper bounds; may be infinite.
        upper: Vec<f64>,
        /// Weights.
        weights: Vec<f64>,
    },
    /// The distance of the origins of two frames is within bounds.
    DistanceBounds {
        /// Frame to be moved.
        frame: Frame,
        /// The other frame.
        reference: Frame,
        /// Least distance, m.
        lower: f64,
        /// Greatest distance, m; may be infinite.
        upper: f64,
        /// Weight.
        weight: f64,
    },
}

impl Constraint {
    /// The origin of `frame` is exactly at a point of `reference`, with weight 1.
    pub fn position(frame: Frame, reference: Frame, target: impl Into<Vector3<f64>>) -> Self {
        Constraint::Position { frame, reference, target: target.into(), tolerance: 0.0, weight: 1.0 }
    }

    /// `frame` is exactly at a placement in `reference`, with weights 1.
    pub fn pose(frame: Frame, reference: Frame, target: Placement) -> Self {
        Constraint::Pose { frame, reference, target, tolerances: [0.0; 2], weights: [1.0; 2] }
    }

    /// The z axis of `frame` points exactly at a point of `reference`, with weight 1.
    pub fn aiming(frame: Frame, reference: Frame, target: impl Into<Vector3<f64>>) -> Self {
        Constraint::Aiming { frame, reference, target: target.into(), tolerance: 0.0, weight: 1.0 }
    }

    /// Checks numbers and frames; `index` is the place of the constraint in its list.
    pub(crate) fn check(&self, index: usize, model: &Model) -> Result<(), SolveError> {
        let constraint = Some(index);
        let finite = |values: &[f64]| match values.iter().all(|e| e.is_finite()) {
            true => Ok(()),
            false => Err(SolveError::NotFinite { what: "the target", constraint }),
        };
        let positive = |what, values: &[f64]| match values.iter().all(|e| *e >= 0.0 && e.is_finite()) {
            true => Ok(()),
            false => Err(SolveError::Negative { constraint: index, what }),
        };
        let rotation = |r: &Matrix3<f64>| match (r.tr_mul(r) - Matrix3::identity()).amax() < 1e-6
            && r.determinant() > 0.0
        {
            true => Ok(()),
            false => Err(SolveError::NotRotation { constraint: index }),
        };
        let ordered = |lower: &[f64], upper: &[f64]| match lower.iter().zip(upper).position(|(l, u)| {
            // not so for NaN
            !(l <= u && *l < f64::INFINITY && *u > f64::NEG_INFINITY)
        }) {
            None => Ok(()),
            Some(entry) => Err(SolveError::BoundsCrossed { constraint, entry }),
        };
        let frames = |frames: [&Frame; 2]| match frames.iter().all(|frame| known(frame, model)) {
            true => Ok(()),
            false => Err(SolveError::UnknownBody { constraint: index }),
        };
        match self {
            Constraint::Position { frame, reference, target, tolerance, weight }
            | Constraint::Aiming { frame, reference, target, tolerance, weight } => {
                frames([frame, reference])?;
                finite(target.as_slice())?;
                positive("tolerance", &[*tolerance])?;
                positive("weight", &[*weight])
            }
            Constraint::Orientation { frame, reference, target, tolerance, weight } => {
                frames([frame, reference])?;
                finite(target.as_slice())?;
                rotation(target)?;
                positive("tolerance", &[*tolerance])?;
                positive("weight", &[*weight])
            }
            Constraint::Pose { frame, reference, target, tolerances, weights } => {
                frames([frame, reference])?;
                finite(target.translation.as_slice())?;
                finite(target.rotation.as_slice())?;
                rotation(&target.rotation)?;
                positive("tolerance", tolerances)?;
                positive("weight", weights)
            }
            Constraint::CartesianBounds { frame, reference, target, lower, upper, weights } => {
                frames([frame, reference])?;
                finite(target.translation.as_slice())?;
                finite(target.rotation.as_slice())?;
                rotation(&target.rotation)?;
                ordered(lower.as_slice(), upper.as_slice())?;
                positive("weight", weights.as_slice())
            }
            Constraint::JointBounds { lower, upper, weights } => {
                for (list, values) in [("lower bounds", lower), ("upper bounds", upper), ("weights", weights)]
                {
                    if values.len() != model.dof() {
                        let (given, joints) = (values.len(), model.dof());
                        return Err(SolveError::WrongLength { list, given, joints });
                    }
                }
                ordered(lower, upper)?;
                positive("weight", weights)
            }
            Constraint::DistanceBounds { frame, reference, lower, upper, weight } => {
                frames([frame, reference])?;
                ordered(&[*lower], &[*upper])?;
                ordered(&[0.0], &[*upper])?;
                positive("weight", &[*weight])
            }
        }
    }
}

fn known(frame: &Frame, model: &Model) -> bool {
    let mut placed = frame.placement.translation.iter().chain(frame.placement.rotation.iter());
    placed.all(|e| e.is_finite()) && frame.body.is_none_or(|body| body.index() < model.bodies().count())
}

/// The constraints of a tool that follows a path of points: its tip is at the point, its z axis aims at it, and no joint
/// moves more than `change` (rad) from `previous`. Tip on the z axis makes the aim a consequence of the position; the
/// orientation then is what the joints leave as near as possible to the one before.
pub fn follow_point(
    tool: Frame,
    reference: Frame,
    point: impl Into<Vector3<f64>>,
    previous: &[f64],
    change: f64,
) -> [Constraint; 3] {
    let point = point.into();
    [
        Constraint::position(tool, reference, point),
        Constraint::aiming(tool, reference, point),
        Constraint::JointBounds {
            lower: previous.iter().map(|q| q - change).collect(),
            upper: previous.iter().map(|q| q + change).collect(),
            weights: vec![1.0; previous.len()],
        },
    ]
}
