use super::*;
use crate::motion::axis_kind::AxisKind;

/// Limits of a six-axis arm of 12 kg payload; position limits wide.
fn arm() -> Vec<AxisLimits> {
    let speeds = [175.0, 175.0, 175.0, 360.0, 360.0, 500.0_f64];
    let accelerations = [8.0, 6.0, 10.0, 25.0, 25.0, 35.0];
    (0..6)
        .map(|i| AxisLimits {
            kind: AxisKind::Turning,
            lower: -3.2,
            upper: 3.2,
            speed: speeds[i].to_radians(),
            acceleration: accelerations[i],
        })
        .collect()
}

fn request(target_deg: &[f64], velocity: f64, acceleration: f64) -> JointMoveRequest {
    JointMoveRequest {
        start: vec![0.0; target_deg.len()],
        target: target_deg.iter().map(|x| x.to_radians()).collect(),
        velocity,
        acceleration,
        rule: Synchronisation::Feasible,
    }
}

fn demo() -> JointMoveRequest {
    request(&[60.0, 30.0, -20.0, 45.0, 60.0, 90.0], 0.4, 0.3)
}

/// A small deterministic generator (splitmix64) of numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn request(&mut self, rule: Synchronisation) -> JointMoveRequest {
        let mut positions = || (0..6).map(|_| 6.4 * self.next() - 3.2).collect();
        let (start, target) = (positions(), positions());
        let velocity = 0.05 + 0.95 * self.next();
        let acceleration = 0.05 + 0.45 * self.next();
        JointMoveRequest { start, target, velocity, acceleration, rule }
    }
}

#[test]
fn a_known_move_has_the_known_times_and_peaks() {
    // Computed by hand: axis 1 covers 60 deg at 70 deg/s in 6/7 s, 3/7 of which is the ramp.
    for rule in [Synchronisation::Feasible, Synchronisation::AsPrinted] {
        let planned = JointMove::plan(&JointMoveRequest { rule, ..demo() }, &arm()).unwrap();
        assert_eq!(planned.leading_axis(), 0);
        assert_eq!(planned.stretch(), 1.0);
        assert!((planned.t_acc() - 18.0 / 49.0).abs() < 1e-14, "{}", planned.t_acc());
        assert!((planned.t_dec() - 6.0 / 7.0).abs() < 1e-14);
        assert!((planned.duration() - 1.22449).abs() < 5e-6);
        let printed = [6.65, 3.33, 2.22, 4.99, 6.65, 9.98];
        for (found, printed) in planned.peak_accelerations().iter().zip(printed) {
            assert!((found - printed).abs() < 0.005, "{found} is not {printed}");
        }
        assert!(planned.violations().is_empty());
    }
}

#[test]
fn the_ends_are_exact_and_at_rest() {
    let request = Random(1).request(Synchronisation::Feasible);
    let planned = JointMove::plan(&request, &arm()).unwrap();
    for axis in 0..planned.axes() {
        for t in [-1.0, 0.0] {
            assert_eq!(planned.at(axis, t), (request.start[axis], 0.0, 0.0));
        }
        for t in [planned.duration(), planned.duration() + 1.0] {
            assert_eq!(planned.at(axis, t), (request.target[axis], 0.0, 0.0));
        }
    }
}

#[test]
fn position_velocity_and_acceleration_are_continuous() {
    let mut random = Random(2);
    for _ in 0..200 {
        let planned = JointMove::plan(&random.request(Synchronisation::Feasible), &arm()).unwrap();
        for axis in 0..planned.axes() {
            for seam in [0.0, planned.t_acc(), planned.t_dec(), planned.duration()] {
                let (before, after) = (planned.at(axis, seam - 1e-15), planned.at(axis, seam + 1e-15));
                assert!((after.0 - before.0).abs() < 1e-12, "position of axis {axis} at {seam}");
                assert!((after.1 - before.1).abs() < 1e-12, "velocity of axis {axis} at {seam}");
                assert!((after.2 - before.2).abs() < 1e-12, "acceleration of axis {axis} at {seam}");
            }
        }
    }
}

#[test]
fn all_axes_cover_the_same_share_of_their_way_at_all_times() {
    let request = demo();
    let planned = JointMove::plan(&request, &arm()).unwrap();
    for k in 0..=100 {
        let t = planned.duration() * f64::from(k) / 100.0;
        let share = |axis: usize| planned.at(axis, t).0 / request.target[axis];
        for axis in 1..6 {
            assert!((share(axis) - share(0)).abs() < 1e-14);
        }
    }
}

