//! `blocksim identify parameters`: what a measurement tells of the parameters of any model.

use serde_json::Value;

use crate::desk::{Answer, Desk};

/// A DC motor that is switched on.
const MOTOR: &str = r#"Diagram(
    parameters: { "k": "50 mN*m/A", "j": "2e-5 kg*m^2", "r": "1.5 ohm", "d": "1e-5 N*m*s/rad" },
    simulation: (stop_time: "0.2 s", solver: Ode45(rtol: 1e-8)),
    blocks: {
        "switch": Step(time: "10 ms", after: "24 V"), "source": ControlledVoltageSource, "ammeter": CurrentSensor,
        "motor": DcMotor(r: "r", l: "2.5 mH", k: "k", j: "j", damping: "d"), "encoder": MotionSensor,
        "ground": ElectricalReference, "housing": RotationalReference,
        "current": Scope(inputs: ["i"]), "speed": Scope(inputs: ["w"], display: "rpm"),
    },
    connections: [
        "switch.y -> source.v", "source.p <-> ammeter.p", "ammeter.n <-> motor.p", "motor.n <-> source.n <-> ground.p",
        "motor.r <-> encoder.r", "motor.c <-> encoder.c <-> housing.r", "ammeter.i -> current.i", "encoder.w -> speed.w",
    ],
)"#;

/// A lag of first order by its law; `gain` and `scale` act as one.
const LAG: &str = r#"Diagram(
    parameters: { "tau": "0.3 s", "gain": 2.0, "scale": 1.0, "unused": 1.0 },
    simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-8)),
    blocks: {
        "step": Step(time: "0 s", after: 1.0), "gain": Gain(k: "gain * scale"), "lag": LowPass(tau: "tau"),
        "scope": Scope(inputs: ["y"]), "beside": Gain(k: "unused"), "other": Scope(inputs: ["y"]),
    },
    connections: ["step.y -> gain.u, beside.u", "gain.y -> lag.u", "lag.y -> scope.y", "beside.y -> other.y"],
)"#;

fn lines(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect()
}

/// `2 (1 - exp(-t / 0.3))` with something on it that no lag explains.
fn measured(noise: f64) -> String {
    let mut text = String::from("time [s],scope.y\n");
    for k in 0..=100 {
        let t = 0.02 * f64::from(k);
        let y = 2.0 * (1.0 - (-t / 0.3_f64).exp()) + noise * (f64::from(k * k) * 0.37).sin();
        text.push_str(&format!("{t},{y}\n"));
    }
    text
}

#[test]
fn a_motor_is_found_again_from_its_run() {
    let desk = Desk::with(&[("motor.ron", MOTOR)]);
    assert_eq!(desk.call(&["run", "motor.ron", "--out", "measured", "--quiet"]).code, Some(0));
    let wrong = ["--set", "k=80 mN*m/A", "--set", "j=1e-5 kg*m^2", "--set", "r=1 ohm"];
    let mut call =
        vec!["identify", "parameters", "motor.ron", "--from", "measured", "--of", "k,j,r", "--json"];
    call.extend(wrong);
    let Answer { code, out, err } = desk.call(&call);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    let found = lines(&out);
    for (line, (name, unit, value)) in
        found.iter().zip([("k", "mN*m/A", 50.0), ("j", "kg*m^2", 2e-5), ("r", "ohm", 1.5)])
    {
        assert_eq!((line["parameter"].as_str(), line["unit"].as_str()), (Some(name), Some(unit)), "{line}");
        let off = (line["value"].as_f64().unwrap() / value - 1.0).abs();
        assert!(off < 1e-5, "{name} is off by {off}: {line}");
    }
    let all = &found[3];
    assert_eq!(all["signals"].as_array().map(Vec::len), Some(2), "{all}");
    let (before, now) =
        (all["signals"][1]["before"].as_f64().unwrap(), all["signals"][1]["now"].as_f64().unwrap());
    assert!(before > 100.0 && now < 0.01, "{all}");
    // Text says the same, and the command that it prints runs.
    call.retain(|word| *word != "--json");
    let text = desk.call(&call).out;
    let last = text.trim_end().lines().last().unwrap();
    assert!(last.starts_with("blocksim run motor.ron --set 'k=50") && last.contains("'j="), "{text}");
}

