//! Values of one evaluation: scratch space, made once.

pub(crate) mod circuits;
mod energies;
mod linear;
mod loops;

use blocksim_block::physical::{
    DryMesh, FrameAcceleration, FrameMotion, Grip, JointLoad, JointMotion, Supply, Torque, Wrench,
};
use blocksim_multibody::{Data, Model};

use self::circuits::{CharacteristicRoom, Convert, FloatRoom, Room};
use self::energies::Energies;
use self::linear::Linear;
use self::loops::LoopWork;
use crate::electrics::Conducting;
use crate::electrics::circuits::Circuits;
use crate::electrics::drift::Ahead;
use crate::mechanics::bounded::Bounded;
use crate::mechanics::lock::Lock;
use crate::mechanics::mesh::MeshScratch;
use crate::mechanics::schur::{Rows, Schur};
use crate::mechanics::stiction::parts::Rest;
use crate::network::Network;

const AT_REST: FrameMotion = FrameMotion {
    rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    position: [0.0; 3],
    angular: [0.0; 3],
    velocity: [0.0; 3],
};

/// Values of one evaluation.
pub(crate) struct Work {
    pub data: Option<Data>,
    /// The model with what payloads add, where there are any.
    pub loaded: Option<Model>,
    pub evaluation: [u64; 3],
    pub s: Vec<f64>,
    pub ds: Vec<f64>,
    pub joint_speed: Vec<f64>,
    /// Accelerations and torques from outside in the order of the tree; motion as members count it.
    pub joint_acceleration: Vec<f64>,
    pub joint_outside: Vec<f64>,
    pub joint_motion: Vec<JointMotion>,
    pub joint_load: Vec<JointLoad>,
    /// Orientation of each ball as its member sees it.
    pub orientation: Vec<[f64; 4]>,
    pub frame_motion: Vec<FrameMotion>,
    pub frame_acceleration: Vec<FrameAcceleration>,
    pub wrench: Vec<Wrench>,
    pub load: Vec<f64>,
    pub pin_speed: Vec<f64>,
    pub pin_acceleration: Vec<f64>,
    pub pin_torque: Vec<f64>,
    pub supply: Vec<Supply>,
    pub line_current: Vec<[f64; 3]>,
    /// Room for currents that a member of a separate circuit shows.
    pub instant: Vec<f64>,
    /// Voltages and currents that components give.
    pub given: Vec<f64>,
    /// States of members with capacitances that sources add to.
    pub own: Vec<f64>,
    pub voltage: Vec<f64>,
    pub current: Vec<f64>,
    /// Solutions of each island.
    pub circuits: Vec<Circuits>,
    /// Whether the gate of each valve is on.
    pub gates: Vec<bool>,
    /// Per island: an instant, and the valves that have changed at it for what comes.
    pub drifted: Vec<(f64, Conducting)>,
    /// Currents that valves of each island which conduct by themselves carried backward where a jump began, all together, A.
    pub late: Vec<f64>,
    pub ahead: Ahead,
    pub float: FloatRoom,
    pub convert: Convert,
    pub characteristics: CharacteristicRoom,
    /// Heat flow of each port for heat, W.
    pub heats: Vec<f64>,
    pub room: Room,
    /// Evaluation in which circuits that the network integrates by itself were looked at.
    pub held_evaluation: u64,
    pub flux: Vec<f64>,
    pub torque: Vec<Torque>,
    /// Torques that members apply to their joints, in the order of the tree and as members count them.
    pub joint_torque: Vec<Torque>,
    pub user_torque: Vec<Torque>,
    /// Mass matrix over the independent speeds, and its Cholesky factor.
    pub mass: Vec<f64>,
    pub factor: Vec<f64>,
    /// Without bodies the mass matrix never changes: both hold for good.
    pub factored: bool,
    pub joint_mass: Vec<f64>,
    pub bias: Vec<f64>,
    pub force: Vec<f64>,
    pub dv: Vec<f64>,
    /// Constraints that hold at this evaluation, their Schur complement, and that of implicit steps.
    pub rows: Rows,
    pub schur: Schur,
    /// What was stuck when it was factored, where that is all it depends on.
    pub schur_of: Vec<usize>,
    pub implicit_schur: Schur,
    /// Mass matrix and constraints where the implicit step began: one matrix for all stages.
    pub implicit_mass: Vec<f64>,
    pub implicit_rows: Rows,
    /// Multipliers within what is held, where several constraints say the same.
    pub bounded: Bounded,
    /// Multipliers of the constraints, and what a loss of one in each mesh takes from them.
    pub lambda: Vec<f64>,
    pub mesh_lambda: Vec<f64>,
    /// What dry friction does; which are stuck, and their first constraint.
    pub grip: Vec<Grip>,
    pub stuck: Vec<usize>,
    pub dry: Vec<DryMesh>,
    pub dry_speed: Vec<f64>,
    pub may_jam: Vec<bool>,
    pub first_stuck: usize,
    /// What the torques and the constraints pull at the network: a torque `Q` at an inertia `J` counts as `Q / sqrt(J)`.
    pub pull: f64,
    pub lock: Lock,
    /// For the choice of modes.
    pub rests: Vec<Rest>,
    pub trial_x: Vec<f64>,
    /// States whose speeds fit the closed loops and what is stuck.
    pub fitting_x: Vec<f64>,
    pub trial_d: Vec<f64>,
    /// Modes that are put aside for a moment.
    pub kept: Vec<f64>,
    /// Something rigid slides that must not.
    pub struck: bool,
    /// Slip of each part behind an impact, if it is rigid.
    pub bounce: Vec<f64>,
    pub residual: Vec<f64>,
    pub mesh: MeshScratch,
    pub mesh_speed: Vec<f64>,
    pub coupling: Vec<f64>,
    pub through: Vec<f64>,
    pub columns: Vec<f64>,
    pub all_mesh: Vec<f64>,
    pub loops: LoopWork,
    /// For the implicit solve.
    pub damping: Vec<f64>,
    pub implicit: Vec<f64>,
    pub product: Vec<f64>,
    pub joint_product: Vec<f64>,
    pub position: Vec<f64>,
    pub position_rate: Vec<f64>,
    /// States and discrete states before a jump.
    pub before: Vec<f64>,
    pub modes: Vec<f64>,
    pub hg: f64,
    pub linear: Vec<Linear>,
    pub energies: Energies,
}

