use super::*;

fn ramp(rows: u32, step: f64, slope: f64, offset: f64) -> (Vec<f64>, Vec<f64>) {
    let time: Vec<f64> = (0..rows).map(|k| f64::from(k) * step).collect();
    let values = time.iter().map(|t| offset + slope * t).collect();
    (time, values)
}

fn compared(a: &(Vec<f64>, Vec<f64>), b: &(Vec<f64>, Vec<f64>), rule: Rule) -> Comparison {
    compare(Series::new(&a.0, &a.1), Series::new(&b.0, &b.1), &rule)
}

#[test]
fn a_signal_is_the_same_as_itself() {
    let a = ramp(11, 0.1, 2.0, 0.0);
    let found = compared(&a, &a, Rule::default());
    assert!(found.is_same() && found.points == 11 && found.rms == 0.0, "{found:?}");
    assert_eq!(found.span, Some((0.0, a.0[10])));
}

#[test]
fn straight_lines_agree_on_any_time_base_between_their_values() {
    let (a, b) = (ramp(11, 0.1, 2.0, 0.0), ramp(8, 1.0 / 7.0, 2.0, 0.0));
    let found = compared(&a, &b, Rule { absolute: 1e-12, ..Rule::default() });
    assert!(found.is_within(), "{found:?}");
    // 0, seven sevenths and ten tenths, 1 being both.
    assert_eq!(found.points, 17);
    // Held values of a ramp differ by up to the slope times the coarser step.
    let held = compared(&a, &b, Rule { interpolation: Interpolation::Hold, ..Rule::default() });
    let maximum = held.maximum.unwrap().difference().abs();
    assert!(maximum > 0.1 && maximum <= 2.0 / 7.0, "{maximum}");
}

#[test]
fn only_common_instants_are_compared_where_that_is_asked_for() {
    // Every third value of the finer one is one of the coarser; between them the two have nothing to do with each other.
    let (mut a, b) = (ramp(31, 0.1, 1.0, 0.0), ramp(11, 0.3, 1.0, 0.0));
    for (k, value) in a.1.iter_mut().enumerate().filter(|(k, _)| k % 3 != 0) {
        *value += if k % 2 == 0 { 5.0 } else { -5.0 };
    }
    let rule = Rule { absolute: 1e-9, ..Rule::default() };
    assert!(!compared(&a, &b, rule).is_within());
    let found = compared(&a, &b, Rule { instants: Instants::Intersection, ..rule });
    assert!(found.is_within() && found.points == 11, "{found:?}");
    let apart = (b.0.iter().map(|t| t + 0.05).collect(), b.1.clone());
    assert_eq!(compared(&a, &apart, Rule { instants: Instants::Intersection, ..rule }).points, 0);
}

#[test]
fn the_tolerance_is_the_larger_of_both() {
    // Differs by 1 % of the baseline 0 to 10, plus nothing.
    let (a, b) = (ramp(101, 0.1, 1.0, 0.0), ramp(101, 0.1, 1.01, 0.0));
    let rule = |absolute, relative| Rule { absolute, relative, ..Rule::default() };
    assert!(compared(&a, &b, rule(0.0, 0.0101)).is_within());
    assert!(compared(&a, &b, rule(0.101, 0.0)).is_within());
    let found = compared(&a, &b, rule(0.05, 0.005));
    // 0.01 t > max(0.05, 0.005 t) from t = 5 on, where it is equal.
    let first = found.first.unwrap();
    assert!((first.time - 5.1).abs() < 1e-9 && (first.tolerance - 0.05).abs() < 1e-12, "{first:?}");
    assert!((found.maximum.unwrap().time - 10.0).abs() < 1e-9);
    // Root of the mean of (0.01 t)^2 over the rows: 0.1 sqrt((2 n + 1) / (6 n)) with n = 100.
    assert!((found.rms - 0.1 * (201.0_f64 / 600.0).sqrt()).abs() < 1e-12);
}

#[test]
fn a_late_step_is_within_its_time_tolerance_and_no_later_one() {
    let step = |at: f64| (vec![0.0, at, at, 2.0], vec![0.0, 0.0, 1.0, 1.0]);
    let rule = |time| Rule { time, absolute: 1e-9, ..Rule::default() };
    assert!(compared(&step(1.0), &step(1.05), rule(0.051)).is_within());
    assert!(compared(&step(1.05), &step(1.0), rule(0.051)).is_within());
    let found = compared(&step(1.0), &step(1.05), rule(0.0));
    assert_eq!(found.first.unwrap(), Deviation { time: 1.0, baseline: 1.0, compared: 0.0, tolerance: 1e-9 });
    assert!(!compared(&step(1.0), &step(1.05), rule(0.04)).is_within());
    // It may come late, but not be too high.
    let mut high = step(1.05);
    high.1[2] = 1.1;
    assert!(!compared(&step(1.0), &high, rule(0.1)).is_within());
}

