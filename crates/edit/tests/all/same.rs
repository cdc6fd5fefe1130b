//! A subsystem around some blocks, or another name for one, changes nothing but the order in which sums are taken, where names decide it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::schedule::{FixedMethod, Schedule, Solver};
use blocksim_diagram::{Model, Options, Sources, compile_and_keep};
use blocksim_edit::{Change, NewBlock, add, rename, wrap};
use blocksim_sim::{Observer, Simulation};

use crate::{Random, Texts, models, root};

/// Part of a run that is compared, and the steps that it takes.
const PART: f64 = 0.1;
const STEPS: f64 = 1000.0;
/// What rounding may come to, as a part of the largest value of a signal.
const ROUNDING: f64 = 1e-9;

/// The recorded values by name, and the times.
#[derive(Default)]
struct Rows {
    times: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Observer for Rows {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.times.push(t);
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
    }
}

type Recorded = BTreeMap<String, Vec<f64>>;

fn compiled(texts: &Texts, path: &Path) -> (Model, Schedule) {
    let sources = Sources::new(texts);
    let (model, compiled) = compile_and_keep(&sources, path, &Options::default());
    let problems: Vec<&str> = compiled.problems.iter().map(|problem| problem.message.as_str()).collect();
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{}: {problems:?}", path.display()));
    (model.expect("a model"), schedule)
}

/// Runs the beginning of a model, in steps that no rounding can change.
fn run(mut schedule: Schedule) -> Recorded {
    let names: Vec<String> = schedule.recorded.iter().map(|recorded| recorded.path.clone()).collect();
    let mut rows = Rows { columns: vec![Vec::new(); names.len()], ..Rows::default() };
    let until = PART * schedule.settings.stop_time;
    schedule.settings.solver = Solver::Fixed { method: FixedMethod::Ode4, step: until / STEPS };
    let mut simulation = Simulation::new(Arc::new(schedule)).expect("a sound diagram");
    // A run that ends early is compared as far as it came.
    let _ = simulation.run_until(until, &mut rows);
    let mut all: Recorded = names.into_iter().zip(rows.columns).collect();
    all.insert("time".to_owned(), rows.times);
    all
}

/// The first signal that differs by more than rounding.
fn difference(expected: &Recorded, found: &Recorded) -> Option<String> {
    let names = |recorded: &Recorded| recorded.keys().cloned().collect::<Vec<_>>();
    if names(expected) != names(found) {
        return Some(format!("{:?} and {:?}", names(expected), names(found)));
    }
    expected.iter().zip(found.values()).find_map(|((name, expected), found)| {
        let size = expected.iter().fold(1e-12_f64, |size, value| size.max(value.abs()));
        let same = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * size;
        let differ = expected.len() != found.len() || !expected.iter().zip(found).all(same);
        differ.then(|| name.clone())
    })
}

/// Runs a model with a change; `moved` is what a block at the top is called then.
fn compare(texts: &Texts, path: &Path, before: &Recorded, change: &Change, moved: impl Fn(&str) -> String) {
    let (_, schedule) = compiled(&texts.with(change), path);
    let after = run(schedule);
    let named = |known: &str| {
        let end = known.find(['.', '/']).unwrap_or(known.len());
        format!("{}{}", moved(&known[..end]), &known[end..])
    };
    let expected: Recorded = before.iter().map(|(name, values)| (named(name), values.clone())).collect();
    assert_eq!(difference(&expected, &after), None, "{}: {}", path.display(), change.summary);
}

