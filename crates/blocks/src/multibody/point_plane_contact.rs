use blocksim_block::physical::{Domain, Element, FrameMotion, Wrench};
use blocksim_block::prelude::*;

use super::joint_limit::{JointLimit, guard_of_side, settle};
use super::vector::{add, between, dot, scale, sub, to_world, velocity_seen};

/// A point that touches a plane: the origin of `follower` against the x-y plane of `base`, whose z axis points out of
/// the material.
///
/// $$ N = s(\delta)\,(k\,\delta + d\,\dot\delta) \ge 0, \qquad s = 3 x^2 - 2 x^3, \quad x = \min(\delta / b, 1) $$
///
/// with the depth $\delta$ of the point below the plane. The normal force sets in smoothly and never pulls. Friction is
/// Coulomb's law, smooth around standstill:
///
/// $$ F_t = -\mu\,N\,\tanh(|v_t| / v_{th})\,v_t / |v_t| $$
///
/// so what lies on a slope creeps, slower the smaller $v_{th}$ is.
///
/// ```ron
/// PointPlaneContact(stiffness: "1e5 N/m", damping: "200 N*s/m", friction: 0.3)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Touch)]
pub struct PointPlaneContact {
    /// Stiffness $k$.
    #[block(unit = "N/m", not_negative, default = 1e6)]
    pub stiffness: f64,
    /// Damping $d$.
    #[block(unit = "N*s/m", not_negative, default = 1e3)]
    pub damping: f64,
    /// Depth $b$ over which both set in.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub transition: f64,
    /// Coefficient of friction $\mu$; zero has none.
    #[block(not_negative, default = 0.0)]
    pub friction: f64,
    /// Speed $v_{th}$ of sliding at which 76 % of the friction act.
    #[block(unit = "m/s", positive, default = 1e-3)]
    pub threshold: f64,
}

const PLANE: &[Change; 2] = &[Change::to(1.0, "touches the plane"), Change::to(0.0, "leaves the plane")];

/// What happens at the point.
struct Touch {
    /// Depth below the plane, m; negative above it.
    depth: f64,
    /// Normal force, N.
    normal: f64,
    /// Speed out of the plane, m/s.
    rise: f64,
    /// Speed of sliding, m/s.
    slip: f64,
    /// Force on the point in world axes, N.
    force: [f64; 3],
}

impl PointPlaneContact {
    /// Where the normal force jumps, it is known whether the point `touches`; elsewhere that is empty.
    fn touch(&self, frames: &[FrameMotion], touches: &[f64]) -> Touch {
        let (plane, point) = (&frames[0], &frames[1]);
        let out = to_world(plane, [0.0, 0.0, 1.0]);
        let depth = -dot(sub(point.position, plane.position), out);
        let velocity = velocity_seen(plane, point);
        let rise = dot(velocity, out);
        let along = sub(velocity, scale(rise, out));
        let slip = dot(along, along).sqrt();
        let normal = self.ground().load(touches.first().map(|touches| *touches != 0.0), depth, -rise).value;
        let grip = if slip > 0.0 { -self.grip(normal, slip) / slip } else { 0.0 };
        Touch { depth, normal, rise, slip, force: add(scale(normal, out), scale(grip, along)) }
    }

    fn ground(&self) -> JointLimit {
        JointLimit { stiffness: self.stiffness, damping: self.damping, transition: self.transition }
    }

    /// Friction along the plane, N.
    fn grip(&self, normal: f64, slip: f64) -> f64 {
        self.friction * normal * (slip / self.threshold).tanh()
    }
}

impl Component for PointPlaneContact {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("base", Domain::Frame, "frame of the plane; its z axis points out")
            .port("follower", Domain::Frame, "frame whose origin touches")
            .measures("f", "N", Needs::State, "normal force")
            .measures("depth", "m", Needs::State, "depth below the plane, negative above it")
            .measures("slip", "m/s", Needs::State, "speed of the point along the plane")
            .element(Element::FrameForce { frame: 0 })
            .element(Element::FrameForce { frame: 1 })
            .guards_of_state();
        let part = match self.ground().is_sudden() {
            true => part.mode("touch", PLANE),
            false => part.kink("touch", "leaves the plane", "touches the plane"),
        };
        if self.transition > 0.0 {
            part.kink("firm", "yields on the plane", "presses fully on the plane")
        } else {
            part
        }
    }

    fn wrenches(&self, c: &Moving, f: &mut [Wrench]) {
        f.copy_from_slice(&between(&c.frames[0], &c.frames[1], self.touch(c.frames, c.d).force));
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        let touch = self.touch(c.frames, c.d);
        let apart = self.ground().apart(touch.depth, -touch.rise);
        let values = std::iter::once(guard_of_side(c.d.first(), apart));
        g.iter_mut().zip(values.chain(self.ground().firm(touch.depth))).for_each(|(g, value)| *g = value);
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        let touch = self.touch(c.frames, c.d);
        d.first_mut().is_some_and(|touches| settle(touches, self.ground().apart(touch.depth, -touch.rise)))
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let touch = self.touch(c.frames, c.d);
        let grip = self.grip(touch.normal, touch.slip);
        let touches = c.d.first().map(|touches| *touches != 0.0);
        self.ground().energy(touches, touch.depth, -touch.rise) + Energy::dissipated(grip * touch.slip)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let touch = self.touch(c.frames, c.d);
        y[..3].copy_from_slice(&[touch.normal, touch.depth, touch.slip]);
    }
}
