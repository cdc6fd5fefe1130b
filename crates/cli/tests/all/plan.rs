//! `blocksim plan` as users call it.

use std::path::PathBuf;

use crate::support::{arguments, commands_of, program, root};

/// Exit code, standard output and standard error.
fn plan(arguments: &[&str]) -> (i32, String, String) {
    let mut command = program();
    command.current_dir(root()).arg("plan").args(arguments).env_remove("CLICOLOR_FORCE");
    let output = command.output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.code().unwrap(), out, err)
}

/// A file that goes away.
struct Fresh(PathBuf);

impl Fresh {
    fn named(name: &str) -> Fresh {
        let path = std::env::temp_dir().join(format!("blocksim-plan-{}-{name}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        Fresh(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for Fresh {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

const TARGET: &str = "60 deg, 30 deg, -20 deg, 45 deg, 60 deg, 90 deg";

#[test]
fn a_joint_move_tells_duration_and_margins() {
    let (code, out, err) = plan(&["joint", "--to", TARGET]);
    assert_eq!((code, err.as_str()), (0, ""));
    // T_end of the demo move: 0.36735 s + 0.85714 s.
    assert!(out.starts_with("move       1.22449 s"), "{out}");
    assert!(out.contains("   1        0.00      60.00           120.00    40 %          83 %"), "{out}");
}

#[test]
fn the_fastest_way_keeps_the_limits_that_it_is_checked_against() {
    // Each was above the acceleration of axis 4 by 2e-6 to 1e-5 between the places at which the planner had looked.
    for (from, to, velocity, acceleration) in [
        ("1391,310,1121", "981,14,1105", "1000", "100"),
        ("1316,-321,1242", "1259,-415,1201", "200", "20"),
        ("1176,-28,1227", "1359,468,1200", "2500", "20"),
        ("1067,-157,1268", "1143,438,1241", "200", "20"),
    ] {
        let words = [
            "linear",
            "--from-point",
            from,
            "--to",
            to,
            "--profile",
            "time-optimal",
            "--orientation",
            "fixed",
        ];
        let words = [&words[..], &["--velocity", velocity, "--acceleration", acceleration]].concat();
        let (code, out, err) = plan(&words);
        assert!(code == 0 && !out.contains("exceeded"), "{from} to {to}: {code} {out}{err}");
        // At a limit: of an axis, or of the tool.
        let of_axis = |line: &str| line.split_whitespace().any(|word| word == "100" || word == "99");
        let is_fast = out.lines().any(|line| of_axis(line) || line.contains("16.00 m/s^2"));
        assert!(is_fast, "{from} to {to}: {out}");
    }
}

#[test]
fn a_line_is_written_once_and_planned_again_from_its_file() {
    let file = Fresh::named("line.ron");
    let asked = ["linear", "--from-point", "1 m, 100 mm, 1.3 m", "--to", "1.2 m, -300 mm, 900 mm", "--out"];
    let asked: Vec<&str> = asked.into_iter().chain([file.path()]).collect();
    let (code, out, _) = plan(&asked);
    assert_eq!(code, 0, "{out}");
    let text = std::fs::read_to_string(file.path()).unwrap();
    assert!(text.contains(r#"target: ["1.2 m", "-300 mm", "900 mm"]"#), "as it was typed: {text}");
    assert!(text.contains("result: (planner:"), "{text}");

    let (code, _, err) = plan(&asked);
    assert!(code == 4 && err.contains("already exists"), "{code}: {err}");
    assert_eq!(std::fs::read_to_string(file.path()).unwrap(), text, "and it is left as it was");

    let (code, again, err) = plan(&["sequence", file.path()]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(again.lines().next(), out.lines().next(), "the same duration");
}

#[test]
fn what_is_exceeded_is_told_with_place_and_remedy_and_nothing_is_written() {
    let file = Fresh::named("fast.ron");
    let start = "25 deg, 20 deg, 5 deg, 0 deg, 40 deg, 0 deg";
    let slow = "robot.axis1.limits.acceleration=0.5 rad/s^2";
    let (code, out, err) = plan(&[
        "linear",
        "--from",
        start,
        "--to",
        "1300 mm, -100 mm, 900 mm",
        "--set",
        slow,
        "--out",
        file.path(),
    ]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.contains("exceeded   at ") && out.contains("% of the path (s = "), "{out}");
    assert!(out.contains("(links[") && out.contains("= help: lower the acceleration to"), "{out}");
    assert!(err.contains("nothing was written") && !file.0.exists());
}

/// Each call with what it says: what is refused before anything is solved, and what is found on the way.
#[test]
fn wrong_requests_are_answered_with_place_reason_and_remedy() {
    let home = "0, 0, 0, 0, 0, 0";
    let at = ["--from-point", "1.2 m, 0, 1 m"];
    let linear = |more: &[&'static str]| [&["linear"], more].concat();
    let to = |more: &[&'static str]| [&["linear", "--to", "1.2 m, 0 m, 1 m"], more].concat();
    let calls: Vec<Vec<&str>> = vec![
        // numbers
        vec!["joint", "--to", "60, 30"],
        vec!["joint", "--to", "1,5 deg, 30 deg, 0, 0, 0, 0"],
        vec!["joint", "--to", "NaN, 0, 0, 0, 0, 0"],
        vec!["joint", "--to", "0,, 0"],
        vec!["joint", "--to", TARGET, "--velocity", "40 mm/s"],
        vec!["joint", "--to", TARGET, "--velocity", "1,5"],
        vec!["joint", "--to", TARGET, "--velocity", "140"],
        linear(&["--to", "1 s, 0 m, 1 m"]),
        linear(&["--to", "1 m, 0 m"]),
        linear(&["--to", "1,2 m, 0, 1 m"]),
        linear(&["--to", "1.2 m, inf, 1 m"]),
        to(&["--velocity", "0"]),
        to(&["--velocity", "-250"]),
        to(&["--acceleration", "150"]),
        to(&["--resolution", "1e-9"]),
        // words and members
        to(&["--profile", "fast"]),
        to(&["--orientation", "loose"]),
        to(&["--orientation", "interpolated"]),
        to(&["--rotation", "0, 90, 0"]),
        to(&["--configuration", "front"]),
        to(&["--surroundings", "no.ron"]),
        vec!["joint", "--to", TARGET, "--robot", "diagrams/servo.ron"],
        // places
        vec!["joint", "--to", home],
        vec!["joint", "--to", "200, 0, 0, 0, 0, 0"],
        vec!["joint", "--to", TARGET, "--from", "0, 0, 80, 0, 0, 0"],
        linear(&["--from", "0, 0, 80, 0, 0, 0", "--to", "1 m, 0 m, 1 m"]),
        linear(&[at[0], at[1], "--to", "1.2 m, 0, 1 m"]),
        linear(&["--to", "3 m, 0 m, 1 m"]),
        linear(&["--to", "3 m, 0 m, 1 m", "--orientation", "fixed"]),
        linear(&["--from-point", "9 m, 0, 0", "--to", "1 m, 0 m, 1 m"]),
        vec!["circular", at[0], at[1], "--via", "1.2 m, 0.1 m, 1 m", "--to", "1.2 m, 0.2 m, 1 m"],
        vec!["circular", at[0], at[1], "--via", "1.2 m, 0.1 m, 3 m", "--to", "1.2 m, 0.2 m, 1 m"],
        // on the way: through the base, from and through a pose with axes 4 and 6 in line
        linear(&[at[0], at[1], "--to", "-1.2 m, 0, 1 m"]),
        linear(&[at[0], at[1], "--to", "-1.2 m, 0, 1 m", "--orientation", "fixed"]),
        linear(&["--from", home, "--to", "1.1 m, 0.4 m, 1.2 m", "--orientation", "fixed"]),
        linear(&[
            "--from-point",
            "1382, -400, 1340.5",
            "--from-rotation",
            "0, 144.2, 0",
            "--to",
            "1382, 400, 1340.5",
            "--orientation",
            "fixed",
            "--configuration",
            "front-up-plain",
        ]),
    ];
    let mut said = String::new();
    for call in calls {
        let (code, out, err) = plan(&call);
        assert!(!err.contains("panicked"), "{call:?}: {err}");
        let kept =
            |line: &&str| ["exceeded", "collision", "  = help"].iter().any(|word| line.starts_with(word));
        let found: Vec<&str> = out.lines().filter(kept).collect();
        let words: Vec<String> = call
            .iter()
            .map(|word| if word.contains(' ') { format!("{word:?}") } else { word.to_string() })
            .collect();
        said += &format!("$ blocksim plan {}\n{err}", words.join(" "));
        said += &found.iter().map(|line| format!("{line}\n")).collect::<String>();
        said += &format!("exit code {code}\n\n");
    }
    expect_test::expect_file!["plan_answers.txt"].assert_eq(&said);
}

#[test]
fn the_page_shows_what_the_program_says() {
    let shown = commands_of("moves.md");
    assert!(shown.len() >= 4, "{} commands with answers", shown.len());
    for (command, answer) in shown {
        let words = arguments(&command);
        assert_eq!(words[..2], ["blocksim", "plan"], "{command}");
        let words: Vec<&str> = words[2..].iter().map(String::as_str).collect();
        let (_, out, err) = plan(&words);
        assert_eq!(format!("{out}{err}"), answer, "{command}");
    }
}

#[test]
fn a_file_of_its_own_says_what_stands_around_and_what_may_touch() {
    let around = |name: &str, text: &str| {
        let file = Fresh::named(name);
        std::fs::write(&file.0, text).unwrap();
        file
    };
    let down =
        ["linear", "--from-point", "1.2 m, 0, 1 m", "--to", "1.2 m, 0, 800 mm", "--json", "--surroundings"];
    let hit = |file: &Fresh| {
        let arguments: Vec<&str> = down.into_iter().chain([file.path()]).collect();
        let (code, out, err) = plan(&arguments);
        let data: serde_json::Value = serde_json::from_str(&out).unwrap_or_default();
        (code, data["collisions"]["first"].clone(), err)
    };
    let shape = "shapes: [(kind: Text(\"box\"), size: [\"0.4 m\", \"0.4 m\", \"0.1 m\"], centre: [\"1.2 m\", 0, \"0.85 m\"])]";
    let block = around("block.ron", &format!("(things: [(name: Text(\"block\"), {shape})])"));
    let (code, first, _) = hit(&block);
    assert_eq!((code, first["names"][1].as_str()), (1, Some("block")), "{first}");
    let soft = around(
        "soft.ron",
        &format!(
            "(things: [(name: Text(\"foam\"), {shape})], may_touch: [[Text(\"tool\"), Text(\"foam\")], [Text(\"link6\"), Text(\"foam\")]])"
        ),
    );
    let (code, first, err) = hit(&soft);
    assert!(code == 0 && first.is_null(), "{code} {first} {err}");
    for (name, text, reason) in [
        ("taken.ron", format!("(things: [(name: Text(\"tool\"), {shape})])"), "not a valid name for a thing"),
        ("pair.ron", "(may_touch: [[Text(\"tool\"), Text(\"cat\")]])".to_owned(), "there is no part `cat`"),
        ("member.ron", "(ceiling: \"3 m\")".to_owned(), "ceiling"),
        ("shape.ron", "(things: [(name: Text(\"a\"), shapes: [(kind: Text(\"egg\"))])])".to_owned(), "egg"),
        ("unit.ron", "(floor: \"3 s\")".to_owned(), "expected a value in m"),
    ] {
        let file = around(name, &text);
        let arguments: Vec<&str> = down.into_iter().chain([file.path()]).collect();
        let (code, told, _) = plan(&arguments);
        assert!(code == 3 && told.contains(reason), "{name}: {code} {told}");
    }
}

#[test]
fn bare_numbers_have_the_units_of_the_help_and_are_written_with_them() {
    let file = Fresh::named("bare.ron");
    let bare = [
        "linear",
        "--from-point",
        "1000, 100, 1300",
        "--to",
        "1200,-300,900",
        "--velocity",
        "250",
        "--acceleration",
    ];
    let (code, out, err) = plan(&bare.into_iter().chain(["20", "--out", file.path()]).collect::<Vec<_>>());
    assert_eq!(code, 0, "{out}{err}");
    let text = std::fs::read_to_string(file.path()).unwrap();
    assert!(
        text.contains(r#"target: ["1200 mm", "-300 mm", "900 mm"]"#) && text.contains("\"250 mm/s\""),
        "{text}"
    );
    let with = ["linear", "--from-point", "1 m, 0.1 m, 1.3 m", "--to", "1.2 m, -0.3 m, 0.9 m"];
    assert_eq!(plan(&with).1.lines().next(), out.lines().next());
}

#[test]
fn a_turn_on_the_spot_is_planned_with_degrees_per_second() {
    let spot =
        ["linear", "--from-point", "1200, 0, 1000", "--from-rotation", "0, 150, 0", "--to", "1200, 0, 1000"];
    let turn = ["--orientation", "interpolated", "--rotation", "30, 150, 0", "--json"];
    let planned = |more: &[&'static str]| {
        let arguments: Vec<&str> = spot.iter().chain(&turn).chain(more).copied().collect();
        let (code, out, err) = plan(&arguments);
        let data: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
        (code, data["duration"].as_f64().unwrap())
    };
    let slow = planned(&["--rotation-velocity", "10", "--rotation-acceleration", "100"]);
    // sin²: d / v + 2 v / a with 30 deg, which turn about the vertical
    assert!(slow.0 == 0 && (slow.1 - 3.2).abs() < 1e-9, "{slow:?}");
    assert!(planned(&[]).1 < 1.2);
}

#[test]
fn what_exceeds_a_limit_is_written_only_with_the_option_that_the_message_names() {
    let file = Fresh::named("accepted.ron");
    let fast =
        ["joint", "--to", TARGET, "--set", "robot.tcp_limits.acceleration=8 m/s^2", "--out", file.path()];
    let (code, out, err) = plan(&fast);
    assert_eq!(code, 1, "{out}{err}");
    // 12.351 m/s^2, as of differences of the path of the tool
    assert!(
        out.contains("the tool accelerates with 8.056 m/s^2, limit 8 m/s^2, up to 12.351 m/s^2"),
        "{out}"
    );
    assert!(out.contains("(tcp_limits.acceleration)\n  = help: lower the velocity to 80.4 %"), "{out}");
    assert!(err.contains("--accept-violations") && !file.0.exists(), "{err}");
    let slower: Vec<&str> = fast[..5].iter().copied().chain(["--velocity", "32.1 %"]).collect();
    assert_eq!(plan(&slower).0, 0, "{}", plan(&slower).1);
    let accepted: Vec<&str> = fast.into_iter().chain(["--accept-violations"]).collect();
    let (code, out, _) = plan(&accepted);
    assert!(code == 0 && out.contains("exceeded ") && file.0.exists(), "{out}");
}

#[test]
fn a_run_along_a_move_that_is_too_fast_or_hits_something_warns_once() {
    let check = |set: &str| {
        let mut command = program();
        let model = "diagrams/irb2600/irb2600.ron";
        command.current_dir(root()).args(["check", model, "--set", set]).env_remove("CLICOLOR_FORCE");
        String::from_utf8(command.output().unwrap().stderr).unwrap()
    };
    let told = check("move=File(\"diagrams/irb2600/moves/exciting.ron\")");
    let count = |what: &str| told.matches(what).count();
    // Seven blocks have this move; the two that look for collisions are one.
    assert_eq!((count("[move_limits]"), count("[move_collision]")), (2, 1), "{told}");
    assert!(
        told.contains("in move 3, at 23.787 % of the time (t = 3.743 s) `tool` meets `workpiece`"),
        "{told}"
    );
    assert!(told.contains("`link4` is 156.4 mm in `workbench` in move 3"), "{told}");
    for shipped in ["demo_joint", "demo_linear"] {
        let told = check(&format!("move=File(\"diagrams/irb2600/moves/{shipped}.ron\")"));
        assert!(!told.contains("[move_"), "{told}");
    }
}

#[test]
fn a_threshold_of_singular_poses_can_be_chosen() {
    let line = [
        "linear",
        "--from-point",
        "1250, -350, 800",
        "--from-rotation",
        "0, 150, 0",
        "--to",
        "1250, 350, 800",
    ];
    let with = |limit: &str| {
        let arguments: Vec<&str> =
            line.into_iter().chain(["--orientation", "fixed", "--singular-limit", limit]).collect();
        plan(&arguments)
    };
    let (code, out, _) = with("0.5");
    assert!(code == 1 && out.contains("nearly singular") && out.contains("`singular_limit`"), "{out}");
    assert_eq!(with("0.001").0, 0);
    let (code, _, err) = with("-1");
    assert!(code == 3 && err.contains("from 0 to 10"), "{code} {err}");
}

#[test]
fn a_refusal_is_json_where_json_was_asked_for() {
    let (code, out, err) = plan(&["linear", "--to", "3 m, 0 m, 1 m", "--json"]);
    let data: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
    assert_eq!((code, data["exit"].as_i64()), (3, Some(3)));
    assert!(data["message"].as_str().unwrap().contains("does not reach the target"), "{out}");
    assert!(!data["help"].as_str().unwrap().is_empty() && err.is_empty(), "{out}{err}");
}

#[test]
fn programs_get_json() {
    let (code, out, _) = plan(&["joint", "--to", TARGET, "--json"]);
    let data: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, data["v"].as_i64()), (0, Some(1)));
    assert!((data["duration"].as_f64().unwrap() - 1.2244897959).abs() < 1e-9);
    assert_eq!(data["axes"].as_array().unwrap().len(), 6);
}

#[test]
fn a_move_that_is_of_the_joints_and_of_the_tool_is_refused() {
    let both = |first: &str, next: &str| {
        let file = Fresh::named("both.ron");
        let home = "start: [0, 0, 0, 0, 0, 0]";
        let tool = "tool: (target: [\"1300 mm\", \"0 mm\", \"1300 mm\"], velocity: \"0.2 m/s\", acceleration: \"20 %\")";
        let text = format!("JointMove({home}, {tool}, {first} moves: [({tool}, {next})])");
        std::fs::write(file.path(), text).unwrap();
        let (code, _, err) = plan(&["sequence", file.path()]);
        (code, err)
    };
    for (first, next, place) in [
        ("target: [1, 0, 0, 0, 0, 0],", "", "`target` is of a move of the joints"),
        ("velocity: \"40 %\",", "", "`velocity` is of a move of the joints"),
        ("", "acceleration: \"30 %\"", "move.moves[0].acceleration"),
    ] {
        let (code, err) = both(first, next);
        assert!(
            code != 0 && err.contains(place) && err.contains("leave out `tool`"),
            "{place}: {code}\n{err}"
        );
    }
}

#[test]
fn a_zone_behind_the_last_move_has_a_note() {
    let with = |zone: &str, rest: &str| {
        let file = Fresh::named("zone.ron");
        let first = r#"target: ["10 deg", 0, 0, 0, "30 deg", 0], velocity: "40 %", acceleration: "30 %""#;
        let text = format!("JointMove(start: [0, 0, 0, 0, \"30 deg\", 0], {first}, {zone} {rest})");
        std::fs::write(file.path(), text).unwrap();
        plan(&["sequence", file.path()])
    };
    let zone = r#"zone: "20 mm","#;
    let (code, out, err) = with(zone, "");
    assert!(code == 0 && out.contains("the zone of 20 mm behind move 1 has no effect"), "{code}\n{out}{err}");
    let back = r#"moves: [(target: [0, 0, 0, 0, "30 deg", 0], velocity: "40 %", acceleration: "30 %", zone: "20 mm")]"#;
    let (code, out, err) = with("", back);
    assert!(code == 0 && out.contains("the zone of 20 mm behind move 2 has no effect"), "{code}\n{out}{err}");
    let (code, _, err) = with(r#"zone: "-20 mm","#, "");
    assert!(code != 0 && err.contains("the zone is negative"), "{code}\n{err}");
}
