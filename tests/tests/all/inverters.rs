//! Machines behind inverters: with every edge, separately integrated, averaged.

use blocksim_tests::{Run, compile_text, run, run_text};

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
        "s": Scope(inputs: ["torque", "shaft", "slip", "v", "i", "p", "q", "dc"]),
    }},
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "w.y -> turn.w",
        "inverter.ac <-> machine.ac", "machine.r <-> turn.r", "machine.c <-> turn.c <-> frame.r",
        "machine.torque -> s.torque", "turn.tau -> s.shaft", "machine.slip -> s.slip",
        "machine.v_rms -> s.v", "machine.i_rms -> s.i", "machine.power -> s.p", "machine.reactive_power -> s.q",
        "inverter.power -> s.dc",
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
        let text = at_fixed_speed(&inverter("Separate(periods: 1)"), SPEED, "0.3 s");
        let run = run_text(&text.replace("Ode45(rtol: 1e-8, atol: 1e-10)", "Ode4(step: \"0.1 ms\")"));
        // The shaft gets the mean of each coupling step, which no tolerance divides.
        close(-mean(&run, "s.shaft"), TORQUE, 5e-3);
        // Against the flux of the rotor, as a circuit does not tell its frequency.
        // A mean of fluxes that turn is a little shorter.
        close(run.column("s.slip")[run.time.len() - 1], 0.02, 2e-3);
    }
}

/// At a prescribed speed nothing of the network moves but its torque: it follows a line within each coupling step, or within its parts
/// where a tolerance divides it, and its integral is that of the torque with every edge, which is that of the equivalent circuit.
#[test]
fn the_angular_impulse_on_a_shaft_that_is_held_is_that_of_the_torque() {
    for (modulation, sampling) in
        [("SpaceVector", "Symmetric"), ("Discontinuous60", "Natural"), ("Discontinuous30", "Natural")]
    {
        let torque = |integration: &str, solver: &str| {
            let inverter = format!(
                "SwitchedInverter(vdc: \"400 V\", switching_frequency: \"5 kHz\", modulation: {modulation}, \
                 sampling: {sampling}, integration: {integration})"
            );
            let text = at_fixed_speed(&inverter, SPEED, "0.3 s")
                .replace("Ode45(rtol: 1e-8, atol: 1e-10)", solver)
                .replace("\"dc\"]", "\"dc\", \"impulse\"]")
                .replace("\"s\": Scope", "\"impulse\": Integrator, \"s\": Scope")
                .replace("turn.tau -> s.shaft", "turn.tau -> s.shaft, impulse.u\", \"impulse.y -> s.impulse");
            let run = run_text(&text);
            // Whole turns of the field.
            -(run.last("s.impulse") - run.at("s.impulse", 0.25)) / 0.05
        };
        let exact = torque("Together", "Ode45(rtol: 1e-8)");
        close(exact, TORQUE, 1e-3);
        for solver in ["Ode45(rtol: 1e-8)", "Ode45(rtol: 1e-4)", "Ode4(step: \"0.1 ms\")", "Auto"] {
            close(torque("Separate(periods: 1)", solver), exact, 1e-5);
        }
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
    for k in 1..200 {
        let t = f64::from(k) * 2e-4;
        let (a, b) = (together.behind("s.torque", t), separate.behind("s.torque", t));
        assert!((a - b).abs() < 1e-5, "{a} != {b} at {t}");
    }
}

/// Coils keep currents and fluxes going: parts in a separate circuit show those of the instant, as sensors in series with them do, and as
/// without separation, whatever they follow from.
#[test]
fn parts_of_a_separate_circuit_show_the_currents_and_fluxes_of_the_instant() {
    let text = |integration: &str| {
        format!(
            r#"Diagram(
  simulation: (stop_time: "80 ms", solver: Ode45(rtol: 1e-7), output: Every("2 ms")),
  blocks: {{
    "inv": SwitchedInverter(vdc: "300 V", switching_frequency: "2 kHz", integration: {integration}),
    "v": Constant(value: "120 V"), "f": Constant(value: "40 Hz"), "sp": PhaseSplitter, "g": ElectricalReference,
    "am": AsynchronousMachine(rated_power: "15 kVA", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 Ohm",
        x_ls: "0.9 Ohm", r_r: "0.14 Ohm", x_lr: "0.41 Ohm", x_m: "17 Ohm", connection: Wye),
    "j": Inertia(j: "5e-3 kg*m^2"), "d": RotationalDamper(d: "0.01 N*m*s/rad"), "h": RotationalReference, "rc": Resistor(r: "300 ohm"),
    "mw": MagneticWinding(turns: 200, r: "0.8 ohm"), "cw": CurrentSensor, "fs": FluxSensor, "mr": MagneticReference,
    "mc": MagneticCore(length: "0.2 m", area: "4 cm^2", mu_r: 500, saturation: "1 T"),
    "l": Inductor(l: "10 mH"), "sw": IdealSwitch, "one": Constant(value: true), "it": IdealTransformer(ratio: 2),
    "r2": Resistor(r: "20 ohm"), "c2": CurrentSensor,
    "s": Scope(inputs: ["w", "winding", "cw", "flux", "fs", "b", "l", "switch", "i2", "c2", "ids", "pu_ids"]),
  }},
  connections: [
    "v.y -> inv.v", "f.y -> inv.f", "inv.ac <-> am.ac <-> sp.ac", "am.r <-> j.r <-> d.r", "am.c <-> d.c <-> h.r", "am.velocity -> s.w",
    "sp.c <-> rc.p", "rc.n <-> g.p", "sp.a <-> cw.p", "cw.n <-> mw.p", "sp.b <-> mw.n", "mw.mp <-> fs.p", "fs.n <-> mc.p",
    "mw.mn <-> mc.n <-> mr.p", "mw.i -> s.winding", "cw.i -> s.cw", "mc.flux -> s.flux", "fs.flux -> s.fs", "mc.b -> s.b",
    "one.y -> sw.gate", "sp.b <-> l.p", "l.n <-> sw.p", "sw.n <-> it.p1", "it.n1 <-> sp.c", "it.p2 <-> c2.p", "c2.n <-> r2.p",
    "it.n2 <-> r2.n <-> g.p", "l.i -> s.l", "sw.i -> s.switch", "it.i2 -> s.i2", "c2.i -> s.c2", "am.i_ds -> s.ids",
    "am.pu_ids -> s.pu_ids",
  ],
)"#
        )
    };
    let together = run_text(&text("Together"));
    for periods in [1, 4] {
        let run = run_text(&text(&format!("Separate(periods: {periods})")));
        let at = |run: &Run, name: &str, t: f64| run.behind(&format!("s.{name}"), t);
        for t in (1..10).map(|k| 8e-3 * f64::from(k)) {
            let of = |name: &str| at(&run, name, t);
            for (part, sensor) in [("winding", "cw"), ("flux", "fs"), ("switch", "l")] {
                assert!(
                    (of(part) - of(sensor)).abs() < 1e-6 * of(sensor).abs(),
                    "{part} {periods} at {t}: {} {}",
                    of(part),
                    of(sensor)
                );
            }
            assert!(
                (of("i2").abs() - of("c2").abs()).abs() < 1e-6,
                "{periods} at {t}: {} {}",
                of("i2"),
                of("c2")
            );
            assert!((of("b") - of("flux") / 4e-4).abs() < 1e-6, "{periods} at {t}");
            for name in ["w", "winding", "flux", "b", "switch", "i2", "ids", "pu_ids"] {
                let (found, expected) = (of(name), at(&together, name, t));
                let size = together
                    .column(&format!("s.{name}"))
                    .iter()
                    .fold(0.0_f64, |most, value| most.max(value.abs()));
                assert!(
                    (found - expected).abs() < 2e-4 * size,
                    "{name} {periods} at {t} s: {found}, not {expected}"
                );
            }
        }
    }
}

