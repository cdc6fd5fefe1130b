//! Which joint is left between two bodies by the constraints of a CAD program.
//!
//! Each constraint forbids some relative motions. A motion of the follower against the base is (ω, v) with the
//! velocity v at a point p₀; that a point p does not move along n is `n·v + ((p - p₀) × n)·ω = 0`, that nothing turns
//! about m is `m·ω = 0`. What no row forbids is the joint: the well-known table of pairs of constraints follows.

use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3, Vector6};

/// Forbidden motions: no turn about `turn`, and no motion of `point` along `along`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Row {
    /// `m·ω = 0`
    Turn(Vector3<f64>),
    /// `n·v(p) = 0`
    Slide { point: Vector3<f64>, along: Vector3<f64> },
}

/// What is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Left {
    /// Nothing.
    Weld,
    /// A turn about an axis through a point.
    Revolute { point: Vector3<f64>, axis: Vector3<f64> },
    /// A translation.
    Prismatic { axis: Vector3<f64> },
    /// A turn about an axis and a translation along it.
    Cylindrical { point: Vector3<f64>, axis: Vector3<f64> },
    /// Translations across an axis and a turn about it.
    Planar { axis: Vector3<f64> },
    /// Any turn about a point.
    Spherical { point: Vector3<f64> },
    /// So many freedoms that no joint has.
    Other(usize),
}

/// Directions whose singular value is below this are free: CAD programs write nine digits or more.
const FREE: f64 = 1e-5;

/// The joint that the rows leave.
pub(super) fn left(rows: &[Row]) -> Left {
    let points: Vec<Vector3<f64>> = rows
        .iter()
        .filter_map(|row| match row {
            Row::Slide { point, .. } => Some(*point),
            Row::Turn(_) => None,
        })
        .collect();
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    // Lengths are counted in the size of the contact, so that turns and translations weigh alike.
    let size = points.iter().map(|point| (point - middle).norm()).fold(1e-3, f64::max);
    let mut sum = Matrix6::zeros();
    for row in rows {
        let row = match row {
            Row::Turn(about) => Vector6::new(about.x, about.y, about.z, 0.0, 0.0, 0.0),
            Row::Slide { point, along } => {
                let lever = ((point - middle) / size).cross(along);
                Vector6::new(lever.x, lever.y, lever.z, along.x, along.y, along.z)
            }
        };
        sum += row * row.transpose();
    }
    let eigen = sum.symmetric_eigen();
    let free: Vec<Vector6<f64>> = (0..6)
        .filter(|k| eigen.eigenvalues[*k] < FREE * FREE)
        .map(|k| eigen.eigenvectors.column(k).into_owned())
        .collect();
    let turn = |m: &Vector6<f64>| Vector3::new(m[0], m[1], m[2]);
    let slide = |m: &Vector6<f64>| Vector3::new(m[3], m[4], m[5]) * size;
    // Turns that are possible: principal directions of the ω parts.
    let turns: Matrix3<f64> = free.iter().map(|m| turn(m) * turn(m).transpose()).sum();
    let turns = turns.symmetric_eigen();
    let possible = turns.eigenvalues.iter().filter(|x| **x > 1e-8).count();
    let other = Left::Other(free.len());
    match (free.len(), possible) {
        (0, _) => Left::Weld,
        (1, 0) => Left::Prismatic { axis: slide(&free[0]).normalize() },
        (1, 1) => {
            let length = turn(&free[0]).norm();
            let (axis, v) = (turn(&free[0]) / length, slide(&free[0]) / length);
            match axis.dot(&v).abs() < 1e-4 * size {
                true => Left::Revolute { point: middle + axis.cross(&v), axis },
                false => other,
            }
        }
        (2 | 3, 1) => {
            let axis = turns.eigenvectors.column(turns.eigenvalues.imax()).into_owned();
            let (about, along) = split(&free, &axis, turn, slide);
            let off = |across: bool| {
                along
                    .iter()
                    .all(|t| if across { t.dot(&axis).abs() < 1e-4 } else { t.cross(&axis).norm() < 1e-4 })
            };
            match free.len() {
                2 if off(false) => Left::Cylindrical { point: middle + axis.cross(&about), axis },
                3 if off(true) => Left::Planar { axis },
                _ => other,
            }
        }
        (3, 3) => centre(&free, turn, slide).map_or(other, |c| Left::Spherical { point: middle + c }),
        _ => other,
    }
}

/// The velocity of the middle for a turn of 1 about the axis, and directions of pure translations.
fn split(
    free: &[Vector6<f64>],
    axis: &Vector3<f64>,
    turn: impl Fn(&Vector6<f64>) -> Vector3<f64>,
    slide: impl Fn(&Vector6<f64>) -> Vector3<f64>,
) -> (Vector3<f64>, Vec<Vector3<f64>>) {
    let rates: Vec<f64> = free.iter().map(|m| turn(m).dot(axis)).collect();
    let squared: f64 = rates.iter().map(|rate| rate * rate).sum();
    let about = free.iter().zip(&rates).map(|(m, rate)| slide(m) * (rate / squared)).sum();
    // Differences that leave no turn; the one of the largest rate serves as the base.
    let most = (0..free.len()).max_by(|a, b| rates[*a].abs().total_cmp(&rates[*b].abs())).unwrap_or(0);
    let pure = (0..free.len()).filter(|k| *k != most);
    let along = pure.map(|k| (slide(&free[k]) - slide(&free[most]) * (rates[k] / rates[most])).normalize());
    (about, along.collect())
}

/// The point c that no motion moves: `v = c × ω` with c counted from the middle.
fn centre(
    free: &[Vector6<f64>],
    turn: impl Fn(&Vector6<f64>) -> Vector3<f64>,
    slide: impl Fn(&Vector6<f64>) -> Vector3<f64>,
) -> Option<Vector3<f64>> {
    // v + ω × c = 0
    let a = DMatrix::from_fn(3 * free.len(), 3, |i, j| turn(&free[i / 3]).cross_matrix()[(i % 3, j)]);
    let b = DMatrix::from_fn(3 * free.len(), 1, |i, _| -slide(&free[i / 3])[i % 3]);
    let c = a.clone().svd(true, true).solve(&b, 1e-9).ok()?;
    let residual = (&a * &c - &b).norm();
    (residual < 1e-6).then(|| Vector3::new(c[0], c[1], c[2]))
}