#[test]
fn both_sides_of_a_jump_count() {
    let a = (vec![0.0, 1.0, 1.0, 2.0], vec![0.0, 0.0, 5.0, 5.0]);
    let b = (vec![0.0, 1.0, 1.0, 2.0], vec![0.0, 0.5, 5.0, 5.0]);
    let found = compared(&a, &b, Rule::default());
    assert_eq!((found.outside, found.maximum.unwrap().difference()), (1, 0.5));
    assert!(compared(&a, &b, Rule { interpolation: Interpolation::Hold, ..Rule::default() }).is_same());
}

#[test]
fn what_is_no_number_agrees_only_with_its_like() {
    let with = |x: f64| (vec![0.0, 1.0, 2.0], vec![0.0, x, 0.0]);
    let (nan, infinite) = (with(f64::NAN), with(f64::INFINITY));
    assert!(compared(&nan, &nan, Rule::default()).is_within());
    assert!(compared(&infinite, &infinite, Rule::default()).is_within());
    for (a, b) in [(&nan, &with(0.0)), (&with(0.0), &nan), (&infinite, &with(1e300)), (&nan, &infinite)] {
        let found = compared(a, b, Rule { absolute: 1e6, relative: 1.0, ..Rule::default() });
        assert!(!found.is_within(), "{a:?} {b:?}");
        assert_eq!(found.first.unwrap().time, 1.0);
    }
}

#[test]
fn signals_without_common_time_are_not_compared() {
    let (a, b) = ((vec![0.0, 1.0], vec![0.0, 0.0]), (vec![2.0, 3.0], vec![0.0, 0.0]));
    let found = compared(&a, &b, Rule::default());
    assert!(!found.is_within() && found.span.is_none() && found.points == 0);
    assert!(!compared(&a, &(vec![], vec![]), Rule::default()).is_within());
    // One common instant is enough.
    assert!(compared(&a, &(vec![1.0, 2.0], vec![0.0, 9.0]), Rule::default()).is_within());
}

#[test]
fn held_values_do_not_come_late_by_rounding() {
    let a = (
        (0..100).map(|k| f64::from(k) * 0.1).collect::<Vec<_>>(),
        (0..100).map(f64::from).collect::<Vec<_>>(),
    );
    let b = ((0..100).map(|k| f64::from(k) / 10.0).collect::<Vec<_>>(), a.1.clone());
    assert!(compared(&a, &b, Rule { interpolation: Interpolation::Hold, ..Rule::default() }).is_same());
}

#[test]
fn a_share_of_the_range_counts_where_the_signal_is_zero() {
    let time: Vec<f64> = (0..=100).map(|i| f64::from(i) * 0.01).collect();
    let wave =
        |late: f64| -> Vec<f64> { time.iter().map(|t| 3.0 * (7.0 * (t - late)).sin() + 0.5).collect() };
    let (a, b) = (wave(0.0), wave(1e-4));
    let by = |rule: Rule| compare(Series::new(&time, &a), Series::new(&time, &b), &rule);
    let largest = by(Rule::default()).maximum.expect("a difference").difference().abs();
    // The range of the sampled wave is a little less than 6.
    let range = a.iter().fold(f64::MIN, |m, x| m.max(*x)) - a.iter().fold(f64::MAX, |m, x| m.min(*x));
    assert!(by(Rule { range: 1.001 * largest / range, ..Rule::default() }).is_within());
    let found = by(Rule { range: 0.999 * largest / range, ..Rule::default() });
    assert!(!found.is_within() && found.outside < 20, "{found:?}");
    assert!(!by(Rule { relative: 1e-2, ..Rule::default() }).is_within());
    // Nothing of a signal that has no range, and NaN takes no part in it.
    let level = vec![2.0; time.len()];
    let rule = Rule { range: 0.1, ..Rule::default() };
    assert_eq!(rule.over(&Series::new(&time, &level)).absolute, 0.0);
    assert_eq!(rule.over(&Series::new(&[0.0, 1.0, 2.0], &[1.0, f64::NAN, 3.0])).absolute, 0.2);
    assert_eq!(rule.over(&Series::new(&[], &[])).absolute, 0.0);
}

/// Two events at one time: the value between them lasts for no time, and is seen all the same, but not of what is held.
#[test]
fn a_value_between_two_rows_of_one_time_is_compared() {
    let by = |baseline: Series, other: Series, interpolation| {
        compare(baseline, other, &Rule { interpolation, ..Rule::default() })
    };
    let (time, values) = ([0.0, 0.5, 0.5, 0.5, 1.0], [0.0, 0.0, 7.0, 0.0, 0.0]);
    let (flat, steps) = (Series::new(&[0.0, 1.0], &[0.0, 0.0]), Series::new(&time, &values));
    for (baseline, other) in [(steps, flat), (flat, steps)] {
        let found = by(baseline, other, Interpolation::Linear);
        assert_eq!(found.outside, 1);
        assert_eq!(found.maximum.map(|maximum| maximum.difference().abs()), Some(7.0));
        assert!(by(baseline, other, Interpolation::Hold).is_same());
    }
    assert!(by(steps, steps, Interpolation::Linear).is_same());
    // On the way of a jump of the other.
    let jump = Series::new(&[0.0, 0.5, 0.5, 1.0], &[0.0, 0.0, 9.0, 9.0]);
    let values = [0.0, 0.0, 7.0, 9.0, 9.0];
    assert!(by(jump, Series::new(&time, &values), Interpolation::Linear).is_same());
}

