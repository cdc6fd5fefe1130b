//! What is recorded of a run, how often, and what other programs get of it.

use std::fs;

use crate::desk::Desk;
use expect_test::expect;

/// A model of which some signals are recorded less often; `RECORD` stands for the entries.
const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "1 s", solver: Ode4(step: "1 ms")),
    record: [RECORD],
    blocks: {
        "wave": Sine(amplitude: 2, frequency: "3 Hz"),
        "lag": LowPass(tau: "50 ms"),
        "high": Compare(operator: Greater, constant: 0),
        "scope": Scope(inputs: ["wave", "lag"]),
        "truth": Scope(inputs: ["high"]),
    },
    connections: [
        "wave.y -> lag.u, high.u, scope.wave",
        "lag.y -> scope.lag",
        "high.y -> truth.high",
    ],
)
"#;

/// A desk with `m.ron`, which has these entries of `record`.
fn with(record: &str) -> Desk {
    Desk::with(&[("m.ron", &MODEL.replace("RECORD", record))])
}

/// Lines of each table of a run, without the headings.
fn rows(desk: &Desk, run: &str) -> Vec<(String, usize)> {
    let tables =
        desk.names(run).into_iter().filter(|name| name.starts_with("signals") && name.ends_with(".csv"));
    tables.map(|name| (name.clone(), desk.read(&format!("{run}/{name}")).lines().count() - 1)).collect()
}

