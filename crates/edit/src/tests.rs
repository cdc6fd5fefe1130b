//! Changes of small models.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use blocksim_block::problem::Severity;
use blocksim_blocks as _;
use blocksim_diagram::{Reader, Trees};

use super::*;

/// Files in memory.
#[derive(Debug, Clone)]
struct Texts(BTreeMap<PathBuf, String>);

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.0.get(path).cloned().ok_or_else(|| "there is no such file".to_owned())
    }
}

impl Texts {
    fn of(files: &[(&str, &str)]) -> Texts {
        Texts(files.iter().map(|(name, text)| (PathBuf::from(name), (*text).to_owned())).collect())
    }

    fn try_it<T>(&self, what: impl FnOnce(&Project) -> T) -> T {
        let all: BTreeSet<PathBuf> = self.0.keys().cloned().collect();
        let others = |_: &[PathBuf]| all.clone();
        what(&Project { reader: self, model: Path::new("m.ron"), others: &others, shared: false })
    }

    /// The texts with a change.
    fn with(&self, change: &Change) -> Texts {
        let mut new = self.clone();
        for text in &change.texts {
            assert_eq!(new.0.get(&text.path), text.old.as_ref(), "{}", text.path.display());
            new.0.insert(text.path.clone(), text.new.clone());
        }
        new
    }

    fn text(&self, name: &str) -> &str {
        &self.0[Path::new(name)]
    }
}

const SERVO: &str = r#"// Try it: --set gain.k=3, or --set top/gain.k=4.
Diagram(
    parameters: { "k": "6 1/s" },
    simulation: (stop_time: "2 s", atol: {"angle": 1e-9}),
    blocks: {
        // What is to be reached.
        "demand": Step(time: "0.5 s", after: "90 deg"), // the target
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "k"),
        "angle": Integrator(),

        // To look at.
        "scope": Scope(inputs: ["set", "actual"], display: "deg"),
    },
    connections: [
        "demand.y -> error.u1, scope.set",
        "angle.y -> error.u2, scope.actual", // feedback
        "error.y -> gain.u",
        "gain.y -> angle.u",
    ],
    record: ["gain.y", (signals: "error.y", every: "10 ms")],
)
"#;

fn servo() -> Texts {
    Texts::of(&[("m.ron", SERVO)])
}

#[test]
fn a_block_is_renamed_wherever_it_is_named() {
    let texts = servo();
    let change = texts.try_it(|p| rename(p, "gain", "amplifier")).expect("a name");
    let new = SERVO
        .replace("--set gain.k", "--set amplifier.k")
        .replace("\"gain\": Gain", "\"amplifier\": Gain")
        .replace("gain.u", "amplifier.u")
        .replace("gain.y", "amplifier.y")
        .replace("--set top/amplifier.k=4", "--set top/gain.k=4");
    assert_eq!(texts.with(&change).text("m.ron"), new);
    assert_eq!(change.summary, "`gain` is `amplifier` now, in 5 places");
    assert_eq!(change.block.as_deref(), Some("amplifier"));
    let back = texts.with(&change).try_it(|p| rename(p, "amplifier", "gain")).expect("a name");
    assert_eq!(texts.with(&change).with(&back).text("m.ron"), SERVO);
    assert_eq!(texts.try_it(|p| rename(p, "gain", "gain")).expect("itself").texts, []);
    for (old, new, reason) in [
        ("gain", "angle", "`angle` is taken: it is a block at m.ron:10"),
        ("gain", "2nd", "`2nd` is not a valid name"),
        ("gain", "in", "`in` is not a valid name"),
        ("gain", "größe", "`größe` is not a valid name"),
        ("gain", "", "`` is not a valid name"),
        ("nothing", "a", "there is no block `nothing`"),
        ("gain/inner", "a", "`gain` is not a subsystem"),
        ("", "a", "there is no block ``"),
        ("gain.u", "v", "the ports of a block have the names that its kind gives them"),
    ] {
        let refusal = texts.try_it(|p| rename(p, old, new)).expect_err(new);
        assert!(refusal.message.starts_with(reason), "{old} {new}: {refusal:?}");
    }
}

