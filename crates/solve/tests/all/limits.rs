//! Limits, restarts, and what happens where the solution ends.

use blocksim_solve::problems::{draining_tank, function, pole, swing, van_der_pol};
use blocksim_solve::{
    Auto, Dop853, Failed, FixedStep, Ode15s, Ode23, Ode23t, Ode23tb, Ode45, Radau5, Rodas4, Ros34pw2,
    StepError, StepLimits, Stepper, System, Tolerances, integrate,
};

fn adaptive(n: usize) -> [Box<dyn Stepper>; 4] {
    let tolerances = || Tolerances::uniform(n, 1e-6, 1e-9);
    [
        Box::new(Ode45::new(tolerances(), StepLimits::default())),
        Box::new(Ode23::new(tolerances(), StepLimits::default())),
        Box::new(Rodas4::new(tolerances(), StepLimits::default())),
        Box::new(Ros34pw2::new(tolerances(), StepLimits::default())),
    ]
}

/// Those, the ones of several steps, and all with tolerances of their own.
fn variable(n: usize) -> Vec<Box<dyn Stepper>> {
    let mut variable: Vec<Box<dyn Stepper>> = adaptive(n).into();
    for tolerances in [Tolerances::uniform(n, 1e-6, 1e-9), Tolerances::automatic(n, 1e-6)] {
        variable.push(Box::new(Ode15s::new(tolerances.clone(), StepLimits::default())));
        variable.push(Box::new(Dop853::new(tolerances.clone(), StepLimits::default())));
        variable.push(Box::new(Ode23t::new(tolerances.clone(), StepLimits::default())));
        variable.push(Box::new(Ode23tb::new(tolerances.clone(), StepLimits::default())));
        variable.push(Box::new(Radau5::new(tolerances.clone(), StepLimits::default())));
        variable.push(Box::new(Auto::new(tolerances, StepLimits::default())));
    }
    variable
}

fn all(n: usize, h: f64) -> Vec<Box<dyn Stepper>> {
    let mut all = variable(n);
    all.extend([
        Box::new(FixedStep::ode1(n, h)) as Box<dyn Stepper>,
        Box::new(FixedStep::ode2(n, h)),
        Box::new(FixedStep::ode3(n, h)),
        Box::new(FixedStep::ode4(n, h)),
        Box::new(FixedStep::ode5(n, h)),
    ]);
    all
}

/// Evaluations by one step of each of [`adaptive`], a Jacobian of two states included and two states within the step.
const PER_STEP: [u64; 4] = [6, 3, 5 + 3 + 2, 3];

#[test]
fn steps_land_on_every_limit_with_its_bits_and_never_look_beyond() {
    for mut stepper in all(2, 0.007) {
        let (mut t, mut x) = (0.0, [2.0, 0.0]);
        for k in 1..=100 {
            let limit = 0.1 * f64::from(k);
            let mut model = van_der_pol(5.0);
            let mut guarded = function(2, |t, x, dx| {
                assert!(t <= limit, "looked at {t} beyond {limit}");
                model.derivatives(t, x, dx).unwrap();
            });
            let mut before = t;
            while t < limit {
                stepper.step(&mut guarded, &mut t, &mut x, limit).unwrap();
                assert_eq!(stepper.last_step(), (before, t));
                before = t;
            }
            assert_eq!(t.to_bits(), limit.to_bits(), "{}", stepper.name());
        }
        let end = (t, x);
        stepper.step(&mut van_der_pol(5.0), &mut t, &mut x, end.0).unwrap();
        assert_eq!((t, x), end, "at the limit there is nothing to do");
    }
}

#[test]
fn a_restart_costs_one_evaluation_at_most() {
    // A sampled controller restarts each millisecond; what it holds changes the law of the states.
    for (mut stepper, per_step) in adaptive(2).into_iter().zip(PER_STEP) {
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        integrate(&mut *stepper, &mut swing(), &mut t, &mut x, 0.1).unwrap();
        let before = stepper.counts();
        for k in 101..=200 {
            stepper.restart();
            stepper.step(&mut swing(), &mut t, &mut x, f64::from(k) * 1e-3).unwrap();
        }
        let after = stepper.counts();
        assert_eq!(after.accepted - before.accepted, 100, "{}", stepper.name());
        assert_eq!(after.evaluations - before.evaluations, 100 * (per_step + 1), "{}", stepper.name());
        assert_eq!(after.rejected, before.rejected);
        assert!((x[0] - t.sin().sin()).abs() < 1e-6);
    }
}

