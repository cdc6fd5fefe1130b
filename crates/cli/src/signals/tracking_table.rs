//! How well actual values follow their set values, as a table and as data.

use blocksim_numbers::format::seconds;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use crate::signals::tracking::{Errors, Tracking};
use crate::terminal::format::{column, headed};

/// A row for each pair, those of one unit below a heading that says it; empty where there is none.
pub fn table(trackings: &[Tracking], time: &[f64]) -> String {
    let rows: Vec<(&str, Errors)> = trackings
        .iter()
        .filter_map(|tracking| Some((tracking.name.as_str(), tracking.errors(time)?)))
        .collect();
    let mut units: Vec<&str> = Vec::new();
    for (_, errors) in &rows {
        if !units.contains(&errors.unit.as_str()) {
            units.push(&errors.unit);
        }
    }
    let mut table = Table::new(&[
        ("", Align::Left),
        ("", Align::Right),
        ("", Align::Right),
        ("", Align::Right),
        ("", Align::Right),
    ]);
    for (n, unit) in units.iter().enumerate() {
        if n > 0 {
            table.gap();
        }
        let own: Vec<&(&str, Errors)> = rows.iter().filter(|(_, errors)| errors.unit == *unit).collect();
        group(&mut table, unit, &own);
    }
    table.render()
}

fn group(table: &mut Table, unit: &str, rows: &[&(&str, Errors)]) {
    let errors = |value: fn(&Errors) -> f64| {
        column(&rows.iter().map(|(_, errors)| Some(value(errors))).collect::<Vec<_>>(), &[unit])
    };
    let torques: Vec<&(f64, String)> = rows.iter().filter_map(|(_, errors)| errors.torque.as_ref()).collect();
    let torque_units: Vec<&str> = torques.iter().map(|torque| torque.1.as_str()).collect();
    // Without any torque nothing is said of it.
    let peaks = match torques.is_empty() {
        true => vec![String::new(); rows.len()],
        false => {
            let peak = |(_, errors): &&(&str, Errors)| errors.torque.as_ref().map(|torque| torque.0);
            column(&rows.iter().map(peak).collect::<Vec<_>>(), &torque_units)
        }
    };
    let heading = if torques.is_empty() { String::new() } else { headed("peak torque", &torque_units) };
    table.row([
        headed("tracking", &[unit]),
        "maximum error".into(),
        "at [s]".into(),
        "final error".into(),
        heading,
    ]);
    let (maximum, remaining) = (errors(|e| e.maximum), errors(|e| e.remaining));
    for (n, (name, errors)) in rows.iter().enumerate() {
        table.row([*name, &maximum[n], &seconds(errors.at, 3), &remaining[n], &peaks[n]]);
    }
}

/// The same as data.
pub fn json(trackings: &[Tracking], time: &[f64]) -> Value {
    let row = |tracking: &Tracking| {
        let errors = tracking.errors(time)?;
        Some(json!({
            "scope": tracking.scope,
            "name": tracking.name,
            "signal": tracking.actual.path,
            "unit": errors.unit,
            "maximum_error": errors.maximum,
            "maximum_error_at": errors.at,
            "final_error": errors.remaining,
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
    use crate::signals::display::{shown, tests::example};
    use crate::signals::tracking::trackings;
    use expect_test::expect;

    #[test]
    fn errors_are_grouped_by_unit_and_their_points_stand_below_each_other() {
        let (mut recorded, recording) = example(vec![
            ("control/joint1/scope.set", "rad", "deg", vec![0.0, 1.0, 1.0]),
            ("control/joint1/scope.actual", "rad", "deg", vec![0.0, 0.995, 1.0001]),
            ("tool/x.set", "m", "mm", vec![0.0, 0.5, 0.5]),
            ("tool/x.actual", "m", "mm", vec![0.0, 0.499, 0.5002]),
            ("control/joint2/scope.set", "rad", "deg", vec![0.0, 0.5, 0.5]),
            ("control/joint2/scope.actual", "rad", "deg", vec![0.0, 0.4, 0.5]),
            ("arm.signals.Joint1OutBus.Torque", "N*m", "", vec![0.0, -1061.2, 500.0]),
        ]);
        recorded[2..4].iter_mut().for_each(|r| r.title = vec!["Tool centre point, x".to_owned()]);
        let shown = shown(&recorded, &recording);
        let trackings = trackings(&shown);
        expect![[r#"
            tracking [deg]        maximum error  at [s]  final error  peak torque [N*m]
            joint1                        0.286   1.000      0.00011               1061
            joint2                        5.730   1.000      0.11459                  -

            tracking [mm]         maximum error  at [s]  final error
            Tool centre point, x          1.000   1.000      -0.1760
        "#]]
        .assert_eq(&table(&trackings, &recording.time));
        let data = json(&trackings, &recording.time);
        assert_eq!(data[0]["peak_torque"], 1061.2);
        assert_eq!(
            (&data[2]["name"], &data[2]["signal"]),
            (&"joint2".into(), &"control/joint2/scope.actual".into())
        );
    }

    #[test]
    fn plain_numbers_have_no_unit_and_nothing_is_no_table() {
        let (recorded, recording) =
            example(vec![("level.set", "1", "", vec![1.0, 1.0]), ("level.actual", "1", "", vec![0.5, 0.75])]);
        let shown = shown(&recorded, &recording);
        expect![[r#"
            tracking  maximum error  at [s]  final error
            level            0.5000   0.000       0.2525
        "#]]
        .assert_eq(&table(&trackings(&shown), &recording.time));
        assert_eq!(table(&[], &[]), "");
    }
}
