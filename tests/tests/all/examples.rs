//! The small diagrams that teach one idea each, against closed forms and reference values.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::{Path, PathBuf};

use blocksim_block::schedule::{OutputTimes, Schedule, Solver, VariableMethod};
use blocksim_tests::{Run, close, compile_file, compile_text, root, run, run_file};

/// A diagram with other settings than its own.
fn run_with(path: &str, change: impl FnOnce(&mut Schedule)) -> Run {
    let (compiled, problems) = compile_file(path, &[]);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    change(&mut schedule);
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

fn ode45(tolerance: f64) -> Solver {
    Solver::Variable {
        method: VariableMethod::Ode45,
        rtol: tolerance,
        atol: Some(tolerance),
        max_step: f64::INFINITY,
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn smallest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn the_servo_settles_at_ninety_degrees() {
    let run = run_file("diagrams/servo.ron", &[]);
    // The slow integral part (ki / kp = 0.25 1/s) leaves a few tenths of a degree after two seconds.
    close(run.last("angle.actual").to_degrees(), 90.0, 0.5, "angle in degrees");
    assert!(run.column("angle.actual")[0] == 0.0, "it starts elsewhere");
}

#[test]
fn the_servo_runs_away_with_a_gear_that_reverses() {
    let run = run_file("diagrams/servo.ron", &["gear.direction=Reversed"]);
    // The voltage limit holds the speed at 48 V / 0.22 V s / 50 = 4.4 rad/s, so the load makes at least one turn back.
    assert!(
        run.last("angle.actual").to_degrees() < -360.0,
        "{} degrees",
        run.last("angle.actual").to_degrees()
    );
}

/// `L i' = v - R i - k w` and `J w' = k i` are an oscillator of second order with decay `a` and frequency `wd`.
#[test]
fn the_dc_motor_starts_as_its_closed_form_says() {
    let (r, l, k, j, v, start) = (1.5, 2.5e-3, 0.22, 5e-5, 24.0, 1e-3);
    let a = r / (2.0 * l);
    let wd = f64::sqrt(k * k / (l * j) - a * a);
    let run = run_file("diagrams/dc_motor_start.ron", &[]);
    let rows = run.time.iter().zip(run.column("current.i")).zip(run.column("speed.w"));
    let mut after = 0;
    for ((t, i), w) in rows {
        let since = (t - start).max(0.0);
        let (sin, cos) = (wd * since).sin_cos();
        let decay = f64::exp(-a * since);
        // At a relative tolerance of 1e-8 and some hundred steps, of values around 100.
        close(*i, v / (l * wd) * decay * sin, 1e-5, &format!("current at {t} s"));
        close(*w, v / k * (1.0 - decay * (cos + a / wd * sin)), 1e-5, &format!("speed at {t} s"));
        after += usize::from(*t > start);
    }
    assert!(after > 20, "only {after} rows lie after the switch");
    assert!(run.time.contains(&start), "the switch is hit exactly");
}

/// Reference: the same equations in phase quantities, computed independently with a fixed step of 50 us.
#[test]
fn the_asynchronous_machine_runs_up_as_the_reference_does() {
    let run = run_with("diagrams/asm_direct_on_line.ron", |schedule| {
        schedule.settings.output = OutputTimes::Every(50e-6);
    });
    let reference = [
        (0.005, 0.2142, 18.999),
        (0.01, 3.2647, 102.776),
        (0.02, 7.3350, -56.699),
        (0.05, 17.8017, 26.009),
        (0.1, 29.4541, 75.113),
        (0.2, 53.1758, 15.282),
        (0.5, 167.6186, 47.451),
        (0.9, 375.7814, 4.190),
    ];
    for (t, w, torque) in reference {
        // Printed to four and three places; the rest is the error of the reference's step.
        close(run.at("speed.w", t), w, 2e-4, &format!("speed at {t} s"));
        close(run.at("torque.tau", t), torque, 2e-3, &format!("torque at {t} s"));
    }
    // Extremes of a swing of 60 Hz, looked at every 50 us: off by less than (0.5 * 50 us * 377 rad/s)^2 / 2 of 100 N m.
    close(largest(run.column("torque.tau")), 117.38, 0.01, "largest torque");
    close(smallest(run.column("torque.tau")), -63.52, 0.01, "smallest torque");
}

/// Arithmetic-geometric mean: `K(k) = pi / (2 agm(1, sqrt(1 - k^2)))`.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..8 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    a
}

const GRAVITY: f64 = 9.80665;

#[test]
fn the_pendulum_swings_with_the_period_of_the_elliptic_integral() {
    let (length, amplitude, swings) = (1.0, FRAC_PI_2, 5.0);
    let small = 2.0 * PI * f64::sqrt(2.0 * length / (3.0 * GRAVITY));
    let period = small / agm(1.0, f64::cos(amplitude / 2.0));
    let run = run_with("diagrams/pendulum.ron", |schedule| {
        schedule.settings.stop_time = swings * period;
        schedule.settings.solver = ode45(1e-10);
    });
    // At the turning point the angle is blind to an error of time, the speed is not: w = 3 g / (2 L) times the error.
    let late = run.last("speed.w") / (1.5 * GRAVITY / length);
    close(late / swings, 0.0, 1e-8, "error of one period, s");
    close(run.last("angle.q"), amplitude, 1e-8, "angle after five swings");
}

#[test]
fn the_pendulum_keeps_its_energy() {
    // One swing at 1e-9, and five at 1e-10: what is lost grows with the number of steps, some forty a swing.
    for (tolerance, stop) in [(1e-9, 1.9), (1e-10, 10.0)] {
        let run = run_with("diagrams/pendulum.ron", |schedule| {
            schedule.settings.solver = ode45(tolerance);
            schedule.settings.stop_time = stop;
        });
        // The energy is zero at the start (horizontal, at rest), so it is compared with the depth of the fall, m g L / 2.
        let depth = GRAVITY / 2.0;
        let rows = run.column("angle.q").iter().zip(run.column("speed.w"));
        let worst =
            largest(&rows.map(|(q, w)| (w * w / 6.0 - depth * q.cos()).abs() / depth).collect::<Vec<_>>());
        assert!(worst < 1e-8, "at a tolerance of {tolerance} the energy drifts by {worst}");
        assert!(smallest(run.column("angle.q")) < -1.5, "it does not swing");
    }
}

#[test]
fn the_mass_bounces_at_the_times_of_the_closed_form() {
    let run = run_file("diagrams/bouncing_mass.ron", &[]);
    let first = f64::sqrt(2.0 * 10.0 / GRAVITY);
    let expected = (0..).scan((first, 2.0 * first), |(t, flight), _| {
        let now = *t;
        *flight *= 0.8;
        *t += *flight;
        Some(now)
    });
    let expected: Vec<f64> = expected.take_while(|t| *t < 10.0).collect();
    let impacts: Vec<f64> = run
        .events
        .iter()
        .filter(|(_, path, what)| path == "velocity" && what == "is reset")
        .map(|(t, ..)| *t)
        .collect();
    assert_eq!(impacts.len(), expected.len(), "{:?}", run.events);
    for (found, expected) in impacts.iter().zip(&expected) {
        // The law is a parabola, which the method integrates without error; what is left is rounding.
        close(*found, *expected, 1e-9, "time of an impact");
    }
    assert!(smallest(run.column("height_scope.h")) > -1e-9, "the mass falls through the floor");
}

#[test]
fn the_charger_keeps_its_current_and_then_its_voltage() {
    let run = run_file("diagrams/charger/charger.ron", &[]);
    // 2 A on 2000 F from 3 V until the terminals are at 4.2 V, with 0.1 V at 50 mohm; then the current falls with R C = 100 s.
    let change = (4.2 - 0.1 - 3.0) * 2000.0 / 2.0;
    let current = |t: f64| if t < change { 2.0 } else { 2.0 * (-(t - change) / 100.0).exp() };
    for (t, i) in run.time.iter().zip(run.column("result.current")) {
        close(*i, current(*t), 1e-6, "current");
    }
    for (v, i) in run.column("plane.x").iter().zip(run.column("plane.y")) {
        close(*i, (4.2 - v).min(0.1) / 0.05, 1e-6, "current over voltage");
    }
    let changes: Vec<_> = run.events.iter().filter(|(_, path, _)| path == "steady_voltage").collect();
    assert_eq!(changes.len(), 1, "{changes:?}");
    close(changes[0].0, change, 1e-6, "time of the change");
}

#[test]
fn clamping_takes_most_of_the_overshoot_away() {
    let run = run_file("diagrams/pid_anti_windup.ron", &[]);
    let (free, clamped) =
        (largest(run.column("result.free")) - 1.0, largest(run.column("result.clamped")) - 1.0);
    assert!(free > 0.3, "without protection it overshoots by {free}");
    assert!(clamped < 0.5 * free, "clamped it overshoots by {clamped}, free by {free}");
    for column in ["effort.free", "effort.clamped"] {
        assert!(
            largest(run.column(column)) <= 1.5 && smallest(run.column(column)) >= -1.5,
            "{column} leaves its limits"
        );
    }
    // Both have an integral part: no error stays.
    close(run.last("result.clamped"), 1.0, 0.01, "end, clamped");
}

/// Current, angular speed and position of the axis, and their derivatives at a voltage; written for the one shaft that
/// everything is rigidly coupled to. Last the force in the nut.
fn ball_screw_axis([i, w, _]: [f64; 3], voltage: f64) -> ([f64; 3], f64) {
    let (r, l, k, j, mass, lead) = (0.6, 0.8e-3, 0.06, 5e-5, 30.0, 0.01 / (2.0 * PI));
    let v = lead * w;
    let x = v / (2e-3 * f64::sqrt(2.0));
    let stribeck = f64::sqrt(2.0 * std::f64::consts::E) * 10.0 * x * (-x * x).exp();
    let friction = stribeck + 30.0 * (v / 2e-4).tanh() + 100.0 * v;
    // The torque into the screw is that of the nut over a share which depends on who drives whom.
    let acceleration = |share: f64| (k * i - lead * friction / share) / (j + lead * lead * mass / share);
    let onset = w.abs().tanh();
    let (forward, backward) = (1.0 - 0.1 * onset, 1.0 + (1.0 / 0.85 - 1.0) * onset);
    let drives = (k * i - j * acceleration(forward)) * w >= 0.0;
    let dw = acceleration(if drives { forward } else { backward });
    ([(voltage - r * i - k * w) / l, dw, v], mass * lead * dw + friction)
}

#[test]
fn the_ball_screw_axis_moves_as_its_equations_integrated_by_hand() {
    let run = run_with("diagrams/ball_screw_axis.ron", |schedule| {
        schedule.settings.output = OutputTimes::Every(20e-3);
    });
    // The classical method of order four with steps of 5 us; both steps of the voltage are hit exactly.
    let h = 5e-6;
    let mut state = [0.0; 3];
    let mut rows = vec![(0.0, state, 0.0)];
    for step in 0..120_000_u32 {
        let t = f64::from(step) * h;
        let voltage = if (2_000..80_000).contains(&step) { 24.0 } else { 0.0 };
        let at = |k: [f64; 3], c: f64| {
            ball_screw_axis(std::array::from_fn(|n| state[n] + c * h * k[n]), voltage).0
        };
        let k1 = at([0.0; 3], 0.0);
        let k2 = at(k1, 0.5);
        let k3 = at(k2, 0.5);
        let k4 = at(k3, 1.0);
        state = std::array::from_fn(|n| state[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]));
        if step % 4_000 == 3_999 {
            rows.push((t + h, state, ball_screw_axis(state, voltage).1));
        }
    }
    assert_eq!(rows.len(), 31);
    for (t, [i, w, x], force) in rows {
        // A relative tolerance of 1e-7 along some hundred steps; the friction makes the force most sensitive.
        close(run.at("current.i", t), i, 3e-6, &format!("current at {t} s"));
        close(run.at("speed.v", t), w * 0.01 / (2.0 * PI), 4e-8, &format!("speed at {t} s"));
        close(run.at("position.x", t), x, 5e-9, &format!("position at {t} s"));
        close(run.at("force.f", t), force, 1e-4, &format!("force at {t} s"));
    }
}

/// All files below a folder that end in `.ron`.
fn files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in
        std::fs::read_dir(folder).expect("a folder of the project").map(|entry| entry.expect("an entry"))
    {
        let path = entry.path();
        if path.is_dir() {
            files(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "ron") {
            into.push(path);
        }
    }
}

/// Every text in quotes behind this word.
fn quoted_behind<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    text.split(word)
        .skip(1)
        .filter_map(|rest| rest.trim_start().strip_prefix('"')?.split('"').next())
        .collect()
}