#[test]
fn a_block_goes_with_its_wires_and_what_names_it() {
    let texts = servo();
    let change = texts.try_it(|p| delete(p, &["gain".to_owned()])).expect("a block");
    let new = SERVO
        .replace("        \"gain\": Gain(k: \"k\"),\n", "")
        .replace("        \"error.y -> gain.u\",\n        \"gain.y -> angle.u\",\n", "")
        .replace("\"gain.y\", (", "(");
    assert_eq!(texts.with(&change).text("m.ron"), new);
    assert_eq!(change.summary, "`gain` deleted");
    assert_eq!(
        change.notes,
        ["not connected any more: `angle.u`", "an entry of `record` was removed as well"]
    );
    let two = texts.try_it(|p| delete(p, &["demand".to_owned(), "angle".to_owned()])).expect("blocks");
    let new = texts.with(&two);
    let new = new.text("m.ron");
    assert!(!new.contains("the target") && new.contains("// What is to be reached."), "{new}");
    assert!(!new.contains("// feedback") && new.contains("atol: {}"), "{new}");
    assert_eq!(two.notes[0], "not connected any more: `error.u1`, `error.u2`, `scope.actual`, `scope.set`");
    assert!(texts.try_it(|p| delete(p, &["none".to_owned()])).is_err());
    assert!(texts.try_it(|p| delete(p, &[])).is_err());
}

/// The servo with a panel of its own, and a model that has the servo in it and turns the same gain.
fn with_panels() -> Texts {
    let panel = r#"
    panel: [
        Slider(target: "gain.k", range: "0 1/s .. 9 1/s", label: "gain"),
        Knob("k", "0 1/s .. 9 1/s"),
        Lamp("gain.y"), // at work
        Gauge(signal: "angle.y", range: "0 deg .. 90 deg"),
    ],
"#;
    let inside = SERVO
        .replace("Diagram(", "Diagram(\n    inputs: {\"off\": ()},")
        .replace("\"k\": \"6 1/s\"", "\"k\": 6")
        .replace("    simulation: (stop_time: \"2 s\", atol: {\"angle\": 1e-9}),\n", "");
    let top = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "none": Constant(value: 0),
        "servo": Subsystem(file: "inside.ron"),
    },
    connections: ["none.y -> servo.off"],
    panel: [Slider("servo/gain.k", "0 .. 9"), Lamp("servo/gain.y"), Gauge("servo/angle.y", "0 .. 2")],
)
"#;
    let end = SERVO.rfind(")\n").expect("an end");
    Texts::of(&[
        ("m.ron", &format!("{}{panel})\n", &SERVO[..end])),
        ("top.ron", top),
        ("inside.ron", &inside),
    ])
}

