//! Conditions that must not be passed over, however long the steps are.

use blocksim_block::Crossing;
use blocksim_block::schedule::OutputTimes::Every;
use blocksim_block::schedule::{Solver, VariableMethod};
use blocksim_sim::{Counts, Simulation};

use crate::toys::*;

fn solver(method: VariableMethod, max_step: f64) -> Solver {
    Solver::Variable { method, rtol: 1e-6, atol: Some(1e-9), max_step }
}

fn run(toy: Toy, recorded: &[&str], stop: f64, solver: Solver) -> (Tape, Counts) {
    let mut tape = Tape::default();
    let mut sim = Simulation::new(toy.schedule(recorded, stop, solver, Every(stop))).unwrap();
    sim.run(&mut tape).unwrap();
    (tape, sim.counts())
}

/// A sine of `frequency` less `level`, its sign, and the integral of that.
fn sign_of_sine(frequency: f64, level: f64) -> Toy {
    Toy::new()
        .with("sine", Sine(frequency), &[])
        .with("level", Constant(level), &[])
        .with("over", Function2(|u, level| u - level), &["sine", "level"])
        .with("sign", Sign, &["over"])
        .with("x", Integrator(0.0), &["sign"])
}

#[test]
fn each_swing_of_a_sine_is_seen_where_nothing_else_moves() {
    // A share of acos(level)/pi of each period lies above the level.
    for level in [0.0, 0.5, 0.95, 0.999, -0.9999] {
        let share = f64::acos(level) / std::f64::consts::PI;
        for method in METHODS {
            let (tape, _) = run(sign_of_sine(7.0, level), &["x"], 10.0, solver(method, f64::INFINITY));
            let expected = 10.0 * (2.0 * share - 1.0);
            // At the start the sine is zero and rises.
            let events = if level == 0.0 { 139 } else { 140 };
            assert!((tape.at(10.0, 0) - expected).abs() < 1e-9, "{method:?} {level}: {}", tape.at(10.0, 0));
            assert!(tape.events.len().abs_diff(events) <= 1, "{method:?} {level}: {}", tape.events.len());
        }
    }
}

#[test]
fn a_source_that_nobody_looks_at_limits_no_step() {
    let toy = Toy::new().with("sine", Sine(1e6), &[]).with("one", Constant(1.0), &[]);
    let toy = toy.with("x", Integrator(0.0), &["one"]).not_minor("sine");
    let (_, counts) = run(toy, &["x", "sine"], 1.0, solver(VariableMethod::Ode45, f64::INFINITY));
    assert!(counts.accepted < 100, "{counts:?}");
}

#[test]
fn a_guard_that_swings_faster_than_its_state_is_followed() {
    // sin(40 x) with x' = 1: the step control sees a straight line.
    for method in METHODS {
        let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
        let toy = toy.with("u", Function2(|x, _| (40.0 * x).sin() - 0.3), &["x", "x"]);
        let (tape, _) = run(toy.with("sign", Sign, &["u"]), &["sign"], 10.0, solver(method, f64::INFINITY));
        // 400 rad: 63 swings and two thirds of one, of which each rises above the level and falls below it.
        assert_eq!(tape.events.len(), 128, "{method:?}");
    }
}

#[test]
fn what_depends_on_time_alone_is_sampled_until_nothing_can_hide() {
    // Two lobes of 10 and 15 ms within a second, in a run without states: (t - a)(t - b) near a and b.
    let hidden = |t: f64, _: f64| (t - 0.313) * (t - 0.328) * (t - 0.771) * (t - 0.781);
    let toy = Toy::new().with("t", Time, &[]).with("u", Function2(hidden), &["t", "t"]);
    let (tape, _) =
        run(toy.with("sign", Sign, &["u"]), &["sign"], 1.0, solver(VariableMethod::Ode45, f64::INFINITY));
    let times: Vec<f64> = tape.events.iter().map(|event| event.0).collect();
    assert_eq!(times.len(), 4, "{times:?}");
    for (time, expected) in times.iter().zip([0.313, 0.328, 0.771, 0.781]) {
        assert!((time - expected).abs() < 1e-9, "{times:?}");
    }
}