/// `"drive": Choice(default: "asm", of: ["asm", "dc"])` as name and alternatives.
fn choices(text: &str) -> Vec<(&str, Vec<&str>)> {
    let pieces: Vec<&str> = text.split("Choice(").collect();
    pieces
        .windows(2)
        .filter_map(|pair| {
            let name =
                pair[0].trim_end().strip_suffix(':')?.trim_end().strip_suffix('"')?.rsplit('"').next()?;
            let list = pair[1].split("of:").nth(1)?.split(']').next()?;
            Some((name, list.split('"').skip(1).step_by(2).collect()))
        })
        .collect()
}

/// One `--set` for each choice, in all combinations.
fn combinations(choices: &[(&str, Vec<&str>)]) -> Vec<Vec<String>> {
    choices.iter().fold(vec![Vec::new()], |sets, (name, alternatives)| {
        let with = |set: &Vec<String>, one: &str| [set.as_slice(), &[format!("{name}={one}")]].concat();
        sets.iter().flat_map(|set| alternatives.iter().map(move |one| with(set, one))).collect()
    })
}

#[test]
fn every_diagram_compiles_without_any_problem_under_every_choice() {
    let folder = root().join("diagrams");
    let mut paths = Vec::new();
    files(&folder, &mut paths);
    let texts: Vec<(PathBuf, String)> = paths
        .into_iter()
        .map(|path| (path.clone(), std::fs::read_to_string(path).expect("a text")))
        .collect();
    let beside = |path: &Path, name: &str| path.with_file_name(name);
    let parts: BTreeSet<PathBuf> = texts
        .iter()
        .flat_map(|(path, text)| quoted_behind(text, "file:").into_iter().map(move |name| beside(path, name)))
        .collect();
    let mut seen = BTreeSet::new();
    let mut combined = 0;
    for (path, text) in &texts {
        let bare = text.lines().find(|line| !line.trim_start().starts_with("//") && !line.trim().is_empty());
        if parts.contains(path) || !bare.is_some_and(|line| line.starts_with("Diagram(")) {
            continue;
        }
        let shown = path.strip_prefix(root()).expect("a file of the project").display().to_string();
        for sets in combinations(&choices(text)) {
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let (compiled, problems) = compile_file(&shown, &sets);
            assert!(problems.is_empty() && compiled.schedule.is_some(), "{shown} with {sets:?}:\n{problems}");
            combined += 1;
        }
        seen.insert(shown);
    }
    for file in [
        "servo",
        "dc_motor_start",
        "asm_direct_on_line",
        "pendulum",
        "double_pendulum",
        "four_bar",
        "bouncing_mass",
        "irb2600/irb2600",
    ] {
        assert!(seen.contains(&format!("diagrams/{file}.ron")), "{file} was not looked at: {seen:?}");
    }
    assert!(combined >= seen.len() + 2, "the choices were not tried: {combined} of {seen:?}");
}