#[test]
fn panels_follow_what_they_turn_and_show() {
    let texts = with_panels();
    let errors = |texts: &Texts, model: &str| {
        let sources = blocksim_diagram::Sources::new(texts);
        let compiled = blocksim_diagram::compile(&sources, Path::new(model), &[]);
        let errors = compiled.problems.iter().filter(|one| one.severity == Severity::Error);
        errors.map(|one| one.message.clone()).collect::<Vec<_>>()
    };
    assert_eq!(errors(&texts, "m.ron"), [""; 0]);
    assert_eq!(errors(&texts, "top.ron"), [""; 0]);
    let before = texts.text("m.ron").to_owned();

    // Another name for the block, and for the parameter of the diagram.
    let new = texts.with(&texts.try_it(|p| rename(p, "gain", "amplifier")).expect("a name"));
    assert_eq!(errors(&new, "m.ron"), [""; 0]);
    let text = new.text("m.ron");
    assert!(
        text.contains(r#"Slider(target: "amplifier.k", range: "0 1/s .. 9 1/s", label: "gain")"#),
        "{text}"
    );
    assert!(text.contains(r#"Lamp("amplifier.y"), // at work"#), "{text}");
    let back = new.with(&new.try_it(|p| rename(p, "amplifier", "gain")).expect("a name"));
    assert_eq!(back.text("m.ron"), before);
    let at = before.find("\"k\":").expect("a parameter") + 1;
    let renaming = texts.try_it(|p| renamed(p, &Trees::default(), Path::new("m.ron"), at, "speed"));
    let Ok(renaming) = renaming else { panic!("a name") };
    let all = renaming.texts("speed");
    let text = &all[Path::new("m.ron")];
    assert!(text.contains(r#"Knob("speed""#) && text.contains(r#"Slider(target: "gain.k""#), "{text}");

    // Without the block its elements mean nothing.
    let change = texts.try_it(|p| delete(p, &["gain".to_owned()])).expect("a block");
    let text = texts.with(&change).text("m.ron").to_owned();
    assert!(!text.contains("\"gain") && !text.contains("at work"), "{text}");
    assert!(text.contains(r#"Knob("k""#) && text.contains(r#"Gauge(signal: "angle.y""#), "{text}");
    assert_eq!(change.notes[1], "3 entries of `panel` and `record` were removed as well");

    // In a subsystem it is named by its path.
    let both = ["gain".to_owned(), "angle".to_owned()];
    let texts = Texts::of(&[("m.ron", &before.replace("Gain(k: \"k\")", "Gain(k: \"6 1/s\")"))]);
    let new = texts.with(&texts.try_it(|p| wrap(p, &both, "drive")).expect("blocks"));
    assert_eq!(errors(&new, "m.ron"), [""; 0]);
    let text = new.text("m.ron");
    assert!(
        text.contains(r#"Slider(target: "drive/gain.k", range: "0 1/s .. 9 1/s", label: "gain")"#),
        "{text}"
    );
    assert!(
        text.contains(r#"Lamp("drive/gain.y")"#) && text.contains(r#"signal: "drive/angle.y""#),
        "{text}"
    );
    assert!(text.contains(r#"Knob("k""#), "{text}");
}

/// A block that bears the name of a parameter has what the parameter does not have, in panels and in comments.
#[test]
fn panels_and_comments_name_a_block_that_bears_the_name_of_a_parameter() {
    let text = r#"// Try --set lag.k=3 or --set lag="3 s" or --set lag.after=1
Diagram(
    parameters: { "lag": "2 s", "one": (after: 3) },
    blocks: {
        "lag": Step(after: 2), "one": Gain(k: "one.after"), "two": Gain(k: 4), "dead": TransportDelay(delay: "lag"),
    },
    connections: ["lag.y -> one.u, two.u", "one.y -> dead.u"],
    panel: [Slider("lag.after", "0 .. 3"), Knob("lag", "1 s .. 4 s"), Slider("one.after", "0 .. 9"), Slider("two.k", "0 .. 9")],
    record: ["lag.y", "two.y", "dead.y"],
)
"#;
    let texts = Texts::of(&[("m.ron", text)]);
    let new = texts.with(&texts.try_it(|p| rename(p, "lag", "start")).expect("a name"));
    let expected = text
        .replace("\"lag\": Step", "\"start\": Step")
        .replace("lag.y", "start.y")
        .replace("lag.after", "start.after")
        .replace("lag.k", "start.k");
    assert_eq!(new.text("m.ron"), expected);
    // The member of the parameter comes first, and would take what the panel turns.
    let new = texts.with(&texts.try_it(|p| rename(p, "one", "other")).expect("a name"));
    assert!(new.text("m.ron").contains("Slider(\"one.after\""), "{}", new.text("m.ron"));
    let swapped =
        Texts::of(&[("m.ron", &text.replace("(after: 3)", "(k: 3)").replace("one.after", "one.k"))]);
    let taken = swapped.try_it(|p| rename(p, "one", "other")).map(|change| swapped.with(&change));
    let taken =
        taken.expect("a name").try_it(|p| rename(p, "two", "one")).expect_err("the parameter has `k`");
    assert!(taken.message.contains("would stand for something else"), "{taken:?}");
    // In a subsystem it is named by its path.
    let new = texts.with(&texts.try_it(|p| wrap(p, &["lag".to_owned()], "source")).expect("a block"));
    let text = new.text("m.ron");
    assert!(text.contains("Slider(\"source/lag.after\"") && text.contains("Knob(\"lag\""), "{text}");
    assert!(text.contains("--set source/lag.after=1") && text.contains("--set lag=\"3 s\""), "{text}");
}

/// A file inside is changed from the model around it, whose panel names what is inside.
#[test]
fn panels_of_models_around_follow_as_well() {
    let texts = with_panels();
    let all: BTreeSet<PathBuf> = texts.0.keys().cloned().collect();
    let others = |_: &[PathBuf]| all.clone();
    let top = Project { reader: &texts, model: Path::new("top.ron"), others: &others, shared: false };
    let new = texts.with(&rename(&top, "servo/gain", "amplifier").expect("a name"));
    let panel = r#"[Slider("servo/amplifier.k", "0 .. 9"), Lamp("servo/amplifier.y"), Gauge("servo/angle.y", "0 .. 2")]"#;
    assert!(new.text("top.ron").contains(panel), "{}", new.text("top.ron"));
    let change = delete(&top, &["servo/gain".to_owned()]).expect("a block");
    let panel = r#"panel: [Gauge("servo/angle.y", "0 .. 2")]"#;
    assert!(texts.with(&change).text("top.ron").contains(panel), "{}", texts.with(&change).text("top.ron"));
    let new = texts.with(&wrap(&top, &["servo/angle".to_owned()], "motor").expect("a block"));
    assert!(
        new.text("top.ron").contains(r#"Gauge("servo/motor/angle.y", "0 .. 2")"#),
        "{}",
        new.text("top.ron")
    );
}

#[test]
fn wires_go_and_come() {
    let texts = servo();
    let apart = texts.try_it(|p| disconnect_end(p, "gain.u")).expect("a wire");
    assert_eq!(texts.with(&apart).text("m.ron"), SERVO.replace("        \"error.y -> gain.u\",\n", ""));
    assert_eq!(apart.notes, ["not connected any more: `gain.u`"]);
    let again = texts.with(&apart).try_it(|p| connect(p, "gain.u", "error.y")).expect("ports");
    let expected = SERVO.replace(
        "        \"error.y -> gain.u\",\n        \"gain.y -> angle.u\",\n",
        "        \"gain.y -> angle.u\",\n        \"error.y -> gain.u\",\n",
    );
    assert_eq!(texts.with(&apart).with(&again).text("m.ron"), expected);
    // Twice is once.
    assert_eq!(texts.try_it(|p| connect(p, "error.y", "gain.u")).expect("ports").texts, []);
    // One more target of a source.
    let one = texts.try_it(|p| disconnect_end(p, "scope.set")).expect("a wire");
    assert_eq!(texts.with(&one).text("m.ron"), SERVO.replace(", scope.set", ""));
    let other = texts.with(&one).try_it(|p| connect(p, "gain.y", "scope.set")).expect_err("units");
    assert!(other.message.contains("deg") && other.message.contains("rad/s"), "{other:?}");
    let back = texts.with(&one).try_it(|p| connect(p, "demand.y", "scope.set")).expect("ports");
    assert_eq!(texts.with(&one).with(&back).text("m.ron"), SERVO);
    for (from, to, reason) in [
        ("gain.y", "error.u1", "`error.u1` is driven by `demand.y` already"),
        ("gain.u", "error.u1", "`gain.u` and `error.u1` are both inputs"),
        ("gain.y", "error.y", "`gain.y` and `error.y` are both outputs"),
        ("gain.q", "error.u1", "`gain` has no port `q`"),
        ("gain", "error.u1", "`gain` does not name a port"),
        ("in.x", "error.u1", "this diagram has no input `x`"),
        ("a/gain.y", "error.u1", "the ports are of different diagrams"),
    ] {
        let refusal = texts.try_it(|p| connect(p, from, to)).expect_err(to);
        assert!(refusal.message.starts_with(reason), "{from} {to}: {refusal:?}");
    }
    assert!(texts.try_it(|p| disconnect_end(p, "gain.q")).is_err());
}

#[test]
fn a_block_is_added_beside_another_or_into_a_wire() {
    let texts = servo();
    let new = NewBlock { kind: "LowPass", beside: "gain", ..NewBlock::default() };
    let change = texts.try_it(|p| add(p, &new)).expect("a block");
    let text = texts.with(&change).text("m.ron").to_owned();
    assert!(text.contains("\"gain\": Gain(k: \"k\"),\n        \"low_pass\": LowPass(tau: "), "{text}");
    assert_eq!(change.notes, ["not connected yet: `low_pass.u`"]);
    let into = ["error.y".to_owned()];
    let parameters = [("k".to_owned(), "k / 3 1/s".to_owned())];
    let new =
        NewBlock { kind: "Gain", name: "half", into: &into, parameters: &parameters, ..NewBlock::default() };
    let change = texts.try_it(|p| add(p, &new)).expect("a block");
    let expected = SERVO
        .replace("\"+-\"),\n", "\"+-\"),\n        \"half\": Gain(k: \"k / 3 1/s\"),\n")
        .replace("\"error.y -> gain.u\"", "\"error.y -> half.u\",\n        \"half.y -> gain.u\"");
    assert_eq!(texts.with(&change).text("m.ron"), expected);
    assert!(change.notes.is_empty(), "{change:?}");
    // Into one branch of a wire.
    let into = ["angle.y".to_owned(), "scope.actual".to_owned()];
    let new = NewBlock { kind: "Gain", into: &into, ..NewBlock::default() };
    let change = texts.try_it(|p| add(p, &new)).expect("a block");
    let text = texts.with(&change).text("m.ron").to_owned();
    let expected = "\"angle.y -> error.u2, gain2.u\", // feedback\n        \"gain2.y -> scope.actual\",";
    assert!(text.contains(expected), "{text}");
    // What only looks hangs on the wire.
    let into = ["error.y".to_owned()];
    let new = NewBlock { kind: "Terminator", into: &into, ..NewBlock::default() };
    let change = texts.try_it(|p| add(p, &new)).expect("a block");
    assert!(texts.with(&change).text("m.ron").contains("\"error.y -> gain.u, terminator.u\""));
    let parameters = [("k".to_owned(), "3 furlongs".to_owned())];
    for (new, reason) in [
        (NewBlock { kind: "Gian", ..NewBlock::default() }, "there is no block kind `Gian`"),
        (NewBlock { kind: "Gain", name: "angle", ..NewBlock::default() }, "there is a block `angle` already"),
        (NewBlock { kind: "Gain", name: "a b", ..NewBlock::default() }, "`a b` is not a valid name"),
        (NewBlock { kind: "Gain", level: "x", ..NewBlock::default() }, "there is no block `x`"),
        (NewBlock { kind: "Subsystem", ..NewBlock::default() }, "`Subsystem` needs `file`"),
        (NewBlock { kind: "Constant", into: &into, ..NewBlock::default() }, "`constant` has no input"),
        (NewBlock { kind: "Gain", parameters: &parameters, ..NewBlock::default() }, ""),
    ] {
        let refusal = texts.try_it(|p| add(p, &new)).expect_err(reason);
        assert!(refusal.message.starts_with(reason) && !refusal.message.is_empty(), "{new:?}: {refusal:?}");
    }
}

const CIRCUIT: &str = r#"Diagram(
    blocks: {
        "source": DcVoltageSource(v: "10 V"),
        "r": Resistor(r: "5 ohm"),
        "l": Inductor(l: "1 mH"),
        "ground": ElectricalReference,
    },
    connections: [
        "source.p <-> r.p",
        "r.n <-> l.p",
        "l.n <-> source.n <-> ground.p",
    ],
)
"#;

#[test]
fn two_pins_go_into_a_circuit_in_series_and_others_hang_on_it() {
    let texts = Texts::of(&[("m.ron", CIRCUIT)]);
    let into = ["r.n".to_owned(), "l.p".to_owned()];
    let new = NewBlock { kind: "Resistor", into: &into, ..NewBlock::default() };
    let change = texts.try_it(|p| add(p, &new)).expect("a block");
    let text = texts.with(&change).text("m.ron").to_owned();
    assert!(text.contains("\"r.n <-> resistor.p\",\n        \"resistor.n <-> l.p\","), "{text}");
    let into = ["l.n".to_owned(), "source.n".to_owned()];
    let new = NewBlock { kind: "Resistor", into: &into, ..NewBlock::default() };
    let text = texts.with(&texts.try_it(|p| add(p, &new)).expect("a block")).text("m.ron").to_owned();
    assert!(
        text.contains("\"l.n <-> resistor.p <-> ground.p\",\n        \"resistor.n <-> source.n\","),
        "{text}"
    );
    let into = ["l.n".to_owned()];
    let new = NewBlock { kind: "VoltageSensor", into: &into, ..NewBlock::default() };
    let text = texts.with(&texts.try_it(|p| add(p, &new)).expect("a block")).text("m.ron").to_owned();
    assert!(text.contains("ground.p <-> voltage_sensor.p\""), "{text}");
    let new = NewBlock { kind: "Inertia", into: &into, ..NewBlock::default() };
    let refusal = texts.try_it(|p| add(p, &new)).expect_err("another domain");
    assert!(refusal.message.contains("has no electrical port"), "{refusal:?}");
    // A port leaves, and the rest stays joined.
    let change = texts.try_it(|p| delete(p, &["source".to_owned()])).expect("a block");
    assert!(
        texts
            .with(&change)
            .text("m.ron")
            .contains("connections: [\n        \"r.n <-> l.p\",\n        \"l.n <-> ground.p\",\n    ]")
    );
    assert_eq!(change.notes, ["not connected any more: `r.p`"]);
    let refusal = texts.try_it(|p| connect(p, "r.p", "source.q")).expect_err("no port");
    assert!(refusal.help.is_some());
    assert_eq!(texts.try_it(|p| connect(p, "l.n", "ground.p")).expect("joined").texts, []);
}

/// Two connections make one node, by way of `r2.p`.
const NODE: &str = r#"Diagram(
    ports: { "out": "r4.p" },
    blocks: {
        "v": VoltageSource(v: "5 V"),
        "r1": Resistor(r: "1 ohm"),
        "r2": Resistor(r: "1 ohm"),
        "r3": Resistor(r: "1 ohm"),
        "r4": Resistor(r: "1 ohm"),
    },
    connections: [
        "r1.n <-> r2.p <-> v.p", // one
        "r2.p <-> r3.p <-> r4.p", // other
        "v.n <-> r2.n",
    ],
)
"#;

#[test]
fn what_is_put_into_a_node_of_several_connections_leaves_the_rest_of_it_together() {
    let texts = Texts::of(&[("m.ron", NODE)]);
    let with = |kind, into: &[&str]| {
        let into: Vec<String> = into.iter().map(|end| (*end).to_owned()).collect();
        texts.try_it(|p| add(p, &NewBlock { kind, name: "i", into: &into, ..NewBlock::default() }))
    };
    let between = |into: &[&str]| {
        let change = with("CurrentSensor", into).expect("a node");
        let text = texts.with(&change).text("m.ron").to_owned();
        let new = text.split_once("connections: [").expect("connections").1.to_owned();
        let lines = new.lines().filter_map(|line| line.trim().strip_prefix('"')?.split_once('"'));
        let all: Vec<String> = lines.map(|(connection, _)| connection.to_owned()).collect();
        (all, text.contains("\"out\": \"r4.p\""))
    };
    let one = ["r1.n <-> i.p <-> v.p", "i.n <-> r2.p", "i.p <-> r3.p <-> r4.p", "v.n <-> r2.n"];
    for from in ["r1.n", "r3.p", "v.p", "r4.p", "out.out"] {
        assert_eq!(between(&[from, "r2.p"]), (one.map(str::to_owned).to_vec(), true), "{from}");
    }
    // Those that go to the other side stay joined there; what is handed outward stays unless it is named.
    let some = ["r1.n <-> i.p <-> v.p", "i.n <-> r2.p", "r2.p <-> r3.p <-> r4.p", "v.n <-> r2.n"];
    assert_eq!(
        between(&["v.p", "r2.p", "r4.p", "r3.p", "out.out"]),
        (some.map(str::to_owned).to_vec(), true)
    );
    assert!(!between(&["v.p", "r2.p", "r4.p", "r3.p"]).1);
    for (kind, into, reason) in [
        ("Resistor", &["r1.n", "v.n"][..], "`v.n` is not joined to `r1.n`"),
        ("ElectricalReference", &["r1.n", "v.n"], "`v.n` is not joined to `r1.n`"),
        ("Resistor", &["r1.p", "out.out"], "`out.out` is not joined to `r1.p`"),
        ("Resistor", &["r1.n", "r1.n"], "`r1.n` cannot be on both sides of `i`"),
    ] {
        let refusal = with(kind, into).expect_err(reason);
        assert_eq!((refusal.message.as_str(), refusal.help.is_some()), (reason, true), "{into:?}");
    }
}

#[test]
fn a_port_that_is_handed_outward_is_connected_without_a_wire() {
    let texts = Texts::of(&[("m.ron", NODE)]);
    let notes = |end: &str| texts.try_it(|p| disconnect_end(p, end)).expect("a wire").notes;
    assert_eq!(notes("r4.p"), [""; 0]);
    assert_eq!(notes("v.n"), ["not connected any more: `r2.n`, `v.n`"]);
}

#[test]
fn what_is_put_into_a_wire_takes_the_targets_that_its_source_drives() {
    let text = r#"Diagram(
    outputs: { "y": "a.y", "z": "b.y" },
    blocks: { "a": Gain(k: 1), "b": Gain(k: 1), "c": Gain(k: 1), "d": Gain(k: 1), "e": Gain(k: 1) },
    connections: [
        "a.y -> b.u, c.u", // one
        "a.y -> d.u", // other
        "b.y -> e.u",
    ],
)
"#;
    let texts = Texts::of(&[("m.ron", text)]);
    let with = |kind, into: &[&str]| {
        let into: Vec<String> = into.iter().map(|end| (*end).to_owned()).collect();
        let change =
            texts.try_it(|p| add(p, &NewBlock { kind, name: "n", into: &into, ..NewBlock::default() }));
        change.map(|change| texts.with(&change).text("m.ron").to_owned())
    };
    let all = with("Abs", &["a.y"]).expect("a wire");
    let lines = "\"a.y -> n.u\", // one\n        \"n.y -> b.u, c.u\",\n        \"n.y -> d.u\", // other\n";
    assert!(all.contains(lines) && all.contains("\"y\": \"n.y\", \"z\": \"b.y\""), "{all}");
    for (kind, into, reason) in [
        ("Abs", ["a.y", "e.u"], "`a.y` does not drive `e.u`"),
        ("Terminator", ["a.y", "e.u"], "`a.y` does not drive `e.u`"),
        ("Abs", ["a.y", "out.z"], "`a.y` does not drive `out.z`"),
    ] {
        let refusal = with(kind, &[&into[..], &["c.u"]].concat()).expect_err(reason);
        assert_eq!(refusal.message, reason);
    }
}

#[test]
fn blocks_become_a_subsystem_with_ports_for_the_wires_that_cross_the_border() {
    let texts = servo();
    let blocks = ["error", "gain", "angle"].map(str::to_owned);
    let change = texts.try_it(|p| wrap(p, &blocks, "loop")).expect("blocks");
    let new = texts.with(&change);
    assert_eq!(
        new.text("loop.ron"),
        r#"Diagram(
    inputs: { "demand": () },
    outputs: { "angle": "angle.y" },
    blocks: {
        "error": Sum(signs: "+-"),
        "gain": Gain(k: "k"),
        "angle": Integrator(),
    },
    connections: ["in.demand -> error.u1", "angle.y -> error.u2", "error.y -> gain.u", "gain.y -> angle.u"],
)
"#
        .replace("connections: [\"in.demand -> error.u1\", \"angle.y -> error.u2\", \"error.y -> gain.u\", \"gain.y -> angle.u\"],",
            "connections: [\n        \"in.demand -> error.u1\",\n        \"angle.y -> error.u2\",\n        \"error.y -> gain.u\",\n        \"gain.y -> angle.u\",\n    ],")
    );
    let expected = SERVO
        .replace("--set gain.k", "--set loop/gain.k")
        .replace("\"angle\": 1e-9", "\"loop/angle\": 1e-9")
        .replace("\"error\": Sum(signs: \"+-\")", "\"loop\": Subsystem(file: \"loop.ron\")")
        .replace("        \"gain\": Gain(k: \"k\"),\n        \"angle\": Integrator(),\n", "")
        .replace("error.u1, ", "loop.demand, ")
        .replace("angle.y -> error.u2, ", "loop.angle -> ")
        .replace("        \"error.y -> gain.u\",\n        \"gain.y -> angle.u\",\n", "")
        .replace("\"gain.y\", (signals: \"error.y\"", "\"loop/gain.y\", (signals: \"loop/error.y\"");
    assert_eq!(new.text("m.ron"), expected);
    assert_eq!(change.summary, "3 blocks are in the subsystem `loop` now, of `loop.ron`");
    // What is within a file of its own is changed there.
    let change = new.try_it(|p| rename(p, "loop/gain", "k1")).expect("a name");
    assert!(new.with(&change).text("loop.ron").contains("\"k1\": Gain"));
    assert!(new.with(&change).text("m.ron").contains("\"loop/k1.y\""));
    for (blocks, name, reason) in [
        (&["error"][..], "angle", "there is a block `angle` already"),
        (&["error"], "m", "there is a file `m.ron` beside this one already"),
        (&["error"], "a/b", "`a/b` is not a valid name"),
        (&["nothing"], "a", "there is no block `nothing`"),
        (&[], "a", "no block is named"),
    ] {
        let blocks: Vec<String> = blocks.iter().map(|name| (*name).to_owned()).collect();
        let refusal = texts.try_it(|p| wrap(p, &blocks, name)).expect_err(reason);
        assert!(refusal.message.starts_with(reason), "{refusal:?}");
    }
}

#[test]
fn a_part_of_a_circuit_becomes_a_subsystem_with_conserving_ports() {
    let texts = Texts::of(&[("m.ron", CIRCUIT)]);
    for (blocks, outside, inside) in [
        (
            &["r", "l"][..],
            "\"source.p <-> load.p\",\n        \"load.n <-> source.n <-> ground.p\",",
            "\"r.n <-> l.p\"",
        ),
        (
            &["source", "ground"],
            "\"load.p <-> r.p\",\n        \"r.n <-> l.p\",\n        \"l.n <-> load.n\",",
            "\"source.n <-> ground.p\"",
        ),
    ] {
        let blocks: Vec<String> = blocks.iter().map(|name| (*name).to_owned()).collect();
        let change = texts.try_it(|p| wrap(p, &blocks, "load")).expect("blocks");
        let new = texts.with(&change);
        assert!(new.text("m.ron").contains(outside), "{}", new.text("m.ron"));
        assert!(new.text("load.ron").contains(inside), "{}", new.text("load.ron"));
    }
}

const PART: &str = r#"Diagram(
    inputs: { "u": () },
    outputs: { "y": "half.y" },
    blocks: {
        "half": Gain(k: 0.5),
        "unused": Terminator,
    },
    connections: [
        "in.u -> half.u, unused.u",
    ],
)
"#;

fn two_parts() -> Texts {
    let top = r#"Diagram(
    blocks: {
        "one": Subsystem(file: "part.ron"),
        "two": Subsystem(file: "part.ron"),
        "c": Constant(value: 1),
        "show": Scope(inputs: ["a", "b"]),
    },
    connections: ["c.y -> one.u, two.u", "one.y -> show.a", "two.y -> show.b"],
)
"#;
    Texts::of(&[("m.ron", top), ("part.ron", PART)])
}

#[test]
fn a_file_that_several_blocks_share_changes_only_when_that_is_meant() {
    let texts = two_parts();
    let refusal = texts.try_it(|p| delete(p, &["one/unused".to_owned()])).expect_err("shared");
    assert_eq!(refusal.message, "2 blocks are made of `part.ron`: `one`, `two`");
    let change =
        texts.try_it(|p| delete(&Project { shared: true, ..*p }, &["one/unused".to_owned()])).expect("meant");
    assert!(!texts.with(&change).text("part.ron").contains("unused"));
    // A new name follows everywhere.
    let change = texts.try_it(|p| rename(p, "one/half", "factor")).expect("a name");
    assert!(texts.with(&change).text("part.ron").contains("\"y\": \"factor.y\""));
    assert_eq!(change.notes, ["`part.ron` is the file of 2 blocks: it has the name in all of them"]);
    // Another model of the project has it as well.
    let mut texts = two_parts();
    texts.0.insert(
        "m.ron".into(),
        texts
            .text("m.ron")
            .replace("        \"two\": Subsystem(file: \"part.ron\"),\n", "")
            .replace("one.u, two.u", "one.u")
            .replace(", \"two.y -> show.b\"", "")
            .replace("\"a\", \"b\"", "\"a\""),
    );
    texts.0.insert("n.ron".into(), "Diagram(blocks: { \"x\": Subsystem(file: \"part.ron\") })".to_owned());
    let refusal = texts.try_it(|p| delete(p, &["one/unused".to_owned()])).expect_err("shared");
    assert_eq!(refusal.message, "`part.ron` is a part of `n.ron` as well");
    // What is handed outward cannot go.
    let refusal = texts
        .try_it(|p| delete(&Project { shared: true, ..*p }, &["one/half".to_owned()]))
        .expect_err("an output");
    assert_eq!(refusal.message, "this diagram hands `y` outward, which comes from `half`");
    let all = |p: &Project| connect(&Project { shared: true, ..*p }, "one/in.u", "one/out.y");
    let change = texts.try_it(all).expect("ports");
    assert!(texts.with(&change).text("part.ron").contains("outputs: { \"y\": \"in.u\" }"));
    let ports = |p: &Project| rename(&Project { shared: true, ..*p }, "one/in.u", "set");
    let change = texts.try_it(ports).expect("a name");
    let new = texts.with(&change);
    assert!(
        new.text("part.ron").contains("\"in.set -> half.u") && new.text("m.ron").contains("c.y -> one.set")
    );
    assert!(new.text("n.ron") == texts.text("n.ron"));
}

#[test]
fn texts_that_are_no_diagrams_are_refused() {
    for text in [
        "",
        "(",
        "Diagram(",
        "Diagram()",
        "(a: 1)",
        "Diagram(blocks: [])",
        "Diagram(blocks: { \"a\": Gain(k: 1), \"a\": Gain(k: 2) })",
    ] {
        let texts = Texts::of(&[("m.ron", text)]);
        assert!(texts.try_it(|p| rename(p, "a", "b")).is_err(), "{text}");
        assert!(texts.try_it(|p| delete(p, &["a".to_owned()])).is_err(), "{text}");
        assert!(texts.try_it(|p| connect(p, "a.y", "a.u")).is_err(), "{text}");
        assert!(texts.try_it(|p| wrap(p, &["a".to_owned()], "s")).is_err(), "{text}");
    }
    let missing = Texts::of(&[]);
    assert!(missing.try_it(|p| rename(p, "a", "b")).is_err());
}

#[test]
fn a_diagram_without_sections_gets_them() {
    let texts = Texts::of(&[("m.ron", "Diagram(\n    title: \"New\",\n)\n")]);
    let new = NewBlock { kind: "Constant", ..NewBlock::default() };
    let one = texts.with(&texts.try_it(|p| add(p, &new)).expect("a block"));
    assert_eq!(
        one.text("m.ron"),
        "Diagram(\n    title: \"New\",\n    blocks: {\n        \"constant\": Constant(value: \"48 V\"),\n    },\n)\n"
    );
    let new = NewBlock { kind: "Integrator", ..NewBlock::default() };
    let two = one.with(&one.try_it(|p| add(p, &new)).expect("a block"));
    let three = two.with(&two.try_it(|p| connect(p, "constant.y", "integrator.u")).expect("ports"));
    assert!(
        three.text("m.ron").contains("    connections: [\n        \"constant.y -> integrator.u\",\n    ],\n"),
        "{}",
        three.text("m.ron")
    );
}
