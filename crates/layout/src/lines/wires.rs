//! Lines of the wires, once all places are known.

use crate::graph::{Point, Segment, Wire};

/// The lines of one net, gathered one after the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lines {
    /// Height, left, right.
    level: Vec<(f64, f64, f64)>,
    /// Place, top, bottom.
    upright: Vec<(f64, f64, f64)>,
}

impl Lines {
    pub fn level(&mut self, y: f64, x1: f64, x2: f64) {
        self.level.push((y, x1.min(x2), x1.max(x2)));
    }

    pub fn upright(&mut self, x: f64, y1: f64, y2: f64) {
        self.upright.push((x, y1.min(y2), y1.max(y2)));
    }

    /// The wire: lines on one another are one, and a dot stands where more than two ways meet.
    pub fn wire(self) -> Wire {
        let (level, upright) = (merged(self.level), merged(self.upright));
        let mut junctions = Vec::new();
        for &(x, top, bottom) in &upright {
            for &(y, left, right) in &level {
                if x < left || x > right || y < top || y > bottom {
                    continue;
                }
                let ways = [x > left, x < right, y > top, y < bottom];
                if ways.iter().filter(|way| **way).count() > 2 {
                    junctions.push(Point { x, y });
                }
            }
        }
        junctions.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).unwrap_or(std::cmp::Ordering::Equal));
        let across = level
            .into_iter()
            .map(|(y, left, right)| Segment { from: Point { x: left, y }, to: Point { x: right, y } });
        let down = upright
            .into_iter()
            .map(|(x, top, bottom)| Segment { from: Point { x, y: top }, to: Point { x, y: bottom } });
        Wire { segments: across.chain(down).collect(), junctions }
    }
}

/// Lines that touch on one axis become one; those without length are left out.
fn merged(mut lines: Vec<(f64, f64, f64)>) -> Vec<(f64, f64, f64)> {
    lines.retain(|(_, from, to)| to > from);
    lines.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut out: Vec<(f64, f64, f64)> = Vec::new();
    for line in lines {
        match out.last_mut() {
            Some(last) if last.0 == line.0 && line.1 <= last.2 => last.2 = last.2.max(line.2),
            _ => out.push(line),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_on_one_another_are_one_and_branches_have_dots() {
        let mut lines = Lines::default();
        lines.level(10.0, 0.0, 20.0);
        lines.level(10.0, 50.0, 15.0);
        lines.upright(20.0, 40.0, 10.0);
        lines.level(40.0, 20.0, 60.0);
        lines.level(40.0, 70.0, 70.0);
        let wire = lines.wire();
        assert_eq!(wire.segments.len(), 3, "{wire:?}");
        assert_eq!(wire.junctions, [Point { x: 20.0, y: 10.0 }]);
    }
}
