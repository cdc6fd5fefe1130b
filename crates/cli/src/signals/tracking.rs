//! Which actual values follow which set values, and how well.

use std::collections::HashMap;

use blocksim_analysis::{metrics, without_jumps};
use blocksim_block::schedule::Recorded;
use blocksim_picture::pairs;
use blocksim_signal::Unit;

use crate::signals::display::{Shown, display_unit, turn};
use crate::signals::headings::headings;
use crate::signals::naming::{is_of, numbered_part};

/// A set value and the actual value beside it in a scope.
#[derive(Debug, Clone)]
pub struct Tracking<'a> {
    /// Path of the scope.
    pub scope: &'a str,
    /// What to call it: the title of the scope or the end of its path, and which of its inputs, if it has several pairs.
    pub name: String,
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
    pub maximum: f64,
    /// When it was, s.
    pub at: f64,
    /// Mean of set - actual over the last 2 % of the time, as [`blocksim_analysis::Metrics`] has it.
    pub remaining: f64,
    /// Largest absolute torque and its unit.
    pub torque: Option<(f64, String)>,
}

/// Finds all set values of scopes with their actual values, in the order in which they are recorded. Of scopes that show the
/// same two signals only the first is taken, with the title and the torque that is found for any of them.
pub fn trackings<'a>(shown: &'a [Shown<'a>]) -> Vec<Tracking<'a>> {
    let all = in_scopes(shown);
    let is_new = |n: &usize| !all[..*n].iter().any(|pair| is_same(pair, &all[*n]));
    let first: Vec<Pair> = (0..all.len()).filter(is_new).map(|n| all[n]).collect();
    // Set values in the scopes that say how their pairs are called.
    let titled: Vec<&Shown> = first
        .iter()
        .map(|pair| twins(&all, pair).find(|set| !set.title.is_empty()).unwrap_or(pair.0))
        .collect();
    let names = headings(&titled.iter().map(|set| (set.block(), set.title)).collect::<Vec<_>>());
    let pairs_of = |scope: &str| all.iter().filter(|pair| pair.0.block() == scope).count();
    let is_only = first.len() == 1;
    let torque = |set: &'a Shown<'a>| {
        // A torque belongs to a scope as a whole.
        if pairs_of(set.block()) == 1 { torque_of(set.block(), is_only, shown) } else { None }
    };
    let tracking = |(n, name): (usize, String)| {
        let (set, actual) = first[n];
        Tracking {
            scope: set.block(),
            name: match pairs_of(titled[n].block()) {
                1 => name,
                _ => format!("{name} {}", part(actual.port())),
            },
            set,
            actual,
            torque: twins(&all, &first[n]).find_map(torque),
        }
    };
    names.into_iter().enumerate().map(tracking).collect()
}

/// Whether two scopes show the same signals.
fn is_same(a: &Pair, b: &Pair) -> bool {
    (a.0.cell, a.1.cell) == (b.0.cell, b.1.cell)
}

/// The set values of all pairs of the same signals.
fn twins<'s, 'a>(
    all: &'s [Pair<'a>],
    pair: &'s Pair<'a>,
) -> impl Iterator<Item = &'a Shown<'a>> + use<'s, 'a> {
    all.iter().filter(move |other| is_same(pair, other)).map(|twin| twin.0)
}

/// A set value and its actual value.
type Pair<'a> = (&'a Shown<'a>, &'a Shown<'a>);