impl Work {
    pub(crate) fn new(network: &Network) -> Self {
        let r = &network.rotation;
        let (n, j, g) = (r.free, network.joints, network.meshes.len());
        let (rows, frictions) = (network.most_constraints(), network.stiction.len());
        let mut given = vec![0.0; network.electrics.given()];
        // The last of the given values is the number 1.
        given.iter_mut().last().into_iter().for_each(|one| *one = 1.0);
        Self {
            data: network.frames.data(),
            loaded: network.frames.model.clone().filter(|_| !network.frames.payloads.is_empty()),
            evaluation: [u64::MAX; 3],
            s: vec![0.0; r.sources],
            ds: vec![0.0; r.sources],
            joint_speed: vec![0.0; j],
            joint_acceleration: vec![0.0; j],
            joint_outside: vec![0.0; j],
            joint_motion: vec![JointMotion::default(); j],
            joint_load: vec![JointLoad::default(); j],
            orientation: vec![[1.0, 0.0, 0.0, 0.0]; network.frames.balls.len()],
            frame_motion: vec![AT_REST; network.frames.probes.len()],
            frame_acceleration: vec![FrameAcceleration::default(); network.frames.probes.len()],
            wrench: vec![Wrench::default(); network.frames.probes.len()],
            load: vec![0.0; network.frames.payloads.len()],
            pin_speed: vec![0.0; r.pins.len()],
            pin_acceleration: vec![0.0; r.pins.len()],
            pin_torque: vec![0.0; r.pins.len()],
            supply: vec![Supply::default(); network.supplies],
            line_current: vec![[0.0; 3]; network.supplies],
            instant: vec![0.0; network.seats.iter().map(|seat| seat.y.len()).max().unwrap_or_default()],
            given,
            own: vec![0.0; network.seats.iter().filter(|s| s.shifted.is_some()).map(|s| s.x.len()).sum()],
            voltage: vec![0.0; network.electrics.two_pins],
            current: vec![0.0; network.electrics.two_pins],
            circuits: network
                .electrics
                .islands
                .iter()
                .map(|i| Circuits::new(&network.electrics, i))
                .collect(),
            gates: vec![false; network.electrics.valves.len()],
            drifted: vec![(f64::NAN, 0); network.electrics.islands.len()],
            late: vec![0.0; network.electrics.islands.len()],
            ahead: Ahead::new(network),
            float: FloatRoom::new(&network.electrics),
            convert: Convert::new(&network.electrics),
            characteristics: CharacteristicRoom::new(&network.electrics),
            heats: vec![0.0; network.electrics.heats.len()],
            room: Room::new(network),
            held_evaluation: u64::MAX,
            flux: Vec::with_capacity(network.electrics.two_pins),
            torque: vec![Torque::default(); r.branches.len()],
            joint_torque: vec![Torque::default(); j],
            user_torque: vec![Torque::default(); j],
            mass: vec![0.0; n * n],
            factor: vec![0.0; n * n],
            factored: false,
            joint_mass: vec![0.0; j * j],
            bias: vec![0.0; j],
            force: vec![0.0; n],
            dv: vec![0.0; n],
            rows: Rows::new(n, rows),
            schur: Schur::new(n, rows),
            schur_of: Vec::with_capacity(frictions),
            implicit_schur: Schur::new(n, rows),
            implicit_mass: vec![0.0; n * n],
            implicit_rows: Rows::new(n, rows),
            bounded: Bounded::new(rows),
            lambda: vec![0.0; rows],
            mesh_lambda: vec![0.0; g * rows],
            grip: vec![Grip::default(); frictions],
            stuck: Vec::with_capacity(frictions),
            dry: vec![DryMesh::default(); network.stiction.meshes()],
            may_jam: vec![false; g],
            dry_speed: vec![0.0; network.stiction.meshes()],
            first_stuck: 0,
            pull: 0.0,
            lock: Lock::new(n, r.sources, frictions),
            rests: vec![Rest::Free; frictions],
            trial_x: vec![0.0; network.interface.states.len()],
            fitting_x: vec![0.0; network.interface.states.len()],
            trial_d: vec![0.0; network.interface.discrete.len()],
            kept: vec![0.0; frictions],
            struck: false,
            bounce: vec![0.0; frictions],
            residual: vec![0.0; r.nodes.len() + j],
            mesh: MeshScratch::new(&network.meshes),
            mesh_speed: vec![0.0; g],
            coupling: vec![0.0; g * g],
            through: vec![0.0; g],
            columns: vec![0.0; g * n],
            all_mesh: vec![0.0; r.all_gears.len()],
            loops: LoopWork::new(network.frames.loops.len(), j, n),
            damping: vec![0.0; n * n],
            implicit: vec![0.0; n * n],
            product: vec![0.0; n],
            joint_product: vec![0.0; j],
            position: vec![0.0; network.positions],
            position_rate: vec![0.0; network.positions],
            before: vec![0.0; network.interface.states.len()],
            modes: vec![0.0; network.interface.discrete.len()],
            hg: 0.0,
            linear: Linear::rooms(network),
            energies: Energies::new(network),
        }
    }
}
