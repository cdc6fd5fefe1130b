//! States within a step of the implicit methods, as rows have them.

use blocksim_solve::problems::{function, swing, swing_solution};
use blocksim_solve::{Ode23t, Ode23tb, Radau5, Rodas4, StepLimits, Stepper, System, Tolerances};

type Make = fn(Tolerances, StepLimits) -> Box<dyn Stepper>;

const METHODS: [Make; 4] = [
    |tolerances, limits| Box::new(Rodas4::new(tolerances, limits)),
    |tolerances, limits| Box::new(Radau5::new(tolerances, limits)),
    |tolerances, limits| Box::new(Ode23t::new(tolerances, limits)),
    |tolerances, limits| Box::new(Ode23tb::new(tolerances, limits)),
];

/// Makes steps until `end`, and looks at nine states within each and at its end.
fn watch(
    make: Make,
    system: &mut dyn System,
    start: &[f64],
    (relative, end): (f64, f64),
    mut look: impl FnMut(f64, &[f64], bool),
) {
    let mut stepper = make(Tolerances::uniform(start.len(), relative, relative), StepLimits::default());
    let (mut t, mut x, mut y) = (0.0, start.to_vec(), start.to_vec());
    while t < end {
        stepper.step(system, &mut t, &mut x, end).unwrap();
        stepper.sharpen_rows(system);
        let spent = stepper.counts().evaluations;
        stepper.sharpen_rows(system);
        assert_eq!(stepper.counts().evaluations, spent, "once is enough");
        let (t0, t1) = stepper.last_step();
        for part in 1..10 {
            let t = t0 + (t1 - t0) * f64::from(part) / 10.0;
            stepper.interpolate(t, &mut y);
            look(t, &y, false);
        }
        look(t, &x, true);
    }
}

/// What follows cos t a million times as fast as that changes, without coming from anywhere else, after A. Prothero,
/// A. Robinson: On the stability and accuracy of one-step methods, Math. Comp. 28 (1974), doi 10.1090/S0025-5718-1974-0331793-2.
fn follower() -> impl System {
    function(1, |t: f64, x, dx| dx[0] = -1e6 * (x[0] - t.cos()) - t.sin())
}

#[test]
fn rows_of_a_stiff_state_are_about_as_exact_as_the_tolerance_says() {
    for (index, make) in METHODS.into_iter().enumerate() {
        // The last two make steps of order 2, which tell less of what is between.
        let most = if index < 2 { 3.0 } else { 15.0 };
        for relative in [1e-3, 1e-6] {
            let mut largest: f64 = 0.0;
            let look = |t: f64, x: &[f64], _| largest = largest.max((x[0] - t.cos()).abs() / relative);
            watch(make, &mut follower(), &[1.0], (relative, 10.0), look);
            assert!(largest < most, "{index}, {relative:e}: {largest} tolerances");
        }
    }
}

#[test]
fn rows_of_a_state_that_is_not_stiff_are_about_as_exact_as_the_ends_of_steps() {
    for (index, make) in METHODS.into_iter().enumerate() {
        let mut largest = [0.0_f64; 2];
        let look = |t: f64, x: &[f64], end| {
            let [a, b] = swing_solution(t);
            let largest = &mut largest[usize::from(end)];
            *largest = largest.max((x[0] - a).hypot(x[1] - b));
        };
        watch(make, &mut swing(), &[0.0, 1.0], (1e-6, 10.0), look);
        let [within, end] = largest;
        assert!(within < 1.5 * end + 3e-6, "{index}: {within:e} and {end:e}");
    }
}

#[test]
fn what_is_conserved_linearly_is_conserved_within_steps() {
    // Three vessels, two of them joined by a wide pipe, the last by a narrow one: stiff and not at once.
    let vessels = || {
        function(3, |_, x, dx| {
            let (wide, narrow) = (1e5 * (x[0] - x[1]), (x[1] - x[2]) * (1.0 + x[2] * x[2]));
            dx.copy_from_slice(&[-wide, wide - narrow, narrow]);
        })
    };
    for (index, make) in METHODS.into_iter().enumerate() {
        let look = |t: f64, x: &[f64], _| {
            let sum: f64 = x.iter().sum();
            assert!((sum - 3.0).abs() < 1e-9, "{index}: {sum} at {t}");
        };
        watch(make, &mut vessels(), &[2.0, 1.0, 0.0], (1e-4, 5.0), look);
    }
}

#[test]
fn what_begins_to_move_leaves_with_the_slope_it_has() {
    // A body that has just broken away: its speed begins as t^2.
    for make in METHODS {
        let mut body = function(2, |t: f64, x, dx| dx.copy_from_slice(&[x[1], t * t.cos() - x[0]]));
        let limits = StepLimits { first: Some(0.1), ..StepLimits::default() };
        let mut stepper = make(Tolerances::uniform(2, 1e-3, 1e-3), limits);
        let (mut t, mut x, mut y) = (0.0, [0.0; 2], [0.0; 2]);
        stepper.step(&mut body, &mut t, &mut x, 1.0).unwrap();
        stepper.sharpen_rows(&mut body);
        stepper.interpolate(1e-6 * t, &mut y);
        // As steep as a thousandth of the way at most.
        assert!(y[1].abs() < 1e-9 * x[1], "{y:?} on the way to {x:?}");
    }
}
