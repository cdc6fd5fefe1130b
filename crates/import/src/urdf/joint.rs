//! Joints: kind, frame, axis and limits.

use std::collections::BTreeMap;

use blocksim_multibody::Placement;
use nalgebra::{Rotation3, Vector3};

use super::link::origin;
use crate::fault::{Fault, shown};
use crate::mechanism::{Joint, Motion, Start};
use crate::xml::Element;

pub(super) fn read(
    joint: Element,
    original: &str,
    name: String,
    links: &BTreeMap<&str, usize>,
    notes: &mut Vec<String>,
) -> Result<Joint, Fault> {
    let base = link_of(joint.need("parent")?, links)?;
    let follower = link_of(joint.need("child")?, links)?;
    let mut in_base = origin(joint)?;
    let mut in_follower = None;
    let kind = joint.text_of("type")?;
    let motion = match kind {
        "fixed" => Motion::Weld,
        "revolute" | "continuous" => Motion::Revolute { axis: axis(joint)? },
        "prismatic" => Motion::Prismatic { axis: axis(joint)? },
        "floating" => Motion::Free,
        "planar" => {
            // The plane stands across the axis; a planar joint moves in x and y.
            let turn = Placement { rotation: z_to(axis(joint)?), translation: Vector3::zeros() };
            if turn != Placement::identity() {
                in_base = in_base * turn;
                in_follower = Some(turn);
            }
            Motion::Planar
        }
        _ => {
            let remedy = "joints are revolute, continuous, prismatic, fixed, floating or planar";
            return Err(joint.fault(format!("`{}` is not a kind of joint", shown(kind)), remedy));
        }
    };
    if joint.one("mimic")?.is_some() {
        notes.push(format!(
            "joint `{original}` follows another one (<mimic>); it is imported as a joint of its own: connect both by a gear"
        ));
    }
    let limit = joint.one("limit")?;
    let range = match (kind, limit) {
        ("revolute" | "prismatic", Some(limit)) => Some(range(limit)?),
        ("revolute" | "prismatic", None) => {
            let reason = format!("the {kind} joint `{original}` has no <limit>");
            return Err(joint.fault(
                reason,
                "add <limit lower=.. upper=.. effort=.. velocity=../>, or make it continuous",
            ));
        }
        _ => None,
    };
    let start = match motion {
        Motion::Revolute { .. } | Motion::Prismatic { .. } => {
            // The nearest to zero that the joint can reach.
            let start = range.map_or(0.0, |[lower, upper]| 0.0_f64.clamp(lower, upper));
            if start != 0.0 {
                notes.push(format!("joint `{original}` cannot be at zero; it starts at its limit, {start}"));
            }
            Start::Position(start)
        }
        _ => Start::Open,
    };
    let (damping, friction) = dynamics(joint)?;
    if friction != 0.0 {
        notes.push(format!(
            "joint `{original}` has dry friction ({friction} N m or N), which is left out: connect a RotationalFriction to its drive side"
        ));
    }
    let positive = |name: &str| -> Result<Option<f64>, Fault> {
        let Some(limit) = limit else { return Ok(None) };
        match limit.numbers::<1>(name)? {
            Some([x]) if x < 0.0 => {
                Err(limit.fault(format!("`{name}` is {x}"), "limits of this kind are not below zero"))
            }
            // Zero is written where nothing is known.
            Some([x]) => Ok((x > 0.0).then_some(x)),
            None => Ok(None),
        }
    };
    Ok(Joint {
        name,
        original: original.to_owned(),
        motion,
        base: Some(base),
        follower,
        in_base,
        in_follower,
        start,
        range,
        speed: positive("velocity")?,
        effort: positive("effort")?,
        damping,
    })
}

fn link_of(element: Element, links: &BTreeMap<&str, usize>) -> Result<usize, Fault> {
    let name = element.text_of("link")?;
    links.get(name).copied().ok_or_else(|| {
        let reason = format!("<{}> names the link `{}`, which does not exist", element.name(), shown(name));
        element.fault(reason, "name a <link> of this file")
    })
}

/// The direction of the axis, x where none is given.
fn axis(joint: Element) -> Result<[f64; 3], Fault> {
    let Some(element) = joint.one("axis")? else { return Ok([1.0, 0.0, 0.0]) };
    let axis = element.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]);
    let length = Vector3::from(axis).norm();
    match length.is_finite() && length > 1e-9 {
        true => Ok(axis),
        false => Err(element.fault("the axis has no direction", "write one such as xyz=\"0 0 1\"")),
    }
}

/// A rotation that takes z to a direction.
fn z_to(axis: [f64; 3]) -> nalgebra::Matrix3<f64> {
    let half_turn_about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    Rotation3::rotation_between(&Vector3::z(), &Vector3::from(axis)).unwrap_or(half_turn_about_x).into_inner()
}

/// `<limit>`: lower and upper position; both are zero where they are not written.
fn range(limit: Element) -> Result<[f64; 2], Fault> {
    let [lower, upper] = ["lower", "upper"].map(|name| limit.numbers::<1>(name));
    let (lower, upper) = (lower?.map_or(0.0, |[x]| x), upper?.map_or(0.0, |[x]| x));
    match lower < upper {
        true => Ok([lower, upper]),
        false => Err(limit.fault(
            format!("the lower limit {lower} is not below the upper limit {upper}"),
            "correct the limits (rad or m); a joint that cannot move is fixed, one without limits continuous",
        )),
    }
}

/// Damping and friction, zero where they are not written.
fn dynamics(joint: Element) -> Result<(f64, f64), Fault> {
    let Some(dynamics) = joint.one("dynamics")? else { return Ok((0.0, 0.0)) };
    let [damping, friction] = ["damping", "friction"].map(|name| dynamics.numbers::<1>(name));
    let (damping, friction) = (damping?.map_or(0.0, |[x]| x), friction?.map_or(0.0, |[x]| x));
    match damping >= 0.0 && friction >= 0.0 {
        true => Ok((damping, friction)),
        false => Err(dynamics.fault("damping or friction is below zero", "correct the sign")),
    }
}