#[test]
fn every_part_is_used_by_some_diagram_or_page() {
    let folder = root().join("diagrams");
    let mut paths = Vec::new();
    files(&folder, &mut paths);
    let read = |path: &PathBuf| std::fs::read_to_string(path).expect("a text");
    let texts: Vec<String> = paths.iter().map(read).collect();
    let pages =
        std::fs::read_dir(root().join("docs")).expect("the manual").map(|page| page.expect("a page").path());
    let pages: Vec<String> = pages
        .filter(|page| page.extension().is_some_and(|ending| ending == "md"))
        .map(|page| read(&page))
        .collect();
    for (path, text) in paths.iter().zip(&texts) {
        let offers =
            ["\n    inputs:", "\n    outputs:", "\n    ports:"].iter().any(|section| text.contains(section));
        let is_data = !text.contains("Diagram(");
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let named = texts.iter().any(|other| other.contains(&format!("{name}\"")));
        let place = path.strip_prefix(root()).expect("below the root").display().to_string();
        let shown = pages.iter().any(|page| page.contains(&place));
        assert!(!(offers || is_data) || named || shown, "nothing uses {place}");
    }
}

#[test]
fn limits_of_a_controller_that_never_reaches_them_cost_nothing() {
    // The sign of an error of 1e-30 flickers; away from the limits that must be no event.
    let text = std::fs::read_to_string(root().join("diagrams/pmsm_foc.ron")).expect("a file");
    let limits = "lower: \"-150 V\", upper: \"150 V\", anti_windup: Clamping, ";
    let limited = ["pi_d", "pi_q"].iter().fold(text.clone(), |text, name| {
        text.replace(&format!("\"{name}\": Pid("), &format!("\"{name}\": Pid({limits}"))
    });
    assert_ne!(text, limited);
    let (compiled, problems) = compile_text(&limited);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);
    assert!(run.events.len() < 50, "{} events", run.events.len());
}

