//! Slopes that follow from laws agree with differences, in all shipped diagrams, all examples and random models.

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Start};
use blocksim_linear::jacobian;
use blocksim_sim::{Frozen, Observer, Origin, Period, PeriodMap, Simulation, Tap};
use blocksim_tests::random::{Puzzle, Signals, Variant};
use blocksim_tests::{compile_file, compile_text, diagrams_below, root};

struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}

/// Runs are looked at up to this time, s.
const LONGEST: f64 = 0.5;
/// Difference of an exact slope and one by differences, as a part of both and of the largest slope of the model.
const CLOSE: (f64, f64) = (1e-7, 1e-10);
/// Difference of slopes over two distances, as a part of the slope, above which there is a kink between.
const KINKED: f64 = 1e-3;

/// Slopes that do not agree, how many were compared, and how many have a kink nearby.
fn compare(name: &str, mut schedule: Schedule, wrong: &mut Vec<String>, kinked: &mut usize) -> usize {
    schedule.settings.start = Start::Given;
    let end = schedule.settings.stop_time.min(LONGEST);
    let Ok(mut simulation) = Simulation::new(Arc::new(schedule)) else { return 0 };
    let mut compared = 0;
    for part in [0.31, 0.77] {
        if simulation.run_until(part * end, &mut Nobody).is_err() {
            break;
        }
        let Ok(Some(slopes)) = simulation.slopes() else { break };
        let largest = slopes.iter().map(|slope| slope.exact.abs()).fold(0.0, f64::max);
        compared += slopes.len();
        for slope in slopes {
            let (a, b) = (slope.exact, slope.difference);
            let agrees = (a - b).abs() <= CLOSE.0 * a.abs().max(b.abs()) + CLOSE.1 * largest;
            if slope.spread > KINKED * a.abs().max(b.abs()) {
                *kinked += 1;
            } else if !agrees {
                wrong.push(format!(
                    "{name}, {} s: d {} / d {}: {a}, but {b}",
                    part * end,
                    slope.derivative,
                    slope.state
                ));
            }
        }
    }
    compared
}

#[test]
fn slopes_of_laws_are_those_of_differences() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let (mut compared, mut wrong, mut kinked) = (0, Vec::new(), 0);
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        compared += compare(&name, schedule, &mut wrong, &mut kinked);
    }
    for seed in 1..201 {
        let (compiled, problems) = compile_text(&Signals::of(seed).text(&Variant::plain()));
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("signals {seed}: {problems}"));
        compared += compare(&format!("signals {seed}"), schedule, &mut wrong, &mut kinked);
    }
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(kinked < compared / 10, "{kinked} of {compared} have a kink nearby");
    assert!(compared > 300, "only {compared} slopes were compared");
}

/// What the chain rule has given, and what of it does not agree with differences of the whole model.
#[derive(Default)]
struct Chained {
    exact: usize,
    partly: usize,
    unknown: usize,
    wrong: Vec<String>,
}

