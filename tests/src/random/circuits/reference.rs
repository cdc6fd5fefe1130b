//! What comes out of a circuit, and by how much it may be off.

use super::super::changes::{certain, doubt};
use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::text::ROWS;
use super::walk::Walk;
use super::{Branch, Circuit, Kind};

/// Longest step of the coarse run at the least effort, s, and by how much it is shorter at the next.
const STEP: f64 = 4e-6;
const FINER: f64 = 8.0;
/// Sources and levels are changed by this part to see what depends on them.
const CHANGE: f64 = 1e-5;
/// By how much a run at default settings may be off, as part of the size of what is alike.
const SLACK: f64 = 5e-4;

/// A diode that begins or ends to conduct crosses its forward voltage by this part of the largest potential, and stays there for this
/// part of the run.
const BAND: f64 = 3e-6;
const MOMENT: f64 = 1e-3;

/// Values at the times that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Names of the values in the recording.
    pub names: Vec<String>,
    /// Times, s.
    pub times: Vec<f64>,
    /// The values at each time.
    pub rows: Vec<Vec<f64>>,
    /// By how much each may be off, at any time.
    pub slack: Vec<f64>,
    /// How often each diode begins or ends to conduct; `None` for other branches, where that is not known, and where a run has too few rows
    /// to tell.
    pub changes: Vec<Option<u32>>,
    /// By how much, V, and how long, s, a voltage must be beyond the forward voltage to count.
    pub counts: (f64, f64),
    sizes: Vec<f64>,
}

/// What comes out, or why nobody knows.
pub(super) fn refer(circuit: &Circuit, effort: u32, change: f64) -> Result<Outcome, Undecided> {
    let step = STEP / FINER.powi(effort as i32);
    let exact = vec![0.0; circuit.branches.len()];
    let coarse = walk(circuit, step, &exact)?;
    let mut fine = walk(circuit, 0.5 * step, &exact)?;
    let mut slack: Vec<f64> = fine.sizes.iter().map(|size| SLACK * size).collect();
    let widen = |slack: &mut Vec<f64>, a: &Outcome, b: &Outcome, factor: f64| {
        for (a, b) in a.rows.iter().zip(&b.rows) {
            let off = a.iter().zip(b).map(|(a, b)| factor * (a - b).abs());
            slack.iter_mut().zip(off).for_each(|(slack, off)| *slack = slack.max(off));
        }
    };
    let sizes = fine.sizes.clone();
    let known = |slack: &[f64]| slack.iter().zip(&sizes).all(|(slack, size)| *slack <= 5.0 * SLACK * size);
    widen(&mut slack, &fine, &coarse, 2.0);
    if !known(&slack) {
        return Err(Undecided::Coarse);
    }
    doubt(&mut fine.changes, &coarse.changes);
    for seed in [1, 2] {
        let mut dice = Dice::new(seed);
        let changes: Vec<f64> = exact.iter().map(|_| change * CHANGE * (2.0 * dice.unit() - 1.0)).collect();
        let other = walk(circuit, step, &changes)?;
        widen(&mut slack, &coarse, &other, 5.0);
        doubt(&mut fine.changes, &other.changes);
    }
    if !known(&slack) {
        return Err(Undecided::Sensitive);
    }
    fine.slack = slack;
    Ok(fine)
}

fn walk(circuit: &Circuit, step: f64, changes: &[f64]) -> Result<Outcome, Undecided> {
    let storages: Vec<usize> =
        (0..circuit.branches.len()).filter(|k| circuit.branches[*k].kind.is_storage()).collect();
    let mut names: Vec<String> = storages.iter().map(|k| format!("x{k}")).collect();
    if circuit.integrals {
        names.extend((1..=circuit.nodes).map(|node| format!("flux{node}")));
    }
    let every = circuit.every.unwrap_or(circuit.stop).min(circuit.stop);
    let count = (circuit.stop / every + 1e-6).floor() as usize;
    let times: Vec<f64> = (1..=count).map(|k| k as f64 * every).collect();
    let mut walk = Walk::new(circuit, changes);
    let mut rows = Vec::new();
    for time in &times {
        walk.go(*time, step)?;
        let states = storages.iter().map(|k| walk.x[*k]);
        let fluxes = walk.fluxes.iter().filter(|_| circuit.integrals);
        rows.push(states.chain(fluxes.copied()).collect::<Vec<_>>());
    }
    // Where only the end is compared, the sizes are those of the way there all the same: potentials are.
    let is_coil = |k: usize| matches!(circuit.branches[k].kind, Kind::Coil(_));
    let largest = walk.largest + 0.1;
    let most = |alike: &dyn Fn(usize) -> bool| {
        let columns = (0..storages.len()).filter(|i| alike(storages[*i]));
        columns.flat_map(|i| rows.iter().map(move |row| row[i].abs())).fold(0.0, f64::max)
    };
    let (current, voltage) = (most(&is_coil) + 1e-2, largest);
    let sizes = storages.iter().map(|k| if is_coil(*k) { current } else { voltage });
    let sizes = sizes.chain((storages.len()..names.len()).map(|_| circuit.stop * largest)).collect();
    let counts = (BAND * largest, MOMENT * circuit.stop);
    let number = |(over, branch): (&Vec<f64>, &Branch)| {
        // Voltages of diodes that do not leak are open where several of them block.
        let leaks = matches!(branch.kind, Kind::Diode(valve) if valve.g_off > 0.0);
        if !leaks || circuit.every.is_none() {
            return None;
        }
        // What can be seen at the steps alone, but not at the rows of a run, is not known to it.
        let row = |k: usize| (walk.times[k] / (every / ROWS)).floor();
        let rows: Vec<usize> = (0..over.len()).filter(|&k| k == 0 || row(k) != row(k - 1)).collect();
        let [times, values] =
            [&walk.times, over].map(|all| rows.iter().map(|&k| all[k]).collect::<Vec<f64>>());
        certain(&walk.times, over, counts).filter(|number| certain(&times, &values, counts) == Some(*number))
    };
    let changes = walk.over.iter().zip(&circuit.branches).map(number).collect();
    Ok(Outcome { names, times, rows, slack: Vec::new(), changes, counts, sizes })
}
