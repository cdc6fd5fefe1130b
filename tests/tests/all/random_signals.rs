//! Random models of signals, run by the engine with default settings and by an interpreter that shares nothing with it.
//!
//! `BLOCKSIM_RANDOM=2000:1 cargo test --release -p blocksim-tests random_models` runs 2000 models from seed 1 on; the
//! program `random_models` of this crate does the same and shrinks what fails.

use blocksim_tests::random::{Variant, Verdict, compare, diagram, generate, judge, refer, vary};

/// Number of models and the first seed.
fn asked() -> (u64, u64) {
    let asked = std::env::var("BLOCKSIM_RANDOM").unwrap_or_default();
    let mut parts = asked.split(':').map(|part| part.parse().ok());
    (parts.next().flatten().unwrap_or(30), parts.next().flatten().unwrap_or(1))
}

#[test]
fn random_models_come_out_as_the_reference_says() {
    let (count, first) = asked();
    let (mut decided, mut wrong) = (0, Vec::new());
    for seed in first..first + count {
        let model = generate(seed);
        let verdict = judge(&model, &Variant::plain());
        if matches!(verdict, Verdict::Undecided(_)) {
            continue;
        }
        decided += 1;
        if let Verdict::Wrong(faults) = verdict {
            wrong.push(format!("seed {seed}: {:?}", faults[0]));
        }
    }
    assert!(2 * decided > count, "{decided} of {count} models are decided");
    assert!(wrong.is_empty(), "{} of {decided}:\n{}", wrong.len(), wrong.join("\n"));
}

/// The same model in other words: methods, tolerances, names, rows, a stranger beside it.
#[test]
fn how_a_model_is_put_does_not_matter() {
    let mut wrong = Vec::new();
    for seed in [9, 11, 15, 21] {
        let model = generate(seed);
        let outcome = refer(&model).expect("a model that can be decided");
        for variant in vary() {
            if let Verdict::Wrong(faults) = compare(&model, &outcome, &variant) {
                wrong.push(format!("seed {seed}, {}: {:?}", variant.name, faults[0]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_seed_makes_one_model_and_its_diagram() {
    let text = |seed| diagram(&generate(seed), &Variant::plain());
    assert_eq!(text(7), text(7));
    assert_ne!(text(7), text(8));
}