#[test]
fn a_permanent_magnet_machine_reaches_its_speed_under_load() {
    let run = run_file("diagrams/pmsm_foc.ron", &[]);
    assert!((run.last("speeds.actual") - 157.0796).abs() < 0.01, "{}", run.last("speeds.actual"));
}

#[test]
fn a_cascade_of_current_and_speed_control_holds_the_speed_of_a_motor() {
    let run = run_file("diagrams/dc_motor_speed_control.ron", &[]);
    let (set, actual) = (run.last("speeds.set"), run.last("speeds.actual"));
    assert!((actual - set).abs() < 1e-3 * set, "{actual} rad/s instead of {set}");
    let peak = run.column("currents.set").iter().fold(0.0_f64, |peak, i| peak.max(*i));
    assert!((peak - 15.0).abs() < 1e-6, "the speed controller asks for {peak} A at most");
}

/// Two rods on hinges: Lagrange's equations in absolute angles, `a t1'' + c cos(d) t2'' = ...` with `d = t1 - t2`.
struct TwoRods {
    a: f64,
    b: f64,
    c: f64,
    weight: [f64; 2],
}

impl TwoRods {
    fn new([l1, l2]: [f64; 2], [m1, m2]: [f64; 2]) -> Self {
        Self {
            a: (m1 / 3.0 + m2) * l1 * l1,
            b: m2 * l2 * l2 / 3.0,
            c: m2 * l1 * l2 / 2.0,
            weight: [GRAVITY * (m1 / 2.0 + m2) * l1, GRAVITY * m2 * l2 / 2.0],
        }
    }

