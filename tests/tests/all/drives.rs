//! Electronics of drives in whole diagrams: edges in time, machines under control.

use std::f64::consts::TAU;

use blocksim_tests::{Run, run_file, run_text};

const LINK: f64 = 560.0;
const PEAK: f64 = 230.0;
const F: f64 = 50.0;

/// A modulator with these parameters at 560 V, behind a sine of 50 Hz and 230 V; its outputs are recorded.
fn modulated(parameters: &str, solver: &str, stop: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: {solver}, output: Every("1 s")),
    blocks: {{
        "v": Constant(value: "{PEAK} V"), "f": Constant(value: "{F} Hz"), "vdc": Constant(value: "{LINK} V"),
        "reference": PhaseReference,
        "pwm": PwmGenerator({parameters}),
        "s": Scope(inputs: ["gates"]),
    }},
    connections: [
        "v.y -> reference.v", "f.y -> reference.f", "reference.abc -> pwm.v", "vdc.y -> pwm.vdc",
        "pwm.gates -> s.gates",
    ],
)"#
    ))
}

/// Times at which a gate changes. Each change is two rows of one time; what happens at the start is the first state of all.
fn edges(run: &Run, gate: usize) -> Vec<f64> {
    let column = run.column(&format!("s.gates[{gate}]"));
    let changes = (1..column.len()).filter(|&row| column[row] != column[row - 1]);
    changes
        .filter(|&row| run.time[row] > 1e-9)
        .map(|row| {
            assert_eq!(run.time[row], run.time[row - 1], "a change between two times");
            run.time[row]
        })
        .collect()
}

/// Duty of a leg under sine modulation.
fn duty(leg: usize, t: f64) -> f64 {
    0.5 + PEAK / LINK * (TAU * F * t - leg as f64 * TAU / 3.0).cos()
}

