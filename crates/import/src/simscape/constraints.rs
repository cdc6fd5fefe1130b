//! Constraints between two instances as rows of forbidden motions.

use nalgebra::Vector3;

use super::freedom::Row;
use super::instances::Instances;
use super::units::Units;
use crate::fault::Fault;
use crate::xml::Element;

/// What a constraint takes hold of, in the world.
#[derive(Debug, Clone, Copy)]
struct Geometry {
    kind: Kind,
    point: Vector3<f64>,
    /// Direction of a line, normal of a plane.
    axis: Vector3<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Point,
    Line,
    Plane,
}

/// A constraint between two instances.
#[derive(Debug)]
pub(super) struct Constraint {
    pub name: String,
    pub between: [usize; 2],
    pub rows: Vec<Row>,
}

/// Reads one; `Err(None)` where it is of a kind that is not known.
pub(super) fn read<'a>(
    element: Element<'a, '_>,
    inside: usize,
    instances: &Instances<'a>,
    units: Units,
) -> Result<Option<Constraint>, Fault> {
    let sides: Vec<Element> = element.all("ConstraintGeometry").collect();
    let [a, b] = sides[..] else { return Ok(None) };
    let between = [instances.named(a, inside)?, instances.named(b, inside)?];
    let (Some(first), Some(second)) =
        (geometry(a, between[0], instances, units)?, geometry(b, between[1], instances, units)?)
    else {
        return Ok(None);
    };
    let name = element.attribute("name").unwrap_or(element.name()).to_owned();
    Ok(rows(element.name(), first, second).map(|rows| Constraint { name, between, rows }))
}

fn geometry(
    element: Element,
    node: usize,
    instances: &Instances,
    units: Units,
) -> Result<Option<Geometry>, Fault> {
    let kind = match element.text_of("geomType")?.to_ascii_lowercase().as_str() {
        "point" | "vertex" | "sphere" => Kind::Point,
        "line" | "axis" | "circle" | "cylinder" | "cone" => Kind::Line,
        "plane" => Kind::Plane,
        _ => return Ok(None),
    };
    let place = &instances.nodes[node].place;
    let point = Vector3::from(element.need("Position")?.content::<3>()?) * units.length;
    let axis = match element.one("Axis")? {
        Some(axis) => {
            let direction = Vector3::from(axis.content::<3>()?);
            let length = direction.norm();
            match length.is_finite() && length > 1e-12 {
                true => direction / length,
                false => return Err(axis.fault("the axis has no direction", "export the assembly again")),
            }
        }
        None if kind == Kind::Point => Vector3::z(),
        None => return Err(element.fault("a line or plane needs an <Axis>", "export the assembly again")),
    };
    Ok(Some(Geometry { kind, point: place.point(&point), axis: place.direction(&axis) }))
}

