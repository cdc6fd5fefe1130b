//! Panels of diagrams: what their elements do, and what is refused.

use blocksim_diagram::{PanelAction, PanelItem, PanelWord};
use blocksim_signal::Unit;
use blocksim_tests::compile_text;

/// A diagram with this panel.
fn text(panel: &str) -> String {
    format!(
        r#"Diagram(
            parameters: {{ "top": "4 1/s", "which": Choice(default: "a", of: ["a", "b"]), "speeds": ["1 rpm", "2 rpm"] }},
            simulation: (stop_time: "0.1 s"),
            panel: [{panel}],
            blocks: {{
                "one": Constant(value: "60 rpm"), "b": Constant(value: false), "vec": Constant(value: ["1 V", "2 V"]),
                "gain": Gain(k: "3 1/s"), "bare": Gain(k: 5), "quiet": Gain(k: "-6 dB"), "sum": Gain(k: "1 1/s + 60 rpm/(1 rad)"),
                "pid": Pid(kp: 2.0, lower: -1.0, upper: 1.0, anti_windup: Clamping), "fast": Gain(k: "top"),
                "show": Scope(display: "rpm/s"), "t": Terminator, "t2": Terminator, "t3": Terminator, "t4": Terminator, "t5": Terminator,
                "t6": Terminator, "t7": Terminator, "one2": Constant(value: 1),
            }},
            connections: [
                "one.y -> gain.u", "vec.y -> t.u", "b.y -> t2.u", "gain.y -> show.u", "one2.y -> bare.u, quiet.u, sum.u, pid.e, fast.u",
                "bare.y -> t3.u", "quiet.y -> t4.u", "sum.y -> t5.u", "pid.u -> t6.u", "fast.y -> t7.u",
            ],
        )"#
    )
}

fn item(element: &str) -> PanelItem {
    let (compiled, problems) = compile_text(&text(element));
    assert!(compiled.schedule.is_some(), "{element}: {problems}");
    let [item] = compiled.panel.as_slice() else { panic!("{element}: {problems}") };
    item.clone()
}

fn number(element: &str) -> ([f64; 2], f64, String) {
    let PanelAction::Number { range, value, unit, .. } = item(element).action else { panic!("{element}") };
    (range, value, unit)
}

fn told(element: &str) -> String {
    let (compiled, problems) = compile_text(&text(element));
    assert!(!compiled.problems.is_empty(), "{element} is accepted");
    problems.to_string()
}

