//! How well actual values follow their set values.

use blocksim_results::format::fixed;
use blocksim_results::{Align, Table};
use blocksim_signal::Unit;
use serde_json::{Value, json};

use crate::signals::naming::{is_of, numbered_part, short_names};
use crate::signals::shown::Shown;
use crate::terminal::format::{column, headed};

/// A scope with the inputs `set` and `actual`.
#[derive(Debug, Clone)]
pub struct Tracking<'a> {
    /// Path of the scope.
    pub scope: &'a str,
    /// The path as far as it differs from the other scopes.
    pub name: &'a str,
    /// Set value.
    pub set: &'a Shown<'a>,
    /// Actual value.
    pub actual: &'a Shown<'a>,
    /// Torque of the same joint, if one is recorded.
    pub torque: Option<&'a Shown<'a>>,
}

/// The numbers of one scope, in the unit of its set value.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// Unit of both errors.
    pub unit: String,
    /// Largest absolute value of set - actual.
    pub largest: f64,
    /// When it was, s.
    pub at: f64,
    /// set - actual in the last row.
    pub last: f64,
    /// Largest absolute torque and its unit.
    pub torque: Option<(f64, String)>,
}

/// Finds all scopes with set and actual values, in the order in which they are recorded. Of scopes that show the
/// same two signals only the first is taken, with the torque that is found for any of them.
pub fn trackings<'a>(shown: &'a [Shown<'a>]) -> Vec<Tracking<'a>> {
    let port_of = |scope: &str, port: &str| shown.iter().find(|s| s.block() == scope && s.port() == port);
    let sets = shown.iter().filter(|s| s.port() == "set");
    let pairs: Vec<_> = sets.filter_map(|set| Some((set, port_of(set.block(), "actual")?))).collect();
    let same = |a: &(&Shown, &Shown), b: &(&Shown, &Shown)| (a.0.cell, a.1.cell) == (b.0.cell, b.1.cell);
    let first: Vec<_> = pairs
        .iter()
        .enumerate()
        .filter(|(n, p)| !pairs[..*n].iter().any(|q| same(p, q)))
        .map(|(_, p)| *p)
        .collect();
    let scopes: Vec<&str> = first.iter().map(|(set, _)| set.block()).collect();
    let is_only = scopes.len() == 1;
    first
        .iter()
        .zip(short_names(&scopes))
        .map(|(pair, name)| {
            let twins = pairs.iter().filter(|other| same(pair, other));
            let torque = twins.filter_map(|(set, _)| torque_of(set.block(), is_only, shown)).next();
            Tracking { scope: pair.0.block(), name, set: pair.0, actual: pair.1, torque }
        })
        .collect()
}

/// The torque of the joint that a scope looks at: a torque whose path has a part of the same name and number
/// (`joint3` and `Joint3OutBus`); where the scope has no number, one recorded beside the scope, or the only one
/// of all for the only scope of all. The one nearest to the top wins: the joint's before the motor's.
fn torque_of<'a>(scope: &str, is_only: bool, shown: &'a [Shown<'a>]) -> Option<&'a Shown<'a>> {
    let torques: Vec<&Shown> = shown.iter().filter(|s| is_torque(s)).collect();
    let depth = |s: &&&Shown| s.path.split(['/', '.']).count();
    if let Some((name, number)) = numbered_part(scope) {
        return torques.iter().filter(|s| is_of(s.path, &name, number)).min_by_key(depth).copied();
    }
    let beside = scope.rsplit_once('/').map(|(parent, _)| format!("{parent}/"));
    let found = torques
        .iter()
        .filter(|s| beside.as_ref().is_some_and(|parent| s.path.starts_with(parent.as_str())))
        .min_by_key(depth);
    found.or(torques.first().filter(|_| is_only && torques.len() == 1)).copied()
}

/// Whether both the path and the unit speak of a torque.
fn is_torque(shown: &Shown) -> bool {
    let measured = Unit::parse("N*m").is_ok_and(|unit| shown.dimension == Some(unit.dimension));
    let named = |part: &str| part.to_lowercase().contains("torque") || part.eq_ignore_ascii_case("tau");
    measured && shown.path.split(['/', '.']).any(named)
}

impl Tracking<'_> {
    /// The errors over a run; `None` where no row has both values.
    pub fn errors(&self, time: &[f64]) -> Option<Errors> {
        let unit = &self.set.unit;
        let error = |(set, actual): (&f64, &f64)| unit.from_si(*set) - unit.from_si(*actual);
        let errors = self.set.si.iter().zip(self.actual.si).map(error);
        let finite: Vec<(f64, f64)> =
            time.iter().copied().zip(errors).filter(|(_, error)| error.is_finite()).collect();
        let largest = finite.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        Some(Errors {
            unit: unit.to_string(),
            largest: largest.1.abs(),
            at: largest.0,
            last: finite.last()?.1,
            torque: self.torque.map(|torque| {
                let sizes = torque.values().into_iter().map(f64::abs).filter(|x| x.is_finite());
                (sizes.fold(0.0, f64::max), torque.unit.to_string())
            }),
        })
    }
}

