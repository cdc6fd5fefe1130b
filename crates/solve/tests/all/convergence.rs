//! Measured orders of all methods, of the steps and of the state in between.

use blocksim_solve::problems::{swing, swing_solution};
use blocksim_solve::{FixedStep, Ode23, Ode45, Radau5, Rodas4, Ros34pw2, StepLimits, Stepper, Tolerances};

const END: f64 = 2.0;

/// Adaptive methods with a tolerance that accepts anything take the largest step they may.
fn fixed(h: f64) -> (Tolerances, StepLimits) {
    (Tolerances::uniform(2, 1e6, 1e6), StepLimits { first: Some(h), max: h, min: 0.0 })
}

type Make = fn(f64) -> Box<dyn Stepper>;

/// Name, constructor by step size, order of the steps, order of the state in between.
const METHODS: [(&str, Make, f64, f64); 10] = [
    ("Ode1", |h| Box::new(FixedStep::ode1(2, h)), 1.0, 1.0),
    ("Ode2", |h| Box::new(FixedStep::ode2(2, h)), 2.0, 2.0),
    // Local errors of one order more count once, so the order in between is one more than that of its conditions.
    ("Ode3", |h| Box::new(FixedStep::ode3(2, h)), 3.0, 3.0),
    ("Ode4", |h| Box::new(FixedStep::ode4(2, h)), 4.0, 4.0),
    ("Ode5", |h| Box::new(FixedStep::ode5(2, h)), 5.0, 4.0),
    ("Ode23", |h| Box::new(Ode23::new(fixed(h).0, fixed(h).1)), 3.0, 3.0),
    ("Ode45", |h| Box::new(Ode45::new(fixed(h).0, fixed(h).1)), 5.0, 5.0),
    ("Rodas4", |h| Box::new(Rodas4::new(fixed(h).0, fixed(h).1)), 4.0, 4.0),
    ("Radau5", |h| Box::new(Radau5::new(fixed(h).0, fixed(h).1)), 5.0, 4.5),
    // The problem gives no Jacobian: J = 0, explicit.
    ("Ros34pw2", |h| Box::new(Ros34pw2::new(fixed(h).0, fixed(h).1)), 3.0, 3.0),
];

/// Errors at the end, and the largest at three points within the steps.
fn errors(stepper: &mut dyn Stepper) -> (f64, f64) {
    let distance = |t: f64, x: [f64; 2]| {
        let [a, b] = swing_solution(t);
        (x[0] - a).hypot(x[1] - b)
    };
    let (mut t, mut x, mut within) = (0.0, [0.0, 1.0], 0.0f64);
    while t < END {
        stepper.step(&mut swing(), &mut t, &mut x, END).unwrap();
        let (t0, t1) = stepper.last_step();
        for theta in [0.25, 0.5, 0.75] {
            let (between, mut y) = (t0 + theta * (t1 - t0), [0.0; 2]);
            stepper.interpolate(between, &mut y);
            within = within.max(distance(between, y));
        }
    }
    (distance(END, x), within)
}

#[test]
fn halving_the_step_divides_the_errors_by_two_to_the_order() {
    for (name, make, order, within) in METHODS {
        // Where roundoff is far: 2e-11 is the smallest error.
        let (coarse, fine) = (errors(&mut *make(END / 40.0)), errors(&mut *make(END / 80.0)));
        let measured = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
        assert_eq!(make(1.0).name(), name);
        // Errors of the next order still show at these steps: half an order up, a quarter down.
        assert!(measured.0 > order - 0.25 && measured.0 < order + 0.5, "{name}: order {:.2}", measured.0);
        assert!(measured.1 > within - 0.25 && measured.1 < within + 0.6, "{name}: {:.2} within", measured.1);
    }
}

#[test]
fn a_fixed_step_costs_its_stages_and_no_more() {
    for (index, stages) in [1, 2, 3, 4, 6].into_iter().enumerate() {
        let mut stepper = METHODS[index].1(END / 10.0);
        errors(&mut *stepper);
        assert_eq!(stepper.counts().evaluations, 10 * stages, "{}", stepper.name());
    }
}

#[test]
fn the_state_in_between_joins_the_steps() {
    for (name, make, ..) in METHODS {
        let mut stepper = make(0.3);
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        let mut y = [0.0; 2];
        for _ in 0..3 {
            let start = x;
            stepper.step(&mut swing(), &mut t, &mut x, END).unwrap();
            let (t0, t1) = stepper.last_step();
            stepper.interpolate(t0, &mut y);
            assert_eq!(y, start, "{name}");
            stepper.interpolate(t1, &mut y);
            assert_eq!(y, x, "{name}");
            stepper.interpolate(t1 - 1e-9, &mut y);
            assert!((y[0] - x[0]).hypot(y[1] - x[1]) < 2e-9, "{name}");
            stepper.interpolate(t0 + 1e-9, &mut y);
            assert!((y[0] - start[0]).hypot(y[1] - start[1]) < 2e-9, "{name}");
        }
    }
}
