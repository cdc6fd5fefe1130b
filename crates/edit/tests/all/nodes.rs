//! What a change does to the nodes and the drivers of random diagrams, beside sets that are joined and split by themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use blocksim_diagram::{ConnectionAst, Content, Model, Reader, Reference, Sources, model};
use blocksim_edit::{Change, NewBlock, Refusal, add, connect, delete, disconnect_end, wrap};
use blocksim_syntax::{TokenKind, Tokens};

use crate::{Random, Texts};

const TOP: &str = "/net/top.ron";
const PART: &str = "/net/part.ron";

/// What the connections of the part mean, by its blocks and, as `out.x` and `in.a`, what leads out of it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Meaning {
    /// Conserving ends that are joined, two or more.
    nodes: Vec<BTreeSet<String>>,
    /// The source of each signal.
    drivers: BTreeMap<String, String>,
}

impl Meaning {
    /// From the trees that the compiler makes, across subsystems.
    fn of(texts: &Texts) -> Meaning {
        let sources = Sources::new(texts);
        let (top, _) = model(&sources, Path::new(TOP), &[]);
        let top = top.expect("a model");
        let Content::Diagram(part) = &top.block("part").expect("the part").content else {
            panic!("a diagram")
        };
        let mut found = Meaning::default();
        let mut subsystems = BTreeSet::new();
        found.gather(part, None, &mut subsystems);
        let is_own = |end: &str| !subsystems.contains(end.split('.').next().unwrap_or_default());
        found.nodes.iter_mut().for_each(|node| node.retain(|end| is_own(end)));
        let through = found.drivers.clone();
        found.drivers.retain(|end, _| is_own(end));
        for source in found.drivers.values_mut() {
            while let Some(before) = through.get(source) {
                source.clone_from(before);
            }
        }
        found.in_order()
    }

    fn gather(&mut self, level: &Model, subsystem: Option<&str>, subsystems: &mut BTreeSet<String>) {
        let boundary = |port: &str, way: &str| format!("{}.{port}", subsystem.unwrap_or(way));
        let end = |at: &Reference| match at.block.as_str() {
            "in" => boundary(&at.port, "in"),
            block => format!("{block}.{}", at.port),
        };
        for connection in &level.ast.connections {
            match connection {
                ConnectionAst::Conserving(ends) => {
                    ends.iter().for_each(|other| self.join(&end(&ends[0]), &end(other)));
                }
                ConnectionAst::Signal(source, targets) => {
                    self.drivers.extend(targets.iter().map(|target| (end(target), end(source))));
                }
            }
        }
        for (name, at) in &level.ast.ports {
            self.join(&boundary(&name.text, "out"), &end(at));
        }
        self.drivers
            .extend(level.ast.outputs.iter().map(|(name, at)| (boundary(&name.text, "out"), end(at))));
        for block in &level.blocks {
            if let Content::Diagram(inside) = &block.content {
                subsystems.insert(block.name.clone());
                self.gather(inside, Some(&block.name), subsystems);
            }
        }
    }

    fn node(&self, end: &str) -> BTreeSet<String> {
        let known = self.nodes.iter().find(|node| node.contains(end));
        known.cloned().unwrap_or_else(|| BTreeSet::from([end.to_owned()]))
    }

    fn join(&mut self, a: &str, b: &str) {
        let whole: BTreeSet<String> = self.node(a).union(&self.node(b)).cloned().collect();
        self.nodes.retain(|node| node.is_disjoint(&whole));
        self.nodes.push(whole);
    }

    /// Takes ends out of their nodes.
    fn take(&mut self, is_gone: impl Fn(&str) -> bool) {
        self.nodes.iter_mut().for_each(|node| node.retain(|end| !is_gone(end)));
    }

    fn in_order(mut self) -> Meaning {
        self.nodes.retain(|node| node.len() > 1);
        self.nodes.sort();
        self
    }
}

