//! Zero crossings, jumps and time events.

use blocksim_block::schedule::OutputTimes::{Every, Steps};
use blocksim_block::schedule::Solver;
use blocksim_sim::Simulation;

use crate::toys::*;

/// Times of the first `n` impacts of a ball that falls from `height`.
fn impacts(height: f64, restitution: f64, n: i32) -> Vec<f64> {
    let fall = (2.0 * height / GRAVITY).sqrt();
    let flights = |k| (1..=k).map(|i| 2.0 * fall * restitution.powi(i)).sum::<f64>();
    (0..n).map(|k| fall + flights(k)).collect()
}

#[test]
fn fifty_impacts_of_a_ball_come_at_their_times() {
    let (height, restitution) = (1.0, 0.9);
    let expected = impacts(height, restitution, 51);
    let stop = 0.5 * (expected[49] + expected[50]);
    let schedule = Toy::new().with("ball", Ball { height, restitution }, &[]).schedule(
        &["ball.h", "ball.v"],
        stop,
        ode45(),
        Steps,
    );
    let mut tape = Tape::default();
    let mut sim = Simulation::new(schedule).unwrap();
    sim.run(&mut tape).unwrap();
    let jumps: Vec<f64> = tape.events.iter().filter(|e| e.1 == "ball jumps").map(|e| e.0).collect();
    assert_eq!(jumps.len(), 50);
    for (k, (jump, expected)) in jumps.iter().zip(&expected).enumerate() {
        assert!((jump - expected).abs() < 1e-9, "impact {k}: {jump} and not {expected}");
    }
    for pair in tape.rows.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        assert!((pair[1].1[1] + restitution * pair[0].1[1]).abs() < 1e-12, "{pair:?}");
    }
}

#[test]
fn rows_of_one_time_stand_only_around_jumps() {
    let ball = Ball { height: 1.0, restitution: 0.5 };
    let schedule = Toy::new().with("ball", ball, &[]).schedule(&["ball.h"], 1.2, ode45(), Every(0.01));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    let times = tape.times();
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    let twice: Vec<f64> = times.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    let jumps: Vec<f64> = tape.events.iter().filter(|e| e.1 == "ball jumps").map(|e| e.0).collect();
    assert_eq!(twice, jumps);
    let fall = |t: f64| 1.0 - 0.5 * GRAVITY * t * t;
    assert!((tape.at(0.3, 0) - fall(0.3)).abs() < 1e-12);
}

#[test]
fn a_step_is_hit_exactly() {
    let toy = Toy::new().with("step", StepAt(0.3), &[]).with("x", Integrator(0.0), &["step"]);
    let schedule = toy.schedule(&["step", "x"], 1.0, ode45(), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    // Zero up to the step and one from then on: two rows of one time.
    let there: Vec<&[f64]> =
        tape.rows.iter().filter(|row| row.0 == 0.3).map(|row| row.1.as_slice()).collect();
    assert_eq!(there, [[0.0, 0.0], [1.0, 0.0]]);
    assert!((tape.at(1.0, 1) - 0.7).abs() < 1e-15);
}

#[test]
fn a_step_off_the_grid_of_rows_is_a_vertical_line() {
    let toy = Toy::new().with("step", StepAt(0.33), &[]).with("x", Integrator(0.0), &["step"]);
    let schedule = toy.schedule(&["step"], 1.0, ode4(0.05), Every(0.25));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.times(), [0.0, 0.25, 0.33, 0.33, 0.5, 0.75, 1.0]);
    assert_eq!(tape.column(0), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn an_event_that_changes_nothing_recorded_is_one_row() {
    let toy = Toy::new().with("step", StepAt(0.33), &[]).with("x", Integrator(0.0), &["step"]);
    let schedule = toy.schedule(&["x"], 1.0, ode45(), Every(0.5));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.times(), [0.0, 0.33, 0.5, 1.0]);
}

#[test]
fn a_sample_hit_is_one_row() {
    let toy = Toy::new().with("t", Time, &[]).with("hold", Hold(0.25), &["t"]);
    let schedule = toy.schedule(&["hold"], 1.0, ode45(), Every(0.25));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.times(), [0.0, 0.25, 0.5, 0.75, 1.0]);
}