/// Compares slopes of derivatives and of all signals, by states and by changes of some signals, in a model at two times.
fn compare_chained(name: &str, mut schedule: Schedule, found: &mut Chained) {
    schedule.settings.start = Start::Given;
    let end = schedule.settings.stop_time.min(LONGEST);
    let schedule = Arc::new(schedule);
    for part in [0.31, 0.77] {
        let Ok(mut simulation) = Simulation::new(Arc::clone(&schedule)) else { return };
        if simulation.run_until(part * end, &mut Nobody).is_err() {
            return;
        }
        let last = schedule.signals.len().saturating_sub(1);
        let cells =
            [0, last / 2, last].map(|signal| schedule.signals.get(signal).map(|signal| signal.offset));
        let mut taps: Vec<Tap> = cells.iter().flatten().map(|&cell| Tap { cell, open: false }).collect();
        taps.dedup_by_key(|tap| tap.cell);
        let Ok(mut frozen) = Frozen::new(simulation, taps.clone()) else { return };
        let x = frozen.states().to_vec();
        let (n, m) = (x.len(), taps.len());
        let signals =
            schedule.signals.iter().map(|signal| signal.offset + signal.shape.len()).max().unwrap_or(0);
        if frozen.differentiate(&x).is_err() {
            continue;
        }
        let mut columns = Vec::new();
        for column in 0..n + m {
            let mut direction = vec![0.0; n + m];
            direction[column] = 1.0;
            let mut dx = vec![0.0; n];
            // What errors of differences make of a slope is an error of it.
            frozen.along(&direction[..n], &direction[n..], true, &mut dx);
            let doubtful =
                dx.iter().copied().chain((0..signals).map(|cell| frozen.rate(cell))).collect::<Vec<f64>>();
            let origin = frozen.along(&direction[..n], &direction[n..], false, &mut dx);
            let rates = dx.into_iter().chain((0..signals).map(|cell| frozen.rate(cell)));
            let rates: Vec<(f64, f64)> =
                rates.zip(doubtful).map(|(rate, other)| (rate, (rate - other).abs())).collect();
            match origin {
                Origin::Laws => found.exact += 1,
                Origin::Differences => found.partly += 1,
                Origin::Unknown => found.unknown += 1,
            }
            columns.push((origin, rates));
        }
        let mut values = |column: usize, by: f64| -> Option<Vec<f64>> {
            let (mut at, mut change, mut dx) = (x.clone(), vec![0.0; m], vec![0.0; n]);
            if column < n {
                at[column] += by
            } else {
                change[column - n] = by
            };
            frozen.evaluate(&at, &change, &mut dx).ok()?;
            Some(dx.into_iter().chain((0..signals).map(|cell| frozen.signal(cell))).collect())
        };
        for (column, (origin, rates)) in
            columns.iter().enumerate().filter(|(_, (origin, _))| *origin != Origin::Unknown)
        {
            let h = 1e-3 * x.get(column).map_or(1.0, |x| x.abs().max(1.0));
            let at = [0.0, -h, h, -h / 2.0, h / 2.0].map(|by| values(column, by));
            let [Some(here), Some(a), Some(b), Some(c), Some(d)] = at else { continue };
            let largest = rates.iter().map(|rate| rate.0.abs()).fold(0.0, f64::max);
            for (row, &(exact, error)) in rates.iter().enumerate() {
                let (wide, narrow) = ((b[row] - a[row]) / (2.0 * h), (d[row] - c[row]) / h);
                let sides = [(here[row] - c[row]) / (h / 2.0), (d[row] - here[row]) / (h / 2.0)];
                let rounding = 1e-13 * here[row].abs().max(d[row].abs()) / h;
                let bend = (sides[1] - sides[0]).abs();
                let difference = (4.0 * narrow - wide) / 3.0;
                let size = exact.abs().max(difference.abs());
                let doubt = (wide - narrow).abs();
                if bend > 0.01 * sides[0].abs().max(sides[1].abs()) || doubt > KINKED * size {
                    continue;
                }
                // Differences of parts are good to seven digits of the largest slope; laws are exact.
                let own = match origin {
                    Origin::Laws => 0.1 * doubt + 1e-12 * largest,
                    _ => doubt + 2.0 * error + CLOSE.0 * largest,
                };
                let within = CLOSE.0 * size + rounding + own;
                if (exact - difference).abs() > within {
                    let what =
                        if row < n { format!("derivative {row}") } else { format!("cell {}", row - n) };
                    found.wrong.push(format!(
                        "{name}, {} s: {what} over column {column} of {n} + {m}: {exact}, but {difference} +- {doubt}",
                        part * end
                    ));
                }
            }
        }
    }
}

#[test]
fn slopes_by_the_chain_rule_are_those_of_the_whole_model() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let mut found = Chained::default();
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        compare_chained(&name, schedule, &mut found);
    }
    for seed in 1..101 {
        let (compiled, problems) = compile_text(&Signals::of(seed).text(&Variant::plain()));
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("signals {seed}: {problems}"));
        compare_chained(&format!("signals {seed}"), schedule, &mut found);
    }
    let Chained { exact, partly, unknown, wrong } = found;
    assert!(
        wrong.is_empty(),
        "{} of {exact} + {partly}:\n{}",
        wrong.len(),
        wrong[..wrong.len().min(60)].join("\n")
    );
    assert!(
        exact > 300 && partly > 100 && unknown < (exact + partly) / 5,
        "{exact} exact, {partly} partly, {unknown} unknown"
    );
}

/// States above which differences of the map over a period take too long.
const MANY: usize = 16;
/// Sample hits in a period above which they do.
const LONG: f64 = 50.0;

/// What is known of the maps from hit to hit.
#[derive(Default)]
struct Mapped {
    exact: usize,
    partly: usize,
    whole: Vec<String>,
    wrong: Vec<String>,
}