    /// Derivatives of both angles and both speeds.
    fn slope(&self, [t1, t2, w1, w2]: [f64; 4]) -> [f64; 4] {
        let (sin, cos) = (t1 - t2).sin_cos();
        let f1 = -self.c * sin * w2 * w2 - self.weight[0] * t1.sin();
        let f2 = self.c * sin * w1 * w1 - self.weight[1] * t2.sin();
        let k = self.c * cos;
        let det = self.a * self.b - k * k;
        [w1, w2, (self.b * f1 - k * f2) / det, (self.a * f2 - k * f1) / det]
    }

    fn energy(&self, [t1, t2, w1, w2]: [f64; 4]) -> f64 {
        0.5 * (self.a * w1 * w1 + self.b * w2 * w2) + self.c * w1 * w2 * (t1 - t2).cos()
            - self.weight[0] * t1.cos()
            - self.weight[1] * t2.cos()
    }
}

#[test]
fn the_double_pendulum_swings_as_its_equations_say_and_keeps_its_energy() {
    let rods = TwoRods::new([0.5, 0.3], [2.0, 1.0]);
    let run = run_file("diagrams/double_pendulum.ron", &[]);
    // Absolute angles from the joints, whose second is counted against the first.
    let state = |i: usize| {
        let [q1, q2, w1, w2] =
            ["angle.upper", "angle.lower", "speed.upper", "speed.lower"].map(|name| run.column(name)[i]);
        [q1, q1 + q2, w1, w1 + w2]
    };
    let (mut x, h) = (state(0), 1e-4);
    let ahead = |x: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| x[i] + h * k[i]);
    for step in 1..=20_000 {
        let k1 = rods.slope(x);
        let k2 = rods.slope(ahead(x, k1, h / 2.0));
        let k3 = rods.slope(ahead(x, k2, h / 2.0));
        let k4 = rods.slope(ahead(x, k3, h));
        x = [0, 1, 2, 3].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if step % 5000 == 0 {
            // The tolerance of 1e-10 a step, some hundred steps, and what the motion multiplies it by within 2 s.
            let found = state(step / 100);
            (0..4).for_each(|i| close(found[i], x[i], 1e-6, &format!("part {i} after {step} steps")));
        }
    }
    // Against the depth of the fall of both rods.
    let (start, depth) = (rods.energy(state(0)), rods.weight[0] + rods.weight[1]);
    let worst =
        (0..run.time.len()).map(|i| (rods.energy(state(i)) - start).abs() / depth).fold(0.0, f64::max);
    assert!(worst < 1e-8, "the energy drifts by {worst}");
    let [x, z] = ["path.x[0]", "path.x[2]"].map(|name| run.column(name)[100]);
    let [t1, t2, ..] = state(100);
    close(x, -0.5 * t1.sin() - 0.3 * t2.sin(), 1e-12, "x of the tip");
    close(z, -0.5 * t1.cos() - 0.3 * t2.cos(), 1e-12, "z of the tip");
}

