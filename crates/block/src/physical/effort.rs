//! What mechanical laws give: torques, forces, dry friction.

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
    /// What happens where something that holds without bound is struck; plastic unless given.
    pub stop: Option<Stop>,
}

/// A rigid end of travel: nothing is held before it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stop {
    /// Part of the speed that is left after a bounce, 0 to 1.
    pub restitution: f64,
    /// How far it is beyond its end, rad or m, as far as its position says: hardly anything where ends are located, a part of a step
    /// where they are not. What would rise no further than that does not bounce.
    pub depth: f64,
}

impl Grip {
    /// The same in both directions: what it holds, and its torque over the amount of the speed.
    pub fn symmetric(hold: f64, speed: f64, slide: impl Fn(f64) -> Torque) -> Self {
        Self { hold: [hold; 2], slide: [slide(speed), slide(-speed)], stop: None }
    }
}

/// Force and torque on a body at the origin of a frame, in the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force, N.
    pub force: [f64; 3],
    /// Torque about the origin of the frame, N*m.
    pub torque: [f64; 3],
}
