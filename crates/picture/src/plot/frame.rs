//! One pair of axes: from times and values to dots.

use blocksim_numbers::ticks::{Range, labels};

use super::figure::Line;

/// Room around the values, share of the height.
const ROOM: f64 = 0.04;

/// Parts of a turn, degrees.
const TURNS: [f64; 6] = [15.0, 30.0, 45.0, 90.0, 180.0, 360.0];

/// A range with some room around it.
pub(crate) fn roomy(range: &Range) -> Range {
    let room = ROOM * (range.high / 2.0 - range.low / 2.0) * 2.0;
    let (low, high) = (range.low - room, range.high + room);
    if low.is_finite() && high.is_finite() && low < high { Range { low, high } } else { *range }
}

/// The vertical axis of a panel or strip.
pub(crate) struct Axis {
    pub range: Range,
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis over a range with at most `parts` parts.
    pub fn over(range: Range, parts: usize) -> Axis {
        let step = range.step(parts);
        let ticks = range.ticks(step);
        let labels = labels(&ticks, step);
        Axis { range, ticks: ticks.into_iter().zip(labels).collect() }
    }

    /// An axis over the values of these lines with at most `parts` parts; `None` where there is nothing to draw. Its
    /// numbers are round ones, or parts of a `turn`.
    pub fn of(lines: &[Line], time: (f64, f64), parts: usize, turn: bool) -> Option<Axis> {
        // Points beyond the range are there for the line to reach it; they must not stretch the axis by much.
        let inside = |t: f64| t >= time.0 && t <= time.1;
        let values = |line: &Line| -> Vec<f64> {
            line.courses.iter().flatten().filter(|p| inside(p.0)).map(|p| p.1).collect()
        };
        let values: Vec<f64> = lines.iter().flat_map(values).collect();
        let beyond = lines.iter().flat_map(|line| line.courses.iter().flatten().map(|p| p.1));
        let range = Range::of(values.into_iter()).or_else(|| Range::of(beyond))?;
        let range = roomy(&range);
        // One number alone gives no scale.
        let mut steps = (parts..parts + 4).map(|parts| range.step(parts));
        let step = steps.find(|step| range.ticks(*step).len() > 1).unwrap_or(range.step(parts));
        let round = TURNS.into_iter().find(|turn| range.high - range.low <= (parts + 1) as f64 * turn);
        let step = round.filter(|_| turn && range.high - range.low > TURNS[0]).unwrap_or(step);
        let ticks = range.ticks(step);
        let labels = labels(&ticks, step);
        Some(Axis { range, ticks: ticks.into_iter().zip(labels).collect() })
    }
}

/// A rectangle of the drawing, dots from the top left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// Dots across for a time.
    pub fn across(&self, time: &Range, t: f64) -> f64 {
        self.x + time.share(t) * self.width
    }

    /// Dots down for a value.
    pub fn down(&self, values: &Range, value: f64) -> f64 {
        self.bottom() - values.share(value) * self.height
    }
}
