//! Parts of physical networks: what a component connects, contains and obeys.
//!
//! A component names its conserving ports, contributes [`Element`]s between them and states the laws of those
//! elements as functions. Kirchhoff's laws, the balance of torques and the elimination of rigid connections
//! appear in no component: the assembly of a network does them in one place.
//!
//! Rotation and translation share their elements: where this page says speed, torque and inertia, translational ports
//! have velocity (m/s), force (N) and mass (kg), and angles (rad) are positions (m).
//!
//! Signs. A branch between `r` and `c` has the speed `w_r - w_c`; its torque is counted positive when it absorbs
//! power at positive speed: it acts as `-tau` on `r` and `+tau` on `c`. A two-pin between `p` and `n` has the
//! voltage `v_p - v_n`; its current is counted positive from `p` through the element to `n`.

use std::fmt::Debug;

use crate::{Discrete, Given, Input, Interface, Output, State};

/// What a conserving port carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Angular velocity (rad/s) and torque (N*m).
    Rotational,
    /// Velocity (m/s) and force (N).
    Translational,
    /// Potential (V) and current (A).
    Electrical,
    /// Three potentials and currents, phases a, b, c.
    ThreePhase,
    /// A frame of a rigid body: pose and wrench.
    Frame,
}

impl std::fmt::Display for Domain {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Domain::Rotational => "rotational",
            Domain::Translational => "translational",
            Domain::Electrical => "electrical",
            Domain::ThreePhase => "three-phase",
            Domain::Frame => "frame",
        })
    }
}

/// A conserving port.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalPort {
    /// Name in the diagram.
    pub name: String,
    /// What it carries.
    pub domain: Domain,
    /// One sentence for the manual.
    pub doc: &'static str,
    /// A node inside of a component; see [`Part::inner`].
    pub inner: bool,
}

/// How torque is lost in a mesh; see [`Element::Gear`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshLoss {
    /// Efficiency when the base drives the follower, in (0, 1].
    pub forward: f64,
    /// Efficiency when the follower drives the base, in (0, 1].
    pub backward: f64,
    /// How the loss sets in around standstill.
    pub model: LossModel,
}

/// How the loss of a mesh sets in around standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LossModel {
    /// `T_f = |T_B| lambda tanh(w_B / threshold)`: never delivers power. Threshold in rad/s at the base.
    Dissipative {
        /// Speed of the base at which the loss is fully there (tanh 1), rad/s.
        threshold: f64,
    },
    /// `T_f = T_B/2 ((FL + BL) tanh(4 p / threshold) + FL - BL)` with the power `p = T_B w_B`. Threshold in W.
    Published {
        /// Power above which the full loss acts, W.
        threshold: f64,
    },
    /// The full loss at any speed, and truly stuck at rest; [`Component::mesh_losses`] gives it, the efficiencies
    /// beside are not looked at. The network chooses between forward, backward and stuck ([`Law::mode`]).
    Stiction,
}

/// What a mesh loses while it slides; at rest it holds up to the same torque. With `T` the torque into the base that
/// passes on to the follower, the loss at the base is the larger one of `share[0] T + bearing[0]` and
/// `-share[1] T + bearing[1]` while the base turns forward, and against that, with `-T`, while it turns backward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DryMesh {
    /// Loss over torque while the base drives (`1/eta - 1`) and while the follower drives (`1 - eta`, above 1 for a mesh
    /// that locks itself).
    pub share: [f64; 2],
    /// Torque of the bearings at the base while the base drives and while the follower drives, N*m; not negative.
    pub bearing: [Torque; 2],
}

impl DryMesh {
    /// Loss at the base, N*m, and its derivatives by the torque that passes and by the speed of the base, while the
    /// base turns in the direction of `sense` (1 or -1).
    pub fn loss(&self, torque: f64, sense: f64) -> (f64, f64, f64) {
        let driving = self.share[0] * sense * torque + self.bearing[0].value;
        let driven = -self.share[1] * sense * torque + self.bearing[1].value;
        if driving >= driven {
            (sense * driving, self.share[0], self.bearing[0].slope)
        } else {
            (sense * driven, -self.share[1], self.bearing[1].slope)
        }
    }
}

/// Where an electrical element ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pin {
    /// An electrical port.
    Port(usize),
    /// Phase 0, 1 or 2 of a three-phase port.
    Phase(usize, usize),
    /// A node of the component's own, numbered from 0.
    Inner(usize),
    /// Potential zero.
    Ground,
}