#[test]
fn a_lag_has_the_estimates_of_its_closed_form() {
    let desk = Desk::with(&[("lag.ron", LAG), ("exact.csv", &measured(0.0)), ("noisy.csv", &measured(0.05))]);
    let call = |table: &str| {
        let words = [
            "identify",
            "parameters",
            "lag.ron",
            "--from",
            table,
            "--of",
            "tau,gain",
            "--set",
            "tau=1 s",
            "--json",
        ];
        let Answer { code, out, err } = desk.call(&words);
        assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
        lines(&out)
    };
    let exact = call("exact.csv");
    for (line, value) in exact.iter().zip([0.3, 2.0]) {
        assert!((line["value"].as_f64().unwrap() - value).abs() < 1e-6 * value, "{line}");
        // Between laws and signals there is a tangent, which is one run for each parameter and step.
        assert!(line["by_differences"].is_null(), "{line}");
    }
    let noisy = call("noisy.csv");
    for (line, value) in noisy.iter().zip([0.3, 2.0]) {
        let (found, interval) = (line["value"].as_f64().unwrap(), line["interval_95"].as_f64().unwrap());
        assert!((found - value).abs() < interval && interval < 0.2 * value, "{line}");
    }
    // The least sum of squares for this table, found by a search over a grid that knows the closed form alone.
    let rows: Vec<(f64, f64)> = measured(0.05)
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').map(|(t, y)| (t.parse().unwrap(), y.parse().unwrap())).unwrap())
        .collect();
    let squares = |tau: f64, gain: f64| -> f64 {
        rows.iter().map(|(t, y)| (y - gain * (1.0 - (-t / tau).exp())).powi(2)).sum()
    };
    let (tau, gain) = (noisy[0]["value"].as_f64().unwrap(), noisy[1]["value"].as_f64().unwrap());
    let least = squares(tau, gain);
    for (i, j) in (-5..=5).flat_map(|i| (-5..=5).map(move |j| (i, j))) {
        let other = squares(tau * (1.0 + 1e-4 * f64::from(i)), gain * (1.0 + 1e-4 * f64::from(j)));
        assert!(other >= least * (1.0 - 1e-9), "{i} {j}: {other} is less than {least}");
    }
    let runs = noisy[2]["runs"].as_u64().unwrap();
    assert!(runs < 60, "{runs} runs");
}

#[test]
fn columns_of_other_names_and_units_are_mapped() {
    let rows: String = measured(0.0).lines().skip(1).map(|line| format!("{line}\n")).collect();
    let desk = Desk::with(&[("lag.ron", LAG), ("table.csv", &format!("time [s],answer\n{rows}"))]);
    let words =
        ["identify", "parameters", "lag.ron", "--from", "table.csv", "--of", "tau", "--set", "tau=0.5 s"];
    let Answer { code, err, .. } = desk.call(&words);
    assert_eq!(code, Some(2), "{err}");
    assert!(err.contains("`answer`") && err.contains("--map") && err.contains("`scope.y`"), "{err}");
    let mut words = words.to_vec();
    words.extend(["--map", "answer=scope.y"]);
    let text = desk.call(&words).out;
    assert!(text.contains("scope.y") && text.contains("0.3 "), "{text}");
}

#[test]
fn what_cannot_be_found_is_explained() {
    let desk = Desk::with(&[("lag.ron", LAG), ("m.csv", &measured(0.0))]);
    for (of, set, code, told) in [
        ("gain,scale", "tau=0.3 s", 1, "cannot separate `gain` and `scale`"),
        ("tau,unused", "tau=0.4 s", 1, "`unused` changes none of the compared signals"),
        ("tau", "gain=nosuch", 3, "unknown name `nosuch`"),
        ("tua", "gain=2", 2, "did you mean `tau`?"),
        ("tau,tau", "gain=2", 2, "`tau` is to be found twice"),
        ("simulation", "gain=2", 2, "`lag.ron` has no parameter `simulation`"),
    ] {
        let words = ["identify", "parameters", "lag.ron", "--from", "m.csv", "--of", of, "--set", set];
        let Answer { code: found, out, err } = desk.call(&words);
        assert_eq!(found, Some(code), "{of} with {set}: {out}{err}");
        assert!(err.contains(told), "{of} with {set}: {err}");
    }
    let words =
        ["identify", "parameters", "lag.ron", "--from", "lag.ron", "--of", "tau", "--map", "a=scope.y"];
    let Answer { code, err, .. } = desk.call(&words);
    assert!(code == Some(2) && err.contains("--map has no place"), "{err}");
    // Rows that the run does not reach are counted.
    let words = ["identify", "parameters", "lag.ron", "--from", "m.csv", "--of", "tau", "--until", "1 s"];
    let answer = desk.call(&words);
    assert!(answer.out.contains("50 rows of `scope.y` are not compared"), "{answer:?}");
    for (from, told) in [("none.csv", "none.csv"), ("lag.ron", "is not a measurement")] {
        let Answer { code, err, .. } =
            desk.call(&["identify", "parameters", "lag.ron", "--from", from, "--of", "tau"]);
        assert!(code != Some(0) && err.contains(told), "{from}: {code:?} {err}");
    }
    // A time constant is never negative, and the shorter it is the better it fits: what is found is said to be undetermined.
    let rising: String = (0..=100).map(|k| format!("{},{}\n", 0.02 * f64::from(k), 2.0)).collect();
    let desk = Desk::with(&[("lag.ron", LAG), ("m.csv", &format!("time [s],scope.y\n{rising}"))]);
    let words = ["identify", "parameters", "lag.ron", "--from", "m.csv", "--of", "tau"];
    let Answer { code, out, err } = desk.call(&words);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("does not determine `tau`"), "{out}");
}