#[test]
fn a_range_is_in_the_unit_that_is_written() {
    let per_second = || "1/s".to_owned();
    assert_eq!(number(r#"Slider("gain.k", "0 .. 50")"#), ([0.0, 50.0], 3.0, per_second()));
    assert_eq!(
        number(r#"Knob(target: "gain.k", range: "-1..1e3 1/s")"#),
        ([-1.0, 1000.0], 3.0, per_second())
    );
    assert_eq!(number(r#"Slider("top", "0 .. 2*top")"#), ([0.0, 8.0], 4.0, per_second()));
    assert_eq!(number(r#"Slider("one.value", "0 .. 100")"#), ([0.0, 100.0], 60.0, "rpm".to_owned()));
    let (range, value, unit) = number(r#"Slider("one.value", "0 .. 9 rad/s")"#);
    assert!(range == [0.0, 9.0] && (value - std::f64::consts::TAU).abs() < 1e-12 && unit == "rad/s");
    assert_eq!(number(r#"Slider("speeds[1]", "0 .. 9")"#), ([0.0, 9.0], 2.0, "rpm".to_owned()));
    // A bare number stays one; a default of the kind counts as written.
    assert_eq!(number(r#"Slider("bare.k", "-10 .. 10")"#), ([-10.0, 10.0], 5.0, String::new()));
    assert_eq!(number(r#"Slider("pid.ki", "0 .. 10")"#), ([0.0, 10.0], 0.0, String::new()));
    let (range, value, unit) = number(r#"Slider("quiet.k", "-40 .. 20")"#);
    assert!(range == [-40.0, 20.0] && (value + 6.0).abs() < 1e-12 && unit == "dB");
}

#[test]
fn switches_and_buttons_have_two_values() {
    let two = |element: &str| match item(element).action {
        PanelAction::Two { off, on, is_on, .. } => (off, on, is_on),
        other => panic!("{other:?}"),
    };
    let texts = |off: &str, on: &str, is_on| (off.to_owned(), on.to_owned(), is_on);
    assert_eq!(two(r#"Button("b.value")"#), texts("false", "true", false));
    assert_eq!(two(r#"Switch("b.value", true, false)"#), texts("true", "false", true));
    assert_eq!(two(r#"Switch(target: "gain.k", off: 0, on: "3 1/s")"#), texts("0", "3 1/s", true));
    assert_eq!(two(r#"Switch("gain.k", "180 1/min", 7)"#), texts("180 1/min", "7", false));
    assert_eq!(two(r#"Switch("pid.anti_windup", None, Clamping)"#), texts("None", "Clamping", true));
}

#[test]
fn gauges_and_lamps_show_what_is_recorded_for_them() {
    let element = r#"Gauge(signal: "vec.y[1]", range: "-5000 .. 5000 mV", label: "Second"), Lamp("b.y"), Gauge("show.u", "0 .. 30")"#;
    let (compiled, problems) = compile_text(&text(element));
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let [first, lamp, shown] = compiled.panel.as_slice() else { panic!("{problems}") };
    let PanelAction::Shows { recorded, alone, range, unit } = &first.action else { panic!() };
    assert!(*alone, "no scope shows it");
    assert_eq!(schedule.recorded[*recorded].path, "vec.y[1]");
    assert_eq!((*range, unit.clone()), (Some([-5000.0, 5000.0]), Unit::parse("mV").ok()));
    assert_eq!((lamp.word, first.label.as_deref()), (PanelWord::Lamp, Some("Second")));
    // In the unit of its scope.
    let PanelAction::Shows { unit, alone, .. } = &shown.action else { panic!() };
    assert!(!alone, "a scope shows it");
    assert_eq!(unit.as_ref().map(|unit| unit.text.as_str()), Some("rpm/s"));
    // What nobody asks to see is not recorded.
    assert!(!schedule.recorded.iter().any(|recorded| recorded.path.starts_with("pid")));
}

#[test]
fn what_an_element_cannot_do_is_told_with_place_and_remedy() {
    for (element, expected) in [
        (r#"Slider("gain.q", "0 .. 1")"#, "there is no parameter `gain.q`"),
        (r#"Slider("gain", "0 .. 1")"#, "`gain` is not one parameter, but has"),
        (r#"Slidr("gain.k", "0 .. 1")"#, "a panel has no `Slidr`"),
        (r#"Slider(target: "gain.k", rang: "0 .. 1")"#, "a Slider has no `rang`"),
        (r#"Slider("gain.k")"#, "`range` of a Slider is missing"),
        (r#"Slider("gain.k", "0 .. 1", "a")"#, "at most 2 members without a name"),
        (r#"Slider("gain.k", 5)"#, "expected a range such as"),
        (r#"Slider("gain.k", "0 - 5")"#, "`0 - 5` is not a range"),
        (r#"Slider("gain.k", "5 .. 0")"#, "the range from 5 1/s to 0 1/s is empty"),
        (r#"Slider("gain.k", "5 ..")"#, "an end of the range is missing"),
        (r#"Slider("gain.k", "0 .. inf")"#, "inf"),
        (r#"Slider("gain.k", "0 .. nothing")"#, "nothing"),
        (r#"Slider("gain.k", "0 .. 1 kg")"#, "expected a range in 1/s, found kg"),
        (r#"Slider("gain.k", "4 .. 9")"#, "`gain.k` is 3 1/s, which is not within the range"),
        (r#"Slider("b.value", "0 .. 1")"#, "`b.value` is false, not a number"),
        (r#"Slider("vec.value", "0 .. 1")"#, "`vec.value` is a list of 2, not a number"),
        (r#"Slider("one.value", "0 .. 1 Hz")"#, "expected a range in rad/s, found Hz"),
        (r#"Switch("gain.k")"#, "a Switch of it needs two values"),
        (r#"Switch("gain.k", 1, true)"#, "cannot become true"),
        (r#"Switch("gain.k", 1, "1 kg")"#, "cannot become 1 kg"),
        (r#"Switch("gain.k", 3, "3 1/s")"#, "off and on of the Switch are the same"),
        (r#"Switch("gain.k", 1, 2)"#, "neither off nor on"),
        (r#"Switch("which", "a", "b")"#, "which cannot change in a run"),
        (r#"Gauge("gain.z")"#, "there is no signal `gain.z`"),
        (r#"Gauge("vec.y")"#, "`vec.y` is not one number"),
        (r#"Gauge("vec.y[1]", "0 .. 3 rpm")"#, "expected a range in V, found rpm"),
        (r#"Lamp(3)"#, "expected a text, found a number"),
        (r#"3"#, "expected an element such as"),
    ] {
        let found = told(element);
        assert!(found.contains(expected), "{element}:\n{found}");
    }
}

#[test]
fn a_panel_has_an_end() {
    let many = |count: usize| vec![r#"Slider("bare.k", "0 .. 9")"#; count].join(", ");
    assert_eq!(compile_text(&text(&many(100))).0.panel.len(), 100);
    let found = told(&many(101));
    assert!(found.contains("a panel has at most 100 elements, this one has 101"), "{found}");
}
