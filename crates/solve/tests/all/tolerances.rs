//! Automatic absolute tolerances: no unit and no size of a state needs to be told.

use blocksim_solve::problems::{function, robertson};
use blocksim_solve::{
    Counts, Dop853, Ode15s, Ode23, Ode23t, Ode23tb, Ode45, Radau5, Rodas4, Ros34pw2, StepLimits, Stepper,
    System, Tolerances, integrate,
};

fn all(n: usize, relative: f64) -> Vec<Box<dyn Stepper>> {
    let tolerances = || Tolerances::automatic(n, relative);
    vec![
        Box::new(Ode45::new(tolerances(), StepLimits::default())),
        Box::new(Ode23::new(tolerances(), StepLimits::default())),
        Box::new(Dop853::new(tolerances(), StepLimits::default())),
        Box::new(Ode23t::new(tolerances(), StepLimits::default())),
        Box::new(Ode23tb::new(tolerances(), StepLimits::default())),
        Box::new(Radau5::new(tolerances(), StepLimits::default())),
        Box::new(Rodas4::new(tolerances(), StepLimits::default())),
        Box::new(Ros34pw2::new(tolerances(), StepLimits::default())),
    ]
}

/// What errors of the size of the tolerance may add up to over the steps of a method of order two, which makes so many of them;
/// nothing for others.
fn added_up(stepper: &dyn Stepper, relative: f64) -> f64 {
    let second = stepper.name().starts_with("Ode23t");
    if second { 2.0 * relative * stepper.counts().accepted as f64 } else { 0.0 }
}

/// Van der Pol's oscillator with mu = 5, its states in another unit.
fn scaled(unit: f64) -> impl System {
    function(2, move |_, x, dx| {
        let (x, v) = (x[0] / unit, x[1] / unit);
        dx[0] = unit * v;
        dx[1] = unit * (5.0 * (1.0 - x * x) * v - x);
    })
}

#[test]
fn units_change_neither_the_steps_nor_the_solution() {
    for k in 0..all(2, 1e-6).len() {
        let keeps = all(2, 1e-6)[k].name().starts_with("Ode23t");
        let run = |unit: f64, start: [f64; 2]| -> (Counts, [f64; 2]) {
            let mut stepper = all(2, 1e-6).remove(k);
            let (mut t, mut x) = (0.0, start.map(|x| unit * x));
            integrate(&mut *stepper, &mut scaled(unit), &mut t, &mut x, 20.0).unwrap();
            (stepper.counts(), x.map(|x| x / unit))
        };
        for start in [[2.0, 0.0], [0.3, 0.1]] {
            let (counts, x) = run(1.0, start);
            // A state that begins at zero meets the least magnitude.
            for unit in [(2f64).powi(-10), (2f64).powi(30)].into_iter().filter(|_| start[1] != 0.0) {
                assert_eq!(run(unit, start), (counts, x), "{k}: a unit of {unit:e}");
            }
            // Where units are no powers of two, rounding makes a step more or less, or a Jacobian serve longer.
            for unit in [1e-9, 1e9] {
                let (other, y) = run(unit, start);
                let more = other.evaluations as f64 / counts.evaluations as f64;
                let part = if keeps { 0.02 } else { 0.01 };
                assert!((more - 1.0).abs() < part, "{k}: {other:?} with a unit of {unit:e}, not {counts:?}");
                assert!((x[0] - y[0]).abs() < 1e-4 && (x[1] - y[1]).abs() < 1e-4, "{k}: {x:?} {y:?}");
            }
        }
    }
}

#[test]
fn an_oscillation_of_a_microvolt_beside_a_large_state_keeps_its_amplitude() {
    // A capacitor of 1 uF and a coil of 1 mH, and a motor that turns at 300 rad/s beside it.
    let (c, l) = (1e-6, 1e-3);
    let period = std::f64::consts::TAU * f64::sqrt(c * l);
    for volts in [1e-6, 1e-9] {
        for mut stepper in all(3, 1e-6) {
            let mut circuit = function(3, |_, x, dx| {
                (dx[0], dx[1]) = (-x[1] / c, x[0] / l);
                dx[2] = 300.0 - x[2];
            });
            let (mut t, mut x) = (0.0, [volts, 0.0, 300.0]);
            integrate(&mut *stepper, &mut circuit, &mut t, &mut x, 50.0 * period).unwrap();
            // Errors of 1e-6 of some thousand steps.
            let more = added_up(&*stepper, 1e-6);
            assert!((x[0] / volts - 1.0).abs() < 3e-3, "{}: {:e} V", stepper.name(), x[0]);
            let current = (x[1] / volts * f64::sqrt(l / c)).abs();
            assert!(current < 1e-2 + more, "{}: {:e} A", stepper.name(), x[1]);
        }
    }
}