#[test]
fn without_restart_the_last_stage_serves_again() {
    for (mut stepper, per_step) in adaptive(2).into_iter().zip(PER_STEP).take(2) {
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        integrate(&mut *stepper, &mut swing(), &mut t, &mut x, 1.0).unwrap();
        let counts = stepper.counts();
        // Two for the start: the derivative and the guess of the step size.
        assert_eq!(counts.evaluations, 2 + per_step * (counts.accepted + counts.rejected));
    }
}

#[test]
fn a_restart_follows_a_jump_of_the_state() {
    for mut stepper in all(1, 0.01) {
        let mut decay = function(1, |_, x, dx| dx[0] = -x[0]);
        let (mut t, mut x) = (0.0, [1.0]);
        integrate(&mut *stepper, &mut decay, &mut t, &mut x, 1.0).unwrap();
        x[0] = 5.0;
        stepper.restart();
        integrate(&mut *stepper, &mut decay, &mut t, &mut x, 2.0).unwrap();
        // Euler's method with h = 0.01 errs by h / 2 of the value.
        assert!((x[0] - 5.0 * (-1f64).exp()).abs() < 0.01, "{}: {}", stepper.name(), x[0]);
    }
}

#[test]
fn no_step_is_longer_than_the_maximum() {
    let limits = StepLimits { max: 0.05, ..StepLimits::default() };
    let mut stepper = Ode45::new(Tolerances::uniform(2, 1e-3, 1e-3), limits);
    let (mut t, mut x) = (0.0, [0.0, 1.0]);
    while t < 2.0 {
        stepper.step(&mut swing(), &mut t, &mut x, 2.0).unwrap();
        let (t0, t1) = stepper.last_step();
        assert!(t1 - t0 <= 0.05 * (1.0 + 1e-8));
    }
}

#[test]
fn a_pole_is_an_underflow_at_its_time() {
    for mut stepper in variable(2) {
        let mut pole = pole();
        let mut pair = function(2, |t, x, dx| {
            dx[0] = -x[0];
            pole.derivatives(t, &x[1..], &mut dx[1..]).unwrap();
        });
        let (mut t, mut x) = (0.0, [1.0, 1.0]);
        let error = integrate(&mut *stepper, &mut pair, &mut t, &mut x, 2.0).unwrap_err();
        let StepError::Underflow { t: at, h, state: 1 } = error else {
            panic!("{}: {error:?}", stepper.name())
        };
        assert_eq!(at, t, "t is that of the last good state");
        // On its way to the pole an error of 1e-6 grows with x^2; methods of order two make more steps with such errors.
        let within = if stepper.name().starts_with("Ode23t") { 1e-4 } else { 5e-5 };
        assert!((t - 1.0).abs() < within && h < 1e-14, "{}: {error}", stepper.name());
        assert!(x[1] > 1e6 && x[1].is_finite());
    }
}

#[test]
fn a_region_without_derivative_is_approached_and_not_entered() {
    for mut stepper in variable(1) {
        let (mut t, mut x) = (0.0, [1.0]);
        let error = integrate(&mut *stepper, &mut draining_tank(), &mut t, &mut x, 3.0).unwrap_err();
        // Methods whose steps are stable may step over the edge by less than the tolerance.
        let named =
            matches!(error, StepError::Underflow { state: 0, .. } | StepError::NotFinite { state: 0, .. });
        assert!(named, "{}: {error:?}", stepper.name());
        // The root is where the tolerance of the state, 1e-9, makes one of sqrt(1e-9) in time.
        assert!((t - 2.0).abs() < 1e-4 && x[0].abs() < 1e-9, "{}: {t} {x:?}", stepper.name());
    }
}

