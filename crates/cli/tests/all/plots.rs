//! `blocksim plot` and `blocksim compare` as users call them: what is drawn, told, written and refused.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use expect_test::expect;

use crate::support::program;

const LAG: &str = r#"Diagram(
    title: "First order lag",
    parameters: { "lag": "0.2 s" },
    simulation: (stop_time: "3 s", output: Every("1 ms")),
    blocks: {
        "demand": Step(time: "0.1 s", after: "90 deg"),
        "lag_block": LowPass(tau: "lag"),
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: [
        "demand.y -> lag_block.u, scope.set",
        "lag_block.y -> scope.actual",
    ],
)
"#;

/// A folder of its own for each test, removed at the end.
struct Desk(PathBuf);

impl Desk {
    fn with(files: &[(&str, &str)]) -> Desk {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("blocksim-plots-{}-{n}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        files.iter().for_each(|(name, text)| fs::write(path.join(name), text).unwrap());
        Desk(path)
    }

    /// Exit code, standard output and standard error.
    fn call(&self, arguments: &[&str]) -> (i32, String, String) {
        let mut command = program();
        command.current_dir(&self.0).args(arguments).env_remove("CLICOLOR_FORCE").env("COLUMNS", "70");
        let output = command.output().unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (output.status.code().unwrap(), out, err)
    }

    /// The same in one text.
    fn said(&self, arguments: &[&str]) -> String {
        let (code, out, err) = self.call(arguments);
        format!("{out}{err}exit code {code}\n")
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.0.join(path)).unwrap()
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A table of `rows` rows every 10 ms.
fn table(heading: &str, rows: u32, row: impl Fn(f64) -> String) -> String {
    let lines = (0..rows).map(|k| {
        let t = f64::from(k) * 0.01;
        format!("{t},{}\n", row(t))
    });
    format!("time [s],{heading}\n{}", lines.collect::<String>())
}

#[test]
fn a_run_is_drawn_in_the_terminal_with_its_error() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    desk.call(&["run", "lag.ron", "-q", "--out", "runs/a"]);
    expect![[r#"
        scope [deg]
             |  ***********+++++++++++++++++++++++++++++++++++++++++  * set
          80 +  *      +++++                                          + actual
             |  *    +++
             |  *   ++
          60 +  *  ++
             |  * ++
          40 +  * +
             |  *++
             |  *+
          20 +  ++
             |  +
           0 ++++
             ++-----------------+----------------+-----------------+
              0                 1                2                 3  time [s]
          100 +  *
              |  ***
           50 +  * *****
            0 +***     **********************************************  * error
              ++-----------------+----------------+-----------------+
               0                 1                2                 3  time [s]
        exit code 0
    "#]]
    .assert_eq(&desk.said(&["plot", "a", "--ascii"]));
}

#[test]
fn titles_and_legends_are_those_of_the_diagram() {
    let inner = r#"Diagram(
        inputs: { "u": (unit: "1") },
        blocks: { "speed": Scope(inputs: ["w"], label: "Axis 1"), "lag": LowPass(tau: 1), "spare": Scope(inputs: ["y"]) },
        connections: ["in.u -> speed.w, lag.u", "lag.y -> spare.y"],
    )"#;
    let model = r#"Diagram(
        simulation: (stop_time: "1 s", output: Every("10 ms")),
        blocks: {
            "step": Step, "lag": LowPass(tau: 0.1),
            "a": Subsystem(file: "inner.ron", label: "Speeds"),
            "b": Subsystem(file: "inner.ron", label: "Torques"),
            "plain": Scope(inputs: ["set", "actual"]),
            "named": Scope(inputs: ["set", "actual"], label: "Antwort", legend: ["Sollwert", "Istwert"]),
        },
        connections: ["step.y -> lag.u, a.u, plain.set, named.set", "lag.y -> b.u, plain.actual, named.actual"],
    )"#;
    let desk = Desk::with(&[("m.ron", model), ("inner.ron", inner)]);
    assert_eq!(desk.call(&["run", "m.ron", "--out", "r", "--quiet"]).0, 0);
    let (code, _, err) = desk.call(&["plot", "r", "--svg", "r.svg"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let drawing = desk.read("r.svg");
    for text in ["Speeds: Axis 1", "Torques: Axis 1", "Speeds: spare", "Antwort", "Sollwert", "Istwert"] {
        assert!(drawing.contains(text), "{text}");
    }
    // The scope without labels shows the same as the one with them.
    assert!(!drawing.contains(">plain") && !drawing.contains(">actual"), "{drawing}");
    assert!(desk.said(&["plot", "r", "plain"]).contains("plain"));
}

/// Places of the curve of the first plot of a drawing.
fn dots(drawing: &str) -> Vec<(f64, f64)> {
    let courses = drawing.split("<svg class=\"courses\"").nth(1).unwrap();
    let data = courses.split("<path d=\"").nth(1).unwrap().split('"').next().unwrap();
    let points = data.split(['M', 'L']).filter(|point| !point.is_empty());
    points
        .map(|point| {
            let (x, y) = point.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect()
}

#[test]
fn an_xy_scope_is_one_signal_over_the_other() {
    let model = r#"Diagram(
        simulation: (stop_time: "1 s", output: Every("1 ms")),
        blocks: {
            "across": Sine(amplitude: "2 m", frequency: "1 Hz", phase: "90 deg"), "upwards": Sine(amplitude: "2 m", frequency: "1 Hz"),
            "circle": XyScope(label: "Circle", display_x: "cm", display_y: "cm"),
        },
        connections: ["across.y -> circle.x", "upwards.y -> circle.y"],
    )"#;
    let desk = Desk::with(&[("m.ron", model)]);
    let summary = desk.said(&["run", "m.ron", "--out", "r"]);
    assert!(summary.contains("circle [cm]") && summary.contains("x [cm]"), "{summary}");
    assert!(!summary.contains("time [s]"), "{summary}");
    let (code, _, err) = desk.call(&["plot", "r", "--svg", "r.svg"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let drawing = desk.read("r.svg");
    assert!(drawing.contains("Circle [cm]") && drawing.contains(">x [cm]<"), "{drawing}");
    assert!(!drawing.contains("time [s]"));
    let dots = dots(&drawing);
    let middle = |value: fn(&(f64, f64)) -> f64| {
        let (low, high) =
            dots.iter().map(value).fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
        ((low + high) / 2.0, (high - low) / 2.0)
    };
    let ((x, radius), (y, other)) = (middle(|dot| dot.0), middle(|dot| dot.1));
    assert!((radius - other).abs() < 0.2 && radius > 50.0, "{radius} {other}");
    assert!(
        dots.iter().all(|dot| ((dot.0 - x).hypot(dot.1 - y) - radius).abs() < 0.3),
        "no circle: {dots:?}"
    );
    let text = desk.said(&["plot", "r"]);
    assert!(text.contains("Circle [cm]") && text.contains("x [cm]"), "{text}");
    let over_time = desk.said(&["plot", "r", "--layout", "signals"]);
    assert_eq!(over_time.matches("time [s]").count(), 2, "{over_time}");
    assert_eq!(desk.call(&["report", "r", "-o", "page.html"]).0, 0);
    let page = desk.read("page.html");
    assert!(page.contains("<figcaption>Circle</figcaption>") && page.contains("id=\"planes\""));
}

#[test]
fn the_numbers_of_a_first_order_lag_are_those_of_its_closed_form() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    desk.call(&["run", "lag.ron", "-q"]);
    let (code, out, _) = desk.call(&["plot", "latest", "--json"]);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let row = &json["tracking"][0];
    let number = |name: &str| row[name].as_f64().unwrap();
    // Rows every 1 ms, straight between: the area of a row is off by at most h^2 / 12 times the curvature.
    for (name, expected, tolerance) in [
        ("begin", 0.1, 1e-9),
        ("step", 90.0, 1e-9),
        ("rise", 0.2 * 9_f64.ln(), 1e-5),
        ("settling", 0.2 * 50_f64.ln(), 1e-5),
        ("overshoot", 0.0, 1e-9),
        ("iae", 90.0 * 0.2, 1e-3),
        ("ise", 90.0 * 90.0 * 0.1, 1e-1),
        ("maximum_error", 90.0, 1e-9),
    ] {
        assert!((number(name) - expected).abs() <= tolerance, "{name}: {} is not {expected}", number(name));
    }
    assert_eq!((row["unit"].as_str(), row["signal"].as_str()), (Some("deg"), Some("scope.actual")));
    let (_, out, _) = desk.call(&["plot", "latest", "--json", "--unit", "rad"]);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let step = json["tracking"][0]["step"].as_f64().unwrap();
    assert!((step - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn drawings_and_pictures_are_written_and_never_replaced_silently() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    desk.call(&["run", "lag.ron", "-q"]);
    assert_eq!(
        desk.said(&["plot", "latest", "--svg", "a.svg", "--png", "a.png"]),
        "a.svg\na.png\nexit code 0\n"
    );
    let drawing = desk.read("a.svg");
    assert!(
        drawing.starts_with("<svg") && drawing.contains(">scope [°]</text>") && drawing.contains(">error<")
    );
    assert!(fs::read(desk.0.join("a.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(
        desk.said(&["plot", "latest", "--png", "a.png"]),
        "error[exists]: `a.png` already exists\n  = help: name another file, or add --yes to replace it\nexit code 4\n"
    );
    assert_eq!(desk.call(&["plot", "latest", "--png", "a.png", "--yes", "--theme", "dark"]).0, 0);
    let lost = desk.said(&["plot", "latest", "--svg", "no/such/a.svg"]);
    assert_eq!(
        lost,
        "error[unwritable]: cannot write `no/such/a.svg`: the folder `no/such` does not exist\n  = help: create it, or choose another \
         place\nexit code 4\n"
    );
    assert!(!desk.0.join("no").exists());
}

#[test]
fn a_name_cannot_bring_a_script_into_a_drawing() {
    let evil = table("\"</text><script>alert(1)</script>.x [m]\"", 3, |t| t.to_string());
    let desk = Desk::with(&[("evil.csv", &evil)]);
    assert_eq!(desk.call(&["plot", "evil.csv", "--svg", "a.svg", "--png", "a.png"]).0, 0);
    assert!(!desk.read("a.svg").contains("<script"));
}

#[test]
fn measured_values_lie_over_a_run_once_their_columns_are_mapped() {
    let measured = "Zeit (ms);Winkel;Strom\n0;0,0;1\n100;0;1\n300;56,9;\n1000;89,0;1\n";
    let desk = Desk::with(&[
        ("lag.ron", LAG),
        ("m.csv", measured),
        ("names.map", "# names\nWinkel = scope.actual [deg]\n"),
    ]);
    desk.call(&["run", "lag.ron", "-q", "--out", "runs/lag"]);
    expect![[r#"
        error[usage]: `m.csv` has none of the requested signals
          = help: it has `Winkel`, `Strom`; name them, such as --map 'Winkel=scope.set'
        exit code 2
    "#]]
    .assert_eq(&desk.said(&["plot", "latest", "--with", "m.csv", "--svg", "a.svg"]));
    let drawn = desk.said(&["plot", "latest", "--with", "m.csv", "--map", "names.map", "--svg", "a.svg"]);
    assert_eq!(drawn, "a.svg\nexit code 0\n");
    assert!(desk.read("a.svg").contains(">actual m.csv</text>"));
    expect![[r#"
        error[usage]: there is no column `Winkl` in `m.csv`
          = help: did you mean `Winkel`?
        exit code 2
    "#]]
    .assert_eq(&desk.said(&["plot", "latest", "--with", "m.csv", "--map", "Winkl=scope.actual[deg]"]));
    expect![[r#"
        error[unreadable]: the unit of column `Winkel` in `m.csv` is not known: unknown unit `grad`
          = help: a degree is `deg`, a gradian 0.9 deg, or give it with --map 'Winkel=scope.actual[UNIT]'
        exit code 4
    "#]]
    .assert_eq(&desk.said(&["plot", "latest", "--with", "m.csv", "--map", "Winkel=scope.actual[grad]"]));
    expect![[r#"
        error[unreadable]: `scope.actual` is in deg in `lag`, but in mm in `m.csv`
          = help: give the unit, such as --map 'COLUMN=scope.actual[unit]'
        exit code 4
    "#]]
    .assert_eq(&desk.said(&["plot", "latest", "--with", "m.csv", "--map", "Winkel=scope.actual[mm]"]));
}

#[test]
fn what_cannot_be_drawn_is_told_with_a_remedy() {
    let desk = Desk::with(&[
        ("empty.csv", ""),
        ("no_rows.csv", "time [s],a.x [m]\n"),
        ("broken.csv", "time [s],a.x [m]\n0,1\n1,x\n"),
        ("backwards.csv", "t;a\n1;1\n0,5;1\n"),
        ("nan.csv", "time [s],a.x [m]\n0,NaN\n1,NaN\n"),
        ("one.csv", "time [s],a.x [m]\n3,1\n"),
    ]);
    let mut said = String::new();
    for arguments in [
        &["plot", "empty.csv"][..],
        &["plot", "no_rows.csv"],
        &["plot", "broken.csv"],
        &["plot", "backwards.csv"],
        &["plot", "nothing.csv"],
        &["plot", "nan.csv"],
        &["plot", "nan.csv", "a.y"],
        &["plot", "nan.csv", "--from", "5"],
        &["plot", "nan.csv", "--map", "a"],
        &["plot", "one.csv", "--metrics"],
    ] {
        said.push_str(&format!("$ {}\n{}\n", arguments.join(" "), desk.said(arguments)));
    }
    expect![[r#"
        $ plot empty.csv
        error[unreadable]: cannot read `empty.csv`: line 1: the file is empty; the first line must name the columns
          = help: correct the file, or export it again
        exit code 4

        $ plot no_rows.csv
        error[unreadable]: `no_rows.csv` has no values
          = help: run the model, or export the table, again
        exit code 4

        $ plot broken.csv
        error[unreadable]: cannot read `broken.csv`: line 3, column 2: `x` is not a number; leave the field empty for a missing one
          = help: correct the file, or export it again
        exit code 4

        $ plot backwards.csv
        error[unreadable]: cannot read `backwards.csv`: line 3, column 1: the time 0.5 follows 1; times must not fall
          = help: correct the file, or export it again
        exit code 4

        $ plot nothing.csv
        error[unreadable]: cannot read `nothing.csv`: no folder, file or run in `runs` has this name
          = help: `blocksim runs` lists what there is; `blocksim run MODEL` makes a new one
        exit code 4

        $ plot nan.csv
        a [m]
          nothing to draw
          x: NaN first at 0; 2 of 2 values are not finite
        exit code 0

        $ plot nan.csv a.y
        error[usage]: no signal of `nan.csv` fits `a.y`
          = help: did you mean `a.x`?
        exit code 2

        $ plot nan.csv --from 5
        error[usage]: there are no values from 5 s on
          = help: `nan.csv` goes from 0 s to 1 s
        exit code 2

        $ plot nan.csv --map a
        error[usage]: cannot read the mappings in `a`: the file does not exist
          = help: write a mapping as 'COLUMN=PATH[unit]'
        exit code 2

        $ plot one.csv --metrics
        note: none of these signals has two values or more in this time
        exit code 0

    "#]].assert_eq(&said);
    for drawable in ["nan.csv", "one.csv"] {
        assert_eq!(desk.call(&["plot", drawable, "--png", "a.png", "--yes"]).0, 0, "{drawable}");
    }
}

#[test]
fn two_million_rows_make_a_small_drawing() {
    let path = Desk::with(&[]);
    let mut text = String::from("time [s],a.x [m]\n");
    for k in 0..2_000_000_u64 {
        text.push_str(&format!("{k}e-6,{}\n", (k * 7919) % 1000));
    }
    fs::write(path.0.join("long.csv"), text).unwrap();
    assert_eq!(path.call(&["plot", "long.csv", "--svg", "a.svg"]).0, 0);
    assert!(path.read("a.svg").len() < 200_000, "{}", path.read("a.svg").len());
}

#[test]
fn two_runs_are_the_same_within_or_different() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    desk.call(&["run", "lag.ron", "-q", "--out", "a"]);
    desk.call(&["run", "lag.ron", "-q", "--out", "b"]);
    desk.call(&["run", "lag.ron", "-q", "--out", "c", "--set", "lag=201ms"]);
    desk.call(&["run", "lag.ron", "-q", "--out", "d", "--until", "1s"]);
    assert_eq!(
        desk.said(&["compare", "a", "b"]),
        "2 signals agree: 2 exactly, 0 within the tolerances\nexit code 0\n"
    );
    expect![[r#"
        signal        verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        scope.actual  DIFFERS         -0.1651 deg     0.3                 0.101  0.448877  0.446649        0

        1 of 2 signals does not agree
        exit code 1
    "#]]
    .assert_eq(&desk.said(&["compare", "a", "c"]));
    // The maximum difference of two lags is about h/e times the relative difference of their time constants.
    assert_eq!(desk.call(&["compare", "a", "c", "--abs", "0.17deg"]).0, 0);
    assert_eq!(desk.call(&["compare", "a", "c", "--abs", "0.16deg"]).0, 1);
    assert_eq!(desk.call(&["compare", "a", "c", "--abs", "0.01deg", "--time-tolerance", "10ms"]).0, 0);
    expect![[r#"
        signal        verdict                 maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        scope.set     SHORT, only 0 s to 1 s               0 deg       0                     -         -         -        -
        scope.actual  DIFFERS                       7.470e-6 deg   0.586                 0.101  0.448877  0.448877        0

        2 of 2 signals do not agree
        exit code 1
    "#]].assert_eq(&desk.said(&["compare", "a", "d"]));
    assert_eq!(desk.call(&["compare", "a", "d", "--overlap", "--abs", "1e-3deg"]).0, 0);
}

/// What lies within the largest step of either recording is no end: here 0.45 s of 1 s.
#[test]
fn a_recording_that_ends_early_does_not_agree() {
    let rows = |rows: &[(f64, f64)]| {
        let rows: String = rows.iter().map(|(t, x)| format!("{t},{x}\n")).collect();
        format!("time [s],x [m]\n{rows}")
    };
    let baseline = [(0.0, 0.0), (0.01, 0.0), (0.5, 0.0), (0.97, 0.0), (0.97, 5.0), (1.0, 5.0)];
    let early = [(0.0, 0.0), (0.001, 0.0), (0.5, 0.0), (0.951, 0.0)];
    let late = [(0.02, 0.0), (0.5, 0.0), (0.97, 0.0), (0.97, 5.0), (1.0, 5.0)];
    // The next sample would be behind the end, or at it.
    let coarse: Vec<(f64, f64)> = (0..3).map(|k| (0.4 * f64::from(k), 0.0)).collect();
    let fine: Vec<(f64, f64)> = (0..100).map(|k| (0.01 * f64::from(k), 5.0 * f64::from(k > 97))).collect();
    let desk = Desk::with(&[
        ("baseline.csv", &rows(&baseline)),
        ("early.csv", &rows(&early)),
        ("late.csv", &rows(&late)),
        ("coarse.csv", &rows(&coarse)),
        ("flat.csv", &rows(&[(0.0, 0.0), (1.0, 0.0)])),
        ("fine.csv", &rows(&fine)),
    ]);
    let verdict = |baseline: &str, other: &str, more: &[&str]| {
        let words = [&["compare", baseline, other, "--json", "--interpolation", "linear"], more].concat();
        let json: serde_json::Value = serde_json::from_str(&desk.call(&words).1).expect("JSON");
        json["signals"][0]["verdict"].as_str().expect("a verdict").to_owned()
    };
    assert_eq!(verdict("baseline.csv", "early.csv", &[]), "short");
    assert_eq!(verdict("baseline.csv", "late.csv", &[]), "short");
    assert_eq!(verdict("baseline.csv", "fine.csv", &["--abs", "5m"]), "short");
    assert_eq!(verdict("flat.csv", "coarse.csv", &[]), "same");
    assert_eq!(verdict("baseline.csv", "early.csv", &["--overlap"]), "same");
    assert_eq!(verdict("baseline.csv", "late.csv", &["--time-tolerance", "30ms"]), "same");
    assert_eq!(verdict("early.csv", "baseline.csv", &[]), "same");
}

/// Whichever of both has no unit is taken to be in that of the other.
#[test]
fn a_table_without_units_agrees_from_either_side() {
    let desk =
        Desk::with(&[("deg.csv", "time [s],x [deg]\n0,0\n1,90\n"), ("none.csv", "time,x\n0,0\n1,90\n")]);
    for (baseline, other) in [("deg.csv", "none.csv"), ("none.csv", "deg.csv")] {
        let (code, _, err) = desk.call(&["compare", baseline, other, "--range", "1e-12"]);
        assert_eq!(code, 0, "{err}");
        assert!(err.contains("note: `none.csv` has no units; assuming `x` in deg"), "{err}");
    }
}

#[test]
fn a_tolerance_in_degrees_celsius_is_a_difference() {
    let table = |middle: f64| format!("time [s],x [degC]\n0,20\n1,{middle}\n2,20\n");
    let desk = Desk::with(&[("a.csv", &table(20.0)), ("b.csv", &table(25.0))]);
    for (tolerance, code) in
        [("0.5degC", 1), ("4.9 °C", 1), ("4.9K", 1), ("5.1degC", 0), ("5.1 [degC]", 0), ("5.1 K", 0)]
    {
        let words = ["compare", "a.csv", "b.csv", "--abs", tolerance, "--interpolation", "linear"];
        let found = desk.call(&words);
        assert_eq!(found.0, code, "{tolerance}: {found:?}");
    }
    let data = desk.call(&["compare", "a.csv", "b.csv", "--abs", "0.5 degC", "--json"]);
    assert!(data.1.contains("\"tolerance\":0.5}"), "{data:?}");
}

/// Rows of a run every 0.1 s beside a table of the closed form every 5 ms: chords of a lag of 0.2 s are off by up to
/// `90 deg (0.1 / 0.2)^2 / 8`, 2.8 deg, just after the step, which no tolerance should have to allow.
#[test]
fn a_run_with_few_rows_agrees_with_its_closed_form_between_them() {
    let model = LAG.replace("Every(\"1 ms\")", "Every(\"0.1 s\")");
    assert_ne!(model, LAG);
    let lag = |t: f64| 90.0 * (1.0 - (-(t - 0.1).max(0.0) / 0.2).exp());
    let rows = (0..400).map(|k| f64::from(k) / 200.0).map(|t| format!("{t},{}\n", lag(t)));
    let table = format!("time [s],scope.actual [deg]\n{}", rows.collect::<String>());
    let desk = Desk::with(&[("lag.ron", &model), ("exact.csv", &table)]);
    desk.call(&["run", "lag.ron", "-q", "--out", "run"]);
    let maximum = |baseline: &str, other: &str, more: &[&str]| {
        let words =
            [&["compare", baseline, other, "--json", "--common", "-s", "scope.actual"], more].concat();
        let (_, out, err) = desk.call(&words);
        let json: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{err}"));
        json["signals"][0]["maximum"]["difference"].as_f64().expect("a number").abs()
    };
    for (baseline, other) in [("run", "exact.csv"), ("exact.csv", "run")] {
        let smooth = maximum(baseline, other, &[]);
        let straight = maximum(baseline, other, &["--interpolation", "linear"]);
        assert!((straight - 2.2).abs() < 0.4 && smooth < 0.15, "{straight} deg, {smooth} deg");
    }
    // What is exported on a finer grid is the same curve.
    desk.call(&["export", "run", "--every", "20ms", "--csv", "fine.csv"]);
    assert!(maximum("run", "fine.csv", &[]) < 1e-6);
    assert!(maximum("exact.csv", "fine.csv", &[]) < 0.3);
}

#[test]
fn the_result_is_data_for_programs() {
    let a = table("a.x [deg],a.b [bool],only.a", 11, |t| format!("{},1,0", 10.0 * t));
    let b = table("a.x [deg],a.b [bool],only.b", 11, |t| {
        format!("{},1,0", 10.0 * t + 0.5 * f64::from(t > 0.045))
    });
    let desk = Desk::with(&[("a.csv", &a), ("b.csv", &b)]);
    let (code, out, err) = desk.call(&["compare", "a.csv", "b.csv", "--json", "--abs", "0.25deg"]);
    assert_eq!((code, err.as_str()), (1, ""));
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    let near = |value: &serde_json::Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-9;
    let x = &json["signals"][0];
    assert_eq!((x["verdict"].as_str(), x["unit"].as_str()), (Some("differs"), Some("deg")));
    assert!(near(&x["first"]["time"], 0.05) && near(&x["first"]["baseline"], 0.5), "{x}");
    assert!(near(&x["first"]["difference"], 0.5) && near(&x["first"]["tolerance"], 0.25), "{x}");
    assert_eq!(x["outside"].as_u64(), Some(6));
    assert_eq!(json["signals"][1]["verdict"], "same");
    assert_eq!(json["signals"][2]["verdict"], "missing");
    assert_eq!(json["only_in_other"], serde_json::json!(["only.b"]));
    assert_eq!(desk.call(&["compare", "a.csv", "b.csv", "--abs", "0.6deg"]).0, 1, "one is missing");
    assert_eq!(desk.call(&["compare", "a.csv", "b.csv", "--abs", "0.6deg", "--common"]).0, 0);
    assert_eq!(desk.call(&["compare", "a.csv", "b.csv", "-s", "a.b"]).0, 0);
}

#[test]
fn a_late_measurement_is_aligned() {
    let bell = |late: f64| move |t: f64| format!("{}", (-((t - 1.0 - late) / 0.2).powi(2)).exp());
    let desk = Desk::with(&[
        ("a.csv", &table("a.x [m]", 301, bell(0.0))),
        ("b.csv", &table("a.x [m]", 301, bell(0.25))),
    ]);
    assert_eq!(desk.call(&["compare", "a.csv", "b.csv", "--abs", "1e-3"]).0, 1);
    assert_eq!(
        desk.call(&["compare", "a.csv", "b.csv", "--abs", "1e-9", "--shift", "-0.25", "--overlap"]).0,
        0
    );
    let aligned =
        desk.said(&["compare", "a.csv", "b.csv", "--abs", "2e-3", "--align", "correlation", "--overlap"]);
    assert!(aligned.contains("`b.csv` is shifted by -0.25"), "{aligned}");
    assert!(aligned.ends_with("exit code 0\n"), "{aligned}");
    let flat = Desk::with(&[("a.csv", "t,x\n0,1\n1,1\n"), ("b.csv", "t,x\n5,1\n6,1\n")]);
    expect![[r#"
        error[usage]: the signals are constant, so their time shift cannot be found
          = help: choose others with --signals, or give --shift
        exit code 2
    "#]]
    .assert_eq(&flat.said(&["compare", "a.csv", "b.csv", "--align", "correlation"]));
    assert_eq!(flat.call(&["compare", "a.csv", "b.csv", "--align", "start"]).0, 0);
    assert_eq!(flat.call(&["compare", "a.csv", "b.csv"]).0, 1, "no common time");
}

#[test]
fn foreign_tables_are_compared_and_their_faults_told() {
    let desk = Desk::with(&[
        ("a.csv", "time [s],q.x [rad],m.x [N*m]\n0,0,1\n1,1.5707963267948966,1\n"),
        ("b.csv", "Zeit [ms];q1;M [Vs]\n0;0;1,0\n500;45,0;1,0\n1000;90,0;1,0\n"),
        ("wrong.csv", "Zeit [ms];q1 [mm]\n0;0\n1000;90,0\n"),
    ]);
    let map = ["--map", "q1=q.x[deg]", "--map", "M=m.x[N*m]"];
    let arguments =
        |more: &[&'static str]| [&["compare", "a.csv", "b.csv", "--abs", "1e-12"][..], more].concat();
    expect![[r#"
        2 signals agree: 2 exactly, 0 within the tolerances
        exit code 0
    "#]]
    .assert_eq(&desk.said(&arguments(&map)));
    expect![[r#"
        error[unreadable]: the unit of column `M` in `b.csv` is not known: unknown unit `Vs`
          = help: write `V*s`, or give it with --map 'M=m.x[UNIT]'
        exit code 4
    "#]]
    .assert_eq(&desk.said(&arguments(&["--map", "M=m.x"])));
    expect![[r#"
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared   allowed
        q.x     DIFFERS           88.43 rad       1                   0.5  0.785398   45.0000  1.00e-12

        1 of 1 signal does not agree
        note: `b.csv` has no units; assuming `q.x` in rad
        exit code 1
    "#]]
    .assert_eq(&desk.said(&arguments(&["--map", "q1=q.x", "-s", "q.x"])));
    expect![[r#"
        signal  verdict              maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q.x     in mm, another UNIT                   -       -                     -         -         -        -
        m.x     MISSING                               -       -                     -         -         -        -

        1 signal of the baseline is missing in `wrong.csv`
        1 of 2 signals does not agree
        exit code 1
    "#]].assert_eq(&desk.said(&["compare", "a.csv", "wrong.csv", "--map", "q1=q.x", "--common"]));
    expect![[r#"
        error: invalid value '-1' for '--abs <X>': a tolerance is not below zero

        For more information, try '--help'.
        exit code 2
    "#]]
    .assert_eq(&desk.said(&["compare", "a.csv", "b.csv", "--abs", "-1"]));
    assert_eq!(desk.call(&["compare", "a.csv", "a.csv", "--svg", "d.svg", "--png", "d.png"]).0, 0);
    assert!(desk.read("d.svg").contains(">difference<"));
}

#[test]
fn pictures_of_several_runs_tell_what_differs_under_the_title_of_the_model() {
    let desk = Desk::with(&[("lag.ron", LAG)]);
    for (run, lag) in [("a", "0.2 s"), ("b", "0.1 s"), ("c", "0.05 s")] {
        let set = format!("lag={lag}");
        assert_eq!(desk.call(&["run", "lag.ron", "--out", run, "--quiet", "--set", &set]).0, 0);
    }
    let texts = |file: &str| -> Vec<String> {
        let drawing = desk.read(file);
        let shown = drawing.lines().filter(|line| line.starts_with("<text"));
        let text = |line: &str| {
            line.split_once('>').and_then(|rest| rest.1.strip_suffix("</text>")).map(str::to_owned)
        };
        shown.filter_map(text).filter(|text| text.parse::<f64>().is_err()).collect()
    };
    assert_eq!(desk.call(&["plot", "a", "--with", "b", "--with", "c", "--svg", "all.svg"]).0, 0);
    assert_eq!(
        texts("all.svg"),
        [
            "First order lag",
            "scope [°]",
            // What all were told to do is one line.
            "set",
            "actual lag = 0.2 s",
            "actual lag = 0.1 s",
            "actual lag = 0.05 s",
            "error",
            "time [s]"
        ]
    );
    assert_eq!(desk.call(&["compare", "a", "b", "--svg", "two.svg"]).0, 1);
    let said = texts("two.svg");
    assert_eq!(said[0], "First order lag");
    assert!(said.contains(&"lag = 0.2 s".to_owned()) && said.contains(&"lag = 0.1 s".to_owned()), "{said:?}");
    let (code, _, told) = desk.call(&["plot", "a", "--svg", "none.svg", "--page", "2"]);
    assert_eq!((code, told.contains("there is no page 2: the drawing has one page")), (2, true), "{told}");
}

#[test]
fn a_signal_that_follows_nothing_has_the_numbers_of_its_own_way() {
    // 1 - exp(-t / tau) has a rise of tau ln 9 in any window, and settles tau ln 50 after its beginning.
    let desk = Desk::with(&[(
        "lag.ron",
        &LAG.replace("inputs: [\"set\", \"actual\"]", "inputs: [\"u\", \"y\"]")
            .replace("scope.set", "scope.u")
            .replace("scope.actual", "scope.y"),
    )]);
    assert_eq!(desk.call(&["run", "lag.ron", "--out", "run", "--quiet"]).0, 0);
    let (code, out, told) = desk.call(&["plot", "run", "scope.y", "--from", "0.1", "--json"]);
    assert_eq!(code, 0, "{told}");
    let data: serde_json::Value = serde_json::from_str(&out).unwrap();
    let row = &data["tracking"][0];
    let near = |name: &str, expected: f64| {
        let found = row[name].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-3, "{name}: {found} is not {expected}");
    };
    near("rise", 0.2 * 9_f64.ln());
    near("settling", 0.2 * 50_f64.ln());
    near("step", 90.0);
    assert!(row["follows"] == false && row["iae"].is_null() && row["final_error"].is_null(), "{row}");
}

/// A scope of a set and an actual value, in degrees where they are angles.
fn followed(blocks: &str, stop: f64, set: &str, actual: &str, more: &str) -> String {
    format!(
        r#"Diagram(simulation: (stop_time: {stop}), blocks: {{ {blocks}, "q": Scope(inputs: ["set", "actual"]) }},
            connections: ["{set} -> q.set", "{actual} -> q.actual", {more}])"#
    )
}

/// The numbers of the only pair of a run.
fn numbers(desk: &Desk, run: &str, arguments: &[&str]) -> serde_json::Value {
    let (code, out, err) = desk.call(&[&["plot", run, "--metrics", "--json"], arguments].concat());
    assert_eq!(code, 0, "{err}");
    let mut found: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(found["tracking"].as_array().unwrap().len(), 1, "{out}");
    found["tracking"][0].take()
}

fn assert_near(found: &serde_json::Value, key: &str, expected: f64, tolerance: f64) {
    let value = found[key].as_f64().unwrap();
    assert!((value - expected).abs() <= tolerance, "{key} is {value}, not {expected}");
}

#[test]
fn a_step_over_the_end_of_the_scale_is_as_far_as_it_is_requested() {
    // A lag of 0.3 s: rise 0.3 ln 9, settling 0.3 ln 50, area of the error 0.3 s times the step.
    for (before, after) in [(150.0, -150.0), (-160.0, 170.0), (170.0, -170.0)] {
        let blocks = format!(
            r#""w": Step(time: 1, before: "{before} deg", after: "{after} deg"), "l": LowPass(tau: 0.3, y0: "{before} deg")"#
        );
        let desk = Desk::with(&[("m.ron", &followed(&blocks, 5.0, "w.y", "l.y", r#""w.y -> l.u""#))]);
        let (_, summary, _) = desk.call(&["run", "m.ron", "--out", "r"]);
        let step: f64 = after - before;
        assert!(summary.contains(&format!(" {:.1} ", step.abs())), "{summary}");
        let found = numbers(&desk, "r", &[]);
        assert_near(&found, "step", step, 1e-9);
        assert_near(&found, "rise", 0.3 * 9_f64.ln(), 1e-3);
        assert_near(&found, "settling", 0.3 * 50_f64.ln(), 1e-3);
        assert_near(&found, "iae", 0.3 * step.abs(), 0.01);
        assert_near(&found, "maximum_error", step.abs(), 1e-9);
        // One and a half tenths of a millionth of the step remain after 13.3 time constants.
        assert_near(&found, "final_error", 0.0, 1e-3);
    }
    // A joint that goes one turn farther is not the same.
    let desk = Desk::with(&[("a.csv", "time [s],x [deg]\n0,150\n1,150\n1,-150\n2,-150\n")]);
    fs::write(desk.0.join("b.csv"), "time [s],x [deg]\n0,150\n1,150\n1,210\n2,210\n").unwrap();
    assert_eq!(desk.call(&["compare", "a.csv", "b.csv", "--abs", "1e-6"]).0, 1);
}

#[test]
fn a_sampled_angle_goes_on_where_its_scale_begins_again() {
    // The sample is up to 1.8 deg behind a saw of 180 deg/s, in the mean half of that.
    for (lower, upper) in [(0, 360), (-180, 180)] {
        let blocks = format!(
            r#""w": Sawtooth(lower: "{lower} deg", upper: "{upper} deg", period: 2), "z": ZeroOrderHold(ts: "10 ms")"#
        );
        let desk = Desk::with(&[("m.ron", &followed(&blocks, 5.0, "w.y", "z.y", r#""w.y -> z.u""#))]);
        desk.call(&["run", "m.ron", "--out", "r"]);
        let found = numbers(&desk, "r", &[]);
        assert_near(&found, "step", 900.0, 1e-6);
        assert_near(&found, "maximum_error", 1.8, 1e-6);
        assert_near(&found, "final_error", 0.9, 0.02);
        assert_near(&found, "iae", 4.5, 1e-3);
    }
    // A sawtooth over 300 deg does not jump by a turn: behind each of its jumps a lag of 50 ms has to go back. The error is 150 deg/s times
    // 50 ms, less what comes of the jumps.
    let blocks = r#""w": Sawtooth(lower: "0 deg", upper: "300 deg", period: 2), "l": LowPass(tau: "50 ms")"#;
    let desk = Desk::with(&[("m.ron", &followed(blocks, 5.0, "w.y", "l.y", r#""w.y -> l.u""#))]);
    desk.call(&["run", "m.ron", "--out", "r"]);
    let found = numbers(&desk, "r", &[]);
    assert_near(&found, "maximum_error", 300.0 - 7.5, 1e-3);
    assert_near(&found, "final_error", 7.5, 1e-3);
}

#[test]
fn numbers_of_a_part_of_the_time_count_what_is_held_at_its_ends() {
    // A sample of 0.5 s and one a sample later: their difference is 1 from 1 s to 1.5 s.
    let blocks = r#""w": Step(time: 1), "z": ZeroOrderHold(ts: 0.5), "u": UnitDelay(ts: 0.5)"#;
    let model = followed(blocks, 5.0, "z.y", "u.y", r#""w.y -> z.u", "z.y -> u.u""#);
    let desk = Desk::with(&[("m.ron", &model)]);
    desk.call(&["run", "m.ron", "--out", "r"]);
    for (from, to, area, maximum, last) in [
        ("0 s", "5 s", 0.5, 1.0, 0.0),
        ("1.1 s", "5 s", 0.4, 1.0, 0.0),
        ("0.3 s", "1.2 s", 0.2, 1.0, 1.0),
        ("0.6 s", "1.4 s", 0.4, 1.0, 1.0),
        ("1.2 s", "1.4 s", 0.2, 1.0, 1.0),
        ("1.5 s", "5 s", 0.0, 0.0, 0.0),
        ("0.2 s", "0.9 s", 0.0, 0.0, 0.0),
    ] {
        let found = numbers(&desk, "r", &["--from", from, "--to", to]);
        assert_near(&found, "iae", area, 1e-9);
        assert_near(&found, "maximum_error", maximum, 1e-9);
        assert_near(&found, "final_error", last, 1e-9);
    }
    // What is straight between rows goes on to both ends: the square of a ramp from 0.25 to 0.75.
    let table = "time [s],a.set [m],a.actual [m]\n0,1,0\n1,1,1\n2,1,1\n";
    fs::write(desk.0.join("ramp.csv"), table).unwrap();
    let found = numbers(&desk, "ramp.csv", &["--from", "0.25", "--to", "0.75"]);
    assert_near(&found, "iae", 0.25, 1e-12);
    assert_near(&found, "maximum_error", 0.75, 1e-12);
}
