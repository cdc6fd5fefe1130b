//! Dead time in loops against the method of steps and the roots of their characteristic equations, with the default
//! tolerance of each method.

use blocksim_tests::{METHODS, Run, compile_text, run_text};

/// x' = -k x(t - 1) from x = 1, with nothing before the start.
fn integrator_with_dead_time(simulation: &str, k: f64) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: ({simulation}),
            blocks: {{ "x": Integrator(x0: 1), "late": TransportDelay(delay: "1 s"), "k": Gain(k: {}), "show": Scope }},
            connections: ["x.y -> late.u, show.u", "late.y -> k.u", "k.y -> x.u"],
        )"#,
        -k
    ))
}

/// Method of steps: x = sum of (-k)^j (t - j)^j / j! over all j up to t.
fn by_steps(k: f64, t: f64) -> f64 {
    let mut sum = 0.0;
    for j in 0..=t as i32 {
        let factorial: f64 = (1..=j).map(f64::from).product();
        sum += (-k * (t - f64::from(j))).powi(j) / factorial;
    }
    sum
}

/// Largest difference to the method of steps until 8 s, beyond which its sum loses digits.
fn error(simulation: &str, k: f64) -> f64 {
    let run = integrator_with_dead_time(&format!(r#"stop_time: "8 s", {simulation}"#), k);
    assert_eq!(run.error, None);
    let pairs = run.time.iter().zip(run.column("show.u"));
    pairs.map(|(&t, x)| (x - by_steps(k, t)).abs()).fold(0.0, f64::max)
}

/// How exact a run at 1e-8 is: errors of steps add up where the order is low, since there are many.
fn within(method: &str) -> f64 {
    if matches!(method, "Ode15s" | "Ode23tb" | "Ode23t") { 5e-5 } else { 1e-6 }
}

#[test]
fn an_integrator_with_dead_time_follows_the_method_of_steps() {
    for method in METHODS {
        for k in [0.2, 1.0, std::f64::consts::FRAC_PI_2, 1.6] {
            let default = error(&format!(r#"solver: {method}, output: Every("10 ms")"#), k);
            assert!(default < 4e-3, "{method} with k = {k}: {default}");
            let tight =
                error(&format!(r#"solver: {method}(rtol: 1e-8, atol: 1e-8), output: Every("10 ms")"#), k);
            assert!(tight < within(method), "{method} with k = {k}: {tight}");
        }
    }
}

/// With k = pi/2 the roots s of s + k exp(-s) = 0 next to the imaginary axis lie on it, at +-i pi/2, and X = 1 / (s + k exp(-s))
/// has the residue 1 / (1 + s) there: x goes on for ever as 2 Re(exp(s t) / (1 + s)).
#[test]
fn with_a_gain_of_half_pi_it_oscillates_for_ever() {
    let amplitude = 2.0 / (1.0 + std::f64::consts::FRAC_PI_2.powi(2)).sqrt();
    for method in METHODS {
        let run = integrator_with_dead_time(
            &format!(r#"stop_time: "200 s", solver: {method}(rtol: 1e-5), output: Every("10 ms")"#),
            std::f64::consts::FRAC_PI_2,
        );
        let last = run.time.iter().zip(run.column("show.u")).filter(|(t, _)| **t > 195.0);
        let peak = last.map(|(_, x)| x.abs()).fold(0.0, f64::max);
        assert!((peak / amplitude - 1.0).abs() < 0.01, "{method}: {peak} instead of {amplitude}");
    }
}

/// With k = 1.6 the pair of roots is at 0.01311 +- 1.57910i (Newton's method on s + k exp(-s) = 0).
#[test]
fn with_a_larger_gain_it_grows_as_its_root_says() {
    let (mut a, mut b) = (0.0_f64, 1.57_f64);
    for _ in 0..50 {
        // f = s + k exp(-s), f' = 1 - k exp(-s), with s = a + i b.
        let (er, ei) = (1.6 * (-a).exp() * b.cos(), -1.6 * (-a).exp() * b.sin());
        let (fr, fi, gr, gi) = (a + er, b + ei, 1.0 - er, -ei);
        let square = gr * gr + gi * gi;
        (a, b) = (a - (fr * gr + fi * gi) / square, b - (fi * gr - fr * gi) / square);
    }
    assert!((a - 0.013114).abs() < 1e-6 && (b - 1.579101).abs() < 1e-6, "{a} {b}");
    for method in METHODS {
        let run = integrator_with_dead_time(
            &format!(r#"stop_time: "120 s", solver: {method}(rtol: 1e-5), output: Every("10 ms")"#),
            1.6,
        );
        let peak = |from: f64, to: f64| {
            let rows = run.time.iter().zip(run.column("show.u"));
            rows.filter(|(t, _)| **t > from && **t < to).map(|(_, x)| x.abs()).fold(0.0, f64::max)
        };
        // Over a whole number of half periods.
        let half = std::f64::consts::PI / b;
        let later = 40.0 * half;
        let growth = peak(30.0 + later, 30.0 + later + half) / peak(30.0, 30.0 + half);
        assert!((growth.ln() / later - a).abs() < 2e-4, "{method}: {} instead of {a}", growth.ln() / later);
    }
}

/// u = sin(3 t) of an oscillator, delayed by a time that goes to and fro, against the formula.
#[test]
fn a_variable_delay_gives_what_went_in_then() {
    for method in METHODS {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "6 s", solver: {method}(rtol: 1e-8, atol: 1e-8), output: Every("10 ms")),
                blocks: {{
                    "v": Integrator(x0: 3), "u": Integrator, "back": Gain(k: -9),
                    "time": Sine(amplitude: "0.2 s", frequency: "1 Hz", bias: "0.5 s"),
                    "late": VariableTransportDelay(min_delay: "50 ms", max_delay: "2 s"),
                    "show": Scope,
                }},
                connections: [
                    "v.y -> u.u", "u.y -> back.u, late.u", "back.y -> v.u", "time.y -> late.delay", "late.y -> show.u",
                ],
            )"#
        ));
        for (t, y) in run.time.iter().zip(run.column("show.u")) {
            let s = t - 0.5 - 0.2 * (std::f64::consts::TAU * t).sin();
            let expected = if s < 0.0 { 0.0 } else { (3.0 * s).sin() };
            assert!((y - expected).abs() < within(method), "{method} at {t} s: {y} instead of {expected}");
        }
    }
}

/// A step at 0.25 s through a delay of 0.1 s + 0.5 t comes out when t - 0.1 - 0.5 t = 0.25, at 0.7 s.
#[test]
fn a_jump_comes_out_of_a_variable_delay_at_its_time() {
    for method in METHODS {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {method}),
                blocks: {{
                    "step": Step(time: "0.25 s", after: 3), "time": Ramp(slope: "0.5 s/s", initial: "0.1 s"),
                    "late": VariableTransportDelay(min_delay: "10 ms", max_delay: "5 s"),
                    "sum": Integrator, "show": Scope(inputs: ["y", "sum"]),
                }},
                connections: ["step.y -> late.u", "time.y -> late.delay", "late.y -> sum.u, show.y", "sum.y -> show.sum"],
            )"#
        ));
        let end = run.column("show.sum").last().copied().unwrap();
        assert!((end - 3.0 * 1.3).abs() < 1e-9, "{method}: {end}");
        let sides: Vec<f64> = run
            .time
            .iter()
            .zip(run.column("show.y"))
            .filter(|(t, _)| (**t - 0.7).abs() < 1e-9)
            .map(|(_, y)| *y)
            .collect();
        assert_eq!(sides, [0.0, 3.0], "{method}");
    }
}

