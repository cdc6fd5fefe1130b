//! Drawings of all levels of all diagrams that ship: what must hold for every drawing, and how good each is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use blocksim_block::{BlockInfo, kinds};
use blocksim_diagram::Sources;
use blocksim_drawing::{Level, Theme, all_levels, level_at, svg, text};
use blocksim_layout::{End, Form, Graph, Layout, Node, PortKind, Standing, layout, metrics};
use blocksim_tests::{Desk, root};

/// Models below `diagrams/`, by their names there.
fn models() -> Vec<(String, PathBuf)> {
    let folder = root().join("diagrams");
    let mut found: Vec<(String, PathBuf)> = std::fs::read_dir(&folder)
        .expect("the diagrams")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .map(|path| (path.file_stem().expect("a name").to_string_lossy().into_owned(), path))
        .collect();
    found.push(("irb2600".to_owned(), folder.join("irb2600/irb2600.ron")));
    found.sort();
    found
}

fn levels_of(desk: &Desk, path: &Path, overrides: &[&str]) -> Vec<Level> {
    let sources = Sources::new(desk);
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let (model, problems) = blocksim_diagram::model(&sources, path, &overrides);
    all_levels(&model.unwrap_or_else(|| panic!("{problems:?}")), &sources)
}

/// All levels by name: those of every model, and those of all alternatives of the robot's drives. The six joints have
/// the same levels; one of each title is enough.
fn shipped() -> BTreeMap<String, Level> {
    let desk = Desk::new();
    let mut found = BTreeMap::new();
    let mut add = |model: &str, levels: Vec<Level>| {
        let mut seen = BTreeSet::new();
        for level in levels {
            if level.path.is_empty() || seen.insert(level.title.clone()) {
                found.insert(format!("{model} {}", level.path).trim().to_owned(), level);
            }
        }
    };
    for (name, path) in models() {
        add(&name, levels_of(&desk, &path, &[]));
    }
    let robot = root().join("diagrams/irb2600/irb2600.ron");
    for (name, choice) in [
        ("irb2600 dc", "drive=dc"),
        ("irb2600 torque", "drive=torque"),
        ("irb2600 asm_switched", "drive=asm_switched"),
        ("irb2600 asm_link", "drive=asm_link"),
        ("irb2600 slip", "speed_control=slip"),
        ("irb2600 power", "reverser=power"),
        ("irb2600 signal", "reverser=signal"),
    ] {
        let levels = levels_of(&desk, &robot, &[choice]);
        add(name, levels.into_iter().filter(|level| level.path.starts_with("arm/base/drive")).collect());
    }
    found
}

#[test]
fn no_wire_runs_through_a_block_and_nothing_lies_over_anything() {
    let levels = shipped();
    assert!(levels.len() > 50, "{}", levels.len());
    for (name, level) in levels {
        let found = metrics(&level.graph, &layout(&level.graph));
        let faults = [found.overlaps, found.through, found.shared, found.loose];
        assert_eq!(faults, [0; 4], "{name}: {found:?}");
    }
}

/// Crossings and bends of each level; `UPDATE_DRAWINGS=1` writes the list anew, to be looked at.
#[test]
fn no_drawing_has_more_crossings_and_bends_than_recorded() {
    let file = root().join("tests/data/drawings.txt");
    let found: BTreeMap<String, (usize, usize)> = shipped()
        .into_iter()
        .map(|(name, level)| {
            let found = metrics(&level.graph, &layout(&level.graph));
            (name, (found.crossings, found.bends))
        })
        .collect();
    if std::env::var_os("UPDATE_DRAWINGS").is_some() {
        let mut list = String::from("# crossings, bends, level\n");
        for (name, (crossings, bends)) in &found {
            list.push_str(&format!("{crossings:3} {bends:3} {name}\n"));
        }
        std::fs::write(&file, list).expect("the list is written");
    }
    let list = std::fs::read_to_string(&file).expect("the list");
    let mut recorded = BTreeMap::new();
    for line in list.lines().filter(|line| !line.starts_with('#')) {
        let mut words = line.split_whitespace();
        let mut count = || words.next().and_then(|word| word.parse::<usize>().ok()).expect("a number");
        let (crossings, bends) = (count(), count());
        recorded.insert(words.collect::<Vec<_>>().join(" "), (crossings, bends));
    }
    for (name, (crossings, bends)) in &found {
        let most = recorded.get(name).unwrap_or_else(|| panic!("`{name}` is not in {}", file.display()));
        assert!(
            *crossings <= most.0 && *bends <= most.1,
            "{name}: {crossings} crossings, {bends} bends, recorded {most:?}"
        );
    }
    assert_eq!(found.len(), recorded.len(), "levels that are gone are to be taken from the list");
}