/// A coil in series with an open switch lets go of its current within microseconds, far faster than a step of the integrator from edge to edge:
/// steps follow that, or the run ends with the reason. Without, the current went up to 1e103 A, and the warning was one about the speed.
#[test]
fn what_is_fast_in_a_separate_circuit_is_integrated_in_short_steps() {
    let text = |integration: &str, g: &str| {
        format!(
            r#"Diagram(
  simulation: (stop_time: "40 ms", solver: Ode45(rtol: 1e-7), output: Every("2 ms")),
  blocks: {{
    "inv": SwitchedInverter(vdc: "300 V", switching_frequency: "2 kHz", integration: {integration}),
    "v": Constant(value: "120 V"), "f": Constant(value: "40 Hz"), "sp": PhaseSplitter, "g": ElectricalReference, "rc": Resistor(r: "300 ohm"),
    "pm": PermanentMagnetMachine(pole_pairs: 2, r_s: "0.6 ohm", l_d: "3.4 mH", l_q: "5.8 mH", flux: "0.12 Wb"),
    "j": Inertia(j: "5e-3 kg*m^2"), "d": RotationalDamper(d: "0.01 N*m*s/rad"), "h": RotationalReference, "m": MotionSensor,
    "sw": IdealSwitch(g_off: {g}), "on": Constant(value: false), "rw": Resistor(r: "10 ohm"), "lw": Inductor(l: "5 mH"),
    "s": Scope(inputs: ["i", "w"]),
  }},
  connections: [
    "v.y -> inv.v", "f.y -> inv.f", "inv.ac <-> pm.ac <-> sp.ac", "pm.r <-> j.r <-> d.r <-> m.r", "pm.c <-> d.c <-> h.r <-> m.c", "m.w -> s.w",
    "sp.c <-> rc.p", "rc.n <-> g.p", "sp.a <-> sw.p", "sw.n <-> rw.p", "rw.n <-> lw.p", "lw.n <-> sp.b", "on.y -> sw.gate", "lw.i -> s.i",
  ],
)"#
        )
    };
    for g in ["\"10 mS\"", "\"1 mS\"", "\"0.1 mS\""] {
        let together = run_text(&text("Together", g));
        for periods in [1, 4] {
            let run = run_text(&text(&format!("Separate(periods: {periods})"), g));
            // The speed is right, and no current that outlasts a step is off.
            assert!(run.warnings.is_empty(), "{g} {periods}: {:?}", run.warnings);
            let size = together.column("s.i").iter().fold(0.0_f64, |most, i| most.max(i.abs()));
            for t in (1..5).map(|k| 8e-3 * f64::from(k)) {
                let [(i, i_0), (w, w_0)] =
                    ["s.i", "s.w"].map(|name| (run.behind(name, t), together.behind(name, t)));
                assert!((i - i_0).abs() < 2e-3 * size, "{g} {periods} at {t} s: {i} A, not {i_0} A");
                assert!((w - w_0).abs() < 1e-4, "{g} {periods} at {t} s: {w} rad/s, not {w_0} rad/s");
            }
        }
    }
    let (compiled, problems) = compile_text(&text("Separate(periods: 4)", "\"1 nS\""));
    let error =
        run(compiled.schedule.unwrap_or_else(|| panic!("{problems}"))).error.expect("a failure").to_string();
    assert!(error.contains("too fast for `integration: Separate`"), "{error}");
}

