//! Volume, centre and inertia of a body that triangles enclose.
//!
//! By the divergence theorem: every triangle and a common point span a tetrahedron whose signed volume counts.
//! Source: C. Zhang, T. Chen, Efficient feature extraction for 2D/3D objects in mesh representation, 2001, extended
//! to second moments by the integral of a product of linear functions over a simplex.

use std::collections::HashMap;
use std::f64::consts::PI;

use blocksim_multibody::Inertia;
use nalgebra::{Matrix3, Vector3};

use crate::stl::Triangle;

/// What triangles enclose, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// Volume, m³; negative where the triangles are turned inside out.
    pub volume: f64,
    /// Centre of the volume, m.
    pub centre: Vector3<f64>,
    /// Inertia about the centre for a density of 1 kg/m³, kg m².
    pub about_centre: Matrix3<f64>,
    /// Least and largest coordinates, m.
    pub bounds: [Vector3<f64>; 2],
    /// Every edge has a triangle on both sides, so that there is an inside.
    pub closed: bool,
}

impl Solid {
    /// A box with its centre at the origin, edges along x, y and z in m.
    pub(crate) fn cuboid(size: [f64; 3]) -> Solid {
        let [a, b, c] = size.map(|x| x * x / 12.0);
        Solid::regular(size.iter().product(), [b + c, a + c, a + b], size.map(|x| x / 2.0))
    }

    /// A cylinder along z with its centre at the origin, m.
    pub(crate) fn cylinder(radius: f64, length: f64) -> Solid {
        let across = radius * radius / 4.0 + length * length / 12.0;
        let volume = PI * radius * radius * length;
        Solid::regular(volume, [across, across, radius * radius / 2.0], [radius, radius, length / 2.0])
    }

    /// A sphere about the origin, m.
    pub(crate) fn sphere(radius: f64) -> Solid {
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        Solid::regular(volume, [0.4 * radius * radius; 3], [radius; 3])
    }

    /// About the origin, with squares of its radii of gyration and how far it reaches along the axes.
    fn regular(volume: f64, gyration: [f64; 3], reach: [f64; 3]) -> Solid {
        let reach = Vector3::from(reach);
        Solid {
            volume,
            centre: Vector3::zeros(),
            about_centre: Matrix3::from_diagonal(&(Vector3::from(gyration) * volume)),
            bounds: [-reach, reach],
            closed: true,
        }
    }

    /// Mass properties at a density, kg/m³; `None` where there is no inside.
    pub fn inertia(&self, density: f64) -> Option<Inertia> {
        let sign = self.volume.signum();
        let usable = self.closed && self.volume != 0.0;
        usable.then(|| Inertia {
            mass: density * self.volume.abs(),
            com: self.centre,
            about_com: self.about_centre * (density * sign),
        })
    }
}

/// Measures triangles whose numbers become metres by `scale`.
pub fn solid(triangles: &[Triangle], scale: [f64; 3]) -> Solid {
    let scale = Vector3::from(scale);
    let corner = |corner: &[f64; 3]| Vector3::from(*corner).component_mul(&scale);
    let mut bounds = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
    for point in triangles.iter().flatten().map(corner) {
        bounds = [bounds[0].inf(&point), bounds[1].sup(&point)];
    }
    // A common point in the middle keeps the tetrahedra small and the sums exact.
    let middle = (bounds[0] + bounds[1]) / 2.0;
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for triangle in triangles {
        let [a, b, c] = triangle.each_ref().map(|point| corner(point) - middle);
        let v = a.dot(&b.cross(&c)) / 6.0;
        let sum = a + b + c;
        volume += v;
        first += sum * (v / 4.0);
        second +=
            (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()) * (v / 20.0);
    }
    let from_middle = if volume == 0.0 { Vector3::zeros() } else { first / volume };
    let central = second - from_middle * from_middle.transpose() * volume;
    // A scale that mirrors turns the triangles inside out.
    let mirrored = scale.iter().product::<f64>().signum();
    Solid {
        volume: volume * mirrored,
        centre: middle + from_middle,
        about_centre: (Matrix3::identity() * central.trace() - central) * mirrored,
        bounds,
        closed: closed(triangles),
    }
}

