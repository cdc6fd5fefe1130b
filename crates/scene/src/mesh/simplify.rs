//! Fewer triangles for a surface that looks the same.
//!
//! Corners that lie in one cell of a grid become one, put where it is nearest to the planes of the triangles around
//! (P. Lindstrom, Out-of-core simplification of large polygonal models, 2000), so that edges stay sharp. The time
//! is proportional to the number of triangles, whatever they look like.

use std::collections::{HashMap, HashSet};

use nalgebra::{Matrix3, Vector3};

use super::surface::Surface;

/// Cells along the longest side, at most: finer ones are not seen.
const FINEST: u32 = 1024;

/// The surface with at most `most` triangles, in cells as small as that allows. One that has no more is returned as it is.
pub fn simplified(surface: &Surface, most: usize) -> Surface {
    if surface.triangles.len() <= most {
        return surface.clone();
    }
    // The number of triangles grows with that of the cells; the finest grid that is coarse enough, by bisection.
    let (mut coarse, mut fine) = (1, FINEST);
    while fine - coarse > 1 + coarse / 16 {
        let middle = (coarse + fine) / 2;
        match merged(surface, &cells(surface, middle)).len() <= most {
            true => coarse = middle,
            false => fine = middle,
        }
    }
    let cells = cells(surface, coarse);
    let mut triangles = merged(surface, &cells);
    // One cell alone may still be too fine for very few triangles.
    triangles.truncate(most);
    placed(surface, &cells, &triangles)
}

/// The cell of each corner, numbered in the order of the corners, with `n` cells along the longest side.
fn cells(surface: &Surface, n: u32) -> Vec<u32> {
    let [low, high] = surface.bounds();
    // A little more than that, so that no cells meet in the middle, where many parts have a plane of corners.
    let longest = 1.003 * (0..3).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let number = |corner: &[f64; 3]| {
        let cell = [0, 1, 2].map(|k| (((corner[k] - low[k]) / longest * f64::from(n)) as u32).min(n - 1));
        let next = u32::try_from(known.len()).unwrap_or(u32::MAX);
        *known.entry(cell).or_insert(next)
    };
    surface.corners.iter().map(number).collect()
}

/// Triangles between cells, each once.
fn merged(surface: &Surface, cells: &[u32]) -> Vec<[u32; 3]> {
    let mut seen = HashSet::new();
    let mut kept = Surface::default();
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|corner| cells[corner as usize]);
        // Turned so that the least one stands first: the same triangle is the same three numbers.
        let turned = match a.min(b).min(c) {
            least if least == a => [a, b, c],
            least if least == b => [b, c, a],
            _ => [c, a, b],
        };
        if seen.insert(turned) {
            kept.add(turned);
        }
    }
    kept.triangles
}