/// What swings in a separate circuit does so as in one with the solver, with steps that follow the tolerance: with four steps a coupling step the
/// currents of this filter were off by 9 %.
#[test]
fn a_filter_in_a_separate_circuit_swings_as_in_one_with_the_solver() {
    let text = |integration: &str| {
        format!(
            r#"Diagram(
  simulation: (stop_time: "20 ms", solver: Ode45(rtol: 1e-7), output: Every("1 ms")),
  blocks: {{
    "inv": SwitchedInverter(vdc: "560 V", switching_frequency: "1 kHz", integration: {integration}),
    "v": Constant(value: "200 V"), "f": Constant(value: "50 Hz"), "filter": ThreePhaseRlc(r: "1.5 ohm", l: "5 mH", c: "1 uF"),
    "star": FloatingNeutral, "part": Selector(indices: [0]), "s": Scope(inputs: ["i"]),
  }},
  connections: ["v.y -> inv.v", "f.y -> inv.f", "inv.ac <-> filter.ac1", "filter.ac2 <-> star.ac", "filter.i -> part.u", "part.y -> s.i"],
)"#
        )
    };
    let together = run_text(&text("Together"));
    let size = together.column("s.i").iter().fold(0.0_f64, |most, i| most.max(i.abs()));
    for periods in [1, 2] {
        let run = run_text(&text(&format!("Separate(periods: {periods})")));
        for t in (1..10).map(|k| 2e-3 * f64::from(k)) {
            let (i, expected) = (run.behind("s.i", t), together.behind("s.i", t));
            assert!((i - expected).abs() < 1e-4 * size, "{periods} at {t} s: {i} A, not {expected} A");
        }
    }
}

/// Instants at which a carrier begins say nothing of voltages: all legs are low.
#[test]
fn a_separate_circuit_shows_the_means_of_what_switches() {
    let averaged = run_text(&at_fixed_speed("AveragedInverter(vdc: \"400 V\")", SPEED, "60 ms"));
    let switched = "SwitchedInverter(vdc: \"400 V\", switching_frequency: \"10 kHz\", integration: Separate(periods: 1))";
    let separate = run_text(&at_fixed_speed(switched, SPEED, "60 ms"));
    for (name, relative) in [("s.v", 2e-3), ("s.i", 2e-3), ("s.p", 2e-3), ("s.q", 5e-3), ("s.dc", 2e-3)] {
        close(mean(&separate, name), mean(&averaged, name), relative);
    }
    // What the inverter takes arrives at the machine.
    for (dc, p) in separate.column("s.dc").iter().zip(separate.column("s.p")).skip(10) {
        assert!((dc - p).abs() < 1e-3 * p.abs(), "{dc} != {p}");
    }
}

/// The mean of a leg over a period of the carrier is what its reference asks for in the middle of it.
#[test]
fn a_separate_circuit_shows_the_means_of_its_legs() {
    let switched = "SwitchedInverter(vdc: \"400 V\", switching_frequency: \"10 kHz\", integration: Separate(periods: 1))";
    let text = at_fixed_speed(switched, SPEED, "20 ms")
        .replace("\"dc\"]", "\"dc\", \"legs\"]")
        .replace("\"inverter.power -> s.dc\",", "\"inverter.power -> s.dc\", \"inverter.v_legs -> s.legs\",");
    let run = run_text(&text);
    let rows = run.time.iter().enumerate().filter(|(_, t)| **t > 0.0);
    for (row, t) in rows {
        for leg in 0..3 {
            let angle = std::f64::consts::TAU * (60.0 * (t - 0.5e-4) - f64::from(leg) / 3.0);
            let expected = 200.0 + 179.62924780409972 * angle.cos();
            let found = run.column(&format!("s.legs[{leg}]"))[row];
            assert!((found - expected).abs() < 1e-6, "{found} != {expected} at {t}");
        }
    }
}

