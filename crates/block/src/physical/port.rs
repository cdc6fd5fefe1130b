//! What the parts of a network are connected by: ports, and the pins of electrical elements.

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
    /// Temperature (K) and heat flow (W).
    Thermal,
    /// Magnetic potential difference (A) and flux (Wb).
    Magnetic,
    /// Pressure (Pa) and volume flow (m^3/s).
    Hydraulic,
    /// A frame of a rigid body: pose and wrench.
    Frame,
}

impl Domain {
    /// Whether the product of its across and its through quantity is power. It is not for heat, whose flow is power already, and for
    /// flux, whose derivative times the potential difference is.
    pub fn carries_power(self) -> bool {
        !matches!(self, Domain::Thermal | Domain::Magnetic)
    }
}

impl std::fmt::Display for Domain {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Domain::Rotational => "rotational",
            Domain::Translational => "translational",
            Domain::Electrical => "electrical",
            Domain::ThreePhase => "three-phase",
            Domain::Thermal => "thermal",
            Domain::Magnetic => "magnetic",
            Domain::Hydraulic => "hydraulic",
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
    /// A node inside of a component; see [`Part::inner`](super::Part::inner).
    pub inner: bool,
    /// An electrical port that may stay unconnected; see [`Part::open`](super::Part::open).
    pub open: bool,
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
