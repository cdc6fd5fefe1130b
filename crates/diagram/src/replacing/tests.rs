use std::f64::consts::PI;
use std::path::Path;

use crate::source::{Reader, Sources};
use crate::{Replaced, compile, parameter};

struct Texts;

const TOP: &str = r#"Diagram(
    parameters: {
        "angle": "90 deg", "minus": "-20 degC", "twice": "2 * 45 deg", "same": "angle", "rate": "10 deg / 2 s",
        "force": "3 kg * 2 m/s^2", "share": "50 %", "mixed": "1 m + 5 mm", "plain": 2, "n": 3, "spin": "angular(50 Hz)",
        "path": ["1 mm", "2 cm"], "line": "[1 mm, 2 mm]", "robot": File("robot.ron"), "mass": "robot.axis.mass",
        "gain": "3 N*m/rad", "level": "-20 dB", "period": "20 ms",
    },
    blocks: {},
    connections: [],
)"#;
const ROBOT: &str = r#"(axis: (mass: (value: "4 g", source: "scales"), start: ["1 deg", "2 deg"]))"#;

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        match path.to_str() {
            Some("top.ron") => Ok(TOP.to_owned()),
            Some("robot.ron") => Ok(ROBOT.to_owned()),
            _ => Err("the file does not exist".to_owned()),
        }
    }
}

/// What is understood, and the value in SI of the parameter, which may lie in a set.
fn set(text: &str) -> Result<(String, f64), String> {
    let sources = Sources::new(&Texts);
    let all = [text.to_owned()];
    let said = |problems: Vec<blocksim_block::problem::Problem>| {
        problems.iter().map(|problem| problem.message.clone()).collect::<Vec<_>>().join("; ")
    };
    let compiled = compile(&sources, Path::new("top.ron"), &all);
    let Some(Replaced { value, .. }) = compiled.replaced.first() else { return Err(said(compiled.problems)) };
    // The diagram has no blocks, which nothing but itself would read.
    let expected = ["empty_diagram", "unused_parameter"];
    if let Some(problem) = compiled.problems.iter().find(|problem| !expected.contains(&problem.code)) {
        return Err(problem.message.clone());
    }
    let target = text.split('=').next().unwrap_or_default();
    // The mass of the robot is read through the parameter `mass`; the other targets are parameters themselves.
    let name = if target == "robot.axis.mass" { "mass" } else { target };
    let number = parameter::<f64>(&sources, Path::new("top.ron"), &all, name);
    Ok((value.clone(), number.unwrap_or(f64::NAN)))
}

#[test]
fn a_bare_number_has_the_unit_in_which_the_value_before_is_written() {
    for (text, understood, si) in [
        ("angle=45", "45 deg", PI / 4.0),
        ("angle=-45", "-45 deg", -PI / 4.0),
        ("angle=9 * 5", "45 deg", PI / 4.0),
        ("angle=15 * n", "45 deg", PI / 4.0),
        ("angle=1 rad", "1 rad", 1.0),
        ("angle=angle0", "", 0.0),
        ("minus=20", "20 degC", 293.15),
        ("level=-40", "-40 dB", 0.01),
        ("level=50 %", "50 %", 0.5),
        ("period=1 / (8 kHz)", "1 / (8 kHz)", 1.25e-4),
        ("minus=-5", "-5 degC", 268.15),
        ("twice=45", "45 deg", PI / 4.0),
        ("same=45", "45 deg", PI / 4.0),
        ("force=7", "7 N", 7.0),
        ("share=60", "60 %", 0.6),
        ("plain=60", "60", 60.0),
        ("plain=60 %", "60 %", 0.6),
        ("gain=1e-9", "1e-9 N*m/rad", 1e-9),
        ("robot.axis.mass=5", "5 g", 0.005),
        ("mass=5", "5 g", 0.005),
    ] {
        match set(text) {
            Ok((value, number)) => {
                assert_eq!(value, understood, "{text}");
                assert!((number - si).abs() <= 1e-15 * si.abs(), "{text}: {number}");
            }
            Err(message) => assert!(understood.is_empty() && message.contains("angle0"), "{text}: {message}"),
        }
    }
}

#[test]
fn items_of_lists_have_the_units_of_their_places() {
    for (text, understood) in [
        ("path=[3, 4]", "[3 mm, 4 cm]"),
        ("path=[3, 4 m, 5]", "[3 mm, 4 m, 5 cm]"),
        ("path[1]=4", "4 cm"),
        ("line=[3, 4, 5]", "[3 mm, 4 mm, 5 mm]"),
        ("robot.axis.start[0]=30", "30 deg"),
        ("robot.axis.start=[30, 40]", "[30 deg, 40 deg]"),
    ] {
        assert_eq!(set(text).map(|(value, _)| value).as_deref(), Ok(understood), "{text}");
    }
}

#[test]
fn what_is_unclear_or_measures_something_else_is_refused() {
    for (text, message) in [
        ("rate=5", "`rate` is computed from values in other units, 5 has none"),
        ("mixed=5", "`mixed` is computed from values in other units, 5 has none"),
        ("spin=60", "`spin` is computed from values in other units, 60 has none"),
        ("angle=45 m", "`angle` is written in deg, but `45 m` is in m"),
        ("share=2 s", "`share` is written in %, but `2 s` is in s"),
        ("robot.axis.mass=2 s", "`robot.axis.mass` is written in g, but `2 s` is in s"),
        ("path=[1, 2 s]", "`path` is written in cm, but `2 s` is in s"),
        ("force=4 m / 2 m", "`force` is written in N, but `4 m / 2 m` has no unit"),
    ] {
        assert_eq!(set(text).expect_err(text), message, "{text}");
    }
}
