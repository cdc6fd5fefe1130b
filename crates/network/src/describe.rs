//! What a network says of its mechanics to those who look at it from outside.

use blocksim_block::physical::MeshLoss;
use blocksim_multibody::Model;

use crate::network::Network;

/// A joint axis of a network, and what moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisView {
    /// Path of the joint.
    pub path: String,
    /// Index of its position among the positions of the tree, which are the first states of the network.
    pub position: usize,
    /// Index of its speed among the speeds of the tree.
    pub speed: usize,
    /// Moment of inertia of what its drive side moves, brought to the joint, kg m².
    pub reflected: f64,
    /// Members that act on the drive side, by their places along it.
    pub parts: Vec<PartView>,
}

/// A member on the drive side of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct PartView {
    /// Index among [`Network::members`].
    pub member: usize,
    /// Its speed over the speed of the joint; of a mesh, that of its base.
    pub ratio: f64,
    /// The losses, if it is a mesh that has some.
    pub mesh: Option<MeshLoss>,
}

impl Network {
    /// The tree of bodies; `None` without bodies.
    pub fn tree(&self) -> Option<&Model> {
        self.frames.model.as_ref()
    }

    /// Whether the tree alone tells how the bodies move: no closed loops, no balls, no bodies that come and go, and no
    /// prescribed speeds.
    pub fn is_plain_tree(&self) -> bool {
        let frames = &self.frames;
        frames.loops.is_empty()
            && frames.balls.is_empty()
            && frames.payloads.is_empty()
            && self.rotation.sources == 0
            && self.rotation.joints_are_free
    }

    /// The place of a member's input, the first of its elements, among the inputs of the network.
    pub fn input(&self, member: usize, port: usize) -> Option<usize> {
        let seat = self.seats.get(member)?;
        seat.inputs.get(port).map(|(first, _)| seat.u.start + *first as usize)
    }

    /// The axes of the joints, in the order of the tree. Members that move with several axes belong to none.
    pub fn axes(&self) -> Vec<AxisView> {
        let speeds = self.frames.speeds.iter().enumerate();
        speeds.filter_map(|(speed, joint)| self.axis(speed, joint.member, joint.position?)).collect()
    }

    fn axis(&self, speed: usize, member: usize, position: usize) -> Option<AxisView> {
        let rotation = &self.rotation;
        // The independent speed that the joint is, and the share of the joint in it.
        let &[(independent, share)] = rotation.joints.get(speed)?.terms() else { return None };
        let alone = |form: &[(u32, f64)]| match form {
            [(index, ratio)] if *index == independent => Some(ratio / share),
            _ => None,
        };
        let mut parts = Vec::new();
        for (member, seat) in self.seats.iter().enumerate() {
            for branch in seat.branches.clone() {
                let pin = rotation.branches.get(branch).and_then(|pin| rotation.pins.get(*pin));
                if let Some(ratio) = pin.and_then(|pin| alone(pin.speed.terms())) {
                    parts.push(PartView { member, ratio, mesh: None });
                }
            }
            for gear in seat.gears.clone() {
                let lossy = rotation.all_gears.get(gear).and_then(|(_, lossy)| *lossy);
                let Some(gear) = lossy.and_then(|index| rotation.gears.get(index)) else { continue };
                if let Some(ratio) = alone(gear.base.terms()) {
                    parts.push(PartView { member, ratio, mesh: Some(gear.loss) });
                }
            }
        }
        let diagonal = independent as usize * (rotation.free + 1);
        let path = self.seats.get(member)?.member.path.clone();
        let reflected = rotation.reflected.get(diagonal)? / (share * share);
        Some(AxisView { path, position, speed, reflected, parts })
    }
}