#[test]
fn the_same_text_gives_the_same_picture() {
    let path = root().join("diagrams/servo.ron");
    let draw = || {
        let level = levels_of(&Desk::new(), &path, &[]).remove(0);
        svg(&level, &layout(&level.graph), Theme::Light)
    };
    assert_eq!(draw(), draw());
}

/// Where a block stands against another: left or right, above or below, with some play.
fn relation(layout: &Layout, a: usize, b: usize) -> (i8, i8) {
    let middle = |node: usize| {
        let placed = &layout.nodes[node];
        (placed.x + placed.width / 2.0, placed.y + placed.height / 2.0)
    };
    let sign = |x: f64| if x < -4.0 { -1 } else { i8::from(x > 4.0) };
    let ((ax, ay), (bx, by)) = (middle(a), middle(b));
    (sign(ax - bx), sign(ay - by))
}

/// Share of the blocks that stand otherwise against more than a third of the others; the first `n` of both layouts go
/// together.
fn moved(before: &Layout, after: &Layout, nodes: &[usize]) -> f64 {
    let mut count = 0;
    for a in nodes {
        let other = nodes.iter().filter(|b| a != *b);
        let differs = other.filter(|b| {
            let (was, is) = (relation(before, *a, **b), relation(after, *a, **b));
            // Turned round, not only level or no longer level.
            was.0 * is.0 < 0 || was.1 * is.1 < 0
        });
        if 3 * differs.count() > nodes.len() - 1 {
            count += 1;
        }
    }
    count as f64 / nodes.len() as f64
}

/// Share of the edits that may move a tenth of the other blocks or more.
const SHIFTING: f64 = 0.09;

#[test]
fn a_change_of_one_block_leaves_most_others_where_they_are() {
    let mut edits: Vec<(f64, String)> = Vec::new();
    for (name, level) in shipped().into_iter().filter(|(_, level)| level.graph.nodes.len() >= 8) {
        let graph = &level.graph;
        let before = layout(graph);
        let all: Vec<usize> = (0..graph.nodes.len()).collect();
        let mut check = |what: String, changed: &Graph, kept: &[usize]| {
            let share = moved(&before, &layout(changed), kept);
            edits.push((share, format!("{name}, {what}")));
        };
        for node in &all {
            let mut changed = graph.clone();
            changed.nodes[*node].width += 30.0;
            check(format!("node {node} wider"), &changed, &all);
        }
        // A scope at each signal.
        for net in (0..graph.nets.len()).filter(|net| graph.nets[*net].directed) {
            let mut changed = graph.clone();
            changed.nodes.push(scope());
            changed.nets[net].ends.push(End { node: graph.nodes.len(), port: 0 });
            check(format!("scope at net {net}"), &changed, &all);
        }
        // Without each of the blocks that feed nothing.
        for sink in all.iter().filter(|node| graph.nodes[**node].ports == [PortKind::Input]) {
            let mut changed = graph.clone();
            changed.nets.iter_mut().for_each(|net| net.ends.retain(|end| end.node != *sink));
            let kept: Vec<usize> = all.iter().copied().filter(|node| node != sink).collect();
            check(format!("without node {sink}"), &changed, &kept);
        }
    }
    assert!(edits.len() > 500, "{}", edits.len());
    edits.sort_by(|a, b| b.0.total_cmp(&a.0));
    let many = edits.iter().filter(|(share, _)| *share >= 0.1).count();
    let share = many as f64 / edits.len() as f64;
    assert!(
        share < SHIFTING,
        "{many} of {} edits move a tenth of the blocks or more: {:?}",
        edits.len(),
        &edits[..many]
    );
}

