//! The methods for stiff systems on the problems of the literature: digits at the end, and work. Counts are exact.
//!
//! Values at the end are those of F. Mazzia, C. Magherini: Test set for initial value problem solvers, release 2.4.

use blocksim_solve::problems::{
    PLEIADES, function, heat, hires, oregonator, pleiades, robertson, swing, swing_solution, van_der_pol,
};
use blocksim_solve::{
    Auto, Counts, Ode15s, Ode23t, Ode23tb, Ode45, Radau5, Share, StepLimits, Stepper, System, Tolerances,
    integrate,
};

/// Runs with an automatic absolute tolerance; returns the maximum error of a state, as a part of its value and a thousandth
/// of `size` if that is larger, and the work.
fn run(
    system: &mut dyn System,
    start: &[f64],
    end: f64,
    relative: f64,
    (expected, size): (&[f64], f64),
) -> (f64, Counts) {
    let mut stepper = Ode15s::new(Tolerances::automatic(start.len(), relative), StepLimits::default());
    let (mut t, mut x) = (0.0, start.to_vec());
    integrate(&mut stepper, system, &mut t, &mut x, end).unwrap();
    let part = |(x, e): (&f64, &f64)| (x - e).abs() / e.abs().max(1e-3 * size);
    let error = x.iter().zip(expected).map(part).fold(0.0, f64::max);
    (error, stepper.counts())
}

#[test]
fn stiff_problems_end_where_the_literature_says_with_little_work() {
    let tolerances = [1e-4, 1e-6, 1e-8];
    // Evaluations by SciPy 1.17's BDF, those for Jacobians included, with absolute tolerances a thousandth (Robertson: 1e-10) of
    // the relative ones.
    type Case<'a> = (&'a str, Box<dyn System>, &'a [f64], f64, (&'a [f64], f64), [u64; 3]);
    let cases: [Case; 4] = [
        (
            "Van der Pol",
            Box::new(van_der_pol(1000.0)),
            &[2.0, 0.0],
            2000.0,
            (&VAN_DER_POL, 0.0),
            [1928, 3927, 8441],
        ),
        ("Robertson", Box::new(robertson()), &[1.0, 0.0, 0.0], 1e11, (&ROBERTSON, 1.0), [1296, 2600, 5427]),
        (
            "HIRES",
            Box::new(hires()),
            &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
            321.8122,
            (&HIRES, 0.0),
            [614, 1111, 2238],
        ),
        (
            "Oregonator",
            Box::new(oregonator()),
            &[1.0, 2.0, 3.0],
            360.0,
            (&OREGONATOR, 0.0),
            [2483, 4824, 10_163],
        ),
    ];
    let mut all = Vec::new();
    for (name, mut system, start, end, expected, others) in cases {
        let mut found = [0; 3];
        for (k, relative) in tolerances.into_iter().enumerate() {
            let (error, counts) = run(&mut *system, start, end, relative, expected);
            // Global errors are larger than local ones: those of a spike are multiplied by what follows.
            let within = if name == "Oregonator" { 400.0 } else { 120.0 };
            assert!(error < within * relative, "{name}, {relative:e}: {error:e}");
            assert!(counts.evaluations * 10 <= others[k] * 13, "{name}, {relative:e}: {counts:?}");
            found[k] = counts.evaluations;
        }
        all.push(found);
    }
    assert_eq!(all, PINNED);
}

/// Evaluations of the problems above.
const PINNED: [[u64; 3]; 4] = [[1935, 2927, 4919], [1360, 2395, 4032], [769, 1146, 1882], [2584, 3951, 6809]];

#[test]
fn a_jacobian_of_before_hides_no_state_behind_the_others() {
    // In the slow phase the Jacobian of the spike is a thousand times too large for the first state, whose corrections are then too
    // small to be seen among those of the others: it stayed behind, and the next spike came at another time.
    let (error, _) = run(&mut oregonator(), &[1.0, 2.0, 3.0], 360.0, 1e-3, (&OREGONATOR, 0.0));
    assert!(error < 0.1, "{error}");
}

