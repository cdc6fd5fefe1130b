//! Van der Pol's oscillator by every method, beside a loop written by hand for it: `cargo bench -p blocksim-solve`.

use blocksim_solve::problems::van_der_pol;
use blocksim_solve::{FixedStep, Ode23, Ode45, Rodas4, Ros34pw2, StepLimits, Stepper, Tolerances, integrate};

fn main() {
    divan::main();
}

fn tolerances() -> (Tolerances, StepLimits) {
    (Tolerances::uniform(2, 1e-6, 1e-9), StepLimits::default())
}

fn run(mut stepper: impl Stepper, mu: f64, end: f64) -> [f64; 2] {
    let (mut t, mut x) = (0.0, divan::black_box([2.0, 0.0]));
    integrate(&mut stepper, &mut van_der_pol(divan::black_box(mu)), &mut t, &mut x, end)
        .expect("a solvable problem");
    x
}

mod mu_5_to_100 {
    use super::*;

    #[divan::bench]
    fn by_hand() -> [f64; 2] {
        dormand_prince_by_hand(divan::black_box(5.0), divan::black_box([2.0, 0.0]), 100.0)
    }

    #[divan::bench]
    fn ode45() -> [f64; 2] {
        run(Ode45::new(tolerances().0, tolerances().1), 5.0, 100.0)
    }

    #[divan::bench]
    fn ode23() -> [f64; 2] {
        run(Ode23::new(tolerances().0, tolerances().1), 5.0, 100.0)
    }

    #[divan::bench]
    fn rodas4() -> [f64; 2] {
        run(Rodas4::new(tolerances().0, tolerances().1), 5.0, 100.0)
    }

    #[divan::bench]
    fn ros34pw2() -> [f64; 2] {
        run(Ros34pw2::new(tolerances().0, tolerances().1), 5.0, 100.0)
    }

    #[divan::bench]
    fn ode4_in_10_000_steps() -> [f64; 2] {
        run(FixedStep::ode4(2, 0.01), 5.0, 100.0)
    }
}

mod mu_1000_to_2000 {
    use super::*;

    #[divan::bench]
    fn rodas4() -> [f64; 2] {
        run(Rodas4::new(tolerances().0, tolerances().1), 1000.0, 2000.0)
    }
}

/// The same method with everything in two registers: no dispatch, no slices, no checks, no interpolation. What remains to
/// `Ode45` over this is the price of its generality.
fn dormand_prince_by_hand(mu: f64, mut x: [f64; 2], end: f64) -> [f64; 2] {
    let f = |x: [f64; 2]| [x[1], mu * (1.0 - x[0] * x[0]) * x[1] - x[0]];
    let along = |x: [f64; 2], h: f64, terms: &[(f64, [f64; 2])]| {
        let mut sum = [0.0; 2];
        for (a, k) in terms {
            sum[0] += a * k[0];
            sum[1] += a * k[1];
        }
        [x[0] + h * sum[0], x[1] + h * sum[1]]
    };
    let (mut t, mut h, mut before, mut rejected) = (0.0, 1e-3f64, 1e-4f64, false);
    let mut k1 = f(x);
    while t < end {
        h = h.min(end - t);
        let k2 = f(along(x, h, &[(0.2, k1)]));
        let k3 = f(along(x, h, &[(3.0 / 40.0, k1), (9.0 / 40.0, k2)]));
        let k4 = f(along(x, h, &[(44.0 / 45.0, k1), (-56.0 / 15.0, k2), (32.0 / 9.0, k3)]));
        let a5 = [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0];
        let k5 = f(along(x, h, &[(a5[0], k1), (a5[1], k2), (a5[2], k3), (a5[3], k4)]));
        let a6 = [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0];
        let k6 = f(along(x, h, &[(a6[0], k1), (a6[1], k2), (a6[2], k3), (a6[3], k4), (a6[4], k5)]));
        let b = [35.0 / 384.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
        let y = along(x, h, &[(b[0], k1), (b[1], k3), (b[2], k4), (b[3], k5), (b[4], k6)]);
        let k7 = f(y);
        let e = [71.0 / 57600.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -0.025];
        let error =
            along([0.0; 2], h, &[(e[0], k1), (e[1], k3), (e[2], k4), (e[3], k5), (e[4], k6), (e[5], k7)]);
        let ratio = |i: usize| error[i] / (1e-9 + 1e-6 * x[i].abs().max(y[i].abs()));
        let err = (0.5 * (ratio(0).powi(2) + ratio(1).powi(2))).sqrt();
        let factor = 0.9 * err.powf(-0.17);
        if err <= 1.0 {
            t = if h == end - t { end } else { t + h };
            (x, k1) = (y, k7);
            h *= (factor * before.powf(0.04)).clamp(0.2, if rejected { 1.0 } else { 10.0 });
            before = err.max(1e-4);
            rejected = false;
        } else {
            h *= factor.max(0.2);
            rejected = true;
        }
    }
    x
}