/// Between two changes that lie far apart neither held signal has a row, and what was long ago must not count there.
#[test]
fn a_held_change_that_comes_too_late_or_never_is_outside_of_a_time_tolerance() {
    let signal = |changes: &[(f64, f64)]| {
        let mut rows = vec![(0.0, 0.0)];
        for &(t, value) in changes {
            rows.push((t, rows.last().unwrap().1));
            rows.push((t, value));
        }
        rows.push((1.0, rows.last().unwrap().1));
        rows.into_iter().unzip::<f64, f64, Vec<_>, Vec<_>>()
    };
    let rule = |interpolation| Rule { time: 0.01, interpolation, ..Rule::default() };
    let pulse = signal(&[(0.4, 1.0), (0.6, 0.0)]);
    for interpolation in [Interpolation::Hold, Interpolation::Linear, Interpolation::Smooth] {
        let outside = |a: &_, b: &_| compared(a, b, rule(interpolation)).outside;
        assert!(outside(&signal(&[(0.5, 1.0)]), &signal(&[(0.9, 1.0)])) > 0, "{interpolation:?}");
        assert!(outside(&signal(&[(0.5, 1.0)]), &signal(&[(0.1, 1.0)])) > 0, "{interpolation:?}");
        assert!(outside(&pulse, &signal(&[])) > 0 && outside(&signal(&[]), &pulse) > 0, "{interpolation:?}");
        assert!(outside(&pulse, &signal(&[(0.395, 1.0), (0.609, 0.0)])) == 0, "{interpolation:?}");
        assert!(outside(&pulse, &signal(&[(0.395, 1.0), (0.611, 0.0)])) > 0, "{interpolation:?}");
        assert!(outside(&pulse, &signal(&[(0.389, 1.0), (0.609, 0.0)])) > 0, "{interpolation:?}");
    }
    let found = compared(&pulse, &signal(&[]), rule(Interpolation::Hold));
    assert!(found.first.is_some_and(|first| (first.time - 0.41).abs() < 1e-6), "{found:?}");
    // Instants that say nothing new are not counted.
    assert_eq!(compared(&pulse, &pulse, rule(Interpolation::Hold)).points, 4);
}

/// Random changes, against looking at very many instants.
#[test]
fn held_signals_agree_within_a_time_tolerance_where_a_fine_grid_says_so() {
    let mut state = 7_u64;
    let mut dice = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % n
    };
    let mut outside = 0;
    for _ in 0..400 {
        // Changes on a grid of 10, the tolerance in the middle of two cells.
        let mut signal = || {
            let mut times = vec![0.0];
            times.extend((0..=dice(4)).map(|_| dice(100) as f64 * 10.0));
            times.push(1000.0);
            times.sort_by(f64::total_cmp);
            let mut values: Vec<f64> = times.iter().map(|_| dice(2) as f64).collect();
            // What begins at the end lasts for no time.
            let end = times.partition_point(|t| *t < 1000.0);
            let before = values[end - 1];
            values[end..].fill(before);
            (times, values)
        };
        let (a, mut b) = (signal(), signal());
        if dice(2) == 0 {
            b = (a.0.iter().map(|t| (t + 20.0 * dice(3) as f64).min(1000.0)).collect(), a.1.clone());
            b.0[0] = 0.0;
            b.0.sort_by(f64::total_cmp);
            let end = b.0.partition_point(|t| *t < 1000.0);
            let before = b.1[end - 1];
            b.1[end..].fill(before);
        }
        let rule = Rule { time: 25.0, interpolation: Interpolation::Hold, ..Rule::default() };
        let held = |(times, values): &(Vec<f64>, Vec<f64>), t: f64| {
            values[times.partition_point(|&x| x <= t).saturating_sub(1)]
        };
        let grid = |from: f64, to: f64| {
            let cells = from.max(0.0).ceil() as i64..=to.min(1000.0).floor() as i64;
            cells.map(|k| k as f64 + 0.5).take_while(|t| *t < 1000.0)
        };
        // Half of a cell is neither here nor there.
        let disagrees = grid(0.0, 999.0).any(|t| {
            let new = held(&b, t);
            grid(t - 25.5, t + 25.5).all(|near| held(&a, near) != new)
        });
        let found = compared(&a, &b, rule);
        if disagrees {
            assert!(found.outside > 0, "{a:?} {b:?}");
            outside += 1;
        }
        let is_near =
            grid(0.0, 999.0).all(|t| grid(t - 23.5, t + 23.5).any(|near| held(&a, near) == held(&b, t)));
        if is_near && held(&a, 1000.0) == held(&b, 1000.0) {
            assert_eq!(found.outside, 0, "{a:?} {b:?}");
        }
    }
    assert!(outside > 100, "{outside}");
}