/// A machine that starts in the steady state of its source has no transient, also where a sensor lies between.
#[test]
fn a_magnetised_machine_knows_the_phase_of_its_source_through_a_sensor() {
    for source in [
        r#""mains": ThreePhaseSource(voltage: "220 V", frequency: "60 Hz", phase: "70 deg")"#,
        r#""mains": ThreePhaseSource(voltage: "220 V", frequency: "60 Hz", phase: "-2", neutral: Floating)"#,
    ] {
        let text = at_fixed_speed("ThreePhaseCurrentSensor", SPEED, "60 ms")
            .replace("\"inverter\": ", &format!("{source}, \"inverter\": "))
            .replace("\"v.y -> inverter.v\", \"f.y -> inverter.f\", ", "\"mains.ac <-> inverter.ac1\", ")
            .replace("inverter.ac <-> machine.ac", "inverter.ac2 <-> machine.ac")
            .replace(
                "\"v\": Constant(value: \"179.62924780409972 V\"), \"f\": Constant(value: \"60 Hz\"), ",
                "",
            )
            .replace("\"inverter.power -> s.dc\",", "\"mains.power -> s.dc\",");
        let run = run_text(&text);
        let torque = run.column("s.torque");
        assert!(
            torque.iter().all(|torque| (torque / TORQUE - 1.0).abs() < 1e-4),
            "{source}: {:?}",
            &torque[..5]
        );
    }
}

#[test]
fn a_negative_amplitude_turns_the_voltages_by_half_a_turn() {
    let torques = ["", "-"].map(|sign| {
        let text = at_fixed_speed("AveragedInverter(vdc: \"400 V\")", SPEED, "0.3 s")
            .replace("179.62924780409972 V", &format!("{sign}179.62924780409972 V"));
        mean(&run_text(&text), "s.torque")
    });
    close(torques[1], torques[0], 1e-3);
}

/// An exchange of two phases turns the field the other way; what magnetises the machine stays positive.
#[test]
fn reactive_power_does_not_know_which_way_the_field_turns() {
    let powers = [("60 Hz", SPEED), ("-60 Hz", -SPEED)].map(|(frequency, speed)| {
        let text = at_fixed_speed("AveragedInverter(vdc: \"400 V\")", speed, "0.3 s")
            .replace("f\": Constant(value: \"60 Hz\")", &format!("f\": Constant(value: \"{frequency}\")"))
            .replace(
                "start: Magnetised(voltage: \"220 V\", frequency: \"60 Hz\"",
                &format!("start: Magnetised(voltage: \"220 V\", frequency: \"{frequency}\""),
            );
        let run = run_text(&text);
        [mean(&run, "s.p"), mean(&run, "s.q")]
    });
    assert!(powers[0][1] > 1e3, "{powers:?}");
    (0..2).for_each(|k| close(powers[1][k], powers[0][k], 1e-6));
}

/// A rotor so light that it changes its speed within a coupling step as fast as the currents.
#[test]
fn a_light_rotor_runs_up_as_it_does_together_with_its_circuit() {
    let runs = ["Together", "Separate(periods: 1)"]
        .map(|integration| run_up_of("1e-4 kg*m^2", "2 kHz", integration));
    let size = runs[0].column("s.w").iter().fold(0.0, |most: f64, w| most.max(w.abs()));
    for ms in 1..=32 {
        let t = 1e-3 * f64::from(ms);
        let [together, separate] = [0, 1].map(|k: usize| runs[k].behind("s.w", t));
        assert!((together - separate).abs() < 0.03 * size, "{separate} != {together} at {t}");
    }
}

fn run_up_of(inertia: &str, carrier: &str, integration: &str) -> Run {
    run_text(&run_up_text(inertia, carrier, integration))
}

/// The reference machine that runs up an inertia from rest behind an inverter.
fn run_up_text(inertia: &str, carrier: &str, integration: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "32 ms", solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("1 ms")),
    blocks: {{
        "v": Constant(value: "60 V"), "f": Constant(value: "20 Hz"),
        "inverter": SwitchedInverter(
            vdc: "400 V", switching_frequency: "{carrier}", modulation: SpaceVector, integration: {integration},
        ),
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
        ),
        "rotor": Inertia(j: "{inertia}"), "encoder": MotionSensor, "frame": RotationalReference,
        "s": Scope(inputs: ["w"]),
    }},
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "inverter.ac <-> machine.ac",
        "machine.r <-> rotor.r <-> encoder.r", "machine.c <-> encoder.c <-> frame.r", "encoder.w -> s.w",
    ],
)"#
    )
}

const TIGHT: &str = "Ode45(rtol: 1e-9, atol: 1e-9)";

