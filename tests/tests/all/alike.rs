//! Blocks that are written alike are one block with one law: models are what they are if each is read by itself, as it is where
//! something is replaced.

use blocksim_block::schedule::Schedule;
use blocksim_tests::random::{Puzzle, Sampled, Signals, Variant};
use blocksim_tests::{Desk, compile_with, schedule};

/// Everything that a run follows from; files are numbered in another way where the command line is one.
fn described(schedule: &Schedule) -> String {
    let mut schedule = schedule.clone();
    for block in &mut schedule.blocks {
        block.place = None;
        block.parts.iter_mut().for_each(|part| part.place = None);
    }
    let laws = schedule.blocks.iter().map(|block| {
        let law = block.law.as_ref();
        let program =
            law.map(|law| (&law.program, &law.outputs, &law.derivatives, &law.guards, &law.settled));
        format!("{}: {program:?}\n", block.path)
    });
    format!("{schedule:?}\n{}", laws.collect::<String>())
}

/// How many blocks of a schedule are another one as well.
fn shared(schedule: &Schedule) -> usize {
    let blocks = schedule.blocks.iter().map(|block| std::sync::Arc::as_ptr(&block.block).cast::<()>());
    let mut all: Vec<*const ()> = blocks.collect();
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    count - all.len()
}

/// Compares a model with itself where a parameter is replaced by the value that it has; returns how many blocks were shared.
fn compare(name: &str, alike: &Schedule, alone: &Schedule) -> usize {
    assert_eq!(shared(alone), 0, "{name}");
    let (one, other) = (described(alike), described(alone));
    let at = one.bytes().zip(other.bytes()).position(|(one, other)| one != other);
    let near =
        |text: &str| text.chars().skip(at.unwrap_or(0).saturating_sub(200)).take(300).collect::<String>();
    assert!(one == other, "{name}: {}\n\nis not\n\n{}", near(&one), near(&other));
    shared(alike)
}

#[test]
fn the_robot_is_the_same_with_each_block_by_itself() {
    let robot = |set: &[&str]| schedule("diagrams/irb2600/irb2600.ron", set);
    assert!(compare("the robot", &robot(&[]), &robot(&["reverser=signed"])) > 0);
}

#[test]
fn random_models_are_the_same_with_each_block_by_itself() {
    let mut found = 0;
    for seed in 0..40 {
        for text in [Signals::of(seed).text(&Variant::plain()), Sampled::of(seed).text(&Variant::plain())] {
            // Two pairs that are alike whatever else there is, and a parameter that may be replaced.
            let extra = r#"blocks: { "own_1": Constant(value: "own"), "own_2": Constant(value: "own"), "own_3": Gain(k: 3), "own_4": Gain(k: 3), "#;
            assert_eq!(text.matches("blocks: {").count(), 1, "{text}");
            let text = text.replacen("connections: [", "connections: [\"own_1.y -> own_3.u, own_4.u\", ", 1);
            let text = text.replacen("blocks: {", &format!("parameters: {{ \"own\": 2 }}, {extra}"), 1);
            let desk = Desk::new().with("model.ron", &text);
            let model = |set: &[&str]| {
                let (compiled, problems) = compile_with(&desk, "model.ron".as_ref(), set);
                compiled.schedule.unwrap_or_else(|| panic!("{problems}"))
            };
            found += compare(&format!("seed {seed}"), &model(&[]), &model(&["own=2"]));
        }
    }
    assert!(found >= 160, "{found} blocks were shared");
}