/// Compares the slopes of the map over a period of the sample times with differences of the map.
fn compare_mapped(name: &str, mut schedule: Schedule, found: &mut Mapped) {
    schedule.settings.start = Start::Given;
    let all: Vec<usize> = (0..schedule.blocks.len()).collect();
    let at = 0.31 * schedule.settings.stop_time.min(LONGEST);
    let fastest = schedule.clock.rates.iter().map(|rate| schedule.clock.time(rate.period));
    let fastest = fastest.fold(f64::INFINITY, f64::min);
    let given = schedule.clock.rates.is_empty().then_some(0.01 * schedule.settings.stop_time);
    let Ok(period) = Period::of(&schedule, &all, at, given) else { return };
    if schedule.states > MANY || period.length / fastest > LONG {
        return;
    }
    let last = schedule.signals.len().saturating_sub(1);
    let cells: Vec<usize> =
        [0, last / 2].iter().filter_map(|&k| schedule.signals.get(k)).map(|signal| signal.offset).collect();
    let taps: Vec<Tap> = cells.first().map(|&cell| Tap { cell, open: false }).into_iter().collect();
    let made = PeriodMap::new(&schedule, (&all, period), taps.clone(), false, &mut Nobody);
    let Ok(Some((mut map, _))) = made else { return };
    let (x, n) = (map.states().to_vec(), map.states().len());
    if n == 0 || n > MANY {
        return;
    }
    let slopes = match map.slopes(taps.len(), &cells, false, &mut || true) {
        Ok(slopes) => slopes,
        Err(reason) => return found.whole.push(format!("{name}: {reason}")),
    };
    match slopes.by_differences.is_empty() {
        true => found.exact += 1,
        false => found.partly += 1,
    }
    let point: Vec<f64> = x.iter().copied().chain(taps.iter().map(|_| 0.0)).collect();
    let rows = n + cells.len();
    let differences = jacobian(&point, rows, |z, out| {
        let (next, values) = out.split_at_mut(n);
        map.evaluate(&z[..n], &z[n..], next)?;
        values.iter_mut().zip(&cells).for_each(|(value, &cell)| *value = map.signal(cell));
        Ok::<(), blocksim_sim::SimError>(())
    });
    let Ok(differences) = differences else { return };
    let size = |column: usize| point[column].abs().max(1.0);
    for row in 0..rows {
        let parts = (0..point.len()).map(|column| differences.value[(row, column)].abs() * size(column));
        let largest = parts.fold(0.0, f64::max);
        for column in 0..point.len() {
            let exact = match row.checked_sub(n) {
                None => slopes.next[(row, column)],
                Some(output) => slopes.signal(cells[output], column),
            };
            let (other, error) = (differences.value[(row, column)], differences.error[(row, column)]);
            let within =
                CLOSE.0 * exact.abs().max(other.abs()) + CLOSE.1 * largest / size(column) + 10.0 * error;
            if (exact - other).abs() > within {
                found.wrong.push(format!(
                    "{name}, {} s: row {row} of {n} over column {column}: {exact}, but {other} +- {error}",
                    period.begin
                ));
            }
        }
    }
}

#[test]
fn slopes_from_hit_to_hit_are_those_of_the_map() {
    let paths = [diagrams_below("diagrams"), diagrams_below("docs/blocks")].concat();
    let mut found = Mapped::default();
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        // Its bridge switches so often in a period that this one takes as long as all others.
        if name.contains("pmsm_foc") {
            continue;
        }
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        compare_mapped(&name, schedule, &mut found);
    }
    for seed in 1..101 {
        let (compiled, problems) = compile_text(&Signals::of(seed).text(&Variant::plain()));
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("signals {seed}: {problems}"));
        compare_mapped(&format!("signals {seed}"), schedule, &mut found);
    }
    let Mapped { exact, partly, whole, wrong } = found;
    assert!(wrong.is_empty(), "{} in {exact} + {partly}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(
        exact > 40 && partly > 80 && whole.len() < 60,
        "{exact} exact, {partly} partly, {} not:\n{}",
        whole.len(),
        whole.join("\n")
    );
    // Nobody is to be left to differences because a look at slopes that are right contradicts them.
    let contradicted: Vec<&String> = whole.iter().filter(|reason| reason.contains("are not those")).collect();
    assert!(contradicted.is_empty(), "{contradicted:#?}");
}

/// `ki ts kv / w1` of the controller of axis 1, a plug-in: `I' = I + ki ts (qd_set + kv (q_set - q) - w) / w1`. Beyond the limits of its
/// output, a hundredth of a radian away, the integral is frozen and does not move on either side.
#[test]
fn an_integral_that_is_frozen_beyond_a_limit_is_followed_within_it() {
    let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &["drive=torque"]);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.start = Start::Given;
    let all: Vec<usize> = (0..schedule.blocks.len()).collect();
    let period = Period::of(&schedule, &all, 0.5, None).expect("a period");
    let made = PeriodMap::new(&schedule, (&all, period), Vec::new(), false, &mut Nobody);
    let (mut map, _) = made.expect("a run").expect("a map");
    let place = |name: &str| map.names().iter().position(|known| known == name).expect("a state");
    let [integral, q, w] =
        ["control/joint1/controller/torque.integral", "arm/base/joint.q", "arm/base/joint.w"].map(place);
    let slopes = map.slopes(0, &[], false, &mut || true).expect("slopes");
    let (kv, ki, ts, w1) = (20.0, 20.0 * 4500.0, 1e-3, 1000.0);
    for (column, expected) in [(integral, 1.0), (q, -ki * ts * kv / w1), (w, -ki * ts / w1)] {
        let found = slopes.next[(integral, column)];
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found}, not {expected}");
    }
}
