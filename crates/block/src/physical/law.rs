//! What a component sees when a network asks for its law.

use super::{ElementPlace, Handle, Supply};

use super::characteristic::find;

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
    /// Derivative of `angular`, rad/s^2; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub angular_acceleration: [f64; 3],
    /// Derivative of `velocity`, m/s^2; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub acceleration: [f64; 3],
}

/// Motion of one speed of a joint: rad, rad/s, N*m, or m, m/s, N of a slide.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMotion {
    /// Position; zero of a ball, see [`Law::orientation`].
    pub q: f64,
    /// Speed.
    pub w: f64,
    /// Acceleration; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub a: f64,
    /// Torque of the drive side on the joint; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub drive: f64,
}

/// What a component sees. Lists are numbered by the elements of one kind in the order of [`Part::elements`](super::Part::elements):
/// `speed`, `acceleration` and `torque` count branches, frictions, rigid couplings, speed sources and speed probes
/// together;
/// `voltage` and `current` count all two-pins (sources, capacitances, windings, resistances, characteristics, valves, heats, both probes)
/// together; a transformer, ideal or variable, counts as two, primary and secondary. Elements that have a name are found by it:
/// [`voltage`](Self::voltage()), [`current`](Self::current()).
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
    /// Their derivatives, rad/s^2; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub acceleration: &'a [f64],
    /// Torques from `r` to `c`, N*m; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub torque: &'a [f64],
    /// Torque into the base of each gear of the component, N*m; in `measure` with [`Needs::Motion`](super::Needs::Motion) only.
    pub mesh: &'a [f64],
    /// Mode of each dry friction, or of each mesh with stiction if there is no friction: 1 slides forward, -1 slides
    /// backward, 0 is stuck.
    pub mode: &'a [f64],
    /// Voltages, V; not in `voltages`.
    pub voltage: &'a [f64],
    /// Currents, A; not in `voltages` and `currents`.
    pub current: &'a [f64],
    /// Where the named elements of the part lie.
    pub places: &'a [ElementPlace],
    /// The three-phase supply that the component is connected to (or is).
    pub supply: &'a Supply,
    /// Current drawn from the supply as a space vector in its frame and zero sequence, A; for the supply in `measure`.
    pub line_current: &'a [f64; 3],
    /// Motion of the component's joint, speed by speed in the order of its freedoms.
    pub joint: &'a [JointMotion],
    /// Orientation of `follower` in `base` of a joint with a ball: unit quaternion (w, x, y, z).
    pub orientation: &'a [f64; 4],
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
            places: &[],
            supply: &Supply::NONE,
            line_current: &[0.0; 3],
            joint: &[],
            orientation: &[1.0, 0.0, 0.0, 0.0],
            frames: &[],
        }
    }

    /// Voltage of a named element, V; the across quantity in other domains. Not a number if the part has no such element.
    #[inline]
    pub fn voltage(&self, handle: Handle) -> f64 {
        find(self.places, handle).map_or(f64::NAN, |place| self.voltage[place.two_pin])
    }

    /// Current of a named element, A; the through quantity in other domains. Not a number if the part has no such element.
    #[inline]
    pub fn current(&self, handle: Handle) -> f64 {
        find(self.places, handle).map_or(f64::NAN, |place| self.current[place.two_pin])
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
