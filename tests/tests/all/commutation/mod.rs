//! Valves against a slow reference and closed forms, with every method of variable step.

mod known;
mod random;
mod reference;
mod rows;

use blocksim_tests::{Run, compile_text, run};
use reference::{Branch, Kind, Slow, diagram};

/// Methods that look for events.
pub const METHODS: [&str; 3] = ["Ode45", "Rodas4", "RosW3"];

/// Runs a diagram to its end, or says why it does not.
pub fn try_run(text: &str) -> Result<Run, String> {
    let (compiled, problems) = compile_text(text);
    let run = run(compiled.schedule.ok_or(problems)?);
    match &run.error {
        Some(error) => Err(format!("{error:?}")),
        None => Ok(run),
    }
}

/// States of all branches of the reference at the points of a grid.
pub fn slow(nodes: usize, branches: &[Branch], h: f64, stop: f64, every: f64) -> Vec<Vec<f64>> {
    let mut slow = Slow::new(nodes, branches, h);
    let (steps, samples) = ((every / h).round() as usize, (stop / every).round() as usize);
    let mut rows = vec![slow.x.clone()];
    for _ in 0..samples {
        (0..steps).for_each(|_| slow.step());
        rows.push(slow.x.clone());
    }
    rows
}

/// Largest difference of a state from the reference, relative to the largest of its kind.
pub fn difference(run: &Run, branches: &[Branch], reference: &[Vec<f64>], every: f64) -> (f64, String) {
    let is_coil = |k: usize| matches!(branches[k].kind, Kind::Coil(_));
    let mut worst = (0.0, String::new());
    for k in (0..branches.len()).filter(|k| matches!(branches[*k].kind, Kind::Coil(_) | Kind::Capacitor(..)))
    {
        let alike = (0..branches.len()).filter(|other| is_coil(*other) == is_coil(k));
        let size = alike.flat_map(|i| reference.iter().map(move |row| row[i].abs())).fold(0.1, f64::max);
        let column = run.column(&format!("s.x{k}"));
        for (n, row) in reference.iter().enumerate() {
            let t = n as f64 * every;
            let at = run.time.partition_point(|time| *time < t - 1e-3 * every);
            assert!((run.time[at] - t).abs() < 1e-3 * every, "no row at {t} s");
            let off = (column[at] - row[k]).abs() / size;
            if off > worst.0 {
                worst = (off, format!("x{k} at {t}: {} for {}", column[at], row[k]));
            }
        }
    }
    worst
}

/// By how much diodes block with more than their forward voltage or conduct backwards, relative to the largest voltages and
/// currents, at every row.
pub fn violation(run: &Run, branches: &[Branch]) -> f64 {
    let most = |kind: char| {
        let alike =
            run.recorded.iter().zip(&run.columns).filter(|(r, _)| r.path.starts_with(&format!("s.{kind}")));
        alike.flat_map(|(_, column)| column).fold(1e-6, |m: f64, x| m.max(x.abs()))
    };
    let (most_v, most_i) = (most('v'), most('i'));
    let mut worst = 0.0_f64;
    for (k, branch) in branches.iter().enumerate() {
        let Kind::Diode(v_f, r_on, g_off) = branch.kind else { continue };
        let (v, i) = (run.column(&format!("s.v{k}")), run.column(&format!("s.i{k}")));
        for (v, i) in v.iter().zip(i) {
            // On the lower line up to the forward voltage, on the upper one above it: beyond the corner by this much.
            let beyond = |over: f64| (over / most_v).max(0.0);
            let on = (v - (v_f + r_on * (i - g_off * v_f))).abs() <= 1e-9 * most_v.max(1.0);
            let wrong = if on {
                ((g_off * v_f - i) / most_i).max(0.0).min(beyond(v_f - v).max(1.0))
            } else {
                beyond(v - v_f)
            };
            worst = worst.max(wrong);
        }
    }
    worst
}

fn branch(p: usize, n: usize, kind: Kind) -> Branch {
    Branch { p, n, kind }
}

/// A bridge of six diodes behind a coil in each phase, on a capacitor and a load.
fn three_phase_bridge() -> (usize, Vec<Branch>) {
    use Kind::*;
    let mut branches = Vec::new();
    // Nodes: 1-3 sources, 4-6 behind the coils, 7 star point, 8 plus; minus is ground.
    for k in 0..3 {
        let phase = -std::f64::consts::TAU / 3.0 * k as f64;
        branches.push(branch(1 + k, 7, Sine(325.0, 50.0, phase, 1e-3)));
        branches.push(branch(1 + k, 4 + k, Coil(0.5e-3)));
        branches.push(branch(4 + k, 8, Diode(0.8, 0.01, 0.0)));
        branches.push(branch(0, 4 + k, Diode(0.8, 0.01, 0.0)));
    }
    branches.push(branch(8, 0, Capacitor(2e-3, 0.0)));
    branches.push(branch(8, 0, Resistor(20.0)));
    (8, branches)
}

#[test]
fn a_three_phase_bridge_agrees_with_the_reference_by_every_method() {
    let (nodes, branches) = three_phase_bridge();
    let (stop, every) = (0.06, 1e-4);
    let reference = slow(nodes, &branches, 1e-6, stop, every);
    for method in METHODS {
        let run = try_run(&diagram(nodes, &branches, stop, every, method)).unwrap();
        let (off, at) = difference(&run, &branches, &reference, every);
        assert!(off < 2e-3, "{method}: {off:e}, {at}");
        assert!(violation(&run, &branches) < 1e-8, "{method}: {:e}", violation(&run, &branches));
    }
}
