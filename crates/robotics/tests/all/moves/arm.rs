//! The arm of the tests: six axes with the lengths of a common industrial robot and a torch.

use blocksim_multibody::Placement;
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use blocksim_robotics::robot::{Drive, Friction, Link, Parts, Robot, TcpLimits};
use std::f64::consts::FRAC_PI_2;

/// The robot, as at home at the start.
pub fn robot() -> Robot {
    let (y, z, x) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let rows = [
        ([0.0, 0.0, 0.445], z, -180.0, 180.0, 175.0, 8.0),
        ([0.15, 0.0, 0.0], y, -95.0, 155.0, 175.0, 6.0),
        ([0.0, 0.0, 0.9], y, -180.0, 75.0, 175.0, 10.0),
        ([0.0, 0.0, 0.115], x, -400.0, 400.0, 360.0, 25.0),
        ([0.795, 0.0, 0.0], y, -120.0, 120.0, 360.0, 25.0),
        ([0.085, 0.0, 0.0], x, -400.0, 400.0, 500.0, 35.0),
    ];
    let links = rows.iter().map(|row| {
        let (origin, axis, lower, upper, speed, acceleration) = *row;
        let limits = AxisLimits {
            kind: AxisKind::Turning,
            lower: f64::to_radians(lower),
            upper: f64::to_radians(upper),
            speed: f64::to_radians(speed),
            acceleration,
        };
        let friction = Friction { breakaway: 0.0, breakaway_velocity: 0.0, coulomb: 0.0, viscous: 0.0 };
        let drive = Drive {
            inertia: 0.0,
            damping: 0.0,
            friction,
            efficiency_forward: 1.0,
            efficiency_backward: 1.0,
            threshold: 1.0,
            limit: f64::INFINITY,
        };
        let origin = Placement::from_translation(origin);
        Link { name: String::new(), origin, axis, limits, start: 0.0, solids: Vec::new(), drive }
    });
    let parts = Parts {
        name: "arm".into(),
        gravity: [0.0, 0.0, -9.81],
        base: Placement::from_rpy([0.3, -0.2, 0.1], [0.0, 0.0, 0.4]),
        reference: Placement::identity(),
        links: links.collect(),
        flange: Placement::from_rpy([0.0; 3], [0.0, FRAC_PI_2, 0.0]),
        tool: Placement::from_rpy([0.1195, 0.0, 0.352], [0.0, 0.945973, 0.0]),
        tcp_limits: TcpLimits { speed: 2.5, acceleration: 8.0 },
    };
    Robot::new(parts).expect("a robot")
}

/// Where the tool is at `q`, in the reference.
pub fn tool(robot: &Robot, q: &[f64]) -> Placement {
    robot.tcp(&mut robot.model().data(), q)
}
