//! Parts whose losses flow into thermal networks: nothing of the heat is lost, and machines feel their temperature.

use blocksim_tests::{Run, compile_text, run, run_text};

fn text(stop: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Auto(rtol: 1e-9)),
    blocks: {{ {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

/// A motor that is held at rest.
fn locked(motor: &str, more: &str, connections: &str, shown: &str, stop: &str) -> String {
    text(
        stop,
        &format!(
            r#""g": ElectricalReference, "still": RotationalReference, "m": {motor}, "c": HeatCapacity(c: "15 J/K"), "air": Ambient,
               {more}"#
        ),
        &format!(
            r#""m.n <-> g.p", "m.r <-> m.c <-> still.r", "m.h <-> c.h", "m.i -> s.i", "c.t -> s.t", {connections}"#
        ),
        shown,
    )
}

/// A constant resistance at a constant voltage: the temperature approaches its end as an exponential does.
#[test]
fn a_locked_motor_warms_up_along_its_heating_curve() {
    for l in ["0 H", "2 mH"] {
        let run = run_text(&locked(
            &format!(
                r#"DcMotor(r: "2 ohm", l: "{l}", k: "0.1 N*m/A", j: "1e-4 kg*m^2", heat_port: true, t_max: "1000 K")"#
            ),
            r#""u": VoltageSource(v: "6 V"), "loss": ThermalResistance(r: "2 K/W")"#,
            r#""u.p <-> m.p", "u.n <-> g.p", "c.h <-> loss.a", "loss.b <-> air.h""#,
            r#""i", "t""#,
            "100 s",
        ));
        for (t, found) in run.time.iter().zip(run.column("s.t")) {
            let expected = 293.15 + 36.0 * (1.0 - (-t / 30.0).exp());
            // The current of the inductance comes 1 ms late: 18 W for 2/3 of that are 12 mJ, less than a thousandth of a kelvin.
            let allowed = if l == "0 H" { 1e-6 } else { 2e-3 };
            assert!((found - expected).abs() < allowed, "{found} for {expected} at {t} s with {l}");
        }
        assert!(run.events.is_empty(), "{:?}", run.events);
    }
}

/// Against the classical Runge-Kutta method on current and temperature.
#[test]
fn a_winding_that_warms_up_takes_less_current() {
    let run = run_text(&locked(
        r#"DcMotor(r: "2 ohm", l: "200 mH", k: "0.1 N*m/A", j: "1e-4 kg*m^2", heat_port: true, alpha: "3.93e-3 1/K")"#,
        r#""u": VoltageSource(v: "12 V"), "loss": ThermalResistance(r: "2 K/W"),
           "account": EnergyAccount(at: Electrical, tolerance: 1e-6)"#,
        r#""u.p <-> m.p", "u.n <-> g.p <-> account.node", "c.h <-> loss.a", "loss.b <-> air.h""#,
        r#""i", "t""#,
        "20 s",
    ));
    let rate = |[i, t]: [f64; 2]| {
        let r = 2.0 * (1.0 + 3.93e-3 * (t - 293.15));
        [(12.0 - r * i) / 0.2, (r * i * i - (t - 293.15) / 2.0) / 15.0]
    };
    let plus = |x: [f64; 2], h: f64, dx: [f64; 2]| [x[0] + h * dx[0], x[1] + h * dx[1]];
    let (mut at, mut x) = (0.0, [0.0, 293.15]);
    for (row, time) in run.time.iter().enumerate() {
        let steps = ((time - at) / 1e-3).ceil().max(1.0);
        let h = (time - at) / steps;
        for _ in 0..steps as usize {
            let a = rate(x);
            let b = rate(plus(x, 0.5 * h, a));
            let c = rate(plus(x, 0.5 * h, b));
            let d = rate(plus(x, h, c));
            x = [0, 1].map(|k| x[k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
        }
        at = *time;
        assert!(
            (run.column("s.i")[row] - x[0]).abs() < 1e-6,
            "{} for {x:?} at {time} s",
            run.column("s.i")[row]
        );
        assert!(
            (run.column("s.t")[row] - x[1]).abs() < 1e-5,
            "{} for {x:?} at {time} s",
            run.column("s.t")[row]
        );
    }
    assert!(x[1] > 330.0, "{x:?}");
}

/// At a constant current a hot winding makes more heat than its cooling takes: the temperature rises without end.
const RUNAWAY: &str =
    r#"DcMotor(r: "2 ohm", l: "1 mH", k: "0.1 N*m/A", j: "1e-4 kg*m^2", heat_port: true, alpha: "4e-3 1/K")"#;

fn runaway(stop: &str) -> Run {
    let (compiled, problems) = compile_text(&locked(
        RUNAWAY,
        r#""held": Constant(value: "15 A"), "rate": Constant(value: "0 A/s"), "j": ControlledCurrentSource, "loss": ThermalResistance(r: "1 K/W")"#,
        r#""held.y -> j.i", "rate.y -> j.di", "j.n <-> m.p", "j.p <-> g.p", "c.h <-> loss.a", "loss.b <-> air.h""#,
        r#""i", "t""#,
        stop,
    ));
    run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
}

#[test]
fn a_thermal_runaway_is_reported_and_ends_the_run() {
    let short = runaway("40 s");
    assert!(short.error.is_none(), "{:?}", short.error);
    // C T' = r i^2 (1 + alpha (T - T_ref)) - (T - T_air) / R, with the same reference and air.
    let (heat, c) = (2.0 * 15.0 * 15.0, 15.0);
    let rate = (4e-3 * heat - 1.0) / c;
    for (t, found) in short.time.iter().zip(short.column("s.t")) {
        let expected = 293.15 + heat / (rate * c) * ((rate * t).exp() - 1.0);
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected} at {t} s");
    }
    let crossed = ((428.15 - 293.15) * rate * c / heat + 1.0).ln() / rate;
    let [(at, path, what)] = &short.events[..] else { panic!("{:?}", short.events) };
    assert!((at - crossed).abs() < 1e-6, "{at} for {crossed}");
    assert!(path == "m" && what.contains("winding exceeds its temperature limit"), "{path} {what}");
    let long = runaway("100000 s");
    let error = long.error.as_ref().map(ToString::to_string).unwrap_or_default();
    assert!(
        error.contains("`c.t`"),
        "{error} after {:?} s at {:?} K",
        long.time.last(),
        long.column("s.t").last()
    );
    assert!(long.time.last().is_some_and(|t| *t < 100.0));
}

/// Rigs in which one part alone makes heat, all of it into an insulated body: the body gains what the account books as heat.
#[test]
fn the_heat_of_a_part_is_the_heat_of_the_account() {
    let shaft = |part: &str, more: &str, connections: &str| -> (String, String) {
        (
            format!(
                r#""part": {part}, "still": RotationalReference, "j": Inertia(j: "0.2 kg*m^2", w0: "40 rad/s"), {more}"#
            ),
            connections.to_owned(),
        )
    };
    let on_a_shaft = r#""part.r <-> j.r", "part.c <-> still.r""#;
    let circuit = r#""u": AcVoltageSource(amplitude: Peak("60 V"), frequency: "50 Hz"), "l": Inductor(l: "20 mH"), "g": ElectricalReference"#;
    let in_line = r#""u.p <-> part.p", "part.n <-> l.p", "l.n <-> u.n <-> g.p""#;
    let three = r#""mains": ThreePhaseSource(voltage: "220 V", frequency: "60 Hz"), "still": RotationalReference,
        "j": Inertia(j: "0.05 kg*m^2")"#;
    let machine = r#""mains.ac <-> part.ac", "part.r <-> j.r", "part.c <-> still.r""#;
    let gear = |part: &str| {
        shaft(
            part,
            r#""load": Inertia(j: "2 kg*m^2"), "push": ConstantTorque(tau: "5 N*m")"#,
            r#""j.r <-> part.base <-> push.r", "push.c <-> still.r", "part.follower <-> load.r""#,
        )
    };
    let node = "Rotational";
    let rigs: Vec<(&str, &str, (String, String))> = vec![
        (node, "part.r", shaft(r#"RotationalDamper(d: "0.05 N*m*s/rad", heat_port: true)"#, "", on_a_shaft)),
        (node, "part.r", shaft(r#"EddyCurrentBrake(torque: "4 N*m", speed: "20 rad/s", heat_port: true)"#, "", on_a_shaft)),
        (
            node,
            "part.r",
            shaft(
                r#"RotationalFriction(breakaway: 3.0, breakaway_velocity: 0.2, coulomb: 2.0, viscous: 0.01, model: Stiction, heat_port: true)"#,
                "",
                on_a_shaft,
            ),
        ),
        (
            node,
            "part.r",
            shaft(
                r#"LuGreFriction(coulomb: 2.0, breakaway: 3.0, stribeck_velocity: 0.3, sigma0: 500.0, sigma1: 2.0, heat_port: true)"#,
                "",
                on_a_shaft,
            ),
        ),
        (
            node,
            "part.r",
            shaft(
                r#"Brake(torque: "6 N*m", heat_port: true)"#,
                r#""on": Step(time: "0.3 s", before: 0.0, after: 1.0)"#,
                r#""part.r <-> j.r", "part.c <-> still.r", "on.y -> part.engaged""#,
            ),
        ),
        (
            node,
            "part.r",
            shaft(
                r#"Clutch(torque: "6 N*m", heat_port: true)"#,
                r#""on": Step(time: "0.3 s", before: 0.0, after: 1.0), "other": Inertia(j: "0.1 kg*m^2")"#,
                r#""part.r <-> j.r", "part.c <-> other.r", "on.y -> part.normal""#,
            ),
        ),
        (node, "part.base", gear("SimpleGear(ratio: 4.0, efficiency: 0.9, heat_port: true)")),
        (node, "part.base", gear("SimpleGear(ratio: 4.0, efficiency: 0.9, loss: Stiction, heat_port: true)")),
        (
            node,
            "part.base",
            gear("LossyGear(ratio: 4.0, losses: [(0.0, 0.7, 0.55, 0.02, 0.02), (300.0, 0.85, 0.8, 0.03, 0.03)], heat_port: true)"),
        ),
        (node, "part.base", gear("ElasticGear(ratio: 4.0, k: 1e3, d: 1.0, efficiency_forward: 0.9, heat_port: true)")),
        ("Electrical", "g.p", (format!(r#""part": Diode(heat_port: true), {circuit}"#), in_line.to_owned())),
        (
            "Electrical",
            "g.p",
            (
                format!(r#""part": IdealSwitch(r_on: 0.4, g_off: 1e-5, heat_port: true), "wave": Sine(frequency: "10 Hz"), "gate": Compare(operator: Greater, constant: 0.0), {circuit}"#),
                format!(r#"{in_line}, "wave.y -> gate.u", "gate.y -> part.gate""#),
            ),
        ),
        (
            "Rotational",
            "part.r",
            (
                format!(
                    r#""part": AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2,
                        r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm", heat_port: true), {three}"#
                ),
                machine.to_owned(),
            ),
        ),
        (
            "Rotational",
            "part.r",
            (
                format!(
                    r#""part": PermanentMagnetMachine(pole_pairs: 4, r_s: "0.6 ohm", l_d: "1.4 mH", l_q: "2.8 mH", flux: "0.12 Wb",
                        heat_port: true, alpha: "4e-3 1/K"), {three}"#
                ),
                machine.to_owned(),
            ),
        ),
        (
            "Rotational",
            "part.r",
            (
                r#""part": DcMotor(r: 1.5, l: 2.5e-3, k: 0.22, j: 5e-3, damping: 1e-3, heat_port: true, alpha: 4e-3),
                    "u": VoltageSource(v: "48 V"), "g": ElectricalReference, "still": RotationalReference"#
                    .to_owned(),
                r#""u.p <-> part.p", "u.n <-> part.n <-> g.p", "part.c <-> still.r""#.to_owned(),
            ),
        ),
    ];
    for (domain, at, (blocks, connections)) in rigs {
        let run = run_text(&text(
            "1 s",
            &format!(
                r#"{}, "body": HeatCapacity(c: "30 J/K"), "account": EnergyAccount(at: {domain}, tolerance: 1e-5)"#,
                blocks.trim_end().trim_end_matches(',')
            ),
            &format!(
                r#"{connections}, "part.h <-> body.h", "account.node <-> {at}", "body.t -> s.t", "account.dissipated_energy -> s.heat""#
            ),
            r#""t", "heat""#,
        ));
        let (gained, heat) = (30.0 * (run.last("s.t") - 293.15), run.last("s.heat"));
        assert!(heat.abs() > 0.1, "{blocks}: only {heat} J of heat");
        assert!((gained / heat - 1.0).abs() < 1e-5, "{blocks}: the body has gained {gained} J of {heat} J");
    }
}

/// Winding and rotor with a port each: the sum is all heat, and sensors of heat show it at the instant.
#[test]
fn winding_and_rotor_warm_up_apart() {
    let run = run_text(&text(
        "2 s",
        r#""u": VoltageSource(v: "24 V"), "g": ElectricalReference, "still": RotationalReference,
           "m": DcMotor(r: 1.5, l: 2.5e-3, k: 0.22, j: 5e-3, damping: 2e-3, heat_port: true, rotor_heat_port: true),
           "q": HeatFlowSensor, "c": HeatCapacity(c: "30 J/K"), "c_r": HeatCapacity(c: "30 J/K"),
           "w": MotionSensor"#,
        r#""u.p <-> m.p", "u.n <-> m.n <-> g.p", "m.c <-> still.r <-> w.c", "m.r <-> w.r", "m.h <-> q.a", "q.b <-> c.h", "m.h_r <-> c_r.h",
           "m.i -> s.i", "w.w -> s.w", "q.q -> s.q", "c_r.t -> s.t_r""#,
        r#""i", "w", "q", "t_r""#,
    ));
    for row in 0..run.time.len() {
        let i = run.column("s.i")[row];
        assert!((run.column("s.q")[row] - 1.5 * i * i).abs() < 1e-9 * (1.0 + i * i));
    }
    let mut gained = 0.0;
    for row in 1..run.time.len() {
        let power = |row: usize| 2e-3 * run.column("s.w")[row].powi(2);
        gained += 0.5 * (power(row) + power(row - 1)) * (run.time[row] - run.time[row - 1]);
    }
    let warmed = 30.0 * (run.last("s.t_r") - 293.15);
    assert!((warmed / gained - 1.0).abs() < 1e-2 && gained > 10.0, "{warmed} for {gained}");
}

#[test]
fn what_is_wrong_with_a_heat_port_is_said() {
    let motor = r#"DcMotor(r: 2.0, l: 1e-3, k: 0.1, j: 1e-4, heat_port: true)"#;
    let problems = |more: &str, connections: &str| -> String {
        let (compiled, problems) = compile_text(&format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ "m": {motor}, "u": VoltageSource(v: 1.0), "g": ElectricalReference,
                "still": RotationalReference, {more} }},
                connections: ["u.p <-> m.p", "u.n <-> m.n <-> g.p", "m.c <-> still.r", {connections}])"#
        ));
        assert!(compiled.schedule.is_none(), "it compiles");
        problems
    };
    let said = problems("", "");
    assert!(said.contains("the thermal port `m.h` is not connected"), "{said}");
    let said =
        problems(r#""r": ThermalResistance(r: 1.0), "air": Ambient"#, r#""m.h <-> r.a", "r.b <-> air.h""#);
    assert!(
        said.contains("heat_without_capacity") && said.contains("connect a HeatCapacity to `m.h`"),
        "{said}"
    );
    let said = problems(r#""t": TemperatureSensor"#, r#""m.h <-> t.h""#);
    assert!(said.contains("no path") && said.contains("HeatCapacity"), "{said}");
    let (_, said) = compile_text(
        r#"Diagram(simulation: (stop_time: "1 s"), blocks: { "m": DcMotor(r: 2.0, l: 1e-3, k: 0.1, j: 1e-4, alpha: 4e-3) }, connections: [])"#,
    );
    assert!(said.contains("alpha") && said.contains("heat_port: true"), "{said}");
}