/// What makes a valve conduct.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValveKind {
    /// While the gate is on, in both directions: contact, MOSFET.
    Switch,
    /// While it is forward biased: diode.
    Diode,
    /// While the gate is on and it is forward biased: IGBT.
    GatedDiode,
    /// From a moment when the gate is on and it is forward biased until its current ends: thyristor.
    Thyristor,
}

/// What a component contributes to a network. Ports are numbered as in [`Part::ports`].
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// Moment of inertia or mass at a mechanical port, against an implied ground.
    Inertia {
        /// Mechanical port.
        port: usize,
        /// Moment of inertia, kg*m^2; mass, kg.
        inertia: f64,
        /// Speed at the start, rad/s or m/s.
        speed: f64,
    },
    /// A torque between two mechanical ports of one domain that [`Component::torques`] gives.
    Branch {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// Dry friction between two mechanical ports of one domain, that sticks: [`Component::grips`] gives what it can hold and its
    /// torque while it slides; the network chooses between forward, backward and stuck ([`Law::mode`]).
    Friction {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// Two mechanical ports of one domain rigidly coupled; the torque through it is measured.
    Rigid {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// A speed between two mechanical ports of one domain that [`Component::speeds`] prescribes.
    SpeedSource {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// Only looks at the speed between two mechanical ports of one domain.
    SpeedProbe {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// `w_follower = ratio * w_base`, both against an implied ground; may lead from one domain to the other.
    Gear {
        /// Input side.
        base: usize,
        /// Output side.
        follower: usize,
        /// Speed of the follower over speed of the base; negative when it reverses. In m from rotation to translation.
        ratio: f64,
        /// Losses of the mesh; `None` when there are none.
        loss: Option<MeshLoss>,
    },
    /// `sum of factor * w_port = 0`, all against an implied ground: the linear relation between the speeds of a
    /// planetary gear or a differential. Without losses; the torques into the ports have the proportions of the
    /// factors.
    Coupling {
        /// Mechanical ports with their factors; none of them zero.
        terms: Vec<(usize, f64)>,
    },
    /// A mechanical port that stands still.
    MechanicalReference {
        /// Mechanical port.
        port: usize,
    },
    /// Two pins that are one node: a connection inside a component.
    Junction {
        /// One pin.
        p: Pin,
        /// The other.
        n: Pin,
    },
    /// Potential zero.
    ElectricalReference {
        /// Electrical port.
        port: usize,
    },
    /// A voltage that [`Component::voltages`] gives.
    VoltageSource {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
    },
    /// A current that [`Component::currents`] gives.
    Winding {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
        /// The current follows from states alone (there is inductance), not from the voltage at the same instant.
        from_state: bool,
    },
    /// A current that [`Component::currents`] gives from its inputs, whatever the voltage.
    CurrentSource {
        /// Pin that the current enters by.
        p: Pin,
        /// Pin that it leaves by.
        n: Pin,
    },
    /// A voltage that is a state: [`Component::voltages`] gives it, the current changes it.
    Capacitance {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
    },
    /// `v = resistance * i`.
    Resistance {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
        /// Resistance, Ohm; positive.
        resistance: f64,
    },
    /// Conducts or not, by a gate, by itself or both.
    Valve {
        /// Pin that the current enters by when the valve conducts forward.
        p: Pin,
        /// Pin that it leaves by.
        n: Pin,
        /// What makes it conduct.
        kind: ValveKind,
        /// Resistance while it conducts, ohm; zero is an ideal contact.
        on_resistance: f64,
        /// Voltage that remains while it conducts, V.
        forward_voltage: f64,
        /// Conductance while it does not, S; zero cuts the branch.
        off_conductance: f64,
    },
    /// `v_primary = ratio * v_secondary`, `i_secondary = -ratio * i_primary`, at all frequencies.
    IdealTransformer {
        /// Positive and negative pin.
        primary: (Pin, Pin),
        /// Positive and negative pin.
        secondary: (Pin, Pin),
        /// Turns of the primary over turns of the secondary.
        ratio: f64,
    },
    /// Only looks at a voltage.
    VoltageProbe {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
    },
    /// A wire whose current is measured.
    CurrentProbe {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
    },
    /// A symmetric three-phase source that [`Component::supply`] gives.
    Supply {
        /// Three-phase port.
        ac: usize,
    },
    /// A three-phase winding that is symmetric and has inductance; it sees [`Law::supply`] and gives
    /// [`Component::line_current`].
    ///
    /// With `ends` it is three separate windings from the phases of `ac` to those of `ends`; voltages and currents are
    /// those of the windings. Without, the windings are joined inside, in delta or in a star whose point floats:
    /// voltages are those of the phases against their mean, currents those of the lines.
    Machine {
        /// Three-phase port.
        ac: usize,
        /// Three-phase port of the other ends.
        ends: Option<usize>,
    },
    /// The inertial frame.
    World {
        /// Frame port.
        frame: usize,
        /// Gravitational acceleration in the world frame, m/s^2.
        gravity: [f64; 3],
    },
    /// A rigid body fixed to a frame.
    Body {
        /// Frame port.
        frame: usize,
        /// Mass, kg.
        mass: f64,
        /// Centre of mass in the frame, m.
        com: [f64; 3],
        /// Inertia about the centre of mass, axes of the frame: Ixx, Iyy, Izz, kg*m^2.
        moi: [f64; 3],
        /// Tensor elements Iyz, Izx, Ixy, kg*m^2.
        poi: [f64; 3],
    },
    /// A fixed displacement between two frames.
    Transform {
        /// Frame it starts from.
        base: usize,
        /// Frame it leads to.
        follower: usize,
        /// Rotation matrix, row by row: coordinates in `follower` to coordinates in `base`.
        rotation: [[f64; 3]; 3],
        /// Origin of `follower` in `base`, m.
        translation: [f64; 3],
    },
    /// A joint: `follower` moves against `base` by one freedom after another, in this order from `base`.
    Joint {
        /// Frame port.
        base: usize,
        /// Frame port.
        follower: usize,
        /// At least one; at most one of them is [`Freedom::Ball`].
        freedoms: Vec<Freedom>,
    },
    /// Looks at the motion of a frame: [`Law::frames`].
    FrameProbe {
        /// Frame port.
        frame: usize,
    },
    /// Looks at the motion of a frame and acts on it with the wrench that [`Component::wrenches`] gives.
    FrameForce {
        /// Frame port.
        frame: usize,
    },
    /// A rigid body fixed to a frame with the share, 0 or 1, that [`Component::load`] gives: what a gripper holds.
    Payload {
        /// Frame port.
        frame: usize,
        /// Mass, kg.
        mass: f64,
        /// Centre of mass in the frame, m.
        com: [f64; 3],
        /// Inertia about the centre of mass, axes of the frame: Ixx, Iyy, Izz, kg*m^2.
        moi: [f64; 3],
        /// Tensor elements Iyz, Izx, Ixy, kg*m^2.
        poi: [f64; 3],
    },
}

/// One motion that a joint allows.
#[derive(Debug, Clone, PartialEq)]
pub enum Freedom {
    /// Rotation about an axis: rad, rad/s, N*m.
    Turn(Axis),
    /// Translation along an axis: m, m/s, N.
    Slide(Axis),
    /// Any rotation. Four positions: the quaternion (w, x, y, z) that turns `follower` against `base`; three speeds:
    /// the angular velocity of `follower` against `base` in the axes of `follower`, rad/s.
    Ball {
        /// Orientation at the start; any length but zero.
        orientation: Option<[f64; 4]>,
        /// Angular velocity at the start in the axes of `follower`, rad/s.
        velocity: Option<[f64; 3]>,
    },
}

/// An axis of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Names of the states: position and speed.
    pub names: [&'static str; 2],
    /// Unit vector in the frame that the freedoms before it have moved.
    pub direction: [f64; 3],
    /// Rod and case of the drive side, two rotational ports (translational ones of a slide): `w_r - w_c` is the
    /// speed of the axis.
    pub drive: Option<(usize, usize)>,
    /// Position at the start; where nothing is given it is zero, or in a closed loop what closes it.
    pub position: Option<f64>,
    /// Speed at the start; as for the position.
    pub velocity: Option<f64>,
}

impl Axis {
    /// An axis without a drive side and without start values.
    pub fn new(names: [&'static str; 2], direction: [f64; 3]) -> Self {
        Self { names, direction, drive: None, position: None, velocity: None }
    }

    /// With a drive side.
    pub fn driven(mut self, r: usize, c: usize) -> Self {
        self.drive = Some((r, c));
        self
    }

    /// With start values.
    pub fn starting(mut self, position: Option<f64>, velocity: Option<f64>) -> Self {
        (self.position, self.velocity) = (position, velocity);
        self
    }
}

impl Freedom {
    /// Number of speeds.
    pub fn speeds(&self) -> usize {
        if matches!(self, Freedom::Ball { .. }) { 3 } else { 1 }
    }
}

/// Motion of a frame in the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameMotion {
    /// Rotation matrix, row by row: coordinates in the frame to coordinates in the world.
    pub rotation: [[f64; 3]; 3],
    /// Origin in the world, m.
    pub position: [f64; 3],
    /// Angular velocity, rad/s.
    pub angular: [f64; 3],
    /// Velocity of the origin, m/s.
    pub velocity: [f64; 3],
}

/// Force and torque on a body at the origin of a frame, in the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force, N.
    pub force: [f64; 3],
    /// Torque about the origin of the frame, N*m.
    pub torque: [f64; 3],
}

/// A torque or force and how it changes with speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Torque {
    /// Torque, N*m; force, N.
    pub value: f64,
    /// Its derivative with respect to the speed, N*m*s/rad or N*s/m; positive damps. Needs not be exact: it keeps stiff
    /// friction cheap to integrate, and never changes the result.
    pub slope: f64,
}

/// What dry friction does at a speed. The first of each pair belongs to forward motion (`w_r > w_c`), the second to
/// backward motion; all are amounts, none negative.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Grip {
    /// Torque up to which it stays stuck, N*m. Infinite where it never slides in this direction, as a freewheel;
    /// zero in both directions where nothing holds (an open clutch).
    pub hold: [f64; 2],
    /// Torque against the motion if it slides at the present speed in this direction; the slope is that over the
    /// speed in this direction. A step of the solver that steps over standstill asks for the direction that it came
    /// from: go on smoothly there.
    pub slide: [Torque; 2],
}

impl Grip {
    /// The same in both directions: what it holds, and its torque over the amount of the speed.
    pub fn symmetric(hold: f64, speed: f64, slide: impl Fn(f64) -> Torque) -> Self {
        Self { hold: [hold; 2], slide: [slide(speed), slide(-speed)] }
    }
}

/// What an output of a component needs before it can be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Needs {
    /// States, positions and speeds: no input at the same instant.
    State,
    /// Voltages and currents as well.
    Electrics,
    /// Torques and accelerations as well.
    Motion,
}

