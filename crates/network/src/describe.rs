//! What a network says of its mechanics to those who look at it from outside.

use blocksim_block::physical::{LossModel, MeshLoss};
use blocksim_multibody::Model;

use crate::mechanics::rotation::LossyGear;
use crate::network::Network;

/// A joint axis of a network, and what moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisView {
    /// Path of the joint.
    pub path: String,
    /// Index of the joint among [`Network::members`].
    pub member: usize,
    /// Index of its position among the positions of the tree, which are the first states of the network.
    pub position: usize,
    /// Index of its speed among the speeds of the tree.
    pub speed: usize,
    /// Moment of inertia of what its drive side moves, brought to the joint, kg m².
    pub reflected: f64,
    /// Members that act on the drive side with a torque, dry friction last.
    pub parts: Vec<PartView>,
    /// Meshes with losses on the drive side.
    pub meshes: Vec<MeshView>,
    /// Members that move with this axis and with others.
    pub shared: Vec<usize>,
}

/// A torque on the drive side of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct PartView {
    /// Index among [`Network::members`].
    pub member: usize,
    /// Its speed over the speed of the joint.
    pub ratio: f64,
    /// For each of [`AxisView::meshes`] the share of its power that goes through the mesh on the way to the joint, positive from the
    /// base to the follower: 1 for a part on the side of the base, -1 on the side of the follower, 0 where the mesh is
    /// not between the part and the joint. Other numbers where power takes several ways.
    pub through: Vec<f64>,
}

/// A mesh with losses on the drive side of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshView {
    /// Index among [`Network::members`].
    pub member: usize,
    /// Its number among the meshes with stiction of the member, if it is one of these.
    pub dry: usize,
    /// The speed of its base over the speed of the joint.
    pub ratio: f64,
    /// The losses.
    pub loss: MeshLoss,
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
        let moves = |form: &[(u32, f64)]| form.iter().any(|(index, _)| *index == independent);
        let (mut parts, mut meshes, mut shared) = (Vec::new(), Vec::new(), Vec::new());
        let mut branches = Vec::new();
        let mut gears = Vec::new();
        for (member, seat) in self.seats.iter().enumerate() {
            let mut dry = 0;
            for gear in seat.gears.clone() {
                let lossy = rotation.all_gears.get(gear).and_then(|(_, lossy)| *lossy);
                let Some(gear) = lossy.and_then(|index| rotation.gears.get(index)) else { continue };
                if let Some(ratio) = alone(gear.base.terms()) {
                    meshes.push(MeshView { member, dry, ratio, loss: gear.loss });
                    gears.push(gear);
                } else if moves(gear.base.terms()) {
                    shared.push(member);
                }
                dry += usize::from(gear.loss.model == LossModel::Stiction);
            }
            branches.extend(seat.branches.clone().map(|branch| (member, branch)));
        }
        for (member, seat) in self.seats.iter().enumerate() {
            branches.extend(seat.frictions.clone().map(|friction| (member, rotation.smooth + friction)));
        }
        for (member, branch) in branches {
            let Some(pin) = rotation.branches.get(branch).and_then(|pin| rotation.pins.get(*pin)) else {
                continue;
            };
            if let Some(ratio) = alone(pin.speed.terms()) {
                // What a torque at the part puts into the base of a mesh while the joint stands still, as power.
                let passes =
                    |(gear, mesh): (&&LossyGear, &MeshView)| -gear.by_torque.at(branch) * mesh.ratio / ratio;
                let through = gears.iter().zip(&meshes).map(passes).collect();
                parts.push(PartView { member, ratio, through });
            } else if moves(pin.speed.terms()) {
                shared.push(member);
            }
        }
        shared.dedup();
        let diagonal = independent as usize * (rotation.free + 1);
        let path = self.seats.get(member)?.member.path.clone();
        let reflected = rotation.reflected.get(diagonal)? / (share * share);
        Some(AxisView { path, member, position, speed, reflected, parts, meshes, shared })
    }
}
