//! Random mechanisms at default settings, against equations of Lagrange in least coordinates.
//!
//! `BLOCKSIM_RANDOM=2000:1 cargo test --release -p blocksim-tests random_mechanisms` runs 2000 models from seed 1 on; the program
//! `random_models --class mechanisms` of this crate does the same and shrinks what fails.

use blocksim_tests::random::{Finding, Mechanisms, Puzzle};

/// Number of models and the first seed.
fn asked() -> (u64, u64) {
    let asked = std::env::var("BLOCKSIM_RANDOM").unwrap_or_default();
    let mut parts = asked.split(':').map(|part| part.parse().ok());
    (parts.next().flatten().unwrap_or(16), parts.next().flatten().unwrap_or(1))
}

#[test]
fn random_mechanisms_move_as_the_reference_says() {
    let (count, first) = asked();
    let (mut decided, mut wrong) = (0, Vec::new());
    for seed in first..first + count {
        match Mechanisms::of(seed).judge("") {
            Finding::Undecided(_) => continue,
            Finding::Right => {}
            Finding::Wrong(_, what) => wrong.push(format!("seed {seed}: {what}")),
        }
        decided += 1;
    }
    assert!(10 * decided > 7 * count, "{decided} of {count} models are decided");
    assert!(wrong.is_empty(), "{} of {decided}:\n{}", wrong.len(), wrong.join("\n"));
}
