//! Parameters that change in the middle of a run, against closed forms and against models in which a signal does the same.

use std::sync::Arc;

use blocksim_block::schedule::{FixedMethod, Schedule, Solver};
use blocksim_sim::{Control, Counts, Ended, Observer, Simulation};
use blocksim_tests::{METHODS, compile_file, compile_text, diagrams_below, root};

/// Keeps all rows, and interrupts the run at the first step at or behind a time.
#[derive(Default)]
struct Watch {
    rows: Vec<(f64, Vec<f64>)>,
    stop: Option<f64>,
}

impl Observer for Watch {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.rows.push((t, values.to_vec()));
    }

    fn is_waiting(&self, t: f64) -> bool {
        self.stop.is_some_and(|stop| t >= stop)
    }

    fn progress(&mut self, t: f64, _: &Counts) -> Control {
        if self.is_waiting(t) { Control::Stop } else { Control::Go }
    }
}

fn schedule(text: &str) -> Arc<Schedule> {
    let (compiled, problems) = compile_text(text);
    Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
}

/// Rows of a run in which `text` becomes another text at the first step at or behind `at`, and that time.
fn tuned(text: &str, other: &str, at: f64) -> (Vec<(f64, Vec<f64>)>, f64) {
    let mut simulation = Simulation::new(schedule(text)).expect("a start");
    let mut watch = Watch { stop: Some(at), ..Watch::default() };
    assert_eq!(simulation.run(&mut watch).expect("a run"), Ended::Interrupted);
    let t = simulation.time();
    let before = simulation.counts();
    simulation.tune(schedule(other), &mut watch).expect("other parameters");
    watch.stop = None;
    assert_eq!(simulation.run(&mut watch).expect("a run"), Ended::Finished);
    let after = simulation.counts();
    assert!(after.accepted > before.accepted && after.major > before.major, "work is counted on");
    (watch.rows, t)
}

fn untouched(text: &str) -> Vec<(f64, Vec<f64>)> {
    let mut watch = Watch::default();
    Simulation::new(schedule(text)).expect("a start").run(&mut watch).expect("a run");
    watch.rows
}

/// x' = -k x.
fn decay(k: &str, solver: &str) -> String {
    format!(
        r#"Diagram(simulation: (stop_time: "2 s", solver: {solver}), blocks: {{
            "k": Gain(k: "{k}"), "x": Integrator(x0: 1), "s": Scope(inputs: ["x", "rate"]) }},
           connections: ["x.y -> k.u, s.x", "k.y -> x.u, s.rate"])"#
    )
}

/// The states of a transfer function are those of the canonical form, whatever the powers of two that they are kept in.
#[test]
fn the_states_of_a_transfer_function_are_kept() {
    let text = |num: &str, den: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "3 s", solver: Ode45(rtol: 1e-9)), blocks: {{
                "one": Constant(value: 1), "g": TransferFunction(num: {num}, den: {den}), "s": Scope(inputs: ["y"]) }},
               connections: ["one.y -> g.u", "g.y -> s.y"])"#
        )
    };
    for new in [0.99, 1.01, 0.999_999, 0.3, 5.0, 1e-3, 300.0] {
        // 1 / (T s + 1) in two ways: the state is T y.
        let forms: [&dyn Fn(f64) -> String; 2] =
            [&|time| text(&format!("[{}]", 1.0 / time), &format!("[1, {}]", 1.0 / time)), &|time| {
                text("[1]", &format!("[{time}, 1]"))
            }];
        for form in forms {
            let (rows, t) = tuned(&form(1.0), &form(new), 2.0);
            let jumped = (1.0 - (-t).exp()) / new;
            for (time, row) in rows.iter().rev().take_while(|(time, _)| *time > t) {
                let exact = 1.0 + (jumped - 1.0) * (-(time - t) / new).exp();
                assert!(
                    (row[0] - exact).abs() < 1e-6 * jumped.max(1.0),
                    "{new} at {time}: {} {exact}",
                    row[0]
                );
            }
        }
        // w^2 / (s^2 + 30 s + w^2) for w = 10, nearly at rest: its output is w^2 times the second state.
        let form = |square: f64| text(&format!("[{square}]"), &format!("[1, 30, {square}]"));
        let (rows, t) = tuned(&form(100.0), &form(100.0 * new), 2.9);
        let after = rows.iter().rfind(|(time, _)| *time == t).expect("a row");
        let exact = 1.0 - 1.170_820_393_2 * (-3.819_660_112_5 * t).exp();
        assert!((after.1[0] - exact * new).abs() < 1e-4 * new, "{new}: {} {}", after.1[0], exact * new);
    }
}

