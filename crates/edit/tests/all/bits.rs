//! A subsystem around some blocks, or another name for one, changes no bit of a run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Model, Options, Sources, compile_and_keep};
use blocksim_edit::{Change, rename, wrap};
use blocksim_sim::{Observer, Simulation};

use crate::{Random, Texts, models, root};

/// Part of a run that is compared.
const PART: f64 = 0.1;

/// Bits of the recorded values by name, and of the times.
#[derive(Default)]
struct Bits {
    times: Vec<u64>,
    columns: Vec<Vec<u64>>,
}

impl Observer for Bits {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.times.push(t.to_bits());
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value.to_bits()));
    }
}

type Recorded = BTreeMap<String, Vec<u64>>;

fn compiled(texts: &Texts, path: &Path) -> (Model, Schedule) {
    let sources = Sources::new(texts);
    let (model, compiled) = compile_and_keep(&sources, path, &Options::default());
    let problems: Vec<&str> = compiled.problems.iter().map(|problem| problem.message.as_str()).collect();
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{}: {problems:?}", path.display()));
    (model.expect("a model"), schedule)
}

/// Runs the beginning of a model.
fn run(schedule: Schedule) -> Recorded {
    let names: Vec<String> = schedule.recorded.iter().map(|recorded| recorded.path.clone()).collect();
    let mut bits = Bits { columns: vec![Vec::new(); names.len()], ..Bits::default() };
    let until = PART * schedule.settings.stop_time;
    let mut simulation = Simulation::new(Arc::new(schedule)).expect("a sound diagram");
    // A run that ends early is compared as far as it came.
    let _ = simulation.run_until(until, &mut bits);
    let mut all: Recorded = names.into_iter().zip(bits.columns).collect();
    assert!(bits.times.len() > 3, "hardly anything was recorded");
    all.insert("time".to_owned(), bits.times);
    all
}

/// Runs a model with a change; `moved` is what a block at the top is called then.
fn compare(texts: &Texts, path: &Path, before: &Recorded, change: &Change, moved: impl Fn(&str) -> String) {
    let (_, schedule) = compiled(&texts.with(change), path);
    let after = run(schedule);
    let named = |known: &str| {
        let end = known.find(['.', '/']).unwrap_or(known.len());
        format!("{}{}", moved(&known[..end]), &known[end..])
    };
    let expected: Recorded = before.iter().map(|(name, bits)| (named(name), bits.clone())).collect();
    let names = |recorded: &Recorded| recorded.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&expected), names(&after), "{}: {}", path.display(), change.summary);
    assert!(expected == after, "{}: {}: other bits", path.display(), change.summary);
}

#[test]
fn shipped_models_give_the_same_bits_with_other_names_and_with_subsystems_around_some_blocks() {
    let mut random = Random(1);
    let (mut names, mut subsystems) = (0, 0);
    for path in models("diagrams") {
        let texts = Texts { with_code: true, ..Texts::default() };
        let (model, schedule) = compiled(&texts, &path);
        let before = run(schedule);
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
        // What is computed first among equals is decided by names, so another name that stands elsewhere among all others
        // changes the order of sums: here it stands at the same place.
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
fn a_subsystem_within_the_robot_changes_no_bit_either() {
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
    let expected: Recorded = before.iter().map(|(name, bits)| (named(name), bits.clone())).collect();
    assert!(expected == after, "other bits");
}