#[test]
fn the_pleiades_end_where_the_literature_says() {
    for (relative, within) in [(1e-6, 1e-2), (1e-8, 2e-4)] {
        let (error, _) = run(&mut pleiades(), &PLEIADES, 3.0, relative, (&STARS, 0.0));
        assert!(error < within, "Ode15s, {relative:e}: {error:e}");
        let mut auto = Auto::new(Tolerances::automatic(28, relative), StepLimits::default());
        let (mut t, mut x) = (0.0, PLEIADES);
        integrate(&mut auto, &mut pleiades(), &mut t, &mut x, 3.0).unwrap();
        let error = x.iter().zip(STARS).map(|(x, e)| (x / e - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < within && auto.share().unwrap().changes == 0, "Auto, {relative:e}: {error:e}");
    }
}

#[test]
fn a_rod_of_a_thousand_cells_is_solved_with_a_sparse_jacobian() {
    let mut stepper = Ode15s::new(Tolerances::automatic(1000, 1e-6), StepLimits::default());
    let (mut t, mut x) = (0.0, vec![0.0; 1000]);
    integrate(&mut stepper, &mut heat(1000), &mut t, &mut x, 1.0).unwrap();
    // 1 - sum of 4 / (pi k) sin(pi k s / 2) exp(-(pi k / 2)^2 t) over odd k; the first two are left. The cells make the rod
    // half a cell shorter at its left end, and their own error is below 1e-6.
    for (i, x) in x.iter().enumerate() {
        let s = (i as f64 + 1.0) / 1000.0;
        let term = |k: f64| {
            let w = std::f64::consts::PI * k / 2.0;
            2.0 / w * (w * s / 1.0005).sin() * (-(w / 1.0005).powi(2)).exp()
        };
        assert!((x - (1.0 - term(1.0) - term(3.0))).abs() < 3e-6, "{i}: {x} {}", 1.0 - term(1.0) - term(3.0));
    }
    let counts = stepper.counts();
    // 38 of the evaluations tell which entries there are.
    assert_eq!((counts.evaluations, counts.accepted, counts.jacobians), (2604, 1231, 2));
}

/// What is only arriving is followed in no unit: the far end of the rod, as t^1000, is left alone beside 1e9 as beside 1.
#[test]
fn a_rod_costs_the_same_in_any_unit() {
    let work = |scale: f64| {
        let mut stepper = Ode15s::new(Tolerances::automatic(300, 1e-6), StepLimits::default());
        let (mut t, mut x) = (0.0, vec![0.0; 300]);
        let mut plain = heat(300);
        let mut scaled = function(300, move |t, x, dx| {
            let x: Vec<f64> = x.iter().map(|x| x / scale).collect();
            plain.derivatives(t, &x, dx).unwrap();
            dx.iter_mut().for_each(|dx| *dx *= scale);
        });
        integrate(&mut stepper, &mut scaled, &mut t, &mut x, 1.0).unwrap();
        stepper.counts().accepted
    };
    let plain = work(1.0);
    for power in [10, 20, 30] {
        let other = work(f64::from(1 << power));
        assert!(other.abs_diff(plain) * 10 < plain, "2^{power}: {other} steps, {plain} in units of one");
    }
}

/// A slow motion, a fast one that follows it (z = x^2), and what drives both, in the ratio of a pressure to a volume.
#[test]
fn states_of_very_different_units_are_all_followed() {
    // A power of two, so that rounding is the same.
    let unit = |n: i32| 2f64.powi(n);
    for (x_unit, y_unit, z_unit) in [(-30, 20, -27), (-37, 23, -30), (0, 40, 10), (-33, 0, -33)]
        .map(|(a, b, c)| (unit(a), unit(b), unit(c)))
    {
        let mut system = function(3, move |_, s, d| {
            let (x, y, z) = (s[0] / x_unit, s[1] / y_unit, s[2] / z_unit);
            d[0] = x_unit * (-1e3 * x + y.cos());
            d[1] = y_unit * (1.0 - 100.0 * x);
            d[2] = z_unit * -1e5 * (z - x * x);
        });
        let steppers: [Box<dyn Stepper>; 4] = [
            Box::new(Ode15s::new(Tolerances::automatic(3, 1e-6), StepLimits::default())),
            Box::new(Auto::new(Tolerances::automatic(3, 1e-6), StepLimits::default())),
            Box::new(Radau5::new(Tolerances::automatic(3, 1e-6), StepLimits::default())),
            Box::new(Ode23tb::new(Tolerances::automatic(3, 1e-6), StepLimits::default())),
        ];
        for mut stepper in steppers {
            let (mut t, mut s) = (0.0, [x_unit, y_unit, 0.0]);
            integrate(&mut *stepper, &mut system, &mut t, &mut s, 10.0).unwrap();
            // The same in units of one, by Radau5 at 1e-12; x has been 1e-3.
            let (x, z) = (s[0] / x_unit, s[2] / z_unit);
            let off = [(x - 3.460_400_527e-5) / 1e-3, z / (x * x) - 1.0];
            assert!(
                off[0].abs() < 1e-4 && off[1].abs() < 2e-3,
                "{} {x_unit:e} {z_unit:e}: {off:?}",
                stepper.name()
            );
        }
    }
}

const VAN_DER_POL: [f64; 2] = [1.706_167_732_170_469, -0.892_809_701_024_812_5e-3];
const ROBERTSON: [f64; 3] = [2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505];
const HIRES: [f64; 8] = [
    0.737_131_257_332_566_8e-3,
    0.144_248_572_631_618_5e-3,
    0.588_872_974_096_757_5e-4,
    0.117_565_134_328_314_9e-2,
    0.238_635_619_883_133_1e-2,
    0.623_896_825_274_279_6e-2,
    0.284_999_839_518_576_9e-2,
    0.285_000_160_481_423_1e-2,
];
const OREGONATOR: [f64; 3] =
    [0.100_081_487_031_852_3e1, 0.122_817_852_154_991_7e4, 0.132_055_494_284_670_6e3];
/// Coordinates of the stars.
pub const STARS: [f64; 14] = [
    0.370_613_914_397_050_2,
    0.323_728_409_205_723_3e1,
    -0.322_255_903_241_832_4e1,
    0.659_709_145_577_531,
    0.342_558_170_715_658_4,
    0.156_217_210_140_063_1e1,
    -0.700_309_292_221_249_5,
    -0.394_343_758_551_739_2e1,
    -3.271_380_973_972_55,
    0.522_508_184_345_654_3e1,
    -2.590_612_434_977_47,
    0.119_821_369_339_227_5e1,
    -0.242_968_234_493_582_4,
    1.091_449_240_428_98,
];

#[test]
fn halving_the_tolerance_halves_the_error_at_all_orders() {
    let mut before = f64::INFINITY;
    for relative in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let mut stepper = Ode15s::new(Tolerances::automatic(2, relative), StepLimits::default());
        let (mut t, mut x, mut within) = (0.0, [0.0, 1.0], 0.0_f64);
        while t < 3.0 {
            stepper.step(&mut swing(), &mut t, &mut x, 3.0).unwrap();
            let (t0, t1) = stepper.last_step();
            for theta in [0.25, 0.5, 0.75] {
                let (between, mut y) = (t0 + theta * (t1 - t0), [0.0; 2]);
                stepper.interpolate(between, &mut y);
                let [a, b] = swing_solution(between);
                within = within.max((y[0] - a).hypot(y[1] - b));
            }
        }
        let [a, b] = swing_solution(3.0);
        let error = (x[0] - a).hypot(x[1] - b);
        assert!(error < 100.0 * relative && within < 100.0 * relative, "{relative:e}: {error:e}, {within:e}");
        assert!(within < before, "{relative:e}: {within:e}");
        before = within;
    }
}

