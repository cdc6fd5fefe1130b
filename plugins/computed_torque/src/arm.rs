//! Inverse dynamics of a chain of links.

use blocksim_controller::prelude::*;

use crate::quantities::{LINKS, Rest};
use crate::vector::{M3, V3, add, cross, dot, rpy, scaled, turn, turned, turned_back};

/// A rigid body in the frame of its link.
#[derive(Clone, Copy)]
struct Solid {
    mass: f64,
    com: V3,
    /// About the centre of mass.
    inertia: M3,
}

impl Solid {
    /// Force, and moment about the origin of the link, that this motion of the link takes: speed and acceleration of
    /// rotation, acceleration of the origin.
    fn wrench(&self, w: V3, dw: V3, a: V3) -> (V3, V3) {
        let at = add(cross(dw, self.com), cross(w, cross(w, self.com)));
        let force = scaled(add(a, at), self.mass);
        let spin = add(turned(&self.inertia, dw), cross(w, turned(&self.inertia, w)));
        (force, add(spin, cross(self.com, force)))
    }
}

fn three(p: &Parameters, name: Parameter) -> V3 {
    let v = p.vector(name);
    [v[0], v[1], v[2]]
}

/// The tensor with the moments (Ixx, Iyy, Izz) and the products (Iyz, Izx, Ixy).
fn tensor(moi: V3, poi: V3) -> M3 {
    [[moi[0], poi[2], poi[1]], [poi[2], moi[1], poi[0]], [poi[1], poi[0], moi[2]]]
}

fn link(p: &Parameters, i: usize) -> Solid {
    let l = &LINKS[i];
    Solid { mass: p[l.mass], com: three(p, l.com), inertia: tensor(three(p, l.moi), three(p, l.poi)) }
}

/// A solid given in the frame of the tool, in that of the last link.
fn on_tool(p: &Parameters, r: &Rest, [mass, com, moi, poi]: [Parameter; 4]) -> Solid {
    let turn = rpy(three(p, r.tool_rpy));
    let own = tensor(three(p, moi), three(p, poi));
    // R I Rᵀ; the tensor is symmetric, so its rows are its columns.
    let half = own.map(|column| turned(&turn, column));
    let columns = [0, 1, 2].map(|k| turned(&turn, [half[0][k], half[1][k], half[2][k]]));
    let com = add(three(p, r.tool_at), turned(&turn, three(p, com)));
    Solid { mass: p[mass], com, inertia: columns }
}

/// Direction of the joint before a link; length one.
fn axis(p: &Parameters, i: usize) -> V3 {
    let axis = three(p, LINKS[i].axis);
    scaled(axis, 1.0 / dot(axis, axis).sqrt())
}

/// Torques of the joints (N m) for a motion: positions, speeds and accelerations in rad, rad/s, rad/s².
///
/// Newton and Euler from the base to the tool and back; each vector is written in the frame of its link. All frames
/// are parallel at position zero. Gravity is an acceleration of the base upward.
pub fn torques<const N: usize>(p: &Parameters, r: &Rest, q: &[f64], qd: &[f64], qdd: &[f64]) -> [f64; N] {
    let (mut w, mut dw, mut a) = ([0.0; 3], [0.0; 3], scaled(three(p, r.gravity), -1.0));
    let mut turns = [[[0.0; 3]; 3]; N];
    let mut wrenches = [([0.0; 3], [0.0; 3]); N];
    for i in 0..N {
        let (axis, origin) = (axis(p, i), three(p, LINKS[i].origin));
        turns[i] = turn(axis, q[i]);
        // The joint moves with the link before.
        a = add(a, add(cross(dw, origin), cross(w, cross(w, origin))));
        let before = turned_back(&turns[i], w);
        let spin = scaled(axis, qd[i]);
        dw = add(turned_back(&turns[i], dw), add(scaled(axis, qdd[i]), cross(before, spin)));
        w = add(before, spin);
        a = turned_back(&turns[i], a);
        wrenches[i] = link(p, i).wrench(w, dw, a);
    }
    let tool = [r.tool_mass, r.tool_com, r.tool_moi, r.tool_poi];
    let load = [r.load_mass, r.load_com, r.load_moi, r.load_poi];
    for solid in [tool, load] {
        wrenches[N - 1] = sum(wrenches[N - 1], on_tool(p, r, solid).wrench(w, dw, a));
    }
    let mut tau = [0.0; N];
    for i in (0..N).rev() {
        let (force, moment) = wrenches[i];
        tau[i] = dot(axis(p, i), moment);
        if i > 0 {
            let force = turned(&turns[i], force);
            let moment = add(turned(&turns[i], moment), cross(three(p, LINKS[i].origin), force));
            wrenches[i - 1] = sum(wrenches[i - 1], (force, moment));
        }
    }
    tau
}

fn sum(a: (V3, V3), b: (V3, V3)) -> (V3, V3) {
    (add(a.0, b.0), add(a.1, b.1))
}