/// A four-bar linkage of uniform bars: what follows from the angle of the crank.
struct FourBar {
    /// Crank, coupler, rocker, ground, m.
    bars: [f64; 4],
    /// kg/m
    density: f64,
    /// Side of the knee: 1 or -1.
    side: f64,
}

impl FourBar {
    /// Angles of coupler and rocker, by the triangle of elbow, knee and pivot.
    fn angles(&self, crank: f64) -> [f64; 2] {
        let [a, b, c, d] = self.bars;
        let (x, z) = (d - a * crank.cos(), -a * crank.sin());
        let length = x.hypot(z);
        let corner = ((b * b + length * length - c * c) / (2.0 * b * length)).acos();
        let coupler = z.atan2(x) + self.side * corner;
        [coupler, (b * coupler.sin() - z).atan2(b * coupler.cos() - x)]
    }

    /// Speed of the rocker over that of the crank; moment of inertia at the crank; potential energy.
    fn reduced(&self, crank: f64) -> (f64, f64, f64) {
        let [a, b, c, _] = self.bars;
        let [coupler, rocker] = self.angles(crank);
        let k3 = a * (crank - rocker).sin() / (b * (rocker - coupler).sin());
        let k4 = a * (crank - coupler).sin() / (c * (rocker - coupler).sin());
        let [m1, m2, m3] = [a, b, c].map(|length| self.density * length);
        let x = -a * crank.sin() - 0.5 * b * k3 * coupler.sin();
        let z = a * crank.cos() + 0.5 * b * k3 * coupler.cos();
        let inertia =
            m1 * a * a / 3.0 + m2 * (x * x + z * z + b * b * k3 * k3 / 12.0) + m3 * c * c * k4 * k4 / 3.0;
        let height = m1 * 0.5 * a * crank.sin()
            + m2 * (a * crank.sin() + 0.5 * b * coupler.sin())
            + m3 * 0.5 * c * rocker.sin();
        (k4, inertia, GRAVITY * height)
    }
}

