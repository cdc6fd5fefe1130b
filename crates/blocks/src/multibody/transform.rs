use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// A fixed displacement between two frames.
///
/// A point with coordinates $x$ in `follower` has $R x + p$ in `base`: the translation $p$ is measured along
/// the axes of `base`. The rotation is given either by roll, pitch and yaw about the axes of `base`, as in
/// robot descriptions,
///
/// $$ R = R_z(\text{yaw})\,R_y(\text{pitch})\,R_x(\text{roll}) $$
///
/// or as a matrix.
///
/// ```ron
/// Transform(translation: [0.0, 0.0, "445 mm"], rpy: [0.0, "90 deg", 0.0])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Frame)]
pub struct Transform {
    /// Origin of `follower` in `base`: x, y, z.
    #[block(unit = "m", finite, default = [0.0, 0.0, 0.0])]
    pub translation: [f64; 3],
    /// Roll, pitch and yaw.
    #[block(unit = "rad", finite, default = [0.0, 0.0, 0.0])]
    pub rpy: [f64; 3],
    /// Rotation matrix, row by row, instead of `rpy`.
    #[block(finite, default = None)]
    pub rotation: Option<[[f64; 3]; 3]>,
}

/// How far the columns of a rotation matrix may be from orthonormal: six printed digits.
const ROUNDING: f64 = 1e-5;

impl Transform {
    /// The rotation matrix.
    fn matrix(&self) -> [[f64; 3]; 3] {
        if let Some(rotation) = self.rotation {
            return rotation;
        }
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.map(f64::sin_cos);
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    }

    fn validate(&self, errors: &mut ParamErrors) {
        let Some(rotation) = &self.rotation else { return };
        if self.rpy != [0.0; 3] {
            let error =
                ParamError::new("rotation", "the rotation is given twice, by `rpy` and by `rotation`");
            errors.add(error.beside(&["rpy"]).help("keep one of them"));
        }
        let mut is_orthogonal = true;
        for (i, a) in rotation.iter().enumerate() {
            for (j, b) in rotation.iter().enumerate().skip(i) {
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                let expected = if i == j { 1.0 } else { 0.0 };
                if (product - expected).abs() < ROUNDING {
                    continue;
                }
                is_orthogonal = false;
                let (i, j) = (i + 1, j + 1);
                let message = match i == j {
                    true => format!("row {i} of `rotation` has the length {}, not 1", product.sqrt()),
                    false => format!("rows {i} and {j} of `rotation` have the product {product}, not 0"),
                };
                let help = "the rows of a rotation matrix have length 1 and are perpendicular; or use `rpy`";
                errors.add(ParamError::new("rotation", message).help(help));
            }
        }
        if is_orthogonal && determinant(rotation) < 0.0 {
            let error = ParamError::new("rotation", "`rotation` is a reflection: its determinant is -1");
            errors.add(error.help("change the sign of one row"));
        }
    }
}

/// Determinant of a matrix.
fn determinant(m: &[[f64; 3]; 3]) -> f64 {
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}

impl Component for Transform {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("base", Domain::Frame, "frame it starts from")
            .port("follower", Domain::Frame, "frame it leads to")
            .element(Element::Transform {
                base: 0,
                follower: 1,
                rotation: self.matrix(),
                translation: self.translation,
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(rpy: [f64; 3]) -> Transform {
        Transform { translation: [0.0; 3], rpy, rotation: None }
    }

    #[test]
    fn roll_pitch_and_yaw_turn_about_x_y_and_z() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let close = |found: [[f64; 3]; 3], expected: [[f64; 3]; 3]| {
            let difference =
                found.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(difference.fold(0.0, f64::max) < 1e-15, "{found:?} != {expected:?}");
        };
        close(turned([quarter, 0.0, 0.0]).matrix(), [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);
        close(turned([0.0, quarter, 0.0]).matrix(), [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]);
        close(turned([0.0, 0.0, quarter]).matrix(), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    }

    #[test]
    fn every_rotation_by_angles_is_a_rotation_matrix() {
        let matrix = turned([0.3, -1.2, 2.5]).matrix();
        let by_matrix = Transform { translation: [1.0, 2.0, 3.0], rpy: [0.0; 3], rotation: Some(matrix) };
        assert_eq!(by_matrix.errors()[..], []);
        assert_eq!(by_matrix.matrix(), matrix);
    }

    #[test]
    fn reflections_skewed_and_doubled_rotations_are_refused() {
        let with = |rotation| Transform { rotation: Some(rotation), ..turned([0.0; 3]) };
        let refused = |transform: Transform| assert!(transform.errors()[0].param.starts_with("rotation"));
        refused(with([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]));
        refused(with([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
        refused(with([[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
        refused(Transform {
            rpy: [0.1, 0.0, 0.0],
            ..with([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        });
    }
}