/// With a grid of rows nobody has to look at the steps between them: who wants to change something is heard at the same step all the same.
#[test]
fn a_change_comes_at_the_first_step_that_reaches_it_with_rows_on_a_grid_as_well() {
    for solver in METHODS {
        let text = |k: f64, output: &str| {
            format!(
                r#"Diagram(simulation: (stop_time: "10 s", solver: {solver}(rtol: 1e-7){output}), blocks: {{
                    "x": Integrator(x0: 1), "v": Integrator, "k": Gain(k: {k}), "s": Scope(inputs: ["x"]) }},
                   connections: ["v.y -> x.u", "x.y -> k.u, s.x", "k.y -> v.u"])"#
            )
        };
        let at = |output: &str| tuned(&text(-10.0, output), &text(-20.0, output), 2.0);
        let ((_, every), (rows, t)) = (at(""), at(r#", output: Every("10 ms")"#));
        assert_eq!(every, t, "{solver}");
        assert!((2.0..2.2).contains(&t), "{solver}: {t} s");
        let (w, faster) = (10.0_f64.sqrt(), 20.0_f64.sqrt());
        let (x, v) = ((w * t).cos(), -w * (w * t).sin());
        for (time, row) in rows.iter().filter(|(time, _)| *time > t) {
            let since = time - t;
            let exact = x * (faster * since).cos() + v / faster * (faster * since).sin();
            assert!((row[0] - exact).abs() < 2e-4, "{solver}: {} instead of {exact} at {time} s", row[0]);
        }
    }
}

#[test]
fn a_gain_acts_from_its_change_on() {
    for (solver, tolerance) in [
        ("Ode45(rtol: 1e-9)", 1e-7),
        ("Ode4(step: \"1 ms\")", 1e-9),
        ("Ode15s(rtol: 1e-8)", 1e-6),
        ("Rodas4(rtol: 1e-8)", 1e-6),
    ] {
        let (rows, t) = tuned(&decay("-1 1/s", solver), &decay("-3 1/s", solver), 0.7);
        let expected = (-t).exp() * (-3.0 * (2.0 - t)).exp();
        let (end, last) = rows.last().expect("rows");
        assert_eq!(*end, 2.0);
        assert!((last[0] - expected).abs() < tolerance, "{solver}: {} and {expected}", last[0]);
        // The state does not jump, the rate does: rows on both sides.
        let around: Vec<_> = rows.iter().filter(|(time, _)| *time == t).collect();
        let [.., (_, before), (_, after)] = around.as_slice() else { panic!("{solver}: {around:?}") };
        assert_eq!(before[0], after[0]);
        assert!((after[1] / before[1] - 3.0).abs() < 1e-12, "{solver}: {before:?} and {after:?}");
    }
}

#[test]
fn constants_initial_values_and_limits() {
    let text = |value: &str, x0: &str, upper: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "2 s", solver: Ode4(step: "10 ms")), blocks: {{
                "c": Constant(value: {value}), "x": Integrator(x0: {x0}), "l": Saturation(lower: -1, upper: {upper}), "s": Scope(inputs: ["x", "l"]) }},
               connections: ["c.y -> x.u", "x.y -> l.u, s.x", "l.y -> s.l"])"#
        )
    };
    let (rows, t) = tuned(&text("1", "0", "0.5"), &text("-1", "7", "0.8"), 1.0);
    assert_eq!(t, 1.0);
    let at = |time: f64| rows.iter().rev().find(|(t, _)| (t - time).abs() < 1e-9).expect("a row").1.clone();
    // It goes on from where it was, whatever it would begin with.
    assert!((at(1.0)[0] - 1.0).abs() < 1e-12 && (at(1.0)[1] - 0.8).abs() < 1e-12, "{:?}", at(1.0));
    assert!((at(1.5)[0] - 0.5).abs() < 1e-12 && (at(2.0)[0] - 0.0).abs() < 1e-12);
    assert!((at(1.1)[1] - 0.8).abs() < 1e-12, "the limit holds: {:?}", at(1.1));
}

#[test]
fn values_at_the_start_that_have_no_effect_are_named() {
    let text = decay("-1 1/s", "Ode4(step: \"1 ms\")");
    let mut simulation = Simulation::new(schedule(&text)).expect("a start");
    let mut watch = Watch { stop: Some(0.5), ..Watch::default() };
    simulation.run(&mut watch).expect("a run");
    let mut tune = |text: String| simulation.tune(schedule(&text), &mut watch).expect("the same shape");
    assert_eq!(tune(text.replace("-1 1/s", "-2 1/s")), Vec::<String>::new());
    assert_eq!(tune(text.replace("x0: 1", "x0: 7")), ["x"]);
}

