//! `blocksim params list`, `get` and `set` as users call them.

use crate::desk::Desk;
use crate::support::{arguments, commands_of, root};

const MODEL: &str = r#"// A lag.
Diagram(
    parameters: {
        "gain": 2.0, // without unit
        "lag": "250 ms",
        "half": "lag / 2",
        "drive": Choice(default: "dc", of: ["asm", "dc"]),
        "set": File("set.ron"),
    },
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Step(time: "0.1 s", after: 1.0),
        "one": Subsystem(file: "part.ron", with: { "tau": "lag" }),
        "two": Subsystem(file: "part.ron"),
        "pid": Pid(kp: "gain", upper: 5.0), /* behind */
        "clock": Clock,
        "scope": Scope(inputs: ["set", "actual"], label: "both"),
        "level": Constant(value: "half * set.mass * set.ratios[0]"),
        "choice": Variant(choice: "drive", of: { "asm": Clock, "dc": Clock }),
    },
    connections: [
        "demand.y -> one.u, scope.set",
        "one.y -> two.u",
        "two.y -> pid.e",
        "pid.u -> scope.actual",
    ],
)
"#;
const PART: &str = r#"Diagram(
    parameters: { "tau": "1 s" },
    inputs: { "u": () },
    outputs: { "y": "lag.y" },
    blocks: { "lag": LowPass(tau: "tau", y0: 0.0) },
    connections: ["in.u -> lag.u"],
)
"#;
const SET: &str =
    "// a set\n(\n    mass: (value: \"4 kg\", source: \"scales\"), // weighed\n    ratios: [1, 2.5],\n)\n";

fn desk() -> Desk {
    Desk::with(&[("model.ron", MODEL), ("part.ron", PART), ("set.ron", SET)])
}

