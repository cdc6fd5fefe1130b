//! Targets of small models, with toys for blocks.

use std::path::Path;

use super::{Found, Origin, Target, find, spelled, targets};
use crate::source::{Reader, Sources};

struct Texts(&'static [(&'static str, &'static str)]);

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        let known = self.0.iter().find(|(name, _)| Path::new(name) == path);
        known.map(|(_, text)| (*text).to_owned()).ok_or_else(|| "the file does not exist".to_owned())
    }
}

const TOP: &str = r#"Diagram(
    parameters: {
        "gain": 2, "speed": "3 m/s", "twice": "2 * gain",
        "drive": Choice(default: "dc", of: ["asm", "dc"]),
        "set": File("set.ron"), "points": ["1 m", "2 m"],
    },
    blocks: {
        "one": Subsystem(file: "part.ron", with: { "tau": "0.5 s" }),
        "two": Subsystem(file: "part.ron"),
    },
    connections: [],
)"#;
const PART: &str = r#"Diagram(parameters: { "tau": "1 s", "name": Text("a") }, blocks: {}, connections: [])"#;
const SET: &str = r#"(mass: (value: "4 kg", source: "scales"), axis: (ratio: 51))"#;

fn with<T>(check: impl FnOnce(&Sources, &[Target]) -> T) -> T {
    let texts = Texts(&[("top.ron", TOP), ("part.ron", PART), ("set.ron", SET)]);
    let sources = Sources::new(&texts);
    let (found, problems) = targets(&sources, Path::new("top.ron"));
    assert!(problems.is_empty(), "{problems:?}");
    check(&sources, &found)
}

fn one<'t>(all: &'t [Target], name: &str) -> &'t Target {
    match find(all, name) {
        Found::One(target) => target,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn everything_that_can_be_set_is_found_where_it_is_written() {
    with(|sources, all| {
        for (name, written, file) in [
            ("gain", "2", "top.ron"),
            ("twice", "\"2 * gain\"", "top.ron"),
            ("drive", "\"dc\"", "top.ron"),
            ("set.mass", "\"4 kg\"", "set.ron"),
            ("set.axis.ratio", "51", "set.ron"),
            ("points[1]", "\"2 m\"", "top.ron"),
            ("one.tau", "\"0.5 s\"", "top.ron"),
        ] {
            let target = one(all, name);
            assert_eq!(target.written, written, "{name}");
            let Origin::Text(place) = &target.origin else { panic!("{name}") };
            let source = sources.file(place.file);
            assert_eq!((source.path.to_str(), &source.text[place.span.clone()]), (Some(file), written));
        }
        let value = |name: &str| one(all, name).value.as_ref().and_then(|value| value.as_number());
        assert_eq!(value("twice").map(|number| number.value), Some(4.0));
        assert!(matches!(one(all, "two.tau").origin, Origin::Declared(_)));
        assert_eq!(one(all, "two.tau").sharers, 1, "it is given to this one alone");
    });
}

#[test]
fn a_value_is_written_as_a_person_would_write_it() {
    with(|sources, all| {
        let after = |name: &str, value: &str| {
            let target = one(all, name);
            let site = &target.site;
            let mut text = sources.file(site.place.file).text.to_string();
            let new = spelled(target, value).map_err(|(said, _)| said)?;
            text.replace_range(site.place.span.clone(), &format!("{}{new}{}", site.before, site.after));
            blocksim_syntax::read(&text).map_err(|error| error.message)?;
            Ok::<_, String>(text)
        };
        let line = |name: &str, value: &str, expected: &str| {
            let text = after(name, value).expect("RON");
            assert!(text.contains(expected), "{name}={value}: {text}");
        };
        line("gain", "2.5", "\"gain\": 2.5,");
        line("gain", "twice / 2", "\"gain\": \"twice / 2\",");
        line("speed", "4 m/s", "\"speed\": \"4 m/s\",");
        line("drive", "asm", "Choice(default: \"asm\",");
        line("set.mass", "5 kg", "(value: \"5 kg\", source: \"scales\")");
        line("points[0]", "3 m", "[\"3 m\", \"2 m\"]");
        line("one.tau", "2 s", "with: { \"tau\": \"2 s\" }");
        line("one.name", "b", "with: { \"tau\": \"0.5 s\", \"name\": Text(\"b\") }");
        line("two.tau", "2 s", "Subsystem(file: \"part.ron\", with: { \"tau\": \"2 s\" })");
        line("speed", "4", "\"speed\": \"4 m/s\",");
        line("speed", "2 * 2", "\"speed\": \"(2 * 2) m/s\",");
        line("set.mass", "5e3", "(value: \"5e3 kg\", source: \"scales\")");
        line("two.tau", "2", "with: { \"tau\": \"2 s\" })");
        let refused = after("speed", "4 m").expect_err("metres per second");
        assert_eq!(refused, "`speed` is 3 m/s, 4 m is not in m/s or a unit of the same kind");
    });
}

#[test]
fn names_that_are_none_are_told_with_what_may_be_meant() {
    with(|_, all| {
        let nothing = |name: &str| match find(all, name) {
            Found::Nothing(help) => help,
            other => panic!("{other:?}"),
        };
        assert_eq!(nothing("gian"), "did you mean `gain`?");
        assert!(nothing("zzzzzz").contains("params list"));
        assert!(matches!(find(all, "set"), Found::One(_)), "a file is a value as well");
        assert!(matches!(find(all, "set.axis"), Found::Several(below) if below.len() == 1));
    });
}

#[test]
fn a_set_of_values_has_targets_as_well() {
    let texts = Texts(&[("set.ron", SET)]);
    let sources = Sources::new(&texts);
    let (all, problems) = targets(&sources, Path::new("set.ron"));
    assert!(problems.is_empty());
    let names: Vec<&str> = all.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["mass", "axis.ratio"]);
}