/// Two states, of which one is as fast as the rate, that both follow cosines.
fn fast_and_slow(rate: f64) -> impl System {
    blocksim_solve::problems::function(2, move |t: f64, x, dx| {
        dx[0] = -rate * (x[0] - t.cos()) - t.sin();
        dx[1] = x[0] - x[1];
    })
}

#[test]
fn auto_stays_with_the_explicit_method_where_nothing_is_stiff() {
    let mut auto = Auto::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
    let mut ode45 = Ode45::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
    for mut system in [Box::new(swing()) as Box<dyn System>, Box::new(van_der_pol(2.0))] {
        let (mut t, mut x, mut s, mut y) = (0.0, [0.0, 1.0], 0.0, [0.0, 1.0]);
        auto.restart();
        ode45.restart();
        integrate(&mut auto, &mut *system, &mut t, &mut x, 50.0).unwrap();
        integrate(&mut ode45, &mut *system, &mut s, &mut y, 50.0).unwrap();
        assert_eq!((x, auto.counts()), (y, ode45.counts()));
    }
    assert_eq!(auto.share(), Some(Share::default()));
}

#[test]
fn steps_that_stability_limits_are_counted() {
    let mut limited = [1e3, 1.0].map(|rate| {
        let mut ode45 = Ode45::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
        let (mut t, mut x) = (0.0, [0.0, 1.0]);
        integrate(&mut ode45, &mut fast_and_slow(rate), &mut t, &mut x, 10.0).unwrap();
        ode45.counts().limited as f64 / ode45.counts().accepted as f64
    });
    limited.iter_mut().for_each(|share| *share = share.round());
    assert_eq!(limited, [1.0, 0.0]);
}

