//! A network: its values, laid out.

use blocksim_block::Interface;
use blocksim_block::physical::MeshLoss;
use blocksim_scene::Scene;

use crate::accounts::Accounts;
use crate::electrics::{Electrics, Separate};
use crate::mechanics::envelope::Envelope;
use crate::mechanics::frames::Frames;
use crate::mechanics::rotation::Rotation;
use crate::mechanics::scene;
use crate::mechanics::stiction::parts::Stiction;
use crate::member::Member;
use crate::problem::NetworkProblem;
use crate::seat::{Active, Seat};

/// A physical network as one block.
///
/// States: positions of joints, independent speeds, then the states of the members. Output groups 0
/// and 3 depend on states alone, group 1 on the inputs of electrical sources, group 2 on everything, as
/// [`Needs`](blocksim_block::physical::Needs) says.
#[derive(Debug)]
pub struct Network {
    pub(crate) seats: Vec<Seat>,
    pub(crate) rotation: Rotation,
    pub(crate) stiction: Stiction,
    /// Shape of the mass matrix.
    pub(crate) envelope: Envelope,
    pub(crate) electrics: Electrics,
    pub(crate) frames: Frames,
    pub(crate) meshes: Vec<MeshLoss>,
    /// Number of supplies: those of sources, and those that machines in circuits see.
    pub(crate) supplies: usize,
    /// Where the discrete states of valves begin: whether each conducts by itself.
    pub(crate) first_latch: usize,
    /// Where the gate of each valve is held among the discrete states, if it has one.
    pub(crate) gate_cells: Vec<Option<usize>>,
    /// Valves that conduct by themselves, in the order of their guards, which come behind those of the members.
    pub(crate) natural: Vec<usize>,
    pub(crate) first_natural: usize,
    pub(crate) interface: Interface,
    /// Number of positions of joints.
    pub(crate) positions: usize,
    /// Where the positions of joints stand among the outputs, if the mechanism has shapes.
    pub(crate) first_pose: usize,
    /// Number of speeds of joints.
    pub(crate) joints: usize,
    /// Some currents are measured before voltages are known.
    pub(crate) has_early: bool,
    pub(crate) active: Active,
    /// Circuits that the network integrates by itself.
    pub(crate) separate: Vec<Separate>,
    pub(crate) accounts: Accounts,
    /// Where it lies whether a steady state is sought.
    pub(crate) seeks: usize,
    /// Values given for the start that are not kept.
    pub(crate) moved: Vec<NetworkProblem>,
}

impl Network {
    /// Values that are given for the start and could not be kept: of joints in closed loops, and of what is coupled to them.
    pub fn moved(&self) -> &[NetworkProblem] {
        &self.moved
    }

    /// The members, in the order of their inputs and outputs.
    pub fn members(&self) -> impl Iterator<Item = &Member> {
        self.seats.iter().map(|seat| &*seat.member)
    }

    /// What is seen of the mechanism.
    pub fn scene(&self) -> &Scene {
        &self.frames.scene
    }

    /// Signals that tell where the bodies of a mechanism with shapes are: the name to record each by and its output.
    pub fn pose_signals(&self) -> impl Iterator<Item = (&str, usize)> {
        let outputs = self.interface.outputs.len();
        let recorded = scene::outputs(&self.frames).len();
        self.frames.signals.iter().map(String::as_str).zip(outputs - recorded..outputs)
    }

    /// Prescribed speeds may jump, and loops pass that on.
    pub(crate) fn loops_meet_sources(&self) -> bool {
        self.rotation.sources > 0 && !self.frames.loops.is_empty()
    }
}