/// A sine of time alone, in a diagram without states, over many of its periods within one delay.
#[test]
fn what_depends_on_time_alone_is_remembered_to_the_tolerance() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "5 s", output: Every("7 ms")),
            blocks: {
                "u": Sine(amplitude: 2, frequency: "3 Hz"), "late": TransportDelay(delay: "2.1 s"), "show": Scope,
            },
            connections: ["u.y -> late.u", "late.y -> show.u"],
        )"#,
    );
    assert!(run.time.len() > 700);
    for (t, y) in run.time.iter().zip(run.column("show.u")).filter(|(t, _)| **t > 2.1) {
        let expected = 2.0 * (std::f64::consts::TAU * 3.0 * (t - 2.1)).sin();
        assert!((y - expected).abs() < 2e-3, "{t}: {y} instead of {expected}");
    }
}

#[test]
fn a_fixed_step_follows_the_method_of_steps_and_one_longer_than_the_delay_is_refused() {
    let coarse = error(r#"solver: Ode4(step: "0.1 s")"#, 1.0);
    let fine = error(r#"solver: Ode4(step: "0.05 s")"#, 1.0);
    assert!(coarse < 1e-5 && fine < coarse / 8.0, "{coarse} {fine}");
    let text = r#"Diagram(
        simulation: (stop_time: "1 s", solver: Ode4(step: "2 ms")),
        blocks: { "x": Integrator(x0: 1), "late": TransportDelay(delay: "1 ms"), "k": Gain(k: -1), "show": Scope },
        connections: ["x.y -> late.u, show.u", "late.y -> k.u", "k.y -> x.u"],
    )"#;
    let error = blocksim_sim::Simulation::new(compile_text(text).0.schedule.unwrap().into()).unwrap_err();
    assert_eq!(error.code, "settings");
    assert!(error.message.contains("0.002 s") && error.message.contains("`late`"), "{}", error.message);
    assert!(
        error.message.contains("an equation that methods of fixed step do not solve"),
        "{}",
        error.message
    );
    assert!(
        error.help.unwrap().starts_with("take a step of at most 0.001 s, a method that chooses its steps")
    );
}

/// -1 until the start comes out as 2 at 0.1 s: a limiter of the rate follows from then on, not from the step before.
#[test]
fn what_is_accepted_just_before_a_jump_does_not_see_it() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "0.4 s"),
            blocks: {
                "u": Constant(value: 2), "late": TransportDelay(delay: "0.1 s", y0: -1),
                "limit": RateLimiter(rising: 5, falling: -5, y0: -1), "play": Backlash(width: 1, y0: -1), "show": Scope(inputs: ["y", "play"]),
            },
            connections: ["u.y -> late.u", "late.y -> limit.u, play.u", "limit.y -> show.y", "play.y -> show.play"],
        )"#,
    );
    for ((&t, &y), &play) in run.time.iter().zip(run.column("show.y")).zip(run.column("show.play")) {
        let expected = -1.0 + 5.0 * (t - 0.1).max(0.0);
        assert!((y - expected).abs() < 1e-9, "{t}: {y} instead of {expected}");
        assert!(t <= 0.1 && play == -1.0 || t >= 0.1 && play == 1.5 || (t - 0.1).abs() < 1e-9, "{t}: {play}");
    }
    let end = run.column("show.y").last().copied().unwrap();
    assert!((end - 0.5).abs() < 1e-9, "{end}");
}

