//! Links and joints must make one tree, and what a joint moves must have mass.

use super::Links;
use crate::fault::{Fault, keep};
use crate::mechanism::{Body, Joint, Motion};
use crate::xml::Element;

/// Gathers what is wrong with the tree.
pub(super) fn check(
    robot: Element,
    links: &Links,
    joints: &[(Element, Joint)],
    filled: bool,
    faults: &mut Vec<Fault>,
) {
    let bodies = &links.bodies;
    let mut above: Vec<Option<usize>> = vec![None; bodies.len()];
    for (i, (element, joint)) in joints.iter().enumerate() {
        let child = joint.follower;
        if let Some(other) = above[child] {
            let (link, other) = (&bodies[child].1.original, &joints[other].1.original);
            let reason =
                format!("link `{link}` is the child of two joints, of `{other}` and of `{}`", joint.original);
            let remedy = "URDF knows trees only; take one joint out and close the loop in the diagram";
            let _ = keep::<()>(Err(element.fault(reason, remedy)), faults);
            continue;
        }
        above[child] = Some(i);
    }
    let roots: Vec<usize> = (0..bodies.len()).filter(|i| above[*i].is_none()).collect();
    if let [_, second, ..] = roots[..] {
        let names: Vec<String> =
            roots.iter().take(5).map(|i| format!("`{}`", bodies[*i].1.original)).collect();
        let reason = format!("several links are no child of a joint: {}", names.join(", "));
        let _ = keep::<()>(Err(bodies[second].0.fault(reason, "join them by joints of type fixed")), faults);
    }
    if !faults.is_empty() {
        return;
    }
    let Some(order) = order(joints, &above, &roots) else {
        let (element, joint) = &joints[0];
        let element = if roots.is_empty() { &robot } else { element };
        let reason = format!("the joints go round in a circle, for example through `{}`", joint.original);
        let _ = keep::<()>(
            Err(element.fault(reason, "one link must be the root: no child of any joint")),
            faults,
        );
        return;
    };
    // Masses that hang on each link, from the tips inwards.
    let filling = |body: &Body| filled && !body.shapes.is_empty();
    let stated = |body: &Body| body.inertia.map_or(if filling(body) { 1.0 } else { 0.0 }, |i| i.mass);
    let mut mass: Vec<f64> = bodies.iter().map(|(_, body)| stated(body)).collect();
    for joint in order.iter().rev() {
        let (element, joint) = &joints[*joint];
        let moved = mass[joint.follower];
        if joint.motion != Motion::Weld && moved == 0.0 {
            let reason = format!("joint `{}` moves nothing that has mass", joint.original);
            let _ = keep::<()>(
                Err(element.fault(reason, "give a link behind it <inertial>, or make the joint fixed")),
                faults,
            );
        }
        if let Some(base) = joint.base {
            mass[base] += moved;
        }
    }
}

/// Joints, those nearer to the root first; `None` if some never come to it.
fn order(joints: &[(Element, Joint)], above: &[Option<usize>], roots: &[usize]) -> Option<Vec<usize>> {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); above.len()];
    for (i, (_, joint)) in joints.iter().enumerate() {
        below[joint.base?].push(i);
    }
    let mut order = Vec::with_capacity(joints.len());
    let mut open = roots.to_vec();
    while let Some(link) = open.pop() {
        for joint in &below[link] {
            order.push(*joint);
            open.push(joints[*joint].1.follower);
        }
    }
    (order.len() == joints.len()).then_some(order)
}