#[test]
fn the_four_bar_linkage_turns_as_its_energy_says() {
    let run = run_file("diagrams/four_bar.ron", &[]);
    let [crank, rocker] = ["angle.crank", "angle.rocker"].map(|name| run.column(name));
    let [speed, follows] = ["speed.crank", "speed.rocker"].map(|name| run.column(name));
    assert_eq!((crank[0], speed[0]), (60.0_f64.to_radians(), 15.0), "the start values that are given");
    let turned = |angle: f64| angle - 2.0 * PI * (angle / (2.0 * PI)).round();
    let bars = |side| FourBar { bars: [0.2, 0.45, 0.4, 0.5], density: 4.0, side };
    // It may be mounted either way.
    let side =
        [1.0, -1.0].into_iter().find(|s| turned(bars(*s).angles(crank[0])[1] - rocker[0]).abs() < 1e-9);
    let linkage = bars(side.expect("a linkage that closes"));
    let (_, inertia, potential) = linkage.reduced(crank[0]);
    let energy = 0.5 * inertia * 15.0 * 15.0 + potential;
    for i in 0..run.time.len() {
        let (k4, inertia, potential) = linkage.reduced(crank[i]);
        // The gap of the loop stays at the error of a few steps (1e-9 each), and so does what follows from it.
        close(turned(rocker[i] - linkage.angles(crank[i])[1]), 0.0, 1e-7, "angle of the rocker");
        close(follows[i], k4 * speed[i], 1e-6, "speed of the rocker");
        close(speed[i], (2.0 * (energy - potential) / inertia).sqrt(), 1e-5, "speed of the crank");
        let drift = (0.5 * inertia * speed[i] * speed[i] + potential - energy) / energy;
        assert!(drift.abs() < 1e-6, "after {} s the energy has drifted by {drift}", run.time[i]);
    }
    assert!(crank[run.time.len() - 1] > 20.0, "the crank turns fully");
}

/// Times at which something happened to a part: `bearing sticks`.
fn times(run: &Run, part: &str, what: &str) -> Vec<f64> {
    let events = run.events.iter().filter(|(_, path, words)| path == part && words == what);
    events.map(|(t, ..)| *t).collect()
}

/// Slipping, the stretch of the spring is `sliding/k + a cos(wt) + v/w sin(wt)` until its rate is that of the pull again;
/// sticking, it grows evenly.
#[test]
fn a_disc_sticks_and_slips_at_the_times_of_its_closed_form() {
    let run = run_file("diagrams/stick_slip.ron", &[]);
    let (j, k, v, held, sliding) = (0.02, 50.0, 0.4, 3.0, 1.8);
    let (omega, a) = (f64::sqrt(k / j), (held - sliding) / k);
    let slip = 2.0 * (PI - f64::atan(a * omega / v)) / omega;
    let stick = 2.0 * a / v;
    let found: Vec<f64> =
        run.events.iter().filter(|(_, path, _)| path == "bearing").map(|(t, ..)| *t).collect();
    let expected =
        (0..).map(|i| held / k / v + f64::from(i / 2) * (slip + stick) + if i % 2 == 1 { slip } else { 0.0 });
    let expected: Vec<f64> = expected.take_while(|t| *t < 1.2).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(&expected) {
        close(*found, *expected, 1e-7, "time of a change of mode");
    }
    let speed = run.column("speed.w");
    let still = run.time.iter().zip(speed).filter(|(t, _)| **t < expected[0] - 1e-6);
    assert!(still.into_iter().all(|(_, w)| *w == 0.0), "it creeps before it breaks away");
    // The fastest point of the swing.
    let fastest = v + f64::hypot(a * omega, v);
    close(largest(speed), fastest, 2e-3 * fastest, "maximum speed, at the points recorded");
}

