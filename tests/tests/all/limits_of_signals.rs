//! Play and limits of the slope at default settings, against closed forms: nothing but the source says how fast signals change.

use std::f64::consts::TAU;

use blocksim_tests::{Run, close, run_text};

fn diagram(stop: f64, source: &str, block: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "{stop} s", output: Every("1 ms")),
    blocks: {{
        "source": {source}, "block": {block}, "rate": Gain(k: "1 1/s"), "integral": Integrator,
        "show": Scope(inputs: ["y", "integral"]),
    }},
    connections: [
        "source.y -> block.u", "block.y -> show.y", "block.y -> rate.u", "rate.y -> integral.u",
        "integral.y -> show.integral",
    ],
)"#
    ))
}

/// Zero of a function that is negative at `a` and positive at `b`.
fn zero(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if f(middle) < 0.0 { a = middle } else { b = middle }
    }
    0.5 * (a + b)
}

/// `u = sin(2 pi t)` with a play of 1: the output rests at 1/2 from the upper turning point of the input on until that has
/// come down to zero, and at -1/2 from the lower one on.
#[test]
fn play_rests_at_the_turning_points_of_a_sine() {
    let run = diagram(10.0, r#"Sine(frequency: "1 Hz")"#, "Backlash(width: 1)");
    // Each period spends as much above zero as below; the first one begins at rest at zero, until the input is 0.5 at 1/12.
    for (t, y) in [(0.05, 0.0), (0.3, 0.5), (0.45, 0.5), (0.8, -0.5), (0.9, -0.5), (9.3, 0.5), (9.9, -0.5)] {
        close(run.at("show.y", t), y, 1e-9, &format!("output at {t} s"));
    }
    // From 1/12 to 1/4 the output is sin - 1/2, then 1/2 until the input has fallen to 0 at 1/2, then sin + 1/2 until 3/4 and
    // -1/2 until 1. From then on a period brings nothing.
    let cos = |t: f64| f64::cos(TAU * t) / TAU;
    let rises = cos(1.0 / 12.0) - cos(0.25) - 0.5 * (0.25 - 1.0 / 12.0);
    let falls = cos(0.5) - cos(0.75) + 0.5 * 0.25;
    let first = rises + 0.5 * 0.25 + falls - 0.5 * 0.25;
    // In a whole period it rests at -1/2 for a quarter, rises for a quarter, rests and falls: these cancel.
    let later = cos(0.0) - cos(0.25) - 0.5 * 0.25 + 0.5 * 0.25 + falls - 0.5 * 0.25;
    close(run.last("show.integral"), first + 9.0 * later, 1e-5, "integral");
}

/// `u = sin(2 pi t)` with slopes of 3 at most: the output leaves the input where its slope passes the rate, and meets it
/// again on a straight line.
#[test]
fn a_rate_is_kept_exactly_where_a_sine_is_too_fast() {
    let rate = 3.0;
    let run = diagram(
        4.0,
        r#"Sine(frequency: "1 Hz", phase: "90 deg")"#,
        "RateLimiter(rising: 3, falling: -3, y0: 1)",
    );
    let u = |t: f64| (TAU * t).cos();
    // It falls too fast from where 2 pi sin = 3.
    let leaves = (rate / TAU).asin() / TAU;
    let meets = zero(leaves + 0.1, 1.0, |t| u(t) - (u(leaves) - rate * (t - leaves)));
    assert!(meets < 0.75 && meets > 0.5, "{meets}");
    for t in [0.5 * leaves, leaves, 0.2, 0.3, 0.9 * meets, meets] {
        let y = if t <= leaves { u(t) } else { u(leaves) - rate * (t - leaves) };
        close(run.at("show.y", t), y, 1e-5, &format!("output at {t} s"));
    }
    // Where it meets the input it rises already too fast, and the picture is that of before upside down; then periods are alike.
    let line = |t: f64| u(meets) + rate * (t - meets);
    let again = zero(0.8, 1.4, |t| line(t) - u(t));
    close(run.at("show.y", 0.5 * (meets + again)), line(0.5 * (meets + again)), 1e-5, "on the way up");
    let rows = run.time.windows(2).zip(run.column("show.y").windows(2));
    for (t, y) in rows.filter(|(t, _)| t[1] - t[0] > 1e-6) {
        let slope = (y[1] - y[0]) / (t[1] - t[0]);
        assert!(slope.abs() <= rate + 1e-6, "slope {slope} at {} s", t[0]);
    }
}

/// Pulses that are met within a small part of a step: triangles with flat tops.
#[test]
fn pulses_become_trapezia_of_the_right_area() {
    let run = diagram(
        2.0,
        r#"Pulse(amplitude: 1, period: "0.25 s", width: 0.4)"#,
        "RateLimiter(rising: 50, falling: -40)",
    );
    // Up in 20 ms, flat for 80 ms, down in 25 ms.
    close(run.last("show.integral"), 8.0 * (0.08 + 0.5 * (0.02 + 0.025)), 1e-6, "area");
    assert_eq!(run.last("show.y"), 0.0, "at rest in the end");
}

/// An input that has the very rate is followed, though rounding makes it faster and slower.
#[test]
fn a_ramp_of_the_very_rate_is_no_event() {
    let run = diagram(7.0, "Ramp(slope: 0.1)", "RateLimiter(rising: 0.1, falling: -0.1)");
    close(run.last("show.y"), 0.7, 1e-12, "output");
    assert!(run.events.len() <= 2, "{:?}", run.events);
}

/// A signal that passes several breakpoints of a table between two looks of the solver stops at each.
#[test]
fn a_stepped_table_misses_no_step() {
    let run = diagram(
        2.0,
        r#"Sine(amplitude: 1.94, frequency: "3.9 Hz")"#,
        "LookupTable1D(breakpoints: [-1.94, -1.46, -1.28, 0.256, 0.933], table: [1.0, 2.0, 4.0, 8.0, 16.0], interpolation: Flat)",
    );
    let share = |level: f64| 0.5 - (level / 1.94_f64).asin() / std::f64::consts::PI;
    // Whole periods up to 7 / 3.9 s; the eighth is 0.8 long: up, and down to past the lower turning point.
    let part = |level: f64| {
        let (a, p) = ((level / 1.94_f64).asin() / TAU, 0.8);
        // Above the level from a to 1/2 - a, and from 1 + a on.
        if a >= 0.0 { 0.5 - 2.0 * a } else { (0.5 - a).min(p) + (p - (1.0 + a)).max(0.0) }
    };
    let above = |level: f64| 7.0 * share(level) + part(level);
    let area: f64 =
        [(-1.46, 1.0), (-1.28, 2.0), (0.256, 4.0), (0.933, 8.0)].iter().map(|(l, d)| d * above(*l)).sum();
    close(run.last("show.integral"), (7.8 + area) / 3.9, 1e-5, "integral");
}

/// On the way back from a turning point the levels are left where they were met, also at halves that rounding moves.
#[test]
fn a_quantized_sine_is_as_long_on_each_level_as_the_sine() {
    let run = diagram(
        1.0,
        r#"Sine(amplitude: 0.462, frequency: "2.15 Hz", phase: "2.24 rad")"#,
        "Quantizer(interval: 0.18)",
    );
    // Integral by the middle rule, off by the interval times half a step at each of the 25 jumps.
    let steps = 10_000_000;
    let level = |k: u32| {
        let t = (f64::from(k) + 0.5) / f64::from(steps);
        0.18 * (0.462 * (TAU * 2.15 * t + 2.24).sin() / 0.18).round()
    };
    let integral = (0..steps).map(level).sum::<f64>() / f64::from(steps);
    close(run.last("show.integral"), integral, 5e-6, "integral");
}

/// The low-pass of a sine has a closed form; the play follows it in a million steps. The stages of the method lie beside the
/// solution, which must neither make turning points nor hide them.
#[test]
fn play_behind_a_filter_rests_at_its_turning_points() {
    let (w, tau, amplitude) = (TAU * 7.13, 0.0327, 1.42);
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "0.25 s"),
            blocks: {{
                "source": Sine(amplitude: {amplitude}, frequency: "7.13 Hz"), "filter": LowPass(tau: "{tau} s"),
                "play": Backlash(width: 1.14), "rate": Gain(k: "1 1/s"), "integral": Integrator, "show": Scope(inputs: ["y", "integral"]),
            }},
            connections: [
                "source.y -> filter.u", "filter.y -> play.u", "play.y -> rate.u, show.y", "rate.y -> integral.u",
                "integral.y -> show.integral",
            ],
        )"#
    ));
    let input = |t: f64| {
        let (sine, cosine) = (w * t).sin_cos();
        amplitude / (1.0 + (w * tau).powi(2)) * (sine - w * tau * cosine + w * tau * (-t / tau).exp())
    };
    let steps = 1_000_000;
    let h = 0.25 / f64::from(steps);
    let (mut y, mut integral) = (0.0_f64, 0.0);
    for k in 1..=steps {
        let u = input(f64::from(k) * h);
        let next = y.clamp(u - 0.57, u + 0.57);
        integral += 0.5 * h * (y + next);
        y = next;
    }
    close(run.last("show.y"), y, 3e-6, "output");
    close(run.last("show.integral"), integral, 1e-6, "integral");
}

