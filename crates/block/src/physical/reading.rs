//! Outputs of components that are numbers of the network, and voltages and currents that they give as they find them.

use super::{Handle, Law, Needs};

/// A number that the network has for a component, for outputs that are just that: see [`Part::reads`](super::Part::reads). Lists are
/// numbered as in [`Law`].
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

    /// The number, in SI units; not a number where there is no such element.
    ///
    /// # Panics
    /// Panics if the component has no such state, speed, gear or joint.
    #[inline]
    pub fn of(self, law: &Law) -> f64 {
        match self {
            Self::State(i) => law.x[i],
            Self::Speed(i) => law.speed[i],
            Self::Acceleration(i) => law.acceleration[i],
            Self::Torque(i) => law.torque[i],
            Self::Mesh(i) => law.mesh[i],
            Self::Voltage(handle) => law.voltage(handle),
            Self::Current(handle) => law.current(handle),
            Self::JointPosition(i) => law.joint[i].q,
            Self::JointSpeed(i) => law.joint[i].w,
            Self::JointAcceleration(i) => law.joint[i].a,
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
    pub fn of(self, law: &Law) -> f64 {
        match self {
            Self::State(i) => law.x[i],
            Self::Input(port) => law.scalar(port),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::{ElementPlace, JointMotion, Part};

    const BODY: Handle = Handle::new("body");

    #[test]
    fn each_reading_is_the_number_of_its_name_and_declares_what_it_needs() {
        let places = [ElementPlace { handle: BODY, two_pin: 1, characteristic: None }];
        let law = Law {
            x: &[1.0, 2.0],
            speed: &[3.0],
            acceleration: &[4.0],
            torque: &[5.0],
            mesh: &[6.0],
            voltage: &[0.0, 7.0],
            current: &[0.0, 8.0],
            places: &places,
            joint: &[JointMotion { q: 9.0, w: 10.0, a: 11.0, drive: 0.0 }],
            ..Law::nothing()
        };
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
            assert_eq!((reading.of(&law), reading.needs()), (value, needs), "{reading:?}");
            let part = Part::new().measures("other", "1", Needs::Motion, "").reads("y", "1", reading, "");
            assert_eq!(part.readings, [None, Some(reading)]);
            assert_eq!(part.outputs[1].1, needs);
        }
        assert!(Reading::Voltage(Handle::new("nothing")).of(&law).is_nan());
    }
}
