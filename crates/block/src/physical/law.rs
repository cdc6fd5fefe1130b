//! What a component sees when a network asks for its law.
//!
//! An evaluation goes from states to speeds, from these to voltages and currents, and from these to torques and accelerations. Each
//! function of a [`Component`](super::Component) is asked at one of these stages, and is shown what is known there and nothing else:
//! [`Known`], then [`Moving`], [`Fed`], [`Flowing`] and [`Loaded`], each of which also has all of the one before.

use std::ops::{Deref, DerefMut};

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
}

/// Derivatives of the velocities of a frame in the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameAcceleration {
    /// Angular acceleration, rad/s^2.
    pub angular: [f64; 3],
    /// Acceleration of the origin, m/s^2.
    pub linear: [f64; 3],
}

/// Motion of one speed of a joint: rad and rad/s, or m and m/s of a slide.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMotion {
    /// Position; zero of a ball, see [`Moving::orientation`].
    pub q: f64,
    /// Speed.
    pub w: f64,
}

/// What moves one speed of a joint: rad/s^2 and N*m, or m/s^2 and N of a slide.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointLoad {
    /// Acceleration.
    pub a: f64,
    /// Torque of the drive side on the joint.
    pub drive: f64,
}

/// What a component sees from the beginning: time, its states and its inputs.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
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
}

/// What a component sees when speeds are known. Lists are numbered by the elements of one kind in the order of
/// [`Part::elements`](super::Part::elements): `speed` counts branches, frictions, rigid couplings, speed sources and speed probes
/// together.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// What was known before.
    pub known: Known<'a>,
    /// Speeds `w_r - w_c`, rad/s.
    pub speed: &'a [f64],
    /// Mode of each dry friction, or of each mesh with stiction if there is no friction: 1 slides forward, -1 slides
    /// backward, 0 is stuck.
    pub mode: &'a [f64],
    /// Motion of the component's joint, speed by speed in the order of its freedoms.
    pub joint: &'a [JointMotion],
    /// Orientation of `follower` in `base` of a joint with a ball: unit quaternion (w, x, y, z).
    pub orientation: &'a [f64; 4],
    /// Motion of the frames that the component looks at: probes and forces in the order of the elements.
    pub frames: &'a [FrameMotion],
}

/// What a component sees when the supplies are known, in whose frames machines count.
#[derive(Debug, Clone, Copy)]
pub struct Fed<'a> {
    /// What was known before.
    pub moving: Moving<'a>,
    /// The three-phase supply that the component is connected to (or is). In circuits where the voltages of machines follow from those
    /// of the nodes, its angle and frequency; its voltage is that of the last evaluation before [`Flowing`].
    pub supply: &'a Supply,
}

/// What a component sees when voltages and currents are known. These count all two-pins (sources, capacitances, windings,
/// resistances, characteristics, valves, heats, both probes) together in the order of the elements; a transformer, ideal or variable,
/// counts as two, primary and secondary. Elements that have a name are found by it: [`voltage`](Self::voltage()),
/// [`current`](Self::current()).
#[derive(Debug, Clone, Copy)]
pub struct Flowing<'a> {
    /// What was known before.
    pub fed: Fed<'a>,
    /// Voltages, V.
    pub voltage: &'a [f64],
    /// Currents, A.
    pub current: &'a [f64],
    /// Where the named elements of the part lie.
    pub places: &'a [ElementPlace],
    /// Current drawn from the supply as a space vector in its frame and zero sequence, A; for the supply itself.
    pub line_current: &'a [f64; 3],
}

/// What a component sees in the end. `acceleration` and `torque` are numbered as [`Moving::speed`], `joint_load` as [`Moving::joint`],
/// `frame_acceleration` as [`Moving::frames`].
#[derive(Debug, Clone, Copy)]
pub struct Loaded<'a> {
    /// What was known before.
    pub flowing: Flowing<'a>,
    /// Derivatives of the speeds, rad/s^2.
    pub acceleration: &'a [f64],
    /// Torques from `r` to `c`, N*m.
    pub torque: &'a [f64],
    /// Torque into the base of each gear of the component, N*m.
    pub mesh: &'a [f64],
    /// What moves the joint of the component.
    pub joint_load: &'a [JointLoad],
    /// Accelerations of the frames that the component looks at.
    pub frame_acceleration: &'a [FrameAcceleration],
}

impl<'a> Known<'a> {
    /// Time zero, nothing connected.
    pub const NOTHING: Known<'static> = Known { t: 0.0, x: &[], d: &[], u: &[], inputs: &[] };

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

impl Moving<'_> {
    /// Everything at rest, nothing connected.
    pub const NOTHING: Moving<'static> = Moving {
        known: Known::NOTHING,
        speed: &[],
        mode: &[],
        joint: &[],
        orientation: &[1.0, 0.0, 0.0, 0.0],
        frames: &[],
    };
}

impl Fed<'_> {
    /// No supply, nothing connected.
    pub const NOTHING: Fed<'static> = Fed { moving: Moving::NOTHING, supply: &Supply::NONE };
}

impl Flowing<'_> {
    /// No current flows, nothing connected.
    pub const NOTHING: Flowing<'static> =
        Flowing { fed: Fed::NOTHING, voltage: &[], current: &[], places: &[], line_current: &[0.0; 3] };

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
}

impl Loaded<'_> {
    /// Nothing acts, nothing connected.
    pub const NOTHING: Loaded<'static> = Loaded {
        flowing: Flowing::NOTHING,
        acceleration: &[],
        torque: &[],
        mesh: &[],
        joint_load: &[],
        frame_acceleration: &[],
    };
}

/// Lets a stage be used where the one before is enough.
macro_rules! has_all_of {
    ($stage:ident, $field:ident: $before:ident) => {
        impl<'a> Deref for $stage<'a> {
            type Target = $before<'a>;

            #[inline(always)]
            fn deref(&self) -> &$before<'a> {
                &self.$field
            }
        }

        impl DerefMut for $stage<'_> {
            #[inline(always)]
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.$field
            }
        }
    };
}

has_all_of!(Moving, known: Known);
has_all_of!(Fed, moving: Moving);
has_all_of!(Flowing, fed: Fed);
has_all_of!(Loaded, flowing: Flowing);