/// Between the events all torques are constant.
#[test]
fn coupled_clutches_lock_and_part_as_their_torques_say() {
    let run = run_file("diagrams/coupled_clutches.ron", &[]);
    let speeds = |t: f64| ["front", "between", "back"].map(|name| run.at(&format!("speeds.{name}"), t));
    let check = |t: f64, expected: [f64; 3]| {
        for (found, expected) in speeds(t).into_iter().zip(expected) {
            close(found, expected, 1e-6, &format!("speed at {t} s"));
        }
    };
    // Slipping: -100 and +100 rad/s^2.
    check(0.3, [70.0, 30.0, 0.0]);
    // Locked at 0.5 s at 50 rad/s; 10 N*m on 0.5 kg*m^2.
    close(times(&run, "first", "locks")[0], 0.5, 1e-9, "the first locks");
    check(0.9, [58.0, 58.0, 0.0]);
    // At 1 s at 60 rad/s the second closes: -20 and +40 rad/s^2; the first bears 10 + 0.2 * 20 = 14 N*m.
    check(1.5, [50.0, 50.0, 20.0]);
    close(run.at("transmitted.first", 1.5), 14.0, 1e-9, "the first bears");
    // They meet at 2 s at 40 rad/s; all three gain 10 rad/s^2. At 2.5 s the first opens: the motor gains 50 rad/s^2.
    close(times(&run, "second", "locks")[0], 2.0, 1e-9, "the second locks");
    check(2.4, [44.0; 3]);
    check(2.8, [60.0, 45.0, 45.0]);
    let locked = (0..run.time.len()).filter(|i| run.time[*i] > 0.6 && run.time[*i] < 1.9);
    for i in locked {
        assert_eq!(run.column("speeds.front")[i], run.column("speeds.between")[i], "a locked clutch slips");
    }
}

/// Driven, `(J1 + J2 / eta) w' = tau - (load + bearing) / eta`; driving, `(J1 + eta J2) w' = tau - eta (load - bearing)`; all
/// at the motor.
#[test]
fn a_hoist_lifts_holds_and_lets_down_as_its_efficiencies_say() {
    let run = run_file("diagrams/lossy_gear.ron", &[]);
    let (up, down, j1, j2) = ((0.4 + 0.02) / 0.75, (0.4 - 0.02) * 0.6, 2e-3, 5.0 / 2500.0);
    let (driven, driving) = (j1 + j2 / 0.75, j1 + 0.6 * j2);
    let lifted = (0.8 - up) / driven * 2.0;
    let rest = 3.0 + lifted * driven / (up - 0.4);
    let lowered = (0.1 - down) / driving * 2.0;
    let end = 9.0 - lowered * driving / (0.4 - down);
    let stops = times(&run, "gear", "sticks");
    assert_eq!(stops.len(), 2, "{stops:?}");
    close(stops[0], rest, 1e-9, "it comes to rest above");
    close(stops[1], end, 1e-9, "it comes to rest below");
    close(run.at("speed.w", 3.0), lifted, 1e-6, "speed after lifting");
    close(run.at("speed.w", 9.0), lowered, 1e-6, "speed after letting down");
    for (t, w) in run.time.iter().zip(run.column("speed.w")) {
        let still = *t < 1.0 || *t > rest + 1e-6 && *t < 7.0 || *t > end + 1e-6;
        assert!(!still || *w == 0.0, "it creeps at {t} s");
    }
}
