//! What the engine makes of a circuit, compared with the reference.

use super::super::changes::changes;
use super::super::puzzle::Fault;
use super::{Circuit, Kind, Outcome};
use crate::Run;

/// By how much a diode may be on the wrong side, as part of the largest voltages and currents.
const WRONG_SIDE: f64 = 1e-4;

/// The first difference, if there is one.
pub(super) fn compare(circuit: &Circuit, outcome: &Outcome, run: &Run) -> Option<Fault> {
    let wrong = contradiction(run, circuit);
    if wrong > WRONG_SIDE {
        return Some(Fault::new("valve", format!("a diode is on the wrong side by {wrong:e}")));
    }
    for (t, row) in outcome.times.iter().zip(&outcome.rows) {
        let last = run.time.len() - 1;
        let at = run.time.partition_point(|time| *time < t - 1e-9).min(last);
        if (run.time[at] - t).abs() > 1e-9 {
            return Some(Fault::new("rows", format!("there is no row at {t} s")));
        }
        for (k, name) in outcome.names.iter().enumerate() {
            let found = run.column(&format!("s.{name}"))[at];
            let fault = Fault::value("value", &format!("{name} at {t} s"), found, row[k], outcome.slack[k]);
            if fault.is_some() {
                return fault;
            }
        }
    }
    outcome.changes.iter().enumerate().find_map(|(k, known)| {
        let (Some(known), Kind::Diode(valve)) = (known, circuit.branches[k].kind) else { return None };
        // The reference ends with the last values that are compared.
        let end = outcome.times.last().map_or(0, |end| run.time.partition_point(|time| *time <= end + 1e-9));
        let v = &run.column(&format!("s.v{k}"))[..end];
        let over: Vec<f64> = v.iter().map(|v| v - valve.v_f).collect();
        let found = changes(&run.time[..end], &over, outcome.counts);
        let what = || format!("diode {k} has begun or ended to conduct {found} times instead of {known}");
        (found != *known).then(|| Fault::new("switches", what()))
    })
}

/// By how much diodes block with more than their forward voltage or conduct backwards, relative to the largest voltages and
/// currents, at every row.
pub fn contradiction(run: &Run, circuit: &Circuit) -> f64 {
    let most = |kind: &str| {
        let alike = run.recorded.iter().zip(&run.columns).filter(|(r, _)| r.path.starts_with(kind));
        alike.flat_map(|(_, column)| column).fold(1e-6, |m: f64, x| m.max(x.abs()))
    };
    let (most_v, most_i) = (most("s.v"), most("s.i"));
    let mut worst = 0.0_f64;
    for (k, branch) in circuit.branches.iter().enumerate() {
        let Kind::Diode(valve) = branch.kind else { continue };
        let (v, i) = (run.column(&format!("s.v{k}")), run.column(&format!("s.i{k}")));
        for (v, i) in v.iter().zip(i) {
            // On the lower line up to the forward voltage, on the upper one above it: beyond the corner by this much.
            let beyond = |over: f64| (over / most_v).max(0.0);
            let leak = valve.g_off * valve.v_f;
            let on = (v - (valve.v_f + valve.r_on * (i - leak))).abs() <= 1e-9 * most_v.max(1.0);
            let wrong = if on {
                ((leak - i) / most_i).max(0.0).min(beyond(valve.v_f - v).max(1.0))
            } else {
                beyond(v - valve.v_f)
            };
            worst = worst.max(wrong);
        }
    }
    worst
}
