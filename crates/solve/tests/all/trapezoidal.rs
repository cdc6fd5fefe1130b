//! `Ode23tb` and `Ode23t`: stiff problems of the literature, what is damped and what is not. Counts are exact.

use blocksim_solve::problems::{
    HIRES_START, ProtheroRobinson, function, heat, hires, oregonator, robertson, van_der_pol,
};
use blocksim_solve::{Counts, Ode23t, Ode23tb, Radau5, StepLimits, Stepper, System, Tolerances, integrate};

/// Both methods with automatic absolute tolerances.
fn both(n: usize, relative: f64) -> [Box<dyn Stepper>; 2] {
    let tolerances = Tolerances::automatic(n, relative);
    [
        Box::new(Ode23tb::new(tolerances.clone(), StepLimits::default())),
        Box::new(Ode23t::new(tolerances, StepLimits::default())),
    ]
}

/// Runs from `start` at zero to `end`.
fn run(stepper: &mut dyn Stepper, system: &mut dyn System, start: &[f64], end: f64) -> Vec<f64> {
    let (mut t, mut x) = (0.0, start.to_vec());
    integrate(stepper, system, &mut t, &mut x, end).unwrap();
    x
}

#[test]
fn stiff_problems_end_where_they_should() {
    type Make = fn() -> Box<dyn System>;
    type Case<'a> = (&'a str, Make, &'a [f64], f64, f64, f64);
    // What an error counts against at least, and how much the problem itself multiplies errors: the spike of the Oregonator ends
    // just before the end of the run, the oscillator has jumped just after its middle.
    let cases: [Case; 4] = [
        ("Van der Pol", || Box::new(van_der_pol(1000.0)), &[2.0, 0.0], 2000.0, 0.0, 40.0),
        ("Robertson", || Box::new(robertson()), &[1.0, 0.0, 0.0], 1e11, 1e-3, 1.0),
        ("HIRES", || Box::new(hires()), &HIRES_START, 321.8122, 0.0, 100.0),
        ("Oregonator", || Box::new(oregonator()), &[1.0, 2.0, 3.0], 360.0, 0.0, 400.0),
    ];
    let mut all = Vec::new();
    for (name, make, start, end, least, within) in cases {
        let n = start.len();
        let mut exact = Radau5::new(Tolerances::automatic(n, 1e-10), StepLimits::default());
        let expected = run(&mut exact, &mut *make(), start, end);
        let mut found = [[0; 2]; 2];
        for (k, relative) in [1e-3, 1e-4].into_iter().enumerate() {
            for (m, mut stepper) in both(n, relative).into_iter().enumerate() {
                found[m][k] = 0;
                // The oscillator needs more digits than three where nothing else damps its speed.
                if (name, stepper.name(), k) == ("Van der Pol", "Ode23t", 0) {
                    continue;
                }
                let x = run(&mut *stepper, &mut *make(), start, end);
                let part = |(x, e): (&f64, &f64)| (x - e).abs() / e.abs().max(least);
                let error = x.iter().zip(&expected).map(part).fold(0.0, f64::max);
                assert!(error < within * relative, "{name}, {}, {relative:e}: {error:e}", stepper.name());
                found[m][k] = stepper.counts().evaluations;
            }
        }
        all.push(found);
    }
    assert_eq!(all, PINNED);
}

/// Evaluations of the problems above by `Ode23tb` and `Ode23t`.
const PINNED: [[[u64; 2]; 2]; 4] = [
    [[1792, 2970], [0, 2442]],
    [[1319, 2506], [1044, 1968]],
    [[923, 1541], [1034, 1622]],
    [[2590, 3943], [2371, 3331]],
];

