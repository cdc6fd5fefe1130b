//! Work and accuracy on known problems. The counts are exact: a change of one of them is a change of the method.

use blocksim_solve::problems::{Coupling, Motor, ProtheroRobinson, robertson, van_der_pol};
use blocksim_solve::{
    Counts, Ode23, Ode45, Rodas4, Ros34pw2, StepLimits, Stepper, System, Tolerances, integrate,
};

/// Runs to `end` and returns the final state.
fn run<const N: usize>(
    stepper: &mut dyn Stepper,
    system: &mut dyn System,
    mut x: [f64; N],
    end: f64,
) -> [f64; N] {
    let mut t = 0.0;
    integrate(stepper, system, &mut t, &mut x, end).unwrap();
    assert_eq!(t, end);
    x
}

fn tolerances(n: usize, relative: f64, absolute: f64) -> (Tolerances, StepLimits) {
    (Tolerances::uniform(n, relative, absolute), StepLimits::default())
}

/// (evaluations, accepted, rejected)
fn work(counts: Counts) -> (u64, u64, u64) {
    (counts.evaluations, counts.accepted, counts.rejected)
}

/// At t = 100 with mu = 5; Ode45 and Rodas4 at a tolerance of 1e-12 agree to 1e-11.
const RELAXATION: [f64; 2] = [-1.82462356754, 0.15467348353];

#[test]
fn van_der_pol_with_mu_5() {
    let tolerances = || tolerances(2, 1e-6, 1e-9);
    let (mut ode45, mut ode23, mut rodas4, mut ros34pw2) = (
        Ode45::new(tolerances().0, tolerances().1),
        Ode23::new(tolerances().0, tolerances().1),
        Rodas4::new(tolerances().0, tolerances().1),
        Ros34pw2::new(tolerances().0, tolerances().1),
    );
    let steppers: [(&mut dyn Stepper, _); 4] = [
        (&mut ode45, (10718, 1631, 155)),
        (&mut ode23, (25940, 8577, 69)),
        (&mut rodas4, (35660, 3189, 116)),
        (&mut ros34pw2, (48697, 12105, 92)),
    ];
    for (stepper, expected) in steppers {
        let x = run(stepper, &mut van_der_pol(5.0), [2.0, 0.0], 100.0);
        // Errors of the relative tolerance add up over the steps.
        assert!((x[0] - RELAXATION[0]).abs() < 2e-5, "{}: {x:?}", stepper.name());
        assert_eq!(work(stepper.counts()), expected, "{}", stepper.name());
    }
}

#[test]
fn ode45_needs_as_many_steps_as_the_tolerance_says() {
    let (tolerances, limits) = tolerances(2, 1e-9, 1e-9);
    let mut fine = Ode45::new(tolerances, limits);
    let x = run(&mut fine, &mut van_der_pol(5.0), [2.0, 0.0], 100.0);
    assert!((x[0] - RELAXATION[0]).abs() < 1e-8, "{x:?}");
    assert_eq!(work(fine.counts()), (27806, 4598, 36));
}

#[test]
fn stiff_van_der_pol_with_mu_1000() {
    let (tolerances, limits) = tolerances(2, 1e-6, 1e-9);
    let mut stepper = Rodas4::new(tolerances, limits);
    let x = run(&mut stepper, &mut van_der_pol(1000.0), [2.0, 0.0], 2000.0);
    // Mazzia and Magherini, Test set for initial value problem solvers, release 2.4: problem vdpol.
    assert!((x[0] - 1.706_167_732_170_469).abs() < 1e-6, "{x:?}");
    assert!((x[1] + 0.892_809_701_024_812_5e-3).abs() < 1e-9, "{x:?}");
    assert_eq!(work(stepper.counts()), (11920, 1079, 10));
    assert_eq!((stepper.counts().jacobians, stepper.counts().factorisations), (1079, 1089));
}

#[test]
fn robertson_over_eleven_decades() {
    // At t = 1e11 the value of problem rober of the same test set; before, digits on which Radau methods at 1e-12 agree.
    for (end, reference) in [
        (0.4, [0.985_172_113_861, 3.386_395_379e-5, 1.479_402_218e-2]),
        (40.0, [0.715_827_068_7, 9.185_534_764e-6, 0.284_163_745_7]),
        (1e11, [2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505]),
    ] {
        let (tolerances, limits) = tolerances(3, 1e-8, 1e-14);
        let mut stepper = Rodas4::new(tolerances, limits);
        let x = run(&mut stepper, &mut robertson(), [1.0, 0.0, 0.0], end);
        for (x, reference) in x.iter().zip(reference) {
            assert!((x / reference - 1.0).abs() < 1e-5, "t = {end}: {x:e} instead of {reference:e}");
        }
        assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-10);
        // Forward differences with increments fixed at the size of ordinary states took 40 times as many.
        assert!(stepper.counts().accepted < 4000);
    }
}

#[test]
fn the_stiffer_the_fewer_steps_with_the_exact_jacobian() {
    let mut before = u64::MAX;
    for rate in [1e0, 1e2, 2e4] {
        let (tolerances, limits) = tolerances(1, 1e-6, 1e-9);
        let mut stepper = Ros34pw2::new(tolerances, limits);
        let [x] = run(&mut stepper, &mut ProtheroRobinson::new(rate), [0.0], 10.0);
        assert!((x - 10f64.sin()).abs() < 1e-6, "rate {rate}: {x}");
        assert!(stepper.counts().accepted < before, "rate {rate}: {:?}", stepper.counts());
        before = stepper.counts().accepted;
    }
    // Stability alone would ask an explicit method for 10 s * 2e4 1/s / 3.3 = 60 000 steps.
    assert!(before < 250);
}

#[test]
fn a_winding_of_2e4_per_second_is_limited_by_accuracy_whatever_is_known_of_the_jacobian() {
    let steps = |coupling, relative: f64| {
        let (tolerances, limits) = tolerances(2, relative, 1e-3 * relative);
        let mut stepper = Ros34pw2::new(tolerances, limits);
        let x = run(&mut stepper, &mut Motor::new(2e4, coupling), [0.0, 0.0], 10.0);
        let (tolerances, limits) = self::tolerances(2, 1e-10, 1e-12);
        let exact =
            run(&mut Rodas4::new(tolerances, limits), &mut Motor::new(2e4, Coupling::Both), [0.0, 0.0], 10.0);
        assert!((x[0] - exact[0]).abs() < relative && (x[1] - exact[1]).abs() < 3.0 * relative);
        stepper.counts().accepted
    };
    // The steps depend on the tolerance, as they would not if stability set them.
    assert_eq!((steps(Coupling::Both, 1e-4), steps(Coupling::Both, 1e-6)), (122, 556));
    assert_eq!((steps(Coupling::OnSpeed, 1e-4), steps(Coupling::OnSpeed, 1e-6)), (738, 6145));
    assert_eq!((steps(Coupling::Neither, 1e-4), steps(Coupling::Neither, 1e-6)), (1098, 9201));

    let (tolerances, limits) = tolerances(2, 1e-4, 1e-7);
    let mut explicit = Ode45::new(tolerances, limits);
    run(&mut explicit, &mut Motor::new(2e4, Coupling::Both), [0.0, 0.0], 10.0);
    assert!(explicit.counts().accepted > 50_000);
}
