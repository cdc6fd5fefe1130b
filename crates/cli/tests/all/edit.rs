//! `blocksim edit`: texts that are changed as pictures are.

use std::fs;

use crate::desk::Desk;

const LOOP: &str = r#"// A loop. Try it: --set gain.k=3
Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {
        "demand": Step(time: "0.5 s", after: "90 deg"), // the target
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "6 1/s"),
        "angle": Integrator(),
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: [
        "demand.y -> error.u1, scope.set",
        "angle.y -> error.u2, scope.actual",
        "error.y -> gain.u",
        "gain.y -> angle.u",
    ],
)
"#;

fn desk() -> Desk {
    Desk::with(&[("loop.ron", LOOP)])
}

#[test]
fn a_block_is_renamed_and_the_difference_is_shown() {
    let desk = desk();
    let dry = desk.call(&["edit", "rename", "loop.ron", "gain", "amplifier", "--dry-run"]);
    assert_eq!((dry.code, dry.err.trim()), (Some(0), "nothing was written"));
    assert!(
        dry.out.contains("-        \"gain\": Gain(k: \"6 1/s\"),\n+        \"amplifier\": Gain"),
        "{}",
        dry.out
    );
    assert_eq!(desk.read("loop.ron"), LOOP);
    let done = desk.call(&["edit", "rename", "loop.ron", "gain", "amplifier"]);
    assert_eq!((done.code, done.err.trim()), (Some(0), "`gain` is `amplifier` now, in 4 places"));
    assert_eq!(desk.read("loop.ron"), LOOP.replace("gain", "amplifier"));
    let again = desk.call(&["edit", "rename", "loop.ron", "amplifier", "amplifier"]);
    assert_eq!((again.code, again.out.trim()), (Some(0), "`amplifier` has this name already"));
}

#[test]
fn what_is_against_a_change_is_explained_and_nothing_is_written() {
    let desk = desk();
    for (words, told) in [
        (&["rename", "loop.ron", "gain", "error"][..], "`error` is taken: it is a block at loop.ron:6"),
        (&["rename", "loop.ron", "gian", "x"], "there is no block `gian`"),
        (&["delete", "loop.ron", "nothing"], "there is no block `nothing`"),
        (&["connect", "loop.ron", "gain.y", "error.u1"], "`error.u1` is driven by `demand.y` already"),
        (&["connect", "loop.ron", "gain.y", "gain.v"], "`gain` has no port `v`"),
        (&["disconnect", "loop.ron", "gain.v"], "`gain` has no port `v`"),
        (&["add", "loop.ron", "Gian"], "there is no block kind `Gian`"),
        (&["add", "loop.ron", "Gain", "--with", "k"], "`k` is not a parameter with its value"),
        (&["add", "loop.ron", "Gain", "--with", "q=2"], "`Gain` has no parameter `q`"),
        (
            &["wrap", "loop.ron", "gain", "--name", "loop"],
            "there is a file `loop.ron` beside this one already",
        ),
        (&["rename", "missing.ron", "a", "b"], "cannot read `missing.ron`"),
    ] {
        let mut all = vec!["edit"];
        all.extend(words);
        let answer = desk.call(&all);
        assert!(answer.err.contains(told), "{words:?}: {}", answer.err);
        assert_ne!(answer.code, Some(0), "{words:?}");
        assert_eq!(desk.read("loop.ron"), LOOP);
    }
    fs::write(desk.0.join("loop.ron"), LOOP.replace("Diagram(", "Diagram((")).expect("a file");
    let answer = desk.call(&["edit", "delete", "loop.ron", "gain"]);
    assert!(answer.err.contains("first correct loop.ron:"), "{}", answer.err);
}

