//! Frames of joints: axes, origins, and numbers without rounding.

use blocksim_multibody::Placement;
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::mechanism::Motion;

/// A rotation that takes z to an axis; the axis may point either way, that with the larger positive part is taken.
pub(super) fn z_to(axis: Vector3<f64>) -> Matrix3<f64> {
    let largest = axis[axis.iamax()];
    let axis = (axis * largest.signum()).map(|x| if x.abs() < 1e-9 { 0.0 } else { x }).normalize();
    let turn = Rotation3::rotation_between(&Vector3::z(), &axis).map(Rotation3::into_inner);
    turn.unwrap_or_else(Matrix3::identity).map(|x| if (x - x.round()).abs() < 1e-12 { x.round() } else { x })
}

/// A joint that constraints leave, with its frame parallel to that of the body that moves and, where its axis passes there,
/// at the origin of that body, as a person would choose it.
pub(super) fn at_body(motion: Motion, frame: &Placement, body: &Placement) -> (Motion, Placement) {
    const NEAR: f64 = 1e-9;
    let z = frame.rotation.column(2).into_owned();
    let axis = || {
        let axis = (body.rotation.transpose() * z).map(|x| if x.abs() < NEAR { 0.0 } else { x });
        axis.normalize().into()
    };
    match motion {
        Motion::Prismatic { .. } => (Motion::Prismatic { axis: axis() }, *body),
        Motion::Revolute { .. } => {
            let foot = frame.translation + z * z.dot(&(body.translation - frame.translation));
            let near = (foot - body.translation).norm() < NEAR;
            let at = if near { body.translation } else { foot };
            (Motion::Revolute { axis: axis() }, Placement { rotation: body.rotation, translation: at })
        }
        _ => (motion, *frame),
    }
}

/// How far two positions of a joint are apart: whole turns do not count.
pub(super) fn gap(motion: Motion, gap: f64) -> f64 {
    match motion {
        Motion::Revolute { .. } => gap.sin().hypot(gap.cos() - 1.0),
        _ => gap.abs(),
    }
}

/// Without the last digits of rounding: lengths to 1e-13 m, rotations where they are zeros and ones.
pub(super) fn clean(place: Placement) -> Placement {
    let length = |x: f64| if x.abs() < 1e-13 { 0.0 } else { x };
    let turn = |x: f64| if (x - x.round()).abs() < 1e-12 { x.round() } else { x };
    Placement { rotation: place.rotation.map(turn), translation: place.translation.map(length) }
}
