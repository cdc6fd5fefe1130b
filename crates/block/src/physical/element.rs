//! What a component contributes to a network.

use super::{Freedom, MeshLoss, Pin};

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

impl Element {
    /// How many voltages and currents it has in a law; none of a machine that a source feeds directly.
    pub fn two_pins(&self) -> usize {
        match self {
            Element::VoltageSource { .. }
            | Element::Winding { .. }
            | Element::CurrentSource { .. }
            | Element::Capacitance { .. }
            | Element::Resistance { .. }
            | Element::Characteristic { .. }
            | Element::Valve { .. }
            | Element::Heat { .. }
            | Element::VoltageProbe { .. }
            | Element::CurrentProbe { .. } => 1,
            Element::IdealTransformer { .. } | Element::VariableTransformer { .. } => 2,
            _ => 0,
        }
    }

    /// Where it ends, if it is electrical, or of a domain with the same assembly.
    pub fn pins(&self) -> Vec<Pin> {
        match *self {
            Element::VoltageSource { p, n }
            | Element::Winding { p, n, .. }
            | Element::CurrentSource { p, n }
            | Element::Capacitance { p, n, .. }
            | Element::Resistance { p, n, .. }
            | Element::Characteristic { p, n, .. }
            | Element::Valve { p, n, .. }
            | Element::Junction { p, n }
            | Element::VoltageProbe { p, n }
            | Element::CurrentProbe { p, n } => vec![p, n],
            Element::IdealTransformer { primary, secondary, .. }
            | Element::VariableTransformer { primary, secondary } => {
                vec![primary.0, primary.1, secondary.0, secondary.1]
            }
            Element::Supply { n, .. } => vec![n],
            Element::Heat { port } => vec![Pin::Port(port), Pin::Ground],
            _ => Vec::new(),
        }
    }
}

/// What a component contributes to a network. Ports are numbered as in [`Part::ports`](super::Part::ports).
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// Moment of inertia or mass at a mechanical port, against an implied ground.
    Inertia {
        /// Mechanical port.
        port: usize,
        /// Moment of inertia, kg*m^2; mass, kg.
        inertia: f64,
        /// Speed at the start, rad/s or m/s; without one, what it is coupled to tells, else it is zero.
        speed: Option<f64>,
    },
    /// A torque between two mechanical ports of one domain that [`Component::torques`](super::Component::torques) gives.
    Branch {
        /// Rod.
        r: usize,
        /// Case.
        c: usize,
    },
    /// Dry friction between two mechanical ports of one domain, that sticks: [`Component::grips`](super::Component::grips) gives what it can hold and its
    /// torque while it slides; the network chooses between forward, backward and stuck ([`Moving::mode`](super::Moving::mode)).
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
    /// A speed between two mechanical ports of one domain that [`Component::speeds`](super::Component::speeds) prescribes.
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
    /// Only looks at the speed of a mechanical port, against an implied ground.
    AbsoluteSpeedProbe {
        /// Mechanical port.
        port: usize,
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
    /// A voltage that [`Component::voltages`](super::Component::voltages) gives.
    VoltageSource {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
    },
    /// A current that [`Component::currents`](super::Component::currents) gives.
    Winding {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
        /// The current follows from states alone (there is inductance), not from the voltage at the same instant.
        from_state: bool,
    },
    /// A current that [`Component::currents`](super::Component::currents) gives from its inputs, whatever the voltage.
    CurrentSource {
        /// Pin that the current enters by.
        p: Pin,
        /// Pin that it leaves by.
        n: Pin,
    },
    /// A voltage that is a state: [`Component::voltages`](super::Component::voltages) gives it, the current changes it.
    ///
    /// In a loop of ideal voltages the state is not the voltage itself; the network then passes the voltage to the component
    /// in the place of its state, see `network/electrics/loops.rs`.
    Capacitance {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
        /// Capacitance, F; positive.
        capacitance: f64,
        /// Which of the states of the component its voltage is.
        state: usize,
        /// Voltage at the start, V; without one, what it is connected to tells, else it is zero.
        start: Option<f64>,
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
    /// A current that [`Component::characteristics`](super::Component::characteristics) gives as a function of voltages at the same
    /// instant, with its exact slopes: its own voltage and those of the other characteristics of the part, states and inputs. Give it a
    /// name with [`Part::named`](super::Part::named).
    Characteristic {
        /// Positive pin.
        p: Pin,
        /// Negative pin.
        n: Pin,
        /// A slope of its current over its voltage as it occurs in use, S: the circuit is solved around it. Only how rounding spreads
        /// depends on it. Zero where the current does not follow from its own voltage, as a flow of heat.
        conductance: f64,
        /// Voltage where the first search for an operating point begins, V; later ones begin at the last major step.
        guess: f64,
    },
    /// A thermal port that heat of the component leaves by: what becomes of the power that its laws dissipate. With one such port that
    /// is all of it; [`Component::heats`](super::Component::heats) divides it among several. As a two-pin its voltage is the
    /// temperature there, K, and its current the heat flow, W, negative. Heat follows from torques and so is known after everything
    /// else: the temperature must be a state, that of a heat capacity at the same node.
    Heat {
        /// Thermal port.
        port: usize,
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
    /// As [`IdealTransformer`](Self::IdealTransformer), with a ratio that [`Component::ratios`](super::Component::ratios)
    /// gives at every instant; any number, also zero.
    VariableTransformer {
        /// Positive and negative pin.
        primary: (Pin, Pin),
        /// Positive and negative pin.
        secondary: (Pin, Pin),
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
    /// A symmetric three-phase source that [`Component::supply`](super::Component::supply) gives.
    Supply {
        /// Three-phase port.
        ac: usize,
        /// Star point.
        n: Pin,
    },
    /// A three-phase winding that is symmetric and has inductance; it sees [`Fed::supply`](super::Fed::supply) and gives
    /// [`Component::line_current`](super::Component::line_current).
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
    /// Looks at the motion of a frame: [`Moving::frames`](super::Moving::frames).
    FrameProbe {
        /// Frame port.
        frame: usize,
    },
    /// Looks at the motion of a frame and acts on it with the wrench that [`Component::wrenches`](super::Component::wrenches) gives.
    FrameForce {
        /// Frame port.
        frame: usize,
    },
    /// A rigid body fixed to a frame with the share, 0 or 1, that [`Component::load`](super::Component::load) gives: what a gripper holds.
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
    /// An account of the energy of the whole network, wherever it is connected; its port joins nothing. The component
    /// has two states, the supplied and the dissipated energy, J, and the outputs stored energy, J, supplied and
    /// dissipated power, W, supplied and dissipated energy, J, error of the balance, J, the largest energy turned over so
    /// far, J, and the error over it; all of [`Needs::Motion`](super::Needs::Motion). The network fills them.
    EnergyAccount {
        /// Relative error at which the simulation ends; `None` never ends it.
        tolerance: Option<f64>,
        /// Energy that counts as turned over at least, J.
        floor: f64,
    },
}