#[test]
fn random_moves_stay_within_every_limit() {
    let mut random = Random(3);
    let limits = arm();
    let mut stretched = 0;
    for _ in 0..2000 {
        let request = random.request(Synchronisation::Feasible);
        let planned = JointMove::plan(&request, &limits).unwrap();
        stretched += usize::from(planned.stretch() > 1.0);
        assert_eq!(planned.violations(), []);
        for (axis, margin) in planned.margins().iter().enumerate() {
            let l = &limits[axis];
            assert!(margin.lower >= 0.0 && margin.upper >= 0.0);
            assert!(margin.speed >= -1e-14 * l.speed && margin.acceleration >= -1e-14 * l.acceleration);
            for k in 0..=50 {
                let (q, qd, qdd) = planned.at(axis, planned.duration() * f64::from(k) / 50.0);
                assert!(q >= l.lower - 1e-14 && q <= l.upper + 1e-14);
                assert!(qd.abs() <= l.speed * (1.0 + 1e-14) && qdd.abs() <= l.acceleration * (1.0 + 1e-14));
            }
        }
    }
    assert!((200..1800).contains(&stretched), "{stretched} moves hit an acceleration limit");
}

#[test]
fn the_printed_rule_breaks_a_limit_in_some_moves_and_says_so() {
    let mut random = Random(4);
    let mut broken = 0;
    for _ in 0..2000 {
        let planned = JointMove::plan(&random.request(Synchronisation::AsPrinted), &arm()).unwrap();
        for violation in planned.violations() {
            assert_ne!(violation.axis, planned.leading_axis(), "the leading axis keeps its own limits");
            assert!(violation.value > violation.limit);
        }
        broken += usize::from(!planned.violations().is_empty());
    }
    assert!((10..1000).contains(&broken), "{broken} of 2000 moves break a limit");
}

#[test]
fn a_violation_reads_as_a_sentence() {
    let limits = [
        AxisLimits { kind: AxisKind::Turning, lower: -3.0, upper: 3.0, speed: 1.0, acceleration: 1e3 },
        AxisLimits { kind: AxisKind::Turning, lower: -3.0, upper: 3.0, speed: 2.0, acceleration: 4.0 },
    ];
    let request = JointMoveRequest {
        start: vec![0.0, 0.0],
        target: vec![1.0, 1.2],
        velocity: 1.0,
        acceleration: 0.2,
        rule: Synchronisation::AsPrinted,
    };
    let planned = JointMove::plan(&request, &limits).unwrap();
    let text: Vec<String> = planned.violations().iter().map(ToString::to_string).collect();
    // Axis 2 alone: v = sqrt(4 * 1.2 / 2) = 1.549 rad/s, T_dec = T_acc = 0.775 s, longer in all than the
    // 1.25 s of axis 1, which would then need 1 / 0.775 = 1.291 rad/s.
    assert_eq!(planned.leading_axis(), 1);
    assert_eq!(text, ["axis 1: speed 73.969 deg/s exceeds its limit 57.296 deg/s by 29.1 %"]);

    let request = JointMoveRequest { target: vec![2.7, 2.5], acceleration: 0.05, ..request };
    let planned = JointMove::plan(&request, &limits).unwrap();
    let text: Vec<String> = planned.violations().iter().map(ToString::to_string).collect();
    assert_eq!(
        text,
        ["axis 2: acceleration 746.653 deg/s^2 exceeds its limit 229.183 deg/s^2 by 225.8 %"],
        "T_dec = 2.7 s, T_acc = 2.7 / 19 s, a = 2 * 2.5 / (2.7 * 2.7 / 19) = 13.03 rad/s^2"
    );
}

#[test]
fn a_move_that_asks_for_too_much_acceleration_is_stretched_as_a_whole() {
    // At 100 % and a share of 10 %: a_m of axis 1 = 2 v / T_acc with T_dec = 60/175 s, T_acc = T_dec / 9.
    let request = request(&[60.0, 30.0, -20.0, 45.0, 60.0, 90.0], 1.0, 0.1);
    let planned = JointMove::plan(&request, &arm()).unwrap();
    let t_dec = 60.0 / 175.0;
    let asked = |d: f64| 2.0 * d.to_radians() / (t_dec * t_dec / 9.0);
    let expected = (asked(60.0) / 8.0).sqrt();
    assert!((planned.stretch() - expected).abs() < 1e-12 * expected, "{}", planned.stretch());
    assert_eq!(planned.leading_axis(), 0);
    assert!((planned.peak_accelerations()[0] - 8.0).abs() < 1e-12);
    // The share of the time spent accelerating is what was asked for.
    assert!((planned.t_acc() / planned.duration() - 0.1).abs() < 1e-15);
    assert!((planned.duration() - expected * t_dec / 0.9).abs() < 1e-12);
}