#[test]
fn a_value_is_told_with_its_unit_and_where_it_is_written() {
    let desk = desk();
    let get = |target: &str| {
        let answer = desk.call(&["params", "get", "model.ron", target]);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        answer.out.split_whitespace().map(str::to_owned).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(get("lag"), "lag 250 ms model.ron:5:16");
    assert_eq!(get("half"), "half 125 ms model.ron:6:17 lag / 2");
    assert_eq!(get("drive"), "drive dc model.ron:7:34");
    assert_eq!(get("set.mass"), "set.mass 4 kg set.ron:3:19");
    assert_eq!(get("set.ratios[1]"), "set.ratios[1] 2.5 set.ron:4:17");
    assert_eq!(get("one.tau"), "one.tau 250 ms model.ron:13:59 lag");
    assert_eq!(get("two.tau"), "two.tau 1 s default, part.ron:2:26");
    assert_eq!(get("one/lag.y0"), "one/lag.y0 0.0 part.ron:5:46");
    assert_eq!(get("pid.upper"), "pid.upper 5.0 model.ron:15:39");
    assert!(get("pid.ki").ends_with("default of Pid"), "{}", get("pid.ki"));
    assert!(get("pid").starts_with("parameter value unit from"), "a block is all that it holds");
    let json = desk.call(&["params", "get", "model.ron", "half", "--json"]);
    let half: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!((&half["value"], &half["unit"], &half["line"]), (&0.125.into(), &"s".into(), &6.into()));
}

#[test]
fn the_list_can_be_narrowed_and_widened() {
    let desk = desk();
    let names = |arguments: &[&str]| -> Vec<String> {
        let answer = desk.call(&[&["params", "list", "model.ron"], arguments].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        let lines = answer.out.lines().skip(1).filter(|line| !line.is_empty());
        lines.map(|line| line.split_whitespace().next().expect("a name").to_owned()).collect()
    };
    assert_eq!(names(&["set."]), ["set.mass", "set.ratios"]);
    assert_eq!(names(&["lag"]), ["lag", "one/lag.tau", "one/lag.y0", "two/lag.tau", "two/lag.y0"]);
    assert!(!names(&[]).contains(&"pid.ki".to_owned()) && names(&["--all"]).contains(&"pid.ki".to_owned()));
    assert_eq!(desk.call(&["params", "list", "model.ron", "zzz"]).code, Some(2));
    assert_eq!(desk.call(&["params", "list", "set.ron"]).out.lines().count(), 3);
}

#[test]
fn one_value_is_replaced_in_the_text_and_nothing_else() {
    for (target, value, file, old, new) in [
        ("lag", "300", "model.ron", "\"lag\": \"250 ms\"", "\"lag\": \"300 ms\""),
        ("half", "20", "model.ron", "\"half\": \"lag / 2\"", "\"half\": \"20 ms\""),
        ("set.mass", "5", "set.ron", "\"4 kg\"", "\"5 kg\""),
        ("lag", "300 ms", "model.ron", "\"lag\": \"250 ms\"", "\"lag\": \"300 ms\""),
        ("gain", "lag / 1 s", "model.ron", "\"gain\": 2.0,", "\"gain\": \"lag / 1 s\","),
        ("gain", "-1", "model.ron", "\"gain\": 2.0,", "\"gain\": -1,"),
        ("drive", "asm", "model.ron", "default: \"dc\"", "default: \"asm\""),
        ("set.mass", "5 kg", "set.ron", "\"4 kg\"", "\"5 kg\""),
        ("set.ratios[0]", "7", "set.ron", "[1, 2.5]", "[7, 2.5]"),
        ("pid.ki", "3", "model.ron", "upper: 5.0)", "upper: 5.0, ki: 3)"),
        ("pid.form", "Ideal", "model.ron", "upper: 5.0)", "upper: 5.0, form: Ideal)"),
        ("one.tau", "1 s", "model.ron", "{ \"tau\": \"lag\" }", "{ \"tau\": \"1 s\" }"),
        (
            "two.tau",
            "2 s",
            "model.ron",
            "(file: \"part.ron\"),",
            "(file: \"part.ron\", with: { \"tau\": \"2 s\" }),",
        ),
        (
            "scope.display",
            "deg",
            "model.ron",
            "[\"set\", \"actual\"],",
            "[\"set\", \"actual\"], display: \"deg\",",
        ),
    ] {
        let desk = desk();
        let before = desk.read(file);
        assert_eq!(before.matches(old).count(), 1, "{old}");
        let shown = desk.call(&["params", "set", "model.ron", target, value, "--dry-run"]);
        assert_eq!((shown.code, desk.read(file)), (Some(0), before.clone()), "{}", shown.text());
        let answer = desk.call(&["params", "set", "model.ron", target, value]);
        assert_eq!(answer.code, Some(0), "{target}: {}", answer.text());
        assert_eq!(desk.read(file), before.replace(old, new), "{target}");
        assert!(shown.out == answer.out && answer.out.contains("\n+"), "{}", answer.text());
        assert!(answer.err.starts_with(&format!("{file}: `{target}` was ")), "{}", answer.err);
    }
}

#[test]
fn the_model_does_the_same_as_with_set() {
    let changed = desk();
    changed.call(&["params", "set", "model.ron", "pid.kp", "7"]);
    changed.call(&["params", "set", "model.ron", "two.tau", "2 s"]);
    let set = desk();
    let arguments = ["run", "model.ron", "--no-plot", "--out", "run"];
    assert_eq!(changed.call(&arguments).code, Some(0));
    let with_set = set.call(&[&arguments[..], &["--set", "pid.kp=7", "--set", "two.tau=2 s"]].concat());
    assert_eq!(with_set.code, Some(0), "{}", with_set.text());
    assert_eq!(changed.read("run/signals.csv"), set.read("run/signals.csv"));
}

#[test]
fn what_cannot_be_set_is_refused_and_nothing_is_written() {
    let desk = desk();
    for (target, value, code, said) in [
        ("lga", "3 s", 2, "did you mean `lag`?"),
        ("pid", "3", 2, "`pid` holds "),
        ("one/lag.y0", "1", 2, "2 parts of the model are made of `part.ron`"),
        ("lag", "3 m", 2, "write a value in ms or a unit of the same kind"),
        ("pid.form", "Idael", 3, "did you mean `Ideal`?"),
        ("gain", "1,05", 3, "decimal comma?"),
        ("drive", "ac", 3, "`ac` is not one of"),
    ] {
        let answer = desk.call(&["params", "set", "model.ron", target, value]);
        assert_eq!(answer.code, Some(code), "{target}={value}: {}", answer.text());
        assert!(answer.err.contains(said), "{target}={value}: {}", answer.text());
    }
    let texts = ["model.ron", "part.ron", "set.ron"].map(|name| desk.read(name));
    assert_eq!(texts, [MODEL, PART, SET].map(str::to_owned));
    assert_eq!(desk.call(&["params", "set", "model.ron", "one/lag.y0", "1", "--all"]).code, Some(0));
    assert!(desk.read("part.ron").contains("y0: 1)"));
    assert_eq!(desk.call(&["params", "get", "gone.ron", "a"]).code, Some(4));
}

#[test]
fn numbers_of_a_set_are_changed_without_a_model() {
    let desk = desk();
    assert_eq!(desk.call(&["params", "set", "set.ron", "mass", "5 kg"]).code, Some(0));
    assert_eq!(desk.read("set.ron"), SET.replace("4 kg", "5 kg"));
    let again = desk.call(&["params", "set", "set.ron", "mass", "5 kg"]);
    assert!(again.code == Some(0) && again.out.contains("already"), "{}", again.text());
}

#[test]
fn the_page_shows_what_the_program_does() {
    let shown = commands_of("text.md");
    let mut seen = 0;
    for (line, answer) in shown.iter().filter(|(line, _)| line.starts_with("blocksim params")) {
        let desk = Desk::with(&[]);
        let words = arguments(line);
        let output = desk
            .command(&words[1..].iter().map(String::as_str).collect::<Vec<_>>())
            .current_dir(root())
            .output();
        let told = crate::desk::Answer::from(output.expect("the program runs"));
        assert_eq!(told.out + &told.err, *answer, "{line}");
        seen += 1;
    }
    assert_eq!(seen, 2);
}

#[test]
fn every_command_takes_a_bare_number_in_the_written_unit_and_says_so() {
    let desk = desk();
    let run = |set: &str, out: &str| {
        let answer = desk.call(&["run", "model.ron", "--no-plot", "--out", out, "--set", set]);
        assert_eq!(answer.code, Some(0), "{set}: {}", answer.text());
        let told = answer.text();
        (told, desk.read(&format!("{out}/signals.csv")), desk.read(&format!("{out}/manifest.json")))
    };
    let (told, bare, manifest) = run("lag=300", "bare");
    let (_, full, _) = run("lag=300 ms", "full");
    assert_eq!(bare, full);
    assert!(told.contains("lag = 300 ms") && manifest.contains("\"300 ms\""), "{told}{manifest}");
    // A parameter of a block, of a subsystem, of one with a default, and one of which nothing is written.
    for (set, understood, same) in [
        ("demand.time=0.2", "demand.time = 0.2 s", "demand.time=200 ms"),
        ("one.tau=300", "one.tau = 300 ms", "one.tau=0.3 s"),
        ("two.tau=2", "two.tau = 2 s", "two.tau=2 s"),
        ("one/lag.tau=200", "one/lag.tau = 200 ms", "one/lag.tau=0.2 s"),
        ("two/lag.tau=2", "two/lag.tau = 2 s", "two/lag.tau=2 s"),
        ("pid.kp=3", "pid.kp = 3", "pid.kp=3"),
    ] {
        let (told, bare, _) = run(set, &format!("bare {set}"));
        assert!(told.contains(understood), "{set}: {told}");
        assert_eq!(bare, run(same, &format!("full {set}")).1, "{set}");
    }
    let swept = desk.call(&["sweep", "model.ron", "--over", "lag=200..300/2"]);
    assert_eq!(swept.code, Some(0), "{}", swept.text());
    assert!(swept.err.contains("set lag = 200 ms"), "{}", swept.text());
    let full = desk.call(&["sweep", "model.ron", "--over", "lag=200 ms..300 ms/2"]);
    // The tables differ in their widths; the best runs stand below them.
    let numbers = |out: &str| {
        let lines = out.lines().filter(|line| line.starts_with("lowest")).map(|line| line.replace(" ms", ""));
        lines.collect::<Vec<_>>()
    };
    assert_eq!(numbers(&swept.out).len(), 2, "{}", swept.out);
    assert_eq!(numbers(&swept.out), numbers(&full.out));
    let checked = desk.call(&["check", "model.ron", "--set", "lag=300"]);
    assert!(checked.code == Some(0) && checked.err.contains("set lag = 300 ms"), "{}", checked.text());
    let linear = ["linearise", "model.ron", "--from", "demand.y", "--to", "one/lag.y", "--no-plot", "--set"];
    let told = desk.call(&[&linear[..], &["lag=300"]].concat());
    let full = desk.call(&[&linear[..], &["lag=300 ms"]].concat());
    assert_eq!((told.code, &told.out), (Some(0), &full.out), "{}", told.text());
    assert!(told.err.contains("set lag = 300 ms"), "{}", told.text());
    for set in ["lag=3 m", "half=3 m", "one.tau=3 m", "demand.time=3 m"] {
        let refused = desk.call(&["check", "model.ron", "--set", set]);
        assert_eq!(refused.code, Some(3), "{set}: {}", refused.text());
        assert!(refused.text().contains("unit_mismatch"), "{set}: {}", refused.text());
    }
}

/// A parameter and a block of one name, both with a member `k`.
const ALIKE: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    parameters: { "g": (k: "2 V") },
    blocks: {
        "c": Constant(value: 1),
        "g": Gain(k: "8 V"),
        "h": Gain(k: "g.k"),
        "s": Scope(inputs: ["block", "parameter"]),
    },
    connections: ["c.y -> g.u, h.u", "g.y -> s.block", "h.y -> s.parameter"],
)
"#;

#[test]
fn a_parameter_comes_before_a_block_of_its_name_and_leaves_it_alone() {
    let desk = Desk::with(&[("alike.ron", ALIKE)]);
    let last = |set: &str, out: &str| {
        let answer = desk.call(&["run", "alike.ron", "--set", set, "--out", out, "--quiet"]);
        assert_eq!(answer.code, Some(0), "{}", answer.text());
        desk.read(&format!("{out}/signals.csv")).lines().last().map(str::to_owned)
    };
    assert_eq!(last("g.k=3", "member").as_deref(), Some("1,8,3"));
    // The parameter has no such member, so the block is meant.
    assert_eq!(last("g.multiplication=UTimesK", "block").as_deref(), Some("1,8,2"));
}

#[test]
fn a_value_in_another_unit_is_one_error() {
    let desk = Desk::with(&[("alike.ron", ALIKE)]);
    let answer = desk.call(&["check", "alike.ron", "--set", "g.k=3 s", "--output-format", "short"]);
    assert_eq!(answer.code, Some(3));
    assert_eq!(answer.text().matches("error[").count(), 1, "{}", answer.text());
    assert!(answer.text().contains("`g.k` is written in V, but `3 s` is in s"), "{}", answer.text());
    let answer = desk.call(&["check", "alike.ron", "--set", "c.value=3 s", "--output-format", "short"]);
    assert_eq!(answer.text().matches("error[").count(), 0, "a bare number takes any unit: {}", answer.text());
}
