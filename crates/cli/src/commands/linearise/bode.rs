//! Magnitude and phase over frequency as a drawing.

use blocksim_linear::Margins;
use blocksim_numbers::format::fixed;
use blocksim_picture::{Across, Figure, Line, Panel, Style, Theme, svg};

use super::Found;
use super::facts::{decibels, degrees};

/// Width of the drawing, dots.
const WIDTH: f64 = 720.0;

/// Both panels as SVG; each output has a line.
pub fn drawing(found: &Found, theme: Theme) -> String {
    let several = found.ways.len() > 1;
    let seen = || found.ways.iter().zip(&found.question.to).filter(|(way, _)| way.zeros.is_some());
    let ends = seen().flat_map(|(way, _)| way.frequencies.iter().map(|w| w.log10()));
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let lines = |values: fn(&[blocksim_linear::Complex<f64>]) -> Vec<f64>| -> Vec<Line> {
        let line = |(n, (way, to)): (usize, (&super::Way, &super::signals::Place))| Line {
            name: if several { to.name.clone() } else { String::new() },
            colour: n,
            courses: courses(&way.frequencies, &values(&way.response)),
            ..Line::default()
        };
        seen().enumerate().map(line).collect()
    };
    let (mut magnitude, mut phase) = (lines(decibels), lines(degrees));
    let mut notes = Vec::new();
    if let Some(margins) = found.ways.first().and_then(|way| way.margins.as_ref()) {
        magnitude.push(level(0.0, low, high));
        // The border that the phase is measured from, as many turns away as the phase at the crossover is.
        let at_crossover = margins.least_phase().map(|margin| {
            let course = &phase[0].courses;
            let near = |a: &&(f64, f64), b: &&(f64, f64)| {
                let away = |p: &(f64, f64)| (p.0 - margin.frequency.log10()).abs();
                away(a).total_cmp(&away(b))
            };
            course.iter().flatten().min_by(near).map_or(-180.0, |p| p.1 - margin.value.to_degrees())
        });
        let border = at_crossover.map_or(-180.0, |phase| ((phase + 180.0) / 360.0).round() * 360.0 - 180.0);
        phase.push(level(border, low, high));
        magnitude.extend(margins.least_gain().map(|gain| {
            let db = -20.0 * gain.value.log10();
            upright(gain.frequency, db.min(0.0), db.max(0.0))
        }));
        phase.extend(margins.least_phase().map(|margin| {
            let end = border + margin.value.to_degrees();
            upright(margin.frequency, border.min(end), border.max(end))
        }));
        notes.push(said(margins));
    }
    let panel = |title: &str, unit: &str, lines| Panel {
        title: title.to_owned(),
        unit: unit.to_owned(),
        lines,
        ..Panel::default()
    };
    let figure = Figure {
        title: title(found, &notes.join("")),
        panels: vec![panel("magnitude", "dB", magnitude), panel("phase", "deg", phase)],
        columns: 1,
        across: Across::Powers("frequency [rad/s]".to_owned()),
        time: if low < high { (low, high) } else { (0.0, 1.0) },
        width: WIDTH,
    };
    svg(&figure, theme)
}

pub(super) fn title(found: &Found, margins: &str) -> String {
    let question = &found.question;
    match question.is_loop {
        true => format!("Loop through {}{margins}", question.name()),
        false => match &question.to[..] {
            [to] => format!("From {} to {}", question.name(), to.name),
            _ => format!("From {}", question.name()),
        },
    }
}

pub(super) fn said(margins: &Margins) -> String {
    if !margins.stable {
        return ": unstable when closed".to_owned();
    }
    let phase =
        margins.least_phase().map(|margin| format!("phase margin {}°", fixed(margin.value.to_degrees(), 1)));
    let gain = margins
        .least_gain()
        .map(|margin| format!("gain margin {} dB", fixed(20.0 * margin.value.log10(), 1)));
    let said: Vec<String> = phase.into_iter().chain(gain).collect();
    if said.is_empty() { String::new() } else { format!(": {}", said.join(", ")) }
}

/// A line without a colour of its own across the whole panel.
fn level(value: f64, low: f64, high: f64) -> Line {
    Line { style: Style::Limit, courses: vec![vec![(low, value), (high, value)]], ..Line::default() }
}

/// A margin.
fn upright(frequency: f64, from: f64, to: f64) -> Line {
    let x = frequency.log10();
    Line { colour: 1, courses: vec![vec![(x, from), (x, to)]], ..Line::default() }
}

/// Stretches of finite values over exponents of ten.
fn courses(frequencies: &[f64], values: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<(f64, f64)> = frequencies.iter().map(|w| w.log10()).zip(values.iter().copied()).collect();
    points
        .split(|point| !point.1.is_finite())
        .filter(|course| !course.is_empty())
        .map(<[_]>::to_vec)
        .collect()
}