#[test]
fn a_step_at_a_sample_hit_is_seen_by_it() {
    // 3 * 0.1 is not the number 0.3.
    let toy =
        Toy::new().with("step", StepAt(3.0 * 0.1), &[]).major("step").with("hold", Hold(0.1), &["step"]);
    let schedule = toy.schedule(&["hold"], 1.0, ode45(), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    // One row for each hit, and one before the step.
    assert_eq!(tape.rows.len(), 12);
    assert_eq!(tape.column(0), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn a_relay_around_an_integrator_oscillates_with_the_right_period() {
    // x' = -relay(x) with thresholds +-0.25 is a triangle of period 4 * 0.25 s.
    let toy = Toy::new().with("x", Integrator(0.0), &["minus"]);
    let toy =
        toy.with("relay", Relay { low: -0.25, high: 0.25 }, &["x"]).with("minus", Gain(-1.0), &["relay"]);
    let schedule = toy.schedule(&["x"], 20.1, ode45(), Steps);
    let mut tape = Tape::default();
    let mut sim = Simulation::new(schedule).unwrap();
    sim.run(&mut tape).unwrap();
    assert_eq!(tape.events.len(), 40);
    for (k, (t, what)) in tape.events.iter().enumerate() {
        assert_eq!(what, "relay switch");
        assert!((t - (0.25 + 0.5 * k as f64)).abs() < 1e-12, "switch {k} at {t}");
    }
    assert_eq!(sim.counts().events, 40);
}

#[test]
fn an_event_is_found_where_nothing_is_integrated() {
    let toy = Toy::new().with("t", Time, &[]).with("late", Function2(|t, _| t - 0.123), &["t", "t"]);
    let toy = toy.with("relay", Sign, &["late"]);
    let schedule = toy.schedule(&["relay"], 1.0, ode45(), Every(0.5));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.events.len(), 1);
    let crossing = tape.events[0].0;
    assert!((crossing - 0.123).abs() < 1e-12);
    assert_eq!(tape.times(), [0.0, crossing, crossing, 0.5, 1.0]);
    assert_eq!(tape.column(0), [-1.0, -1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn the_first_of_two_crossings_in_a_step_comes_first() {
    let toy = Toy::new()
        .with("t", Time, &[])
        .with("seven", Function2(|t, _| 0.7 - t), &["t", "t"])
        .with("six", Function2(|t, _| t - 0.65), &["t", "t"])
        .with("later", Sign, &["seven"])
        .with("sooner", Sign, &["six"])
        .with("one", Constant(1.0), &[])
        .with("x", Integrator(0.0), &["one"]);
    let schedule = toy.schedule(&["x"], 10.0, ode45(), Every(10.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    let names: Vec<&str> = tape.events.iter().map(|event| event.1.as_str()).collect();
    assert_eq!(names, ["sooner zero", "later zero"]);
    assert!((tape.events[0].0 - 0.65).abs() < 1e-11 && (tape.events[1].0 - 0.7).abs() < 1e-11);
}

#[test]
fn a_branch_that_starts_on_its_threshold_is_chosen_anew_behind_it() {
    // The input starts at zero, where the sign is 1, and falls; the sign must not stay 1 for the whole step.
    let toy = Toy::new().with("minus", Constant(-1.0), &[]).with("u", Integrator(0.0), &["minus"]);
    let toy = toy.with("sign", Sign, &["u"]).with("x", Integrator(0.0), &["sign"]);
    let schedule = toy.schedule(&["x"], 1.0, ode45(), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert!((tape.at(1.0, 0) + 1.0).abs() < 1e-5, "{}", tape.at(1.0, 0));
    assert!(tape.events.is_empty());
}

#[test]
fn fixed_steps_do_not_look_for_crossings() {
    let toy = Toy::new().with("t", Time, &[]).with("late", Function2(|t, _| t - 0.123), &["t", "t"]);
    let toy = toy.with("sign", Sign, &["late"]).with("x", Integrator(0.0), &["sign"]);
    let schedule = toy.schedule(&["x"], 1.0, ode4(0.1), Steps);
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert!(tape.events.is_empty());
    assert_eq!(tape.times(), (0..=10).map(|k| f64::from(k) / 10.0).collect::<Vec<_>>());
}

#[test]
fn a_largest_step_is_kept_where_nothing_is_integrated() {
    let Solver::Variable { method, rtol, atol, .. } = ode45() else { unreachable!() };
    let solver = Solver::Variable { method, rtol, atol, max_step: 0.25 };
    let mut tape = Tape::default();
    let schedule = Toy::new().with("t", Time, &[]).schedule(&["t"], 1.0, solver, Steps);
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.column(0), [0.0, 0.25, 0.5, 0.75, 1.0]);
}

#[test]
fn impacts_that_are_far_shorter_than_a_step_are_all_seen() {
    // Without a limit the step has grown to seconds when the ball hops for microseconds.
    let (height, restitution) = (1.0, 0.5);
    let expected = impacts(height, restitution, 26);
    let stop = 0.5 * (expected[24] + expected[25]);
    let ball = Ball { height, restitution };
    let schedule = Toy::new().with("ball", ball, &[]).schedule(&["ball.h"], 10.0, ode45(), Every(1.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run_until(stop, &mut tape).unwrap();
    let jumps: Vec<f64> = tape.events.iter().filter(|e| e.1 == "ball jumps").map(|e| e.0).collect();
    assert_eq!(jumps.len(), 25);
    assert!((jumps[24] - expected[24]).abs() < 1e-9);
}

/// Times at which the guard of a sign block with this input fires while x' = 1 is integrated in one long step.
fn switches(f: fn(f64, f64) -> f64, stop: f64) -> Vec<f64> {
    let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
    let toy = toy.with("u", Function2(f), &["x", "x"]).with("sign", Sign, &["u"]);
    let schedule = toy.schedule(&["sign"], stop, ode45(), Every(stop));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    tape.events.iter().map(|event| event.0).collect()
}

fn assert_times(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} and not {expected:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance, "{found} and not {expected}");
    }
}

#[test]
fn a_parabola_that_dips_below_zero_for_a_hundredth_of_a_step_is_seen() {
    // Steps of x' = 1 grow tenfold each, so these dips are hundredths, and one a ten thousandth, of the step around them.
    assert_times(&switches(|x, _| (x - 61.0) * (x - 61.5), 100.0), &[61.0, 61.5], 1e-9);
    assert_times(&switches(|x, _| -(x - 61.0) * (x - 61.5), 100.0), &[61.0, 61.5], 1e-9);
    assert_times(&switches(|x, _| (x - 61.0) * (x - 61.005), 100.0), &[61.0, 61.005], 1e-9);
    // It only just touches zero, and it stays away by a millionth.
    assert_eq!(switches(|x, _| (x - 61.0) * (x - 61.0), 100.0).len() % 2, 0);
    assert!(switches(|x, _| (x - 61.0) * (x - 61.0) + 1e-6, 100.0).is_empty());
}

#[test]
fn of_two_dips_in_a_step_the_first_comes_first() {
    let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
    let toy = toy.with("late", Function2(|x, _| (x - 80.0) * (x - 80.5)), &["x", "x"]);
    let toy = toy.with("soon", Function2(|x, _| (x - 60.0) * (x - 60.5)), &["x", "x"]);
    let toy = toy.with("a", Sign, &["late"]).with("b", Sign, &["soon"]);
    let schedule = toy.schedule(&["a", "b"], 100.0, ode45(), Every(100.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    let names: Vec<&str> = tape.events.iter().map(|event| event.1.as_str()).collect();
    assert_eq!(names, ["b zero", "b zero", "a zero", "a zero"]);
    let times: Vec<f64> = tape.events.iter().map(|event| event.0).collect();
    assert_times(&times, &[60.0, 60.5, 80.0, 80.5], 1e-9);
}

#[test]
fn a_sine_is_seen_above_a_threshold_just_below_its_peak() {
    // The peaks rise above it for 0.02 to 0.0002 of a radian, while steps are half a radian long.
    for threshold in [1.0 - 5e-5, 1.0 - 5e-7, 1.0 - 5e-9] {
        let toy = Toy::new().with("v", Integrator(1.0), &["force"]).with("x", Integrator(0.0), &["v"]);
        let toy = toy.with("force", Gain(-1.0), &["x"]).with("level", Constant(threshold), &[]);
        let toy = toy.with("u", Function2(|x, level| x - level), &["x", "level"]).with("sign", Sign, &["u"]);
        let solver = Solver::Variable {
            method: blocksim_block::schedule::VariableMethod::Ode45,
            rtol: 1e-10,
            atol: Some(1e-12),
            max_step: f64::MAX,
        };
        let mut tape = Tape::default();
        Simulation::new(toy.schedule(&["x"], 40.0, solver, Every(40.0))).unwrap().run(&mut tape).unwrap();
        let half = threshold.acos();
        let middles = (0..7).map(|k| std::f64::consts::FRAC_PI_2 + std::f64::consts::TAU * f64::from(k));
        let expected: Vec<f64> = middles.flat_map(|middle| [middle - half, middle + half]).collect();
        let times: Vec<f64> = tape.events.iter().map(|event| event.0).collect();
        // An error of the state is enlarged by the slope there, which is `half`.
        assert_times(&times, &expected, 1e-7 / half);
    }
}

#[test]
fn a_ball_that_hops_for_hundredths_of_a_step_never_falls_through_the_floor() {
    // Nothing but the hops limits the steps of a free flight, which the method integrates exactly.
    for (height, restitution) in [(1e-6, 0.999), (1e-3, 0.9), (1.0, 0.7)] {
        let expected = impacts(height, restitution, 31);
        let stop = 0.5 * (expected[29] + expected[30]);
        let ball = Ball { height, restitution };
        let schedule = Toy::new().with("ball", ball, &[]).schedule(&["ball.h"], 1e3, ode45(), Every(1e3));
        let mut tape = Tape::default();
        Simulation::new(schedule).unwrap().run_until(stop, &mut tape).unwrap();
        let jumps: Vec<f64> = tape.events.iter().filter(|e| e.1 == "ball jumps").map(|e| e.0).collect();
        assert_times(&jumps, &expected[..30], 1e-9);
    }
}

#[test]
fn a_guard_with_a_direction_fires_in_that_direction_alone() {
    use blocksim_block::Crossing::{Either, Falling, Rising};
    let Solver::Variable { method, rtol, atol, .. } = ode45() else { unreachable!() };
    let times = |crossing, max_step, f: fn(f64, f64) -> f64| {
        let solver = Solver::Variable { method, rtol, atol, max_step };
        let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
        let toy = toy.with("u", Function2(f), &["x", "x"]).with("count", Crossings(crossing), &["u"]);
        let schedule = toy.schedule(&["count"], 100.0, solver, Every(100.0));
        let mut tape = Tape::default();
        Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
        assert_eq!(tape.at(100.0, 0), tape.events.len() as f64);
        tape.events.iter().map(|event| event.0).collect::<Vec<f64>>()
    };
    let slow: fn(f64, f64) -> f64 = |x, _| (0.1 * x).cos();
    let quarter = 5.0 * std::f64::consts::PI;
    assert_times(&times(Either, 8.0, slow), &[quarter, 3.0 * quarter, 5.0 * quarter], 1e-9);
    assert_times(&times(Falling, 8.0, slow), &[quarter, 5.0 * quarter], 1e-9);
    assert_times(&times(Rising, 8.0, slow), &[3.0 * quarter], 1e-9);
    // Both crossings within one step.
    let dip: fn(f64, f64) -> f64 = |x, _| (x - 61.0) * (x - 61.5);
    assert_times(&times(Falling, f64::MAX, dip), &[61.0], 1e-9);
    assert_times(&times(Rising, f64::MAX, dip), &[61.5], 1e-9);
}

/// Both inputs above a half, as a number below or above zero.
fn both(a: f64, b: f64) -> f64 {
    if a > 0.5 && b > 0.5 { 1.0 } else { -1.0 }
}

#[test]
fn at_a_reset_from_outside_nobody_sees_the_new_trigger_beside_the_old_value() {
    use blocksim_block::Crossing::Rising;
    let toy = Toy::new()
        .with("trigger", StepAt(0.8), &[])
        .major("trigger")
        .with("watch", Stopwatch, &["trigger"])
        .with("both", Function2(both), &["trigger", "watch"])
        .with("count", Crossings(Rising), &["both"]);
    let schedule = toy.schedule(&["watch", "count"], 1.2, ode45(), Every(10.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    // Before the reset the trigger was low, after it the watch shows less than a half.
    assert_eq!(tape.at(1.2, 1), 0.0);
    let there: Vec<f64> = tape.rows.iter().filter(|row| row.0 == 0.8).map(|row| row.1[0]).collect();
    assert!(there.len() == 2 && (there[0] - 0.8).abs() < 1e-12 && there[1] == 0.0, "{there:?}");
    let jumps: Vec<&(f64, String)> = tape.events.iter().filter(|event| event.1 == "watch jumps").collect();
    assert!(jumps.len() == 1 && jumps[0].0 == 0.8, "{jumps:?}");
    assert!((tape.at(1.2, 0) - 0.4).abs() < 1e-12);
}

#[test]
fn a_sampled_trigger_resets_with_rows_on_both_sides() {
    let toy = Toy::new()
        .with("trigger", StepAt(0.7), &[])
        .major("trigger")
        .with("hold", Hold(0.25), &["trigger"])
        .with("watch", Stopwatch, &["hold"]);
    let schedule = toy.schedule(&["watch"], 1.0, ode45(), Every(10.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    let there: Vec<f64> = tape.rows.iter().filter(|row| row.0 == 0.75).map(|row| row.1[0]).collect();
    assert!(there.len() == 2 && (there[0] - 0.75).abs() < 1e-12 && there[1] == 0.0, "{there:?}");
}

#[test]
fn who_resets_itself_has_reached_its_limit_for_all_to_see() {
    use blocksim_block::Crossing::Rising;
    let toy = Toy::new()
        .with("full", Function2(|x, _| x - 1.0), &["watch", "watch"])
        .with("sign", Sign, &["full"])
        .with("watch", Stopwatch, &["sign"])
        .with("count", Crossings(Rising), &["sign"]);
    let schedule = toy.schedule(&["watch", "count"], 10.5, ode45(), Every(20.0));
    let mut tape = Tape::default();
    Simulation::new(schedule).unwrap().run(&mut tape).unwrap();
    assert_eq!(tape.at(10.5, 1), 10.0);
    assert!((tape.at(10.5, 0) - 0.5).abs() < 1e-9, "{}", tape.at(10.5, 0));
}

#[test]
fn events_that_come_faster_and_faster_without_end_are_an_error_and_not_a_fall_through_the_floor() {
    let ball = Ball { height: 10.0, restitution: 0.8 };
    let schedule = Toy::new().with("ball", ball, &[]).schedule(&["ball.h"], 14.0, ode45(), Every(0.1));
    let mut tape = Tape::default();
    let error = Simulation::new(schedule).unwrap().run(&mut tape).unwrap_err();
    assert_eq!((error.code, error.path.as_deref()), ("endless_events", Some("ball")));
    let fall = (2.0 * 10.0 / GRAVITY).sqrt();
    let end = fall + 2.0 * fall * 0.8 / 0.2;
    assert!(error.t < end && error.t > end - 1e-6, "{} and not {end}", error.t);
    assert!(tape.rows.iter().all(|row| row.1[0] > -1e-12), "rows so far are kept and right");
    assert!(tape.rows.len() > 120);
}