/// Two delays and two limits of the slope in a row: steps as short as the resolution of time, over which everything is rough
/// from rounding, are remembered as they are.
#[test]
fn steps_as_short_as_rounding_do_not_fill_the_memory() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "0.5 s"),
            blocks: {
                "u": Sine(amplitude: 3.66, frequency: "2.05 Hz"), "slow": RateLimiter(rising: 10.4, falling: -26.6),
                "late": TransportDelay(delay: "0.416 s"), "slower": RateLimiter(rising: 9.88, falling: -23.9),
                "later": TransportDelay(delay: "0.129 s"), "show": Scope(inputs: ["slow", "late", "slower", "later"]),
            },
            connections: [
                "u.y -> slow.u", "slow.y -> late.u, show.slow", "late.y -> slower.u, show.late",
                "slower.y -> later.u, show.slower", "later.y -> show.later",
            ],
        )"#,
    );
    assert!(run.counts.major < 100, "{:?}", run.counts);
    let end = |name: &str| run.column(name).last().copied().unwrap();
    // The sine is steeper than both limits: ramps since 0 s and since 0.416 s.
    assert!((end("show.late") - 10.4 * 0.084).abs() < 1e-9, "{}", end("show.late"));
    assert!(
        (end("show.slower") - 9.88 * 0.084).abs() < 1e-9 && end("show.later") == 0.0,
        "{}",
        end("show.slower")
    );
}