/// The place where a sine becomes too fast for a rate lies between two looks of a step, and one of them stands there twice but
/// for rounding: it is found all the same. From there on the output falls straight until it meets the sine again.
#[test]
fn a_rate_that_sets_in_near_a_look_is_not_missed() {
    let (amplitude, w, rate) = (2.6, TAU * 0.356, -2.57);
    let u = |t: f64| amplitude * (w * t).sin();
    let onset = |turns: f64| (f64::acos(rate / (amplitude * w)) + TAU * turns) / w;
    let met = zero(2.0, 2.7, |t| u(t) - (u(onset(0.0)) + rate * (t - onset(0.0))));
    let area = |from: f64, to: f64| amplitude / w * ((w * from).cos() - (w * to).cos());
    let straight = |from: f64, to: f64| (to - from) * (u(from) + 0.5 * rate * (to - from));
    let last = onset(1.0);
    let expected = area(0.0, onset(0.0)) + straight(onset(0.0), met) + area(met, last) + straight(last, 4.0);
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "4 s", solver: {solver}),
                blocks: {{
                    "time": Clock, "plain": Gain(k: "1 1/s"), "u": Sine(amplitude: 2.6, frequency: "0.356 Hz"),
                    "lag": TransferFunction(num: [8.0, 31.8], den: [1.0, 8.0, 31.8]),
                    "limit": RateLimiter(rising: 10.0, falling: -2.57), "rate": Gain(k: "1 1/s"), "sum": Integrator,
                    "slow": Gain(k: "1 1/s"), "other": Integrator, "show": Scope(inputs: ["sum", "other"]),
                }},
                connections: [
                    "time.y -> plain.u", "plain.y -> lag.u", "u.y -> limit.u", "limit.y -> rate.u", "rate.y -> sum.u",
                    "lag.y -> slow.u", "slow.y -> other.u", "sum.y -> show.sum", "other.y -> show.other",
                ],
            )"#
        ));
        let found = run.last("show.sum");
        assert!((found - expected).abs() < 2e-5, "{solver}: {found} instead of {expected}");
    }
}