#[test]
fn auto_follows_what_swings_for_ever_with_the_explicit_method_at_any_tolerance() {
    for relative in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
        for mut system in [
            Box::new(blocksim_solve::problems::function(2, |_, x, dx| (dx[0], dx[1]) = (x[1], -x[0])))
                as Box<dyn System>,
            Box::new(blocksim_solve::problems::function(2, |_, x, dx| (dx[0], dx[1]) = (x[1], -x[0].sin()))),
        ] {
            let mut auto = Auto::new(Tolerances::automatic(2, relative), StepLimits::default());
            let (mut t, mut x) = (0.0, [2.0, 0.0]);
            integrate(&mut auto, &mut *system, &mut t, &mut x, 1000.0).unwrap();
            assert_eq!(auto.share(), Some(Share::default()), "{relative:e}: {:?}", auto.counts());
        }
    }
}

#[test]
fn auto_changes_to_the_stiff_method_in_time_and_says_when() {
    for rate in [1e3, 1e5, 1e8] {
        let mut auto = Auto::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
        let (mut t, mut x) = (0.0, [1.0, 0.0]);
        integrate(&mut auto, &mut fast_and_slow(rate), &mut t, &mut x, 10.0).unwrap();
        assert!((x[0] - 10f64.cos()).abs() < 1e-5, "{rate:e}: {x:?}");
        let share = auto.share().unwrap();
        let first = share.first.unwrap();
        assert!(first < 200.0 / rate && share.changes == 1, "{rate:e}: {share:?}");
        // Stability would ask for rate * 10 / 3.3 steps.
        assert!(auto.counts().accepted < 400, "{rate:e}: {:?}", auto.counts());
    }
}