/// Forbidden motions of a kind of constraint; `None` where the kind is not known for this geometry.
fn rows(name: &str, a: Geometry, b: Geometry) -> Option<Vec<Row>> {
    use Kind::{Line, Plane, Point};
    // Points first, planes last: half the cases.
    let rank = |g: &Geometry| match g.kind {
        Point => 0,
        Line => 1,
        Plane => 2,
    };
    let (a, b) = if rank(&a) <= rank(&b) { (a, b) } else { (b, a) };
    let slide = |point: Vector3<f64>, along: Vector3<f64>| Row::Slide { point, along };
    let across = |axis: &Vector3<f64>| -> [Vector3<f64>; 2] {
        let first = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        [first, axis.cross(&first)]
    };
    let [u, v] = across(&b.axis);
    let parallel = vec![Row::Turn(u), Row::Turn(v)];
    // A line in a plane, or lines or planes at an angle: one turn; none is defined where both are parallel.
    let tilt = a.axis.cross(&b.axis);
    let tilted = match tilt.norm() > 1e-6 {
        true => vec![Row::Turn(tilt.normalize())],
        false => parallel.clone(),
    };
    let with = |mut rows: Vec<Row>, more: &[Row]| {
        rows.extend(more);
        rows
    };
    let gap = b.point - a.point;
    Some(match (name, a.kind, b.kind) {
        ("Concentric" | "Coincident", Point, Point) => {
            [Vector3::x(), Vector3::y(), Vector3::z()].map(|along| slide(a.point, along)).to_vec()
        }
        ("Concentric" | "Coincident", Point, Line) => vec![slide(a.point, u), slide(a.point, v)],
        ("Concentric" | "Coincident", Line, Line) => with(parallel, &[slide(a.point, u), slide(a.point, v)]),
        ("Coincident" | "Distance" | "Tangent", Point, Plane) => vec![slide(a.point, b.axis)],
        ("Coincident" | "Distance" | "Tangent", Line, Plane) => with(tilted, &[slide(a.point, b.axis)]),
        ("Coincident" | "Distance", Plane, Plane) => with(parallel, &[slide(a.point, b.axis)]),
        ("Distance", Point, Point) => vec![slide(a.point, gap.try_normalize(1e-9)?)],
        ("Distance", _, Line) => {
            let away = (gap - b.axis * gap.dot(&b.axis)).try_normalize(1e-9)?;
            let rows = vec![slide(a.point, away)];
            if a.kind == Line { with(rows, &parallel) } else { rows }
        }
        ("Parallel", Line, Line) | ("Parallel", Plane, Plane) => parallel,
        ("Parallel", Line, Plane) => tilted,
        ("Perpendicular", Line, Plane) => parallel,
        ("Perpendicular" | "Angle", Line, Line) | ("Perpendicular" | "Angle", Plane, Plane) => tilted,
        ("Angle", Line, Plane) => tilted,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::freedom::{Left, left};
    use super::*;

    fn geometry(kind: Kind, point: [f64; 3], axis: [f64; 3]) -> Geometry {
        Geometry { kind, point: point.into(), axis: Vector3::from(axis).normalize() }
    }

    /// What is left by constraints between equal geometry on both sides.
    fn of(constraints: &[(&str, Geometry, Geometry)]) -> Left {
        let all: Vec<Row> = constraints.iter().flat_map(|(name, a, b)| rows(name, *a, *b).unwrap()).collect();
        left(&all)
    }

    #[test]
    fn pairs_of_constraints_leave_the_joints_of_the_table() {
        let skew = [1.0, 2.0, -0.5];
        let unit = Vector3::from(skew).normalize();
        let shaft = geometry(Kind::Line, [0.3, -0.1, 0.7], skew);
        let face = geometry(Kind::Plane, [4.0, 1.0, 0.0], skew);
        let side = geometry(Kind::Plane, [0.0, 0.0, 2.0], [2.0, -1.0, 0.0]);
        let other = geometry(Kind::Line, [1.3, -0.1, 0.7], skew);
        let tip = geometry(Kind::Point, [0.1, 0.2, 0.3], [0.0, 0.0, 1.0]);

        let Left::Cylindrical { point, axis } = of(&[("Concentric", shaft, shaft)]) else {
            panic!("concentric")
        };
        assert!(axis.cross(&unit).norm() < 1e-9 && (point - shaft.point).cross(&unit).norm() < 1e-9);
        let Left::Revolute { point, axis } = of(&[("Concentric", shaft, shaft), ("Coincident", face, face)])
        else {
            panic!("concentric and coincident")
        };
        assert!(axis.cross(&unit).norm() < 1e-9 && (point - shaft.point).cross(&unit).norm() < 1e-9);
        let Left::Planar { axis } = of(&[("Coincident", face, face)]) else { panic!("coincident planes") };
        assert!(axis.cross(&unit).norm() < 1e-9);
        let Left::Prismatic { axis } = of(&[("Concentric", shaft, shaft), ("Parallel", side, side)]) else {
            panic!("concentric and parallel")
        };
        assert!(axis.cross(&unit).norm() < 1e-9);
        let edge = unit.cross(&Vector3::new(2.0, -1.0, 0.0)).normalize();
        let Left::Prismatic { axis } = of(&[("Coincident", face, face), ("Distance", side, side)]) else {
            panic!("two planes")
        };
        assert!(axis.cross(&edge).norm() < 1e-9);
        let Left::Spherical { point } = of(&[("Coincident", tip, tip)]) else { panic!("points") };
        assert!((point - tip.point).norm() < 1e-9);
        let weld = [("Concentric", shaft, shaft), ("Coincident", face, face), ("Concentric", other, other)];
        assert_eq!(of(&weld), Left::Weld);
        assert_eq!(of(&[("Coincident", tip, face)]), Left::Other(5));
        assert_eq!(of(&[("Parallel", shaft, other)]), Left::Other(4));
    }

    #[test]
    fn constraints_that_are_not_known_are_named_so() {
        let tip = geometry(Kind::Point, [0.0; 3], [0.0, 0.0, 1.0]);
        assert!(rows("Gear", tip, tip).is_none());
        assert!(rows("Distance", tip, tip).is_none(), "no direction");
    }
}