/// Three-phase voltages as a space vector (amplitude invariant) in a frame of its own.
///
/// An ideal source gives its frame, which turns with it, to the machines that it feeds directly; elsewhere the frame
/// stands still with its real axis on phase a.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Supply {
    /// Components on the real (d) and imaginary (q) axis of the frame, V; their length is the peak phase voltage.
    pub voltage: [f64; 2],
    /// Zero sequence: the mean of the three voltages, V.
    pub zero: f64,
    /// Speed of the frame, Hz; negative for the sequence a, c, b.
    pub frequency: f64,
    /// Angle of the frame against the axis of phase a, rad.
    pub angle: f64,
}

impl Supply {
    /// Peak phase voltage, V.
    pub fn amplitude(&self) -> f64 {
        self.voltage[0].hypot(self.voltage[1])
    }

    /// Voltages of the phases, V.
    pub fn phases(&self) -> [f64; 3] {
        let (sin, cos) = self.angle.sin_cos();
        let [d, q] = self.voltage;
        from_space_vector([cos * d - sin * q, sin * d + cos * q, self.zero])
    }
}

/// Half the square root of three.
const HALF_SQRT_3: f64 = 0.866_025_403_784_438_6;

/// Phase values of a space vector with zero sequence in the frame of phase a.
#[inline]
pub fn from_space_vector([alpha, beta, zero]: [f64; 3]) -> [f64; 3] {
    let (half, lift) = (-0.5 * alpha, HALF_SQRT_3 * beta);
    [alpha + zero, half + lift + zero, half - lift + zero]
}