#[test]
fn the_diagram_says_how_often_and_the_command_line_overrules_it() {
    let desk = with(r#"(signals: "scope.*", every: "10 ms"), (signals: "lag.*", rows: 100)"#);
    assert_eq!(desk.said(&["run", "m.ron", "--out", "a", "--quiet"]), "a\nexit code 0\n");
    let found = rows(&desk, "a");
    let of =
        |rows: &[(String, usize)], name: &str| rows.iter().find(|(known, _)| known == name).map(|row| row.1);
    assert_eq!(of(&found, "signals.csv"), Some(101), "{found:?}");
    assert_eq!(of(&found, "signals-100rows.csv"), Some(11), "{found:?}");
    assert!(of(&found, "signals-all.csv") >= Some(1001), "{found:?}");
    let manifest = fs::read_to_string(desk.0.join("a/manifest.json")).unwrap();
    let start = manifest.find("\"recorded\"").unwrap();
    let end = start + manifest[start..].find("\"started\"").unwrap();
    let plain: String = manifest[start..end].split_whitespace().collect();
    assert_eq!(
        plain,
        r#""recorded":{"bases":[{"rate":{"every":0.01},"signals":2},{"rate":"all","signals":1},{"rate":{"nth":100},"signals":1}]},"#
    );

    let said = desk.said(&["run", "m.ron", "--out", "b", "--quiet", "--signals", "scope@20ms"]);
    assert_eq!((said.as_str(), rows(&desk, "b")), ("b\nexit code 0\n", vec![("signals.csv".to_owned(), 51)]));
    let manifest = fs::read_to_string(desk.0.join("b/manifest.json")).unwrap();
    assert!(manifest.contains("\"scope@20ms\""), "{manifest}");
}

#[test]
fn what_cannot_be_recorded_is_told_with_place_and_remedy() {
    let desk = with(r#""lg.y", "scop*", (signals: "lag.y", every: "1.5 ms")"#);
    expect![[r#"
        error[unknown_signal]: no signal matches `lg.y`
         --> m.ron:3:14
          |
        3 |     record: ["lg.y", "scop*", (signals: "lag.y", every: "1.5 ms")],
          |              ^^^^^^ matches nothing
          |
          = help: did you mean `lag.y`?

        error[unknown_signal]: no signal matches `scop*`
         --> m.ron:3:22
          |
        3 |     record: ["lg.y", "scop*", (signals: "lag.y", every: "1.5 ms")],
          |                      ^^^^^^^ matches nothing
          |
          = help: did you mean `scop**`?

        error[record_rate]: `every` is 1.5 ms, which is not a multiple of the step, 1 ms
         --> m.ron:3:57
          |
        3 |     record: ["lg.y", "scop*", (signals: "lag.y", every: "1.5 ms")],
          |                                                         ^^^^^^^^ falls between the rows
          |
          = help: write `every: "2 ms"`, or change the step

        m.ron: 3 errors
        exit code 3
    "#]]
    .assert_eq(&desk.said(&["check", "m.ron"]));
    let desk = with("");
    expect![[r#"
        error[usage]: the rate of `scope`, 1.5 ms, is not a multiple of the step, 1 ms
          = help: write 2 ms, or a number of rows such as `scope@10rows`
        exit code 2
    "#]]
    .assert_eq(&desk.said(&["run", "m.ron", "--signals", "scope@1500us"]));
    expect![[r#"
        error[usage]: no recorded signal fits `scope.lg`
          = help: did you mean 'scope.lag'?
        exit code 2
    "#]]
    .assert_eq(&desk.said(&["run", "m.ron", "--signals", "scope.lg"]));
}

#[test]
fn a_parquet_file_is_written_for_each_rate_and_never_replaced() {
    let desk = with(r#"(signals: "scope.*", every: "10 ms")"#);
    assert_eq!(desk.said(&["run", "m.ron", "--out", "a", "--quiet"]), "a\nexit code 0\n");
    expect![[r#"
        a.parquet
        a-2.parquet
        3 signals of a
        exit code 0
    "#]]
    .assert_eq(&desk.said(&["export", "a", "--parquet", "a.parquet"]));
    for file in ["a.parquet", "a-2.parquet"] {
        let bytes = fs::read(desk.0.join(file)).unwrap();
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"), "{file}");
    }
    expect![[r#"
        error[unwritable]: cannot write `a.parquet`: a file of this name is in the way
          = help: name a file elsewhere
        exit code 4
    "#]]
    .assert_eq(&desk.said(&["export", "a", "--parquet", "a.parquet"]));
    expect![[r#"
        error[unwritable]: cannot write `none/a.parquet`: the folder does not exist
          = help: create it, or name a file elsewhere
        exit code 4
    "#]]
    .assert_eq(&desk.said(&["export", "a", "--parquet", "none/a.parquet"]));
}

#[test]
fn recordings_that_have_nothing_in_common_are_told() {
    let desk = with(r#"(signals: "scope.*", every: "10 ms")"#);
    assert_eq!(
        desk.said(&["run", "m.ron", "--out", "a", "--quiet", "--signals", "scope@10ms"]),
        "a\nexit code 0\n"
    );
    for (name, text) in [
        ("empty.csv", "time [s],scope.wave\n"),
        ("other.csv", "time [s],force [N]\n0,1\n1,1\n"),
        ("later.csv", "time [s],scope.wave,scope.lag\n5,1,1\n6,1,NaN\n"),
        ("broken.csv", "time [s],scope.wave\n0,1\n0.5,one\n"),
        ("back.csv", "time [s],scope.wave\n0,1\n-1,1\n"),
    ] {
        fs::write(desk.0.join(name), text).unwrap();
    }
    expect![[r#"
        error[unreadable]: `empty.csv` has no values
          = help: run the model, or export the table, again
        exit code 4
        error[usage]: `other.csv` has none of the requested signals
          = help: it has `force`; name them, such as --map 'force=scope.wave'
        exit code 2
        signal      verdict         maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        scope.wave  NO COMMON TIME                   -       -                     -         -         -        -
        scope.lag   NO COMMON TIME                   -       -                     -         -         -        -

        2 of 2 signals do not agree
        exit code 1
        error[unreadable]: cannot read `broken.csv`: line 3, column 2: `one` is not a number; leave the field empty for a missing one
          = help: correct the file, or export it again
        exit code 4
        error[unreadable]: cannot read `back.csv`: line 3, column 1: the time -1 follows 0; times must not fall
          = help: correct the file, or export it again
        exit code 4
    "#]]
    .assert_eq(
        &["empty.csv", "other.csv", "later.csv", "broken.csv", "back.csv"]
            .map(|name| desk.said(&["compare", "a", name]))
            .concat(),
    );
    // Of rows at other times those count that both have, if that is asked for.
    let rows: String = (0..51)
        .map(|k| {
            format!(
                "{},{},0\n",
                f64::from(k) * 0.02,
                (f64::from(k) * 0.12 * std::f64::consts::PI).sin() * 2.0
            )
        })
        .collect();
    fs::write(desk.0.join("half.csv"), format!("time [s],scope.wave,scope.lag\n{rows}")).unwrap();
    let compare = ["compare", "a", "half.csv", "-s", "scope.wave", "--abs", "1e-9"];
    assert!(desk.said(&compare).ends_with("exit code 1\n"));
    let said = desk.said(&[&compare[..], &["--sync", "intersection"]].concat());
    assert!(said.ends_with("exit code 0\n"), "{said}");
}