/// A delay that jumps, to and fro, over a jump of what went in.
#[test]
fn a_delay_that_jumps_leads_past_a_jump_at_once() {
    for method in METHODS {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {method}),
                blocks: {{
                    "step": Step(time: "0.5 s", before: 1, after: 3),
                    "time": Pulse(amplitude: "0.6 s", period: "0.3 s", width: 0.5, delay: "0.7 s"), "least": Constant(value: "0.1 s"),
                    "delay": Sum(signs: "++"),
                    "late": VariableTransportDelay(min_delay: "10 ms", max_delay: "5 s"),
                    "sum": Integrator, "show": Scope(inputs: ["y", "sum"]),
                }},
                connections: [
                    "step.y -> late.u", "time.y -> delay.u1", "least.y -> delay.u2", "delay.y -> late.delay",
                    "late.y -> sum.u, show.y", "sum.y -> show.sum",
                ],
            )"#
        ));
        // 0 before 0.1 s, 1 until 0.6 s and while the delay of 0.7 s reads before 0.5 s: 0.7 .. 0.85 s and 1.0 .. 1.15 s.
        let ones = 0.5 + 0.15 + 0.15;
        let expected = ones + 3.0 * (1.9 - ones);
        let end = run.column("show.sum").last().copied().unwrap();
        assert!((end - expected).abs() < 1e-9, "{method}: {end} instead of {expected}");
    }
}

/// y = u - y(t - T) of a pulse: what cancels leaves rounding, which is no shape to be told in small pieces.
#[test]
fn what_cancels_does_not_fill_the_memory() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "4 s"),
            blocks: {
                "u": Pulse(amplitude: 0.558, period: "0.211 s", width: 0.683, delay: "0.0233 s"),
                "late": TransportDelay(delay: "0.0868 s"), "y": Sum(signs: "+-"), "show": Scope,
            },
            connections: ["u.y -> y.u1", "late.y -> y.u2", "y.y -> late.u, show.u"],
        )"#,
    );
    assert_eq!(run.error, None);
    let pulse = |t: f64| {
        let phase = (t - 0.0233).rem_euclid(0.211);
        (
            0.558 * f64::from(t > 0.0233 && phase < 0.683 * 0.211),
            phase.min(0.211 - phase).min((phase - 0.683 * 0.211).abs()),
        )
    };
    for (&t, &y) in run.time.iter().zip(run.column("show.u")) {
        let terms = (0..).map(|k| t - 0.0868 * f64::from(k)).take_while(|s| *s >= 0.0);
        let (mut expected, mut nearest, mut sign) = (0.0, 1.0_f64, 1.0);
        for s in terms {
            let (value, edge) = pulse(s);
            expected += sign * value;
            sign = -sign;
            nearest = nearest.min(edge);
        }
        assert!((y - expected).abs() < 1e-12 || nearest < 1e-9, "{t}: {y} instead of {expected}");
    }
}

/// What goes round a dead time without a loss: y(t) = x(t) - t + y(t - T) behind a lag x of t - y(t - T), eight times in all,
/// against the same by short steps at a tight tolerance.
#[test]
fn what_goes_round_a_dead_time_loses_no_digits() {
    let value = |settings: &str| {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "4 s"{settings}),
                blocks: {{
                    "time": Clock, "number": Gain(k: "1 1/s"), "lag": LowPass(tau: "0.153 s"),
                    "late": TransportDelay(delay: "0.487 s"), "left": Sum(signs: "+-"), "round": Sum(signs: "+-"), "show": Scope,
                }},
                connections: [
                    "time.y -> number.u", "number.y -> left.u1", "late.y -> left.u2", "left.y -> lag.u", "lag.y -> round.u1",
                    "left.y -> round.u2", "round.y -> late.u, show.u",
                ],
            )"#
        ));
        run.last("show.u")
    };
    let expected = value(", solver: Ode45(rtol: 1e-10, max_step: \"1 ms\")");
    for solver in METHODS {
        let found = value(&format!(", solver: {solver}"));
        assert!((found - expected).abs() < 2.5e-5, "{solver}: {found} instead of {expected}");
    }
}

