//! Rotation and translation: the same parts under different names and units.

use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Name, unit and meaning of a signal.
type Signal = (&'static str, &'static str, &'static str);

/// What a kind of motion calls its quantities.
#[derive(Debug)]
pub(crate) struct Quantities {
    pub domain: Domain,
    pub position: Signal,
    pub speed: Signal,
    pub acceleration: Signal,
    /// Derivative of the speed, as an input.
    pub rate: Signal,
    /// Torque or force that passes from `r` to `c`.
    pub load: Signal,
    /// Torque or force of a source on `r`.
    pub drive: Signal,
}

pub(crate) const ROTATION: Quantities = Quantities {
    domain: Domain::Rotational,
    position: ("phi", "rad", "angle of r against c"),
    speed: ("w", "rad/s", "speed of r against c"),
    acceleration: ("a", "rad/s^2", "acceleration of r against c"),
    rate: ("dw", "rad/s^2", "derivative of w"),
    load: ("tau", "N*m", "torque from r to c"),
    drive: ("tau", "N*m", "torque on r"),
};

pub(crate) const TRANSLATION: Quantities = Quantities {
    domain: Domain::Translational,
    position: ("x", "m", "position of r against c"),
    speed: ("v", "m/s", "velocity of r against c"),
    acceleration: ("a", "m/s^2", "acceleration of r against c"),
    rate: ("dv", "m/s^2", "derivative of v"),
    load: ("f", "N", "force from r to c"),
    drive: ("f", "N", "force on r"),
};

fn input((name, unit, doc): Signal) -> Input {
    Input::real(name).scalar().unit(unit).doc(doc)
}

fn output((name, unit, doc): Signal) -> Output {
    Output::real(name).unit(unit).doc(doc)
}

impl Quantities {
    /// The ports `r` and `c` and one element between them.
    pub(crate) fn between(&self, element: Element) -> Part {
        Part::new().port("r", self.domain, "rod").port("c", self.domain, "case").element(element)
    }

    /// A torque or force between `r` and `c`.
    pub(crate) fn branch(&self) -> Part {
        self.between(Element::Branch { r: 0, c: 1 })
    }

    /// The same with outputs: speed and load.
    pub(crate) fn damped(&self) -> Part {
        self.branch()
            .output_read(output(self.speed), Reading::Speed(0))
            .output_read(output(self.load), Reading::Torque(0))
    }

    /// The same with the deflection as a state, and outputs: deflection and load.
    pub(crate) fn elastic(&self, start: f64) -> Part {
        self.held(Element::Branch { r: 0, c: 1 }, start)
    }

    /// An element with the deflection as a state, and the same outputs.
    pub(crate) fn held(&self, element: Element, start: f64) -> Part {
        self.between(element)
            .state(self.position.0, start)
            .output_read(output(self.position), Reading::State(0))
            .output_read(output(self.load), Reading::Torque(0))
    }

    /// A source of torque or force with an input.
    pub(crate) fn effort_source(&self) -> Part {
        self.branch().input(input(self.drive))
    }

    /// A source of speed: inputs for speed and derivative, the drive as output.
    pub(crate) fn speed_source(&self) -> Part {
        self.between(Element::SpeedSource { r: 0, c: 1 })
            .input(input(self.speed))
            .input(input(self.rate).rate_of(0))
            .output(output(self.drive), Needs::Motion)
    }

    /// A rigid coupling that measures what passes through it.
    pub(crate) fn load_sensor(&self) -> Part {
        self.between(Element::Rigid { r: 0, c: 1 }).output_read(output(self.load), Reading::Torque(0))
    }

    /// Position, speed and acceleration; the position is a state.
    pub(crate) fn motion_sensor(&self, start: f64) -> Part {
        self.between(Element::SpeedProbe { r: 0, c: 1 })
            .output_read(output(self.position), Reading::State(0))
            .output_read(output(self.speed), Reading::Speed(0))
            .output_read(output(self.acceleration), Reading::Acceleration(0))
            .drifting_state(self.position.0, start)
    }

    /// A part with inertia or mass, and outputs: speed and acceleration.
    pub(crate) fn inertia(&self, doc: &'static str, inertia: f64, speed: Option<f64>) -> Part {
        Part::new()
            .port("r", self.domain, doc)
            .element(Element::Inertia { port: 0, inertia, speed })
            .element(Element::AbsoluteSpeedProbe { port: 0 })
            .reads(self.speed.0, self.speed.1, Reading::Speed(0), "speed")
            .reads(self.acceleration.0, self.acceleration.1, Reading::Acceleration(0), "acceleration")
    }

    /// A part that stands still.
    pub(crate) fn reference(&self) -> Part {
        Part::new()
            .port("r", self.domain, "the part that stands still")
            .element(Element::MechanicalReference { port: 0 })
    }
}

/// A torque or force that damps not at all.
pub(crate) fn undamped(value: f64) -> Torque {
    Torque { value, slope: 0.0 }
}