/// Sum over planes of the squared distance, weighed by area: `x'Ax - 2b'x`.
#[derive(Clone)]
struct Planes {
    a: Matrix3<f64>,
    b: Vector3<f64>,
    sum: Vector3<f64>,
    corners: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

/// Puts each cell's corner where it is nearest to the planes of its triangles.
fn placed(surface: &Surface, cells: &[u32], triangles: &[[u32; 3]]) -> Surface {
    let count = cells.iter().max().map_or(0, |last| *last as usize + 1);
    let none = Planes {
        a: Matrix3::zeros(),
        b: Vector3::zeros(),
        sum: Vector3::zeros(),
        corners: 0.0,
        low: Vector3::repeat(f64::INFINITY),
        high: Vector3::repeat(f64::NEG_INFINITY),
    };
    let mut planes = vec![none; count];
    for (corner, cell) in surface.corners.iter().zip(cells) {
        let (planes, corner) = (&mut planes[*cell as usize], Vector3::from(*corner));
        planes.sum += corner;
        planes.corners += 1.0;
        planes.low = planes.low.inf(&corner);
        planes.high = planes.high.sup(&corner);
    }
    for triangle in &surface.triangles {
        let [p, q, r] = triangle.map(|corner| Vector3::from(surface.corners[corner as usize]));
        let normal = (q - p).cross(&(r - p));
        for corner in triangle {
            let planes = &mut planes[cells[*corner as usize] as usize];
            planes.a += normal * normal.transpose();
            planes.b += normal * normal.dot(&p);
        }
    }
    // Only cells that a triangle has are kept.
    let mut place: Vec<Option<u32>> = vec![None; count];
    let mut out = Surface::default();
    for triangle in triangles {
        let indices = triangle.map(|cell| {
            *place[cell as usize].get_or_insert_with(|| {
                out.corners.push(best(&planes[cell as usize]).into());
                u32::try_from(out.corners.len() - 1).unwrap_or(u32::MAX)
            })
        });
        out.triangles.push(indices);
    }
    out
}

/// The best point of a cell, within the corners that it stands for; along what the planes leave open, their middle.
fn best(planes: &Planes) -> Vector3<f64> {
    let middle = planes.sum / planes.corners.max(1.0);
    let eigen = planes.a.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let gap = planes.b - planes.a * middle;
    let mut point = middle;
    for (value, axis) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > 1e-3 * largest && largest > 0.0 {
            point += axis * (axis.dot(&gap) / value);
        }
    }
    let point = point.sup(&planes.low).inf(&planes.high);
    if point.iter().all(|x| x.is_finite()) { point } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Triangle;

    /// A box of 1 x 1 x 1 whose faces are divided into n x n squares.
    fn divided_box(n: u32) -> Surface {
        let mut triangles: Vec<Triangle> = Vec::new();
        for axis in 0..3 {
            for side in [0.0, 1.0] {
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let at = |di: u32, dj: u32| {
                        let mut point = [side; 3];
                        point[(axis + 1) % 3] = f64::from(i + di) / f64::from(n);
                        point[(axis + 2) % 3] = f64::from(j + dj) / f64::from(n);
                        point
                    };
                    let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                    triangles.extend(if side > 0.5 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, c, b], [a, d, c]]
                    });
                }
            }
        }
        Surface::welded(&triangles, [1.0; 3])
    }

    fn volume(surface: &Surface) -> f64 {
        let corner = |i: u32| Vector3::from(surface.corners[i as usize]);
        surface.triangles.iter().map(|t| corner(t[0]).dot(&corner(t[1]).cross(&corner(t[2]))) / 6.0).sum()
    }

    #[test]
    fn a_finely_divided_box_stays_a_box_with_sharp_edges() {
        let fine = divided_box(60);
        assert_eq!(fine.triangles.len(), 43200);
        let few = simplified(&fine, 2000);
        assert!(few.triangles.len() <= 2000 && few.triangles.len() > 1000, "{}", few.triangles.len());
        assert!((volume(&few) - 1.0).abs() < 1e-9, "{}", volume(&few));
        for corner in &few.corners {
            let off = corner.iter().map(|x| x.abs().min((x - 1.0).abs())).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-9, "every corner lies on a face: {corner:?}");
        }
    }

    #[test]
    fn a_ball_keeps_its_volume_within_the_size_of_a_cell() {
        let mut ball = divided_box(60);
        for corner in &mut ball.corners {
            let out = Vector3::from(*corner) - Vector3::repeat(0.5);
            *corner = out.normalize().into();
        }
        let few = simplified(&ball, 1500);
        let whole = 4.0 / 3.0 * std::f64::consts::PI;
        assert!(few.triangles.len() <= 1500);
        assert!((volume(&few) / whole - 1.0).abs() < 0.02, "{}", volume(&few) / whole);
    }

    #[test]
    fn few_triangles_stay_as_they_are_and_bounds_hold_for_any_surface() {
        let plain = divided_box(2);
        assert_eq!(simplified(&plain, 48), plain);
        assert!(simplified(&plain, 3).triangles.len() <= 3);
        let flat = Surface::welded(&[[[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e-300, 0.0]]; 9], [1.0; 3]);
        assert!(simplified(&flat, 1).triangles.len() <= 1);
    }
}