#[test]
fn shipped_models_do_the_same_with_other_names_and_with_subsystems_around_some_blocks() {
    let mut random = Random(1);
    let (mut names, mut subsystems) = (0, 0);
    for path in models("diagrams") {
        let texts = Texts { with_code: true, ..Texts::default() };
        let (model, schedule) = compiled(&texts, &path);
        let before = run(schedule);
        if before["time"].len() < 10 {
            // Steps of this size are too long for it.
            continue;
        }
        let blocks: Vec<String> = model.blocks.iter().map(|block| block.name.clone()).collect();
        for _ in 0..3 {
            let some: BTreeSet<String> = blocks.iter().filter(|_| random.below(2) == 0).cloned().collect();
            let some: Vec<String> = some.into_iter().collect();
            if some.is_empty() {
                continue;
            }
            let change = texts.edit(&path, false, |project| wrap(project, &some, "part_of_it"));
            let change = change.unwrap_or_else(|refusal| panic!("{}: {some:?}: {refusal:?}", path.display()));
            subsystems += 1;
            compare(&texts, &path, &before, &change, |name| match some.iter().any(|block| block == name) {
                true => format!("part_of_it/{name}"),
                false => name.to_owned(),
            });
        }
        let old = &blocks[random.below(blocks.len())];
        let new = format!("{old}_");
        let change = texts.edit(&path, false, |project| rename(project, old, &new));
        let change = change.unwrap_or_else(|refusal| panic!("{}: {old}: {refusal:?}", path.display()));
        names += 1;
        compare(&texts, &path, &before, &change, |name| match name == old {
            true => new.clone(),
            false => name.to_owned(),
        });
    }
    assert!(names >= 30 && subsystems >= 80, "{names} names and {subsystems} subsystems");
}

#[test]
fn a_subsystem_within_the_robot_changes_nothing_either() {
    let path = root().join("diagrams/irb2600/irb2600.ron");
    let texts = Texts { with_code: true, ..Texts::default() };
    let (model, schedule) = compiled(&texts, &path);
    let before = run(schedule);
    let inside = model.block("control").expect("the control systems");
    let blocksim_diagram::Content::Diagram(inside) = &inside.content else { panic!("a subsystem") };
    let some: Vec<String> = inside.blocks.iter().take(3).map(|block| block.path.clone()).collect();
    let change =
        texts.edit(&path, false, |project| wrap(project, &some, "front")).expect("blocks of one file");
    let (_, schedule) = compiled(&texts.with(&change), &path);
    let after = run(schedule);
    let named = |known: &String| {
        let within = some
            .iter()
            .any(|block| known.strip_prefix(block.as_str()).is_some_and(|rest| rest.starts_with(['.', '/'])));
        if within { known.replacen("control/", "control/front/", 1) } else { known.clone() }
    };
    let expected: Recorded = before.iter().map(|(name, values)| (named(name), values.clone())).collect();
    assert_eq!(difference(&expected, &after), None);
}

/// 5 V over 1 ohm and then two of 1 ohm side by side, whose node is written in two connections.
const NODE: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "v": VoltageSource(v: "5 V"),
        "r1": Resistor(r: "1 ohm"),
        "r2": Resistor(r: "1 ohm"),
        "r3": Resistor(r: "1 ohm"),
        "g": ElectricalReference,
        "vs": VoltageSensor,
    },
    connections: [
        "v.p <-> r1.p",
        "r1.n <-> r2.p <-> vs.p",
        "r3.p <-> r2.p",
        "v.n <-> r2.n <-> r3.n <-> vs.n <-> g.p",
    ],
    record: ["vs.v"],
)
"#;

#[test]
fn a_sensor_that_is_a_wire_can_be_put_between_any_parts_of_a_node() {
    let path = Path::new("/circuit/circuit.ron");
    let changed = BTreeMap::from([(PathBuf::from(path), NODE.to_owned())]);
    let texts = Texts { changed, with_code: false };
    let ends = ["r1.n", "r2.p", "r3.p", "vs.p"];
    for (stays, from) in ends.iter().enumerate() {
        for far in 1..16_usize {
            let others = ends.iter().enumerate().filter(|(n, _)| *n != stays && far >> n & 1 == 1);
            let into: Vec<String> =
                [from].into_iter().chain(others.map(|(_, end)| end)).map(|end| (*end).to_owned()).collect();
            if into.len() == 1 || far >> stays & 1 == 1 {
                continue;
            }
            let new = NewBlock { kind: "CurrentSensor", into: &into, ..NewBlock::default() };
            let change = texts.edit(path, false, |project| add(project, &new)).expect("a node");
            let after = run(compiled(&texts.with(&change), path).1);
            let volts = after["vs.v"].last().expect("a row");
            assert!((volts - 5.0 / 3.0).abs() < 1e-9, "{into:?}: {volts} V");
        }
    }
}