/// Space vector and zero sequence of phase values, in the frame of phase a.
#[inline]
pub fn space_vector([a, b, c]: [f64; 3]) -> [f64; 3] {
    [(2.0 * a - b - c) / 3.0, (b - c) / (2.0 * HALF_SQRT_3), (a + b + c) / 3.0]
}

/// Motion of one speed of a joint: rad, rad/s, N*m, or m, m/s, N of a slide.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMotion {
    /// Position; zero of a ball, see [`Law::orientation`].
    pub q: f64,
    /// Speed.
    pub w: f64,
    /// Acceleration; in `measure` with [`Needs::Motion`] only.
    pub a: f64,
    /// Torque of the drive side on the joint; in `measure` with [`Needs::Motion`] only.
    pub drive: f64,
}

/// What a component sees. Lists are numbered by the elements of one kind in the order of [`Part::elements`]:
/// `speed`, `acceleration` and `torque` count branches, frictions, rigid couplings, speed sources and speed probes
/// together;
/// `voltage` and `current` count all two-pins (sources, capacitances, windings, resistances, valves, both probes)
/// together; an ideal transformer counts as two, primary and secondary.
#[derive(Debug, Clone, Copy)]
pub struct Law<'a> {
    /// Time, s.
    pub t: f64,
    /// States of the component.
    pub x: &'a [f64],
    /// Discrete states of the component: latches, modes, memories.
    pub d: &'a [f64],
    /// Inputs, port after port.
    pub u: &'a [f64],
    /// Start and end in `u` of each input port.
    pub inputs: &'a [(u32, u32)],
    /// Speeds `w_r - w_c`, rad/s.
    pub speed: &'a [f64],
    /// Their derivatives, rad/s^2; in `measure` with [`Needs::Motion`] only.
    pub acceleration: &'a [f64],
    /// Torques from `r` to `c`, N*m; in `measure` with [`Needs::Motion`] only.
    pub torque: &'a [f64],
    /// Torque into the base of each gear of the component, N*m; in `measure` with [`Needs::Motion`] only.
    pub mesh: &'a [f64],
    /// Mode of each dry friction, or of each mesh with stiction if there is no friction: 1 slides forward, -1 slides
    /// backward, 0 is stuck.
    pub mode: &'a [f64],
    /// Voltages, V; not in `voltages`.
    pub voltage: &'a [f64],
    /// Currents, A; not in `voltages` and `currents`.
    pub current: &'a [f64],
    /// The three-phase supply that the component is connected to (or is).
    pub supply: Supply,
    /// Current drawn from the supply as a space vector in its frame and zero sequence, A; for the supply in `measure`.
    pub line_current: [f64; 3],
    /// Motion of the component's joint, speed by speed in the order of its freedoms.
    pub joint: &'a [JointMotion],
    /// Orientation of `follower` in `base` of a joint with a ball: unit quaternion (w, x, y, z).
    pub orientation: [f64; 4],
    /// Motion of the frames that the component looks at: probes and forces in the order of the elements.
    pub frames: &'a [FrameMotion],
}