#[test]
fn a_sampled_controller_goes_on_as_with_a_gain_that_is_a_signal() {
    let text = |gain: &str, solver: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "1 s", solver: {solver}), blocks: {{
                "w": Constant(value: 1), "e": Sum(signs: "+-"), "hold": ZeroOrderHold(ts: "10 ms"), {gain}
                "d": DiscreteIntegrator(ts: "10 ms"), "u": Sum(signs: "++"), "x": FirstOrder, "s": Scope(inputs: ["x", "u"]) }},
               connections: ["w.y -> e.u1", "x.y -> e.u2", "e.y -> hold.u", "hold.y -> d.u", "d.y -> u.u2", "u.y -> x.u, s.u", "x.y -> s.x", {}])"#,
            if gain.contains("Product") {
                r#""hold.y -> k.u1", "step.y -> k.u2", "k.y -> u.u1""#
            } else {
                r#""hold.y -> k.u", "k.y -> u.u1""#
            }
        )
        .replace("FirstOrder", "TransferFunction(num: [1], den: [0.1, 1])")
    };
    for (solver, tolerance) in [("Ode4(step: \"2 ms\")", 1e-13), ("Ode45(rtol: 1e-10)", 1e-8)] {
        let plain = |k: &str| text(&format!("\"k\": Gain(k: {k}),"), solver);
        let (rows, t) = tuned(&plain("4"), &plain("0.5"), 0.5);
        assert!((t - 0.5).abs() < 1e-12);
        let signal = text(
            "\"k\": Product(factors: 2), \"step\": Step(time: \"0.5 s\", before: 4, after: 0.5),",
            solver,
        );
        let signal = signal.replace("Product(factors: 2)", "Product");
        let expected = untouched(&signal);
        let (end, last) = rows.last().expect("rows");
        let (same, wanted) = expected.last().expect("rows");
        assert_eq!(end, same);
        for (a, b) in last.iter().zip(wanted) {
            assert!((a - b).abs() < tolerance, "{solver}: {last:?} and {wanted:?}");
        }
    }
}

/// A circuit that is integrated by itself takes parameters that change between two of its hits there and then, those of its inputs and its own.
#[test]
fn a_separate_circuit_takes_a_parameter_within_its_coupling_step() {
    let text = |f: &str, r_s: &str, integration: &str, solver: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "60 ms", solver: {solver}, output: Every("2 ms")),
    blocks: {{
        "f": {f}, "v": Gain(k: "3 V/Hz"),
        "inverter": SwitchedInverter(vdc: "400 V", switching_frequency: "2 kHz", integration: {integration}),
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: {r_s}, x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
        ),
        "rotor": Inertia(j: "0.05 kg*m^2"), "frame": RotationalReference, "encoder": MotionSensor, "s": Scope(inputs: ["w"]),
    }},
    connections: [
        "f.y -> v.u, inverter.f", "v.y -> inverter.v", "inverter.ac <-> machine.ac",
        "machine.r <-> rotor.r <-> encoder.r", "machine.c <-> frame.r <-> encoder.c", "encoder.w -> s.w",
    ],
)"#
        )
    };
    let fixed = r#"Ode4(step: "0.1 ms")"#;
    let separate = |f: &str, r_s: &str| text(f, r_s, "Separate(periods: 1)", fixed);
    let [slow, fast] = [40, 50].map(|f| format!(r#"Constant(value: "{f} Hz")"#));
    for (f, r_s) in [(&fast, "0.25"), (&slow, "1.5")] {
        let (rows, t) = tuned(&separate(&slow, "0.25"), &separate(f, r_s), 0.0203);
        assert!((t - 0.0203).abs() < 1e-9, "{t}");
        let together = |f: &str, r_s: &str| text(f, r_s, "Together", r#"Ode4(step: "0.1 us")"#);
        let (exact, same) = tuned(&together(&slow, "0.25"), &together(f, r_s), t);
        assert!((t - same).abs() < 1e-9, "{same}");
        let [found, exact] = [&rows, &exact].map(|rows| rows.last().expect("rows").1[0]);
        assert!((found - exact).abs() < 1e-4 * exact, "{f}, {r_s} ohm: {found} and {exact}");
    }
}

#[test]
fn a_network_goes_on_with_another_resistance() {
    let text = |r: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-9)), blocks: {{
                "u": VoltageSource(v: "10 V"), "r": Resistor(r: "{r}"), "c": Capacitor(c: "1 mF"), "g": ElectricalReference,
                "m": VoltageSensor, "s": Scope(inputs: ["v"]) }},
               connections: ["u.p <-> r.p", "r.n <-> c.p", "c.p <-> m.p", "c.n <-> u.n", "c.n <-> m.n", "c.n <-> g.p", "m.v -> s.v"])"#
        )
    };
    let (rows, t) = tuned(&text("1 kOhm"), &text("100 Ohm"), 0.5);
    let at = 10.0 - 10.0 * (-t).exp();
    let expected = 10.0 + (at - 10.0) * (-(2.0 - t) / 0.1).exp();
    assert!((rows.last().expect("rows").1[0] - expected).abs() < 1e-6, "{:?} and {expected}", rows.last());
}