#[test]
fn what_is_fast_fades_at_once_and_costs_no_steps() {
    for rate in [1e3, 1e6, 1e9] {
        for mut stepper in both(1, 1e-4) {
            let x = run(&mut *stepper, &mut ProtheroRobinson::new(rate), &[0.0], 10.0);
            assert!((x[0] - 10f64.sin()).abs() < 1e-3, "{} at {rate:e}: {x:?}", stepper.name());
            // A state beside its way: the error is there, and must be gone after a step.
            let Counts { accepted, .. } = stepper.counts();
            assert!(accepted < 300, "{} at {rate:e}: {accepted}", stepper.name());
            let (mut t, mut x) = (10.0, vec![10f64.sin() + 0.1]);
            stepper.restart();
            integrate(&mut *stepper, &mut ProtheroRobinson::new(rate), &mut t, &mut x, 10.5).unwrap();
            assert!((x[0] - 10.5f64.sin()).abs() < 1e-3, "{} at {rate:e}: {x:?}", stepper.name());
        }
    }
}

#[test]
fn an_oscillation_beside_what_is_stiff_keeps_its_amplitude_with_the_trapezoidal_rule_alone() {
    // A thousand periods, and a state that follows one of the swinging ones within a microsecond.
    let mut energies = Vec::new();
    for mut stepper in both(3, 1e-2) {
        let mut system = function(3, |_, x, dx| {
            (dx[0], dx[1]) = (x[1], -x[0]);
            dx[2] = 1e6 * (x[0] - x[2]);
        });
        let x = run(&mut *stepper, &mut system, &[1.0, 0.0, 1.0], 1000.0 * std::f64::consts::TAU);
        assert!((x[2] - x[0]).abs() < 1e-2, "{}: {x:?}", stepper.name());
        energies.push(x[0] * x[0] + x[1] * x[1]);
    }
    assert!(energies[0] < 0.5 && (energies[1] - 1.0).abs() < 0.05, "{energies:?}");
}

#[test]
fn a_jump_that_nobody_announces_does_not_ring() {
    // What follows within a microsecond a square wave that no restart tells of, seen within all steps behind the jump.
    for mut stepper in both(2, 1e-4) {
        let level = |t: f64| if t < 0.5 { 1.0 } else { 2.0 };
        let mut system = function(2, move |t: f64, x, dx| {
            dx[0] = 1e6 * (level(t) - x[0]);
            dx[1] = x[0];
        });
        let (mut t, mut x) = (0.0, vec![1.0, 0.0]);
        while t < 1.0 {
            stepper.step(&mut system, &mut t, &mut x, 1.0).unwrap();
            let (t0, t1) = stepper.last_step();
            let mut y = [0.0; 2];
            for theta in [0.25, 0.5, 0.75] {
                stepper.interpolate(t0 + theta * (t1 - t0), &mut y);
                assert!(y[0] > 0.9 && y[0] < 2.1, "{} at {t}: {y:?}", stepper.name());
                if t0 > 0.51 {
                    assert!((y[0] - 2.0).abs() < 1e-3, "{} at {t}: {y:?}", stepper.name());
                }
            }
        }
        assert!((x[1] - 1.5).abs() < 1e-3, "{}: {x:?}", stepper.name());
    }
}

#[test]
fn a_rod_of_a_thousand_cells_is_solved_with_a_sparse_jacobian() {
    for (mut stepper, evaluations) in both(1000, 1e-4).into_iter().zip([4393, 3110]) {
        let x = run(&mut *stepper, &mut heat(1000), &vec![0.0; 1000], 1.0);
        // See `stiff.rs`.
        for (i, x) in x.iter().enumerate() {
            let s = (i as f64 + 1.0) / 1000.0;
            let term = |k: f64| {
                let w = std::f64::consts::PI * k / 2.0;
                2.0 / w * (w * s / 1.0005).sin() * (-(w / 1.0005).powi(2)).exp()
            };
            let expected = 1.0 - term(1.0) - term(3.0);
            assert!((x - expected).abs() < 2e-3, "{}, {i}: {x} {expected}", stepper.name());
        }
        assert_eq!(stepper.counts().evaluations, evaluations, "{}", stepper.name());
    }
}