#[test]
fn a_region_without_derivative_beside_the_way_only_costs_rejections() {
    for mut stepper in variable(1) {
        // The first step is far too long and tries states below -0.1, where the root has no value.
        let mut system = function(1, |_, x, dx| dx[0] = -50.0 * x[0] * (x[0] + 0.1).sqrt());
        let tolerances = Tolerances::uniform(1, 1e-6, 1e-9);
        if stepper.name() == "Ode45" {
            let limits = StepLimits { first: Some(0.5), ..StepLimits::default() };
            stepper = Box::new(Ode45::new(tolerances, limits));
        }
        let (mut t, mut x) = (0.0, [1.0]);
        integrate(&mut *stepper, &mut system, &mut t, &mut x, 1.0).unwrap();
        assert!(x[0] > 0.0 && x[0] < 1e-5, "{}: {x:?}", stepper.name());
        assert!(stepper.name() != "Ode45" || stepper.counts().rejected > 0);
    }
}

#[test]
fn a_start_without_derivative_is_named_at_once() {
    for mut stepper in all(2, 0.1) {
        let mut system = function(2, |_, x, dx| (dx[0], dx[1]) = (1.0, x[1].ln()));
        let (mut t, mut x) = (0.5, [0.0, -1.0]);
        let error = stepper.step(&mut system, &mut t, &mut x, 1.0).unwrap_err();
        assert_eq!(error, StepError::NotFinite { t: 0.5, state: 1 }, "{}", stepper.name());
        assert_eq!((t, x), (0.5, [0.0, -1.0]));
    }
}

/// Fails beyond t = 0.5.
struct Breaking;

impl System for Breaking {
    fn dimension(&self) -> usize {
        1
    }

    fn derivatives(&mut self, t: f64, _x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        dx[0] = 1.0;
        if t > 0.5 { Err(Failed) } else { Ok(()) }
    }
}

#[test]
fn a_failure_of_the_system_ends_the_step_and_leaves_the_state_and_a_retry_works() {
    // Euler's method looks at the start of a step only, and so gets beyond.
    for mut stepper in all(1, 0.1).into_iter().filter(|stepper| stepper.name() != "Ode1") {
        let (mut t, mut x) = (0.0, [0.0]);
        assert_eq!(
            integrate(&mut *stepper, &mut Breaking, &mut t, &mut x, 1.0),
            Err(StepError::System),
            "{}",
            stepper.name()
        );
        assert!(t <= 0.5 && (x[0] - t).abs() < 1e-12, "{}: {t} {x:?}", stepper.name());
        integrate(&mut *stepper, &mut Breaking, &mut t, &mut x, 0.5).unwrap();
        assert_eq!(t, 0.5);
        assert!((x[0] - 0.5).abs() < 1e-12, "{}", stepper.name());
    }
}

#[test]
fn a_system_without_states_steps_to_the_limit() {
    for mut stepper in all(0, 0.3) {
        let mut nothing = function(0, |_, _, _| {});
        let mut t = 0.0;
        integrate(&mut *stepper, &mut nothing, &mut t, &mut [], 1.0).unwrap();
        assert_eq!(t, 1.0);
        assert!(stepper.counts().accepted <= 8, "{}: {:?}", stepper.name(), stepper.counts());
    }
}

#[test]
fn two_runs_give_the_same_bits() {
    for (mut a, mut b) in all(2, 0.01).into_iter().zip(all(2, 0.01)) {
        let (mut ta, mut xa, mut tb, mut xb) = (0.0, [2.0, 0.0], 0.0, [2.0, 0.0]);
        integrate(&mut *a, &mut van_der_pol(5.0), &mut ta, &mut xa, 10.0).unwrap();
        integrate(&mut *b, &mut van_der_pol(5.0), &mut tb, &mut xb, 10.0).unwrap();
        assert_eq!(xa.map(f64::to_bits), xb.map(f64::to_bits), "{}", a.name());
    }
}

#[test]
fn a_stepper_that_recalls_the_memory_of_another_goes_on_with_its_bits() {
    for (mut first, mut second) in all(2, 0.007).into_iter().zip(all(2, 0.007)) {
        let mut model = van_der_pol(5.0);
        let (mut t, mut x) = (0.0, [2.0, 0.0]);
        for _ in 0..50 {
            first.step(&mut model, &mut t, &mut x, 10.0).unwrap();
        }
        let (mut t2, mut x2) = (t, x);
        second.recall(&first.memory());
        for _ in 0..50 {
            first.step(&mut model, &mut t, &mut x, 10.0).unwrap();
            second.step(&mut model, &mut t2, &mut x2, 10.0).unwrap();
            assert_eq!((t, x), (t2, x2), "{}", first.name());
        }
    }
}