#[test]
fn the_same_parameters_change_nothing() {
    for file in [
        "diagrams/servo.ron",
        "diagrams/pid_anti_windup.ron",
        "diagrams/bouncing_mass.ron",
        "diagrams/pendulum.ron",
        "diagrams/dc_motor_start.ron",
    ] {
        let (compiled, problems) = blocksim_tests::compile_file(file, &[]);
        let schedule = Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        let (mut touched, mut plain) = (Watch::default(), Watch::default());
        let stop = schedule.settings.stop_time;
        Simulation::new(Arc::clone(&schedule)).expect("a start").run(&mut plain).expect("a run");
        let mut simulation = Simulation::new(Arc::clone(&schedule)).expect("a start");
        for part in [0.2, 0.5, 0.7] {
            touched.stop = Some(part * stop);
            simulation.run(&mut touched).expect("a run");
            simulation.tune(Arc::clone(&schedule), &mut touched).expect("the same");
        }
        touched.stop = None;
        simulation.run(&mut touched).expect("a run");
        let (end, last) = touched.rows.last().expect("rows");
        let (same, wanted) = plain.rows.last().expect("rows");
        assert_eq!(end, same, "{file}");
        for (n, (a, b)) in last.iter().zip(wanted).enumerate() {
            let size = plain.rows.iter().fold(0.0_f64, |size, (_, row)| size.max(row[n].abs()));
            assert!((a - b).abs() <= 1e-3 * size + 1e-9, "{file}: signal {n} is {a} and {b}");
        }
    }
}