#[test]
fn blocks_are_added_connected_and_deleted() {
    let desk = desk();
    let added = desk.call(&["edit", "add", "loop.ron", "LowPass", "--into", "error.y", "--with", "tau=5 ms"]);
    assert_eq!(added.code, Some(0), "{}", added.err);
    let text = desk.read("loop.ron");
    assert!(text.contains("        \"low_pass\": LowPass(tau: \"5 ms\"),\n"), "{text}");
    assert!(text.contains("\"error.y -> low_pass.u\",\n        \"low_pass.y -> gain.u\","), "{text}");
    assert_eq!(desk.call(&["check", "loop.ron"]).code, Some(0));
    let gone = desk.call(&["edit", "delete", "loop.ron", "low_pass"]);
    assert!(gone.err.contains("not connected any more: `gain.u`"), "{}", gone.err);
    let joined = desk.call(&["edit", "connect", "loop.ron", "error.y", "gain.u"]);
    assert_eq!(joined.code, Some(0), "{}", joined.err);
    assert_eq!(desk.call(&["check", "loop.ron"]).code, Some(0));
    let apart = desk.call(&["edit", "disconnect", "loop.ron", "scope.set"]);
    assert!(apart.err.contains("`scope.set` disconnected"), "{}", apart.err);
}

#[test]
fn a_subsystem_around_blocks_runs_to_the_same_bits() {
    let desk = desk();
    let bits = |desk: &Desk, out: &str| {
        let run = desk.call(&["run", "loop.ron", "--out", out, "--quiet"]);
        assert_eq!(run.code, Some(0), "{}", run.err);
        desk.read(&format!("{out}/signals.csv"))
    };
    let before = bits(&desk, "before");
    let wrapped = desk.call(&["edit", "wrap", "loop.ron", "error", "gain", "angle", "--name", "plant"]);
    assert_eq!(wrapped.code, Some(0), "{}", wrapped.err);
    assert!(wrapped.out.contains("+++ plant.ron"), "{}", wrapped.out);
    assert!(desk.read("loop.ron").starts_with("// A loop. Try it: --set plant/gain.k=3\n"));
    assert_eq!(bits(&desk, "after"), before);
    // What its file says is changed there, and what several blocks share only when that is meant.
    let inside = desk.call(&["edit", "rename", "loop.ron", "plant/gain", "k"]);
    assert_eq!(inside.code, Some(0), "{}", inside.err);
    assert!(desk.read("plant.ron").contains("\"k\": Gain"));
    let twice = desk.read("loop.ron").replace(
        "\"plant\": Subsystem(file: \"plant.ron\"),",
        "\"plant\": Subsystem(file: \"plant.ron\"), \"other\": Subsystem(file: \"plant.ron\"),",
    );
    fs::write(desk.0.join("loop.ron"), twice).expect("a file");
    let shared = desk.call(&["edit", "delete", "loop.ron", "plant/k"]);
    assert!(shared.err.contains("2 blocks are made of `plant.ron`: `plant`, `other`"), "{}", shared.err);
    assert!(shared.err.contains("--all"), "{}", shared.err);
    assert_eq!(desk.call(&["edit", "delete", "loop.ron", "plant/k", "--all"]).code, Some(0));
}

/// `**` means the outputs of the new subsystem as well, which are no other signals.
#[test]
fn a_pattern_for_everything_does_not_stand_in_the_way_of_a_subsystem() {
    let model = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: { "s": Sine(amplitude: 1, frequency: 1), "g": Gain(k: 2), "i": Integrator },
    connections: ["s.y -> g.u", "g.y -> i.u"],
    record: ["RECORD"],
)
"#;
    let desk = Desk::with(&[
        ("all.ron", &model.replace("RECORD", "**")),
        ("some.ron", &model.replace("RECORD", "g.*")),
    ]);
    let wrapped = desk.call(&["edit", "wrap", "all.ron", "g", "--name", "sub"]);
    assert_eq!(wrapped.code, Some(0), "{}", wrapped.err);
    let run = desk.call(&["run", "all.ron", "--quiet", "--out", "run"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(desk.read("run/signals.csv").lines().next().is_some_and(|names| names.contains("sub/g.y")));
}
