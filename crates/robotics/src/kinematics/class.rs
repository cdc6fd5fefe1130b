//! Whether an arm has an ortho-parallel basis and a spherical wrist, and its dimensions.

use crate::kinematics::closed_form::ClosedForm;
use crate::kinematics::error::ClassError;
use crate::kinematics::ortho_parallel::OrthoParallel;
use blocksim_multibody::{Frame, Joint, Model, Placement, forward_kinematics, home_positions};
use nalgebra::{Matrix3, Vector3};

/// What counts as exact, rad and m.
const TOLERANCE: f64 = 1e-6;

/// A joint axis with all joints at zero.
#[derive(Clone, Copy)]
struct Axis {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

impl ClosedForm {
    /// Reads the dimensions off the six joints that carry `end`, a frame on the last of them or fixed to it: the flange
    /// or a tool. The positions of the solutions are in the order of these joints. Angles and lengths that the closed
    /// form takes for exact may deviate by 1e-6 (rad, m); the solutions are then off by as much.
    ///
    /// # Errors
    /// [`ClassError`] names what does not fit.
    pub fn of(model: &Model, end: &Frame) -> Result<Self, ClassError> {
        let last = end.body.ok_or(ClassError::NotSixAxes { axes: 0 })?;
        let chain = model.chain(last);
        if chain.len() != 6 {
            return Err(ClassError::NotSixAxes { axes: chain.len() });
        }
        let mut data = model.data();
        forward_kinematics(model, &mut data, &home_positions(model));
        let mut axes = [Axis { point: Vector3::zeros(), direction: Vector3::z() }; 6];
        for (i, body) in chain.iter().enumerate() {
            let Joint::Revolute { axis } = model.joint(*body) else {
                return Err(ClassError::NotRevolute { axis: i });
            };
            let placement = data.placement(*body);
            axes[i] = Axis { point: placement.translation, direction: placement.direction(axis) };
        }
        let home = end.in_world(&data);
        check(&axes)?;
        measure(&axes, &home)
    }
}

fn check(axes: &[Axis; 6]) -> Result<(), ClassError> {
    for (i, j) in [(0, 1), (2, 3), (3, 4), (4, 5)] {
        let cosine = axes[i].direction.dot(&axes[j].direction);
        if cosine.abs() > TOLERANCE {
            let angle = cosine.clamp(-1.0, 1.0).acos();
            return Err(ClassError::NotPerpendicular { axes: [i, j], angle });
        }
    }
    let sine = axes[1].direction.cross(&axes[2].direction).norm();
    match sine > TOLERANCE {
        true => Err(ClassError::NotParallel { axes: [1, 2], angle: sine.clamp(0.0, 1.0).asin() }),
        false => Ok(()),
    }
}

/// The wrist centre: where axes 4 and 5 meet, which must be on axis 6.
fn wrist_centre(axes: &[Axis; 6]) -> Result<Vector3<f64>, ClassError> {
    let (four, five, six) = (&axes[3], &axes[4], &axes[5]);
    // perpendicular axes: the feet of the common normal are projections
    let between = five.point - four.point;
    let on_four = four.point + four.direction * between.dot(&four.direction);
    let on_five = five.point - five.direction * between.dot(&five.direction);
    let distance = (on_five - on_four).norm();
    if distance > TOLERANCE {
        return Err(ClassError::NotMeeting { axes: [3, 4], distance });
    }
    let distance = (on_four - six.point).cross(&six.direction).norm();
    match distance > TOLERANCE {
        true => Err(ClassError::NotMeeting { axes: [3, 5], distance }),
        false => Ok(on_four),
    }
}

fn measure(axes: &[Axis; 6], home: &Placement) -> Result<ClosedForm, ClassError> {
    let d: [Vector3<f64>; 6] = std::array::from_fn(|i| axes[i].direction);
    let (z, y) = (d[0], d[1]);
    let x = y.cross(&z).normalize();
    let origin = axes[0].point - z * axes[0].point.dot(&z);
    let centre = wrist_centre(axes)?;
    // in the plane of the arm
    let plane = |v: &Vector3<f64>| (v.dot(&x), v.dot(&z));
    let (shoulder, elbow) = (axes[1].point, axes[2].point);
    let (a1, c1) = plane(&(shoulder - origin));
    let (forward, up) = plane(&(elbow - shoulder));
    let c2 = forward.hypot(up);
    let t2 = forward.atan2(up);
    let (mut signs, mut offsets) = ([1.0; 6], [0.0; 6]);
    // senses are chosen so that lengths along axes 4 and 6 are positive
    let sign = |positive: f64| if positive < 0.0 { -1.0 } else { 1.0 };
    signs[2] = sign(d[2].dot(&y));
    let fore = centre - elbow;
    signs[3] = sign(fore.dot(&d[3]));
    let z4 = d[3] * signs[3];
    let x4 = y.cross(&z4).normalize();
    let (a2, c3) = (fore.dot(&x4), fore.dot(&z4));
    let (z4_forward, z4_up) = plane(&z4);
    let t3 = z4_forward.atan2(z4_up) - t2;
    signs[4] = sign(d[4].dot(&y));
    let y5 = d[4] * signs[4];
    let t4 = (-y5.dot(&x4)).atan2(y5.dot(&y));
    let x5 = y5.cross(&z4);
    let hand = home.translation - centre;
    signs[5] = sign(hand.dot(&d[5]));
    let z6 = d[5] * signs[5];
    let t5 = z6.dot(&x5).atan2(z6.dot(&z4));
    let c4 = hand.dot(&z6);
    // with θ = sign q - offset and q = 0
    for (i, t) in [(1, t2), (2, t3), (3, t4), (4, t5)] {
        offsets[i] = 0.0 - wrapped(t);
    }
    for (part, length) in [("upper arm", c2), ("forearm", a2.hypot(c3))] {
        if length < TOLERANCE {
            return Err(ClassError::NoLength { part });
        }
    }
    let last = Placement {
        rotation: Matrix3::from_columns(&[y5.cross(&z6).normalize(), y5, z6]),
        translation: centre + z6 * c4,
    };
    let base = Placement { rotation: Matrix3::from_columns(&[x, y, z]), translation: origin };
    let b = (centre - origin).dot(&y);
    let geometry = OrthoParallel { a1, a2, b, c1, c2, c3, c4, signs, offsets };
    Ok(ClosedForm { base, geometry, end: last.inverse() * *home })
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}
