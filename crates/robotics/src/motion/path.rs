//! Cartesian paths: a straight line or an arc of a circle for the position, one turn about a fixed axis for the
//! orientation.

use std::fmt;

use blocksim_multibody::{Placement, rotation_vector};
use nalgebra::{Rotation3, Vector3};

/// Ways shorter than this, m, and turns smaller than this, rad, are none.
const NOTHING: f64 = 1e-9;

/// Three points whose triangle is flatter than this, relative to its longest side, lie on a line.
const FLAT: f64 = 1e-6;

/// A path of a frame between two placements, by its length.
///
/// On a line the origin moves straight, on an arc it keeps its distance from a centre. The orientation turns about the one
/// axis that leads from the first to the last, evenly along the path. Where the origin rests, the angle of the turn is
/// the length.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    start: Placement,
    end: Placement,
    /// Vector of the rotation from start to end, in the axes of the parent frame, rad.
    turn: Vector3<f64>,
    shape: Shape,
    length: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Only the orientation changes.
    Turn,
    /// Unit vector.
    Line(Vector3<f64>),
    /// Centre, unit vectors to the start and along the path at the start, radius (m).
    Arc(Vector3<f64>, Vector3<f64>, Vector3<f64>, f64),
}

/// Where a frame is on its path, and how that changes with the length of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Placement in the parent frame.
    pub placement: Placement,
    /// Derivative of the position over the length; a unit vector, or zero where the frame only turns.
    pub tangent: Vector3<f64>,
    /// Its derivative: the vector to the centre over the square of the radius, 1/m.
    pub curvature: Vector3<f64>,
    /// Angle turned for each unit of length, as a vector in the axes of the parent frame.
    pub turn: Vector3<f64>,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathError {
    /// Start and end coincide.
    Nothing,
    /// The three points of an arc lie on a line, or two of them coincide.
    Straight,
    /// A number is infinite or none.
    NotFinite,
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            PathError::Nothing => "start and target are the same: give a target that differs",
            PathError::Straight => {
                "the three points of the arc lie on a line: choose a point beside the way, or a linear move"
            }
            PathError::NotFinite => "a coordinate is infinite or no number",
        })
    }
}

impl std::error::Error for PathError {}

impl Path {
    /// A straight line, or a turn on the spot.
    ///
    /// # Errors
    /// [`PathError::Nothing`] where both placements are the same to 1e-9 m and rad; [`PathError::NotFinite`].
    pub fn line(start: Placement, end: Placement) -> Result<Self, PathError> {
        check(&[start.translation, end.translation])?;
        let way = end.translation - start.translation;
        let turn = turn(&start, &end)?;
        let (shape, length) = match (way.norm(), turn.norm()) {
            (way_length, _) if way_length > NOTHING => (Shape::Line(way / way_length), way_length),
            (_, angle) if angle > NOTHING => (Shape::Turn, angle),
            _ => return Err(PathError::Nothing),
        };
        Ok(Self { start, end, turn, shape, length })
    }

    /// The arc of the circle through the origins of `start` and `end` that passes the point `via`.
    ///
    /// # Errors
    /// [`PathError::Straight`] where the points lie on a line; [`PathError::NotFinite`].
    pub fn arc(start: Placement, via: Vector3<f64>, end: Placement) -> Result<Self, PathError> {
        let (a, b, c) = (start.translation, via, end.translation);
        check(&[a, b, c])?;
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(&ac);
        let longest = ab.norm().max(ac.norm()).max((c - b).norm());
        if normal.norm() <= FLAT * longest * longest {
            return Err(PathError::Straight);
        }
        // Centre of the circumscribed circle.
        let square = normal.norm_squared();
        let to_centre =
            (normal.cross(&ab) * ac.norm_squared() + ac.cross(&normal) * ab.norm_squared()) / (2.0 * square);
        let (centre, radius) = (a + to_centre, to_centre.norm());
        let u = -to_centre / radius;
        // The path passes `via` on its way to `end`, which is the positive sense about this normal.
        let v = normal.normalize().cross(&u);
        let angle_of = |p: Vector3<f64>| {
            let r = p - centre;
            r.dot(&v).atan2(r.dot(&u)).rem_euclid(std::f64::consts::TAU)
        };
        let angle = angle_of(c);
        let turn = turn(&start, &end)?;
        Ok(Self { start, end, turn, shape: Shape::Arc(centre, u, v, radius), length: radius * angle })
    }

    /// Length, m; where only the orientation changes, the angle, rad.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether the origin rests and the length is an angle.
    pub fn is_turn(&self) -> bool {
        self.shape == Shape::Turn
    }

    /// Angle by which the orientation changes, rad.
    pub fn angle(&self) -> f64 {
        self.turn.norm()
    }

    /// The frame at a length along the path; before the start and behind the end as at these, to the bit.
    pub fn at(&self, s: f64) -> PathPoint {
        let s = s.clamp(0.0, self.length);
        let (tangent, curvature, position) = match self.shape {
            Shape::Turn => (Vector3::zeros(), Vector3::zeros(), self.start.translation),
            Shape::Line(along) => (along, Vector3::zeros(), self.start.translation + s * along),
            Shape::Arc(centre, u, v, radius) => {
                let (sin, cos) = (s / radius).sin_cos();
                let outward = cos * u + sin * v;
                (cos * v - sin * u, -outward / radius, centre + radius * outward)
            }
        };
        let placement = if s == 0.0 {
            self.start
        } else if s == self.length {
            self.end
        } else {
            let rotation = Rotation3::new(self.turn * (s / self.length)).into_inner() * self.start.rotation;
            Placement { rotation, translation: position }
        };
        PathPoint { placement, tangent, curvature, turn: self.turn / self.length }
    }
}

