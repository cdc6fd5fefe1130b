//! Tests of the continuous PID controller.

use super::super::units::testing::{interface_with, output_unit, vector};
use super::*;
use crate::continuous::Form;
use blocksim_block::testing::Bench;

fn pid(kp: f64, ki: f64, kd: f64) -> PidLaw {
    PidLaw {
        kp,
        ki,
        kd,
        n: 100.0,
        form: Form::Parallel,
        lower: None,
        upper: None,
        external_limits: false,
        anti_windup: AntiWindup::None,
        kb: 1.0,
        x0: 0.0,
        d0: 0.0,
    }
}

fn limited(anti_windup: AntiWindup) -> PidLaw {
    PidLaw { lower: Some(-1.0), upper: Some(1.0), anti_windup, ..pid(2.0, 3.0, 0.0) }
}

fn block(law: PidLaw) -> Pid {
    Pid { law, reset: Reset::None }
}

#[test]
fn the_response_to_a_unit_step_matches_the_reference_values() {
    // P 2, I 3, D 0.5, N 100: 2 + 3 t + 50 exp(-100 t).
    let mut bench = Bench::new(block(pid(2.0, 3.0, 0.5)));
    assert_eq!(bench.respond(1.0), 52.0);
    for (duration, expected) in [(0.01, 20.42397), (0.09, 2.302270), (0.9, 5.0)] {
        bench.integrate(duration, 4000);
        let (u, exact) = (bench.minor()[0], 2.0 + 3.0 * bench.t + 50.0 * (-100.0 * bench.t).exp());
        assert!((u - exact).abs() < 1e-9, "t = {}: {u} != {exact}", bench.t);
        // The reference values are rounded to seven digits.
        assert!((u - expected).abs() < 5e-6, "t = {}: {u} != {expected}", bench.t);
    }
}

#[test]
fn in_the_ideal_form_kp_multiplies_all_parts() {
    let mut bench = Bench::new(block(PidLaw { form: Form::Ideal, ..pid(2.0, 3.0, 0.5) }));
    bench.set(0, &[1.0]).integrate(0.5, 4000);
    let expected = 2.0 * (1.0 + 1.5 + 50.0 * (-50.0_f64).exp());
    assert!((bench.minor()[0] - expected).abs() < 1e-9);
}

#[test]
fn vectors_are_controlled_element_by_element() {
    let mut bench = Bench::with_inputs(block(limited(AntiWindup::Clamping)), vector("e", 2));
    assert_eq!(bench.set(0, &[0.25, -4.0]).major(), [0.5, -1.0]);
    assert_eq!(bench.derivatives(), [0.75, 0.0, 0.0, -0.0]);
    assert_eq!(bench.guards().len(), 6);
}

#[test]
fn without_protection_the_integral_part_winds_up() {
    let mut bench = Bench::new(block(limited(AntiWindup::None)));
    bench.set(0, &[1.0]).integrate(2.0, 20);
    assert!((bench.x[0] - 6.0).abs() < 1e-12);
    assert_eq!(bench.minor(), [1.0]);
}

#[test]
fn clamping_stops_the_integral_part_only_on_the_way_out() {
    let mut bench = Bench::new(block(limited(AntiWindup::Clamping)));
    bench.set(0, &[1.0]).major();
    bench.integrate(2.0, 20);
    assert_eq!((bench.x[0], bench.minor()[0]), (0.0, 1.0));
    assert_eq!(bench.guards()[2], 1.0);
    // The error turns while v is still above: the integral part goes on at once.
    bench.x[0] = 4.0;
    bench.set(0, &[-1.0]).major();
    assert_eq!(bench.minor(), [1.0]);
    assert_eq!(bench.derivatives()[0], -3.0);
}

#[test]
fn a_clamped_integral_part_waits_a_thousandth_of_the_range_inside() {
    let mut bench = Bench::new(block(limited(AntiWindup::Clamping)));
    bench.set(0, &[0.6]).major();
    assert_eq!(bench.derivatives()[0], 0.0);
    // v = 0.999: back inside, but by less than 0.002.
    bench.set(0, &[0.4995]).major();
    assert_eq!(bench.derivatives()[0], 0.0);
    assert!((bench.guards()[0] - 0.001).abs() < 1e-12);
    bench.set(0, &[0.4985]).major();
    assert!(bench.derivatives()[0] > 1.0);
    assert!((bench.guards()[0] + 0.003).abs() < 1e-12);
}

#[test]
fn clamping_knows_the_sign_of_the_gains() {
    // With negative gains the integral part leads out at the upper limit for a negative error.
    let mut bench =
        Bench::new(block(PidLaw { kp: -2.0, form: Form::Ideal, ..limited(AntiWindup::Clamping) }));
    bench.set(0, &[-1.0]).major();
    assert_eq!((bench.minor()[0], bench.derivatives()[0]), (1.0, 0.0));
    assert_eq!(bench.guards()[2], 1.0);
    bench.x[0] = -4.0;
    bench.set(0, &[0.25]).major();
    assert!(bench.guards()[0] > 6.0);
    assert_eq!(bench.guards()[2], -0.25);
}

