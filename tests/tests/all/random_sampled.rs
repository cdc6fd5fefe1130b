//! Random loops of sampled control at default settings, against exact plants and difference equations.
//!
//! `BLOCKSIM_RANDOM=2000:1 cargo test --release -p blocksim-tests random_sampled` runs 2000 models from seed 1 on; the program
//! `random_models --class sampled` of this crate does the same and shrinks what fails.

use blocksim_tests::random::{Finding, Puzzle, Sampled};

/// Number of models and the first seed.
fn asked() -> (u64, u64) {
    let asked = std::env::var("BLOCKSIM_RANDOM").unwrap_or_default();
    let mut parts = asked.split(':').map(|part| part.parse().ok());
    (parts.next().flatten().unwrap_or(100), parts.next().flatten().unwrap_or(1))
}

#[test]
fn random_sampled_loops_come_out_as_the_reference_says() {
    let (count, first) = asked();
    let (mut decided, mut wrong) = (0, Vec::new());
    for seed in first..first + count {
        match Sampled::of(seed).judge("") {
            Finding::Undecided(_) => continue,
            Finding::Right => {}
            Finding::Wrong(_, what) => wrong.push(format!("seed {seed}: {what}")),
        }
        decided += 1;
    }
    assert!(10 * decided > 9 * count, "{decided} of {count} models are decided");
    assert!(wrong.is_empty(), "{} of {decided}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Every method finds the same samples: what is held is exact, so that only the plants are off.
#[test]
fn sampled_loops_come_out_the_same_by_every_method() {
    let mut wrong = Vec::new();
    for method in [
        "Ode23(rtol: 1e-7)",
        "Rodas4(rtol: 1e-7)",
        "RosW3(rtol: 1e-8)",
        "Ode15s(rtol: 1e-8)",
        "Radau5(rtol: 1e-7)",
    ] {
        for seed in [1, 4, 7, 12] {
            let settings = format!(", solver: {method}");
            if let Finding::Wrong(_, what) = Sampled::of(seed).judge(&settings) {
                wrong.push(format!("seed {seed}, {method}: {what}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
