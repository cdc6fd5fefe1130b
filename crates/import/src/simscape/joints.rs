//! Joints that a file states as such: each has a frame on both sides, its axis along z.

use blocksim_multibody::Placement;

use super::instances::{Instances, placement};
use super::units::Units;
use crate::fault::{Fault, shown};
use crate::mechanism::Motion;
use crate::xml::Element;

/// A joint as stated.
#[derive(Debug, Clone)]
pub(super) struct Stated {
    pub name: String,
    pub motion: Motion,
    pub between: [usize; 2],
    /// Its frames in both instances.
    pub frames: [Placement; 2],
}

pub(super) fn read<'a>(
    element: Element<'a, '_>,
    inside: usize,
    instances: &Instances<'a>,
    units: Units,
) -> Result<Stated, Fault> {
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    let motion = match element.name() {
        "Weld" | "Rigid" | "Fixed" => Motion::Weld,
        "Revolute" => Motion::Revolute { axis: Z },
        "Prismatic" => Motion::Prismatic { axis: Z },
        "Cylindrical" => Motion::Cylindrical,
        "Planar" => Motion::Planar,
        "Spherical" => Motion::Spherical,
        "SixDof" | "Bushing" => Motion::Free,
        other => {
            let reason = format!("`{}` is not a kind of joint that is known", shown(other));
            return Err(element
                .fault(reason, "use weld, revolute, prismatic, cylindrical, planar or spherical joints"));
        }
    };
    let side = |name: &'static str| -> Result<(usize, Placement), Fault> {
        let frame = element.need(name)?;
        let place = match frame.one("Transform")? {
            Some(transform) => placement(transform, units)?,
            None => Placement::identity(),
        };
        Ok((instances.named(frame, inside)?, place))
    };
    let ((base, in_base), (follower, in_follower)) = (side("BaseFrame")?, side("FollowerFrame")?);
    let name = element.attribute("name").unwrap_or(element.name()).to_owned();
    Ok(Stated { name, motion, between: [base, follower], frames: [in_base, in_follower] })
}
