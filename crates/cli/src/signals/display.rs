//! Recorded signals in the units in which people want to see them.

use blocksim_block::schedule::Recorded;
use blocksim_recording::{Kind, Layout, Rate, Recording, Signal, SignalInfo};
use blocksim_signal::{Dimension, Unit};

/// A recorded signal and the unit to show it in.
#[derive(Debug, Clone)]
pub struct Shown<'a> {
    /// Its path: `control/joint1/scope.set`.
    pub path: &'a str,
    /// Unit to show it in.
    pub unit: Unit,
    /// What is measured, if anything says it.
    pub dimension: Option<Dimension>,
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Cell of the value among the signals: two names of one signal have the same.
    pub cell: usize,
    /// Labels of its scope and of the subsystems around it, the outermost first; empty without.
    pub title: &'a [String],
    /// What the diagram calls it in legends, if it does.
    pub legend: Option<&'a str>,
    /// Path of the signal over which its scope draws it, if that is not time.
    pub over: Option<&'a str>,
    /// The values in SI.
    pub si: &'a [f64],
}

impl Shown<'_> {
    /// The values in the unit to show them in.
    pub fn values(&self) -> Vec<f64> {
        self.si.iter().map(|&value| self.unit.from_si(value)).collect()
    }

    /// Path of the block, without port and element.
    pub fn block(&self) -> &str {
        self.path.split_once('.').map_or(self.path, |(block, _)| block)
    }

    /// Port and element, without the block.
    pub fn port(&self) -> &str {
        self.path.split_once('.').map_or("", |(_, port)| port)
    }
}

/// An empty recording of what a schedule wants recorded, in SI units.
pub fn recording(recorded: &[Recorded]) -> Recording {
    let signal = |r: &Recorded| Signal::new(&r.path, si_unit(r), kind(r));
    Recording::new(recorded.iter().map(signal).collect())
}

/// The layout of a recording on disk: all signals with all rows, with the units to show them in.
pub fn layout(recorded: &[Recorded]) -> Layout {
    let info = |r: &Recorded| SignalInfo {
        path: r.path.clone(),
        unit: si_unit(r),
        display: Some(display_unit(r).to_string()),
        title: r.title.clone(),
        legend: r.legend.clone(),
        over: r.over.clone(),
        kind: kind(r),
        held: r.held,
        base: 0,
    };
    Layout { rates: vec![Rate::All], signals: recorded.iter().map(info).collect() }
}

fn si_unit(recorded: &Recorded) -> String {
    recorded.dimension.map_or_else(|| "1".to_owned(), |dimension| dimension.to_string())
}

/// Pairs what a schedule wanted recorded with what was recorded, in the same order.
pub fn shown<'a>(recorded: &'a [Recorded], recording: &'a Recording) -> Vec<Shown<'a>> {
    let pair = |(r, signal): (&'a Recorded, &'a Signal)| Shown {
        path: &r.path,
        unit: display_unit(r),
        dimension: r.dimension,
        kind: kind(r),
        cell: r.cell,
        title: &r.title,
        legend: r.legend.as_deref(),
        over: r.over.as_deref(),
        si: &signal.values,
    };
    recorded.iter().zip(&recording.signals).map(pair).collect()
}

/// The unit that the diagram says; else degrees for angles and SI for all else.
pub fn display_unit(recorded: &Recorded) -> Unit {
    let fits = |unit: &Unit| recorded.dimension.is_none_or(|dimension| dimension.compatible(unit.dimension));
    let asked = recorded.display.as_deref().and_then(|text| Unit::parse(text).ok()).filter(fits);
    let degrees = || Unit::parse("deg").ok().filter(|unit| recorded.dimension == Some(unit.dimension));
    asked.or_else(degrees).unwrap_or_else(|| Unit::si(recorded.dimension.unwrap_or(Dimension::NONE)))
}

/// A whole turn in a unit; `None` if it is not a unit of angles.
pub fn turn(unit: &Unit) -> Option<f64> {
    let is_angle = Unit::parse("rad").is_ok_and(|rad| rad.dimension == unit.dimension);
    is_angle.then(|| unit.from_si(std::f64::consts::TAU))
}

fn kind(recorded: &Recorded) -> Kind {
    match recorded.kind {
        blocksim_signal::Kind::Bool => Kind::Bool,
        blocksim_signal::Kind::Int => Kind::Int,
        _ => Kind::Real,
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use blocksim_block::schedule::Keep;

    /// A column of a recording: path, unit and display unit (both may be empty), values in SI.
    pub type Column<'a> = (&'a str, &'a str, &'a str, Vec<f64>);

    /// A recording of these columns at 0, 1, 2 ... s.
    pub fn example(columns: Vec<Column>) -> (Vec<Recorded>, Recording) {
        let recorded: Vec<Recorded> = columns
            .iter()
            .enumerate()
            .map(|(cell, (path, unit, display, _))| Recorded {
                path: (*path).to_owned(),
                cell,
                kind: blocksim_signal::Kind::Real,
                dimension: Unit::parse(unit).ok().map(|unit| unit.dimension),
                display: (!display.is_empty()).then(|| (*display).to_owned()),
                title: Vec::new(),
                legend: None,
                over: None,
                keep: Keep::All,
                held: false,
            })
            .collect();
        let mut recording = recording(&recorded);
        let rows = columns.first().map_or(0, |column| column.3.len());
        for row in 0..rows {
            let values: Vec<f64> = columns.iter().map(|column| column.3[row]).collect();
            recording.push_row(row as f64, &values).unwrap();
        }
        (recorded, recording)
    }

    #[test]
    fn the_diagram_chooses_the_unit_and_angles_are_in_degrees_otherwise() {
        let pi = std::f64::consts::PI;
        let (recorded, recording) = example(vec![
            ("a/scope.set", "rad", "deg", vec![pi]),
            ("bus.Angle", "rad", "", vec![pi]),
            ("w.y", "rad/s", "", vec![2.0]),
            ("w.rpm", "rad/s", "rpm", vec![pi]),
            ("wrong.y", "m", "deg", vec![3.0]),
            ("unknown.y", "", "", vec![4.0]),
        ]);
        let shown = shown(&recorded, &recording);
        let all: Vec<(String, f64)> = shown.iter().map(|s| (s.unit.to_string(), s.values()[0])).collect();
        let expected =
            [("deg", 180.0), ("deg", 180.0), ("rad/s", 2.0), ("rpm", 30.0), ("m", 3.0), ("1", 4.0)];
        for ((unit, value), (expected_unit, expected_value)) in all.iter().zip(expected) {
            assert_eq!(unit, expected_unit);
            assert!((value - expected_value).abs() < 1e-12, "{value} {unit}");
        }
        assert_eq!((shown[0].block(), shown[0].port()), ("a/scope", "set"));
        assert_eq!(recording.signals[0].unit, "rad", "files are in SI");
    }
}
