/// A course without the points that lie on the way between others, up to `error` up or down.
///
/// From a kept point on, the slopes are narrowed by every further point to those of lines that pass it within `error`;
/// the first point outside of them makes the one before it the next that is kept. (The swinging door of recorders,
/// E. H. Bristol, 1990.)
pub(crate) fn straightened(course: impl Iterator<Item = (f64, f64)>, error: f64) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    let mut slopes = (f64::NEG_INFINITY, f64::INFINITY);
    for point in course {
        let (Some(&from), Some(last)) = (kept.last(), before) else {
            if kept.is_empty() {
                kept.push(point);
            } else {
                slopes = narrowed((f64::NEG_INFINITY, f64::INFINITY), kept[0], point, error);
                before = Some(point);
            }
            continue;
        };
        let slope = (point.1 - from.1) / (point.0 - from.0);
        // What does not go to the right has no slope.
        if point.0 > last.0 && slope >= slopes.0 && slope <= slopes.1 {
            slopes = narrowed(slopes, from, point, error);
        } else {
            kept.push(last);
            slopes = narrowed((f64::NEG_INFINITY, f64::INFINITY), last, point, error);
        }
        before = Some(point);
    }
    kept.extend(before);
    kept
}

/// The slopes among `slopes` of lines from one point that pass another within `error`.
fn narrowed(slopes: (f64, f64), from: (f64, f64), to: (f64, f64), error: f64) -> (f64, f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    if dx <= 0.0 {
        // Nothing may be left out around a jump.
        return (f64::INFINITY, f64::NEG_INFINITY);
    }
    (slopes.0.max((dy - error) / dx), slopes.1.min((dy + error) / dx))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_need_two_points() {
        let line = (0..100).map(|k| (f64::from(k), 3.0 + 0.5 * f64::from(k)));
        assert_eq!(straightened(line, 0.01), [(0.0, 3.0), (99.0, 52.5)]);
    }

    #[test]
    fn corners_and_jumps_stay() {
        let course =
            [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 5.0), (2.0, 3.0), (3.0, 3.0), (4.0, 3.0), (5.0, 9.0)];
        let kept = straightened(course.into_iter(), 0.01);
        assert_eq!(kept, [(0.0, 0.0), (2.0, 0.0), (2.0, 5.0), (2.0, 3.0), (4.0, 3.0), (5.0, 9.0)]);
        assert_eq!(straightened([(1.0, 2.0)].into_iter(), 0.1), [(1.0, 2.0)]);
        assert!(straightened(std::iter::empty(), 0.1).is_empty());
    }

    #[test]
    fn no_point_that_is_left_out_lies_farther_off_than_allowed() {
        let course: Vec<(f64, f64)> =
            (0..2000).map(|k| f64::from(k) * 0.2).map(|x| (x, 70.0 + 60.0 * (x / 30.0).sin())).collect();
        let kept = straightened(course.iter().copied(), 0.06);
        assert!(kept.len() < 250, "{}", kept.len());
        for &(x, y) in &course {
            let at = kept.partition_point(|p| p.0 < x).max(1);
            let ((x0, y0), (x1, y1)) = (kept[at - 1], kept[at]);
            let line = y0 + (y1 - y0) * (x - x0) / (x1 - x0);
            assert!((line - y).abs() <= 0.0601, "{x}: {line} {y}");
        }
    }
}