#[test]
fn back_calculation_settles_where_both_drives_are_in_balance() {
    let mut bench = Bench::new(block(PidLaw { kb: 5.0, ..limited(AntiWindup::BackCalculation) }));
    bench.set(0, &[1.0]).integrate(10.0, 2000);
    // ki e = kb (v - upper): v = 1 + 3 / 5, of which kp e = 2.
    assert!((bench.x[0] - (1.6 - 2.0)).abs() < 1e-12);
    // And on the way there exponentially with kb.
    let mut bench = Bench::new(block(PidLaw { kb: 5.0, ..limited(AntiWindup::BackCalculation) }));
    bench.set(0, &[1.0]).integrate(0.2, 200);
    assert!((bench.x[0] + 0.4 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
}

#[test]
fn without_integral_gain_nothing_is_integrated() {
    let block = block(PidLaw { ki: 0.0, x0: 0.25, ..limited(AntiWindup::BackCalculation) });
    let mut bench = Bench::new(block);
    bench.set(0, &[3.0]).integrate(1.0, 10);
    assert_eq!(bench.x[0], 0.25);
}

#[test]
fn a_reset_sets_both_states_back() {
    let mut bench =
        Bench::new(Pid { reset: Reset::Rising, law: PidLaw { x0: 1.0, d0: 0.5, ..pid(2.0, 3.0, 0.5) } });
    bench.set(0, &[1.0]).set(1, &[-1.0]).major();
    bench.integrate(0.1, 100);
    assert_eq!(bench.guards(), [-1.0]);
    bench.set(1, &[1.0]);
    assert_eq!(bench.major(), [3.0]);
    assert_eq!(bench.x, [1.0, 0.5]);
    assert!(!bench.interface.reads(0, 1));
}

#[test]
fn the_unit_is_that_of_the_input_times_that_of_kp() {
    let block = block(pid(2.0, 3.0, 0.5));
    assert_eq!(output_unit(&block, &[("e", "rad")], &[]), "rad");
    assert_eq!(output_unit(&block, &[("e", "rad")], &[("kp", "N*m/rad")]), "N*m");
    let with = |parameters: &[(&str, &str)]| interface_with(&block, &[("e", "m")], parameters);
    assert!(with(&[("kp", "N/m"), ("ki", "N/(m*s)"), ("kd", "N*s/m"), ("upper", "N")]).is_ok());
    for wrong in [("ki", "N/m"), ("kd", "N/m"), ("upper", "m")] {
        let error = with(&[("kp", "N/m"), wrong]).unwrap_err();
        assert!(error.message.contains(wrong.0), "{}", error.message);
    }
    let ideal = Pid { law: PidLaw { form: Form::Ideal, ..block.law }, ..block };
    assert!(interface_with(&ideal, &[("e", "m")], &[("kp", "N/m"), ("ki", "1/s"), ("kd", "s")]).is_ok());
}

#[test]
fn parameters_that_make_no_controller_are_refused() {
    let refused = [
        (block(PidLaw { kp: f64::NAN, ..pid(1.0, 0.0, 0.0) }), "kp"),
        (block(PidLaw { n: 0.0, ..pid(1.0, 0.0, 0.0) }), "n"),
        (block(PidLaw { lower: Some(1.0), upper: Some(1.0), ..pid(1.0, 0.0, 0.0) }), "upper"),
        (block(PidLaw { anti_windup: AntiWindup::Clamping, ..pid(1.0, 0.0, 0.0) }), "anti_windup"),
        (block(PidLaw { kb: -1.0, ..limited(AntiWindup::BackCalculation) }), "kb"),
    ];
    for (block, param) in refused {
        assert_eq!(block.errors()[0].param, param);
    }
}

#[test]
fn limits_by_signals_do_what_parameters_of_the_same_value_do() {
    for anti_windup in [AntiWindup::None, AntiWindup::Clamping, AntiWindup::BackCalculation] {
        let by_signals = PidLaw { lower: None, upper: None, external_limits: true, ..limited(anti_windup) };
        let mut signals = Bench::new(block(by_signals));
        let mut fixed = Bench::new(block(limited(anti_windup)));
        for e in [0.2, 3.0, -0.5, -4.0, 0.1] {
            signals.set(0, &[e]).set(1, &[-1.0]).set(2, &[1.0]);
            fixed.set(0, &[e]);
            assert_eq!(
                signals.integrate(0.5, 20).major(),
                fixed.integrate(0.5, 20).major(),
                "{anti_windup:?}"
            );
            assert_eq!(signals.guards(), fixed.guards());
        }
    }
    let mut bench = Bench::new(block(PidLaw { external_limits: true, ..pid(2.0, 0.0, 0.0) }));
    assert_eq!(bench.respond(1e9), 2e9, "an input that is not connected does not limit");
    assert_eq!(bench.set(2, &[3.0]).major(), [3.0]);
    assert!(bench.set(1, &[4.0]).failure().unwrap().contains("the limits cross"));
}
