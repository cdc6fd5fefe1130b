mod ports;

use blocksim_block::{BlockInfo, Bound, ParameterInfo, Requirement, in_diagram, kinds};
use blocksim_diagram::HIERARCHY;
use blocksim_signal::closest;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use crate::args::manual::BlocksArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::search::{Query, kinds_elsewhere};
use crate::terminal::console::Console;
use crate::terminal::prose::{first_sentence, one_line, prose, shortened, wrapped};

/// Lists all kinds of block or those that some words are about, or describes one.
///
/// # Errors
/// If there is no such kind and nothing is about the words.
pub fn blocks(args: &BlocksArgs, console: Console) -> Outcome {
    let all = all();
    if args.words.is_empty() {
        console.data(&if args.json { lines(&all) } else { list(&all, console.width) })?;
        return Ok(Exit::Done);
    }
    let words = args.words.join(" ");
    let found = found(&words);
    match named(&words, &all) {
        Some(info) if args.json => console.data(&lines(&[info]))?,
        Some(info) if info.kind == words => console.data(&page(info, console.width))?,
        // Written in another way it may be a word that is looked for.
        Some(info) => console.data(&(page(info, console.width) + &related(info, &found)))?,
        None if found.is_empty() => return Err(unknown(&words, &all)),
        None if args.json => console.data(&lines(&found))?,
        None => console.data(&results(&found, console.width))?,
    }
    Ok(Exit::Done)
}

/// Ports of a kind as cells (name, side, what it carries, unit, default) and their meanings; none where no example can be built
/// alone.
#[cfg(feature = "site")]
pub fn port_rows(info: &BlockInfo) -> Vec<([String; 5], &'static str)> {
    ports::interface(info).map(|interface| ports::plain_rows(&interface)).unwrap_or_default()
}

/// The kind that is written so, whatever its capitals and spaces.
fn named<'a>(words: &str, all: &[&'a BlockInfo]) -> Option<&'a BlockInfo> {
    let plain = |text: &str| text.to_lowercase().replace([' ', '-', '_'], "");
    all.iter().find(|info| plain(info.kind) == plain(words)).copied()
}

/// Kinds that some words are about, best first.
pub fn found(words: &str) -> Vec<&'static BlockInfo> {
    let query = Query::new(words);
    let score = |info: &&BlockInfo| {
        let first = first_sentence(info.doc);
        query.score(&[(info.kind, 8), (&first, 4), (info.category, 2), (info.doc, 1)])
    };
    let ours = kinds_elsewhere(words);
    let all = all();
    let first = ours.iter().filter_map(|kind| all.iter().find(|info| info.kind == *kind)).copied();
    let rest = query.ranked(all.iter().copied(), score).into_iter().filter(|info| !ours.contains(&info.kind));
    first.chain(rest).collect()
}

/// Most kinds that are listed as the result of a search.
const MOST: usize = 20;

fn results(found: &[&BlockInfo], width: usize) -> String {
    let shown = &found[..found.len().min(MOST)];
    let longest = shown.iter().map(|info| info.kind.len()).max().unwrap_or_default();
    let more = match found.len() - shown.len() {
        0 => String::new(),
        left => format!("and {left} more: add a word to see fewer. "),
    };
    let lines: String = shown.iter().map(|info| line(info, longest, width)).collect();
    format!("{lines}\n{more}`blocksim blocks KIND` describes one of them.\n")
}

fn related(info: &BlockInfo, found: &[&BlockInfo]) -> String {
    let others: Vec<&str> =
        found.iter().map(|other| other.kind).filter(|kind| *kind != info.kind).take(6).collect();
    if others.is_empty() { String::new() } else { format!("\nSee also {}.\n", others.join(", ")) }
}

/// Ports of the example of a kind; nothing where none can be built alone.
pub fn interface(info: &BlockInfo) -> Option<blocksim_block::Interface> {
    ports::interface(info)
}

/// All kinds by category and name, those of the hierarchy first.
pub fn everything() -> Vec<&'static BlockInfo> {
    all()
}

/// All kinds by category and name, those of the hierarchy first.
fn all() -> Vec<&'static BlockInfo> {
    static OF_HIERARCHY: [BlockInfo; 2] = HIERARCHY;
    OF_HIERARCHY.iter().chain(kinds()).collect()
}