impl<'a> Law<'a> {
    /// Time zero, everything at rest, nothing connected.
    #[inline]
    pub fn nothing() -> Self {
        Law {
            t: 0.0,
            x: &[],
            d: &[],
            u: &[],
            inputs: &[],
            speed: &[],
            acceleration: &[],
            torque: &[],
            mesh: &[],
            mode: &[],
            voltage: &[],
            current: &[],
            supply: Supply::default(),
            line_current: [0.0; 3],
            joint: &[],
            orientation: [1.0, 0.0, 0.0, 0.0],
            frames: &[],
        }
    }

    /// The first element of an input port.
    #[inline]
    pub fn scalar(&self, port: usize) -> f64 {
        self.u[self.inputs[port].0 as usize]
    }

    /// All elements of an input port.
    #[inline]
    pub fn input(&self, port: usize) -> &'a [f64] {
        let (start, end) = self.inputs[port];
        &self.u[start as usize..end as usize]
    }
}

/// The law of a block that belongs to a physical network. All functions are pure.
pub trait Component: Debug + Send + Sync {
    /// Ports, signals, states and elements.
    fn part(&self, given: &Given) -> Part;

    /// Voltage of each voltage source and capacitance, V.
    fn voltages(&self, _c: &Law, _v: &mut [f64]) {}

    /// The three-phase supply.
    fn supply(&self, _c: &Law) -> Supply {
        Supply::default()
    }

    /// Prescribed speed and its derivative of each speed source.
    fn speeds(&self, _c: &Law, _w: &mut [f64], _dw: &mut [f64]) {}

