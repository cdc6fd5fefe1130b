//! Random models at default settings, each class against a reference of its own.
//!
//! The program `random_models` of this crate runs thousands of them and shrinks what fails.

use blocksim_sim::{Control, verify};
use blocksim_tests::compile_text;
use blocksim_tests::random::{
    Circuit, Finding, Joint, Mechanisms, Puzzle, Sampled, Shafts, Signals, Torque, Variant, survey, vary,
};

/// Judges the models of these seeds; at least this part of them must be decided.
fn check<P: Puzzle>(seeds: std::ops::Range<u64>, part: f64) {
    let survey = survey::<P>(seeds.clone(), &Variant::plain(), P::judge, |_, _, _| {});
    let wrong: Vec<String> = survey
        .wrong
        .iter()
        .map(|(seed, fault)| format!("seed {seed}: {}: {}", fault.kind, fault.what))
        .collect();
    assert!(wrong.is_empty(), "{survey}{}", wrong.join("\n"));
    assert!(survey.decided() as f64 >= part * survey.count as f64, "{survey}");
}

/// No watched condition of the models of these seeds is passed over.
fn nothing_is_missed<P: Puzzle>(seeds: std::ops::Range<u64>) {
    let survey = survey::<P>(seeds, &Variant::plain(), P::audit, |_, _, _| {});
    assert!(survey.wrong.is_empty(), "{survey}{:?}", survey.wrong);
}

