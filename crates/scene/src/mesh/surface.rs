//! Triangles that share their corners.

use std::collections::HashMap;

use super::stl::Triangle;

/// A surface in metres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Points, each once, m.
    pub corners: Vec<[f64; 3]>,
    /// Triangles by the indices of their corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Corners that are nearer to each other, as a share of the longest side, are one.
const NEAR: f64 = 1e-6;

/// The longest side, m; above zero.
fn longest(triangles: &[Triangle], scale: [f64; 3]) -> f64 {
    let side = |k: usize| {
        let ends =
            triangles.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], corner| {
                [low.min(corner[k]), high.max(corner[k])]
            });
        (ends[1] * scale[k] - ends[0] * scale[k]).abs()
    };
    (0..3).map(side).fold(f64::MIN_POSITIVE, f64::max)
}

impl Surface {
    /// Welds corners that are the same but for the last digits of what wrote them, a millionth of the longest side; triangles
    /// without area go. A scale that mirrors turns the triangles, so that their outside stays outside.
    pub fn welded(triangles: &[Triangle], scale: [f64; 3]) -> Surface {
        let mut surface = Surface::default();
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        let near = NEAR * longest(triangles, scale);
        let mirrored = scale.iter().product::<f64>() < 0.0;
        for triangle in triangles {
            let mut indices = triangle.map(|corner| {
                let point = [0, 1, 2].map(|k| corner[k] * scale[k] + 0.0);
                *known.entry(point.map(|x| (x / near).round() as i64)).or_insert_with(|| {
                    surface.corners.push(point);
                    // A file of 4 GiB, which nobody reads, has fewer corners than that.
                    u32::try_from(surface.corners.len() - 1).unwrap_or(u32::MAX)
                })
            });
            if mirrored {
                indices.swap(1, 2);
            }
            surface.add(indices);
        }
        surface
    }

    /// Adds a triangle unless two of its corners are one.
    pub(super) fn add(&mut self, [a, b, c]: [u32; 3]) {
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
        }
    }

    /// Least and largest coordinates, m.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for corner in &self.corners {
            for k in 0..3 {
                bounds[0][k] = bounds[0][k].min(corner[k]);
                bounds[1][k] = bounds[1][k].max(corner[k]);
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::stl::tests::cuboid;

    #[test]
    fn corners_that_differ_by_rounding_alone_are_one() {
        let mut triangles = cuboid([0.0, -1.0, -1.0], [1.0, 2.0, 3.0]);
        for (n, x) in triangles.iter_mut().flatten().flatten().enumerate() {
            *x += 1e-12 * (n as f64 * 0.7).sin();
        }
        let surface = Surface::welded(&triangles, [1.0; 3]);
        assert_eq!((surface.corners.len(), surface.triangles.len()), (8, 12));
    }

    #[test]
    fn a_box_has_eight_corners_and_a_mirror_keeps_its_outside() {
        for scale in [[1.0; 3], [-0.001, 0.001, 0.001]] {
            let surface = Surface::welded(&cuboid([1.0; 3], [1.0, 2.0, 3.0]), scale);
            assert_eq!((surface.corners.len(), surface.triangles.len()), (8, 12));
            let volume: f64 = surface
                .triangles
                .iter()
                .map(|triangle| {
                    let [a, b, c] =
                        triangle.map(|corner| nalgebra::Vector3::from(surface.corners[corner as usize]));
                    a.dot(&b.cross(&c)) / 6.0
                })
                .sum();
            assert!((volume - 6.0 * scale.iter().product::<f64>().abs()).abs() < 1e-12, "{volume}");
        }
    }
}
