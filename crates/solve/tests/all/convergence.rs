//! Measured orders of all methods, of the steps and of the state in between.

use blocksim_solve::problems::{swing, swing_solution};
use blocksim_solve::{
    Auto, Dop853, FixedStep, Ode15s, Ode23, Ode23t, Ode23tb, Ode45, Radau5, Rodas4, Ros34pw2, StepLimits,
    Stepper, Tolerances, integrate,
};

const END: f64 = 2.0;

/// Adaptive methods with a tolerance that accepts anything take the maximum step they may.
fn fixed(h: f64) -> (Tolerances, StepLimits) {
    (Tolerances::uniform(2, 1e6, 1e6), StepLimits { first: Some(h), max: h, min: 0.0 })
}

type Make = fn(f64) -> Box<dyn Stepper>;

/// Name, constructor by step size, order of the steps, order of the state in between.
const METHODS: [(&str, Make, f64, f64); 13] = [
    ("Ode1", |h| Box::new(FixedStep::ode1(2, h)), 1.0, 1.0),
    ("Ode2", |h| Box::new(FixedStep::ode2(2, h)), 2.0, 2.0),
    // Local errors of one order more count once, so the order in between is one more than that of its conditions.
    ("Ode3", |h| Box::new(FixedStep::ode3(2, h)), 3.0, 3.0),
    ("Ode4", |h| Box::new(FixedStep::ode4(2, h)), 4.0, 4.0),
    ("Ode5", |h| Box::new(FixedStep::ode5(2, h)), 5.0, 4.0),
    ("Ode23", |h| Box::new(Ode23::new(fixed(h).0, fixed(h).1)), 3.0, 3.0),
    ("Ode45", |h| Box::new(Ode45::new(fixed(h).0, fixed(h).1)), 5.0, 5.0),
    ("Ode23t", |h| Box::new(Ode23t::new(fixed(h).0, fixed(h).1)), 2.0, 2.0),
    ("Ode23tb", |h| Box::new(Ode23tb::new(fixed(h).0, fixed(h).1)), 2.0, 2.0),
    ("Dop853", |h| Box::new(Dop853::new(fixed(h).0, fixed(h).1)), 8.0, 8.0),
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
        // Where roundoff is far: 2e-12 is the smallest error.
        let steps = if order > 5.0 { 8.0 } else { 40.0 };
        let (coarse, fine) = (errors(&mut *make(END / steps)), errors(&mut *make(END / (2.0 * steps))));
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

/// Largest error at points within one step of the size `h` from the exact solution, as it is or sharpened.
fn within_one(h: f64, sharp: bool) -> f64 {
    let (tolerances, limits) = fixed(h);
    let mut stepper = Ode45::new(tolerances, limits);
    let (mut t, mut x) = (0.3, swing_solution(0.3));
    stepper.step(&mut swing(), &mut t, &mut x, 0.3 + h).unwrap();
    if sharp {
        stepper.sharpen(&mut swing());
    }
    let error = |k: i32| {
        let (between, mut y) = (0.3 + h * f64::from(k) / 10.0, [0.0; 2]);
        stepper.interpolate(between, &mut y);
        let [a, b] = swing_solution(between);
        (y[0] - a).hypot(y[1] - b)
    };
    (1..10).map(error).fold(0.0, f64::max)
}

#[test]
fn a_sharpened_step_is_as_exact_within_as_at_its_end() {
    for (sharp, order) in [(false, 5.0), (true, 6.0)] {
        let measured = (within_one(0.04, sharp) / within_one(0.02, sharp)).log2();
        assert!((measured - order).abs() < 0.4, "{sharp}: {measured:.2}");
    }
    assert!(within_one(0.02, true) < 0.5 * within_one(0.02, false));
    let work = |sharp: bool| {
        let (tolerances, limits) = fixed(0.1);
        let mut stepper = Ode45::new(tolerances, limits);
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        stepper.step(&mut swing(), &mut t, &mut x, 0.1).unwrap();
        (0..2).filter(|_| sharp).for_each(|_| stepper.sharpen(&mut swing()));
        stepper.counts().evaluations
    };
    assert_eq!(work(true), work(false) + 2, "once is enough");
}

/// Takes a step back and makes it once more: as it was, or up to an earlier time from the same history.
#[test]
fn a_step_that_is_taken_back_can_be_made_once_more() {
    let tolerances = || Tolerances::uniform(2, 1e-6, 1e-6);
    let limits = StepLimits::default();
    let steppers: [Box<dyn Stepper>; 3] = [
        Box::new(Ode15s::new(tolerances(), limits)),
        Box::new(Auto::new(tolerances(), limits)),
        Box::new(Ode23::new(tolerances(), limits)),
    ];
    for mut stepper in steppers {
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        integrate(&mut *stepper, &mut swing(), &mut t, &mut x, 1.0).unwrap();
        let before = (t, x);
        stepper.step(&mut swing(), &mut t, &mut x, 9.0).unwrap();
        let first = (t, x);
        stepper.back();
        (t, x) = before;
        stepper.step(&mut swing(), &mut t, &mut x, first.0).unwrap();
        // The iteration may end one round earlier or later.
        let off = (x[0] - first.1[0]).hypot(x[1] - first.1[1]);
        assert!(t == first.0 && off < 1e-7, "{}: off by {off:e}", stepper.name());
        stepper.back();
        (t, x) = before;
        let end = 0.5 * (before.0 + first.0);
        stepper.step(&mut swing(), &mut t, &mut x, end).unwrap();
        let [a, b] = swing_solution(end);
        assert!(t == end && (x[0] - a).hypot(x[1] - b) < 3e-5, "{}", stepper.name());
    }
}