#[test]
fn auto_gives_back_when_stiffness_ends() {
    // Stiff for the first ten seconds; what oscillates later is not.
    let mut system = blocksim_solve::problems::function(2, |t: f64, x, dx| {
        let rate = if t < 10.0 { 1e5 } else { 1.0 };
        dx[0] = -rate * (x[0] - t.cos());
        dx[1] = x[0] - x[1];
    });
    let mut auto = Auto::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
    let (mut t, mut x) = (0.0, [1.0, 0.0]);
    integrate(&mut auto, &mut system, &mut t, &mut x, 10.0).unwrap();
    auto.restart();
    integrate(&mut auto, &mut system, &mut t, &mut x, 40.0).unwrap();
    let share = auto.share().unwrap();
    assert_eq!(share.changes, 2, "{share:?}");
    // x = (cos t + sin t) / 2 + c exp(-t) behind, of which the last has faded.
    assert!((x[0] - 0.5 * (40f64.cos() + 40f64.sin())).abs() < 1e-5, "{x:?}");
}

#[test]
fn auto_solves_the_stiff_problems_by_default() {
    let mut auto = Auto::new(Tolerances::automatic(3, 1e-6), StepLimits::default());
    let (mut t, mut x) = (0.0, [1.0, 0.0, 0.0]);
    integrate(&mut auto, &mut robertson(), &mut t, &mut x, 40.0).unwrap();
    for (x, reference) in x.iter().zip([0.715_827_068_7, 9.185_534_764e-6, 0.284_163_745_7]) {
        assert!((x / reference - 1.0).abs() < 1e-5, "{x:e} instead of {reference:e}");
    }
    assert!(auto.share().unwrap().changes == 1 && auto.counts().evaluations < 600, "{:?}", auto.counts());
    let mut auto = Auto::new(Tolerances::automatic(2, 1e-6), StepLimits::default());
    let (mut t, mut x) = (0.0, [2.0, 0.0]);
    integrate(&mut auto, &mut van_der_pol(1000.0), &mut t, &mut x, 2000.0).unwrap();
    assert!((x[0] / VAN_DER_POL[0] - 1.0).abs() < 1e-4, "{x:?}");
    assert!(auto.counts().evaluations < 4000, "{:?}", auto.counts());
}

#[test]
fn radau_gains_digits_where_tolerances_are_tight() {
    type Case<'a> = (&'a str, Box<dyn System>, &'a [f64], f64, &'a [f64], [u64; 2]);
    let cases: [Case; 3] = [
        ("Van der Pol", Box::new(van_der_pol(1000.0)), &[2.0, 0.0], 2000.0, &VAN_DER_POL, [7468, 19_529]),
        (
            "HIRES",
            Box::new(hires()),
            &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
            321.8122,
            &HIRES,
            [3739, 9973],
        ),
        ("Oregonator", Box::new(oregonator()), &[1.0, 2.0, 3.0], 360.0, &OREGONATOR, [10_271, 27_160]),
    ];
    for (name, mut system, start, end, expected, pinned) in cases {
        let mut found = [0; 2];
        for (k, relative) in [1e-6, 1e-8].into_iter().enumerate() {
            let mut stepper =
                Radau5::new(Tolerances::automatic(start.len(), relative), StepLimits::default());
            let (mut t, mut x) = (0.0, start.to_vec());
            integrate(&mut stepper, &mut *system, &mut t, &mut x, end).unwrap();
            let error = x.iter().zip(expected).map(|(x, e)| (x / e - 1.0).abs()).fold(0.0, f64::max);
            assert!(error < 2.0 * relative, "{name}, {relative:e}: {error:e}");
            found[k] = stepper.counts().evaluations;
        }
        assert_eq!(found, pinned, "{name}");
    }
}