/// A row for each scope; empty where there is none.
pub fn table(trackings: &[Tracking], time: &[f64]) -> String {
    let rows: Vec<(&str, Errors)> =
        trackings.iter().filter_map(|tracking| Some((tracking.name, tracking.errors(time)?))).collect();
    let units: Vec<&str> = rows.iter().map(|(_, errors)| errors.unit.as_str()).collect();
    let cells = |value: &dyn Fn(&Errors) -> Option<f64>, units: &[&str]| {
        column(&rows.iter().map(|(_, errors)| value(errors)).collect::<Vec<_>>(), units)
    };
    let torques: Vec<&str> =
        rows.iter().filter_map(|(_, e)| e.torque.as_ref().map(|torque| torque.1.as_str())).collect();
    let columns = [
        (headed("largest error", &units), cells(&|e| Some(e.largest), &units)),
        ("at [s]".to_owned(), rows.iter().map(|(_, e)| fixed(e.at, 3)).collect()),
        (headed("final error", &units), cells(&|e| Some(e.last), &units)),
        (headed("peak torque", &torques), cells(&|e| e.torque.as_ref().map(|torque| torque.0), &torques)),
    ];
    // Without any torque its column is left out.
    let columns = if torques.is_empty() { &columns[..3] } else { &columns[..] };
    let mut headings = vec![("following", Align::Left)];
    headings.extend(columns.iter().map(|(heading, _)| (heading.as_str(), Align::Right)));
    if rows.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&headings);
    for (n, (name, _)) in rows.iter().enumerate() {
        table.row(
            std::iter::once((*name).to_owned()).chain(columns.iter().map(|(_, cells)| cells[n].clone())),
        );
    }
    table.render()
}