fn scope() -> Node {
    Node {
        width: 44.0,
        height: 36.0,
        label_width: 30.0,
        label_height: 14.0,
        form: Form::Box,
        standing: Standing::Free,
        ports: vec![PortKind::Input],
    }
}

#[test]
fn texts_of_a_diagram_add_nothing_to_its_drawing() {
    let model = r#"Diagram(
    title: "<script>alert('t')</script> & \"more\"",
    blocks: {
        "a": Constant(value: 1.0, label: "</text><script>alert(1)</script>"),
        "b": Gain(k: "\"/><script>x</script>"),
        "c": Scope(inputs: ["\" onload=\"alert(2)"], label: "]]>&amp;<!--"),
    },
    connections: ["a.y -> b.u", "b.y -> c.u"],
)"#;
    let desk = Desk::new().with("model.ron", model);
    let level = levels_of(&desk, Path::new("model.ron"), &[]).remove(0);
    for theme in [Theme::Light, Theme::Dark] {
        let drawing = svg(&level, &layout(&level.graph), theme);
        assert!(
            !drawing.contains("<script") && !drawing.contains("<!--") && !drawing.contains("\" onload"),
            "{drawing}"
        );
        blocksim_picture::png(&drawing, 1.0).expect("it is well-formed");
    }
}

#[test]
fn every_level_can_be_a_picture_and_text() {
    for (name, level) in shipped() {
        let laid_out = layout(&level.graph);
        let drawing = svg(&level, &laid_out, Theme::Dark);
        assert!(blocksim_picture::png(&drawing, 0.25).is_ok(), "{name}");
        let (signs, plain) = (text(&level, &laid_out, false), text(&level, &laid_out, true));
        for figure in level.figures.iter().filter(|figure| figure.path.is_some()) {
            let shown = figure.name.as_str();
            let is_sum = figure.kind == "Sum";
            assert!(is_sum || (signs.contains(shown) && plain.contains(shown)), "{name}: {shown}\n{plain}");
        }
        assert!(plain.lines().skip(1).all(|line| line.is_ascii()), "{name}");
    }
}

/// A model with one block of each kind that its example can make.
#[test]
fn every_kind_can_be_drawn() {
    let mut drawn = 0;
    for info in kinds() {
        let BlockInfo { kind, .. } = info;
        let example = info.examples().first().map_or((*kind).to_owned(), ToString::to_string);
        let model = format!("Diagram(blocks: {{ \"one\": {example} }}, connections: [])");
        let desk = Desk::new().with("model.ron", &model);
        let sources = Sources::new(&desk);
        let (model, _) = blocksim_diagram::model(&sources, Path::new("model.ron"), &[]);
        let Some(model) = model else { continue };
        let level = level_at(&model, &sources, "").expect("the top");
        let drawing = svg(&level, &layout(&level.graph), Theme::Light);
        assert!(blocksim_picture::png(&drawing, 0.5).is_ok(), "{kind}: {drawing}");
        drawn += 1;
    }
    assert!(drawn > 150, "{drawn}");
}

#[test]
fn paths_that_lead_nowhere_say_where_they_end() {
    let desk = Desk::new();
    let sources = Sources::new(&desk);
    let (model, _) = blocksim_diagram::model(&sources, &root().join("diagrams/irb2600/irb2600.ron"), &[]);
    let model = model.expect("a model");
    let error = level_at(&model, &sources, "arm/link9").expect_err("no such link");
    assert_eq!((error.found.as_str(), error.name.as_str(), error.is_block), ("arm", "link9", false));
    assert!(error.subsystems.contains(&"link5".to_owned()));
    let error = level_at(&model, &sources, "arm/world").expect_err("nothing inside");
    assert!(error.is_block);
}
