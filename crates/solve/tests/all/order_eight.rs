//! `Dop853` at the tolerances that it is for. Counts are exact.

use blocksim_solve::problems::{PLEIADES, arenstorf, pleiades};
use blocksim_solve::{Dop853, Ode45, StepLimits, Stepper, System, Tolerances, integrate};

/// Runs from `start` to `end`; returns the largest distance from `expected`, and the evaluations.
fn run(
    stepper: &mut dyn Stepper,
    system: &mut dyn System,
    start: &[f64],
    end: f64,
    expected: &[f64],
) -> (f64, u64) {
    let (mut t, mut x) = (0.0, start.to_vec());
    integrate(stepper, system, &mut t, &mut x, end).unwrap();
    let error = x.iter().zip(expected).map(|(x, e)| (x - e).abs()).fold(0.0, f64::max);
    (error, stepper.counts().evaluations)
}

#[test]
fn a_closed_orbit_is_closed_to_the_tolerance_with_a_fraction_of_the_work() {
    // E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary Differential Equations I, section II.0: the orbit of Arenstorf.
    let (start, period) = ([0.994, 0.0, 0.0, -2.001_585_106_379_082_5], 17.065_216_560_157_964);
    let mut found = Vec::new();
    for relative in [1e-8, 1e-10, 1e-12] {
        let tolerances = || (Tolerances::uniform(4, relative, relative), StepLimits::default());
        let mut eighth = Dop853::new(tolerances().0, tolerances().1);
        let mut fifth = Ode45::new(tolerances().0, tolerances().1);
        let (error, work) = run(&mut eighth, &mut arenstorf(), &start, period, &start);
        let (other, more) = run(&mut fifth, &mut arenstorf(), &start, period, &start);
        // Passing the moon multiplies errors by ten thousand.
        assert!(error < 2e5 * relative && other < 2e6 * relative, "{relative:e}: {error:e} {other:e}");
        found.push((work, more));
    }
    assert_eq!(found, [(2111, 2162), (3350, 5054), (5012, 12692)]);
}

#[test]
fn the_pleiades_agree_with_the_literature_in_all_its_digits() {
    let mut stepper = Dop853::new(Tolerances::automatic(28, 1e-13), StepLimits::default());
    let (error, _) = run(&mut stepper, &mut pleiades(), &PLEIADES, 3.0, &crate::stiff::STARS);
    assert!(error < 1e-9, "{error:e}");
}

#[test]
fn the_state_in_between_is_as_exact_as_the_ends() {
    let mut stepper = Dop853::new(Tolerances::uniform(2, 1e-12, 1e-12), StepLimits::default());
    let mut swing = blocksim_solve::problems::function(2, |_, x, dx| (dx[0], dx[1]) = (x[1], -x[0]));
    let (mut t, mut x, mut y) = (0.0, [1.0, 0.0], [0.0; 2]);
    while t < 20.0 {
        stepper.step(&mut swing, &mut t, &mut x, 20.0).unwrap();
        let (t0, t1) = stepper.last_step();
        for theta in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let between = t0 + theta * (t1 - t0);
            stepper.interpolate(between, &mut y);
            let error = (y[0] - between.cos()).hypot(y[1] + between.sin());
            assert!(error < 1e-11, "{between}: {error:e}");
        }
    }
}

#[test]
fn a_stage_of_the_extension_that_leaves_the_domain_rejects_the_step() {
    // Not a number between 0.3 and 0.31 of the time, where the twelve stages of some trial do not look.
    let mut system = blocksim_solve::problems::function(1, |t: f64, _, dx| {
        dx[0] = if (0.3..0.31).contains(&t) { f64::NAN } else { 1.0 };
    });
    let limits = StepLimits { first: Some(0.39), ..StepLimits::default() };
    let mut stepper = Dop853::new(Tolerances::uniform(1, 1e-6, 1e-6), limits);
    let (mut t, mut x) = (0.0, [0.0]);
    stepper.step(&mut system, &mut t, &mut x, 1.0).unwrap();
    assert!(t < 0.3 && stepper.counts().rejected > 0, "{t} {:?}", stepper.counts());
}
