//! `--json` of several commands about the same thing: one name, one unit, one value.

use serde_json::Value;

use crate::desk::Desk;

/// w^2 / (s^2 + 2 z w s + w^2) with w = 10 rad/s and z = 0.5, and a step.
const SECOND: &str = r#"Diagram(
    parameters: { "height": 2.0 },
    simulation: (stop_time: "3 s", solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("0.2 ms")),
    blocks: {
        "demand": Step(time: "0 s", after: "height"),
        "plant": TransferFunction(num: [100], den: [1, 10, 100]),
        "scope": Scope(inputs: ["set", "actual"]),
    },
    connections: ["demand.y -> plant.u, scope.set", "plant.y -> scope.actual"],
)
"#;

fn data(desk: &Desk, words: &[&str]) -> Value {
    let answer = desk.call(words);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    serde_json::from_str(answer.out.lines().last().unwrap())
        .unwrap_or_else(|error| panic!("{error}: {answer:?}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn a_quantity_has_one_name_and_one_unit_wherever_it_stands() {
    let desk = Desk::with(&[("second.ron", SECOND)]);
    let run = data(&desk, &["run", "second.ron", "--json", "--out", "kept"]);
    let plot = data(&desk, &["plot", "kept", "--json"]);
    let linear = data(&desk, &["linearise", "second.ron", "--from", "demand.y", "--to", "plant.y", "--json"]);
    let metrics = "--metric=rise,overshoot,settling,iae,ise,final_error,maximum_error";
    let sweep = data(&desk, &["sweep", "second.ron", "--over", "height=2", metrics, "--json"]);
    let pair = &plot["tracking"][0];
    let step = &linear["ways"][0]["step"];
    let swept = |name: &str| {
        let all = sweep["runs"][0]["metrics"].as_array().unwrap();
        all.iter()
            .find(|metric| metric["metric"] == name)
            .unwrap_or_else(|| panic!("{name} in {sweep}"))
            .clone()
    };
    for name in ["rise", "overshoot", "settling"] {
        let found = number(&pair[name]);
        assert!((number(&step[name]) / found - 1.0).abs() < 1e-4, "{name}: {step} {pair}");
        assert!((number(&swept(name)["value"]) / found - 1.0).abs() < 1e-9, "{name}");
    }
    for name in ["iae", "ise", "final_error", "maximum_error"] {
        let found = number(&pair[name]);
        assert!((number(&swept(name)["value"]) - found).abs() <= 1e-9 * found.abs(), "{name}");
    }
    // exp(-pi z / sqrt(1 - z^2)) of the step, a share and no per cent.
    let overshoot = (-std::f64::consts::PI * 0.5 / 0.75_f64.sqrt()).exp();
    assert!((number(&pair["overshoot"]) - overshoot).abs() < 1e-5, "{pair}");
    assert_eq!((&swept("overshoot")["unit"], &swept("rise")["unit"]), (&"1".into(), &"s".into()));
    let tracking = &run["tracking"][0];
    for name in ["maximum_error", "maximum_error_at", "final_error"] {
        assert_eq!(number(&tracking[name]), number(&pair[name]), "{name}");
    }
    assert_eq!(tracking["signal"], pair["signal"]);
}

#[test]
fn all_names_of_numbers_are_in_the_manual() {
    let manual = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/data.md")).unwrap();
    let desk = Desk::with(&[("second.ron", SECOND)]);
    data(&desk, &["run", "second.ron", "--json", "--out", "kept"]);
    let plot = data(&desk, &["plot", "kept", "--json"]);
    let linear = data(&desk, &["linearise", "second.ron", "--from", "demand.y", "--to", "plant.y", "--json"]);
    for of in [&plot["tracking"][0], &linear["ways"][0]["step"]] {
        for name in of.as_object().unwrap().keys() {
            assert!(manual.contains(&format!("`{name}`")), "`{name}` is not in docs/data.md");
        }
    }
}

#[test]
fn numbers_do_not_depend_on_how_far_the_steps_of_the_solver_are_apart() {
    let overshoot = (-std::f64::consts::PI * 0.5 / 0.75_f64.sqrt()).exp();
    for solver in ["Ode23", "Ode45", "Rodas4", "RosW3"] {
        let model = SECOND.replace(
            r#"solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("0.2 ms")"#,
            &format!("solver: {solver}"),
        );
        assert_ne!(model, SECOND);
        let exact = Desk::with(&[("second.ron", SECOND)]);
        let desk = Desk::with(&[("second.ron", &model)]);
        let pair = |desk: &Desk| {
            data(desk, &["run", "second.ron", "--json", "--out", "kept"]);
            data(desk, &["plot", "kept", "--json"])["tracking"][0].clone()
        };
        let (fine, coarse) = (pair(&exact), pair(&desk));
        assert!((number(&coarse["overshoot"]) - overshoot).abs() < 3e-3, "{solver}: {coarse}");
        for name in ["rise", "settling", "iae", "ise"] {
            let (fine, coarse) = (number(&fine[name]), number(&coarse[name]));
            assert!((coarse / fine - 1.0).abs() < 1e-2, "{solver}, {name}: {coarse} instead of {fine}");
        }
    }
}

/// A light rotor behind an inverter that is integrated apart from it, with a tolerance that no division of its steps keeps.
const COUPLED: &str = r#"Diagram(
    simulation: (stop_time: "32 ms", solver: Ode45(rtol: 1e-11), output: Every("1 ms")),
    blocks: {
        "v": Constant(value: "60 V"), "f": Constant(value: "20 Hz"),
        "inverter": SwitchedInverter(
            vdc: "400 V", switching_frequency: "2 kHz", modulation: SpaceVector, integration: Separate(periods: 4),
        ),
        "machine": AsynchronousMachine(
            rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
            r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm",
        ),
        "rotor": Inertia(j: "1e-4 kg*m^2"), "encoder": MotionSensor, "frame": RotationalReference,
        "s": Scope(inputs: ["w"]),
    },
    connections: [
        "v.y -> inverter.v", "f.y -> inverter.f", "inverter.ac <-> machine.ac",
        "machine.r <-> rotor.r <-> encoder.r", "machine.c <-> encoder.c <-> frame.r", "encoder.w -> s.w",
    ],
)
"#;

#[test]
fn a_missed_tolerance_is_told_with_its_place_by_all_who_run_a_model() {
    let desk = Desk::with(&[("coupled.ron", COUPLED)]);
    let lines = |words: &[&str]| -> Vec<Value> {
        let answer = desk.call(words);
        assert_eq!(answer.code, Some(0), "{answer:?}");
        answer.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    };
    let run = lines(&["run", "coupled.ron", "--json", "--out", "kept"]);
    let sweep = [
        "sweep",
        "coupled.ron",
        "--over",
        "v.value=50..60/2",
        "--metric",
        "final:w",
        "--json",
        "--keep",
        "all",
    ];
    let sweep = lines(&sweep);
    for (told, last) in [(&run, "done"), (&sweep, "sweep")] {
        let warning = told.iter().find(|line| line["code"] == "coupling_error").expect("a warning");
        assert_eq!(warning["severity"], "warning");
        assert_eq!(told.last().expect("a line")["type"], last);
    }
    let warning = run.iter().find(|line| line["code"] == "coupling_error").expect("a warning");
    assert_eq!(
        (&warning["labels"][0]["line"], &warning["labels"][0]["text"]),
        (&5.into(), &"this is `inverter`".into())
    );
    for log in ["kept/log.txt", "all/1/log.txt", "all/2/log.txt"] {
        assert!(desk.read(log).contains("warning[coupling_error]"), "{log}");
    }
    assert!(desk.call(&["run", "coupled.ron", "--quiet"]).err.contains("warning[coupling_error]"));
}
