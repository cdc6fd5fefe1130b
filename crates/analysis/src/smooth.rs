//! Values between rows: a signal that is smooth around them goes along a cubic, all else straight.
//!
//! Rows of a run are dense enough for the eye, not for a time that is to be known to a millisecond. Where the second
//! differences at both ends of a stretch agree, the cubic through the four rows around it is nearer to the signal than the
//! chord, by two orders. At corners, jumps (two rows of one time) and in noise they do not agree, and nothing is added.

/// Parts of a stretch along a cubic.
const PARTS: usize = 8;
/// Second differences agree whose ratio is not above this.
const ALIKE: f64 = 3.0;
/// A curve that is no farther from its chord than this share of the size of the signal is straight.
const STRAIGHT: f64 = 1e-12;

/// The rows of signals of one time with more between them. Times do not decrease, and all is finite.
pub(crate) fn refine<const N: usize>(rows: &[(f64, [f64; N])]) -> Vec<(f64, [f64; N])> {
    let size: [f64; N] =
        std::array::from_fn(|n| rows.iter().fold(0.0, |size: f64, row| size.max(row.1[n].abs())));
    let mut refined = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        refined.push(*row);
        let Some(next) = rows.get(i + 1).filter(|next| next.0 > row.0) else { continue };
        let bends: [Bend; N] = std::array::from_fn(|n| Bend::of(rows, i, n));
        let h = next.0 - row.0;
        let curved = |n: usize| bends[n].most() * h * h > 4.0 * STRAIGHT * size[n];
        if !(0..N).any(curved) {
            continue;
        }
        for part in 1..PARTS {
            let share = part as f64 / PARTS as f64;
            let value = |n: usize| {
                let (a, b) = (row.1[n], next.1[n]);
                a + share * (b - a) + bends[n].off_chord(share, h)
            };
            refined.push((row.0 + share * h, std::array::from_fn(value)));
        }
    }
    refined
}

/// A signal with more rows where it is smooth, eight in place of one, along a cubic; as it is where a value is not finite.
/// Times do not decrease.
///
/// ```
/// let time = [0.0, 1.0, 2.0, 3.0];
/// let (times, values) = blocksim_analysis::refined(&time, &time.map(|t: f64| t * t));
/// assert_eq!((times[12], values[12]), (1.5, 2.25));
/// ```
pub fn refined(time: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let rows: Vec<(f64, [f64; 1])> = time.iter().zip(values).map(|(&t, &x)| (t, [x])).collect();
    if rows.iter().any(|(t, [x])| !t.is_finite() || !x.is_finite()) {
        return rows.into_iter().map(|(t, [x])| (t, x)).unzip();
    }
    refine(&rows).into_iter().map(|(t, [x])| (t, x)).unzip()
}

/// The second divided difference of a stretch, at its start and at its end.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bend([f64; 2]);

impl Bend {
    /// That of signal `n` between row `i` and the next.
    fn of<const N: usize>(rows: &[(f64, [f64; N])], i: usize, n: usize) -> Self {
        Self::between(rows.len(), |k| (rows[k].0, rows[k].1[n]), i)
    }

    /// That between row `i` and the next, of `count` rows of time and value. Times do not decrease.
    pub fn between(count: usize, row: impl Fn(usize) -> (f64, f64), i: usize) -> Self {
        // Around row `k`; none beside a jump.
        let around = |k: usize| -> Option<f64> {
            let [a, b, c] = [k.checked_sub(1)?, k, k + 1];
            let [a, b, c] = if c < count { [row(a), row(b), row(c)] } else { return None };
            let smooth = a.0 < b.0 && b.0 < c.0;
            let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
            smooth.then(|| (slope(b, c) - slope(a, b)) / (c.0 - a.0))
        };
        let t = |k: usize| row(k).0;
        let line = |near: f64, far: f64, step: f64, way: [f64; 2]| {
            // Along the cubic the second difference changes straight; `step` is what both are apart.
            let slope = (far - near) / step;
            Self(way.map(|way| near + slope * way))
        };
        match (around(i), around(i + 1)) {
            (Some(left), Some(right)) if alike(left, right) => {
                line(left, right, t(i + 2) - t(i - 1), [t(i) - t(i - 1), t(i + 1) - t(i - 1)])
            }
            (None, Some(right)) => match around(i + 2) {
                Some(next) if alike(right, next) => {
                    line(right, next, t(i + 3) - t(i), [t(i) - t(i + 2), t(i + 1) - t(i + 2)])
                }
                _ => Self::default(),
            },
            (Some(left), None) => match i.checked_sub(1).and_then(around) {
                Some(last) if alike(left, last) => {
                    line(left, last, t(i - 2) - t(i + 1), [t(i) - t(i - 1), t(i + 1) - t(i - 1)])
                }
                _ => Self::default(),
            },
            _ => Self::default(),
        }
    }

    /// How far the signal is from its chord at a share of the stretch, whose length is `h`.
    pub fn off_chord(self, share: f64, h: f64) -> f64 {
        let off = share * (1.0 - share) * h * h * self.at(share);
        // Values near the limit of numbers go straight.
        if off.is_finite() { -off } else { 0.0 }
    }