/// Largest error of the speed at instants that belong to all coupling steps (1 ms, 0.5 ms, 0.25 ms) in parts of the speed, of a
/// rotor with this load, with a method of fixed step, which leaves coupling steps as they are.
fn coupling_errors(load: &str, carrier: &str, periods: [u32; 3]) -> [f64; 3] {
    let wired = if load.contains("load") { "\"rotor.r <-> load.r\", \"load.c <-> far.r\", " } else { "" };
    let run = |integration: &str, solver: Option<&str>| {
        let text =
            run_up_text("0.01 kg*m^2", carrier, integration).replace("\"encoder\": MotionSensor", load);
        let text = text.replace(TIGHT, solver.unwrap_or(TIGHT));
        run_text(&text.replace("connections: [", &format!("connections: [{wired}")))
    };
    let speed = |run: &Run, ms: f64| run.behind("s.w", 1e-3 * ms);
    let exact = run("Together", None);
    periods.map(|periods| {
        let run = run(&format!("Separate(periods: {periods})"), Some("Ode4(step: \"25 us\")"));
        let error = |ms: i32| (speed(&run, f64::from(ms)) - speed(&exact, f64::from(ms))).abs();
        (1..=32).map(error).fold(0.0, f64::max) / speed(&exact, 32.0).abs()
    })
}

/// What the torques do to a speed through an inertia the circuit knows by itself.
#[test]
fn a_separate_circuit_with_a_mere_inertia_is_as_exact_as_together_with_it() {
    let errors = coupling_errors("\"encoder\": MotionSensor", "8 kHz", [8, 4, 2]);
    assert!(errors.iter().all(|error| *error < 1e-8), "{errors:?}");
}

/// A load that bends the speed within a coupling step.
const DAMPED: &str =
    "\"encoder\": MotionSensor, \"load\": RotationalDamper(d: \"1 N*m*s/rad\"), \"far\": RotationalReference";

#[test]
fn the_coupling_of_a_separate_circuit_is_of_order_three() {
    // A fast carrier, whose ripple does not count.
    let errors = coupling_errors(DAMPED, "32 kHz", [32, 16, 8]);
    assert!(errors[2] < 2e-6, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((5.0..11.0).contains(&ratio), "{errors:?}");
    }
}

/// A damper sees the mean of the ripple of a speed, and not what it is where a carrier begins.
#[test]
fn what_ripple_does_to_a_load_falls_with_the_square_of_the_carrier() {
    let errors = ["8 kHz", "16 kHz"].map(|carrier| coupling_errors(DAMPED, carrier, [2, 1, 1])[1]);
    let ratio = errors[0] / errors[1];
    assert!(errors[0] < 4e-6 && (3.0..6.0).contains(&ratio), "{errors:?}");
}

/// What a run says about its coupling: by how much of its maximum the speed is off.
fn warned(run: &Run) -> Option<f64> {
    let [warning] = run.warnings.as_slice() else {
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
        return None;
    };
    let (_, rest) = warning.message.split_once("is off by about ").expect("a number");
    Some(rest.split_once(' ').expect("a number").0.parse().expect("a number"))
}

/// A run-up against a damper.
fn damped_text(inertia: &str, carrier: &str, damping: &str, integration: &str) -> String {
    let load = format!(
        "\"encoder\": MotionSensor, \"load\": RotationalDamper(d: \"{damping}\"), \"far\": RotationalReference"
    );
    run_up_text(inertia, carrier, integration)
        .replace("\"encoder\": MotionSensor", &load)
        .replace("connections: [", "connections: [\"rotor.r <-> load.r\", \"load.c <-> far.r\", ")
}

/// A servo of 0.1 g m^2 at 2 kHz, whose coupling steps are divided by this solver.
pub(crate) fn light_servo(solver: &str) -> String {
    damped_text("1e-4 kg*m^2", "2 kHz", "0.05 N*m*s/rad", "Separate(periods: 1)").replace(TIGHT, solver)
}

/// Largest difference of the speed of two runs at every millisecond, over the greatest speed.
fn speeds_apart(run: &Run, exact: &Run) -> f64 {
    let most = exact.column("s.w").iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    let speed = |run: &Run, ms: i32| run.behind("s.w", 1e-3 * f64::from(ms));
    (1..=32).map(|ms| (speed(run, ms) - speed(exact, ms)).abs()).fold(0.0, f64::max) / most
}

/// Rotors, carriers, loads and periods in a coupling step, from a heavy rotor to a servo of 0.1 g m^2 that follows the ripple.
const DRIVES: [(&str, &str, &str, u32); 5] = [
    ("0.01 kg*m^2", "8 kHz", "1 N*m*s/rad", 8),
    ("0.01 kg*m^2", "8 kHz", "1 N*m*s/rad", 1),
    ("1e-4 kg*m^2", "2 kHz", "0.05 N*m*s/rad", 1),
    ("1e-4 kg*m^2", "8 kHz", "0.05 N*m*s/rad", 4),
    ("1e-4 kg*m^2", "2 kHz", "0 N*m*s/rad", 1),
];