/// The pairs of each scope, in the order of their set values.
fn in_scopes<'a>(shown: &'a [Shown<'a>]) -> Vec<Pair<'a>> {
    let all: Vec<(&str, &str)> = shown.iter().map(|s| (s.path, s.unit.text.as_str())).collect();
    paired(&all).into_iter().map(|(set, actual)| (&shown[set], &shown[actual])).collect()
}

/// Whether each signal is a set or an actual value of a pair; what is found of these alone by [`trackings`] is what is found of all.
pub fn are_followed(recorded: &[Recorded]) -> Vec<bool> {
    let units: Vec<String> = recorded.iter().map(|r| display_unit(r).text).collect();
    let all: Vec<(&str, &str)> =
        recorded.iter().zip(&units).map(|(r, unit)| (r.path.as_str(), &**unit)).collect();
    let mut are = vec![false; recorded.len()];
    for (set, actual) in paired(&all) {
        (are[set], are[actual]) = (true, true);
    }
    are
}

/// Positions of the set and the actual values of each scope among signals with these paths and units. What is recorded of a bus
/// has the path of its elements behind that of the block, and is in no scope.
fn paired(all: &[(&str, &str)]) -> Vec<(usize, usize)> {
    let mut scopes: Vec<Vec<(usize, &str)>> = Vec::new();
    let mut known = HashMap::new();
    for (at, (path, _)) in all.iter().enumerate() {
        let Some((block, port)) =
            path.split_once('.').filter(|(_, port)| !port.is_empty() && !port.contains('.'))
        else {
            continue;
        };
        let scope = *known.entry(block).or_insert(scopes.len());
        if scope == scopes.len() {
            scopes.push(Vec::new());
        }
        scopes[scope].push((at, port));
    }
    let of_scope = |inputs: &Vec<(usize, &str)>| -> Vec<(usize, usize)> {
        let found = pairs(&inputs.iter().map(|(_, port)| *port).collect::<Vec<_>>());
        let both = found.into_iter().map(|(set, actual)| (inputs[set].0, inputs[actual].0));
        both.filter(|(set, actual)| all[*set].1 == all[*actual].1).collect()
    };
    scopes.iter().flat_map(of_scope).collect()
}

/// What an input has of its own: `[2]` of `actual[2]`, else its name.
pub fn part(port: &str) -> &str {
    port.find('[').map_or(port, |start| &port[start..])
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
        let (mut set, mut actual) = (self.set.values(), self.actual.values());
        if let Some(turn) = turn(unit) {
            without_jumps([time; 2], &mut set, &mut actual, turn);
        }
        let (maximum, at, remaining) = match metrics(time, Some(&set), &actual) {
            Some(numbers) => (numbers.max_error, numbers.max_error_at, numbers.steady_state_error),
            // Of one row alone there is no mean over time.
            None => {
                let errors =
                    time.iter().zip(set.iter().zip(&actual)).map(|(t, (set, actual))| (t, set - actual));
                let (t, error) = errors.rev().find(|(_, error)| error.is_finite())?;
                (error.abs(), *t, error)
            }
        };
        Some(Errors {
            unit: unit.to_string(),
            maximum,
            at,
            remaining,
            torque: self.torque.map(|torque| {
                let sizes = torque.values().into_iter().map(f64::abs).filter(|x| x.is_finite());
                (sizes.fold(0.0, f64::max), torque.unit.to_string())
            }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::display::{shown, tests::example};

    #[test]
    fn joints_are_paired_with_their_torques() {
        let ramp = || vec![0.0, 1.0];
        let (recorded, recording) = example(vec![
            ("control/joint1/scope.set", "rad", "deg", ramp()),
            ("control/joint1/scope.actual", "rad", "deg", ramp()),
            ("control/joint2/scope.set", "rad", "deg", ramp()),
            ("control/joint2/scope.actual", "rad", "deg", ramp()),
            ("control/joint3/scope.set", "rad", "deg", ramp()),
            ("other/scope.set", "rad", "deg", ramp()),
            ("arm.signals.Joint1OutBus.Drive.Torque", "N*m", "", ramp()),
            ("arm.signals.Joint1OutBus.Torque", "N*m", "", ramp()),
            ("arm.signals.Joint12OutBus.Torque", "N*m", "", ramp()),
        ]);
        let shown = shown(&recorded, &recording);
        let found: Vec<(String, Option<&str>)> =
            trackings(&shown).into_iter().map(|t| (t.name, t.torque.map(|torque| torque.path))).collect();
        let torque = Some("arm.signals.Joint1OutBus.Torque");
        assert_eq!(found, [("joint1".to_owned(), torque), ("joint2".to_owned(), None)]);
    }

    #[test]
    fn an_angle_that_jumps_by_a_whole_turn_is_not_off_by_one() {
        let pi = std::f64::consts::PI;
        let (recorded, recording) = example(vec![
            ("tool/zyx.set", "rad", "deg", vec![0.95 * pi, pi, -0.95 * pi]),
            ("tool/zyx.actual", "rad", "deg", vec![0.95 * pi, -pi, -0.95 * pi]),
        ]);
        let shown = shown(&recorded, &recording);
        let errors = trackings(&shown)[0].errors(&recording.time).unwrap();
        assert!(errors.maximum.abs() < 1e-9 && errors.remaining.abs() < 1e-9, "{errors:?}");
    }

    #[test]
    fn a_scope_of_several_pairs_has_a_name_for_each_and_no_torque() {
        let axis = || vec![0.0, 1.0];
        let (mut recorded, recording) = example(vec![
            ("tool/place.set[0]", "m", "mm", axis()),
            ("tool/place.set[1]", "m", "mm", axis()),
            ("tool/place.actual[0]", "m", "mm", axis()),
            ("tool/place.actual[1]", "m", "mm", axis()),
            ("tool/mixed.set", "m", "mm", axis()),
            ("tool/mixed.actual", "rad", "deg", axis()),
            ("tool/torque.tau", "N*m", "", axis()),
        ]);
        recorded[..4].iter_mut().for_each(|r| r.title = vec!["Tool centre point".to_owned()]);
        let shown = shown(&recorded, &recording);
        let found = trackings(&shown);
        let names: Vec<&str> = found.iter().map(|t| t.name.as_str()).collect();
        assert_eq!(names, ["Tool centre point [0]", "Tool centre point [1]"]);
        assert!(found.iter().all(|t| t.torque.is_none()));
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
        recorded[2..4].iter_mut().for_each(|r| r.title = vec!["Joint angle 1".to_owned()]);
        let shown = shown(&recorded, &recording);
        let trackings = trackings(&shown);
        assert_eq!(trackings.len(), 1);
        assert_eq!(
            (trackings[0].scope, trackings[0].name.as_str()),
            ("control/joint1/scope", "Joint angle 1")
        );
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
        assert_eq!((errors.maximum, errors.torque), (0.0, Some((0.5, "N*m".to_owned()))));
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
        assert!((trackings[0].errors(&recording.time).unwrap().remaining + 1.0).abs() < 1e-12);
    }
}