    /// Shares of a stretch of length `h` at which a signal that rises by `rise` along it is at rest.
    pub fn at_rest(self, rise: f64, h: f64) -> impl Iterator<Item = f64> {
        // rise - h^2 ((1 - 2 s) (p + q s) + (s - s^2) q) = 0 with the bend p + q s.
        let (p, q) = (self.0[0], self.0[1] - self.0[0]);
        let (a, b, c) = (3.0 * q, 2.0 * (p - q), rise / (h * h) - p);
        let root = (b * b - 4.0 * a * c).sqrt();
        // Without loss of digits where `a` is small; what does not exist is NaN and lies nowhere.
        let sum = -0.5 * (b + root.copysign(b));
        [sum / a, c / sum].into_iter().filter(|share| *share > 0.0 && *share < 1.0)
    }

    fn most(self) -> f64 {
        self.0[0].abs().max(self.0[1].abs())
    }

    fn at(self, share: f64) -> f64 {
        self.0[0] + share * (self.0[1] - self.0[0])
    }
}

fn alike(a: f64, b: f64) -> bool {
    a * b > 0.0 && a.abs() <= ALIKE * b.abs() && b.abs() <= ALIKE * a.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let rows: Vec<(f64, [f64; 1])> = rows.iter().map(|&(t, y)| (t, [y])).collect();
        refine(&rows).into_iter().map(|(t, [y])| (t, y)).collect()
    }

    #[test]
    fn a_cubic_is_met_between_rows_at_any_distances() {
        let cubic = |t: f64| 1.0 + t * (2.0 + t * (3.0 + t));
        let rows: Vec<(f64, f64)> = [0.0, 0.3, 0.5, 1.0, 1.2].map(|t| (t, cubic(t))).to_vec();
        let refined = of(&rows);
        assert_eq!(refined.len(), 4 * PARTS + 1);
        for (t, y) in refined {
            assert!((y - cubic(t)).abs() < 1e-13, "{t}: {y}");
        }
    }

    #[test]
    fn a_stretch_is_at_rest_where_its_cubic_is() {
        // t^3 - t on rows around its minimum at 1 / sqrt(3), and around both of its extremes.
        let cubic = |t: f64| t * t * t - t;
        for (times, rest) in [
            ([0.0, 0.3, 0.9, 1.1], vec![1.0 / 3.0_f64.sqrt()]),
            ([0.2, 0.4, 0.5, 0.6], vec![]),
            ([0.1, 0.3, 0.5, 1.0], vec![]),
        ] {
            let bend = Bend::between(4, |k| (times[k], cubic(times[k])), 1);
            let h = times[2] - times[1];
            let found: Vec<f64> = bend
                .at_rest(cubic(times[2]) - cubic(times[1]), h)
                .map(|share| times[1] + share * h)
                .collect();
            assert_eq!(found.len(), rest.len(), "{times:?}: {found:?}");
            assert!(found.iter().zip(&rest).all(|(a, b)| (a - b).abs() < 1e-12), "{times:?}: {found:?}");
        }
        // A parabola has no bend that changes.
        let bend = Bend::between(4, |k| (k as f64, (k as f64 - 1.25).powi(2)), 1);
        assert_eq!(bend.at_rest(0.75_f64.powi(2) - 0.25_f64.powi(2), 1.0).collect::<Vec<_>>(), [0.25]);
    }

    #[test]
    fn numbers_at_their_limit_stay_finite() {
        for value in [1e308, -1e308] {
            let rows = [(0.0, -value), (1e-9, value), (2e-9, -value), (3e-9, value), (4e-9, value / 3.0)];
            assert!(of(&rows).iter().all(|(_, y)| y.is_finite()));
        }
        let rows: Vec<(f64, f64)> =
            (0..9).map(|k| (f64::from(k) * 1e-160, f64::from(k * k) * 1e150)).collect();
        assert!(of(&rows).iter().all(|(_, y)| y.is_finite()));
    }

    #[test]
    fn corners_jumps_and_triangles_stay_straight() {
        for rows in [
            vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)],
            vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 2.0), (4.0, 3.0)],
            vec![(0.0, 0.0), (1.0, 0.0), (1.0, 5.0), (2.0, 5.0)],
            vec![(0.0, 1.0), (1.0, -1.0), (2.0, 1.0), (3.0, -1.0)],
        ] {
            assert_eq!(of(&rows), rows);
        }
    }

    #[test]
    fn a_jump_takes_no_part_in_the_curves_beside_it() {
        let rows: Vec<(f64, f64)> = (0..=8)
            .map(|k| (f64::from(k), f64::from(k).powi(2)))
            .chain((8..=16).map(|k| (f64::from(k), 100.0 - f64::from(k).powi(2))))
            .collect();
        for (k, (t, y)) in of(&rows).into_iter().enumerate() {
            let expected = if k <= 8 * PARTS { t * t } else { 100.0 - t * t };
            assert!((y - expected).abs() < 1e-11, "{t}: {y}");
        }
    }
}