#[test]
fn sampled_edges_come_at_their_instants_for_ten_thousand_periods() {
    let carrier = 10e3;
    for sampling in ["Symmetric", "Asymmetric"] {
        let parameters = format!(r#"switching_frequency: "10 kHz", modulation: Sine, sampling: {sampling}"#);
        let run = modulated(&parameters, "Ode45(rtol: 1e-6)", "1 s");
        for leg in 0..3 {
            let edges = edges(&run, 2 * leg);
            assert_eq!(edges.len(), 20_000);
            for (half, edge) in edges.iter().enumerate() {
                let sampled = if sampling == "Symmetric" { half / 2 * 2 } else { half };
                let d = duty(leg, sampled as f64 / (2.0 * carrier));
                let share = if half % 2 == 0 { 1.0 - d } else { d };
                let expected = (half as f64 + share) / (2.0 * carrier);
                assert!((edge - expected).abs() < 1e-12, "{sampling}, leg {leg}: {edge} and not {expected}");
            }
        }
    }
}

#[test]
fn natural_edges_lie_where_the_reference_meets_the_carrier() {
    let carrier = 2e3;
    let parameters = r#"switching_frequency: "2 kHz", modulation: Sine, sampling: Natural"#;
    let run = modulated(parameters, "Ode45(rtol: 1e-6)", "0.1 s");
    for leg in 0..3 {
        let edges = edges(&run, 2 * leg);
        assert_eq!(edges.len(), 400);
        for (half, edge) in edges.iter().enumerate() {
            // The carrier moves by 1 in each half; the reference is so slow that the iteration contracts by 0.07.
            let share = |t: f64| if half % 2 == 0 { 1.0 - duty(leg, t) } else { duty(leg, t) };
            let expected = (0..30)
                .fold(half as f64 / (2.0 * carrier), |t, _| (half as f64 + share(t)) / (2.0 * carrier));
            assert!((edge - expected).abs() < 1e-12, "leg {leg}: {edge} and not {expected}");
        }
    }
    assert_eq!(run.counts.events, 1200);
}

/// Whether a leg is above the carrier at `t` under a discontinuous law: the leg rests whose voltage, turned by `early` rad, has the
/// `rank`-th greatest magnitude, on its side.
fn is_above(leg: usize, t: f64, carrier: f64, (rank, early): (usize, f64)) -> bool {
    let angle = |leg: usize| TAU * F * t - leg as f64 * TAU / 3.0;
    let mut by_size = [0, 1, 2];
    by_size.sort_by(|a, b| {
        let size = |leg: &usize| (angle(*leg) + early).cos().abs();
        size(b).total_cmp(&size(a))
    });
    let rests = by_size[rank];
    let side = (angle(rests) + early).cos().signum();
    let modulation = side + (angle(leg).cos() - angle(rests).cos()) * PEAK / (LINK / 2.0);
    let triangle = 1.0 - (2.0 * (t * carrier).fract() - 1.0).abs();
    0.5 * (1.0 + modulation) > 1.0 - triangle
}

/// Where another leg comes to rest the references jump, and legs turn for a part of a half; a step over that would see nothing.
#[test]
fn natural_edges_under_discontinuous_laws_are_those_of_a_dense_search() {
    let early = TAU / 12.0;
    let laws = [
        ("Discontinuous60", (0, 0.0)),
        ("Discontinuous60Leading", (0, early)),
        ("Discontinuous60Lagging", (0, -early)),
        ("Discontinuous30", (1, 0.0)),
    ];
    for (name, law) in laws {
        for carrier in [170.0, 1310.0] {
            let parameters =
                format!(r#"switching_frequency: "{carrier} Hz", modulation: {name}, sampling: Natural"#);
            let run = modulated(&parameters, "Ode45(rtol: 1e-6)", "60 ms");
            let parts = 120_000;
            let at = |k: i32| 0.06 * (f64::from(k) + 0.5) / f64::from(parts);
            for leg in 0..3 {
                let above = |t: f64| is_above(leg, t, carrier, law);
                let turns = (1..parts).filter(|k| above(at(k - 1)) != above(at(*k)));
                let expected: Vec<f64> = turns
                    .map(|k| {
                        let (mut left, mut right, before) = (at(k - 1), at(k), above(at(k - 1)));
                        for _ in 0..50 {
                            let middle = 0.5 * (left + right);
                            *(if above(middle) == before { &mut left } else { &mut right }) = middle;
                        }
                        right
                    })
                    .collect();
                let edges = edges(&run, 2 * leg);
                assert_eq!(
                    edges.len(),
                    expected.len(),
                    "{name}, {carrier} Hz, leg {leg}: {edges:?} {expected:?}"
                );
                for (edge, expected) in edges.iter().zip(&expected) {
                    assert!(
                        (edge - expected).abs() < 1e-9,
                        "{name}, {carrier} Hz, leg {leg}: {edge}, {expected}"
                    );
                }
            }
        }
    }
}

/// Duties jump by the same law: a comparison behind them sees both sides of the jump.
#[test]
fn what_compares_duties_sees_where_they_jump() {
    let run = run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "20 ms", solver: Ode45(), output: Every("1 s")),
    blocks: {{
        "v": Constant(value: "{PEAK} V"), "f": Constant(value: "{F} Hz"), "vdc": Constant(value: "{LINK} V"),
        "reference": PhaseReference, "duties": DutyCycles(modulation: Discontinuous60),
        "level": Constant(value: 0.99), "high": Compare(operator: Greater), "s": Scope(inputs: ["gates"]),
    }},
    connections: [
        "v.y -> reference.v", "f.y -> reference.f", "reference.abc -> duties.v", "vdc.y -> duties.vdc",
        "duties.duty -> high.u1", "level.y -> high.u2", "high.y -> s.gates",
    ],
)"#
    ));
    // Each leg rests high for 60 degrees around its peak.
    for (leg, degrees) in [[30.0, 330.0], [90.0, 150.0], [210.0, 270.0]].into_iter().enumerate() {
        let expected = degrees.map(|degrees| degrees / 360.0 / F);
        let edges = edges(&run, leg);
        assert!(edges.len() == 2, "leg {leg}: {edges:?}");
        assert!(edges.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "leg {leg}: {edges:?}");
    }
}

/// A link that is gone for less than a step lets all legs follow a duty of one half.
#[test]
fn a_short_loss_of_the_dc_link_is_not_passed_over() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "100 ms", solver: Ode45(max_step: "40 ms"), output: Every("1 s")),
    blocks: {
        "v": Constant(value: ["5 V", "-1 V", "2 V"]),
        "dip": SignalBuilder(points: [("0 s", "20 V"), ("40 ms", "20 V"), ("41 ms", "-20 V"), ("42 ms", "20 V")]),
        "pwm": PwmGenerator(switching_frequency: "1 Hz", modulation: Sine, sampling: Natural),
        "s": Scope(inputs: ["gates", "duty"]),
    },
    connections: ["v.y -> pwm.v", "dip.y -> pwm.vdc", "pwm.gates -> s.gates", "pwm.duty -> s.duty"],
)"#,
    );
    let half = run.column("s.duty[0]").iter().zip(&run.time).filter(|(d, _)| **d == 0.5);
    let times: Vec<f64> = half.map(|(_, t)| *t).collect();
    assert!((times[0] - 40.5e-3).abs() < 1e-9 && (times.last().unwrap() - 41.5e-3).abs() < 1e-9, "{times:?}");
}

