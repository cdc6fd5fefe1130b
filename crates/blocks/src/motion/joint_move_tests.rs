//! Tests of the block.

use super::*;
use blocksim_block::in_unit::AxisValue;
use blocksim_block::testing::Bench;
use std::f64::consts::PI;

fn of(path: JointPath, limits: Vec<Limits>, axis: usize, delay: f64, rule: Rule) -> JointMove {
    JointMove { path, limits, axis, delay, rule, robot: None, plan: None, seams: Vec::new() }
}

/// Two axes over 1 rad and -0.5 rad, at most 1 rad/s and 10 rad/s^2.
fn block(axis: usize) -> JointMove {
    let path = JointPath::joint(vec![0.0, 0.25], vec![1.0, -0.25], 0.5, 0.25);
    let limits = vec![Limits { lower: -1.5, upper: 1.5, speed: 1.0, acceleration: 10.0, slides: None }; 2];
    of(path, limits, axis, 0.5, Rule::Feasible)
}

fn refused(change: impl Fn(&mut JointMove)) -> ParamError {
    let mut block = block(1);
    change(&mut block);
    block.try_build().unwrap_err()[0].clone()
}

#[test]
fn the_set_values_match_the_closed_form() {
    // Axis 1 leads: T_dec = 1 / 0.5 = 2 s, T_acc = 0.25 / 0.75 * 2 = 2/3 s.
    for (axis, start, d) in [(1, 0.0, 1.0), (2, 0.25, -0.5)] {
        let (t_acc, t_dec, v) = (2.0 / 3.0, 2.0, d / 2.0);
        let a = 2.0 * v / t_acc;
        let mut bench = Bench::new(block(axis));
        for t in [0.1, 0.3, 0.6_f64] {
            bench.t = 0.5 + t;
            let s = (PI * t / t_acc).sin();
            let q = start + a * (t * t / 4.0 - (t_acc / (2.0 * PI) * s).powi(2));
            let qd = a * (t / 2.0 - t_acc / (4.0 * PI) * (2.0 * PI * t / t_acc).sin());
            for (y, expected) in bench.major().into_iter().zip([q, qd, a * s * s]) {
                assert!((y - expected).abs() < 1e-14, "axis {axis}, t {t}: {y} != {expected}");
            }
        }
        bench.t = 0.5 + (t_acc + t_dec) / 2.0;
        let y = bench.major();
        assert!((y[0] - (start + d / 2.0)).abs() < 1e-14 && (y[1] - v).abs() < 1e-14 && y[2] == 0.0);
    }
}

#[test]
fn the_axis_rests_before_and_after_the_move() {
    let mut bench = Bench::new(block(2));
    for (t, q) in [(0.0, 0.25), (0.5, 0.25), (0.5 + 8.0 / 3.0 + 1e-9, -0.25), (99.0, -0.25)] {
        bench.t = t;
        assert_eq!(bench.major(), [q, 0.0, 0.0], "t = {t}");
    }
}

#[test]
fn the_seams_are_time_events_and_the_end_is_known() {
    let block = block(1);
    let end = block.clone().built().end_time().unwrap();
    assert!((end - (0.5 + 8.0 / 3.0)).abs() < 1e-15);
    let mut bench = Bench::new(block);
    for expected in [0.5, 0.5 + 2.0 / 3.0, 2.5, end] {
        bench.t = bench.next_event();
        assert!((bench.t - expected).abs() < 1e-15, "{} != {expected}", bench.t);
    }
    assert_eq!(bench.next_event(), f64::INFINITY);
}

#[test]
fn building_makes_the_plan() {
    assert_eq!(block(1).end_time(), None);
    assert!(block(1).built().end_time().is_some());
}

#[test]
fn outputs_bear_their_units() {
    let interface = block(1).interface(&Given::nothing()).unwrap();
    let units: Vec<_> = interface
        .outputs
        .iter()
        .map(|output| output.port_type.dimension.map(|dimension| dimension.to_string()))
        .collect();
    assert_eq!(units, ["rad", "rad/s", "rad/s^2"].map(|unit| Some(unit.to_owned())));
    assert!(interface.uses_time && interface.time_events);
}

#[test]
fn a_target_beyond_a_limit_is_named_with_value_limit_and_remedy() {
    let error = refused(|block| block.path.target[1].value = 2.0);
    assert_eq!(error.param, "path.target[1]");
    assert_eq!(error.message, "axis 2: the target 114.592 deg is 28.648 deg above the limit 85.944 deg");
    assert_eq!(error.help.unwrap(), "choose a position from -85.944 to 85.944 deg");
}

#[test]
fn each_mistake_is_blamed_on_its_parameter() {
    assert_eq!(refused(|block| block.path.start.truncate(1)).param, "path.start");
    assert_eq!(refused(|block| block.path.start[0].value = f64::NAN).param, "path.start[0]");
    assert_eq!(refused(|block| block.path.target = block.path.start.clone()).param, "path.target");
    assert_eq!(refused(|block| block.path.velocity = Some(40.0)).param, "path.velocity");
    assert_eq!(refused(|block| block.path.acceleration = Some(0.6)).param, "path.acceleration");
    assert_eq!(refused(|block| block.path.resolution = 0.0).param, "path.resolution");
    assert_eq!(refused(|block| block.limits[1].speed = 0.0).param, "limits[1].speed");
    assert_eq!(refused(|block| block.limits[0].acceleration = -1.0).param, "limits[0].acceleration");
    assert_eq!(refused(|block| block.limits[0].lower = 9.0).param, "limits[0].upper");
    assert_eq!(refused(|block| block.limits.clear()).param, "limits");
    assert_eq!(refused(|block| block.delay = -1.0).param, "delay");
    for axis in [0, 3] {
        assert_eq!(refused(|block| block.axis = axis).param, "axis");
    }
}

#[test]
fn every_refusal_comes_with_a_remedy() {
    assert!(refused(|block| block.path.velocity = Some(0.0)).help.is_some());
    assert!(refused(|block| block.axis = 7).help.unwrap().contains("1 to 2"));
}

#[test]
fn the_rule_as_printed_can_be_chosen() {
    // Axis 2 would need 3.65 s alone and axis 1 leads with 3.73 s; in its times axis 2 exceeds its limit by 28 %.
    let with = |rule| {
        let mut limits = block(1).limits;
        limits[1].acceleration = 0.3;
        let mut path = block(1).path;
        path.target[0].value = 1.4;
        of(path, limits, 1, 0.0, rule).built().end_time().unwrap()
    };
    assert!(with(Rule::AsPrinted) < with(Rule::Feasible));
}

#[test]
fn an_axis_that_slides_has_lengths() {
    let slide = Limits { lower: 0.0, upper: 0.4, speed: 0.5, acceleration: 2.0, slides: Some(true) };
    let mut block = block(2);
    block.limits[1] = slide;
    block.path = JointPath::joint(vec![0.0, 0.1], vec![0.5, 0.3], 0.5, 0.25);
    let units: Vec<_> = block.interface(&Given::nothing()).unwrap().outputs;
    let units: Vec<_> = units.iter().filter_map(|y| Some(y.port_type.dimension?.to_string())).collect();
    assert_eq!(units, ["m", "m/s", "m/s^2"]);
    block = block.built();
    block.path.target[1] = AxisValue { value: 0.5, slides: Some(false) };
    let error = &block.try_build().unwrap_err()[0];
    assert_eq!(error.param, "path.target[1]");
    assert_eq!(error.message, "axis 2 slides, but this has the unit of an axis that turns");
}
