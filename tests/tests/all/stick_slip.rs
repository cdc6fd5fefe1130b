//! Dry friction that breaks away without a jump of its torque: known times, for every method, at defaults.

use std::f64::consts::TAU;

use blocksim_tests::{Run, close, run_blocks};

/// Times at which modes end.
fn modes(run: &Run, guard: &str) -> Vec<f64> {
    run.events.iter().filter(|(_, path, _)| path == guard).map(|(t, ..)| *t).collect()
}

const SOLVERS: [&str; 15] = [
    "Auto",
    "Dop853",
    "Ode15s",
    "Radau5",
    "Ode23tb",
    "Ode23t",
    "Ode45",
    "Ode23",
    "RosW3",
    "Rodas4",
    "Ode45(rtol: 1e-8)",
    "Ode23(rtol: 1e-8)",
    "RosW3(rtol: 1e-7)",
    "Rodas4(rtol: 1e-8)",
    "Rodas4(rtol: 1e-10)",
];

const WIRES: &str = r#""source.y -> push.tau", "push.r <-> disc.r <-> bearing.r <-> sensor.r",
    "push.c <-> bearing.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#;

fn disc(source: &str, bearing: &str) -> String {
    format!(
        r#""source": {source}, "push": IdealTorqueSource, "disc": Inertia(j: 0.5),
           "bearing": RotationalFriction({bearing}, model: Stiction),
           "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w"])"#
    )
}

const HARD: &str = "breakaway: 3.0, breakaway_velocity: 0.0, coulomb: 3.0";

/// A torque that grows moves a disc once it overcomes the friction, from then on with the square of time.
#[test]
fn a_ramp_moves_a_disc_once_and_for_all() {
    for solver in SOLVERS {
        let run = run_blocks("2 s", solver, &disc(r#"Ramp(slope: "5 N*m/s")"#, HARD), WIRES);
        let times = modes(&run, "bearing");
        assert_eq!(times.len(), 1, "{solver}: {times:?}");
        close(times[0], 0.6, 1e-9, solver);
        close(run.last("scope.w"), 5.0 * 1.4 * 1.4, 1e-3, solver);
    }
}

/// A torque that swings moves a disc twice a period, forward and back, and it stands still in between.
#[test]
fn a_sine_breaks_a_disc_loose_twice_a_period() {
    let (torque, friction, j, omega) = (5.0, 3.0, 0.5, TAU);
    // It breaks away at asin(friction / torque) and stops when the impulses are equal: bisect.
    let away = f64::asin(friction / torque) / omega;
    let speed =
        |t: f64| (torque / omega * ((omega * away).cos() - (omega * t).cos()) - friction * (t - away)) / j;
    let (mut low, mut high) = (0.3, 0.9);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if speed(middle) > 0.0 { low = middle } else { high = middle }
    }
    let stop = low;
    // The torque is still on the forward side, or holds already: then it rests until the other half wave.
    assert!(stop < away + 0.5, "it rests between the strokes");
    let mut expected = Vec::new();
    for half in 0..20 {
        expected.extend([away + 0.5 * f64::from(half), stop + 0.5 * f64::from(half)]);
    }
    for solver in SOLVERS {
        let run =
            run_blocks("10 s", solver, &disc(r#"Sine(amplitude: "5 N*m", frequency: "1 Hz")"#, HARD), WIRES);
        let times = modes(&run, "bearing");
        let due: Vec<f64> = expected.iter().copied().filter(|t| *t < 10.0).collect();
        assert_eq!(times.len(), due.len(), "{solver}: {times:?}");
        for (found, due) in times.iter().zip(&due) {
            close(*found, *due, 2e-3, solver);
        }
    }
}

/// With a friction that falls smoothly over the speed, a body on a spring whose end turns evenly sticks and slips; all
/// methods see the same events as a run at a tight tolerance.
#[test]
fn stick_slip_over_a_falling_friction_has_the_same_events_with_all_methods() {
    let blocks = r#""pull": Constant(value: "0.4 rad/s"), "drive": IdealSpeedSource, "spring": RotationalSpring(k: 50.0),
        "disc": Inertia(j: 0.02),
        "rail": RotationalFriction(breakaway: 3.0, breakaway_velocity: 0.1, coulomb: 1.8, model: Stiction),
        "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w"])"#;
    let wires = r#""pull.y -> drive.w", "drive.r <-> spring.r", "spring.c <-> disc.r <-> rail.r <-> sensor.r",
        "drive.c <-> rail.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#;
    let reference = modes(&run_blocks("1 s", "Ode45(rtol: 1e-11, atol: 1e-13)", blocks, wires), "rail");
    close(reference[0], 0.15, 1e-12, "the spring bears the breakaway torque");
    assert!(reference.len() > 6, "{reference:?}");
    for solver in SOLVERS {
        let run = run_blocks("1 s", solver, blocks, wires);
        let times = modes(&run, "rail");
        assert_eq!(times.len(), reference.len(), "{solver}: {times:?} != {reference:?}");
        for (found, due) in times.iter().zip(&reference) {
            close(*found, *due, 3e-3, solver);
        }
    }
}

/// What slides to rest with a friction whose peak about standstill is a millimetre a second wide, from many speeds: the last step is a hundred
/// times as long as the peak takes. It sticks after the integral of `m dv / F(v)`.
#[test]
fn the_peak_of_the_friction_about_standstill_is_not_passed_over() {
    let (peak, coulomb, viscous, width) = (8.0, 4.0, 0.5, 1e-3 * f64::sqrt(2.0));
    // By Simpson's rule up to 20 mm/s, beyond which nothing is left of the peak.
    let (edge, parts) = (0.02, 20_000);
    let friction = |v: f64| coulomb + viscous * v + peak * (-(v / width).powi(2)).exp();
    let weight = |k: i32| if k == 0 || k == parts { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let sum: f64 = (0..=parts).map(|k| weight(k) / friction(edge * f64::from(k) / f64::from(parts))).sum();
    let slow = sum * edge / f64::from(parts) / 3.0;
    let fast = |v0: f64| ((coulomb + viscous * v0) / (coulomb + viscous * edge)).ln() / viscous;
    for solver in SOLVERS {
        for v0 in (0..12).map(|k| 2.0 + 0.17 * f64::from(k)) {
            let run = run_blocks(
                "2 s",
                solver,
                &format!(
                    r#""m": Mass(m: 1, v0: {v0:?}), "w": TranslationalReference, "s": Scope(inputs: ["v"]), "x": TranslationalMotionSensor,
                       "f": TranslationalFriction(
                           breakaway: 12, coulomb: 4, breakaway_velocity: 0.001, viscous: 0.5, model: Stiction)"#
                ),
                r#""m.r <-> f.r <-> x.r", "w.r <-> f.c <-> x.c", "x.v -> s.v""#,
            );
            let told = modes(&run, "f");
            assert_eq!(told.len(), 1, "{solver}: {:?}", run.events);
            close(told[0], slow + fast(v0), 1e-5, &format!("{solver}, {v0} m/s"));
        }
    }
}