#[test]
fn robertson_is_right_to_its_tolerance() {
    // See `work.rs` for the references.
    for (relative, within) in [(1e-4, 1e-3), (1e-6, 1e-5), (1e-8, 1e-7)] {
        let mut stepper = Rodas4::new(Tolerances::automatic(3, relative), StepLimits::default());
        let (mut t, mut x) = (0.0, [1.0, 0.0, 0.0]);
        integrate(&mut stepper, &mut robertson(), &mut t, &mut x, 40.0).unwrap();
        for (x, reference) in x.iter().zip([0.715_827_068_7, 9.185_534_764e-6, 0.284_163_745_7]) {
            assert!((x / reference - 1.0).abs() < within, "{relative:e}: {x:e} instead of {reference:e}");
        }
    }
}

#[test]
fn a_state_that_is_only_rounding_costs_nothing_worth_mentioning() {
    let steps = |noise: f64, stepper: &mut dyn Stepper| {
        let mut system = function(3, |t: f64, x, dx| {
            (dx[0], dx[1]) = (x[1], -x[0]);
            // Two terms that are equal, but for rounding, in time and in states.
            let (a, b) = (t.sin() + 1.5 * x[1], (t + std::f64::consts::PI).sin() - 1.5 * x[1]);
            dx[2] = noise * (a + b);
        });
        let (mut t, mut x) = (0.0, [0.0, 1.0, 0.0]);
        integrate(stepper, &mut system, &mut t, &mut x, 20.0).unwrap();
        assert!((x[0] - 20f64.sin()).abs() < 3e-4 && x[2].abs() < noise.max(1.0) * 1e-13);
        stepper.counts().evaluations
    };
    for (mut plain, mut noisy) in all(3, 1e-6).into_iter().zip(all(3, 1e-6)) {
        let without = steps(0.0, &mut *plain);
        let with = steps(1e3, &mut *noisy);
        // An order of eight grows slowly again from the steps that it makes before noise is known.
        let times = if plain.name() == "Dop853" { 4.0 } else { 2.5 };
        assert!((with as f64) < times * without as f64, "{}: {with} instead of {without}", plain.name());
    }
}

#[test]
fn what_grows_from_nothing_with_a_high_power_of_time_does_not_stall() {
    // Twelve integrators in a row: t^12 / 12! at the end.
    for mut stepper in all(12, 1e-6) {
        let mut chain = function(12, |_, x, dx| {
            dx[0] = 1.0;
            dx[1..].copy_from_slice(&x[..11]);
        });
        let (mut t, mut x) = (0.0, [0.0; 12]);
        let most = if stepper.name() == "Ode45" { 200 } else { 3000 };
        integrate(&mut *stepper, &mut chain, &mut t, &mut x, 2.0).unwrap();
        let mut exact = 1.0;
        for (i, x) in x.iter().enumerate() {
            exact *= 2.0 / (i + 1) as f64;
            let within = 1e-5 + added_up(&*stepper, 1e-6);
            assert!((x / exact - 1.0).abs() < within, "{}: {i}: {x:e} {exact:e}", stepper.name());
        }
        assert!(stepper.counts().accepted < most, "{}: {:?}", stepper.name(), stepper.counts());
    }
}

#[test]
fn a_tighter_tolerance_is_never_worse() {
    for k in 0..all(2, 1e-6).len() {
        let mut before = f64::INFINITY;
        for relative in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
            let mut stepper = all(2, relative).remove(k);
            let (mut t, mut x) = (0.0, [1e-9, 0.0]);
            let mut swing = function(2, |_, x, dx| (dx[0], dx[1]) = (x[1], -x[0]));
            integrate(&mut *stepper, &mut swing, &mut t, &mut x, 20.0).unwrap();
            let error = (x[0] - 1e-9 * 20f64.cos()).hypot(x[1] + 1e-9 * 20f64.sin());
            let within = 1e-9 * (100.0 * relative + added_up(&*stepper, relative));
            assert!(error < before && error < within, "{}, {relative:e}: {error:e}", stepper.name());
            before = error;
        }
    }
}

#[test]
fn what_is_at_rest_until_it_is_driven_begins_with_a_step_of_good_size() {
    let mut steppers = all(2, 1e-6);
    steppers.push(Box::new(Ode15s::new(Tolerances::automatic(2, 1e-6), StepLimits::default())));
    for mut stepper in steppers {
        // Nothing moves at t = 0.
        let mut lag = function(2, |t: f64, x, dx| {
            dx[0] = t.sin() - x[0];
            dx[1] = x[0] - x[1];
        });
        let (mut t, mut x) = (0.0, [0.0; 2]);
        stepper.step(&mut lag, &mut t, &mut x, 10.0).unwrap();
        // The second state grows with a power of time that low orders know no digit of, until it is no dwarf.
        assert!(t > 1e-20, "{}: {t:e}", stepper.name());
        integrate(&mut *stepper, &mut lag, &mut t, &mut x, 10.0).unwrap();
        let exact = 0.5 * (10f64.sin() - 10f64.cos() + (-10f64).exp());
        assert!((x[0] - exact).abs() < 1e-5, "{}: {x:?} {exact}", stepper.name());
    }
}
