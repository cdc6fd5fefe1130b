//! Machines behind inverters: with every edge, separately integrated, averaged.

use blocksim_tests::{Run, run_text};

/// The reference machine (15 kVA, 220 V, 60 Hz, one pole pair, delta) at a prescribed speed behind an inverter with
/// a link of 400 V.
fn at_fixed_speed(inverter: &str, speed: f64, stop: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-8, atol: 1e-10), output: Every("0.2 ms")),
    blocks: {{
        "v": Constant(value: "179.62924780409972 V"), "f": Constant(value: "60 Hz"), "w": Constant(value: "{speed} rad/s"),
        "inverter": {inverter},
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
            start: Magnetised(voltage: "220 V", frequency: "60 Hz", slip: 0.02),
        ),
        "turn": IdealSpeedSource, "frame": RotationalReference,
        "s": Scope(inputs: ["torque", "shaft", "slip"]),
    }},
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "w.y -> turn.w",
        "inverter.ac <-> machine.ac", "machine.r <-> turn.r", "machine.c <-> turn.c <-> frame.r",
        "machine.torque -> s.torque", "turn.tau -> s.shaft", "machine.slip -> s.slip",
    ],
)"#
    )
}

/// Mean of a column over its last fiftieth of a second, by the rule of trapezoids.
fn mean(run: &Run, name: &str) -> f64 {
    let (t, y) = (&run.time, run.column(name));
    let end = t[t.len() - 1];
    let first = t.iter().position(|t| *t >= end - 0.02 - 1e-9).unwrap_or(0);
    let area: f64 = (first + 1..t.len()).map(|i| 0.5 * (y[i] + y[i - 1]) * (t[i] - t[i - 1])).sum();
    area / (end - t[first])
}

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() <= relative, "{found} != {expected} ({relative})");
}

/// Torque of the machine at this slip by its equivalent circuit, N*m.
const TORQUE: f64 = 45.1793;
const SPEED: f64 = 0.98 * 120.0 * std::f64::consts::PI;

#[test]
fn a_switching_inverter_gives_the_torque_of_its_mean() {
    for (modulation, sampling) in [
        ("Sine", "Symmetric"),
        ("Sine", "Asymmetric"),
        ("SpaceVector", "Symmetric"),
        ("SpaceVector", "Natural"),
    ] {
        let inverter = |integration: &str| {
            format!(
                "SwitchedInverter(vdc: \"400 V\", switching_frequency: \"5 kHz\", modulation: {modulation}, \
                 sampling: {sampling}, integration: {integration})"
            )
        };
        let run = run_text(&at_fixed_speed(&inverter("Separate(periods: 1)"), SPEED, "0.3 s"));
        // The shaft gets the mean of each coupling step.
        close(-mean(&run, "s.shaft"), TORQUE, 5e-3);
        // Against the flux of the rotor, as a circuit does not tell its frequency.
        close(run.column("s.slip")[run.time.len() - 1], 0.02, 1e-3);
    }
}

#[test]
fn separate_integration_gives_what_the_solver_gives_that_stops_at_every_edge() {
    ["Symmetric", "Natural"].into_iter().for_each(separate_is_as_together);
}

fn separate_is_as_together(sampling: &str) {
    let inverter = |integration: &str| {
        format!(
            "SwitchedInverter(vdc: \"400 V\", switching_frequency: \"5 kHz\", sampling: {sampling}, integration: {integration})"
        )
    };
    let together = run_text(&at_fixed_speed(&inverter("Together"), SPEED, "40 ms"));
    let separate = run_text(&at_fixed_speed(&inverter("Separate(periods: 1)"), SPEED, "40 ms"));
    // Rows at the beginnings of coupling steps, which are those of the carrier.
    let row = |run: &Run, t: f64| run.time.iter().rposition(|other| (other - t).abs() < 1e-9).expect("a row");
    for k in 1..200 {
        let t = f64::from(k) * 2e-4;
        let (a, b) =
            (together.column("s.torque")[row(&together, t)], separate.column("s.torque")[row(&separate, t)]);
        assert!((a - b).abs() < 1e-5, "{a} != {b} at {t}");
    }
}

/// The reference machine that runs up an inertia from rest behind an inverter of 8 kHz.
fn run_up(integration: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "32 ms", solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("1 ms")),
    blocks: {{
        "v": Constant(value: "60 V"), "f": Constant(value: "20 Hz"),
        "inverter": SwitchedInverter(
            vdc: "400 V", switching_frequency: "8 kHz", modulation: SpaceVector, integration: {integration},
        ),
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
        ),
        "rotor": Inertia(j: "0.01 kg*m^2"), "encoder": MotionSensor, "frame": RotationalReference,
        "s": Scope(inputs: ["w"]),
    }},
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "inverter.ac <-> machine.ac",
        "machine.r <-> rotor.r <-> encoder.r", "machine.c <-> encoder.c <-> frame.r", "encoder.w -> s.w",
    ],
)"#
    ))
}

#[test]
fn the_coupling_of_a_separate_circuit_is_of_order_two() {
    let speed = |run: &Run, ms: f64| {
        let row = run.time.iter().rposition(|t| (t - 1e-3 * ms).abs() < 1e-9).expect("a row");
        run.column("s.w")[row]
    };
    let exact = run_up("Together");
    // Largest error at instants that belong to all coupling steps: 1 ms, 0.5 ms, 0.25 ms.
    let errors = [8, 4, 2].map(|periods| {
        let run = run_up(&format!("Separate(periods: {periods})"));
        (1..=32)
            .map(|ms| (speed(&run, f64::from(ms)) - speed(&exact, f64::from(ms))).abs())
            .fold(0.0, f64::max)
    });
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.2..5.5).contains(&ratio), "{errors:?}");
    }
    assert!(errors[2] < 1e-3 * speed(&exact, 32.0).abs(), "{errors:?}");
}
