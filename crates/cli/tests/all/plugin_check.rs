//! `blocksim plugin check`, and the script that grades a class with it.
#![cfg(unix)]

use std::fs;

use serde_json::Value;

use crate::desk::Desk;
use crate::support::root;

/// The controller that `plugin new` writes in C, with some of its text replaced.
fn controller(desk: &Desk, folder: &str, replaced: &[(&str, &str)]) {
    let made = desk.call(&["plugin", "new", folder, "--language", "c", "--kind", "Law"]);
    assert_eq!(made.code, Some(0), "{}", made.text());
    let path = desk.0.join(folder).join("controller.c");
    let text = fs::read_to_string(&path).expect("the source");
    let text = replaced.iter().fold(text, |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    });
    fs::write(path, text).expect("written");
}

const LAW: &str = "y[U] = limited(p, wanted(p, xd, u));";
const UPDATE: &str = "next[X] = xd[X] + p[KI] * p[TS] * u[E];";
const CHECK: &str = "    if (!(p[TS] > 0.0) || isinf(p[TS])) {";

#[test]
fn each_rule_that_is_broken_is_found() {
    let desk = Desk::with(&[]);
    let law = |code: &str| code.replace("LAW", LAW);
    let cases = [
        ("good", vec![], None),
        (
            "check",
            vec![(CHECK, "    return BLOCKSIM_ERROR;\n    if (!(p[TS] > 0.0) || isinf(p[TS])) {".to_owned())],
            Some("parameters"),
        ),
        ("beside", vec![(LAW, law("LAW y[1] = 0.0;"))], Some("runs")),
        ("crash", vec![(LAW, law("LAW if (t > 0.2) *(volatile int *)0 = 1;"))], Some("runs")),
        ("loop", vec![(LAW, law("LAW while (t > 0.2) ;"))], Some("runs")),
        ("nan", vec![(LAW, law("LAW if (t > 0.2) y[U] = sqrt(-1.0 - u[E] * u[E]);"))], Some("finite")),
        (
            "clock",
            vec![
                (LAW, law("LAW y[U] += 1e-9 * (double)(clock() + time(0)) + (double)(uintptr_t)&table;")),
                ("#include <math.h>", "#include <math.h>\n#include <time.h>\n#include <stdint.h>".to_owned()),
                (
                    "static double wanted",
                    "static const blocksim_plugin_table table;\nstatic double wanted".to_owned(),
                ),
            ],
            Some("repeatable"),
        ),
        (
            "memory",
            vec![(LAW, law("static double sum = 0.0; sum += u[E]; LAW y[U] += sum;"))],
            Some("stateless"),
        ),
        (
            "pointer",
            vec![(
                LAW,
                law(
                    "static const double *last = 0; LAW if (last && t > 0.2) y[U] += 0.0 * last[0]; last = u;",
                ),
            )],
            Some("pointers"),
        ),
        (
            "writer",
            vec![(LAW, law("static double *last = 0; LAW if (last && t > 0.2) last[0] = y[U]; last = y;"))],
            Some("pointers"),
        ),
        ("state", vec![(UPDATE, format!("{UPDATE} ((double *)xd)[0] = 0.0;"))], Some("runs")),
    ];
    for (name, replaced, broken) in cases {
        let replaced: Vec<(&str, &str)> = replaced.iter().map(|(old, new)| (*old, new.as_str())).collect();
        controller(&desk, name, &replaced);
        let answer = desk.call(&["plugin", "check", name, "--json", "--call-limit", "500ms"]);
        let examined: Value =
            serde_json::from_str(answer.out.trim()).unwrap_or_else(|_| panic!("{}", answer.text()));
        assert_eq!(answer.code, Some(i32::from(broken.is_some())), "{name}: {}", answer.text());
        assert_eq!(
            (examined["kind"].as_str(), examined["good"].as_bool()),
            (Some("Law"), Some(broken.is_none()))
        );
        let findings = examined["findings"].as_array().expect("findings");
        assert_eq!(findings.len(), 8, "{examined}");
        let failed = findings.iter().find(|finding| finding["verdict"] == "failed");
        let failed = failed.map(|finding| finding["rule"].as_str().expect("a rule").to_owned());
        assert_eq!(failed.as_deref(), broken, "{name}: {examined}");
        let time = examined["mean_step_time"].as_f64();
        assert_eq!(time.is_some(), !matches!(broken, Some("parameters" | "runs")), "{examined}");
        assert!(time.is_none_or(|time| time > 0.0 && time < 1e-3), "{examined}");
    }
    // Nothing of this was trusted but what `plugin new` has written.
    let text = desk.call(&["plugin", "check", "memory"]);
    assert!(text.out.contains("Law\n  passed   loads       memory 0.1.0\n"), "{}", text.out);
    assert!(text.out.contains("  failed   stateless   other results ("), "{}", text.out);
    for (words, code, expected) in [
        (&["plugin", "check", "good", "--set", "kp=2", "--set", "ts=20 ms"][..], 0, "us a step"),
        (&["plugin", "check", "good", "--set", "ts=-1"], 1, "`ts` is -1 s, it must be above zero"),
        (&["plugin", "check", "good", "--set", "kq=2"], 4, "`Law` has no parameter `kq`"),
        (&["plugin", "check", "good", "--block", "Lew"], 4, "did you mean `Law`"),
        (&["plugin", "check", "goot"], 4, "did you mean `good`"),
        (&["plugin", "check", "good", "--set", "kp"], 2, "write NAME=VALUE"),
    ] {
        let answer = desk.call(words);
        assert_eq!(answer.code, Some(code), "{words:?}: {}", answer.text());
        assert!(answer.text().contains(expected), "{words:?}: {}", answer.text());
    }
}

#[test]
fn the_script_of_the_guide_grades_a_class() {
    let desk = Desk::with(&[]);
    fs::create_dir(desk.0.join("students")).expect("a folder");
    for (name, old, new) in [
        ("ada", LAW, LAW),
        ("bob", LAW, "y[U] = 1.0 / (t > 0.2 ? 0.0 : 1.0);"),
        ("cem", LAW, "y[U] = limited(p, wanted(p, xd, u))"),
        ("dan", LAW, "for (;;) ;"),
        ("eva", LAW, "y[U] = *(volatile double *)0;"),
    ] {
        controller(&desk, &format!("students/{name}"), &[(old, new)]);
    }
    fs::copy(desk.0.join("students/ada/demo.ron"), desk.0.join("loop.ron")).expect("a loop");
    let page = fs::read_to_string(root().join("docs/grading.md")).expect("the page");
    let section = page.split("## The script\n").nth(1).expect("the section");
    let script = section.split("```sh\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a script");
    let output =
        desk.script(&format!("blocksim() {{ \"$blocksim\" \"$@\"; }}\n{script}")).output().expect("a shell");
    assert!(output.status.success(), "{output:?}");
    let grades = desk.read("grades.csv");
    let lines: Vec<&str> = grades.lines().collect();
    assert_eq!(lines.len(), 5, "{grades}");
    let error: f64 =
        lines[0].strip_prefix("ada,0,0,").and_then(|error| error.parse().ok()).unwrap_or(f64::NAN);
    assert!(error.abs() < 0.01, "{grades}");
    for (line, expected) in lines[1..].iter().zip(["bob,1,1,", "cem,4,3,", "dan,1,1,", "eva,1,1,"]) {
        assert!(line.starts_with(expected), "{grades}");
    }
    assert!(desk.read("graded/bob/signals.csv").lines().count() > 20, "what bob's loop did is kept");
}
