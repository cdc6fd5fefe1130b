use std::path::Path;

use super::PanelAction;
use crate::compile;
use crate::source::{Reader, Sources};

struct Texts;

const TOP: &str = r#"Diagram(
    parameters: {
        "way": "0.5 m", "angle": "90 deg", "heat": "350 K", "share": "-20 dB", "plain": 2, "rate": "6 1/s", "twice": "2 * angle",
        "load": "0 N*m", "stop": false,
    },
    panel: [
        Slider("way", "0 .. 1 m"), Slider("way", "0 .. 1000 mm"), Slider("angle", "-3 .. 3 rad"), Slider("heat", "0 .. 500 degC"),
        Slider("share", "-60 .. 0 dB"), Slider("plain", "0 .. 9"), Slider("rate", "0 .. 20"), Slider("twice", "0 .. 360 deg"),
        Switch("load", "0 N*m", "6 N*m"), Button("stop"),
    ],
    blocks: {},
    connections: [],
)"#;

impl Reader for Texts {
    fn read(&self, _: &Path) -> Result<String, String> {
        Ok(TOP.to_owned())
    }
}

/// What the elements of the panel have with what is set.
fn now(set: &[&str]) -> Vec<String> {
    let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
    let compiled = compile(&Sources::new(&Texts), Path::new("top.ron"), &set);
    let of = |action: &PanelAction| match action {
        PanelAction::Number { now, unit, .. } => format!("{now} {unit}").trim().to_owned(),
        PanelAction::Two { is_on_now, .. } => is_on_now.to_string(),
        PanelAction::Shows { .. } => String::new(),
    };
    compiled.panel.iter().map(|item| of(&item.action)).collect()
}

#[test]
fn elements_have_what_is_set_in_their_own_units() {
    let text = [
        "0.5 m",
        "500 mm",
        "1.5707963267949 rad",
        "76.85 degC",
        "-20 dB",
        "2",
        "6 1/s",
        "180 deg",
        "false",
        "false",
    ];
    let text: Vec<String> = text.iter().map(|&text| text.to_owned()).collect();
    assert_eq!(now(&[]), text);
    for (set, at, wanted) in [
        ("way=200 mm", 0, "0.2 m"),
        ("way=200 mm", 1, "200 mm"),
        ("way=0.7", 1, "700 mm"),
        ("way= 2 * 20 cm", 0, "0.4 m"),
        ("angle=1 rad", 2, "1 rad"),
        ("heat=350 degC", 3, "350 degC"),
        ("heat=273.15", 3, "0 degC"),
        ("heat=1.3 degC", 3, "1.3 degC"),
        ("share=0.1", 4, "0.1 dB"),
        ("share=-40", 4, "-40 dB"),
        ("plain=3 * plain", 5, "6"),
        ("rate=7", 6, "7 1/s"),
        // It is computed from what is set.
        ("angle=20", 7, "40 deg"),
        ("load=6000 mN*m", 8, "true"),
        ("load=5 N*m", 8, "false"),
        ("stop=true", 9, "true"),
    ] {
        assert_eq!(now(&[set])[at], wanted, "{set}");
    }
    assert_eq!(now(&["way=200 mm", "way=0.3 m"])[0], "0.3 m", "the last one counts");
}