fn check(points: &[Vector3<f64>]) -> Result<(), PathError> {
    let finite = points.iter().all(|p| p.iter().all(|e| e.is_finite()));
    if finite { Ok(()) } else { Err(PathError::NotFinite) }
}

/// Vector of the rotation from one orientation to another.
fn turn(start: &Placement, end: &Placement) -> Result<Vector3<f64>, PathError> {
    let turn = rotation_vector(&(end.rotation * start.rotation.transpose()));
    check(&[turn])?;
    Ok(turn)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn at(x: f64, y: f64, z: f64) -> Placement {
        Placement::from_translation([x, y, z])
    }

    fn turned(x: f64, y: f64, z: f64, rpy: [f64; 3]) -> Placement {
        Placement::from_rpy([x, y, z], rpy)
    }

    fn samples() -> Vec<Path> {
        let (a, b) = (turned(0.1, 0.2, 0.3, [0.2, -0.4, 1.0]), turned(-0.6, 0.5, 0.9, [-1.0, 0.3, 0.4]));
        vec![
            Path::line(a, b).unwrap(),
            Path::line(a, Placement { translation: a.translation, ..b }).unwrap(),
            Path::arc(a, Vector3::new(-0.4, -0.3, 0.5), b).unwrap(),
            Path::arc(at(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), at(0.0, -1.0, 0.0)).unwrap(),
        ]
    }

    #[test]
    fn a_path_begins_and_ends_where_it_should() {
        for path in samples() {
            assert_eq!(path.at(0.0).placement, path.start);
            assert_eq!(path.at(path.length()).placement, path.end);
            // Beside the ends nothing jumps.
            let h = 1e-9;
            for (near, end) in [(h, path.start), (path.length() - h, path.end)] {
                let near = path.at(near).placement;
                assert!((near.translation - end.translation).norm() < 2e-9, "{path:?}");
                assert!((near.rotation - end.rotation).norm() < 1e-8, "{path:?}");
            }
        }
    }

    #[test]
    fn tangent_curvature_and_turn_are_derivatives() {
        for path in samples() {
            for share in [0.1, 0.5, 0.83] {
                let (s, h) = (share * path.length(), 1e-5);
                let [before, here, after] = [s - h, s, s + h].map(|s| path.at(s));
                let slope = (after.placement.translation - before.placement.translation) / (2.0 * h);
                assert!((slope - here.tangent).norm() < 1e-8, "{path:?}: {slope} and {}", here.tangent);
                let bend = (after.tangent - before.tangent) / (2.0 * h);
                assert!((bend - here.curvature).norm() < 1e-8, "{path:?}");
                let turned = after.placement.rotation * before.placement.rotation.transpose();
                let turn = rotation_vector(&turned) / (2.0 * h);
                assert!((turn - here.turn).norm() < 1e-8, "{path:?}: {turn} and {}", here.turn);
            }
        }
    }

    #[test]
    fn an_arc_passes_its_point_and_has_the_length_of_the_circle() {
        // Three quarters of the unit circle, by the point at a third of them.
        let path = Path::arc(at(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), at(0.0, -1.0, 0.0)).unwrap();
        assert!((path.length() - 1.5 * PI).abs() < 1e-14);
        let via = path.at(FRAC_PI_2).placement.translation;
        assert!((via - Vector3::y()).norm() < 1e-15);
        for k in 0..=100 {
            let p = path.at(path.length() * f64::from(k) / 100.0).placement.translation;
            assert!((p.norm() - 1.0).abs() < 1e-15 && p.z == 0.0);
        }
        // The other way round, past the opposite point.
        let path = Path::arc(at(1.0, 0.0, 0.0), Vector3::new(0.7, -0.7, 0.0).normalize(), at(0.0, -1.0, 0.0))
            .unwrap();
        assert!((path.length() - FRAC_PI_2).abs() < 1e-14);
    }

    #[test]
    fn a_turn_on_the_spot_is_as_long_as_its_angle() {
        let path = Path::line(at(1.0, 2.0, 3.0), turned(1.0, 2.0, 3.0, [0.0, 0.0, -0.7])).unwrap();
        assert!(path.is_turn() && (path.length() - 0.7).abs() < 1e-15);
        assert_eq!(path.at(0.3).placement.translation, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn what_is_no_path_is_said() {
        let here = turned(0.1, 0.2, 0.3, [0.2, -0.4, 1.0]);
        assert_eq!(Path::line(here, here), Err(PathError::Nothing));
        assert_eq!(Path::line(here, at(f64::NAN, 0.0, 0.0)), Err(PathError::NotFinite));
        let arc = |via| Path::arc(at(0.0, 0.0, 0.0), via, at(1.0, 0.0, 0.0));
        for via in [Vector3::new(0.5, 0.0, 0.0), Vector3::zeros(), Vector3::x(), Vector3::new(3.0, 0.0, 0.0)]
        {
            assert_eq!(arc(via), Err(PathError::Straight), "{via}");
        }
        assert_eq!(arc(Vector3::new(f64::INFINITY, 0.0, 0.0)), Err(PathError::NotFinite));
    }
}
