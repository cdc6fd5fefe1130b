//! Absolute tolerances of single states, and automatic ones of states whose sizes lie far apart.

use std::f64::consts::TAU;

use blocksim_tests::{Run, compile_text, run_blocks, run_text};

fn diagram(settings: &str, blocks: &str, connections: &str) -> String {
    format!("Diagram(simulation: ({settings}), blocks: {{ {blocks} }}, connections: [ {connections} ])")
}

/// A state that begins at a million and decays: how much of its value is wrong after 30 time constants.
fn decay(atol: &str) -> (Run, f64) {
    let run = run_text(&diagram(
        &format!("stop_time: 30, {atol}"),
        r#""none": Constant(value: 0), "x": LowPass(tau: 1, y0: 1e6), "show": Scope(inputs: ["x"])"#,
        r#""none.y -> x.u", "x.y -> show.x""#,
    ));
    let error = (run.last("show.x") / (1e6 * (-30.0_f64).exp()) - 1.0).abs();
    (run, error)
}

#[test]
fn a_tolerance_of_its_own_lets_a_state_be_followed_below_what_it_once_was() {
    let (plain, coarse) = decay("");
    for name in ["x", "x.x"] {
        let (close, fine) = decay(&format!(r#"atol: {{ "{name}": 1e-15 }}"#));
        assert!(fine < 1e-4 && coarse > 10.0 * fine, "{name}: {fine:e} instead of {coarse:e}");
        assert!(close.counts.evaluations > plain.counts.evaluations);
    }
    // Of two the one that is closer to the state holds.
    let (_, both) = decay(r#"atol: { "x": 1e3, "x.x": 1e-15 }"#);
    assert!(both < 1e-4, "{both:e}");
    let (loose, _) = decay(r#"atol: { "x": 1e3 }"#);
    assert!(loose.counts.evaluations < plain.counts.evaluations);
    // Beside one for all.
    let (_, beside) = decay(r#"solver: Auto(atol: 1), atol: { "x": 1e-15 }"#);
    assert!(beside < 1e-4, "{beside:e}");
}

#[test]
fn a_part_of_a_circuit_may_have_a_tolerance_in_its_unit() {
    let circuit = |atol: &str| {
        compile_text(&diagram(
            &format!("stop_time: 1, atol: {{ {atol} }}"),
            r#""u": VoltageSource(v: "1 V"), "r": Resistor(r: "1 ohm"), "coil": Inductor(l: "1 mH"), "store": Capacitor(c: "1 uF"), "g": ElectricalReference"#,
            r#""u.p <-> r.p", "r.n <-> coil.p", "coil.n <-> store.p", "store.n <-> u.n <-> g.p""#,
        ))
    };
    let (compiled, problems) = circuit(r#""coil": "1 nA", "store.v": "1 uV""#);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let found: Vec<(&str, f64, usize)> =
        schedule.settings.atol.iter().map(|one| (one.name.as_str(), one.value, one.states.len())).collect();
    assert_eq!(found, [("coil", 1e-9, 1), ("store.v", 1e-6, 1)]);
    for (atol, message, help) in [
        (r#""coil": "1 nV""#, "`coil.i` is measured in A, but its tolerance is in", ""),
        (r#""r": "1 nA""#, "`r` has no continuous states, so no tolerance", ""),
        (r#""stor": "1 nV""#, "there is no block or state `stor`", "did you mean `store`?"),
        (r#""store": 0"#, "`atol` of `store` is 0, but must be positive", ""),
        (r#""store": true"#, "`atol` of `store` must be a number, not", ""),
    ] {
        let (compiled, problems) = circuit(atol);
        assert!(compiled.schedule.is_none() || problems.contains("error"), "{atol}");
        assert!(problems.contains(message) && problems.contains(help), "{atol}: {problems}");
    }
    let (_, problems) = compile_text(&diagram(
        r#"stop_time: 1, solver: Ode4(step: "1 ms"), atol: { "x": 1 }"#,
        r#""one": Constant(value: 1), "x": Integrator"#,
        r#""one.y -> x.u""#,
    ));
    assert!(problems.contains("Ode4 has no tolerances: its step is fixed"), "{problems}");
}

/// The states of a state space are those of the user, whatever their sizes: an oscillator of 1e4 rad/s, damped by 0.01, with its
/// second state in units that are up to 1e12 too small or too large. The automatic tolerances do what a balancing of the matrices
/// would.
#[test]
fn a_state_space_whose_states_differ_by_many_powers_of_ten_needs_no_balance() {
    let (w, damping) = (1e4_f64, 0.01_f64);
    let fast = w * (1.0 - damping * damping).sqrt();
    for (solver, within) in [("Auto", 2e-5), ("Radau5", 1e-6), ("Ode15s", 4e-4)] {
        let mut work = Vec::new();
        for k in [1.0, 1e4, 1e8, 1e-8, 1e12] {
            let run = run_text(&diagram(
                &format!(r#"stop_time: "20 ms", solver: {solver}"#),
                &format!(
                    r#""u": Constant(value: 1), "show": Scope(inputs: ["y"]),
                       "g": StateSpace(a: [[0, {:e}], [{:e}, {}]], b: [[0], [{:e}]], c: [[1, 0]])"#,
                    1.0 / k,
                    -w * w * k,
                    -2.0 * damping * w,
                    w * w * k
                ),
                r#""u.y -> g.u", "g.y -> show.y""#,
            ));
            for (t, y) in run.time.iter().zip(run.column("show.y")) {
                let swing = (fast * t).cos() + damping * w / fast * (fast * t).sin();
                let error = y - (1.0 - (-damping * w * t).exp() * swing);
                assert!(error.abs() < within, "{solver}, {k:e} at {t}: {error:e}");
            }
            work.push(run.counts.accepted);
        }
        let (least, most) = (work.iter().min(), work.iter().max());
        assert!(most.zip(least).is_some_and(|(most, least)| 2 * most < 3 * least), "{solver}: {work:?}");
    }
}

/// An oscillation of 1e-20 for twenty seconds, its size brought to one, by a method and with tolerances.
fn tiny(settings: &str) -> Run {
    run_text(&diagram(
        &format!("stop_time: 20, {settings}"),
        r#""x": Integrator(x0: 1e-20), "v": Integrator, "minus": Gain(k: -1), "show": Scope(inputs: ["x"])"#,
        r#""v.y -> x.u", "x.y -> minus.u, show.x", "minus.y -> v.u""#,
    ))
}

fn ignored(run: &Run) -> Vec<String> {
    let told = run.warnings.iter().filter(|warning| warning.code == "ignored_state");
    told.map(|warning| format!("{} ({})", warning.message, warning.help.as_deref().unwrap_or("no help")))
        .collect()
}

/// Below `rtol` times 1e-12 a state counts as nothing, so this one may be noise: that is said, with what helps, and it does help.
#[test]
fn a_state_that_lies_below_its_tolerance_all_the_time_is_named_with_a_remedy_that_helps() {
    let exact = 1e-20 * 20.0_f64.cos();
    for (method, allowed) in
        [("Auto", 1e-4), ("Ode15s", 1e-3), ("Radau5", 1e-4), ("Ode23t", 1e-2), ("RosW3", 1e-3)]
    {
        let run = tiny(&format!("solver: {method}"));
        let told = ignored(&run);
        assert_eq!(told.len(), 1, "{method}: {told:?}");
        for part in [
            "no step was chosen for `v.x`, `x.x`, which are never larger than the absolute tolerance",
            "its tolerance is 1e-18",
            r#"give it a tolerance of its own: `simulation: (atol: {"v.x": "#,
        ] {
            assert!(told[0].contains(part), "{method}: {part} is not in {}", told[0]);
        }
        let run = tiny(&format!(r#"solver: {method}, atol: {{ "x": 1e-26, "v": 1e-26 }}"#));
        assert_eq!(ignored(&run), [""; 0], "{method}");
        let error = (run.last("show.x") - exact).abs() / 1e-20;
        assert!(error < allowed, "{method}: {error:e}");
    }
    // Without the remedy it may indeed be noise.
    assert!((tiny("solver: Ode15s").last("show.x") - exact).abs() > 0.1 * 1e-20);
}

#[test]
fn a_tolerance_that_is_larger_than_what_it_is_for_is_told_be_it_for_one_state_or_for_all() {
    for (settings, told) in [
        (r#"atol: { "x": 100 }"#, true),
        ("solver: Ode45(atol: 1e300)", true),
        (r#"atol: { "x": 0.5 }"#, false),
        ("solver: Ode45(atol: 0.5)", false),
        ("", false),
        (r#"solver: Ode4(step: "1 ms")"#, false),
    ] {
        let run = run_text(&diagram(
            &format!("stop_time: 1, {settings}"),
            r#""none": Constant(value: 0), "x": LowPass(tau: 1, y0: 1), "show": Scope(inputs: ["x"])"#,
            r#""none.y -> x.u", "x.y -> show.x""#,
        ));
        let found = ignored(&run);
        assert_eq!(found.len(), usize::from(told), "{settings}: {found:?}");
        assert!(
            found.iter().all(|text| text.contains("`x.x`, which is never") && text.contains("leave it out")),
            "{found:?}"
        );
    }
}

/// Zero, constant, zero but for rounding, on its way: of these nobody wants to hear.
#[test]
fn states_that_are_zero_or_at_rest_or_only_arriving_are_not_named() {
    for method in ["Auto", "Ode15s", "Radau5", "Rodas4", "Ode23t", "Ode23tb", "Dop853", "Ode23", "RosW3"] {
        // Three phases whose sum is rounding, a PI controller whose filter has nothing to do, a tiny constant.
        let run = run_text(&diagram(
            &format!("stop_time: 2, solver: {method}"),
            r#""a": Sine(amplitude: 300, frequency: "1 Hz"), "b": Sine(amplitude: 300, frequency: "1 Hz", phase: "120 deg"),
               "c": Sine(amplitude: 300, frequency: "1 Hz", phase: "240 deg"), "sum": Sum(signs: "+++"), "k": Gain(k: 1e-6),
               "rounding": LowPass(tau: 0.1), "control": Pid(kp: 2, ki: 1), "plant": LowPass(tau: 0.5), "error": Sum(signs: "+-"),
               "zero": Constant(value: 0), "still": Integrator(x0: 1e-30), "nothing": LowPass(tau: 1), "show": Scope(inputs: ["x"])"#,
            r#""a.y -> sum.u1, error.u1", "b.y -> sum.u2", "c.y -> sum.u3", "sum.y -> k.u", "k.y -> rounding.u", "rounding.y -> show.x",
               "error.y -> control.e", "control.u -> plant.u", "plant.y -> error.u2", "zero.y -> still.u, nothing.u""#,
        ));
        assert_eq!(ignored(&run), [""; 0], "{method}");
    }
    // The warmth has only just reached the far end of a rod of sixty cells: 1e-40 of what goes in.
    let cells = 60;
    let blocks: String = (0..cells).map(|i| format!("\"t{i}\": LowPass(tau: 1), ")).collect();
    let chain: String = (1..cells).map(|i| format!("\"t{}.y -> t{i}.u\", ", i - 1)).collect();
    let run = run_text(&diagram(
        "stop_time: 3",
        &format!(r#""one": Constant(value: 1), {blocks} "show": Scope(inputs: ["x"])"#),
        &format!(r#""one.y -> t0.u", {chain} "t{}.y -> show.x""#, cells - 1),
    ));
    assert!(run.last("show.x") < 1e-30 && run.last("show.x") > 0.0, "{:e}", run.last("show.x"));
    assert_eq!(ignored(&run), [""; 0]);
}

/// What spins about its centre of mass and falls: its places and speeds across are zero but for rounding, of which hardly a step is thrown
/// away where the size of steps has settled to what it lets pass.
#[test]
fn what_spins_and_falls_is_not_held_up_by_rounding_across() {
    for (method, rtol, most) in
        [("Dop853", 1e-6, 500), ("Dop853", 1e-8, 3000), ("Radau5", 1e-6, 500), ("Radau5", 1e-8, 2000)]
    {
        let run = run_blocks(
            "2 s",
            &format!("{method}(rtol: {rtol:e})"),
            r#""w": World, "j": FreeJoint(spin: [1, 5, 0.5]), "show": Scope(inputs: ["x"]),
               "b": Body(mass: 2, moi: [0.05, 0.08, 0.04], poi: [0.006, -0.003, 0.004])"#,
            r#""w.frame <-> j.base", "j.follower <-> b.frame", "j.x -> show.x""#,
        );
        for (place, expected) in [(0, 0.0), (1, 0.0), (2, -2.0 * 9.80665)] {
            let found = run.last(&format!("show.x[{place}]"));
            assert!((found - expected).abs() < 20.0 * rtol, "{method} at {rtol:e}, {place}: {found}");
        }
        assert!(run.counts.accepted < most, "{method} at {rtol:e}: {} steps", run.counts.accepted);
    }
}

/// A rod with a ball at each end that only turns about itself: the loop holds a slider still, whose speed is what the errors of all others
/// make of nothing.
#[test]
fn a_speed_that_a_closed_loop_holds_at_nothing_costs_no_steps() {
    let blocks = r#""world": World,
        "slide": PrismaticJoint(axis: [1, 0, 0], position: 0.1, stiffness: 70), "block": Body(mass: 2),
        "ball": SphericalJoint(rpy: [0, "30 deg", "20 deg"]),
        "rod": Body(mass: 1, com: [0, 0.1, "-0.25 m"], moi: [0.02, 0.03, 0.01]),
        "tip": Transform(translation: [0, 0, "-0.5 m"]), "other": SphericalJoint,
        "pivot": Transform(translation: [-0.13492315519647707, -0.08550503583141716, -0.43301270189221935]),
        "scope": Scope(inputs: ["x"])"#;
    let connections = r#""world.frame <-> slide.base <-> pivot.base", "slide.follower <-> block.frame <-> ball.base",
        "ball.follower <-> rod.frame <-> tip.base", "tip.follower <-> other.follower", "pivot.follower <-> other.base",
        "slide.x -> scope.x""#;
    let most =
        [("Ode45", 150), ("RosW3", 450), ("Rodas4", 150), ("Radau5", 250), ("Ode23t", 1500), ("Auto", 250)];
    for (method, most) in most {
        let run = run_blocks("1 s", &format!("{method}(rtol: 1e-6)"), blocks, connections);
        assert!(run.error.is_none(), "{method}: {:?}", run.error);
        assert!(run.counts.accepted < most, "{method}: {:?}", run.counts);
    }
}

/// Four bars and a spring without damping: nothing is dissipated but rounding, which an account of energy sums up.
#[test]
fn an_account_of_energy_is_not_followed_into_its_rounding() {
    let four = |account: &str| {
        let blocks = format!(
            r#""world": World, "ground": Transform(translation: ["0.5 m", "0 m", "0 m"]),
            "a": RevoluteJoint(axis: [0, -1, 0], position: "60 deg", velocity: "5 rad/s"), "b": RevoluteJoint(axis: [0, -1, 0]),
            "c": RevoluteJoint(axis: [0, -1, 0], stiffness: 0.1), "d": RevoluteJoint(axis: [0, -1, 0]),
            "left": Body(mass: "0.8 kg", com: ["0.1 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.006 kg*m^2", "0.006 kg*m^2"]),
            "left_end": Transform(translation: ["0.2 m", "0 m", "0 m"]),
            "coupler": Body(mass: "1.1 kg", com: ["0.2 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.01 kg*m^2", "0.01 kg*m^2"]),
            "coupler_end": Transform(translation: ["0.45 m", "0 m", "0 m"]),
            "right": Body(mass: "0.9 kg", com: ["0.2 m", "0 m", "0 m"], moi: ["0 kg*m^2", "0.01 kg*m^2", "0.01 kg*m^2"]),
            "right_end": Transform(translation: ["0.4 m", "0 m", "0 m"]), "scope": Scope(inputs: ["q"]){account}"#
        );
        let node = if account.is_empty() {
            ""
        } else {
            r#", "world.frame <-> books.node", "books.relative -> scope.share""#
        };
        let blocks =
            if account.is_empty() { blocks } else { blocks.replace(r#"["q"]"#, r#"["q", "share"]"#) };
        let connections = format!(
            r#""world.frame <-> a.base <-> ground.base", "a.follower <-> left.frame <-> left_end.base",
            "left_end.follower <-> b.base", "b.follower <-> coupler.frame <-> coupler_end.base",
            "coupler_end.follower <-> c.base", "c.follower <-> right_end.follower",
            "right_end.base <-> right.frame <-> d.follower", "d.base <-> ground.follower", "a.q -> scope.q"{node}"#
        );
        let run = run_blocks("2 s", "RosW3(rtol: 1e-5)", &blocks, &connections);
        assert!(run.error.is_none(), "{:?}", run.error);
        run
    };
    let (with, without) = (four(r#", "books": EnergyAccount(at: Frame)"#), four(""));
    assert!(with.counts.accepted < 4 * without.counts.accepted, "{:?} and {:?}", with.counts, without.counts);
    // It balances to what the method leaves.
    assert!(with.last("scope.share").abs() < 1e-4, "{}", with.last("scope.share"));
    assert!((with.last("scope.q") - without.last("scope.q")).abs() < 1e-2);
}

/// Joints that no loop holds are as exact beside one as without it: a slider of 1 mm beside a flywheel of 300 rad/s and a parallelogram.
#[test]
fn a_loop_does_not_make_what_is_beside_it_inexact() {
    let blocks = r#""world": World, "ground": Transform(translation: ["0.5 m", "0 m", "0 m"]),
        "a": RevoluteJoint(axis: [0, -1, 0], position: "-90 deg"), "b": RevoluteJoint(axis: [0, -1, 0], position: "90 deg"),
        "c": RevoluteJoint(axis: [0, -1, 0]), "d": RevoluteJoint(axis: [0, -1, 0]),
        "left": Body(mass: 0.8, com: [0.15, 0, 0], moi: [0, 0.006, 0.006]), "left_end": Transform(translation: [0.3, 0, 0]),
        "coupler": Body(mass: 1.1, com: [0.2, 0, 0], moi: [0, 0.01, 0.01]), "coupler_end": Transform(translation: [0.5, 0, 0]),
        "right": Body(mass: 0.8, com: [0.15, 0, 0], moi: [0, 0.006, 0.006]), "right_end": Transform(translation: [0.3, 0, 0]),
        "spin": RevoluteJoint(velocity: 300), "wheel": Body(mass: 2, moi: [0.1, 0.1, 0.2]),
        "slide": PrismaticJoint(axis: [1, 0, 0], position: "1 mm", stiffness: 1000), "block": Body(mass: 1), "scope": Scope(inputs: ["x"])"#;
    let connections = r#""world.frame <-> a.base <-> ground.base <-> spin.base <-> slide.base", "spin.follower <-> wheel.frame",
        "slide.follower <-> block.frame", "slide.x -> scope.x", "a.follower <-> left.frame <-> left_end.base", "left_end.follower <-> b.base",
        "b.follower <-> coupler.frame <-> coupler_end.base", "coupler_end.follower <-> c.base", "c.follower <-> right_end.follower",
        "right_end.base <-> right.frame <-> d.follower", "d.base <-> ground.follower""#;
    for method in ["Auto", "Ode45", "Radau5"] {
        let run = run_blocks("20 s", &format!("{method}(rtol: 1e-6)"), blocks, connections);
        assert!(run.error.is_none(), "{method}: {:?}", run.error);
        let expected = 1e-3 * (1000.0_f64.sqrt() * 20.0).cos();
        let off = (run.last("scope.x") - expected).abs();
        assert!(off < 2e-6, "{method}: off by {off:.1e} m");
    }
}

/// The slow motion `z = x^2` in units that lie sixteen decades apart. The least automatic tolerance follows `y` and would be a hundredth of
/// all that `x` ever is; but `x` and `z` have sizes of their own.
#[test]
fn states_of_very_different_units_are_followed_without_a_word() {
    let solve = |method: &str| {
        run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "10 s", solver: {method}),
                blocks: {{
                    "s": OdeSystem(
                        law: "x' = -1e3*x + 1e-9*cos(y/1e6); y' = 1e6*(1 - 100*x/1e-9); z' = -1e5*(z - 1e-8*(x/1e-9)^2)",
                        start: {{ "x": 1e-9, "y": 1e6, "z": 0 }},
                    ),
                    "show": Scope(inputs: ["x", "z"]),
                }},
                connections: ["s.x -> show.x", "s.z -> show.z"],
            )"#
        ))
    };
    let off = |run: &Run| {
        let pairs = run.column("show.x").iter().zip(run.column("show.z")).zip(&run.time);
        let late = pairs.filter(|(_, t)| **t > 1.0);
        late.map(|((x, z), _)| (z / 1e-8 - (x / 1e-9).powi(2)).abs()).fold(0.0, f64::max)
    };
    for method in ["Auto", "Ode15s", "Ode23t", "Ode23tb", "Radau5", "Rodas4", "RosW3"] {
        let plain = solve(method);
        assert_eq!(ignored(&plain), [""; 0], "{method}");
        assert!(off(&plain) < 1e-8, "{method}: {:e}", off(&plain));
    }
}

/// Sample times end steps, and a filter behind a hold moves by a few time constants a step: lengths at which an error estimate may be
/// zero by itself. Against the exact map from hit to hit, for time constants from far below a step to far above it.
#[test]
fn no_time_constant_behind_a_hold_hides_from_an_error_estimate() {
    let methods =
        ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Radau5", "Rodas4", "RosW3", "Ode23t", "Ode23tb"];
    let wave = |k: f64| (TAU * 0.07 * k).sin();
    let taus: Vec<f64> =
        (0..56).map(|i| 0.004 * 10_f64.powf(f64::from(i) / 28.0)).chain([0.05, 0.1, 0.025]).collect();
    for method in methods {
        for &tau in &taus {
            let run = run_text(&format!(
                r#"Diagram(simulation: (stop_time: "3 s", solver: {method}(rtol: 1e-4), output: Every("0.1 s")), blocks: {{
                    "wave": Sine(amplitude: 1, frequency: "0.7 Hz"), "hold": ZeroOrderHold(ts: "0.1 s"), "filter": LowPass(tau: "{tau} s"),
                    "show": Scope(inputs: ["y"]) }},
                   connections: ["wave.y -> hold.u", "hold.y -> filter.u", "filter.y -> show.y"])"#
            ));
            let decay = (-0.1 / tau).exp();
            let mut exact = 0.0;
            let mut worst = 0.0_f64;
            for (k, y) in run.column("show.y").iter().enumerate() {
                worst = worst.max((y - exact).abs());
                exact = decay * exact + (1.0 - decay) * wave(k as f64);
            }
            assert!(worst < 6e-4, "{method}, {tau} s: {worst:.1e}");
        }
    }
}