/// With references that never change only the carrier moves: its crossings count as well.
#[test]
fn natural_edges_of_constant_references_lie_where_the_carrier_meets_them() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "3 ms", output: Every("1 s")),
    blocks: {
        "v": Constant(value: ["5 V", "-1 V", "2 V"]), "vdc": Constant(value: "20 V"),
        "pwm": PwmGenerator(switching_frequency: "1 kHz", modulation: Sine, sampling: Natural),
        "m": Constant(value: 0.4), "bridge": HBridgePwm(switching_frequency: "1 kHz", sampling: Natural),
        "s": Scope(inputs: ["gates", "bridge"]),
    },
    connections: [
        "v.y -> pwm.v", "vdc.y -> pwm.vdc", "m.y -> bridge.m", "pwm.gates -> s.gates", "bridge.gates -> s.bridge",
    ],
)"#,
    );
    for (leg, duty) in [0.75, 0.45, 0.6].into_iter().enumerate() {
        let edges = edges(&run, 2 * leg);
        let ends = (0..3).flat_map(|k| {
            [0.5 * (1.0 - duty), 0.5 * (1.0 + duty)].map(|share| (f64::from(k) + share) * 1e-3)
        });
        let expected: Vec<f64> = ends.collect();
        assert_eq!(edges.len(), expected.len(), "leg {leg}: {edges:?}");
        assert!(edges.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "leg {leg}: {edges:?}");
    }
    let gate = run.column("s.bridge[0]");
    assert!((1..gate.len()).filter(|&row| gate[row] != gate[row - 1]).count() == 6, "{gate:?}");
}

/// The carrier has 42 periods a turn, so sidebands that reach the fundamental are of the order 41: nothing.
#[test]
fn the_fundamental_of_natural_sampling_is_the_reference() {
    let parameters = r#"switching_frequency: "2.1 kHz", modulation: Sine, sampling: Natural"#;
    let run = modulated(parameters, "Ode45(rtol: 1e-6)", "20 ms");
    let sum: f64 = edges(&run, 0)
        .chunks_exact(2)
        .map(|pulse| ((TAU * F * pulse[1]).sin() - (TAU * F * pulse[0]).sin()) * LINK * 2.0 / TAU)
        .sum();
    assert!((sum - PEAK).abs() < 1e-8, "{sum} V and not {PEAK} V");
}