/// A bar of a four-bar linkage cannot become longer while the others stay where they are; its mass can change.
#[test]
fn a_closed_loop_of_bodies_is_not_opened() {
    let file = |change: &str| {
        let (compiled, problems) = compile_file("diagrams/four_bar.ron", &[change]);
        Arc::new(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
    };
    let mut simulation = Simulation::new(file("density=4 kg/m")).expect("a start");
    let mut watch = Watch { stop: Some(0.5), ..Watch::default() };
    simulation.run(&mut watch).expect("a run");
    let error = simulation.tune(file("coupler_length=0.3 m"), &mut watch).expect_err("an open loop");
    assert_eq!(error.code, "tuning");
    assert!(error.message.contains("a closed loop would be open by 0.15"), "{}", error.message);
    // As for any other model that is refused, the run goes on as it was.
    watch.stop = Some(0.6);
    simulation.run(&mut watch).expect("a run");
    simulation.tune(file("density=5 kg/m"), &mut watch).expect("another mass");
    watch.stop = None;
    assert_eq!(simulation.run(&mut watch).expect("a run"), Ended::Finished);
}

#[test]
fn another_model_is_refused_and_the_run_goes_on() {
    let text = decay("-1 1/s", "Ode4(step: \"1 ms\")");
    let mut simulation = Simulation::new(schedule(&text)).expect("a start");
    let mut watch = Watch { stop: Some(0.5), ..Watch::default() };
    simulation.run(&mut watch).expect("a run");
    let others = [
        (text.replace("\"k\": Gain", "\"j\": Constant(value: 1), \"k\": Gain"), "`j` stands where `k` stood"),
        (text.replace("Integrator(x0: 1)", "TransferFunction(num: [1], den: [1, 2, 1])"), "`x`"),
        (text.replace("1 ms", "2 ms"), "the method of solution is another"),
        (
            text.replace("\"x\", \"rate\"", "\"x\", \"rates\"").replace("s.rate\"", "s.rates\""),
            "other signals are recorded",
        ),
    ];
    for (other, told) in others {
        let error = simulation.tune(schedule(&other), &mut watch).expect_err("another model");
        assert_eq!(error.code, "tuning");
        assert!(error.message.contains(told), "{}", error.message);
    }
    watch.stop = None;
    simulation.run(&mut watch).expect("a run");
    assert!((watch.rows.last().expect("rows").1[0] - (-2.0_f64).exp()).abs() < 1e-9);
}

/// Rows of a run in steps of the same length, with the same parameters given anew at some times; nothing if the steps are too long
/// for the model.
fn anew(schedule: &Arc<Schedule>, times: &[f64]) -> Option<Vec<(f64, Vec<f64>)>> {
    let mut watch = Watch::default();
    let mut simulation = Simulation::new(Arc::clone(schedule)).ok()?;
    for time in times {
        watch.stop = Some(*time);
        if simulation.run(&mut watch).ok()? != Ended::Interrupted {
            break;
        }
        simulation.tune(Arc::clone(schedule), &mut watch).expect("the same parameters");
    }
    watch.stop = None;
    simulation.run(&mut watch).ok()?;
    Some(watch.rows)
}

/// Whatever blocks remember is carried over: delays, hysteresis, filters, counters, random streams, machines, coupled circuits.
#[test]
fn nothing_that_a_block_remembers_is_lost() {
    let (mut wrong, mut agreed) = (Vec::new(), 0);
    for path in diagrams_below("docs/blocks").into_iter().chain(diagrams_below("diagrams")) {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        let Some(mut schedule) = compile_file(&name, &[]).0.schedule else { continue };
        let stop = schedule.settings.stop_time.min(2.0);
        let step = stop / 1000.0;
        schedule.settings.stop_time = stop;
        schedule.settings.solver = Solver::Fixed { method: FixedMethod::Ode4, step };
        let schedule = Arc::new(schedule);
        let Some(plain) = anew(&schedule, &[]) else { continue };
        if !plain.iter().all(|(_, row)| row.iter().all(|value| value.is_finite() && value.abs() < 1e9)) {
            continue;
        }
        let Some(touched) = anew(&schedule, &[0.23 * stop, 0.5 * stop, 0.77 * stop]) else {
            wrong.push(format!("{name}: ends early"));
            continue;
        };
        // Each change is a row more.
        let last = |rows: &[(f64, Vec<f64>)]| rows.last().cloned().expect("rows");
        let ((end, found), (same, expected)) = (last(&touched), last(&plain));
        let differs = found.iter().zip(&expected).position(|(a, b)| a.to_bits() != b.to_bits() && a != b);
        match differs {
            _ if end != same => wrong.push(format!("{name}: ends at {end} and {same}")),
            Some(n) => wrong
                .push(format!("{name}: `{}` is {} and {}", schedule.recorded[n].path, found[n], expected[n])),
            None => agreed += 1,
        }
    }
    assert!(wrong.is_empty(), "{} models, {agreed} agreed:\n{}", wrong.len(), wrong.join("\n"));
    assert!(agreed > 250, "only {agreed} models");
}

/// Where a sample hit, a reset and a change meet, what was before them is recorded there and not at the end of the next step.
#[test]
fn what_was_before_a_change_at_a_hit_is_recorded_at_the_change() {
    for solver in ["Ode15s(rtol: 1e-4)", "Ode45(rtol: 1e-4)", "Rodas4(rtol: 1e-4)", "Ode4(step: \"10 ms\")"] {
        let text = |k: u32| {
            format!(
                r#"Diagram(simulation: (stop_time: "1 s", solver: {solver}), blocks: {{
                    "one": Constant(value: 1), "g": Gain(k: {k}), "i": Integrator, "z": ZeroOrderHold(ts: "0.1 s"),
                    "above": Compare(operator: Greater, constant: 1.5), "hold": Integrator(reset: Rising),
                    "s": Scope(inputs: ["i", "z", "hold"]) }},
                   connections: ["one.y -> g.u, hold.u", "g.y -> i.u, z.u, above.u", "above.y -> hold.reset", "i.y -> s.i", "z.y -> s.z",
                    "hold.y -> s.hold"])"#
            )
        };
        let (rows, t) = tuned(&text(1), &text(3), 0.5);
        assert!((t - 0.5).abs() < 1e-12, "{solver}: the change is at a hit");
        for (at, values) in rows.iter().filter(|(at, _)| *at > t) {
            let expected = [t + 3.0 * (at - t), 3.0, at - t];
            let worst = values.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{solver}: {values:?} at {at} s");
        }
        let at_change = rows.iter().filter(|(at, _)| *at == t).map(|(_, values)| values.clone());
        let near = |a: &[f64], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
        let at_change: Vec<_> = at_change.collect();
        assert!(
            near(&at_change[0], [t, 1.0, t]) && near(at_change.last().unwrap(), [t, 3.0, 0.0]),
            "{at_change:?}"
        );
    }
}
