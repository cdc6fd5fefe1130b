//! Outputs of components that are numbers of the network, and voltages and currents that they give as they find them.

use super::{Flowing, Handle, Known, Loaded, Moving, Needs};

/// A number that the network has for a component, for outputs that are just that: see [`Part::reads`](super::Part::reads). Lists are
/// numbered as in [`Moving`], [`Flowing`] and [`Loaded`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reading {
    /// A state of the component.
    State(usize),
    /// A speed, rad/s or m/s.
    Speed(usize),
    /// Its derivative, rad/s^2 or m/s^2.
    Acceleration(usize),
    /// A torque from `r` to `c`, N*m, or a force, N.
    Torque(usize),
    /// The torque into the base of a gear, N*m.
    Mesh(usize),
    /// The voltage of a named element, V; the across quantity in other domains.
    Voltage(Handle),
    /// The current of a named element, A; the through quantity in other domains.
    Current(Handle),
    /// The position of the joint, rad or m.
    JointPosition(usize),
    /// Its speed, rad/s or m/s.
    JointSpeed(usize),
    /// Its acceleration, rad/s^2 or m/s^2.
    JointAcceleration(usize),
}

impl Reading {
    /// What must be known before.
    pub fn needs(self) -> Needs {
        match self {
            Self::State(_) | Self::Speed(_) | Self::JointPosition(_) | Self::JointSpeed(_) => Needs::State,
            Self::Voltage(_) | Self::Current(_) => Needs::Electrics,
            Self::Acceleration(_) | Self::Torque(_) | Self::Mesh(_) | Self::JointAcceleration(_) => {
                Needs::Motion
            }
        }
    }

    /// The number, in SI units; not a number if it [needs](Self::needs) more.
    ///
    /// # Panics
    /// Panics if the component has no such state, speed or joint.
    #[inline]
    pub fn of_state(self, c: &Moving) -> f64 {
        match self {
            Self::State(i) => c.x[i],
            Self::Speed(i) => c.speed[i],
            Self::JointPosition(i) => c.joint[i].q,
            Self::JointSpeed(i) => c.joint[i].w,
            _ => f64::NAN,
        }
    }

    /// The number, in SI units; not a number if it [needs](Self::needs) more, or where there is no such element.
    ///
    /// # Panics
    /// Panics if the component has no such state, speed or joint.
    #[inline]
    pub fn of_electrics(self, c: &Flowing) -> f64 {
        match self {
            Self::Voltage(handle) => c.voltage(handle),
            Self::Current(handle) => c.current(handle),
            _ => self.of_state(c),
        }
    }

    /// The number, in SI units; not a number where there is no such element.
    ///
    /// # Panics
    /// Panics if the component has no such state, speed, gear or joint.
    #[inline]
    pub fn of_motion(self, c: &Loaded) -> f64 {
        match self {
            Self::Acceleration(i) => c.acceleration[i],
            Self::Torque(i) => c.torque[i],
            Self::Mesh(i) => c.mesh[i],
            Self::JointAcceleration(i) => c.joint_load[i].a,
            _ => self.of_electrics(c),
        }
    }
}

/// A voltage or a current that a component gives as it finds it: see [`Part::voltage_is`](super::Part::voltage_is).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gives {
    /// A state of the component.
    State(usize),
    /// A scalar input.
    Input(usize),
}

impl Gives {
    /// The number, in SI units.
    ///
    /// # Panics
    /// Panics if the component has no such state or input.
    #[inline]
    pub fn of(self, c: &Known) -> f64 {
        match self {
            Self::State(i) => c.x[i],
            Self::Input(port) => c.scalar(port),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::{ElementPlace, JointLoad, JointMotion, Part};

    const BODY: Handle = Handle::new("body");

    #[test]
    fn each_reading_is_the_number_of_its_name_and_declares_what_it_needs() {
        let places = [ElementPlace { handle: BODY, two_pin: 1, characteristic: None }];
        let mut c = Loaded::NOTHING;
        (c.x, c.speed, c.joint) = (&[1.0, 2.0], &[3.0], &[JointMotion { q: 9.0, w: 10.0 }]);
        (c.voltage, c.current, c.places) = (&[0.0, 7.0], &[0.0, 8.0], &places);
        (c.acceleration, c.torque, c.mesh) = (&[4.0], &[5.0], &[6.0]);
        c.joint_load = &[JointLoad { a: 11.0, drive: 0.0 }];
        let all = [
            (Reading::State(1), 2.0, Needs::State),
            (Reading::Speed(0), 3.0, Needs::State),
            (Reading::Acceleration(0), 4.0, Needs::Motion),
            (Reading::Torque(0), 5.0, Needs::Motion),
            (Reading::Mesh(0), 6.0, Needs::Motion),
            (Reading::Voltage(BODY), 7.0, Needs::Electrics),
            (Reading::Current(BODY), 8.0, Needs::Electrics),
            (Reading::JointPosition(0), 9.0, Needs::State),
            (Reading::JointSpeed(0), 10.0, Needs::State),
            (Reading::JointAcceleration(0), 11.0, Needs::Motion),
        ];
        for (reading, value, needs) in all {
            assert_eq!((reading.of_motion(&c), reading.needs()), (value, needs), "{reading:?}");
            assert_eq!(reading.of_state(&c) == value, needs == Needs::State, "{reading:?}");
            assert_eq!(reading.of_electrics(&c) == value, needs != Needs::Motion, "{reading:?}");
            let part = Part::new().measures("other", "1", Needs::Motion, "").reads("y", "1", reading, "");
            assert_eq!(part.readings, [None, Some(reading)]);
            assert_eq!(part.outputs[1].1, needs);
        }
        assert!(Reading::Voltage(Handle::new("nothing")).of_motion(&c).is_nan());
    }
}