    /// Current of each winding and current source, A.
    fn currents(&self, _c: &Law, _i: &mut [f64]) {}

    /// Current that a machine draws from its supply, as a space vector in the frame of the supply and zero sequence, A;
    /// from states alone.
    fn line_current(&self, _c: &Law) -> [f64; 3] {
        [0.0; 3]
    }

    /// Whether the gate of each valve is on; from inputs and discrete states.
    fn gates(&self, _c: &Law, _on: &mut [bool]) {}

    /// How the currents of windings that are states change with voltages: `di/dt = inverse * (v - internal)`.
    ///
    /// Where nothing but such currents meets at a node they depend on each other, and this tells the potential
    /// there. `internal` has one entry for each such winding, three for a machine: a space vector in the frame of its
    /// supply and zero sequence. `inverse`, 1/H, is symmetric and stored by rows. Speeds are known.
    fn reluctance(&self, _c: &Law, _internal: &mut [f64], _inverse: &mut [f64]) {}

    /// Adds volt-seconds, as numbered in [`reluctance`](Self::reluctance), to the fluxes: what a voltage without end
    /// does in no time when a contact opens.
    fn strike(&self, _c: &Law, _volt_seconds: &[f64], _x: &mut [f64]) {}

    /// Torque of each branch.
    fn torques(&self, _c: &Law, _tau: &mut [Torque]) {}

    /// What each dry friction does.
    fn grips(&self, _c: &Law, _grips: &mut [Grip]) {}

    /// What each mesh of [`LossModel::Stiction`] loses, at these speeds of their bases in the direction they slide in.
    fn mesh_losses(&self, _c: &Law, _speed: &[f64], _losses: &mut [DryMesh]) {}

    /// Torque that the component itself applies to each speed of its joint (springs, stops, the torque input).
    fn joint_torques(&self, _c: &Law, _tau: &mut [Torque]) {}

    /// Force and torque on each frame that the component acts on, in the order of [`Element::FrameForce`].
    fn wrenches(&self, _c: &Law, _f: &mut [Wrench]) {}

    /// Share of its payload that is attached: 0 or 1.
    fn load(&self, _c: &Law) -> f64 {
        0.0
    }

    /// Derivatives of the states; voltages, currents and speeds are known.
    fn derivatives(&self, _c: &Law, _dx: &mut [f64]) {}

    /// How the states and the torque of the only branch change, for linearly implicit methods: `a` is the derivative of
    /// the derivatives of the states over the states, by rows; `b` that over the speed of the branch; `c` that of the
    /// torque over the states. Only when the part says [`Part::linear`]. They need not be exact: they keep what is
    /// stiff cheap to integrate, and never change the result.
    fn linearize(&self, _law: &Law, _a: &mut [f64], _b: &mut [f64], _c: &mut [f64]) {}

    /// Jumps of states at a major step: changes `x` and `d`, while the law shows everything as it was before; see
    /// [`Block::jump`](crate::Block::jump). Only when the part says [`Part::jumps`].
    fn jump(&self, _c: &Law, _x: &mut [f64], _d: &mut [f64]) -> bool {
        false
    }

    /// Functions whose sign changes are events; as many as [`Part::guards`].
    fn guards(&self, _c: &Law, _g: &mut [f64]) {}

    /// The next time after `c.t` at which the component changes by itself; of the law, only time, inputs and
    /// states are known. Only when the part says [`Part::time_events`].
    fn next_event(&self, _c: &Law) -> f64 {
        f64::INFINITY
    }

    /// Writes all outputs of one need. `y` holds all outputs of the component, port after port.
    fn measure(&self, _c: &Law, _needs: Needs, _y: &mut [f64]) {}
}

/// Ports, signals, states and elements of a component.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// Conserving ports.
    pub ports: Vec<PhysicalPort>,
    /// Signal inputs.
    pub inputs: Vec<Input>,
    /// Signal outputs and what they need.
    pub outputs: Vec<(Output, Needs)>,
    /// Continuous states.
    pub states: Vec<State>,
    /// Discrete states; [`Component::jump`] changes them.
    pub discrete: Vec<Discrete>,
    /// Names of the guards.
    pub guards: Vec<String>,
    /// Has [`Component::jump`].
    pub jumps: bool,
    /// Has [`Component::next_event`].
    pub time_events: bool,
    /// Has [`Component::linearize`].
    pub linear: bool,
    /// Longest step of the solver while valves wait for a zero of the voltage, s: they must not sleep through one.
    pub max_step: Option<f64>,
    /// Voltages and prescribed currents stay as they are until inputs or discrete states change.
    pub holds: bool,
    /// What the component contributes.
    pub elements: Vec<Element>,
    /// The electrical circuit that the component belongs to is integrated by the network itself, between the edges of
    /// its valves, and coupled to the mechanics in steps of this length, s; see [`Part::separate`].
    pub separate: Option<f64>,
}