#[test]
fn a_guard_that_rests_on_zero_and_leaves_it_within_a_step_is_seen() {
    // max(0, x - 3) rests on zero for three seconds; its negative leaves it downwards.
    for sign in [1.0, -1.0] {
        let toy = Toy::new().with("one", Constant(sign), &[]).with("x", Integrator(0.0), &["one"]);
        let rest: fn(f64, f64) -> f64 = |x, _| if x.abs() > 3.0 { x - 3.0 * x.signum() } else { 0.0 };
        let toy = toy.with("u", Function2(rest), &["x", "x"]).with("sign", Sign, &["u"]);
        let toy = toy.with("y", Integrator(0.0), &["sign"]);
        let (tape, _) = run(toy, &["y"], 10.0, solver(VariableMethod::Ode45, f64::MAX));
        // The sign of zero is one.
        let expected = if sign > 0.0 { 10.0 } else { 3.0 - 7.0 };
        assert!((tape.at(10.0, 0) - expected).abs() < 1e-6, "{sign}: {}", tape.at(10.0, 0));
    }
}

/// Beside it something a million times faster, that a stiff method lets be: nothing explicit may get so far.
#[test]
fn a_guard_that_leaves_its_rest_within_a_stiff_step_leaves_fast_states_where_they_are() {
    for method in
        [VariableMethod::Ode15s, VariableMethod::Radau5, VariableMethod::Rodas4, VariableMethod::Ode23tb]
    {
        // Somewhere in a step of each of them, be it near its start or near its end.
        for level in 0..20 {
            let level = 2.0 + 0.1 * f64::from(level);
            let toy = Toy::new().with("one", Constant(1.0), &[]).with("level", Constant(level), &[]);
            let toy = toy.with("x", Integrator(0.0), &["one"]);
            let rest: fn(f64, f64) -> f64 = |x, level| if x > level { level - x } else { 0.0 };
            let toy = toy.with("u", Function2(rest), &["x", "level"]).with("sign", Sign, &["u"]);
            let toy = toy.with("lag", Function2(|x, fast| 1e6 * (x.sin() - fast)), &["x", "fast"]);
            let toy = toy.with("fast", Integrator(0.0), &["lag"]).with("z", Integrator(0.0), &["fast"]);
            let toy = toy.with("y", Integrator(0.0), &["sign"]);
            let (tape, _) = run(toy, &["y", "z"], 10.0, solver(method, f64::MAX));
            let (y, z) = (tape.at(10.0, 0), tape.at(10.0, 1));
            assert!((y - (2.0 * level - 10.0)).abs() < 1e-6, "{method:?}, {level}: {y}");
            assert!((z - (1.0 - 10.0_f64.cos())).abs() < 1e-3, "{method:?}, {level}: {z}");
        }
    }
}

#[test]
fn no_step_is_longer_than_a_fiftieth_of_the_run_unless_the_settings_say_so() {
    let toy = || Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
    let accepted = |max_step| run(toy(), &["x"], 10.0, solver(VariableMethod::Ode45, max_step)).1.accepted;
    assert!((50..70).contains(&accepted(f64::INFINITY)), "{}", accepted(f64::INFINITY));
    assert!(accepted(f64::MAX) < 20);
    assert!(accepted(0.01) >= 1000);
}

/// x' = 1 and a dip of 1.4 s in a guard, around a third of the run.
fn dip() -> Toy {
    let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
    let toy = toy.with("u", Function2(|x, _| 1.0 - 2.0 * (-(x - 57.0) * (x - 57.0)).exp()), &["x", "x"]);
    toy.with("sign", Sign, &["u"])
}