/// A kink that goes round without being integrated stays a kink: y(t) = u(t) + y(t - T) is the sum of all u(t - kT), and each of
/// them begins with one. Steps end at all of them, and the integral of y is as exact as its tolerance.
#[test]
fn a_kink_that_is_not_integrated_comes_round_as_one() {
    let (delay, w) = (0.0345, 2.0 * std::f64::consts::TAU);
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "1 s", solver: {solver}),
                blocks: {{
                    "u": Sine(frequency: "2 Hz"), "y": Sum(signs: "++"), "late": TransportDelay(delay: "{delay} s"),
                    "rate": Gain(k: "1 1/s"), "x": Integrator, "show": Scope(inputs: ["y", "x"]),
                }},
                connections: [
                    "u.y -> y.u1", "late.y -> y.u2", "y.y -> late.u, rate.u, show.y", "rate.y -> x.u", "x.y -> show.x",
                ],
            )"#
        ));
        let starts = |t: f64| (0..=((t / delay + 1e-9) as i32)).map(move |k| t - f64::from(k) * delay);
        let (y, x) = (run.column("show.y"), run.column("show.x"));
        for (row, &t) in run.time.iter().enumerate() {
            let sum: f64 = starts(t).map(|t| (w * t).sin()).sum();
            let integral: f64 = starts(t).map(|t| (1.0 - (w * t).cos()) / w).sum();
            assert!((y[row] - sum).abs() < 1e-4, "{solver} at {t}: {} instead of {sum}", y[row]);
            assert!((x[row] - integral).abs() < 1e-4, "{solver} at {t}: {} instead of {integral}", x[row]);
        }
        for kink in (1..29).map(|k| f64::from(k) * delay) {
            assert!(run.time.iter().any(|t| (t - kink).abs() < 1e-9), "{solver}: no step ends at {kink} s");
        }
    }
}

/// Four dead times of which no two have a common measure, each with a signal of its own. What comes out of one, and where it has a
/// kink, says nothing of the others: steps end at the samples and once more for each sample that comes out, and not at all
/// sums of the times.
#[test]
fn what_comes_out_of_one_memory_is_no_break_in_another() {
    let times = [0.0218, 0.0531, 0.425, 0.461];
    let (mut blocks, mut wires) = (String::new(), String::new());
    for (k, time) in times.iter().enumerate() {
        blocks += &format!(
            r#""sine{k}": Sine(frequency: "{k}.3 Hz"), "late{k}": TransportDelay(delay: "{time} s"),
               "rate{k}": Gain(k: "1 1/s"), "sum{k}": Integrator, "#
        );
        // The first one delays what is sampled and smoothed.
        let from = if k == 0 { "smooth.y" } else { &format!("sine{k}.y") };
        wires += &format!(
            r#""{from} -> late{k}.u", "late{k}.y -> rate{k}.u, show.late{k}", "rate{k}.y -> sum{k}.u", "sum{k}.y -> show.sum{k}", "#
        );
    }
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "2 s"),
            blocks: {{
                {blocks} "hold": ZeroOrderHold(ts: "20 ms"), "smooth": LowPass(tau: "50 ms"),
                "show": Scope(inputs: ["late0", "late1", "late2", "late3", "sum0", "sum1", "sum2", "sum3"]),
            }},
            connections: [{wires} "sine0.y -> hold.u", "hold.y -> smooth.u"],
        )"#
    ));
    assert_eq!(run.error, None);
    // A hundred samples, and each of them once more.
    assert!(run.counts.accepted < 600, "{:?}", run.counts);
    for (k, time) in times.iter().enumerate().skip(1) {
        let w = std::f64::consts::TAU * (k as f64 + 0.3);
        let (late, sum) = (f64::sin(w * (2.0 - time)), (1.0 - f64::cos(w * (2.0 - time))) / w);
        for (name, expected) in [(format!("show.late{k}"), late), (format!("show.sum{k}"), sum)] {
            let found = run.last(&name);
            assert!((found - expected).abs() < 1e-5, "{name}: {found}, not {expected}");
        }
    }
    // The sampled sine through the low-pass, sample by sample, until the time that comes out last.
    let (w, ts, tau, end) = (std::f64::consts::TAU * 0.3, 0.02, 0.05, 2.0 - times[0]);
    let mut y = 0.0;
    for k in 0..100 {
        let length = (end - ts * f64::from(k)).clamp(0.0, ts);
        y += (1.0 - f64::exp(-length / tau)) * (f64::sin(w * ts * f64::from(k)) - y);
    }
    assert!((run.last("show.late0") - y).abs() < 1e-5, "{}, not {y}", run.last("show.late0"));
}