/// A tolerance of the beginning, where the first state is 1, would let it pass zero when it has fallen to 1e-8, and below zero
/// there is no way back: all ended at -1e7 or so, at tolerances up to 1e-3 here and at any on the longer run.
#[test]
fn states_that_fall_a_millionfold_keep_their_digits() {
    type Make = fn(Tolerances, StepLimits) -> Box<dyn Stepper>;
    for (relative, within) in [(1e-2, 3e-2), (1e-3, 1e-2), (1e-4, 3e-3), (1e-6, 2e-4), (1e-8, 1e-4)] {
        let tolerances = || Tolerances::automatic(3, relative);
        let limits = StepLimits::default;
        let methods: [Make; 5] = [
            |tolerances, limits| Box::new(Auto::new(tolerances, limits)),
            |tolerances, limits| Box::new(Ode15s::new(tolerances, limits)),
            |tolerances, limits| Box::new(Radau5::new(tolerances, limits)),
            |tolerances, limits| Box::new(Ode23t::new(tolerances, limits)),
            |tolerances, limits| Box::new(Ode23tb::new(tolerances, limits)),
        ];
        for make in methods {
            let mut stepper = make(tolerances(), limits());
            let (mut t, mut x) = (0.0, [1.0, 0.0, 0.0]);
            integrate(&mut *stepper, &mut robertson(), &mut t, &mut x, 1e11).unwrap();
            for (x, expected) in x.iter().zip(ROBERTSON) {
                let error = (x / expected - 1.0).abs();
                assert!(error < within, "{}, {relative:e}: {x:e} instead of {expected:e}", stepper.name());
            }
            // The terms of the second equation agree to 13 digits there: nothing but rounding is left, but it decides nothing.
            integrate(&mut *stepper, &mut robertson(), &mut t, &mut x, 4e13).unwrap();
            assert!(
                x[0].abs() < 1e-9 && (x[2] - 1.0).abs() < 1e-9,
                "{}, {relative:e}: {x:?}",
                stepper.name()
            );
            assert!(stepper.counts().evaluations < 200_000, "{}: {:?}", stepper.name(), stepper.counts());
        }
    }
}

#[test]
fn rounding_is_not_taken_for_stiffness() {
    // Adding a number that is far larger and taking it away leaves noise in f, which makes steps short; but no stiff method
    // could make longer ones.
    for (large, relative) in [(1e8, 1e-6), (1e8, 1e-10), (1e10, 1e-8)] {
        let rounded = |x: f64| (large + x) - large;
        let mut swing = function(2, |_, x, dx| {
            dx[0] = x[1];
            dx[1] = -rounded(x[0]);
        });
        let mut follows = function(2, |t: f64, x, dx| {
            dx[0] = -rounded(x[0]) + 0.1 * x[1];
            dx[1] = rounded(t.sin()) - x[1];
        });
        for system in [&mut swing as &mut dyn System, &mut follows] {
            let mut auto = Auto::new(Tolerances::automatic(2, relative), StepLimits::default());
            let (mut t, mut x) = (0.0, [1.0, 0.5]);
            integrate(&mut auto, system, &mut t, &mut x, 100.0).unwrap();
            assert_eq!(auto.share().unwrap().changes, 0, "{large:e}, {relative:e}");
        }
    }
}

#[test]
fn what_has_faded_is_left_to_the_stiff_method_far_inside_the_region_of_stability() {
    // HIRES at a tight tolerance: Ode45 makes steps of 1.1 of the shortest time constant where those of Ode15s are twice as long.
    let mut auto = Auto::new(Tolerances::automatic(8, 1e-8), StepLimits::default());
    let (mut t, mut x) = (0.0, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057]);
    integrate(&mut auto, &mut hires(), &mut t, &mut x, 321.8122).unwrap();
    let Share { changes, first, .. } = auto.share().unwrap();
    assert_eq!(changes, 1);
    assert!((0.9..1.4).contains(&first.unwrap()), "{first:?}");
    assert!(auto.counts().evaluations < 2500, "{:?}", auto.counts());
    assert!((x[0] / 0.737_131_257_332_566_8e-3 - 1.0).abs() < 1e-6);
}