/// Whether each edge is run along in both directions equally often.
fn closed(triangles: &[Triangle]) -> bool {
    // Adding zero makes 0 of -0.
    let key = |corner: &[f64; 3]| corner.map(|x| (x + 0.0).to_bits());
    let mut edges: HashMap<[[u64; 3]; 2], i64> = HashMap::new();
    for [a, b, c] in triangles.iter().map(|triangle| triangle.each_ref().map(key)) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (edge, direction) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
            *edges.entry(edge).or_default() += direction;
        }
    }
    edges.values().all(|sum| *sum == 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stl::tests::cuboid;

    #[test]
    fn a_box_has_the_volume_centre_and_inertia_of_the_books() {
        let size = [0.3, 0.5, 0.2];
        for low in [[0.0; 3], [10.0, -20.0, 5.0]] {
            let millimetres = cuboid(low.map(|x| 1e3 * x), size.map(|x| 1e3 * x));
            let found = solid(&millimetres, [1e-3; 3]);
            assert!((found.volume - 0.03).abs() < 1e-15);
            let centre = Vector3::from(low) + Vector3::from(size) / 2.0;
            assert!((found.centre - centre).norm() < 1e-13);
            let [a, b, c] = size.map(|x| x * x);
            let expected = Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b)) * (0.03 / 12.0);
            assert!((found.about_centre - expected).abs().max() < 1e-15);
            assert!(found.closed);
        }
    }

    #[test]
    fn boxes_cylinders_and_spheres_are_as_their_triangles() {
        let size = [0.3, 0.5, 0.2];
        let [exact, found] = [Solid::cuboid(size), solid(&cuboid(size.map(|x| -x / 2.0), size), [1.0; 3])];
        assert!((exact.volume - found.volume).abs() < 1e-15 && exact.bounds == found.bounds);
        assert!((exact.about_centre - found.about_centre).abs().max() < 1e-15);
        // A rod is slender: m l^2 / 12 across, m r^2 / 2 along; a ball has 2/5 m r^2.
        let rod = Solid::cylinder(0.001, 2.0);
        assert!((rod.volume - 2e-6 * PI).abs() < 1e-18);
        assert!((rod.about_centre[(0, 0)] / rod.volume - 4.0 / 12.0).abs() < 1e-6);
        assert!((rod.about_centre[(2, 2)] / rod.volume - 0.5e-6).abs() < 1e-18);
        let ball = Solid::sphere(0.5);
        assert!((ball.volume - PI / 6.0).abs() < 1e-15);
        assert!((ball.about_centre[(1, 1)] / ball.volume - 0.1).abs() < 1e-15);
    }

    #[test]
    fn a_tetrahedron_has_products_of_inertia() {
        // Corners at the origin and on the axes at 1: V = 1/6, centre 1/4, ∫x² = 1/60, ∫xy = 1/120.
        let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let found = solid(&[[o, y, x], [o, x, z], [o, z, y], [x, y, z]], [1.0; 3]);
        assert!((found.volume - 1.0 / 6.0).abs() < 1e-16);
        let diagonal = 2.0 * (1.0 / 60.0 - 1.0 / 96.0);
        let product = -(1.0 / 120.0 - 1.0 / 96.0);
        assert!((found.about_centre[(0, 0)] - diagonal).abs() < 1e-16);
        assert!((found.about_centre[(0, 1)] - product).abs() < 1e-16);
    }

    #[test]
    fn a_sphere_of_triangles_comes_near_to_a_sphere() {
        // Along circles of latitude; error of order (step)².
        let (radius, steps) = (0.1, 120);
        let point = |i: usize, j: usize| {
            let (theta, phi) = (
                std::f64::consts::PI * i as f64 / steps as f64,
                std::f64::consts::TAU * (j % (2 * steps)) as f64 / (2 * steps) as f64,
            );
            let ring = if i == 0 || i == steps { 0.0 } else { theta.sin() };
            [radius * ring * phi.cos(), radius * ring * phi.sin(), radius * theta.cos()]
        };
        let mut triangles = Vec::new();
        for i in 0..steps {
            for j in 0..2 * steps {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let found = solid(&triangles, [1.0; 3]);
        let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        assert!((found.volume / volume - 1.0).abs() < 1e-3);
        let ratio = found.about_centre[(0, 0)] / (0.4 * volume * radius * radius);
        assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
    }

    #[test]
    fn a_hole_leaves_no_inside_and_a_mirror_leaves_the_mass_alone() {
        let mut triangles = cuboid([0.0; 3], [1.0; 3]);
        let mirrored = solid(&triangles, [-1.0, 1.0, 1.0]).inertia(2.0).map(|i| (i.mass, i.com.x));
        assert_eq!(mirrored, Some((2.0, -0.5)));
        triangles.pop();
        let open = solid(&triangles, [1.0; 3]);
        assert!(!open.closed && open.inertia(1.0).is_none());
    }
}
