//! Tests of the block.

use super::*;
use blocksim_block::in_unit::AxisValue;
use blocksim_block::testing::Bench;

use crate::motion::Limits;
use crate::robotics::{DriveData, JointLink, Seat, TcpData};

/// Seats and axes of a chain, without bodies; every axis within `range` to both sides.
fn arm(seats: &[([f64; 3], [f64; 3])], range: f64) -> RobotDescription {
    let link = |(seat, axis): &([f64; 3], [f64; 3])| JointLink {
        name: String::new(),
        origin: Seat { translation: *seat, rpy: [0.0; 3] },
        axis: Some(*axis),
        slide: None,
        limits: Limits { lower: -range, upper: range, speed: 2.0, acceleration: 9.0, slides: None },
        start: AxisValue::bare(0.0),
        bodies: Vec::new(),
        drive: DriveData::default(),
    };
    RobotDescription { links: seats.iter().map(link).collect(), ..nothing() }
}

fn nothing() -> RobotDescription {
    RobotDescription {
        name: String::new(),
        gravity: [0.0; 3],
        base: Seat::default(),
        reference: Seat::default(),
        links: Vec::new(),
        flange: Seat::default(),
        tool: Seat::default(),
        load: Vec::new(),
        tcp_limits: TcpData::default(),
        pedestal: Vec::new(),
        may_touch: Vec::new(),
    }
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

fn six(range: f64) -> InverseKinematics {
    let seats = [
        ([0.0, 0.0, 0.4], Z),
        ([0.1, 0.0, 0.0], Y),
        ([0.0, 0.0, 0.9], Y),
        ([0.0, 0.0, 0.1], X),
        ([0.8, 0.0, 0.0], Y),
        ([0.1, 0.0, 0.0], X),
    ];
    block(arm(&seats, range))
}

fn block(robot: RobotDescription) -> InverseKinematics {
    InverseKinematics { robot, shoulder: None, elbow: None, wrist: None }
}

/// Where the tool is at `q`: position and Euler angles.
fn place(block: &InverseKinematics, q: &[f64]) -> ([f64; 3], [f64; 3]) {
    let robot = &block.clone().built().robot;
    let tool = robot.tcp(&mut robot.model().data(), q);
    let EulerZyx { alpha, beta, gamma } = EulerZyx::from_rotation(&tool.rotation);
    (tool.translation.into(), [alpha, beta, gamma])
}

#[test]
fn each_configuration_that_is_asked_for_comes_out_and_leads_there() {
    let q = [0.3, 0.2, -0.4, 0.5, 0.8, -0.2];
    let (p, zyx) = place(&six(6.0), &q);
    let mut seen = Vec::new();
    for wish in 0..8 {
        let wish = [1, 2, 4].map(|bit| if wish & bit == 0 { 1.0 } else { -1.0 });
        let mut bench = Bench::new(six(6.0));
        let y = bench.set(0, &p).set(1, &zyx).set(2, &q).set(3, &wish).major();
        assert_eq!((&y[6..8], &y[8..11]), (&[1.0, 0.0][..], &wish[..]), "{y:?}");
        let (there, turned) = place(&six(6.0), &y[..6]);
        for (a, b) in there.iter().chain(&turned).zip(p.iter().chain(&zyx)) {
            assert!((a - b).abs() < 1e-9, "{there:?} {turned:?}");
        }
        seen.push(y[..6].to_vec());
    }
    let near = seen.iter().filter(|found| found.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-9));
    assert_eq!(near.count(), 1, "one of them is where the arm was: {seen:?}");
    // By parameter, and the input goes before it.
    let back = InverseKinematics { shoulder: Some(ShoulderName::Back), ..six(6.0) };
    let mut bench = Bench::new(back);
    assert_eq!(bench.set(0, &p).set(1, &zyx).set(2, &q).major()[8], -1.0);
    assert_eq!(bench.set(3, &[1.0, 0.0, 0.0]).major()[8], 1.0);
}

#[test]
fn what_has_no_solution_says_why_and_gives_numbers() {
    let q = [0.3, 0.2, -0.4, 0.5, 0.8, -0.2];
    let (p, zyx) = place(&six(6.0), &q);
    let answer = |block: InverseKinematics, p: [f64; 3], near: [f64; 6], wish: [f64; 3]| {
        Bench::new(block).set(0, &p).set(1, &zyx).set(2, &near).set(3, &wish).major()
    };
    let none = [0.0; 3];
    for (status, y) in [
        (1.0, answer(six(6.0), [9.0, 0.0, 0.0], q, none)),
        (2.0, answer(six(0.1), p, [0.0; 6], none)),
        (3.0, answer(six(1.0), p, q, [-1.0, 0.0, 0.0])),
        (5.0, answer(six(6.0), [f64::NAN, 0.0, 0.0], q, none)),
        (5.0, answer(six(6.0), p, [f64::INFINITY; 6], none)),
    ] {
        assert_eq!((y[6], y[7], &y[8..]), (0.0, status, &none[..]), "{y:?}");
        assert!(y.iter().all(|y| y.is_finite()), "{y:?}");
    }
    assert_eq!(answer(six(6.0), [9.0, 0.0, 0.0], q, none)[..6], q);
}

#[test]
fn an_arm_without_closed_form_is_led_there_and_has_no_configurations() {
    // A wrist whose axes do not meet.
    let seats = [
        ([0.0, 0.0, 0.4], Z),
        ([0.1, 0.0, 0.0], Y),
        ([0.0, 0.0, 0.9], Y),
        ([0.0, 0.0, 0.1], X),
        ([0.8, 0.0, 0.05], Y),
        ([0.1, 0.03, 0.0], X),
    ];
    let general = block(arm(&seats, 6.0));
    let q = [0.3, 0.2, -0.4, 0.5, 0.8, -0.2];
    let (p, zyx) = place(&general, &q);
    let mut bench = Bench::new(general.clone());
    let y = bench.set(0, &p).set(1, &zyx).set(2, &[0.2, 0.3, -0.3, 0.4, 0.7, -0.1]).major();
    assert_eq!(y[6..], [1.0, 0.0]);
    assert!(y.iter().zip(&q).all(|(y, q)| (y - q).abs() < 1e-7), "{y:?}");
    let y = bench.set(0, &[9.0, 0.0, 0.0]).major();
    assert_eq!((y[6], y[7]), (0.0, 4.0));
    let wrong = InverseKinematics { elbow: Some(ElbowName::Up), ..general };
    assert_eq!(wrong.try_build().unwrap_err()[0].param, "elbow");
}
