//! Values of one evaluation: scratch space, made once.

use blocksim_block::physical::{JointMotion, Supply, Torque};
use blocksim_multibody::Data;

use crate::circuits::Circuits;
use crate::constraints::{Rows, Schur};
use crate::float::FloatRoom;
use crate::mesh::MeshScratch;
use crate::network::Network;
use crate::separate::Room;

/// Values of one evaluation.
pub(crate) struct Work {
    pub data: Option<Data>,
    pub evaluation: [u64; 3],
    pub s: Vec<f64>,
    pub ds: Vec<f64>,
    pub joint_speed: Vec<f64>,
    pub joint_motion: Vec<JointMotion>,
    pub pin_speed: Vec<f64>,
    pub pin_acceleration: Vec<f64>,
    pub pin_torque: Vec<f64>,
    pub supply: Vec<Supply>,
    pub line_current: Vec<[f64; 3]>,
    /// Voltages and currents that components give.
    pub given: Vec<f64>,
    pub voltage: Vec<f64>,
    pub current: Vec<f64>,
    /// Solutions of each island.
    pub circuits: Vec<Circuits>,
    /// Whether the gate of each valve is on.
    pub gates: Vec<bool>,
    pub float: FloatRoom,
    pub room: Room,
    /// Evaluation in which circuits that the network integrates by itself were looked at.
    pub held_evaluation: u64,
    pub flux: Vec<f64>,
    pub torque: Vec<Torque>,
    pub joint_torque: Vec<Torque>,
    /// Mass matrix over the independent speeds, and its Cholesky factor.
    pub mass: Vec<f64>,
    pub factor: Vec<f64>,
    pub joint_mass: Vec<f64>,
    pub bias: Vec<f64>,
    pub force: Vec<f64>,
    pub dv: Vec<f64>,
    /// Constraints that hold at this evaluation, their Schur complement, and that of implicit steps.
    pub rows: Rows,
    pub schur: Schur,
    pub implicit_schur: Schur,
    /// Multipliers of the constraints, and what a loss of one in each mesh takes from them.
    pub lambda: Vec<f64>,
    pub mesh_lambda: Vec<f64>,
    pub residual: Vec<f64>,
    pub mesh: MeshScratch,
    pub mesh_speed: Vec<f64>,
    pub coupling: Vec<f64>,
    pub through: Vec<f64>,
    pub columns: Vec<f64>,
    pub all_mesh: Vec<f64>,
    /// For the implicit solve.
    pub damping: Vec<f64>,
    pub implicit: Vec<f64>,
    pub product: Vec<f64>,
    /// States and discrete states before a jump.
    pub before: Vec<f64>,
    pub modes: Vec<f64>,
    pub hg: f64,
}

impl Work {
    pub(crate) fn new(network: &Network) -> Self {
        let r = &network.rotation;
        let (n, j, g) = (r.free, network.joints, network.meshes.len());
        let rows = network.most_constraints();
        let mut given = vec![0.0; network.electrics.given()];
        // The last of the given values is the number 1.
        given.iter_mut().last().into_iter().for_each(|one| *one = 1.0);
        Self {
            data: network.frames.data(),
            evaluation: [u64::MAX; 3],
            s: vec![0.0; r.sources],
            ds: vec![0.0; r.sources],
            joint_speed: vec![0.0; j],
            joint_motion: vec![JointMotion::default(); j],
            pin_speed: vec![0.0; r.pins.len()],
            pin_acceleration: vec![0.0; r.pins.len()],
            pin_torque: vec![0.0; r.pins.len()],
            supply: vec![Supply::default(); network.supplies],
            line_current: vec![[0.0; 3]; network.supplies],
            given,
            voltage: vec![0.0; network.electrics.two_pins],
            current: vec![0.0; network.electrics.two_pins],
            circuits: network
                .electrics
                .islands
                .iter()
                .map(|i| Circuits::new(&network.electrics, i))
                .collect(),
            gates: vec![false; network.electrics.valves.len()],
            float: FloatRoom::new(&network.electrics),
            room: Room::new(network),
            held_evaluation: u64::MAX,
            flux: Vec::with_capacity(network.electrics.two_pins),
            torque: vec![Torque::default(); r.branches.len()],
            joint_torque: vec![Torque::default(); j],
            mass: vec![0.0; n * n],
            factor: vec![0.0; n * n],
            joint_mass: vec![0.0; j * j],
            bias: vec![0.0; j],
            force: vec![0.0; n],
            dv: vec![0.0; n],
            rows: Rows::new(n, rows),
            schur: Schur::new(n, rows),
            implicit_schur: Schur::new(n, rows),
            lambda: vec![0.0; rows],
            mesh_lambda: vec![0.0; g * rows],
            residual: vec![0.0; r.nodes.len() + j],
            mesh: MeshScratch::new(g),
            mesh_speed: vec![0.0; g],
            coupling: vec![0.0; g * g],
            through: vec![0.0; g],
            columns: vec![0.0; g * n],
            all_mesh: vec![0.0; r.all_gears.len()],
            damping: vec![0.0; n * n],
            implicit: vec![0.0; n * n],
            product: vec![0.0; n],
            before: vec![0.0; network.interface.states.len()],
            modes: vec![0.0; network.interface.discrete.len()],
            hg: 0.0,
        }
    }
}