/// Blocks of the part by their names and kinds.
type Blocks = Vec<(String, &'static str)>;

fn ends(blocks: &Blocks, ports: &[(&str, &str)]) -> Vec<String> {
    let of = |(name, kind): &(String, &'static str)| {
        let own = ports.iter().filter(|(known, _)| known == kind);
        own.map(|(_, port)| format!("{name}.{port}")).collect::<Vec<_>>()
    };
    blocks.iter().flat_map(of).collect()
}

fn pins(blocks: &Blocks) -> Vec<String> {
    ends(blocks, &[("Resistor", "p"), ("Resistor", "n"), ("ElectricalReference", "p")])
}

fn sources(blocks: &Blocks) -> Vec<String> {
    let mut all = ends(blocks, &[("Gain", "y"), ("Sum", "y")]);
    all.push("in.a".to_owned());
    all
}

fn sinks(blocks: &Blocks) -> Vec<String> {
    ends(blocks, &[("Gain", "u"), ("Sum", "u1"), ("Sum", "u2")])
}

fn one(of: &[String], random: &mut Random) -> String {
    of[random.below(of.len())].clone()
}

fn diagram(random: &mut Random) -> (Texts, Blocks) {
    let resistors = (0..5).map(|n| (format!("r{n}"), "Resistor"));
    let gains = (0..4).map(|n| (format!("g{n}"), "Gain"));
    let blocks: Blocks = resistors
        .chain(gains)
        .chain([("e".to_owned(), "ElectricalReference"), ("s".to_owned(), "Sum")])
        .collect();
    let value = |kind| match kind {
        "Resistor" => "Resistor(r: \"1 ohm\")",
        "Gain" => "Gain(k: 0.5)",
        "Sum" => "Sum(signs: \"++\")",
        other => other,
    };
    let mut lines: Vec<String> = Vec::new();
    for _ in 0..1 + random.below(6) {
        let all: Vec<String> = (0..2 + random.below(3)).map(|_| one(&pins(&blocks), random)).collect();
        let distinct: BTreeSet<&String> = all.iter().collect();
        if distinct.len() == all.len() {
            lines.push(all.join(" <-> "));
        }
    }
    let mut wires: Vec<(String, Vec<String>)> = Vec::new();
    for sink in sinks(&blocks) {
        let source = one(&sources(&blocks), random);
        let known = wires.iter_mut().find(|(known, _)| *known == source);
        match (random.below(4), known) {
            (0, _) => {}
            (1 | 2, Some((_, sinks))) => sinks.push(sink),
            _ => wires.push((source, vec![sink])),
        }
    }
    lines.extend(wires.into_iter().map(|(source, sinks)| format!("{source} -> {}", sinks.join(", "))));
    let lines: String =
        lines.iter().enumerate().map(|(n, line)| format!("        \"{line}\", // wire {n}\n")).collect();
    let entries: String =
        blocks.iter().map(|(name, kind)| format!("        \"{name}\": {},\n", value(kind))).collect();
    let [x, z] = [(); 2].map(|()| one(&pins(&blocks), random));
    let y = one(&ends(&blocks, &[("Gain", "y"), ("Sum", "y")]), random);
    let part = format!(
        "Diagram(\n    inputs: {{ \"a\": () }},\n    outputs: {{ \"y\": \"{y}\" }},\n    \
         ports: {{ \"x\": \"{x}\", \"z\": \"{z}\" }},\n    blocks: {{\n{entries}    }},\n    connections: [\n{lines}    ],\n)\n"
    );
    let top = "Diagram(\n    blocks: {\n        \"part\": Subsystem(file: \"part.ron\"),\n    },\n)\n";
    let changed = BTreeMap::from([(PathBuf::from(TOP), top.to_owned()), (PathBuf::from(PART), part)]);
    (Texts { changed, with_code: false }, blocks)
}

#[derive(Debug, Clone)]
enum Deed {
    Add(&'static str, Vec<String>),
    Connect(String, String),
    Delete(Vec<String>),
    Disconnect(String),
    Wrap(Vec<String>),
}

const NEW: &str = "new";

fn done(texts: &Texts, deed: &Deed, name: &str) -> Result<Change, Refusal> {
    let full = |name: &String| format!("part/{name}");
    let level = "part";
    texts.edit(Path::new(TOP), true, |project| match deed {
        Deed::Add(kind, into) => add(project, &NewBlock { level, kind, name, into, ..NewBlock::default() }),
        Deed::Connect(a, b) => connect(project, &full(a), &full(b)),
        Deed::Delete(blocks) => delete(project, &blocks.iter().map(full).collect::<Vec<_>>()),
        Deed::Disconnect(end) => disconnect_end(project, &full(end)),
        Deed::Wrap(blocks) => wrap(project, &blocks.iter().map(full).collect::<Vec<_>>(), "inner"),
    })
}

/// What the diagram means with the change; nothing if it must be refused. `handed` are the ends that ports hand outward.
fn expected(before: &Meaning, deed: &Deed, name: &str, handed: &BTreeMap<String, String>) -> Option<Meaning> {
    let mut new = before.clone();
    let is_signal = |end: &str| end == "in.a" || end == "out.y" || end.ends_with(".y") || end.contains(".u");
    match deed {
        Deed::Wrap(_) => {}
        Deed::Add(kind, into) if is_signal(&into[0]) => {
            let driven: Vec<String> = new
                .drivers
                .iter()
                .filter(|(_, source)| **source == into[0])
                .map(|(end, _)| end.clone())
                .collect();
            let chosen = if into.len() == 1 { &driven } else { &into[1..].to_vec() };
            if !into[1..].iter().all(|end| driven.contains(end)) {
                return None;
            }
            if *kind == "Gain" {
                if chosen.is_empty() {
                    return None;
                }
                new.drivers.extend(chosen.iter().map(|end| (end.clone(), format!("{name}.y"))));
            }
            new.drivers.insert(format!("{name}.u"), into[0].clone());
        }
        Deed::Add(kind, into) => {
            let node = new.node(&into[0]);
            if !into[1..].iter().all(|end| node.contains(end) && *end != into[0]) {
                return None;
            }
            if *kind == "Resistor" && into.len() > 1 {
                let (far, near): (BTreeSet<String>, BTreeSet<String>) =
                    node.iter().cloned().partition(|end| into[1..].contains(end));
                new.nodes.retain(|known| known.is_disjoint(&node));
                new.nodes.extend([far, near]);
                new.join(&into[1], &format!("{name}.n"));
            }
            new.join(&into[0], &format!("{name}.p"));
        }
        Deed::Connect(a, b) if is_signal(a) => match new.drivers.get(b) {
            Some(source) if source != a => return None,
            _ => drop(new.drivers.insert(b.clone(), a.clone())),
        },
        Deed::Connect(a, b) if a == b => return None,
        Deed::Connect(a, b) => new.join(a, b),
        Deed::Delete(blocks) => {
            let is_gone = |end: &str| blocks.iter().any(|name| end.split('.').next() == Some(name));
            if blocks.is_empty() || handed.values().any(|end| is_gone(end)) {
                return None;
            }
            new.take(is_gone);
            new.drivers.retain(|end, source| !is_gone(end) && !is_gone(source));
        }
        Deed::Disconnect(end) => {
            // What hands the end outward stays with it.
            let own: Vec<&String> =
                handed.iter().filter(|(_, at)| *at == end).map(|(port, _)| port).collect();
            let inside = |one: &String| !one.starts_with("out.");
            let is_known = new.node(end).iter().filter(|one| inside(one)).count() > 1
                || new
                    .drivers
                    .iter()
                    .any(|(target, source)| inside(target) && (target == end || source == end));
            if !is_known {
                return None;
            }
            new.take(|known| known == end || own.iter().any(|port| *port == known));
            own.iter().filter(|port| **port != "out.y").for_each(|port| new.join(port, end));
            new.drivers.retain(|target, source| !inside(target) || (target != end && source != end));
        }
    }
    Some(new.in_order())
}

fn handed(texts: &Texts) -> BTreeMap<String, String> {
    let sources = Sources::new(texts);
    let (top, _) = model(&sources, Path::new(TOP), &[]);
    let top = top.expect("a model");
    let Content::Diagram(part) = &top.block("part").expect("the part").content else { panic!("a diagram") };
    let all = part.ast.ports.iter().chain(&part.ast.outputs);
    all.map(|(name, at)| (format!("out.{}", name.text), format!("{}.{}", at.block, at.port))).collect()
}

fn deed(before: &Meaning, blocks: &Blocks, random: &mut Random) -> Deed {
    let some = |random: &mut Random| -> Vec<String> {
        blocks.iter().filter(|_| random.below(4) == 0).map(|(name, _)| name.clone()).collect()
    };
    match random.below(12) {
        0..5 => {
            let kind = ["Resistor", "Resistor", "Resistor", "ElectricalReference"][random.below(4)];
            let mut all = pins(blocks);
            all.extend(["out.x", "out.z"].map(str::to_owned));
            let from = one(&all, random);
            // Mostly ends of the same node.
            let near: Vec<String> = before.node(&from).into_iter().filter(|end| *end != from).collect();
            let mut into = vec![from];
            for _ in 0..random.below(4) {
                let all = if near.is_empty() || random.below(12) == 0 { &all } else { &near };
                into.push(one(all, random));
            }
            Deed::Add(kind, into)
        }
        5..8 => {
            let kind = ["Gain", "Gain", "Terminator"][random.below(3)];
            let from = one(&sources(blocks), random);
            let driven: Vec<String> = before
                .drivers
                .iter()
                .filter(|(_, source)| **source == from)
                .map(|(end, _)| end.clone())
                .collect();
            let mut into = vec![from];
            for _ in 0..random.below(3) {
                let all = if driven.is_empty() || random.below(12) == 0 { &sinks(blocks) } else { &driven };
                into.push(one(all, random));
            }
            Deed::Add(kind, into)
        }
        8 => Deed::Connect(one(&pins(blocks), random), one(&pins(blocks), random)),
        9 => Deed::Connect(one(&sources(blocks), random), one(&sinks(blocks), random)),
        10 => Deed::Delete(some(random)),
        _ if random.below(2) == 0 => Deed::Wrap(some(random)),
        _ => {
            let mut all = pins(blocks);
            all.extend(sources(blocks));
            all.extend(sinks(blocks));
            Deed::Disconnect(one(&all, random))
        }
    }
}

/// Ends that had a wire and have none: what the notes of a change name.
fn lost(before: &Meaning, after: &Meaning, deed: &Deed) -> BTreeSet<String> {
    let wired = |all: &Meaning| -> BTreeSet<String> {
        all.nodes.iter().flatten().chain(all.drivers.keys()).cloned().collect()
    };
    let gone = match deed {
        Deed::Delete(blocks) => blocks.as_slice(),
        _ => &[],
    };
    let is_there = |end: &String| !gone.iter().any(|name| end.split('.').next() == Some(name));
    wired(before)
        .difference(&wired(after))
        .filter(|end| is_there(end) && !end.starts_with("out."))
        .cloned()
        .collect()
}

fn noted(change: &Change) -> BTreeSet<String> {
    let note = change.notes.iter().find_map(|note| note.strip_prefix("not connected any more: "));
    note.map(|note| note.split('`').skip(1).step_by(2).map(str::to_owned).collect()).unwrap_or_default()
}

fn comments(text: &str) -> BTreeSet<String> {
    let tokens = Tokens::new(text).filter(|token| token.kind == TokenKind::LineComment);
    tokens.map(|token| token.of(text).trim().to_owned()).collect()
}

#[test]
fn a_change_of_a_random_network_joins_and_splits_what_it_is_about_and_nothing_else() {
    let mut random = Random(11);
    let (mut made, mut refused) = ([0; 5], 0);
    for _ in 0..300 {
        let (mut texts, mut blocks) = diagram(&mut random);
        for n in 0..6 {
            let before = Meaning::of(&texts);
            let deed = deed(&before, &blocks, &mut random);
            let name = format!("{NEW}{n}");
            let expected = expected(&before, &deed, &name, &handed(&texts));
            let old = texts.read(Path::new(PART)).expect("a text");
            let change = match (done(&texts, &deed, &name), expected.is_some()) {
                (Ok(change), true) => change,
                // A subsystem may be refused, as it takes more than wires.
                (Err(_), is_expected) if !is_expected || matches!(deed, Deed::Wrap(_)) => {
                    refused += 1;
                    continue;
                }
                (done, _) => panic!("{deed:?}\nexpected {expected:?}\nis {done:?}\n{old}"),
            };
            texts = texts.with(&change);
            let new = texts.read(Path::new(PART)).expect("a text");
            let after = Meaning::of(&texts);
            assert_eq!(Some(&after), expected.as_ref(), "{deed:?}\n{old}\n{new}");
            assert_eq!(noted(&change), lost(&before, &after, &deed), "{deed:?}\n{old}\n{new}");
            made[match &deed {
                Deed::Add(kind, _) => {
                    assert_eq!(comments(&new), comments(&old), "{deed:?}\n{old}\n{new}");
                    blocks.push((name, kind));
                    0
                }
                Deed::Connect(..) => 1,
                Deed::Delete(gone) => {
                    blocks.retain(|(name, _)| !gone.contains(name));
                    2
                }
                Deed::Disconnect(_) => 3,
                Deed::Wrap(_) => 4,
            }] += 1;
            if matches!(deed, Deed::Wrap(_)) {
                break;
            }
        }
    }
    assert!(made.iter().all(|count| *count > 20) && refused > 50, "{made:?}, {refused} refused");
}
