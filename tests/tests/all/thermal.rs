//! Thermal networks against closed forms, and parts whose heat flows into them.

use blocksim_tests::{Run, close, compile_text, problems, run, run_text};

fn text(settings: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: ({settings}),
    blocks: {{ {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

fn network(settings: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&text(settings, blocks, connections, shown))
}

/// A chain of equal bodies whose ends are insulated: each cosine of the place decays on its own, with
/// `4 / (R C) sin^2(pi m / 2 n)`.
#[test]
fn a_chain_of_bodies_cools_as_its_cosines_do_and_keeps_its_heat() {
    const N: usize = 5;
    let (c, r) = (20.0, 0.5);
    let start = [400.0, 300.0, 280.0, 350.0, 290.0];
    let bodies: Vec<String> =
        (0..N).map(|k| format!(r#""c{k}": HeatCapacity(c: "20 J/K", t0: "{} K")"#, start[k])).collect();
    let walls: Vec<String> = (1..N).map(|k| format!(r#""r{k}": ThermalResistance(r: "0.5 K/W")"#)).collect();
    let mut lines: Vec<String> = (0..N).map(|k| format!(r#""c{k}.t -> s.t{k}""#)).collect();
    for k in 0..N {
        let left = if k > 0 { format!(" <-> r{k}.b") } else { String::new() };
        let right = if k + 1 < N { format!(" <-> r{}.a", k + 1) } else { String::new() };
        lines.push(format!(r#""c{k}.h{left}{right}""#));
    }
    let shown: Vec<String> = (0..N).map(|k| format!(r#""t{k}""#)).collect();
    let run = network(
        r#"stop_time: "60 s", solver: Ode45(rtol: 1e-10)"#,
        &[bodies, walls].concat().join(", "),
        &lines.join(", "),
        &shown.join(", "),
    );
    assert!(run.time.len() > 10);
    let cosine = |m: usize, k: usize| (std::f64::consts::PI * m as f64 * (k as f64 + 0.5) / N as f64).cos();
    let share: Vec<f64> = (0..N)
        .map(|m| {
            let norm = if m == 0 { N as f64 } else { N as f64 / 2.0 };
            (0..N).map(|k| start[k] * cosine(m, k)).sum::<f64>() / norm
        })
        .collect();
    for (row, t) in run.time.iter().enumerate() {
        let mut sum = 0.0;
        for k in 0..N {
            let expected: f64 = (0..N)
                .map(|m| {
                    let rate =
                        4.0 / (r * c) * (std::f64::consts::PI * m as f64 / (2.0 * N as f64)).sin().powi(2);
                    share[m] * cosine(m, k) * (-rate * t).exp()
                })
                .sum();
            let found = run.column(&format!("s.t{k}"))[row];
            assert!((found - expected).abs() < 1e-6, "{found} for {expected} at {t} s in {k}");
            sum += found;
        }
        assert!((sum - start.iter().sum::<f64>()).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn a_heated_body_approaches_what_its_losses_allow() {
    let run = network(
        r#"stop_time: "300 s", solver: Ode45(rtol: 1e-9)"#,
        r#""p": Constant(value: "50 W"), "q": HeatSource, "c": HeatCapacity(c: "100 J/K", t0: "25 degC"),
           "r": ThermalResistance(r: "0.8 K/W"), "m": HeatFlowSensor, "t": TemperatureSensor, "a": Ambient(t: "25 degC")"#,
        r#""p.y -> q.q", "q.h <-> c.h <-> t.h <-> r.a", "r.b <-> m.a", "m.b <-> a.h", "t.t -> s.t", "m.q -> s.q", "a.q -> s.a""#,
        r#""t", "q", "a""#,
    );
    for (row, t) in run.time.iter().enumerate() {
        let rise = 50.0 * 0.8 * (1.0 - (-t / 80.0).exp());
        assert!((run.column("s.t")[row] - 298.15 - rise).abs() < 1e-6);
        assert!((run.column("s.q")[row] - rise / 0.8).abs() < 1e-6);
        assert!((run.column("s.a")[row] - rise / 0.8).abs() < 1e-6);
    }
}

/// Alone in empty space: `T^-3` grows evenly.
#[test]
fn a_body_in_empty_space_radiates_its_heat() {
    let run = network(
        r#"stop_time: "1 h", solver: Ode45(rtol: 1e-10)"#,
        r#""c": HeatCapacity(c: "400 J/K", t0: "900 K"), "r": ThermalRadiation(area: "0.04 m^2", emissivity: 0.8),
           "space": Ambient(t: "0 K")"#,
        r#""c.h <-> r.a", "r.b <-> space.h", "c.t -> s.t""#,
        r#""t""#,
    );
    for (t, found) in run.time.iter().zip(run.column("s.t")) {
        let factor = 0.8 * 5.670_374_419e-8 * 0.04;
        let expected = (900.0_f64.powi(-3) + 3.0 * factor * t / 400.0).powf(-1.0 / 3.0);
        assert!((found - expected).abs() < 1e-5, "{found} for {expected} at {t} s");
    }
}

const HEATER: &str = r#""u": VoltageSource(v: "24 V"), "g": ElectricalReference,
    "r": Resistor(r: "4 ohm", heat_port: true, alpha: "3.93e-3 1/K", t_ref: "20 degC"),
    "loss": ThermalResistance(r: "1.5 K/W"), "air": Ambient(t: "30 degC")"#;
const HEATED: &str = r#""u.p <-> r.p", "u.n <-> r.n <-> g.p", "r.h <-> loss.a", "loss.b <-> air.h", "r.i -> s.i", "air.q -> s.q""#;

/// Against the classical Runge-Kutta method with small steps on the one equation that is left.
#[test]
fn a_resistor_heats_itself_and_its_resistance_follows() {
    let run = network(
        r#"stop_time: "200 s", solver: Ode45(rtol: 1e-9)"#,
        &format!(
            r#"{HEATER}, "c": HeatCapacity(c: "40 J/K", t0: "30 degC"), "account": EnergyAccount(at: Electrical, tolerance: 1e-6)"#
        ),
        &format!(
            r#"{HEATED}, "c.h <-> r.h", "c.t -> s.t", "account.node <-> g.p", "account.dissipated -> s.p""#
        ),
        r#""i", "q", "t", "p""#,
    );
    let power = |t: f64| 24.0 * 24.0 / (4.0 * (1.0 + 3.93e-3 * (t - 293.15)));
    let rate = |t: f64| (power(t) - (t - 303.15) / 1.5) / 40.0;
    let (mut at, mut temperature) = (0.0, 303.15);
    for (row, time) in run.time.iter().enumerate() {
        let steps = ((time - at) / 0.01).ceil().max(1.0);
        let h = (time - at) / steps;
        for _ in 0..steps as usize {
            let a = rate(temperature);
            let b = rate(temperature + 0.5 * h * a);
            let c = rate(temperature + 0.5 * h * b);
            let d = rate(temperature + h * c);
            temperature += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        at = *time;
        let found = run.column("s.t")[row];
        assert!((found - temperature).abs() < 1e-6, "{found} for {temperature} at {time} s");
        assert!((run.column("s.p")[row] - power(temperature)).abs() < 1e-6);
        assert!((run.column("s.i")[row] - power(temperature) / 24.0).abs() < 1e-7);
    }
    assert!(temperature > 350.0, "{temperature}");
}

/// Without a capacity the temperature follows at once: a quadratic equation.
#[test]
fn a_resistor_without_capacity_finds_its_temperature() {
    let run = network(r#"stop_time: "1 s""#, HEATER, HEATED, r#""i", "q""#);
    // x = T - T_a: x (1 + alpha (x + T_a - T_ref)) = 1.5 V^2 / r.
    let (a, b, c): (f64, f64, f64) = (3.93e-3, 1.0 + 3.93e-3 * 10.0, -1.5 * 24.0 * 24.0 / 4.0);
    let rise = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    assert!((run.last("s.q") - rise / 1.5).abs() < 1e-9, "{} for {}", run.last("s.q"), rise / 1.5);
    assert!((run.last("s.i") - rise / 1.5 / 24.0).abs() < 1e-11);
}

#[test]
fn bodies_that_touch_have_one_temperature_and_add_their_capacities() {
    let run = network(
        r#"stop_time: "100 s", solver: Ode45(rtol: 1e-9)"#,
        r#""a": HeatCapacity(c: "30 J/K", t0: "350 K"), "b": HeatCapacity(c: "70 J/K"), "r": ThermalResistance(r: "0.5 K/W"),
           "air": Ambient(t: "300 K")"#,
        r#""a.h <-> b.h <-> r.a", "r.b <-> air.h", "a.t -> s.a", "b.t -> s.b""#,
        r#""a", "b""#,
    );
    for (row, t) in run.time.iter().enumerate() {
        let expected = 300.0 + 50.0 * (-t / 50.0).exp();
        assert!((run.column("s.a")[row] - expected).abs() < 1e-6);
        assert!((run.column("s.b")[row] - expected).abs() < 1e-6);
    }
}

#[test]
fn what_is_wrong_with_a_thermal_network_is_said_in_its_terms() {
    let said = problems(
        r#""r": Resistor(r: 1.0), "c": HeatCapacity(c: 1.0), "g": ElectricalReference, "u": VoltageSource(v: 1.0)"#,
        r#""r.p <-> c.h <-> u.p", "r.n <-> g.p <-> u.n""#,
    );
    assert!(said.contains("thermal") && said.contains("heat_port: true"), "{said}");
    let said = problems(
        r#""p": Constant(value: "1 W"), "q": HeatSource, "t": TemperatureSensor"#,
        r#""p.y -> q.q", "q.h <-> t.h""#,
    );
    assert!(said.contains("no_current_path") || said.contains("floating_node"), "{said}");
    assert!(said.contains("HeatCapacity") && !said.contains("current source"), "{said}");
    let said = problems(r#""a": Ambient(t: "20 degC"), "b": Ambient(t: "30 degC")"#, r#""a.h <-> b.h""#);
    assert!(said.contains("two parts prescribe the same temperature"), "{said}");
    let said = problems(
        r#""a": HeatCapacity(c: 1.0, t0: "20 degC"), "b": HeatCapacity(c: 1.0, t0: "30 degC")"#,
        r#""a.h <-> b.h""#,
    );
    assert!(
        said.contains("the temperatures at the start do not fit each other") && said.contains("10"),
        "{said}"
    );
    let said = problems(
        r#""a": ThermalResistance(r: 1.0), "b": ThermalResistance(r: 1.0)"#,
        r#""a.a <-> b.a", "a.b <-> b.b""#,
    );
    assert!(said.contains("nothing determines the temperature"), "{said}");
    let said = problems(r#""a": HeatCapacity(c: 1.0)"#, "");
    assert!(said.contains("the thermal port `a.h` is not connected"), "{said}");
}

/// `C dT/dt = V^2 / (R (1 + alpha (T - T_0)))` comes to where the resistance is zero, 200 K above `T_0`, after
/// `C R 100 K / V^2`, and not beyond.
#[test]
fn a_resistance_that_its_temperature_would_make_negative_is_named() {
    for solver in ["Auto", "Ode45", "Ode23"] {
        let model = text(
            &format!(r#"stop_time: "20 s", solver: {solver}"#),
            r#""v": VoltageSource(v: "60 V"), "g": ElectricalReference,
               "r": Resistor(r: "10 ohm", heat_port: true, alpha: "-0.005 1/K"), "c": HeatCapacity(c: "10 J/K")"#,
            r#""v.p <-> r.p", "v.n <-> r.n <-> g.p", "r.h <-> c.h", "c.t -> s.t""#,
            r#""t""#,
        );
        let (compiled, problems) = compile_text(&model);
        let failure =
            run(compiled.schedule.unwrap_or_else(|| panic!("{problems}"))).error.expect("a failure");
        close(failure.t, 10.0 * 10.0 * 100.0 / 3600.0, 5e-3, solver);
        let message = failure.to_string();
        assert!(
            message.contains("the law of `r` has no value at ") && message.contains(" V, 493.1"),
            "{solver}: {message}"
        );
    }
}

/// `T = T_0 + q t / C` is negative from `t = - C T_0 / q` on.
#[test]
fn a_body_that_falls_below_absolute_zero_is_named_at_the_end() {
    for solver in ["Auto", "Radau5", "Ode4(step: \"0.5 s\")"] {
        let cooled = |stop: &str, start: &str| {
            network(
                &format!(r#"stop_time: "{stop}", solver: {solver}"#),
                &format!(
                    r#""q": Constant(value: "-40 W"), "cooler": HeatSource, "body": HeatCapacity(c: "20 J/K", t0: "{start}")"#
                ),
                r#""q.y -> cooler.q", "cooler.h <-> body.h", "body.t -> s.t""#,
                r#""t""#,
            )
        };
        let warnings = cooled("200 s", "293 K").warnings;
        assert_eq!(warnings.len(), 1, "{solver}: {warnings:?}");
        let expected = "`body.t` falls below absolute zero at t = 146.5 s, where its law does not hold: its least value is \
                        -107 K, at 200 s";
        assert_eq!((warnings[0].code, &*warnings[0].message), ("below_floor", expected), "{solver}");
        let warm = cooled("146 s", "293 K").warnings;
        assert!(warm.is_empty(), "{solver}: {warm:?}");
    }
}

/// What radiates to nothing comes ever closer to absolute zero and is not below it, and a body at absolute zero stays there.
#[test]
fn cold_bodies_are_not_below_absolute_zero() {
    for solver in ["Auto", "Auto(rtol: 1e-3)", "Ode23(rtol: 1e-3)", "Radau5(rtol: 1e-2)"] {
        let run = network(
            &format!(r#"stop_time: "1e9 s", solver: {solver}"#),
            r#""space": Ambient(t: "0 K"), "rays": ThermalRadiation(area: "1 m^2", emissivity: 1.0), "body": HeatCapacity(c: "20 J/K"),
               "wall": ThermalResistance(r: "1 K/W"), "cold": HeatCapacity(c: "1 J/K", t0: "0 K")"#,
            r#""space.h <-> rays.b <-> wall.b", "rays.a <-> body.h", "wall.a <-> cold.h", "body.t -> s.body", "cold.t -> s.cold""#,
            r#""body", "cold""#,
        );
        let last = *run.column("s.body").last().expect("a row");
        let found: Vec<&String> =
            run.warnings.iter().filter(|w| w.code == "below_floor").map(|w| &w.message).collect();
        assert!(last < 1.0 && found.is_empty(), "{solver}: {last} K, {found:?}");
    }
}

/// The state of a capacity beside a source of temperature is not its temperature.
#[test]
fn a_capacity_that_a_source_holds_warm_is_not_below_absolute_zero() {
    let run = network(
        r#"stop_time: "10 s""#,
        r#""t": Ramp(slope: "10 K/s", initial: "300 K"), "source": TemperatureSource, "body": HeatCapacity(c: "20 J/K")"#,
        r#""t.y -> source.t", "source.h <-> body.h", "body.t -> s.t""#,
        r#""t""#,
    );
    assert!((run.column("s.t").last().expect("a row") - 400.0).abs() < 1e-9);
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
}