#[test]
fn dead_time_delays_every_turn_on_and_nothing_overlaps() {
    let plain = r#"switching_frequency: "10 kHz", modulation: SpaceVector"#;
    let runs = ["0 s", "2 us"]
        .map(|dead| modulated(&format!(r#"{plain}, dead_time: "{dead}""#), "Ode45(rtol: 1e-6)", "40 ms"));
    for leg in 0..3 {
        let (ideal, real) = (edges(&runs[0], 2 * leg), edges(&runs[1], 2 * leg));
        assert_eq!(ideal.len(), real.len());
        for (i, (ideal, real)) in ideal.iter().zip(&real).enumerate() {
            let delay = if i % 2 == 0 { 2e-6 } else { 0.0 };
            assert!((real - ideal - delay).abs() < 2e-12, "edge {i} of leg {leg}");
        }
        let columns = [2 * leg, 2 * leg + 1].map(|gate| runs[1].column(&format!("s.gates[{gate}]")));
        assert!(columns[0].iter().zip(columns[1]).all(|(upper, lower)| upper * lower == 0.0));
    }
}

#[test]
fn a_method_of_fixed_step_hits_the_same_edges() {
    let parameters = r#"switching_frequency: "10 kHz", modulation: Sine"#;
    let variable = modulated(parameters, "Ode45(rtol: 1e-6)", "20 ms");
    let fixed = modulated(parameters, r#"Ode4(step: "30 us")"#, "20 ms");
    for gate in 0..6 {
        let (a, b) = (edges(&variable, gate), edges(&fixed, gate));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "gate {gate}");
    }
}

#[test]
fn references_from_a_controller_of_the_same_rate_are_taken_at_once() {
    // The hold samples with the carrier, at the same instants: as if it were not there.
    let text = |hold: &str, from: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "40 ms", solver: Ode45(rtol: 1e-6), output: Every("1 s")),
    blocks: {{
        "m": Sine(amplitude: 0.8, frequency: "50 Hz"), {hold}
        "pwm": HBridgePwm(switching_frequency: "7 kHz", scheme: Bipolar),
        "s": Scope(inputs: ["gates"]),
    }},
    connections: [{from} "pwm.gates -> s.gates"],
)"#
        )
    };
    let direct = run_text(&text("", r#""m.y -> pwm.m","#));
    let held = r#""hold": ZeroOrderHold(ts: "1 s / 7000"),"#;
    let sampled = run_text(&text(held, r#""m.y -> hold.u", "hold.y -> pwm.m","#));
    let (a, b) = (edges(&direct, 0), edges(&sampled, 0));
    assert_eq!((a.len(), b.len()), (560, 560));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn a_chopper_bounds_the_voltage_of_a_link_that_is_fed() {
    // 0.1 V/us up, with the chopper on 0.2 V/us down: a triangle between both points.
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "10 ms", solver: Ode45(rtol: 1e-8), output: Every("0.1 ms")),
    blocks: {
        "on": Constant(value: "-2e5 V/s"), "off": Constant(value: "1e5 V/s"),
        "choice": Switch, "link": Integrator(x0: "650 V"),
        "chopper": ChopperControl(on_at: "700 V", off_at: "680 V"),
        "s": Scope(inputs: ["v"]),
    },
    connections: [
        "on.y -> choice.u1", "chopper.gate -> choice.control", "off.y -> choice.u3", "choice.y -> link.u",
        "link.y -> chopper.vdc, s.v",
    ],
)"#,
    );
    let v = run.column("s.v");
    assert!(v.iter().all(|v| *v < 700.0 + 1e-9));
    let later = run.time.iter().zip(v).filter(|(t, _)| **t > 0.6e-3);
    assert!(later.map(|(_, v)| *v).fold(f64::INFINITY, f64::min) > 680.0 - 1e-9);
    // Up in 0.2 ms, down in 0.1 ms.
    let times: Vec<f64> =
        run.events.iter().filter(|(_, path, _)| path == "chopper").map(|(t, ..)| *t).collect();
    assert!(times.len() > 60);
    for (k, pair) in times.windows(2).enumerate() {
        let expected = if k % 2 == 0 { 1e-4 } else { 2e-4 };
        assert!((pair[1] - pair[0] - expected).abs() < 1e-9, "{pair:?}");
    }
}

#[test]
fn a_direction_is_reversed_behind_the_hysteresis_and_never_sooner_than_the_hold() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "1 s", solver: Ode45(rtol: 1e-8), output: Every("1 s")),
    blocks: {
        "u": Sine(amplitude: 1.0, frequency: "4 Hz"),
        "quick": DirectionReverser(hysteresis: 0.5), "slow": DirectionReverser(hysteresis: 0.5, hold: "0.2 s"),
        "s": Scope(inputs: ["quick", "slow"]),
    },
    connections: ["u.y -> quick.u, slow.u", "quick.reverse -> s.quick", "slow.reverse -> s.slow"],
)"#,
    );
    let changes = |name: &str| -> Vec<f64> {
        let column = run.column(name);
        (1..column.len()).filter(|&k| column[k] != column[k - 1]).map(|k| run.time[k]).collect()
    };
    // sin(2 pi 4 t) = -+1/2: a twelfth of a period behind each zero.
    let quick = changes("s.quick");
    assert_eq!(quick.len(), 7);
    for (k, t) in quick.iter().enumerate() {
        let expected = (0.5 * (k as f64 + 1.0) + 1.0 / 12.0) / 4.0;
        assert!((t - expected).abs() < 1e-12, "{t} and not {expected}");
    }
    let slow = changes("s.slow");
    assert!(slow.len() >= 3 && slow.windows(2).all(|pair| pair[1] - pair[0] >= 0.2 - 1e-12), "{slow:?}");
}

#[test]
fn the_filtered_pulses_follow_the_reference() {
    let run = run_file("diagrams/pwm.ron", &[]);
    // Two filters of 0.2 ms at 50 Hz: 1 / (1 + (w tau)^2), late by 2 atan(w tau).
    let wt: f64 = TAU * 50.0 * 0.2e-3;
    let rows = run.time.iter().zip(run.column("phase.filtered")).filter(|(t, _)| **t > 5e-3);
    for (t, filtered) in rows {
        let expected =
            245.0 * (2.0_f64 / 3.0).sqrt() / (1.0 + wt * wt) * (TAU * 50.0 * t - 2.0 * wt.atan()).cos();
        // Sampling is late by half a period of 0.2 ms, 3 % of 200 V; the ripple is of the same size.
        assert!((filtered - expected).abs() < 12.0, "{filtered} and not {expected} at {t}");
    }
}

#[test]
fn slip_control_holds_the_speed_of_a_machine_under_load_within_its_slip() {
    let run = run_file("diagrams/asm_slip_control.ron", &[]);
    assert!((run.last("speeds.actual") + 200.0).abs() < 0.2, "{} rad/s", run.last("speeds.actual"));
    assert!((run.at("speeds.actual", 1.15) - 200.0).abs() < 10.0);
    assert!(run.column("frequencies.slip").iter().all(|slip| slip.abs() <= 2.5));
    // Power and sense: in steady state the machine carries the load.
    assert!((run.last("torque.machine").abs() - 20.0).abs() < 0.2, "{} N m", run.last("torque.machine"));
    // With a double pole at p = 12.5 1/s the end of a ramp overshoots by a / (p e) = 8.8 rad/s; the fluxes add to it.
    let speeds = run.column("speeds.actual");
    assert!(speeds.iter().all(|w| w.abs() < 220.0), "{speeds:?}");
}