#[test]
fn an_audit_finds_what_long_steps_have_passed_over() {
    let audited = |toy: Toy, solver| {
        let mut tape = Tape::default();
        let mut sim = Simulation::new(toy.schedule(&["x", "sign"], 100.0, solver, Every(100.0))).unwrap();
        let is_audited = sim.audit();
        sim.run(&mut tape).unwrap();
        (is_audited, tape.bits(), tape.events.len(), sim.findings())
    };
    let (_, _, events, findings) = audited(dip(), solver(VariableMethod::Ode45, f64::MAX));
    let findings = findings.unwrap();
    assert_eq!((events, findings.count), (0, 2), "{findings:?}");
    assert_eq!(
        (findings.missed[0].path.as_str(), findings.missed[0].what.as_str()),
        ("sign", "crosses zero at its guard `zero`")
    );
    assert!((findings.missed[0].t - 57.0).abs() < 0.9, "{findings:?}");
    // The default finds both crossings by itself, and an audit changes nothing.
    for method in METHODS {
        let (_, bits, events, findings) = audited(dip(), solver(method, f64::INFINITY));
        let findings = findings.unwrap();
        assert_eq!((events, findings.count), (2, 0), "{method:?}: {findings:?}");
        assert!(findings.looks > 3000);
        let (tape, _) = run(dip(), &["x", "sign"], 100.0, solver(method, f64::INFINITY));
        assert_eq!(tape.bits(), bits);
    }
    assert!(!audited(dip(), ode4(0.1)).0);
}

#[test]
fn a_dependency_that_a_block_does_not_declare_is_found() {
    let pairs = |toy: Toy| {
        let mut sim = Simulation::new(toy.schedule(&["x"], 1.0, ode45(), Every(1.0))).unwrap();
        sim.audit();
        sim.run_until(0.5, &mut Tape::default()).unwrap();
        let pairs = sim.findings().unwrap().undeclared.into_iter();
        pairs.map(|pair| (pair.derivative, pair.state)).collect::<Vec<_>>()
    };
    let toy = Toy::new().with("liar", Liar(-2.0), &["gain"]).with("y", Integrator(1.0), &["liar"]);
    let toy = toy.with("x", Integrator(1.0), &["y"]).with("gain", Gain(3.0), &["x"]);
    assert_eq!(pairs(toy), [("y.x".to_owned(), "x.x".to_owned())]);
    let toy = Toy::new().with("honest", Gain(-2.0), &["gain"]).with("y", Integrator(1.0), &["honest"]);
    assert!(pairs(toy.with("x", Integrator(1.0), &["y"]).with("gain", Gain(3.0), &["x"])).is_empty());
}

#[test]
fn a_dip_is_seen_in_a_step_at_whose_end_another_guard_has_crossed() {
    // The sign of `dip` changes twice just behind 30 s, that of `late` once at 31 s; steps are seconds long.
    for method in METHODS {
        let toy = Toy::new().with("one", Constant(1.0), &[]).with("x", Integrator(0.0), &["one"]);
        let toy = toy.with("u", Function2(|x, _| (x - 30.0) * (x - 30.1)), &["x", "x"]);
        let toy = toy.with("v", Function2(|x, _| x - 31.0), &["x", "x"]);
        let toy = toy.with("dip", Sign, &["u"]).with("late", Sign, &["v"]);
        let (tape, _) = run(toy, &["dip"], 100.0, solver(method, f64::MAX));
        let names: Vec<&str> = tape.events.iter().map(|event| event.1.as_str()).collect();
        assert_eq!(names, ["dip zero", "dip zero", "late zero"], "{method:?}");
    }
}

#[test]
fn a_mode_that_touches_zero_hides_no_crossing_behind() {
    // The first guard touches zero, on the side where its mode holds; another one crosses later in the same long step.
    let touches = |t: f64, _: f64| {
        let square = (t - 0.313) * (t - 0.313);
        if square < 1e-4 { 0.0 } else { square }
    };
    let toy = Toy::new().with("t", Time, &[]).with("touches", Function2(touches), &["t", "t"]);
    let toy = toy.with("holds", Crossings(Crossing::Holds), &["touches"]);
    let toy = toy.with("u", Function2(|t, _| t - 0.771), &["t", "t"]).with("sign", Sign, &["u"]);
    let toy = toy.with("x", Integrator(0.0), &["sign"]);
    for method in METHODS {
        let toy = toy.clone();
        let (tape, _) = run(toy, &["x"], 1.0, solver(method, f64::INFINITY));
        let times: Vec<f64> = tape.events.iter().map(|event| event.0).collect();
        assert!(times.len() == 1 && (times[0] - 0.771).abs() < 1e-12, "{method:?}: {times:?}");
        assert!((tape.at(1.0, 0) - (1.0 - 2.0 * 0.771)).abs() < 1e-12, "{method:?}: {}", tape.at(1.0, 0));
    }
}
