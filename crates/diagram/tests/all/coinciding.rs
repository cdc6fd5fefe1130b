//! Instants that coincide but for rounding, and edges within a step, with what conditional subsystems make of them.

use crate::conditional::GAIN;
use crate::texts::run;

/// Sources within, conditions and samples that change at multiples of 0.1 s, which no float meets: in whole numbers they coincide, and so they
/// must in a run, whatever their order of rounding.
#[test]
fn instants_that_coincide_but_for_rounding_coincide_within_subsystems_as_well() {
    let pulse = |k: i64, (period, width, delay): (i64, i64, i64)| k >= delay && (k - delay) % period < width;
    let written = |(period, width, delay): (i64, i64, i64)| {
        format!(
            r#"Pulse(period: "{} s", width: {}, delay: "{} s")"#,
            period as f64 / 10.0,
            width as f64 / period as f64,
            delay as f64 / 10.0
        )
    };
    let mut seed = 5_u64;
    let mut below = |most: i64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as i64 % most
    };
    for case in 0..150 {
        let mut any = || {
            let period = 2 + below(6);
            (period, 1 + below(period - 1), below(5))
        };
        let (inside, outside) = (any(), any());
        let solver = ["Ode45", "Ode15s", "Ode4(step: \"0.1 s\")"][case % 3];
        let triggered = case % 2 == 1;
        let (parameter, port) =
            if triggered { ("trigger: Rising", "trigger") } else { ("enable: Held", "enable") };
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "4 s", solver: {solver}, output: Every("0.1 s")),
                blocks: {{
                    "on": {}, "sub": Subsystem(file: "sub.ron", {parameter}), "z": ZeroOrderHold(ts: "0.1 s"),
                    "show": Scope(inputs: ["z", "y"]),
                }},
                connections: ["on.y -> sub.{port}", "sub.y -> z.u, show.y", "z.y -> show.z"],
            )"#,
            written(outside)
        );
        let sub = format!(
            r#"Diagram(outputs: {{ "y": "sum.y" }}, blocks: {{
                "p": {}, "saw": Sawtooth(period: "0.3 s", upper: 3), "one": Constant(value: 1), "sum": Sum(signs: "+++"),
            }}, connections: ["p.y -> sum.u1", "saw.y -> sum.u2", "one.y -> sum.u3"])"#,
            written(inside)
        );
        let found = run(&[("model.ron", &model), ("sub.ron", &sub)]);
        // As it is at an instant, and as it was directly before.
        let at = |k: i64| 1.0 + f64::from(u8::from(pulse(k, inside))) + (k % 3) as f64;
        let before = |k: i64| at(k - 1) + 1.0;
        let mut expected = 0.0;
        let rows = found.column("show.z");
        for (row, &(t, z)) in rows.iter().enumerate() {
            // Rows of one instant are its two sides.
            if rows.get(row + 1).is_some_and(|next| next.0 - t < 1e-6) {
                continue;
            }
            let k = (10.0 * t).round() as i64;
            let runs = pulse(k, outside) && !(triggered && (k == 0 || pulse(k - 1, outside)));
            if runs {
                expected = at(k);
            } else if !triggered && k > 0 && pulse(k - 1, outside) {
                expected = before(k);
            }
            assert!(
                (z - expected).abs() < 1e-9,
                "{case} {solver} {parameter}: {z} at {t} s, not {expected}\n{model}\n{sub}"
            );
        }
    }
}

/// A block whose time stands still with it goes on where it stopped, and not a rounding before that: a limiter of the rate that has nothing to
/// do would find itself before its last step.
#[test]
fn a_limiter_that_has_nothing_to_do_pauses_as_often_as_it_likes() {
    let sub = r#"Diagram(inputs: { "u": () }, outputs: { "y": "e.y" },
        blocks: { "e": RateLimiter(rising: 8, falling: -9) }, connections: ["in.u -> e.u"])"#;
    for (period, delay) in [(0.2, 0.1), (0.3, 0.1), (0.7, 0.3), (0.11, 0.07), (0.06, 0.01)] {
        for solver in ["Auto", "Ode23", "Dop853", "Ode15s", "Radau5", "Ode4(step: \"10 ms\")"] {
            let model = format!(
                r#"Diagram(
                    simulation: (stop_time: "5 s", solver: {solver}, output: Every("0.1 s")),
                    blocks: {{
                        "on": Pulse(period: "{period} s", width: 0.5, delay: "{delay} s"), "u": Constant(value: 0),
                        "s": Subsystem(file: "sub.ron", enable: Held), "show": Scope,
                    }},
                    connections: ["on.y -> s.enable", "u.y -> s.u", "s.y -> show.u"],
                )"#
            );
            let run = run(&[("model.ron", &model), ("sub.ron", sub)]);
            assert!(run.column("show.u").iter().all(|(_, y)| *y == 0.0), "{solver}");
        }
    }
}

/// A trigger that crosses zero the other way within a step and then jumps back is seen, wherever steps end.
#[test]
fn a_trigger_that_jumps_back_across_zero_is_seen() {
    for (sign, edge) in [(1.0, "Falling"), (-1.0, "Rising")] {
        for solver in ["Auto", "Ode45", "Ode15s", "Radau5", "Rodas4"] {
            for late in [1e-6, 1e-3, 0.02, 0.2] {
                let model = format!(
                    r#"Diagram(simulation: (stop_time: "2 s", solver: {solver}), blocks: {{
                        "up": Ramp(slope: {sign}, initial: {}), "down": Step(time: "{} s", after: {}), "u": Sum(signs: "++"),
                        "time": Clock, "s": Subsystem(file: "sub.ron", trigger: {edge}), "show": Scope(inputs: ["y"]) }},
                      connections: ["up.y -> u.u1", "down.y -> u.u2", "u.y -> s.trigger", "time.y -> s.u", "s.y -> show.y"])"#,
                    -sign,
                    1.0 + late,
                    -5.0 * sign
                );
                let run = run(&[("model.ron", &model), ("sub.ron", GAIN)]);
                let found = run.last("show.y");
                assert!((found - 2.0 * (1.0 + late)).abs() < 1e-9, "{solver}: {found} at {late} s");
            }
        }
    }
}

/// The same where nothing makes steps between the edges of the source within: a step passes several of them on its way to the trigger.
#[test]
fn an_instant_that_coincides_behind_many_others_does_so_as_well() {
    let sub = r#"Diagram(outputs: { "y": "p.y" }, blocks: { "p": Pulse(period: "0.2 s", width: 0.5, delay: "0.1 s") })"#;
    for parameter in ["trigger: Rising", "enable: Held"] {
        for k in 1..60 {
            let port = parameter.split(':').next().unwrap_or_default();
            let model = format!(
                r#"Diagram(simulation: (stop_time: "6.5 s"), blocks: {{
                    "go": Step(time: "{} s"), "s": Subsystem(file: "sub.ron", {parameter}), "z": ZeroOrderHold(ts: "{} s"),
                    "show": Scope(inputs: ["y"]) }},
                  connections: ["go.y -> s.{port}", "s.y -> z.u", "z.y -> show.y"])"#,
                f64::from(k) / 10.0,
                f64::from(k) / 10.0,
            );
            let run = run(&[("model.ron", &model), ("sub.ron", sub)]);
            let at = f64::from(k) / 10.0;
            let found =
                run.column("show.y").into_iter().rfind(|(t, _)| (t - at).abs() < 1e-6).expect("a row").1;
            assert_eq!(found, f64::from(k % 2), "{parameter} at {at} s");
        }
    }
}
