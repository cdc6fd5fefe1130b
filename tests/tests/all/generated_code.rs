//! Code for targets of whole diagrams, of every block that has an example and of random models, held against the engine.

use std::path::Path;
use std::process::Command;

use blocksim_block::schedule::Schedule;
use blocksim_codegen::{Method, Part, Target, generate};
use blocksim_tests::random::{Puzzle, Sampled, Signals, Variant};
use blocksim_tests::{compile_file, compile_text, diagrams_below, root};

/// Exports, compiles and runs a diagram; `None` if it is refused.
fn agree(name: &str, schedule: &Schedule, folder: &Path, wrong: &mut Vec<String>) -> Option<()> {
    let rates = schedule.clock.rates.iter().map(|rate| schedule.clock.time(rate.period));
    let step = rates.fold(1e-3, f64::min);
    let target =
        Target { name: "made".to_owned(), step, method: Some(Method::Rk4), float: false, test_steps: 1000 };
    let made = generate(schedule, &Part::whole(schedule), &target).ok()?;
    for (file, text) in &made.files {
        std::fs::write(folder.join(file), text).expect("a file");
    }
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-O1"])
        .args(["made.c", "made_test.c", "-lm", "-o", "made"])
        .current_dir(folder)
        .output()
        .expect("a compiler of C named cc");
    if !compiled.status.success() {
        wrong.push(format!("{name}: {}", String::from_utf8_lossy(&compiled.stderr)));
        return Some(());
    }
    let ran = Command::new(folder.join("made")).output().expect("a program");
    if !ran.status.success() {
        wrong.push(format!("{name}: {}", String::from_utf8_lossy(&ran.stdout)));
    }
    Some(())
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("blocksim-generated-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn examples_of_blocks_have_the_bits_of_the_engine_in_c() {
    let folder = folder("examples");
    let (mut made, mut wrong) = (Vec::new(), Vec::new());
    for path in diagrams_below("docs/blocks") {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        made.extend(agree(&name, &schedule, &folder, &mut wrong).map(|()| name));
    }
    std::fs::remove_dir_all(&folder).expect("a folder of its own");
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), made.len(), wrong.join("\n"));
    assert!(made.len() >= 20, "only {} examples were exported: {made:?}", made.len());
}

#[test]
fn random_models_have_the_bits_of_the_engine_in_c() {
    fn random<P: Puzzle>(class: &str, folder: &Path, wrong: &mut Vec<String>) -> usize {
        let of_seed = |seed: u64| {
            let (compiled, problems) = compile_text(&P::of(seed).text(&Variant::plain()));
            compiled.schedule.unwrap_or_else(|| panic!("{class} {seed}: {problems}"))
        };
        (1..201).filter_map(|seed| agree(&format!("{class} {seed}"), &of_seed(seed), folder, wrong)).count()
    }
    let folder = folder("random");
    let mut wrong = Vec::new();
    let made =
        random::<Sampled>("sampled", &folder, &mut wrong) + random::<Signals>("signals", &folder, &mut wrong);
    std::fs::remove_dir_all(&folder).expect("a folder of its own");
    assert!(wrong.is_empty(), "{} of {made}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(made >= 25, "only {made} models were exported");
}
