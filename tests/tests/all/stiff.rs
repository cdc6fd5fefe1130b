//! Stiff problems of the literature as diagrams, with default settings: published end values, and what they cost.

use std::fmt::Write;

use blocksim_tests::{Run, run_text};

/// A part of a derivative: a factor, in 1/s, and the states that it is multiplied by.
type Term = (f64, &'static [usize]);

/// A diagram of integrators whose derivatives are polynomials.
fn polynomial(start: &[f64], derivatives: &[Vec<Term>], stop: f64, solver: &str) -> Run {
    let (mut blocks, mut connections) = (String::new(), String::new());
    let mut shown = Vec::new();
    for (i, (x0, terms)) in start.iter().zip(derivatives).enumerate() {
        writeln!(
            blocks,
            r#""x{i}": Integrator(x0: {x0:e}), "d{i}": Sum(signs: "{}"),"#,
            "+".repeat(terms.len())
        )
        .expect("text");
        let many = terms.len() > 1;
        for (k, (factor, states)) in terms.iter().enumerate() {
            let into = if many { format!("d{i}.u{}", k + 1) } else { format!("d{i}.u") };
            match states {
                [] => writeln!(blocks, r#""k{i}_{k}": Constant(value: "{factor:e} 1/s"),"#).expect("text"),
                states => {
                    writeln!(blocks, r#""k{i}_{k}": Gain(k: "{factor:e} 1/s"),"#).expect("text");
                    let from = if let [one] = states {
                        format!("x{one}.y")
                    } else {
                        let signs = "*".repeat(states.len());
                        writeln!(blocks, r#""p{i}_{k}": Product(inputs: {}),"#, signs.len()).expect("text");
                        for (port, state) in states.iter().enumerate() {
                            writeln!(connections, r#""x{state}.y -> p{i}_{k}.u{}","#, port + 1)
                                .expect("text");
                        }
                        format!("p{i}_{k}.y")
                    };
                    writeln!(connections, r#""{from} -> k{i}_{k}.u","#).expect("text");
                }
            }
            writeln!(connections, r#""k{i}_{k}.y -> {into}","#).expect("text");
        }
        shown.push(format!(r#""x{i}""#));
        writeln!(connections, r#""d{i}.y -> x{i}.u", "x{i}.y -> show.x{i}","#).expect("text");
    }
    run_text(&format!(
        "Diagram(simulation: (stop_time: {stop:e}, solver: {solver}), blocks: {{ {blocks} \"show\": Scope(inputs: [{}]) }}, \
         connections: [ {connections} ])",
        shown.join(", ")
    ))
}

struct Problem {
    name: &'static str,
    start: Vec<f64>,
    derivatives: Vec<Vec<Term>>,
    stop: f64,
    /// Values at the end, and what an error counts against at least.
    end: Vec<f64>,
    least: f64,
    /// Most that an error may be, in relative tolerances.
    within: f64,
    /// Steps and evaluations at relative tolerances of 1e-4, 1e-6, 1e-8.
    work: [[u64; 2]; 3],
}

/// F. Mazzia, C. Magherini: Test Set for Initial Value Problem Solvers, release 2.4 (2008); Robertson's reaction and Van der Pol's
/// oscillator as in E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section IV.10.
fn problems() -> Vec<Problem> {
    let w = 77.27;
    vec![
        Problem {
            name: "Van der Pol, mu = 1000",
            start: vec![2.0, 0.0],
            derivatives: vec![vec![(1.0, &[1])], vec![(1000.0, &[1]), (-1000.0, &[0, 0, 1]), (-1.0, &[0])]],
            stop: 2000.0,
            end: vec![1.706_167_732_170_469, -0.892_809_701_024_812_5e-3],
            least: 0.0,
            within: 200.0,
            work: [[423, 2009], [668, 3132], [1313, 5762]],
        },
        Problem {
            name: "Robertson",
            start: vec![1.0, 0.0, 0.0],
            derivatives: vec![
                vec![(-0.04, &[0]), (1e4, &[1, 2])],
                vec![(0.04, &[0]), (-1e4, &[1, 2]), (-3e7, &[1, 1])],
                vec![(3e7, &[1, 1])],
            ],
            stop: 1e11,
            end: vec![2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505],
            least: 1e-3,
            within: 120.0,
            work: [[433, 1475], [749, 2439], [1298, 4124]],
        },
        Problem {
            name: "HIRES",
            start: vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
            derivatives: vec![
                vec![(-1.71, &[0]), (0.43, &[1]), (8.32, &[2]), (0.0007, &[])],
                vec![(1.71, &[0]), (-8.75, &[1])],
                vec![(-10.03, &[2]), (0.43, &[3]), (0.035, &[4])],
                vec![(8.32, &[1]), (1.71, &[2]), (-1.12, &[3])],
                vec![(-1.745, &[4]), (0.43, &[5]), (0.43, &[6])],
                vec![(-280.0, &[5, 7]), (0.69, &[3]), (1.71, &[4]), (-0.43, &[5]), (0.69, &[6])],
                vec![(280.0, &[5, 7]), (-1.81, &[6])],
                vec![(-280.0, &[5, 7]), (1.81, &[6])],
            ],
            stop: 321.8122,
            end: vec![
                0.737_131_257_332_566_8e-3,
                0.144_248_572_631_618_5e-3,
                0.588_872_974_096_757_5e-4,
                0.117_565_134_328_314_9e-2,
                0.238_635_619_883_133_1e-2,
                0.623_896_825_274_279_6e-2,
                0.284_999_839_518_576_9e-2,
                0.285_000_160_481_423_1e-2,
            ],
            least: 0.0,
            within: 120.0,
            work: [[165, 699], [309, 1222], [611, 2325]],
        },
        Problem {
            name: "Oregonator",
            start: vec![1.0, 2.0, 3.0],
            derivatives: vec![
                vec![(w, &[1]), (w, &[0]), (-w * 8.375e-6, &[0, 0]), (-w, &[0, 1])],
                vec![(1.0 / w, &[2]), (-1.0 / w, &[1]), (-1.0 / w, &[0, 1])],
                vec![(0.161, &[0]), (-0.161, &[2])],
            ],
            stop: 360.0,
            end: vec![0.100_081_487_031_852_3e1, 0.122_817_852_154_991_7e4, 0.132_055_494_284_670_6e3],
            least: 0.0,
            within: 400.0,
            work: [[583, 2473], [1116, 4370], [2238, 8190]],
        },
    ]
}

#[test]
fn stiff_diagrams_end_where_the_literature_says() {
    let mut found = Vec::new();
    for problem in problems() {
        let mut work = [[0; 2]; 3];
        for (rtol, work) in [1e-4, 1e-6, 1e-8].into_iter().zip(&mut work) {
            let solver = if rtol == 1e-6 { "Auto".to_owned() } else { format!("Auto(rtol: {rtol:e})") };
            let run = polynomial(&problem.start, &problem.derivatives, problem.stop, &solver);
            let size = problem.end.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            for (i, expected) in problem.end.iter().enumerate() {
                let found = run.last(&format!("show.x{i}"));
                let error = (found - expected).abs() / expected.abs().max(problem.least * size);
                assert!(
                    error < problem.within * rtol,
                    "{} at {rtol:e}, x{i}: {found:e} {expected:e}",
                    problem.name
                );
            }
            *work = [run.counts.accepted, run.counts.evaluations];
        }
        found.push((problem.name, work));
    }
    let pinned: Vec<_> = problems().iter().map(|problem| (problem.name, problem.work)).collect();
    assert_eq!(found, pinned);
}

/// Few digits are asked for, but the states fall a millionfold and must not pass zero, where the reaction runs away.
#[test]
fn loose_tolerances_do_not_let_robertsons_reaction_run_away() {
    let problems = problems();
    let problem = problems.iter().find(|problem| problem.name == "Robertson").expect("the reaction");
    for rtol in [1e-2, 1e-3] {
        for solver in ["Auto", "Ode15s", "Radau5", "Ode23t", "Ode23tb"] {
            let solver = format!("{solver}(rtol: {rtol:e})");
            let run = polynomial(&problem.start, &problem.derivatives, problem.stop, &solver);
            for (i, expected) in problem.end.iter().enumerate() {
                let found = run.last(&format!("show.x{i}"));
                assert!(
                    (found / expected - 1.0).abs() < 10.0 * rtol,
                    "{solver}, x{i}: {found:e} {expected:e}"
                );
            }
        }
    }
}

/// Heat that flows into a rod whose other end is insulated, in cells: what a thousand integrators cost.
#[test]
fn a_rod_of_a_thousand_cells_is_a_diagram_of_three_thousand_blocks() {
    let n = 1000;
    let rate = f64::from(n).powi(2);
    let (mut blocks, mut connections) = (String::new(), String::new());
    for i in 0..n {
        let left = if i == 0 { "hot.y".to_owned() } else { format!("x{}.y", i - 1) };
        let right = (i + 1).min(n - 1);
        writeln!(blocks, r#""x{i}": Integrator, "d{i}": Sum(signs: "+--+"), "k{i}": Gain(k: "{rate} 1/s"),"#)
            .expect("text");
        writeln!(
            connections,
            r#""{left} -> d{i}.u1", "x{i}.y -> d{i}.u2", "x{i}.y -> d{i}.u3", "x{right}.y -> d{i}.u4", "d{i}.y -> k{i}.u", "k{i}.y -> x{i}.u","#
        )
        .expect("text");
    }
    let run = run_text(&format!(
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ {blocks} "hot": Constant(value: 1), "show": Scope(inputs: ["middle", "end"]) }},
           connections: [ {connections} "x{}.y -> show.middle", "x{}.y -> show.end" ])"#,
        n / 2 - 1,
        n - 1
    ));
    // 1 - sum of 4 / (pi k) sin(pi k s / 2) exp(-(pi k / 2)^2 t) over odd k; two are left. The cells make the rod half a cell shorter
    // at its hot end, and their own error is below 1e-6.
    for (cell, port) in [(n / 2 - 1, "show.middle"), (n - 1, "show.end")] {
        let s = (f64::from(cell) + 1.0) / f64::from(n);
        let term = |k: f64| {
            let w = std::f64::consts::PI * k / 2.0;
            2.0 / w * (w * s / 1.0005).sin() * (-(w / 1.0005).powi(2)).exp()
        };
        let (found, expected) = (run.last(port), 1.0 - term(1.0) - term(3.0));
        assert!((found - expected).abs() < 5e-6, "{port}: {found} {expected}");
    }
    assert_eq!([run.counts.accepted, run.counts.evaluations], [1078, 3955]);
    assert!(run.time.len() < 2000, "{} rows", run.time.len());
}

/// Seven stars of the masses 1 to 7 in a plane, with near encounters; not stiff. E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary
/// Differential Equations I, section II.10; coordinates at t = 3 as in F. Mazzia, C. Magherini, problem plei.
#[test]
fn the_pleiades_are_a_diagram_of_twenty_eight_states() {
    const START: [[f64; 7]; 4] = [
        [3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0],
        [3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.75, -1.5],
        [0.0, 0.0, 0.0, -1.25, 1.0, 0.0, 0.0],
    ];
    const END: [[f64; 7]; 2] = [
        [
            0.370_613_914_397_050_2,
            0.323_728_409_205_723_3e1,
            -0.322_255_903_241_832_4e1,
            0.659_709_145_577_531,
            0.342_558_170_715_658_4,
            0.156_217_210_140_063_1e1,
            -0.700_309_292_221_249_5,
        ],
        [
            -0.394_343_758_551_739_2e1,
            -3.271_380_973_972_55,
            0.522_508_184_345_654_3e1,
            -2.590_612_434_977_47,
            0.119_821_369_339_227_5e1,
            -0.242_968_234_493_582_4,
            1.091_449_240_428_98,
        ],
    ];
    let (mut blocks, mut connections, mut shown) = (String::new(), String::new(), Vec::new());
    let mut block = |text: String| blocks.push_str(&text);
    let mut connect = |from: String, to: String| writeln!(connections, r#""{from} -> {to}","#).expect("text");
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        for (i, (place, speed)) in START[axis].into_iter().zip(START[2 + axis]).enumerate() {
            block(format!(
                r#""{name}{i}": Integrator(x0: {place:?}), "v{name}{i}": Integrator(x0: {speed:?}),"#
            ));
            block(format!(r#""s{name}{i}": Gain(k: "1 1/s"), "a{name}{i}": Sum(signs: "++++++"),"#));
            connect(format!("v{name}{i}.y"), format!("s{name}{i}.u"));
            connect(format!("s{name}{i}.y"), format!("{name}{i}.u"));
            connect(format!("a{name}{i}.y"), format!("v{name}{i}.u"));
            connect(format!("{name}{i}.y"), format!("show.{name}{i}"));
            shown.push(format!(r#""{name}{i}""#));
            for j in (0..7).filter(|&j| j != i) {
                let (a, b) = (i.min(j), i.max(j));
                // The pull of star j, along the way from a to b.
                let mass = if i < j { j as f64 + 1.0 } else { -(j as f64 + 1.0) };
                block(format!(r#""m{name}{i}{j}": Gain(k: "{mass} 1/s"),"#));
                connect(format!("w{name}{a}{b}.y"), format!("m{name}{i}{j}.u"));
                let port = if j < i { j + 1 } else { j };
                connect(format!("m{name}{i}{j}.y"), format!("a{name}{i}.u{port}"));
            }
            for j in i + 1..7 {
                let pair = format!("{name}{i}{j}");
                block(format!(r#""d{pair}": Sum(signs: "+-"), "q{pair}": Product(inputs: 2),"#));
                block(format!(r#""w{pair}": Product(inputs: 2),"#));
                connect(format!("{name}{j}.y"), format!("d{pair}.u1"));
                connect(format!("{name}{i}.y"), format!("d{pair}.u2"));
                connect(format!("d{pair}.y"), format!("q{pair}.u1"));
                connect(format!("d{pair}.y"), format!("q{pair}.u2"));
                connect(format!("d{pair}.y"), format!("w{pair}.u1"));
                connect(format!("r{i}{j}.y"), format!("w{pair}.u2"));
                connect(format!("q{pair}.y"), format!("s{i}{j}.u{}", axis + 1));
            }
        }
    }
    for i in 0..7 {
        for j in i + 1..7 {
            block(format!(r#""s{i}{j}": Sum(signs: "++"), "r{i}{j}": Power(exponent: -1.5),"#));
            connect(format!("s{i}{j}.y"), format!("r{i}{j}.u"));
        }
    }
    let mut found = Vec::new();
    for rtol in [1e-4, 1e-6, 1e-8] {
        let run = run_text(&format!(
            "Diagram(simulation: (stop_time: 3, solver: Auto(rtol: {rtol:e})), blocks: {{ {blocks} \
             \"show\": Scope(inputs: [{}]) }}, connections: [ {connections} ])",
            shown.join(", ")
        ));
        let mut error = 0.0_f64;
        for (end, name) in END.into_iter().zip(["x", "y"]) {
            for (i, expected) in end.into_iter().enumerate() {
                error = error.max((run.last(&format!("show.{name}{i}")) / expected - 1.0).abs());
            }
        }
        // Each of the encounters, of which the nearest is at 0.006, multiplies errors.
        assert!(error < 2000.0 * rtol, "{rtol:e}: {error:e}");
        found.push([run.counts.accepted, run.counts.evaluations]);
    }
    assert_eq!(found, [[98, 755], [195, 1472], [461, 3062]]);
}

/// A linkage of three bars between two fixed points 0.4 m apart, on which nothing acts: speeds of 1e-15 are what closing its loop
/// leaves of them. A Newton iteration gets no nearer than rounding lets it, at any step.
#[test]
fn a_linkage_at_rest_takes_few_steps_by_every_method() {
    let methods =
        ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Radau5", "Rodas4", "RosW3", "Ode23t", "Ode23tb"];
    for method in methods {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "10 s", solver: {method}),
                blocks: {{
                    "world": World, "ground": Transform(translation: ["0.4 m", "0 m", "0 m"]),
                    "crank": RevoluteJoint(axis: [0, 1, 0]), "elbow": RevoluteJoint(axis: [0, 1, 0]),
                    "pivot": RevoluteJoint(axis: [0, 1, 0]),
                    "first": Body(mass: "1 kg", moi: ["0.1 kg*m^2", "0.1 kg*m^2", "0.1 kg*m^2"]),
                    "second": Body(mass: "1 kg", moi: ["0.1 kg*m^2", "0.1 kg*m^2", "0.1 kg*m^2"]),
                    "arm": Transform(translation: ["0.2 m", "0 m", "0 m"]),
                    "reach": Transform(translation: ["0.3 m", "0 m", "0 m"]),
                    "show": Scope(inputs: ["q", "w"]),
                }},
                connections: [
                    "world.frame <-> crank.base <-> ground.base",
                    "crank.follower <-> first.frame <-> arm.base",
                    "arm.follower <-> elbow.base",
                    "elbow.follower <-> second.frame <-> reach.base",
                    "reach.follower <-> pivot.base",
                    "pivot.follower <-> ground.follower",
                    "crank.q -> show.q", "crank.w -> show.w",
                ],
            )"#
        ));
        let q = run.column("show.q");
        let most = |column: &[f64]| column.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let moved: Vec<f64> = q.iter().map(|angle| angle - q[0]).collect();
        assert!(most(&moved) < 1e-9 && most(run.column("show.w")) < 1e-9, "{method}: {:e}", most(&moved));
        assert!(run.counts.accepted + run.counts.rejected < 1500, "{method}: {:?}", run.counts);
    }
}

/// A loop of two lags that starts at zero, and feeds quicker ones that move: it gets nothing back, so it is zero for ever, to the last
/// digit. Rounding that the elimination of the whole brought in made a condition on it change without end.
#[test]
fn what_depends_on_nothing_that_moves_stays_at_zero() {
    for solver in ["Auto", "Ode45", "Ode15s", "Radau5", "Rodas4", "Ode23t", "Ode23tb", "RosW3"] {
        for (condition, words) in [("Compare(operator: Greater, constant: 0)", "becomes"), ("Abs", "passes")]
        {
            let run = run_text(&format!(
                r#"Diagram(
                    simulation: (stop_time: "3 s", solver: {solver}),
                    blocks: {{
                        "x": LowPass(tau: "4.28e-5 s"), "b": LowPass(tau: "2.49e-4 s"), "back": Sum(signs: "+-"),
                        "c": {condition}, "step": Step(time: "0.1 s"), "sum": Sum(signs: "++"), "quick": LowPass(tau: "1e-4 s"),
                        "slow": LowPass(tau: "0.2 s"), "s": Scope(inputs: ["b", "slow", "c"]),
                    }},
                    connections: [
                        "x.y -> b.u, back.u2", "b.y -> back.u1, c.u, sum.u2, s.b", "back.y -> x.u", "step.y -> sum.u1",
                        "sum.y -> quick.u", "quick.y -> slow.u", "slow.y -> s.slow", "c.y -> s.c",
                    ],
                )"#
            ));
            assert!(run.events.iter().all(|event| !event.2.contains(words)), "{solver}: {:?}", run.events);
            assert!(run.column("s.b").iter().all(|b| *b == 0.0), "{solver}: {:?}", run.column("s.b"));
            let right = 1.0 - (-2.9_f64 / 0.2).exp();
            assert!((run.last("s.slow") - right).abs() < 1e-5, "{solver}: {}", run.last("s.slow"));
        }
    }
}

/// An oscillator of 10 rad/s beside a filter of a microsecond. What is sampled, or remembered from step to step, and only recorded bends
/// nothing: a method of many steps goes on.
#[test]
fn what_is_only_recorded_does_not_let_a_method_begin_anew() {
    let run = |solver: &str, beside: &str| {
        let (block, wires, input) = match beside {
            "" => (String::new(), "", ""),
            kind => (
                format!(r#""sine": Sine(frequency: "0.5 Hz"), "beside": {kind},"#),
                r#", "sine.y -> beside.u", "beside.y -> show.z""#,
                r#", "z""#,
            ),
        };
        run_text(&format!(
            r#"Diagram(simulation: (stop_time: "10 s", solver: {solver}), blocks: {{ {block}
                "system": OdeSystem(law: "x' = v; v' = -100*x - 0.1*v; w' = -1e6*(w - x)", start: {{"x": 1}}), "show": Scope(inputs: ["x"{input}]) }},
               connections: ["system.x -> show.x"{wires}])"#
        ))
    };
    let damped = (100.0 - 0.0025_f64).sqrt();
    let expected = (-0.5_f64).exp() * ((10.0 * damped).cos() + 0.05 / damped * (10.0 * damped).sin());
    for solver in ["Auto(rtol: 1e-6)", "Ode15s(rtol: 1e-6)"] {
        let alone = run(solver, "");
        let error = |run: &Run| (run.last("show.x") - expected).abs();
        assert!(error(&alone) < 3e-4, "{}", error(&alone));
        let memory = run(solver, "Memory");
        assert_eq!(memory.counts.accepted, alone.counts.accepted);
        assert_eq!(memory.last("show.x"), alone.last("show.x"));
        // A hit ends a step, which costs steps and no exactness.
        let sampled = run(solver, r#"ZeroOrderHold(ts: "20 ms")"#);
        assert!(error(&sampled) < 5e-4, "{}", error(&sampled));
        assert!(sampled.counts.accepted < 4000, "{}", sampled.counts.accepted);
    }
}

/// Ways from a signal that changes at some instants alone to a derivative: behind each of them a method has to begin anew. Those that go
/// on with the derivative, or the polynomial, of before are off by far more than their tolerance. The reference takes implicit steps,
/// each by itself.
#[test]
fn what_jumps_acts_on_derivatives_by_every_way() {
    let sources = [
        (r#""z": ZeroOrderHold(ts: "0.1 s")"#, "wave.y -> z.u"),
        (r#""z": UnitDelay(ts: "0.07 s")"#, "wave.y -> z.u"),
        (r#""z": Relay(on_at: 0.5, off_at: -0.5)"#, "wave.y -> z.u"),
        (r#""z": FirstOrderHold(ts: "0.1 s")"#, "wave.y -> z.u"),
        (r#""h": ZeroOrderHold(ts: "0.1 s"), "z": Gain(k: 2)"#, r#"wave.y -> h.u", "h.y -> z.u"#),
    ];
    let ways = [
        (r#""i": LowPass(tau: "0.08 s")"#, r#""z.y -> i.u", "i.y -> show.y""#),
        (r#""i": OdeSystem(law: "x' = sin(3*x) + u")"#, r#""z.y -> i.u", "i.x -> show.y""#),
        (
            r#""sw": Switch(threshold: 0.1), "one": Sine(amplitude: 2, frequency: "0.3 Hz"), "two": Constant(value: -2), "i": LowPass(tau: "0.08 s")"#,
            r#""z.y -> sw.control", "one.y -> sw.u1", "two.y -> sw.u3", "sw.y -> i.u", "i.y -> show.y""#,
        ),
        (
            r#""d": TransportDelay(delay: "0.033 s"), "i": LowPass(tau: "0.08 s")"#,
            r#""z.y -> d.u", "d.y -> i.u", "i.y -> show.y""#,
        ),
        (
            r#""sum": Sum(signs: "+-"), "g": Gain(k: 0.5), "i": LowPass(tau: "0.08 s")"#,
            r#""z.y -> sum.u1", "sum.y -> g.u, i.u", "g.y -> sum.u2", "i.y -> show.y""#,
        ),
        (
            r#""volt": Gain(k: "1 V"), "v": ControlledVoltageSource, "r": Resistor(r: "1 ohm"), "l": Inductor(l: "0.1 H"),
               "ground": ElectricalReference, "i": CurrentSensor"#,
            r#""z.y -> volt.u", "volt.y -> v.v", "v.p <-> r.p", "r.n <-> l.p", "l.n <-> i.p", "i.n <-> v.n <-> ground.p", "i.i -> show.y""#,
        ),
        (
            r#""torque": Gain(k: "1 N*m"), "source": IdealTorqueSource, "wheel": Inertia(j: 0.1), "damper": RotationalDamper(d: "0.1 N*m*s/rad"),
               "housing": RotationalReference, "i": MotionSensor"#,
            r#""z.y -> torque.u", "torque.y -> source.tau", "source.r <-> wheel.r <-> damper.r <-> i.r",
               "source.c <-> housing.r <-> damper.c <-> i.c", "i.w -> show.y""#,
        ),
    ];
    for (source, wire) in sources {
        for (blocks, wires) in ways {
            let run = |solver: &str| {
                run_text(&format!(
                    r#"Diagram(simulation: (stop_time: "2 s", solver: {solver}, output: Every("0.05 s")), blocks: {{
                        "wave": Sine(amplitude: 1, frequency: "0.7 Hz"), {source}, {blocks}, "show": Scope(inputs: ["y"]) }},
                       connections: ["{wire}", {wires}])"#
                ))
            };
            // Of two rows of one time the last.
            let last = |run: &Run| -> Vec<(f64, f64)> {
                let rows = run.time.iter().copied().zip(run.column("show.y").iter().copied());
                let mut kept: Vec<(f64, f64)> = Vec::new();
                for row in rows.filter(|(t, _)| (20.0 * t - (20.0 * t).round()).abs() < 1e-9) {
                    kept.pop_if(|before| row.0 - before.0 < 1e-9);
                    kept.push(row);
                }
                kept
            };
            let reference = last(&run("Radau5(rtol: 1e-10)"));
            for method in ["Ode45", "Ode23", "Dop853", "Ode15s", "Rodas4", "Ode23t"] {
                let found = last(&run(&format!("{method}(rtol: 1e-7)")));
                assert_eq!(found.len(), reference.len(), "{method} {source} {blocks}");
                let errors = found.iter().zip(&reference).map(|(a, b)| (a.1 - b.1).abs());
                let worst = errors.fold(0.0, f64::max);
                assert!(worst < 3e-5, "{method} {source} {blocks}: {worst:.1e}");
            }
        }
    }
}