#[test]
fn half_the_time_is_the_longest_ramp_and_an_axis_may_stay() {
    let planned = JointMove::plan(&request(&[0.0, 30.0, 0.0, 0.0, 0.0, 0.0], 0.5, 0.5), &arm()).unwrap();
    assert_eq!(planned.t_acc(), planned.t_dec());
    assert_eq!(planned.leading_axis(), 1);
    assert_eq!(planned.at(0, planned.duration() / 3.0), (0.0, 0.0, 0.0));
}

#[test]
fn limits_may_be_infinite() {
    let free = AxisLimits {
        kind: AxisKind::Turning,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        speed: 1.0,
        acceleration: f64::INFINITY,
    };
    let planned = JointMove::plan(&request(&[3600.0], 1.0, 0.2), &[free]).unwrap();
    assert!((planned.t_dec() - 3600.0_f64.to_radians()).abs() < 1e-12);
}

#[test]
fn refusals_name_axis_value_limit_and_remedy() {
    let check = |change: &dyn Fn(&mut JointMoveRequest, &mut Vec<AxisLimits>), expected: &str| {
        let (mut request, mut limits) = (demo(), arm());
        change(&mut request, &mut limits);
        let error = JointMove::plan(&request, &limits).unwrap_err();
        assert_eq!(error.to_string(), expected);
    };
    check(
        &|r, _| r.start.truncate(5),
        "the start has 5 positions, but there are 6 axes; give one position per axis, decimals with a point",
    );
    check(
        &|r, _| r.target.push(0.0),
        "the target has 7 positions, but there are 6 axes; give one position per axis, decimals with a point",
    );
    check(
        &|r, _| r.target[2] = f64::NAN,
        "axis 3: the target is NaN, which is not a position; give a number with an angle unit",
    );
    check(
        &|r, l| (r.target[2], l[2].upper) = (200.0_f64.to_radians(), 75.0_f64.to_radians()),
        "axis 3: the target 200 deg is 125 deg above the limit 75 deg; choose a position from -183.346 to 75 deg",
    );
    check(
        &|r, l| (r.start[0], l[0].lower) = (-0.5, -0.5 + 1e-6),
        "axis 1: the start -28.648 deg is 5.730e-5 deg below the limit -28.648 deg; choose a position from \
         -28.648 to 183.346 deg",
    );
    check(
        &|r, _| r.target = r.start.clone(),
        "start and target are the same on all axes; change the target of at least one",
    );
    check(
        &|r, _| r.velocity = 40.0,
        "the velocity is 4000 % of the maximum speed; choose more than 0 % and at most 100 %",
    );
    check(
        &|r, _| r.velocity = f64::NAN,
        "the velocity is NaN % of the maximum speed; choose more than 0 % and at most 100 %",
    );
    check(
        &|r, _| r.acceleration = 0.6,
        "60 % of the move time are to be spent accelerating; choose more than 0 % and at most 50 %, for \
         braking takes as long",
    );
    check(
        &|_, l| l[3].lower = 4.0,
        "axis 4: the lower limit 229.183 deg is not below the upper limit 183.346 deg; correct the limits",
    );
    check(&|_, l| l[4].speed = 0.0, "axis 5: the maximum speed is 0 deg/s; give a positive number");
    check(
        &|_, l| l[5].acceleration = -1.0,
        "axis 6: the maximum acceleration is -57.296 deg/s^2; give a positive number",
    );
    check(&|_, l| l.clear(), "there is no axis to move; give the limits of at least one");
}

#[test]
fn distances_too_small_to_compute_with_are_refused() {
    let error = JointMove::plan(&request(&[1e-320, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0, 0.1), &arm()).unwrap_err();
    assert!(matches!(error, MoveError::NotComputable { .. }), "{error}");
}

#[test]
fn a_position_off_by_rounding_is_within_its_limits() {
    let mut limits = arm();
    limits[0].upper = 60.0_f64.to_radians() - 1e-15;
    assert!(JointMove::plan(&demo(), &limits).is_ok());
}

#[test]
fn what_is_said_of_an_axis_that_slides_is_in_millimetres() {
    let slide = AxisLimits { kind: AxisKind::Sliding, lower: 0.0, upper: 0.5, speed: 0.2, acceleration: 1.0 };
    let request = |target| JointMoveRequest {
        start: vec![0.1],
        target: vec![target],
        velocity: 1.0,
        acceleration: 0.5,
        rule: Synchronisation::Feasible,
    };
    let error = JointMove::plan(&request(0.6), &[slide]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "axis 1: the target 600 mm is 100 mm above the limit 500 mm; choose a position from 0 to 500 mm"
    );
    // 0.3 m at 0.2 m/s: 1.5 s to the middle of braking.
    let planned = JointMove::plan(&request(0.4), &[slide]).unwrap();
    assert!((planned.t_dec() - 1.5).abs() < 1e-12 && planned.violations().is_empty());
}