/// The model of a seed comes out as the reference says, put in each of these ways.
fn comes_out<P: Puzzle>(seeds: &[u64], variants: &[Variant]) {
    let mut wrong = Vec::new();
    for &seed in seeds {
        let model = P::of(seed);
        for variant in variants {
            match model.judge(variant) {
                Finding::Right => {}
                finding => {
                    wrong.push(format!("seed {seed}, {} {}: {finding:?}", variant.name, variant.settings))
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The largest part of its range by which a signal of a model at default settings differs from a run that is more exact.
fn verified<P: Puzzle>(seed: u64) -> f64 {
    let (compiled, problems) = compile_text(&P::of(seed).text(&Variant::plain()));
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let found = verify(&schedule, &mut || Control::Go).unwrap().unwrap();
    found.differences.first().map_or(0.0, |worst| worst.share)
}

#[test]
fn where_a_model_amplifies_errors_a_verification_says_so() {
    // Their runs at default settings are off by more than the judge allows, and are right at a tighter tolerance.
    for (name, least, share) in [
        ("shafts 50361", 1e-3, verified::<Shafts>(50361)),
        ("shafts 50699", 1e-3, verified::<Shafts>(50699)),
        ("shafts 51485", 1e-3, verified::<Shafts>(51485)),
        ("shafts 61037", 1e-3, verified::<Shafts>(61037)),
        ("mechanisms 51404", 1e-3, verified::<Mechanisms>(51404)),
        ("mechanisms 51751", 4e-4, verified::<Mechanisms>(51751)),
        ("mechanisms 51832", 1e-3, verified::<Mechanisms>(51832)),
        ("mechanisms 61752", 1e-3, verified::<Mechanisms>(61752)),
        ("circuits 50751", 2e-4, verified::<Circuit>(50751)),
    ] {
        assert!(share > least, "{name}: {share:e}");
    }
    // One that was among them is right since its method does not begin anew for what is only recorded.
    assert!(matches!(Circuit::of(51453).judge(&Variant::plain()), Finding::Right));
    // Ordinary ones are not blamed.
    for seed in 1..9 {
        let shares = [verified::<Shafts>(seed), verified::<Signals>(seed)];
        assert!(shares.iter().all(|share| *share < 1e-4), "{seed}: {shares:?}");
    }
}

#[test]
fn random_signals_come_out_as_an_interpreter_says() {
    check::<Signals>(1..31, 0.6);
}

#[test]
fn random_sampled_loops_come_out_as_difference_equations_say() {
    check::<Sampled>(1..101, 0.85);
}

#[test]
fn random_mechanisms_move_as_equations_of_lagrange_say() {
    check::<Mechanisms>(1..17, 0.7);
}

#[test]
fn random_circuits_behave_as_fixed_steps_say() {
    check::<Circuit>(1..25, 0.8);
}

#[test]
fn random_shafts_move_as_time_stepping_says() {
    check::<Shafts>(1..25, 0.8);
}

/// The same model in other words: methods, tolerances, names, rows, a stranger beside it.
#[test]
fn how_a_model_is_put_does_not_matter() {
    comes_out::<Signals>(&[9, 11, 15, 21], &vary());
    comes_out::<Shafts>(&[3, 8], &vary());
}

/// Every method finds the same samples: what is held is exact, so that only the plants are off.
#[test]
fn sampled_loops_come_out_the_same_by_every_method() {
    let methods = [
        "Ode23(rtol: 1e-7)",
        "Rodas4(rtol: 1e-7)",
        "RosW3(rtol: 1e-8)",
        "Ode15s(rtol: 1e-8)",
        "Radau5(rtol: 1e-7)",
    ];
    let variants = methods.map(|method| Variant::with(&format!(", solver: {method}")));
    comes_out::<Sampled>(&[1, 4, 7, 12], &variants);
}

/// Valves change at the same instants by every method.
#[test]
fn circuits_behave_the_same_by_every_method() {
    let methods = ["Ode45", "Ode23", "Rodas4", "RosW3", "Ode15s", "Radau5"];
    let variants = methods.map(|method| Variant::with(&format!(", solver: {method}")));
    comes_out::<Circuit>(&[1, 2, 3, 4, 5, 6, 7, 8], &variants);
}

/// Frictions of very different size hold each other, some of them twice.
#[test]
fn frictions_that_share_what_they_hold_neither_chatter_nor_slip() {
    let friction = |a, b, torque| (a, b, Joint::Friction(torque, None));
    let spring = |a, b, k, d| (a, b, Joint::Spring { k, d });
    let freewheel = |a, b| (a, Some(b), Joint::Freewheel);
    let sine = |disc, amplitude, frequency| (disc, Torque::Sine { amplitude, frequency });
    let step = |disc, time, before, after| (disc, Torque::Step { time, before, after });
    let models = [
        Shafts {
            discs: vec![(0.244, -13.8), (0.121, 1.7), (0.3, 0.0), (0.829, 0.0), (0.872, 0.0)],
            joints: vec![
                friction(1, None, 2.06),
                spring(1, None, 9.88, 0.0794),
                spring(4, None, 9.43, 0.223),
                friction(0, Some(1), 1.25),
                freewheel(2, 1),
                freewheel(3, 2),
                friction(3, Some(1), 0.463),
                friction(4, Some(3), 3.85),
            ],
            torques: vec![
                step(0, 0.846, 2.14, -0.15),
                step(2, 0.659, 2.5, -4.05),
                sine(3, 0.631, 3.72),
                sine(4, 1.29, 0.608),
            ],
            stop: 2.0,
        },
        Shafts {
            discs: vec![(0.208, 0.0), (0.372, 0.0), (0.0847, -9.31), (0.136, 0.0), (0.128, 0.0)],
            joints: vec![
                friction(0, None, 0.0599),
                friction(2, None, 0.0514),
                friction(3, None, 0.235),
                spring(3, None, 13.4, 0.0262),
                friction(4, None, 2.93),
                freewheel(1, 0),
                freewheel(1, 2),
                freewheel(1, 2),
                freewheel(3, 2),
                friction(3, Some(2), 3.62),
                friction(3, Some(4), 3.5),
                friction(3, Some(4), 2.91),
            ],
            torques: vec![step(0, 0.345, 0.115, -1.59), sine(1, 5.34, 3.37), sine(4, 3.85, 1.3)],
            stop: 2.0,
        },
        Shafts {
            discs: vec![(0.139, 0.0), (0.0894, -1.39), (0.247, 0.0), (0.528, 0.0), (0.116, 0.0)],
            joints: vec![
                friction(0, None, 0.865),
                friction(1, None, 0.537),
                friction(3, None, 1.55),
                friction(4, None, 0.641),
                friction(1, Some(0), 0.63),
                friction(2, Some(1), 0.21),
                freewheel(1, 2),
                spring(3, Some(2), 15.5, 0.587),
                freewheel(2, 3),
                friction(3, Some(4), 0.535),
            ],
            torques: vec![sine(1, 4.39, 2.8), step(4, 0.269, 0.146, -3.42)],
            stop: 2.0,
        },
        Shafts {
            discs: vec![(0.259, 2.81), (0.213, 0.0), (0.14, -7.69), (0.125, 0.0)],
            joints: vec![
                friction(0, None, 1.16),
                friction(2, None, 0.357),
                friction(3, None, 0.38),
                friction(0, Some(1), 1.01),
                freewheel(0, 1),
                friction(2, Some(1), 1.14),
                freewheel(1, 2),
                freewheel(2, 3),
            ],
            torques: vec![sine(2, 1.74, 1.37)],
            stop: 2.0,
        },
    ];
    for (i, shafts) in models.iter().enumerate() {
        for method in ["Auto", "Ode45(rtol: 1e-8)", "Ode23", "Rodas4", "RosW3", "Ode15s", "Radau5"] {
            let finding = shafts.judge(&Variant::with(&format!(", solver: {method}")));
            assert_eq!(finding, Finding::Right, "model {i}, {method}");
        }
    }
}

/// Four-bar linkages with dry friction on the rocker, whose loop has drifted by the error of the steps when the rocker turns
/// round: the crank goes on as if nothing had happened.
#[test]
fn a_rocker_turns_round_and_the_crank_does_not_notice() {
    comes_out::<Mechanisms>(&[308, 724, 1585], &[Variant::plain()]);
}

/// A clutch that is let go while it is locked, one side of which a soft end of travel then pushes from rest.
#[test]
fn a_clutch_that_nothing_presses_does_not_chatter() {
    comes_out::<Shafts>(&[20538], &[Variant::plain()]);
}

/// An integral of a low-passed sine, which grows as the fourth power of time, sets another one back where it falls through zero; a
/// dead time whose output goes round in its own input without loss; a crossing that was found to the last digit, behind which rounding
/// has the sign of before.
#[test]
fn what_begins_flatly_and_what_goes_round_for_ever_come_out() {
    comes_out::<Signals>(&[21802, 20813, 21557], &[Variant::plain()]);
}

#[test]
fn a_seed_makes_one_model_and_its_diagram() {
    let text = |seed| Signals::of(seed).text(&Variant::plain());
    assert_eq!(text(7), text(7));
    assert_ne!(text(7), text(8));
}

/// Nobody knows what comes out of more models, but that no change of a condition may be passed over.
#[test]
fn no_random_model_passes_over_a_change_of_a_condition() {
    nothing_is_missed::<Signals>(50_844..50_854);
    nothing_is_missed::<Sampled>(50_001..50_011);
    nothing_is_missed::<Shafts>(50_284..50_294);
    nothing_is_missed::<Circuit>(50_001..50_009);
    nothing_is_missed::<Mechanisms>(50_001..50_004);
}
