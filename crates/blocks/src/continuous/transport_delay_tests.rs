use super::super::units::testing::{output_unit, vector};
use super::*;
use blocksim_block::testing::Bench;

fn block(delay: f64, y0: f64) -> TransportDelay {
    TransportDelay { delay, y0, buffer: 64 }
}

/// Runs over steps of length `h` with input `u(t)` and returns time and output after each.
fn run(delay: f64, h: f64, steps: usize, u: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut bench = Bench::new(block(delay, -7.0));
    let mut rows = vec![(0.0, bench.major()[0])];
    for step in 1..=steps {
        let end = step as f64 * h;
        bench.remember(end, step == 1, |t| vec![u(t)]);
        bench.reach();
        rows.push((end, bench.major()[0]));
    }
    rows
}

#[test]
fn a_polynomial_of_degree_four_comes_out_later_and_exact() {
    for (delay, h) in [(1.0, 0.3), (1.0, 1.0), (0.5, 0.01), (0.05, 1e-3)] {
        let u = |t: f64| 2.0 + t * (3.0 - t * (1.0 + t * (0.5 - 0.2 * t)));
        for (t, y) in run(delay, h, (3.0 * delay / h) as usize, u) {
            let expected = if t < delay { -7.0 } else { u(t - delay) };
            assert!((y - expected).abs() < 1e-11, "delay {delay}, h {h}, t {t}: {y} != {expected}");
        }
    }
}

#[test]
fn the_error_of_a_sine_falls_with_the_fifth_power_of_the_step() {
    let error = |h: f64| {
        let rows = run(0.2, h, (1.0 / h) as usize, |t| (10.0 * t).sin());
        let late = |&(t, y): &(f64, f64)| if t < 0.2 { 0.0 } else { (y - (10.0 * (t - 0.2)).sin()).abs() };
        // Between the ends of steps as well: the delay is no multiple of them.
        rows.iter().map(late).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(0.06), error(0.03));
    assert!(coarse < 1e-4 && fine < coarse / 20.0, "{coarse} {fine}");
}

#[test]
fn a_jump_comes_out_as_a_jump_at_a_time_event_and_a_kink_is_stopped_at() {
    let mut bench = Bench::new(block(0.1, -1.0));
    bench.remember(0.05, true, |t| vec![3.0 + t]);
    // At 0.05 the input jumps to 8; at 0.08 its slope changes.
    bench.remember(0.08, true, |_| vec![8.0]);
    bench.remember(0.09, true, |t| vec![8.0 + 5.0 * (t - 0.08)]);
    assert_eq!((bench.next_event(), bench.next_kink()), (0.1, 0.08 + 0.1));
    let jumps = [(0.1, -1.0, 3.0), (0.05 + 0.1, 3.05, 8.0)];
    for (event, before, after) in jumps {
        assert_eq!(bench.next_event(), event);
        bench.t = event;
        assert!((bench.minor()[0] - before).abs() < 1e-12);
        bench.remember(event, false, |_| vec![8.05]);
        assert!((bench.minor()[0] - before).abs() < 1e-12, "at the end of the step it is not there yet");
        bench.reach();
        assert!((bench.major()[0] - after).abs() < 1e-12, "{:?}", bench.major());
    }
    assert_eq!((bench.next_event(), bench.next_kink()), (f64::INFINITY, 0.08 + 0.1));
    bench.remember(0.08 + 0.1, false, |_| vec![8.05]);
    bench.reach();
    assert_eq!(bench.next_kink(), f64::INFINITY);
}

#[test]
fn what_comes_back_through_the_own_loop_is_smoother_each_time_and_not_stopped_at_for_ever() {
    let mut bench = Bench::new(block(1.0, 0.0));
    let mut stops = Vec::new();
    // The signal starts with a jump from 0 to 1 and goes on smoothly, with an event whenever the delay asks for one.
    bench.remember(0.5, true, |_| vec![1.0]);
    while bench.t < 12.0 {
        let next = bench.next_event().min(bench.next_kink());
        let end = (bench.t + 0.5).min(next);
        bench.remember(end, stops.last() == Some(&bench.t), |_| vec![1.0]);
        bench.reach();
        if end == next {
            stops.push(end);
        }
    }
    assert_eq!(stops, [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn more_steps_than_there_is_room_for_are_an_error_that_names_the_remedy() {
    let failed = std::panic::catch_unwind(|| run(1.0, 0.01, 200, |t| t));
    let reason = *failed.unwrap_err().downcast::<String>().unwrap();
    assert!(reason.contains("room for 64 steps") && reason.contains("`buffer`"), "{reason}");
    run(1.0, 0.02, 200, |t| t);
}

#[test]
fn vectors_are_delayed_element_by_element() {
    let mut bench = Bench::with_inputs(block(0.5, 0.0), vector("u", 2));
    assert_eq!(bench.major(), [0.0, 0.0]);
    bench.remember(0.4, true, |t| vec![1.0 + t, 2.0 - t]);
    bench.remember(0.75, false, |t| vec![1.0 + t, 2.0 - t]);
    bench.reach();
    let y = bench.major();
    assert!((y[0] - 1.25).abs() < 1e-14 && (y[1] - 1.75).abs() < 1e-14, "{y:?}");
}

#[test]
fn the_unit_is_that_of_the_input_and_no_delay_is_refused() {
    let block = block(0.0, 0.0);
    assert_eq!(output_unit(&block, &[("u", "V")], &[("y0", "mV")]), "V");
    assert_eq!(block.errors()[0].param, "delay");
}
