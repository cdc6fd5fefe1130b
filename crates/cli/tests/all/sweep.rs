//! `blocksim sweep` as users call it.

use std::process::Output;

use crate::support::{arguments, commands_of, program, root};
use serde_json::Value;

/// x' = (u - x) / tau: the answer to a step is 1 - exp(-t / tau).
const LAG: &str = r#"Diagram(
    parameters: { "tau": "0.1 s" },
    simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-9), output: Every("0.5 ms")),
    blocks: {
        "demand": Step(time: "0.5 s", after: 2.0),
        "lag": LowPass(tau: "tau"),
        "scope": Scope(inputs: ["set", "actual"]),
    },
    connections: ["demand.y -> lag.u, scope.set", "lag.y -> scope.actual"],
)
"#;

/// A folder with a model that is removed at the end.
struct Desk(std::path::PathBuf);

impl Desk {
    fn new(name: &str) -> Desk {
        let path = std::env::temp_dir().join(format!("blocksim-sweep-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        std::fs::write(path.join("lag.ron"), LAG).expect("a model");
        Desk(path)
    }

    fn sweep(&self, words: &[&str]) -> Output {
        sweep(&self.0, words)
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn sweep(folder: &std::path::Path, words: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(folder).env("NO_COLOR", "1").env_remove("COLUMNS").arg("sweep").args(words);
    command.output().expect("the program runs")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn numbers_of_a_lag_are_those_of_the_formula_whatever_the_number_of_jobs() {
    let desk = Desk::new("formula");
    let metrics = "--metric=rise,settling,iae,max:scope.actual,rms:scope.set";
    let words = ["lag.ron", "--over", "tau=50 ms..100 ms/3", metrics, "--json"];
    let output = desk.sweep(&words);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let one = desk.sweep(&[&words[..], &["--jobs", "1"]].concat());
    assert_eq!(output.stdout, one.stdout, "runs do not disturb each other");
    let sweep: Value = serde_json::from_slice(&output.stdout).expect("data");
    let runs = sweep["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 3);
    for (run, tau) in runs.iter().zip([0.05, 0.075, 0.1]) {
        assert_eq!(run["set"]["tau"], format!("{} ms", 1e3 * tau));
        let number = |n: usize| run["metrics"][n]["value"].as_f64().expect("a number");
        // 10 % at tau ln(10/9), 90 % at tau ln 10; 2 % are left at tau ln 50; rows are 0.5 ms apart.
        assert!((number(0) - tau * 9.0_f64.ln()).abs() < 1e-5, "{run}");
        assert!((number(1) - tau * 50.0_f64.ln()).abs() < 1e-5, "{run}");
        let left = (-1.5 / tau).exp();
        assert!((number(2) - 2.0 * tau * (1.0 - left)).abs() < 1e-5, "{run}");
        assert!((number(3) - 2.0 * (1.0 - left)).abs() < 1e-8, "{run}");
        assert!((number(4) - (4.0 * 1.5 / 2.0_f64).sqrt()).abs() < 1e-12, "{run}");
    }
}

#[test]
fn a_value_that_the_model_refuses_leaves_the_other_runs_alone() {
    let desk = Desk::new("refused");
    let output = desk.sweep(&["lag.ron", "--over", "tau=0.1 s,-0.1 s,0.2 s", "--out", "table.csv"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("1 of 3 runs have no numbers"), "{}", said(&output));
    let table = std::fs::read_to_string(desk.0.join("table.csv")).expect("the table");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 4);
    assert!(lines[0].starts_with("tau,maximum error,") && lines[0].ends_with(",failed"), "{table}");
    assert!(lines[2].starts_with("-0.1 s,,,,,,"), "{table}");
    assert!(lines[1].ends_with(',') && lines[3].ends_with(','), "{table}");

    let again = desk.sweep(&["lag.ron", "--over", "tau=0.1 s", "--out", "table.csv"]);
    assert_eq!(again.status.code(), Some(4));
    assert!(said(&again).contains("already exists"), "{}", said(&again));
    assert_eq!(std::fs::read_to_string(desk.0.join("table.csv")).expect("the table"), table);
    let replaced = desk.sweep(&["lag.ron", "--over", "tau=0.1 s", "--out", "table.csv", "--yes"]);
    assert_eq!(replaced.status.code(), Some(0), "{}", said(&replaced));
    // The first of them is no other than the rest; where all are refused, it is the model.
    let first = desk.sweep(&["lag.ron", "--over", "tau=-0.1 s,0.1 s", "--out", "first.csv"]);
    assert_eq!(first.status.code(), Some(1), "{}", said(&first));
    let table = std::fs::read_to_string(desk.0.join("first.csv")).expect("the table");
    assert!(table.lines().nth(1).is_some_and(|line| line.starts_with("-0.1 s,,,,,,")), "{table}");
    let none = desk.sweep(&["lag.ron", "--over", "tau=-0.1 s,-0.2 s"]);
    assert!(none.status.code() == Some(3) && said(&none).contains("nothing was run"), "{}", said(&none));
}

#[test]
fn a_variant_without_the_signal_does_not_cost_the_numbers_of_the_others() {
    let desk = Desk::new("variants");
    let part = |inside: &str| {
        format!(
            "Diagram(inputs: {{ \"u\": () }}, blocks: {{ \"lag\": LowPass(tau: 0.1){inside} }}, \
             connections: [\"in.u -> lag.u\"])"
        )
    };
    let seen =
        part(", \"seen\": Scope(inputs: [\"y\"])").replace("lag.u\"]", "lag.u\", \"lag.y -> seen.y\"]");
    std::fs::write(desk.0.join("a.ron"), seen).expect("a part");
    std::fs::write(desk.0.join("b.ron"), part("")).expect("a part");
    let top = r#"Diagram(
        parameters: { "kind": Choice(default: "a", of: ["a", "b"]) },
        simulation: (stop_time: "1 s"),
        blocks: {
            "one": Constant(value: 1.0),
            "part": Variant(choice: "kind", of: {
                "a": Subsystem(file: "a.ron"), "b": Subsystem(file: "b.ron"),
            }),
            "scope": Scope(inputs: ["u"]),
        },
        connections: ["one.y -> part.u, scope.u"],
    )"#;
    std::fs::write(desk.0.join("top.ron"), top).expect("a model");
    let output = desk.sweep(&["top.ron", "--over", "kind=a,b", "--metric", "final:seen"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].contains("1.000"), "{table}");
    assert!(lines[2].ends_with("no recorded signal fits `seen` of `final:seen`"), "{table}");
}

#[test]
fn mistakes_are_told_before_anything_is_run() {
    let desk = Desk::new("mistakes");
    for (words, code, expected) in [
        (&["lag.ron", "--over", "tua=1 s,2 s"][..], 3, "did you mean `tau`?"),
        (&["lag.ron", "--over", "tau=1 s..2 s"], 2, "write from..to/n"),
        (&["lag.ron", "--over", "tau=1 s", "--over", "tau=2 s"], 2, "`tau` is varied twice"),
        (
            &["lag.ron", "--over", "tau=1 s", "--metric", "peak:lag"],
            2,
            "recorded are scope.set, scope.actual",
        ),
        (&["lag.ron", "--over", "tau=1 s", "--metric", "peak"], 2, "peak:SIGNAL"),
        (&["lag.ron", "--over", "tau=1 s", "--solver", "ode4"], 2, "--step"),
        (&["log.ron", "--over", "tau=1 s"], 4, "did you mean `lag.ron`?"),
        (&["lag.ron"], 2, "--over"),
        (&["lag.ron", "--over", "tau=1..2/100000", "--over", "demand.after=1..2/100000"], 2, "1000000 runs"),
    ] {
        let output = desk.sweep(words);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(expected), "{words:?}: {}", said(&output));
        assert!(output.stdout.is_empty(), "{words:?}");
    }
}

#[test]
fn the_pages_show_what_the_program_says() {
    for (page, least) in [("sweep.md", 3), ("control.md", 1)] {
        let shown = commands_of(page);
        assert!(shown.len() >= least, "{page}: {} commands with answers", shown.len());
        for (command, answer) in shown {
            let words = arguments(&command);
            assert_eq!(words[..2], ["blocksim", "sweep"], "{command}");
            let words: Vec<&str> = words[2..].iter().map(String::as_str).collect();
            let output = sweep(&root(), &words);
            assert_eq!(String::from_utf8_lossy(&output.stdout), answer, "{command}: {}", said(&output));
        }
    }
}

#[test]
fn runs_that_are_kept_are_ordinary_runs_with_the_same_numbers() {
    let desk = Desk::new("kept");
    let words = ["lag.ron", "--over", "tau=0.1 s,-0.1 s,0.2 s", "--json"];
    let plain: Value = serde_json::from_slice(&desk.sweep(&words).stdout).expect("data");
    let output = desk.sweep(&[&words[..], &["--keep", "all/runs"]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let kept: Value = serde_json::from_slice(&output.stdout).expect("data");
    for n in 0..3 {
        assert_eq!(plain["runs"][n]["metrics"], kept["runs"][n]["metrics"]);
        assert_eq!(kept["runs"][n]["run"], (n + 1).to_string());
    }
    let mut names: Vec<String> = std::fs::read_dir(desk.0.join("all/runs"))
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    assert_eq!(names, ["1", "3"], "the model refuses the second value");
    // What is kept is bit for bit what `blocksim run` records.
    let call = |words: &[&str]| {
        let mut command = program();
        command.current_dir(&desk.0).env("NO_COLOR", "1").args(words).output().expect("the program runs")
    };
    assert!(call(&["run", "lag.ron", "--set", "tau=0.2 s", "--out", "again", "--quiet"]).status.success());
    for file in ["signals.rec", "signals.csv", "events.csv", "model.json"] {
        let bytes = |run: &str| std::fs::read(desk.0.join(run).join(file)).expect("a file");
        assert_eq!(bytes("all/runs/3"), bytes("again"), "{file}");
    }
    let listed = String::from_utf8(call(&["runs", "all/runs"]).stdout).expect("text");
    assert!(listed.contains("lag.ron tau=0.2 s") && listed.contains("complete"), "{listed}");
    // A folder with anything in it is left alone.
    let again = desk.sweep(&[&words[..], &["--keep", "all/runs"]].concat());
    assert_eq!(again.status.code(), Some(4));
    let told = String::from_utf8(again.stdout).expect("text");
    assert!(told.contains("there is something in it") && told.contains("\"exit\":4"), "{told}");
}

#[test]
fn random_runs_are_the_same_for_the_same_seed() {
    let desk = Desk::new("random");
    let random = |seed: &str| {
        let words = [
            "lag.ron",
            "--over",
            "tau=50 ms..100 ms",
            "--random",
            "20",
            "--seed",
            seed,
            "--metric",
            "rise",
            "--json",
        ];
        let output = desk.sweep(&words);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        serde_json::from_slice::<Value>(&output.stdout).expect("data")
    };
    let first = random("1");
    assert_eq!(first, random("1"));
    assert_ne!(first, random("2"));
    let runs = first["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 20);
    for run in runs {
        let tau = run["set"]["tau"].as_str().and_then(|text| text.strip_suffix(" ms")).expect("in ms");
        let tau: f64 = tau.parse::<f64>().expect("a number") * 1e-3;
        let rise = run["metrics"][0]["value"].as_f64().expect("a number");
        assert!((0.05..=0.1).contains(&tau) && (rise - tau * 9.0_f64.ln()).abs() < 1e-5, "{run}");
    }
    let table = desk.sweep(&["lag.ron", "--over", "tau=50 ms..100 ms", "--random", "20", "--metric", "rise"]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    assert!(table.contains("median") && table.contains("rise [s]"), "{table}");
}

#[test]
fn the_derivatives_of_a_lag_by_its_time_constant_are_those_of_the_formula() {
    let desk = Desk::new("sensitivity");
    let words = ["lag.ron", "--sensitivity", "tau", "--of", "actual", "--out", "s.csv", "--svg", "s.svg"];
    let output = desk.sweep(&[&words[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found: Value = serde_json::from_slice(&output.stdout).expect("data");
    let one = &found["parameters"][0];
    assert_eq!(
        (&one["parameter"], &one["value"], &one["by"]),
        (&"tau".into(), &0.1.into(), &"tangent".into())
    );
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().expect("numbers").iter().filter_map(Value::as_f64).collect()
    };
    let (times, values) = (numbers(&one["time"]), numbers(&one["signals"][0]["derivative"]));
    assert_eq!((times.len(), values.len()), (1001, 1001));
    for (t, value) in times.iter().zip(&values) {
        let since = (t - 0.5).max(0.0);
        let exact = -2.0 * since / 0.01 * (-since / 0.1).exp();
        assert!((value - exact).abs() < 1e-6, "{t} s: {value} is not {exact}");
    }
    let table = std::fs::read_to_string(desk.0.join("s.csv")).expect("a table");
    assert!(
        table.starts_with("time [s],d scope.actual / d tau [1/s],error of d scope.actual / d tau [1/s]\n"),
        "{table:.200}"
    );
    assert_eq!(table.lines().count(), 1002);
    assert!(
        std::fs::read_to_string(desk.0.join("s.svg")).expect("a drawing").contains("scope.actual for 1 %")
    );
    // For a person; at another value, in the unit in which it is written.
    let shown = desk.sweep(&["lag.ron", "--sensitivity", "tau", "--of", "actual", "--set", "tau=200 ms"]);
    let text = String::from_utf8_lossy(&shown.stdout);
    assert_eq!(shown.status.code(), Some(0), "{}", said(&shown));
    // -2/(T e) = -3.679 1/s at T behind the step.
    assert!(
        text.contains("-0.003679") && text.contains("1/ms") && text.contains("`tau`: by the tangent"),
        "{text}"
    );
}

#[test]
fn parameters_without_a_derivative_are_refused() {
    let desk = Desk::new("no-derivative");
    for (words, part) in [
        (&["lag.ron", "--sensitivity", "taw"][..], "no parameter `taw`"),
        (&["lag.ron", "--sensitivity", "tau", "--of", "nothing"][..], "no recorded signal fits `nothing`"),
        (&["lag.ron", "--sensitivity", "scope.inputs"][..], "there is no derivative by that"),
        (&["lag.ron", "--sensitivity", "lag"][..], "holds several parameters"),
        (&["lag.ron", "--sensitivity", "tau", "--over", "tau=1"][..], "cannot be used with"),
        (&["lag.ron", "--svg", "a.svg", "--over", "tau=1"][..], "--sensitivity"),
    ] {
        let output = desk.sweep(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", said(&output));
        assert!(said(&output).contains(part), "{words:?}: {}", said(&output));
    }
}

/// Three pairs, of which one is called otherwise and two are elements of vectors: the error of each is `size exp(-t / tau)` behind the
/// step.
const PAIRS: &str = r#"Diagram(
    parameters: { "k": 1.0 },
    simulation: (stop_time: "2 s", solver: Ode45(rtol: 1e-9), output: Every("0.5 ms")),
    blocks: {
        "demand": Step(time: "0.5 s"),
        "sizes": Gain(k: ["k", 2.0]),
        "lag": LowPass(tau: "0.1 s"),
        "slow": LowPass(tau: "0.2 s"),
        "a": Scope(inputs: ["set", "actual"]),
        "b": Scope(inputs: ["other", "q_ref", "q"]),
    },
    connections: [
        "demand.y -> sizes.u, slow.u, b.q_ref, b.other",
        "sizes.y -> lag.u, a.set", "lag.y -> a.actual", "slow.y -> b.q",
    ],
)
"#;

#[test]
fn every_pair_is_measured_whatever_its_names_and_whether_runs_are_kept() {
    let desk = Desk::new("pairs");
    std::fs::write(desk.0.join("pairs.ron"), PAIRS).expect("a model");
    let metrics = |words: &[&str]| -> Value {
        let output = desk.sweep(&[&["pairs.ron", "--over", "k=1,3", "--json"], words].concat());
        assert_eq!(output.status.code(), Some(0), "{words:?}: {}", said(&output));
        serde_json::from_slice::<Value>(&output.stdout).expect("data")["runs"].clone()
    };
    let of_pairs = metrics(&["--metric", "maximum_error,iae"]);
    assert_eq!(of_pairs.as_array().map(Vec::len), Some(2));
    for (run, k) in of_pairs.as_array().expect("runs").iter().zip([1.0, 3.0]) {
        let found: Vec<(&str, &str, f64)> = run["metrics"]
            .as_array()
            .expect("metrics")
            .iter()
            .map(|m| {
                let text = |name: &str| m[name].as_str().expect("a text");
                (text("metric"), text("signal"), m["value"].as_f64().expect("a number"))
            })
            .collect();
        let area = |size: f64, tau: f64| size * tau * (1.0 - (-1.5 / tau).exp());
        let wanted = [
            ("maximum_error", "a.actual[0]", k),
            ("maximum_error", "a.actual[1]", 2.0),
            ("maximum_error", "b", 1.0),
            ("iae", "a.actual[0]", area(k, 0.1)),
            ("iae", "a.actual[1]", area(2.0, 0.1)),
            ("iae", "b", area(1.0, 0.2)),
        ];
        assert_eq!(found.len(), wanted.len(), "{run}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert_eq!((found.0, found.1), (wanted.0, wanted.1), "{run}");
            assert!((found.2 - wanted.2).abs() < 1e-5, "{found:?}: {wanted:?}");
        }
    }
    let one = metrics(&["--metric", "iae:b"]);
    assert_eq!(one[0]["metrics"][0], of_pairs[0]["metrics"][5]);
    let plain = metrics(&[]);
    let kept = metrics(&["--keep", "kept"]);
    for n in 0..2 {
        assert_eq!(plain[n]["metrics"], kept[n]["metrics"], "what is kept changes no numbers");
        let largest = of_pairs[n]["metrics"].as_array().expect("metrics")[..3].to_vec();
        assert_eq!(plain[n]["metrics"].as_array(), Some(&largest));
    }
    let table = desk.sweep(&["pairs.ron", "--over", "k=1,3"]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    for heading in ["maximum error a [0]", "maximum error a [1]", "maximum error b"] {
        assert!(table.contains(heading), "{table}");
    }
}