impl Part {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a conserving port; they are numbered in this order.
    pub fn port(mut self, name: &str, domain: Domain, doc: &'static str) -> Self {
        self.ports.push(PhysicalPort { name: name.to_owned(), domain, doc, inner: false });
        self
    }

    /// Adds a node inside the component: numbered like the ports, but nothing can be connected to it. Inner nodes come
    /// after the ports.
    pub fn inner(mut self, name: &str, domain: Domain) -> Self {
        self.ports.push(PhysicalPort { name: name.to_owned(), domain, doc: "", inner: true });
        self
    }

    /// Adds the ports `r` (rod) and `c` (case).
    pub fn rod_and_case(self) -> Self {
        self.port("r", Domain::Rotational, "rod").port("c", Domain::Rotational, "case")
    }

    /// Adds the ports `p` and `n`.
    pub fn pins(self) -> Self {
        self.port("p", Domain::Electrical, "positive pin").port("n", Domain::Electrical, "negative pin")
    }

    /// Adds an input.
    pub fn input(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds an output.
    pub fn output(mut self, output: Output, needs: Needs) -> Self {
        self.outputs.push((output, needs));
        self
    }

    /// Adds a scalar output in a unit.
    pub fn measures(self, name: &str, unit: &str, needs: Needs, doc: &'static str) -> Self {
        self.output(Output::real(name).unit(unit).doc(doc), needs)
    }

    /// Adds a state.
    pub fn state(mut self, name: &str, initial: f64) -> Self {
        self.states.push(State { name: name.to_owned(), initial });
        self
    }

    /// Adds a discrete state. The component changes it in [`Component::jump`].
    pub fn discrete(mut self, name: &str, initial: f64) -> Self {
        self.discrete.push(Discrete { name: name.to_owned(), initial });
        self
    }

    /// Steps may not be longer than this, s, where valves conduct by themselves.
    pub fn max_step(mut self, step: f64) -> Self {
        self.max_step = Some(step);
        self
    }

    /// Has [`Component::linearize`]; the component has one branch.
    pub fn linear(mut self) -> Self {
        self.linear = true;
        self
    }

    /// Promises that voltages and prescribed currents stay as they are until inputs or discrete states change.
    pub fn holds(mut self) -> Self {
        self.holds = true;
        self
    }

    /// Lets the network integrate the circuit that this component belongs to by itself: from one instant where a
    /// component of it changes by itself ([`Component::next_event`]) to the next, at the speeds that are expected for
    /// the coupling step; the mechanics gets the mean of the torques. For circuits that switch much faster than the
    /// mechanics moves.
    pub fn separate(mut self, step: f64) -> Self {
        self.separate = Some(step);
        self
    }

    /// Adds a guard.
    pub fn guard(mut self, name: &str) -> Self {
        self.guards.push(name.to_owned());
        self
    }

    /// Has [`Component::jump`].
    pub fn jumps(mut self) -> Self {
        self.jumps = true;
        self
    }

    /// Has [`Component::next_event`].
    pub fn time_events(mut self) -> Self {
        self.time_events = true;
        self
    }

    /// Adds an element.
    pub fn element(mut self, element: Element) -> Self {
        self.elements.push(element);
        self
    }

    /// What the compiler needs to know of the component as a block, before its network is assembled.
    pub fn interface(self) -> Interface {
        let mut interface = Interface::new();
        interface.inputs = self.inputs;
        interface.ports = self.ports;
        interface.ports.retain(|port| !port.inner);
        interface.states = self.states;
        interface.discrete = self.discrete;
        interface.guards = self.guards;
        interface.jumps = self.jumps;
        interface.time_events = self.time_events;
        for (output, needs) in self.outputs {
            interface = match needs {
                Needs::State => interface.output_from_state(output),
                Needs::Electrics | Needs::Motion => interface.output(output),
            };
        }
        interface
    }
}