/// Coupling steps are divided until the tolerance is kept, or as good as kept and told.
#[test]
fn a_tighter_tolerance_makes_a_separate_circuit_more_exact() {
    let mut missed = Vec::new();
    for (inertia, carrier, damping, periods) in DRIVES {
        let exact = run_text(&damped_text(inertia, carrier, damping, "Together"));
        let separate = damped_text(inertia, carrier, damping, &format!("Separate(periods: {periods})"));
        for rtol in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let run = run_text(&separate.replace(TIGHT, &format!("Ode45(rtol: {rtol:e})")));
            let error = speeds_apart(&run, &exact);
            if error > 3.0 * rtol && warned(&run).is_none() || error > 10.0 * rtol {
                let told = warned(&run);
                missed.push(format!(
                    "{inertia}, {carrier}, {damping}, {periods} periods at {rtol:e}: {error:.1e}, told {told:?}"
                ));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// No number of parts is enough for a tolerance of 1e-11.
#[test]
fn a_coupling_that_cannot_keep_the_tolerance_is_told() {
    let exact = run_text(&damped_text("1e-4 kg*m^2", "2 kHz", "0.05 N*m*s/rad", "Together"));
    let separate = damped_text("1e-4 kg*m^2", "2 kHz", "0.05 N*m*s/rad", "Separate(periods: 2)");
    let run = run_text(&separate.replace(TIGHT, "Ode45(rtol: 1e-11, atol: 1e-11)"));
    let (error, told) = (speeds_apart(&run, &exact), warned(&run).expect("it is missed"));
    assert!((0.3 * error..30.0 * error).contains(&told), "{told} is told of {error}");
}

/// Errors are those of whole coupling steps, with a method of fixed step.
#[test]
fn a_coupling_that_misses_the_tolerance_is_told_with_its_error() {
    let heavy = [8, 2, 1].map(|periods| ("0.01 kg*m^2", "8 kHz", "1 N*m*s/rad", periods));
    let light =
        [("1e-4 kg*m^2", "8 kHz", "0.05 N*m*s/rad", 8), ("1e-4 kg*m^2", "2 kHz", "0.05 N*m*s/rad", 1)];
    for (inertia, carrier, damping, periods) in heavy.into_iter().chain(light) {
        let exact = run_text(&damped_text(inertia, carrier, damping, "Together"));
        assert_eq!(warned(&exact), None);
        let separate = damped_text(inertia, carrier, damping, &format!("Separate(periods: {periods})"));
        let run = run_text(&separate.replace(TIGHT, "Ode4(step: \"25 us\")"));
        let error = speeds_apart(&run, &exact);
        if inertia == heavy[0].0 {
            // A tolerance that is kept is not talked about.
            assert!(error < 1e-3 && warned(&run).is_none(), "{error}, {periods} periods");
            continue;
        }
        let told = warned(&run).expect("a tolerance of 1e-3 is missed");
        assert!((0.2 * error..5.0 * error).contains(&told), "{told} is told of {error}, {periods} periods");
    }
}

/// A machine runs up by a frequency that is made so, with the amplitude that belongs to it.
fn moving_text(frequency: [&str; 2], integration: &str, tolerance: &str) -> String {
    let [blocks, connections] = frequency;
    format!(
        r#"Diagram(
    simulation: (stop_time: "0.2 s", solver: Ode45(rtol: {tolerance}), output: Every("2 ms")),
    blocks: {{
        {blocks}
        "v": Gain(k: "3 V/Hz"),
        "inverter": SwitchedInverter(
            vdc: "400 V", switching_frequency: "2 kHz", sampling: Symmetric, integration: {integration},
        ),
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
        ),
        "rotor": Inertia(j: "0.05 kg*m^2"), "load": Inertia(j: "0.05 kg*m^2"),
        "coupling": RotationalSpringDamper(k: "200 N*m/rad", d: "0.1 N*m*s/rad"),
        "fan": QuadraticLoad(torque: "20 N*m", speed: "310 rad/s"),
        "frame": RotationalReference, "encoder": MotionSensor, "s": Scope(inputs: ["w", "torque"]),
    }},
    connections: [
        {connections}
        "f.y -> v.u, inverter.f", "v.y -> inverter.v", "inverter.ac <-> machine.ac",
        "machine.r <-> rotor.r <-> coupling.r <-> encoder.r", "coupling.c <-> load.r <-> fan.r",
        "machine.c <-> frame.r <-> fan.c <-> encoder.c", "encoder.w -> s.w", "machine.torque -> s.torque",
    ],
)"#
    )
}

/// Inputs that move within a coupling step go on as they move; the part of one that is sampled stays where it is. A drive whose
/// frequency is made from its own speed moves all the time. With inputs held, speeds are off by 1e-3 to 4e-3 of their greatest. What
/// jumps or has a kink between two hits does so at once: acting from the next hit on only, it puts speeds off by up to 1e-2.
#[test]
fn inputs_move_within_a_coupling_step() {
    let sine = r#""f0": Sine(amplitude: "10 Hz", frequency: "7 Hz", bias: "20 Hz"),"#;
    let mixed = format!(r#"{sine} "f1": ZeroOrderHold(ts: "2 ms"), "f": Sum(signs: "++"),"#);
    let sampled = format!(r#"{sine} "f": ZeroOrderHold(ts: "2 ms"),"#);
    let drives = [
        ([r#""f": Ramp(slope: "200 Hz/s"),"#, ""], 3e-6),
        ([r#""f": Sine(amplitude: "10 Hz", frequency: "7 Hz", bias: "40 Hz"),"#, ""], 3e-6),
        ([&*sampled, r#""f0.y -> f.u","#], 3e-6),
        ([&*mixed, r#""f0.y -> f1.u, f.u1", "f1.y -> f.u2","#], 3e-6),
        (
            [
                r#""w": Constant(value: "200 rad/s"), "e": Sum(signs: "+-"), "pi": Pid(kp: "0.2 Hz/(rad/s)", ki: "1 Hz/rad"),
                   "f": Gain(k: 1.0),"#,
                r#""w.y -> e.u1", "encoder.w -> e.u2", "e.y -> pi.e", "pi.u -> f.u","#,
            ],
            6e-5,
        ),
        ([r#""f": Step(before: "30 Hz", after: "40 Hz", time: "0.1003 s"),"#, ""], 5e-6),
        (
            [
                r#""f0": Sine(amplitude: "10 Hz", frequency: "7 Hz", bias: "40 Hz"), "f": ZeroOrderHold(ts: "0.7 ms"),"#,
                r#""f0.y -> f.u","#,
            ],
            1e-5,
        ),
        (
            [
                r#""f0": Sine(amplitude: "10 Hz", frequency: "7 Hz", bias: "40 Hz"), "f": ZeroOrderHold(ts: "0.5 ms"),"#,
                r#""f0.y -> f.u","#,
            ],
            3e-6,
        ),
        (
            [
                r#""p": Pulse(amplitude: "10 Hz", period: "7.3 ms", width: 0.37), "b": Constant(value: "30 Hz"), "f": Sum(signs: "++"),"#,
                r#""p.y -> f.u1", "b.y -> f.u2","#,
            ],
            2e-5,
        ),
        ([r#""f": Sawtooth(lower: "10 Hz", upper: "50 Hz", period: "40 ms", width: 0.5),"#, ""], 3e-6),
    ];
    for (frequency, allowed) in drives {
        let exact = run_text(&moving_text(frequency, "Together", "1e-9"));
        for periods in [1, 4] {
            let run = run_text(&moving_text(frequency, &format!("Separate(periods: {periods})"), "1e-6"));
            for (signal, allowed) in [("s.w", allowed), ("s.torque", 10.0 * allowed)] {
                let size = exact.column(signal).iter().fold(0.0_f64, |most, y| most.max(y.abs()));
                let at = |run: &Run, k: i32| run.behind(signal, 2e-3 * f64::from(k));
                let off = |k: i32| (at(&run, k) - at(&exact, k)).abs();
                let off = (0..=100).map(off).fold(0.0, f64::max) / size;
                assert!(off < allowed, "{frequency:?}, {periods} periods: {signal} is off by {off:.1e}");
            }
        }
    }
}

/// Contacts in a separate circuit that change over between two hits do so at once: from the next hit on only, speeds were off by 3e-2.
#[test]
fn contacts_change_within_a_coupling_step() {
    let reversed = r#""f": Constant(value: "40 Hz"), "p": Pulse(period: "83.3 ms", width: 0.47),
        "at": Compare(operator: Greater, constant: 0.5), "contacts": ReversingContactor(r_on: "1 mOhm"),"#;
    let speeds = |integration: &str, rtol: &str| {
        let text =
            moving_text([reversed, r#""p.y -> at.u", "at.y -> contacts.reverse","#], integration, rtol)
                .replace(
                    "inverter.ac <-> machine.ac",
                    "inverter.ac <-> contacts.ac1\", \"contacts.ac2 <-> machine.ac",
                );
        let run = run_text(&text);
        (0..=100).map(|k| run.behind("s.w", 2e-3 * f64::from(k))).collect::<Vec<f64>>()
    };
    let exact = speeds("Together", "1e-9");
    let size = exact.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    for periods in [1, 4] {
        let found = speeds(&format!("Separate(periods: {periods})"), "1e-6");
        let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
        assert!(off < 5e-5, "{periods} periods: off by {off:.1e}");
    }
}

/// About a kink the frequency is expected to go on as before for a step, and not to move for another. The angle has lost nothing of its
/// integral by then: 2 pi (2 * 20 ms * 30 Hz + 10 ms * 20 Hz).
#[test]
fn the_angle_of_an_inverter_is_the_integral_of_a_frequency_with_kinks() {
    let triangle = r#""f": SignalBuilder(points: [("0 s", "10 Hz"), ("20 ms", "50 Hz"), ("40 ms", "10 Hz"), ("60 ms", "50 Hz")]),"#;
    for periods in [1, 4] {
        let text = moving_text([triangle, ""], &format!("Separate(periods: {periods})"), "1e-6")
            .replace(r#""w", "torque"]"#, r#""w", "torque", "theta"]"#)
            .replace(
                r#""machine.torque -> s.torque","#,
                r#""machine.torque -> s.torque", "inverter.theta -> s.theta","#,
            )
            .replace(r#"stop_time: "0.2 s""#, r#"stop_time: "50 ms""#);
        let (found, right) = (run_text(&text).last("s.theta"), 2.0 * std::f64::consts::PI * 1.4);
        assert!((found - right).abs() < 1e-9, "{periods} periods: {found} rad, not {right}");
    }
}

/// Another sample time makes the common clock a fine one; circuits are coupled at the same times all the same. With a clock that had lost digits
/// whole coupling steps were left out, and the machine ran at twice its speed.
#[test]
fn a_sample_time_that_has_nothing_to_do_with_a_circuit_changes_nothing() {
    let steady = |beside: &str| {
        let text = moving_text(
            [&format!(r#""f": Constant(value: "40 Hz"), {beside}"#), ""],
            "Separate(periods: 1)",
            "1e-6",
        )
        .replace("2 kHz", "1250 Hz")
        .replace(r#""w", "torque"]"#, r#""w", "torque", "theta"]"#)
        .replace(
            r#""machine.torque -> s.torque","#,
            r#""machine.torque -> s.torque", "inverter.theta -> s.theta","#,
        );
        if beside.is_empty() {
            text
        } else {
            text.replace("connections: [", r#"connections: ["f.y -> hold.u", "hold.y -> no.u","#)
        }
    };
    let alone = run_text(&steady(""));
    for ts in ["0.4919 ms", "0.3681 ms", "6.378 ms"] {
        let beside = run_text(&steady(&format!(r#""hold": ZeroOrderHold(ts: "{ts}"), "no": Terminator,"#)));
        let right = 2.0 * std::f64::consts::PI * 40.0 * 0.2;
        assert!((beside.last("s.theta") - right).abs() < 1e-9, "{ts}: {} rad", beside.last("s.theta"));
        let [found, right] = [&beside, &alone].map(|run| run.last("s.w"));
        assert!((found - right).abs() < 1e-5 * right, "{ts}: {found} rad/s, not {right} rad/s");
    }
}

/// What strikes the shaft of a machine strikes the machine: its circuit went on with the speed before until the end of the coupling step, which
/// put speeds off by 9e-3 of their greatest.
#[test]
fn a_shaft_that_is_struck_changes_its_speed_within_a_coupling_step() {
    let text = |inputs: &str, integration: &str, rtol: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "0.3 s", solver: Ode45(rtol: {rtol}), output: Every("2 ms")),
    blocks: {{
        {inputs}
        "inverter": SwitchedInverter(vdc: "400 V", switching_frequency: "4 kHz", integration: {integration}),
        "machine": PermanentMagnetMachine(pole_pairs: 2, r_s: "0.4 ohm", l_d: "3 mH", l_q: "5 mH", flux: "0.25 Wb"),
        "rotor": Inertia(j: 0.02), "frame": RotationalReference, "load": RotationalDamper(d: 0.05),
        "stop": RotationalRigidStop(lower: -1, upper: 3, restitution: 0.5), "encoder": MotionSensor, "s": Scope(inputs: ["w"]),
    }},
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "inverter.ac <-> machine.ac", "encoder.w -> s.w",
        "machine.r <-> rotor.r <-> load.r <-> encoder.r <-> stop.r",
        "frame.r <-> machine.c <-> load.c <-> encoder.c <-> stop.c",
    ],
)"#
        )
    };
    let at = |run: &Run| -> Vec<f64> { (0..=150).map(|k| run.behind("s.w", 2e-3 * f64::from(k))).collect() };
    for inputs in [
        r#""v": Ramp(slope: "450 V/s", initial: "15 V"), "f": Ramp(slope: "200 Hz/s"),"#,
        // Inputs that never move, of which nobody is told at the ends of steps.
        r#""v": Constant(value: "60 V"), "f": Constant(value: "15 Hz"),"#,
    ] {
        let exact = run_text(&text(inputs, "Together", "1e-9"));
        assert!(exact.events.iter().any(|event| event.1 == "stop"), "{:?}", exact.events);
        let exact = at(&exact);
        let size = exact.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        for periods in [1, 4] {
            let run = run_text(&text(inputs, &format!("Separate(periods: {periods})"), "1e-6"));
            let off = at(&run).iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
            assert!(off < 3e-5, "{inputs}, {periods} periods: off by {off:.1e}");
        }
    }
}
