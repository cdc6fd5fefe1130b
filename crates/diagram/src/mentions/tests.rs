//! Names of small models.

use std::path::Path;

use super::{Meaning, Mentions, mentions};
use crate::source::{Reader, Sources};

struct Texts(Vec<(&'static str, String)>);

impl Reader for Texts {
    fn read(&self, path: &Path) -> Result<String, String> {
        let known = self.0.iter().find(|(name, _)| Path::new(name) == path);
        known.map(|(_, text)| text.clone()).ok_or_else(|| "there is no such file".to_owned())
    }
}

const TOP: &str = r#"Diagram(
    parameters: { "gain": 2, "set": File("set.ron"), "kind": Choice(default: "a", of: ["a", "b"]) },
    blocks: {
        "one": Subsystem(file: "part.ron", with: { "tau": "2 * gain + 3 m / (1 m)" }),
        "two": Variant(choice: "kind", of: {
            "a": Subsystem(file: "part.ron"),
            "b": Subsystem(file: "other.ron"),
        }),
    },
    connections: ["one.y -> two.u", "two.y.a -> one.u"],
    record: ["one/inner.y", "t*.y", "**"],
    panel: [Slider("gain", "0 .. 9"), Knob(target: "one.tau", range: "0 .. 9"), Lamp("one.y")],
)"#;
const PART: &str = r#"Diagram(
    parameters: { "tau": "gain / 2" },
    inputs: { "u": () }, outputs: { "y": "inner.y" },
    blocks: { "inner": Subsystem(file: "inner.ron", with: { "tau": "tau" }) },
    connections: ["in.u -> inner.u"],
)"#;
const OTHER: &str = r#"Diagram(
    inputs: { "u": () }, outputs: { "y": "in.u" }, blocks: { "inner": Subsystem(file: "inner.ron") }, connections: [],
)"#;
const INNER: &str = r#"Diagram(
    parameters: { "tau": 1 }, inputs: { "u": (), "in_use": () }, outputs: { "y": "in.u" }, blocks: {}, connections: [],
)"#;

/// Every place that names what stands at the sign `|` of `file`, as `file:start`, with the text there; and what it is.
fn places(file: &str, marked: &str) -> (Option<Meaning>, Vec<String>, Option<String>) {
    let at = marked.find('|').expect("a mark");
    let texts = [("top.ron", TOP), ("part.ron", PART), ("other.ron", OTHER), ("inner.ron", INNER)];
    let mut texts: Vec<(&str, String)> = texts.map(|(name, text)| (name, text.to_owned())).to_vec();
    texts.push(("set.ron", "(double: \"2 * gain\")".to_owned()));
    let unmarked = marked.replacen('|', "", 1);
    assert!(texts.iter().any(|(name, text)| *name == file && *text == unmarked), "{file} differs");
    let texts = Texts(texts);
    let sources = Sources::new(&texts);
    let (found, _) = mentions(&sources, Path::new("top.ron"));
    let id = sources.open(Path::new(file)).expect("a file");
    let Mentions { symbols, .. } = &found;
    let Some(mention) = found.at(id, at) else { return (None, Vec::new(), None) };
    let [symbol] = mention.symbols.as_slice() else { panic!("{mention:?}") };
    let line = |place: &blocksim_block::problem::Place| {
        let file = sources.file(place.file);
        let line = file.text[..place.span.start].matches('\n').count() + 1;
        format!("{}:{line}:{}", file.path.display(), &file.text[place.span.clone()])
    };
    let all = found.of(*symbol).map(|mention| line(&mention.place)).collect();
    (Some(symbols[*symbol].meaning), all, symbols[*symbol].fixed.clone())
}

fn mark(text: &str, at: &str) -> String {
    text.replacen(&at.replace('|', ""), at, 1)
}

#[test]
fn a_parameter_is_named_across_files_and_never_by_a_unit_of_its_spelling() {
    let (meaning, all, _) = places("top.ron", &mark(TOP, "\"ga|in\": 2"));
    assert_eq!(meaning, Some(Meaning::Parameter));
    assert_eq!(
        all,
        ["top.ron:2:gain", "top.ron:4:gain", "top.ron:12:gain", "set.ron:1:gain", "part.ron:2:gain"]
    );
    let (_, all, _) = places("part.ron", &mark(PART, "\"ta|u\": \"gain"));
    assert_eq!(all, ["top.ron:4:tau", "top.ron:12:tau", "part.ron:2:tau", "part.ron:4:tau"]);
    // The parameter of the innermost file is another one, which `with` names.
    let (_, all, _) = places("inner.ron", &mark(INNER, "\"ta|u\": 1"));
    assert_eq!(all, ["part.ron:4:tau", "inner.ron:2:tau"]);
}

#[test]
fn a_block_is_named_by_connections_interfaces_paths_and_patterns() {
    let (meaning, all, _) = places("part.ron", &mark(PART, "\"inn|er\": Sub"));
    assert_eq!(meaning, Some(Meaning::Block));
    assert_eq!(all, ["top.ron:11:inner", "part.ron:3:inner", "part.ron:4:inner", "part.ron:5:inner"]);
    let (_, all, _) = places("top.ron", &mark(TOP, "two|.y.a"));
    assert_eq!(all, ["top.ron:5:two", "top.ron:10:two", "top.ron:10:two", "top.ron:11:t*"]);
    assert_eq!(places("top.ron", &mark(TOP, "\"|a\": Sub")).0, None, "an alternative is not a block");
}

#[test]
fn a_port_of_alternatives_is_one_in_several_files() {
    let (meaning, all, fixed) = places("other.ron", &mark(OTHER, "\"|y\""));
    assert_eq!(meaning, Some(Meaning::Port));
    let expected =
        ["top.ron:10:y", "top.ron:10:y", "top.ron:11:y", "top.ron:12:y", "part.ron:3:y", "other.ron:2:y"];
    assert_eq!((all, fixed), (expected.map(str::to_owned).to_vec(), None));
    let (_, all, _) = places("part.ron", &mark(PART, "in.|u"));
    assert_eq!(all.len(), 6, "{all:?}");
}
