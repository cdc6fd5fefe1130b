use blocksim_block::physical::{Domain, Element, FrameMotion, Wrench};
use blocksim_block::prelude::*;

use super::vector::{between, dot, scale, sub};

/// A spring and a damper between the origins of two frames, along the line between them.
///
/// $$ F = k\,(l - l_0) + d\,\dot l $$
///
/// with the distance $l$ of the origins; positive $F$ pulls them together. While the origins coincide the line has no
/// direction and nothing acts.
///
/// ```ron
/// FrameSpringDamper(stiffness: "2000 N/m", damping: "50 N*s/m", length: "0.3 m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = SpringDamper)]
pub struct FrameSpringDamper {
    /// Stiffness $k$.
    #[block(unit = "N/m", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient $d$ of the damper.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub damping: f64,
    /// Length $l_0$ of the relaxed spring.
    #[block(unit = "m", not_negative, default = 0.0)]
    pub length: f64,
}

/// Distance below which a line has no direction, m.
const NO_DIRECTION: f64 = 1e-12;

impl FrameSpringDamper {
    /// Direction from the first origin to the second, their distance and its rate, and the pull.
    fn pull(&self, frames: &[FrameMotion]) -> ([f64; 3], [f64; 3]) {
        let way = sub(frames[1].position, frames[0].position);
        let distance = dot(way, way).sqrt();
        if distance < NO_DIRECTION {
            return ([0.0; 3], [distance, 0.0, 0.0]);
        }
        let direction = scale(1.0 / distance, way);
        let rate = dot(sub(frames[1].velocity, frames[0].velocity), direction);
        (direction, [distance, rate, self.stiffness * (distance - self.length) + self.damping * rate])
    }
}

impl Component for FrameSpringDamper {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("base", Domain::Frame, "frame at one end")
            .port("follower", Domain::Frame, "frame at the other end")
            .measures("l", "m", Needs::State, "distance of the origins")
            .measures("v", "m/s", Needs::State, "its rate")
            .measures("f", "N", Needs::State, "force that pulls the origins together")
            .element(Element::FrameForce { frame: 0 })
            .element(Element::FrameForce { frame: 1 })
    }

    fn wrenches(&self, c: &Moving, f: &mut [Wrench]) {
        let (direction, [_, _, pull]) = self.pull(c.frames);
        f.copy_from_slice(&between(&c.frames[0], &c.frames[1], scale(-pull, direction)));
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let [distance, rate, _] = self.pull(c.frames).1;
        let stretch = distance - self.length;
        Energy {
            stored: 0.5 * self.stiffness * stretch * stretch,
            dissipated: self.damping * rate * rate,
            ..Energy::default()
        }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[..3].copy_from_slice(&self.pull(c.frames).1);
    }
}