fn unknown(name: &str, all: &[&BlockInfo]) -> Failure {
    let meant = closest(name, all.iter().map(|info| info.kind));
    let part = || all.iter().find(|info| info.kind.to_lowercase().contains(&name.to_lowercase()));
    Failure::usage(format!("there is no block `{name}`")).help(match meant.or(part().map(|info| info.kind)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "`blocksim blocks` lists all".to_owned(),
    })
}

/// Kinds below the headings of their categories, each with its first sentence.
fn list(all: &[&BlockInfo], width: usize) -> String {
    let longest = all.iter().map(|info| info.kind.len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut category = "";
    for info in all {
        if info.category != category {
            text.push_str(&format!("{}{}\n", if category.is_empty() { "" } else { "\n" }, info.category));
            category = info.category;
        }
        text.push_str(&line(info, longest, width));
    }
    text.push_str(
        "\n`blocksim blocks KIND` describes one of them, `blocksim blocks spring` finds some by words.\n",
    );
    text
}

/// A kind with its first sentence.
fn line(info: &BlockInfo, longest: usize, width: usize) -> String {
    let room = width.saturating_sub(longest + 4).max(20);
    format!("  {:<longest$}  {}\n", info.kind, shortened(&first_sentence(info.doc), room))
}

/// All about one kind.
fn page(info: &BlockInfo, width: usize) -> String {
    let mut text = format!("{} ({})\n\n{}", info.kind, info.category, prose(info.doc.trim()));
    let mut section = |title: &str, content: String| {
        if !content.is_empty() {
            text.push_str(&format!("\n{title}\n{content}"));
        }
    };
    let ports = ports::interface(info).map(|interface| ports::table(&interface, width));
    section("Ports of the example, with nothing connected", ports.unwrap_or_default());
    section("Parameters", parameter_table(info, width));
    section("Source", format!("  {}:{}\n", info.file, info.line));
    text
}

fn parameter_table(info: &BlockInfo, width: usize) -> String {
    let headings = ["  name", "unit", "range", "default"];
    let cells: Vec<[String; 4]> = info.parameters.iter().map(start_of_row).collect();
    // Where all values are allowed a column of ranges has nothing to show.
    let is_ranged = cells.iter().any(|row| row[2] != "-");
    let shown: Vec<usize> = (0..headings.len()).filter(|n| *n != 2 || is_ranged).collect();
    let widest = |n: usize| cells.iter().map(|row| row[n].chars().count()).max().unwrap_or(0);
    let taken: usize = shown.iter().map(|&n| widest(n).max(headings[n].len()) + 2).sum();
    let room = width.saturating_sub(taken).max(30);
    let mut columns: Vec<(&str, Align)> = shown.iter().map(|&n| (headings[n], Align::Left)).collect();
    columns.push(("", Align::Left));
    let mut table = Table::new(&columns);
    for (parameter, start) in info.parameters.iter().zip(cells) {
        let doc = wrapped(&one_line(parameter.doc), room);
        let mut lines = doc.lines().map(str::to_owned);
        table.row(shown.iter().map(|&n| start[n].clone()).chain(lines.next()));
        lines.for_each(|line| table.row(shown.iter().map(|_| String::new()).chain([line])));
    }
    if info.parameters.is_empty() { String::new() } else { table.render() }
}

/// Name, unit, range and default of a parameter as they are written in diagrams; a line for what may be absent.
fn start_of_row(parameter: &ParameterInfo) -> [String; 4] {
    let range = Some(parameter.range()).filter(|range| !range.is_empty());
    let unit = if parameter.unit.is_empty() { "-" } else { parameter.unit };
    let default = match parameter.default {
        None => "required".to_owned(),
        Some(default) => in_diagram(default).unwrap_or_else(|| "-".to_owned()),
    };
    [format!("  {}", parameter.name), unit.to_owned(), range.unwrap_or_else(|| "-".to_owned()), default]
}

/// What the value of a parameter must be, for programs: words, or words with a number or the name of another parameter.
fn requirements(parameter: &ParameterInfo) -> Vec<Value> {
    let end = |word: &str, bound: Bound| match bound {
        Bound::Number(value) => json!({ word: value }),
        Bound::Parameter(name) => json!({ word: name }),
    };
    let one = |requirement: &Requirement| match *requirement {
        Requirement::Finite => json!("finite"),
        Requirement::NotZero => json!("not_zero"),
        Requirement::Above(bound) => end("above", bound),
        Requirement::AtLeast(bound) => end("at_least", bound),
        Requirement::Below(bound) => end("below", bound),
        Requirement::AtMost(bound) => end("at_most", bound),
        Requirement::NotEmpty => json!("not_empty"),
        Requirement::Increasing => json!("increasing"),
        Requirement::AsManyAs(other) => json!({ "as_many_as": other }),
        Requirement::Unit => json!("a_unit"),
        Requirement::Direction => json!("direction"),
    };
    parameter.requires.list.iter().map(one).collect()
}

/// A JSON object a line.
fn lines(all: &[&BlockInfo]) -> String {
    all.iter().map(|info| format!("{}\n", data(info))).collect()
}

fn data(info: &BlockInfo) -> Value {
    let parameters: Vec<Value> = info
        .parameters
        .iter()
        .map(|p| {
            let (required, default) = (p.default.is_none(), p.default.and_then(in_diagram));
            json!({"name": p.name, "type": p.rust_type, "unit": p.unit, "required": required, "default": default,
                "range": p.range(), "requires": requirements(p), "doc": p.doc})
        })
        .collect();
    let ports = ports::interface(info).map(|interface| ports::data(&interface));
    json!({
        "v": 1,
        "type": "block",
        "kind": info.kind,
        "category": info.category,
        "doc": info.doc,
        "examples": info.examples(),
        "ports": ports,
        "parameters": parameters,
        "file": info.file,
        "line": info.line,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_and_the_plug_in_block_are_linked() {
        let names: Vec<&str> = all().iter().map(|info| info.kind).collect();
        for expected in ["Subsystem", "Variant", "Gain", "Integrator", "Plugin"] {
            assert!(names.contains(&expected), "{expected} is missing");
        }
        assert!(names.len() >= 30, "only {} kinds", names.len());
    }

    #[test]
    fn every_kind_has_a_page_and_a_line() {
        let all = all();
        let list = list(&all, 100);
        for info in &all {
            assert!(list.contains(&format!("  {} ", info.kind)), "{}", info.kind);
            let page = page(info, 100);
            assert!(info.parameters.iter().all(|p| page.contains(p.name)), "{}", info.kind);
            assert!(page.contains(info.file));
        }
        assert!(list.lines().all(|line| line.chars().count() <= 100));
    }

    #[test]
    fn an_unknown_kind_gets_the_likely_one() {
        assert!(unknown("Intergrator", &all()).text().ends_with("did you mean `Integrator`?"));
        assert!(unknown("Zzzz", &all()).text().ends_with("`blocksim blocks` lists all"));
    }

    #[test]
    fn kinds_are_found_by_what_they_do() {
        for (words, kind) in [
            ("spring", "RotationalSpring"),
            ("torsion spring", "RotationalSpring"),
            ("low pass", "LowPass"),
            ("PT1", "LowPass"),
            ("dead time", "TransportDelay"),
            ("coil", "Inductor"),
            ("add", "Sum"),
            ("multiply", "Gain"),
            ("gearbox", "SimpleGear"),
            ("induction motor", "AsynchronousMachine"),
            ("brushless", "PermanentMagnetMachine"),
            ("flywheel", "Inertia"),
            ("Transfer Fcn", "TransferFunction"),
            ("rigid transform", "Transform"),
            ("stiction", "RotationalFriction"),
            ("limit", "Saturation"),
            ("robot", "Robot"),
        ] {
            let kinds: Vec<&str> = found(words).iter().map(|info| info.kind).collect();
            let place = kinds.iter().position(|found| *found == kind);
            assert!(place.is_some_and(|place| place < 6), "{words}: {kinds:?}");
        }
        assert!(found("Gian").is_empty() && found("zzz").is_empty());
    }

    #[test]
    fn a_kind_is_known_however_it_is_written() {
        for words in ["LowPass", "lowpass", "low pass", "low_pass"] {
            assert_eq!(named(words, &all()).map(|info| info.kind), Some("LowPass"), "{words}");
        }
        assert!(named("low", &all()).is_none());
    }

    #[test]
    fn no_default_of_the_library_shows_rust() {
        for info in kinds() {
            for parameter in info.parameters {
                let shown = parameter.default.and_then(in_diagram).unwrap_or_default();
                let strange = ["::", "!", "()", "to_owned"].iter().any(|rust| shown.contains(rust));
                assert!(!strange, "{}.{}: {shown}", info.kind, parameter.name);
            }
        }
    }
}
