//! Diagrams as they are written, with default settings: right whatever the sizes of their states, and whatever a trial step
//! tries.

use blocksim_block::schedule::VariableMethod;
use blocksim_tests::accounts::solved_by;
use blocksim_tests::{compile_text, run, run_blocks, run_text, schedule};

#[test]
fn a_fast_and_weakly_damped_transfer_function_is_right() {
    let result = run_text(
        r#"Diagram(
    simulation: (stop_time: "50 ms"),
    blocks: {
        "u": Step(time: "1 ms", after: 1),
        "g": TransferFunction(num: [1e8], den: [1, 200, 1e8]),
        "show": Scope(inputs: ["y"]),
    },
    connections: ["u.y -> g.u", "g.y -> show.y"],
)"#,
    );
    let (damping, swing) = (100.0_f64, f64::sqrt(1e8 - 1e4));
    let mut worst = 0.0_f64;
    for (t, y) in result.time.iter().zip(result.column("show.y")) {
        let t = t - 1e-3;
        let ring = (-damping * t).exp() * ((swing * t).cos() + damping / swing * (swing * t).sin());
        worst = worst.max((y - if t > 0.0 { 1.0 - ring } else { 0.0 }).abs());
    }
    assert!(worst < 1e-4, "{worst:e}");
}

#[test]
fn a_circuit_that_swings_with_a_microvolt_neither_grows_nor_decays() {
    // 1 mH and 1 uF: 31.6 krad/s, 250 periods.
    for volts in [1e-6, 1e-9] {
        let result = run_text(&format!(
            r#"Diagram(
    simulation: (stop_time: "50 ms"),
    blocks: {{
        "g": ElectricalReference,
        "c": Capacitor(c: "1 uF", v0: "{volts} V"),
        "l": Inductor(l: "1 mH"),
        "show": Scope(inputs: ["v"]),
    }},
    connections: ["c.p <-> l.p", "c.n <-> l.n <-> g.p", "c.v -> show.v"],
)"#
        ));
        let w = 1.0 / f64::sqrt(1e-9);
        for (t, v) in result.time.iter().zip(result.column("show.v")) {
            assert!((v / volts - (w * t).cos()).abs() < 2e-2, "{volts} V: {v:e} at {t}");
        }
        let late = result.time.iter().zip(result.column("show.v")).filter(|(t, _)| **t > 0.049);
        let amplitude = late.fold(0.0, |largest: f64, (_, v)| largest.max(v.abs())) / volts;
        assert!((amplitude - 1.0).abs() < 0.02, "{amplitude}");
    }
}

/// A lag of 0.1 s that falls from 1 to 0.001 at 5 s; its root is integrated. Steps have become long by then.
fn rooted(after: f64) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "8 s"),
    blocks: {{
        "u": Step(time: "5 s", before: 1, after: {after}),
        "lag": LowPass(tau: "100 ms", y0: 1),
        "root": Function(function: Sqrt),
        "sum": Integrator,
        "show": Scope(inputs: ["x"]),
    }},
    connections: ["u.y -> lag.u", "lag.y -> root.u", "root.y -> sum.u", "sum.y -> show.x"],
)"#
    )
}

#[test]
fn a_trial_step_that_leaves_the_domain_of_a_root_is_made_smaller() {
    let result = run_text(&rooted(0.001));
    // The integral of sqrt(a + b exp(-s)), with r = sqrt(a + b) at the start: 2 (r0 - r1) + sqrt(a) ln(...), in units of tau.
    let (a, b) = (0.001_f64, 0.999_f64);
    let (root, end) = (a.sqrt(), (a + b * (-30.0_f64).exp()).sqrt());
    let part = |r: f64| -2.0 * r + root * ((r + root) / (r - root)).ln();
    // Where r is a to rounding, r - root is b exp(-s) / (2 root).
    let last = -2.0 * end + root * ((2.0 * root).powi(2) / b).ln() + root * 30.0;
    let expected = 5.0 + 0.1 * (last - part((a + b).sqrt()));
    let found = result.last("show.x");
    assert!((found - expected).abs() < 2e-6, "{found} instead of {expected}");
    assert!(result.counts.rejected > 0, "{:?}", result.counts);
}

#[test]
fn a_solution_that_leaves_the_domain_is_an_error_with_its_time_and_block() {
    let (compiled, problems) = compile_text(&rooted(-1.0));
    let result = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = result.error.expect("the root of a negative number");
    // 1 - 2 (1 - exp(-s)) is zero at s = ln 2.
    assert!((error.t - (5.0 + 0.1 * 2f64.ln())).abs() < 1e-4, "{error}");
    assert_eq!((error.code, error.path.as_deref()), ("block_failed", Some("root")), "{error}");
    assert!(error.message.contains("Sqrt has no value"), "{error}");
}

/// Steps of `RosW3` on what is free in the plane and turns about a centre of mass beside its frame: `x = a (1 - cos w t)`. The mass
/// matrix depends on the angle.
#[test]
fn rosw3_follows_a_body_with_its_centre_of_mass_aside() {
    let mut steps = Vec::new();
    for rtol in [1e-5, 1e-8] {
        let run = run_blocks(
            "2 s",
            &format!("RosW3(rtol: {rtol:e})"),
            r#""w": World(gravity: [0, 0, 0]), "j": PlanarJoint(speed: 5), "show": Scope(inputs: ["x", "q"]),
               "b": Body(mass: 2, moi: [0.05, 0.08, 0.04], com: [0.1, 0, 0])"#,
            r#""w.frame <-> j.base", "j.follower <-> b.frame", "j.x -> show.x", "j.q -> show.q""#,
        );
        let [x, y, q] = ["show.x[0]", "show.x[1]", "show.q"].map(|path| run.last(path));
        let (sine, cosine) = 10_f64.sin_cos();
        // The frame goes along with the speed that the centre begins with.
        let expected = [0.1 * (1.0 - cosine), 1.0 - 0.1 * sine, 10.0];
        for (found, expected) in [x, y, q].into_iter().zip(expected) {
            assert!((found - expected).abs() < 20.0 * rtol, "{rtol:e}: {found} in the place of {expected}");
        }
        steps.push(run.counts.accepted as f64);
    }
    // Order three: a thousandth of the tolerance takes ten times as many steps, and 32 with an order lost.
    assert!(steps[1] < 13.0 * steps[0], "{steps:?}");
}

/// The same with hinges on bodies that move, and where bodies close a loop, against a method of order eight.
#[test]
fn rosw3_keeps_its_order_in_trees_and_loops_of_bodies() {
    for path in ["double_pendulum", "four_bar"] {
        let by = |method, rtol| {
            let mut schedule = schedule(&format!("diagrams/{path}.ron"), &[]);
            schedule.settings.stop_time = 1.0;
            run(solved_by(schedule, method, rtol))
        };
        let exact = by(VariableMethod::Dop853, 1e-11);
        let [loose, tight] = [1e-5, 1e-8].map(|rtol| {
            let found = by(VariableMethod::RosW3, rtol);
            for (recorded, column) in exact.recorded.iter().zip(&exact.columns) {
                let size = column.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
                let (found, expected) = (found.last(&recorded.path), exact.last(&recorded.path));
                assert!(
                    (found - expected).abs() <= 500.0 * rtol * size,
                    "{path}, {rtol:e}, {}: {found} {expected}",
                    recorded.path
                );
            }
            found.counts.accepted
        });
        assert!(tight < 13 * loose, "{path}: {loose} and {tight} steps");
    }
}
