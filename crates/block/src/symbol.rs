/// What a kind of block looks like in a drawing: the sign of its field. `#[block(symbol = Gain)]` beside the category
/// says it; a kind that says nothing is a box with its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A box with the name of the kind.
    Plain,
    /// A box with a short text: `|u|`, `PID`.
    Text(&'static str),
    /// A box with a fraction: `Fraction("1", "s")`.
    Fraction(&'static str, &'static str),
    /// A box with two lines of text: a pair of equations.
    Lines(&'static str, &'static str),
    /// The fraction of the polynomials `num` and `den` in the given letter.
    Polynomials(&'static str),
    /// The value of a parameter, such as that of a constant.
    Value(&'static str),
    /// A triangle with the value of a parameter.
    Gain(&'static str),
    /// A circle with the signs of the parameter `signs`.
    Sum,
    /// A box with a curve.
    Curve(Curve),
    /// A screen.
    Scope,
    /// A cross-section of lines that come together or part.
    Bar,
    /// Two contacts and a lever.
    Switch,
    /// The end of a line.
    Terminator,
    /// The source of the block is a library of the user.
    Plugin,
    /// A resistor.
    Resistor,
    /// A resistor whose resistance depends on its voltage.
    Varistor,
    /// A capacitor.
    Capacitor,
    /// An inductor.
    Inductor,
    /// Coupled windings.
    Transformer,
    /// A circle with `+` and `-`.
    VoltageSource,
    /// A circle with an arrow.
    CurrentSource,
    /// A circle with a wave.
    AcSource,
    /// A circle with a letter: a meter.
    Meter(&'static str),
    /// A circle with a letter and a shaft: a machine.
    Machine(&'static str),
    /// A diode.
    Diode,
    /// A thyristor.
    Thyristor,
    /// A transistor.
    Transistor,
    /// Two contacts in a line.
    Contact,
    /// A box with a diagonal between two kinds of current: `Converter("~", "=")`.
    Converter(&'static str, &'static str),
    /// Potential zero.
    Ground,
    /// What stands still mechanically.
    Housing,
    /// A disc on a shaft.
    Inertia,
    /// A block of mass.
    Mass,
    /// A spring.
    Spring,
    /// A dashpot.
    Damper,
    /// A spring beside a dashpot.
    SpringDamper,
    /// Two surfaces that rub.
    Friction,
    /// Two stops.
    HardStop,
    /// Two wheels that mesh.
    Gear,
    /// Two wheels that mesh, and a spring behind them.
    ElasticGear,
    /// Planets between a sun and a ring.
    Planetary,
    /// A wheel with an eccentric disc or an oval one inside.
    WaveGear,
    /// A worm and its wheel.
    Worm,
    /// Bevel wheels in a cage.
    Differential,
    /// A screw with its nut.
    Screw,
    /// A wheel on a rack.
    Rack,
    /// Two plates.
    Clutch,
    /// A plate that is pressed against what stands still.
    Brake,
    /// A shaft that another may overrun.
    Freewheel,
    /// A curved arrow.
    Torque,
    /// A straight arrow.
    Force,
    /// A source of motion: a circle with the letter of what it prescribes.
    MotionSource(&'static str),
    /// A sensor of motion or effort, with a letter.
    Sensor(&'static str),
    /// A hinge.
    Hinge,
    /// A slide.
    Slide,
    /// A slide that may turn as well.
    Cylinder,
    /// A plate that slides and turns on another.
    Planar,
    /// Two forks on a cross.
    Universal,
    /// A ball in its cup.
    Ball,
    /// A point above a plane.
    Touch,
    /// The star point of three phases.
    Star,
    /// Three lines that become one.
    Phases,
    /// A robot arm, with a formula of what is computed about it; empty for the robot itself.
    Arm(&'static str),
    /// A line between two arcs: an opening that fluid flows through.
    Restriction,
    /// The same with an arrow across.
    VariableRestriction,
    /// A ball in its seat.
    CheckValve,
    /// A box with an arrow that a spring holds.
    ReliefValve,
    /// Three boxes with arrows between two lines each: a spool.
    SpoolValve,
    /// Two lines beside each other.
    Pipe,
    /// An open vessel.
    Tank,
    /// A circle with a triangle and a shaft.
    Pump,
    /// A vessel with gas above fluid.
    Accumulator,
    /// A piston with its rod.
    HydraulicCylinder,
    /// Two parts as one.
    Weld,
    /// A rigid body with its centre of mass.
    Body,
    /// One frame moved to another.
    Frame,
    /// The fixed frame.
    World,
}

/// What a curve in a box looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// A step over time.
    Step,
    /// A ramp over time.
    Ramp,
    /// A sine over time.
    Sine,
    /// Pulses over time.
    Pulse,
    /// A profile of a move over time.
    Move,
    /// A measured course.
    Record,
    /// Output over input, limited.
    Saturation,
    /// Output over input, with a dead zone.
    DeadZone,
    /// Output over input, with hysteresis.
    Relay,
    /// Output over input, in steps.
    Quantizer,
    /// Output over input, with play.
    Backlash,
    /// The slope is limited.
    RateLimit,
    /// The sign.
    Sign,
    /// A table.
    Table,
    /// Held samples.
    Hold,
    /// A carrier and its pulses.
    Modulation,
}
