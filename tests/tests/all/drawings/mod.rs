//! Drawings of all levels of all diagrams that ship: what must hold for every drawing, and how good each is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use blocksim_block::{BlockInfo, kinds};
use blocksim_diagram::Sources;
use blocksim_drawing::{Level, Theme, all_levels, level_at, svg, text};
use blocksim_layout::{layout, metrics};
use blocksim_tests::{Desk, root};

mod edits;
mod steady;

/// Models below `diagrams/`, by their names there.
fn models() -> Vec<(String, PathBuf)> {
    let folder = root().join("diagrams");
    let mut found: Vec<(String, PathBuf)> = std::fs::read_dir(&folder)
        .expect("the diagrams")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        // Some hold the parameters of others.
        .filter(|path| std::fs::read_to_string(path).expect("a text").contains("Diagram("))
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

/// The picture of the README and of the guide; `UPDATE_DRAWINGS=1` draws it anew.
#[test]
fn the_same_text_gives_the_same_picture() {
    let path = root().join("diagrams/servo.ron");
    let draw = || {
        let level = levels_of(&Desk::new(), &path, &[]).remove(0);
        svg(&level, &layout(&level.graph), Theme::Light)
    };
    let picture = root().join("docs/servo.svg");
    if std::env::var_os("UPDATE_DRAWINGS").is_some() {
        std::fs::write(&picture, draw()).expect("the picture is written");
    }
    assert_eq!(draw(), draw());
    assert_eq!(std::fs::read_to_string(&picture).expect("the picture"), draw());
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