/// A delay that jumps leads what is read over a peak, or a jump, of the input in no time: nothing of that comes out, and who looks at
/// that instant, or remembers what it sees, does not see it.
#[test]
fn a_delay_that_jumps_leads_over_a_peak_without_showing_it() {
    // A triangle with its peak of 5 at 0.3 s, and a pulse of that height; from 0.4 s on both are zero.
    let inputs = [
        "SignalBuilder(points: [(0.0, 0.0), (0.3, 5.0), (0.4, 0.0), (2.0, 0.0)])",
        r#"Pulse(period: "9 s", width: "0.15/9", delay: "0.2 s", amplitude: 5.0)"#,
    ];
    // From 0.1 s to 0.45 s, and from 0.65 s to 0.05 s, at 0.5 s or at 0.7 s.
    let jumps = [("0.5 s", "0.4 s", "0.05 s"), ("0.7 s", "50 ms", "0.65 s")];
    for (input, (time, before, after)) in inputs.iter().flat_map(|input| jumps.map(|jump| (input, jump))) {
        for solver in METHODS {
            let run = run_text(&format!(
                r#"Diagram(
                    simulation: (stop_time: "0.8 s", solver: {solver}(rtol: 1e-6), output: Every("0.1 s")),
                    blocks: {{
                        "u": {input}, "tau": Step(time: "{time}", before: "{before}", after: "{after}"),
                        "late": VariableTransportDelay(min_delay: "50 ms", max_delay: "0.8 s"),
                        "relay": Relay(on_at: 4.0, off_at: -1.0), "hits": HitCrossing(at: 4.0, direction: Rising),
                        "held": ZeroOrderHold(ts: "0.1 s"), "play": Backlash(width: 1.0),
                        "show": Scope(inputs: ["late", "relay", "hits", "held", "play"]),
                    }},
                    connections: [
                        "u.y -> late.u", "tau.y -> late.delay", "late.y -> relay.u, hits.u, held.u, play.u, show.late",
                        "relay.y -> show.relay", "hits.count -> show.hits", "held.y -> show.held", "play.y -> show.play",
                    ],
                )"#
            ));
            // What has come out by itself before the jump of the longer delay, over the peak.
            let seen = if after == "0.65 s" { 1.0 } else { 0.0 };
            let what = format!("{input}, {after}, {solver}");
            assert_eq!(run.last("show.hits"), seen, "{what}");
            assert_eq!(run.last("show.relay"), seen, "{what}");
            let [late, held] = ["show.late", "show.held"].map(|path| run.column(path));
            // Of the rows of a sample, the last one is behind it.
            let samples = (1..9).map(|k| {
                let at = |row: &usize| (run.time[*row] - 0.1 * f64::from(k)).abs() < 1e-9;
                (0..run.time.len()).rfind(at).expect("a row at each sample")
            });
            for row in samples {
                assert!((late[row] - held[row]).abs() < 1e-6, "{what}: {late:?}, {held:?}");
            }
            if seen == 0.0 {
                assert!(run.last("show.play").abs() < 1.2, "{what}: {}", run.last("show.play"));
            }
        }
    }
}
