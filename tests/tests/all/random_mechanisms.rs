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

/// Four-bar linkages with dry friction on the rocker, whose loop has drifted by the error of the steps when the rocker turns
/// round: the crank goes on as if nothing had happened.
#[test]
fn a_rocker_turns_round_and_the_crank_does_not_notice() {
    for seed in [308, 724, 1585] {
        if let Finding::Wrong(_, what) = Mechanisms::of(seed).judge("") {
            panic!("seed {seed}: {what}");
        }
    }
}