/// A gain and a lag that three clean signals show, and a gain that one noisy signal shows alone.
const SENSORS: &str = r#"Diagram(
    parameters: { "gain": 2.0, "tau": "0.4 s", "b": 1.2 },
    simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-8)),
    blocks: {
        "step": Step(time: "0 s", after: 1.0), "gain": Gain(k: "gain"), "lag": LowPass(tau: "tau"), "other": Gain(k: "b"),
        "clean": Scope(inputs: ["y", "u"]), "noisy": Scope(inputs: ["z"]),
    },
    connections: ["step.y -> gain.u, other.u", "gain.y -> lag.u, clean.u", "lag.y -> clean.y", "other.y -> noisy.z"],
)"#;

#[test]
fn signals_with_noise_of_their_own_have_intervals_of_their_own() {
    const ROWS: usize = 200;
    const CASES: u64 = 12;
    let (clean, noisy) = (0.002, 0.3);
    let mut held = [0; 3];
    let (mut widths, mut errors) = ([0.0; 3], [0.0; 3]);
    // The standard errors where the noise is known, from the slopes of the closed forms.
    let mut normal = [[0.0; 2]; 2];
    for k in 1..=ROWS {
        let t = 0.01 * k as f64;
        let e = (-t / 0.4_f64).exp();
        let slopes = [[1.0 - e, -2.0 * e * t / 0.16], [1.0, 0.0]];
        for slope in slopes {
            for i in 0..2 {
                for j in 0..2 {
                    normal[i][j] += slope[i] * slope[j] / (clean * clean);
                }
            }
        }
    }
    let determinant = normal[0][0] * normal[1][1] - normal[0][1].powi(2);
    let expected = [
        (normal[1][1] / determinant).sqrt(),
        (normal[0][0] / determinant).sqrt(),
        noisy / (ROWS as f64).sqrt(),
    ];
    for seed in 0..CASES {
        let mut random = blocksim_identify::Random::new(seed);
        let mut table = String::from("time [s],clean.y,clean.u,noisy.z\n");
        for k in 1..=ROWS {
            let t = 0.01 * k as f64;
            let y = 2.0 * (1.0 - (-t / 0.4_f64).exp()) + clean * random.normal();
            let (u, z) = (2.0 + clean * random.normal(), 1.2 + noisy * random.normal());
            table.push_str(&format!("{t},{y},{u},{z}\n"));
        }
        let desk = Desk::with(&[("model.ron", SENSORS), ("m.csv", &table)]);
        let words = ["identify", "parameters", "model.ron", "--from", "m.csv", "--of", "gain,tau,b"];
        let begin = ["--set", "gain=2.5", "--set", "tau=0.3 s", "--set", "b=1.5", "--json"];
        let Answer { code, out, err } = desk.call(&[&words[..], &begin].concat());
        assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
        for (n, (line, truth)) in lines(&out).iter().zip([2.0, 0.4, 1.2]).enumerate() {
            let (value, interval) = (line["value"].as_f64().unwrap(), line["interval_95"].as_f64().unwrap());
            held[n] += u32::from((value - truth).abs() <= interval);
            widths[n] += interval / (1.96 * expected[n]) / CASES as f64;
            errors[n] += ((value - truth) / expected[n]).powi(2) / CASES as f64;
        }
    }
    for n in 0..3 {
        assert!((0.9..1.1).contains(&widths[n]), "intervals are {widths:?} of what the noise leaves");
        // Twelve squares have a mean of 1 with a standard deviation of 0.41.
        assert!(errors[n] < 2.6 && held[n] >= 10, "{errors:?}, {held:?}");
    }
}
