//! Corners in 16 bits along each axis.

use super::surface::Surface;

/// A surface whose corners are counted in steps from its lower end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Packed {
    /// Where the counting begins, m.
    pub low: [f64; 3],
    /// Length of a step along x, y and z, m.
    pub step: [f64; 3],
    /// Steps along x of all corners, then along y, then along z.
    pub corners: Vec<u16>,
    /// Indices of the first corners of all triangles, then of the second ones, then of the third ones.
    pub triangles: Vec<u32>,
}

impl Packed {
    /// Rounds each corner to the nearest step; the whole extent has 65535.
    pub fn of(surface: &Surface) -> Packed {
        let most = f64::from(u16::MAX);
        let [low, high] = surface.bounds();
        let step = [0, 1, 2].map(|k| (high[k] / most - low[k] / most).max(0.0));
        let mut corners = Vec::with_capacity(3 * surface.corners.len());
        for k in 0..3 {
            let steps = |corner: &[f64; 3]| match step[k] > 0.0 {
                // A float beyond the range becomes the largest number.
                true => ((corner[k] - low[k]) / step[k]).round() as u16,
                false => 0,
            };
            corners.extend(surface.corners.iter().map(steps));
        }
        let triangles = (0..3).flat_map(|k| surface.triangles.iter().map(move |triangle| triangle[k]));
        Packed { low, step, corners, triangles: triangles.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::stl::tests::cuboid;

    #[test]
    fn corners_come_back_within_half_a_step() {
        let mut triangles = cuboid([-0.3, 0.1, 0.0], [0.7, 0.2, 1.9]);
        triangles.push([[0.123, 0.2, 0.456], [0.2, 0.21, 0.7], [0.1, 0.15, 1.234]]);
        let surface = Surface::welded(&triangles, [1.0; 3]);
        let packed = Packed::of(&surface);
        let n = surface.corners.len();
        for (i, corner) in surface.corners.iter().enumerate() {
            for (k, x) in corner.iter().enumerate() {
                let back = packed.low[k] + packed.step[k] * f64::from(packed.corners[k * n + i]);
                assert!((back - x).abs() <= 0.5001 * packed.step[k], "{back} {x}");
            }
        }
        let m = surface.triangles.len();
        assert_eq!([0, m, 2 * m].map(|at| packed.triangles[at + 12]), surface.triangles[12]);
    }

    #[test]
    fn a_flat_surface_has_no_steps_across() {
        let surface = Surface::welded(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]], [1.0; 3]);
        let packed = Packed::of(&surface);
        assert_eq!((packed.step[2], &packed.corners[6..]), (0.0, &[0, 0, 0][..]));
    }
}