/// The same as data.
pub fn json(trackings: &[Tracking], time: &[f64]) -> Value {
    let row = |tracking: &Tracking| {
        let errors = tracking.errors(time)?;
        Some(json!({
            "scope": tracking.scope,
            "unit": errors.unit,
            "largest_error": errors.largest,
            "at": errors.at,
            "final_error": errors.last,
            "torque": tracking.torque.map(|torque| torque.path),
            "peak_torque": errors.torque.as_ref().map(|torque| torque.0),
            "torque_unit": errors.torque.as_ref().map(|torque| torque.1.as_str()),
        }))
    };
    trackings.iter().filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::shown::{shown, tests::example};
    use expect_test::expect;

    #[test]
    fn joints_are_paired_with_their_torques_and_told_in_degrees() {
        let (recorded, recording) = example(vec![
            ("control/joint1/scope.set", "rad", "deg", vec![0.0, 1.0, 1.0]),
            ("control/joint1/scope.actual", "rad", "deg", vec![0.0, 0.995, 1.0001]),
            ("control/joint2/scope.set", "rad", "deg", vec![0.0, 0.5, 0.5]),
            ("control/joint2/scope.actual", "rad", "deg", vec![0.0, 0.4, 0.5]),
            ("control/joint3/scope.set", "rad", "deg", vec![0.0, 0.5, 0.5]),
            ("other/scope.set", "rad", "deg", vec![0.0, 0.5, 0.5]),
            ("arm.signals.Joint1OutBus.Drive.Torque", "N*m", "", vec![0.0, 7.0, 1.0]),
            ("arm.signals.Joint1OutBus.Torque", "N*m", "", vec![0.0, -1061.2, 500.0]),
            ("arm.signals.Joint12OutBus.Torque", "N*m", "", vec![0.0, 9.0, 1.0]),
        ]);
        let shown = shown(&recorded, &recording);
        let trackings = trackings(&shown);
        assert_eq!(trackings[0].torque.map(|torque| torque.path), Some("arm.signals.Joint1OutBus.Torque"));
        expect![[r#"
            following  largest error [deg]  at [s]  final error [deg]  peak torque [N*m]
            joint1                   0.286   1.000          -0.005730               1061
            joint2                   5.730   1.000           0.000000                  -
        "#]]
        .assert_eq(&table(&trackings, &recording.time));
        assert_eq!(json(&trackings, &recording.time)[0]["peak_torque"], 1061.2);
    }

    #[test]
    fn two_scopes_of_the_same_signals_are_one_row_with_the_torque_of_either() {
        let (mut recorded, recording) = example(vec![
            ("control/joint1/scope.set", "rad", "", vec![0.0, 1.0]),
            ("control/joint1/scope.actual", "rad", "", vec![0.0, 1.0]),
            ("measurements/axis1.set", "rad", "", vec![0.0, 1.0]),
            ("measurements/axis1.actual", "rad", "", vec![0.0, 1.0]),
            ("measurements/torques.axis1", "N*m", "", vec![0.0, 5.0]),
        ]);
        recorded[2].cell = recorded[0].cell;
        recorded[3].cell = recorded[1].cell;
        let shown = shown(&recorded, &recording);
        let trackings = trackings(&shown);
        assert_eq!(trackings.len(), 1);
        assert_eq!(trackings[0].torque.map(|torque| torque.path), Some("measurements/torques.axis1"));
    }

    #[test]
    fn one_servo_takes_the_only_torque_there_is() {
        let columns = vec![
            ("angle.set", "rad", "", vec![0.0, 1.0]),
            ("angle.actual", "rad", "", vec![0.0, f64::NAN]),
            ("sensor.tau", "N*m", "", vec![0.5, f64::NAN]),
        ];
        let (recorded, recording) = example(columns);
        let shown = shown(&recorded, &recording);
        let errors = trackings(&shown)[0].errors(&recording.time).unwrap();
        assert_eq!((errors.largest, errors.torque), (0.0, Some((0.5, "N*m".to_owned()))));
    }

    #[test]
    fn a_torque_beside_its_scope_is_taken_and_a_work_is_none() {
        let (recorded, recording) = example(vec![
            ("left/scope.set", "m", "mm", vec![0.0]),
            ("left/scope.actual", "m", "mm", vec![0.001]),
            ("right/scope.set", "m", "mm", vec![0.0]),
            ("right/scope.actual", "m", "mm", vec![0.0]),
            ("left/drive.torque", "N*m", "", vec![3.0]),
            ("right/drive.torque", "W", "", vec![3.0]),
        ]);
        let shown = shown(&recorded, &recording);
        let trackings = trackings(&shown);
        assert_eq!(trackings[0].torque.map(|torque| torque.path), Some("left/drive.torque"));
        assert!(trackings[1].torque.is_none());
        assert_eq!(trackings[0].name, "left");
        assert!((trackings[0].errors(&recording.time).unwrap().last + 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_recorded_is_no_table() {
        assert_eq!(table(&[], &[]), "");
    }
}
