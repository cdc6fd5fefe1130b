//! Shapes as a parameter gives them: sets with a kind, dimensions with units and a place.

use blocksim_multibody::Placement;
use blocksim_signal::{Dimension, Unit, Value, si_text};
use nalgebra::{Rotation3, UnitVector3, Vector3};

use crate::shape::{Form, Purpose, Shape};

/// Members that every shape may have.
const COMMON: [&str; 5] = ["use", "kind", "centre", "rpy", "colour"];

/// The shapes of a body: a list of sets such as
/// `(kind: Text("box"), size: ["0.2 m", "0.1 m", "1 m"], centre: ["0 m", "0 m", "0.5 m"])`, or one set alone.
///
/// | kind | members |
/// |---|---|
/// | `box` | `size`: edges along x, y and z |
/// | `cylinder` | `radius`, `length` along z |
/// | `capsule` | `radius`, `length` between the centres of its ends |
/// | `sphere` | `radius` |
/// | `cone` | `radius` below, `top` (radius above; without it a tip), `length` |
/// | `mesh` | `file`, `scale`: what makes metres of its numbers |
///
/// Further members are `centre` and `rpy` in the frame of the body; `from` and `to`, the ends of a cylinder,
/// capsule or cone, in their place and that of `length`; `colour`: red, green, blue and, if wanted, opacity from 0 to
/// 1; and `use`, `visual` or `collision`, where a shape is not for both.
///
/// # Errors
/// A sentence with the number of the shape, the member, the reason and the remedy.
pub fn shapes(value: &Value) -> Result<Vec<Shape>, String> {
    match value {
        Value::List(items) => items
            .iter()
            .enumerate()
            .map(|(i, item)| shape(item).map_err(|reason| format!("shape {}: {reason}", i + 1)))
            .collect(),
        Value::Set(_) => Ok(vec![shape(value)?]),
        other => Err(format!("expected a list of shapes, found {}", other.describe())),
    }
}

fn shape(value: &Value) -> Result<Shape, String> {
    let Some(members) = value.as_set() else {
        return Err(format!(
            "expected a set such as `(kind: Text(\"sphere\"), radius: \"0.1 m\")`, found {}",
            value.describe()
        ));
    };
    let kind =
        word(value, "kind")?.ok_or("`kind` is missing: box, cylinder, capsule, sphere, cone or mesh")?;
    let own: &[&str] = match kind {
        "box" => &["size"],
        "cylinder" | "capsule" => &["radius", "length", "from", "to"],
        "sphere" => &["radius"],
        "cone" => &["radius", "top", "length", "from", "to"],
        "mesh" => &["file", "scale"],
        other => {
            return Err(format!(
                "`{other}` is not a kind of shape; there are box, cylinder, capsule, sphere, cone and mesh"
            ));
        }
    };
    if let Some((unknown, _)) =
        members.iter().find(|(name, _)| !COMMON.contains(&name.as_str()) && !own.contains(&name.as_str()))
    {
        return Err(format!("a {kind} has no `{unknown}`; it has {}, {}", own.join(", "), COMMON.join(", ")));
    }
    let (place, between) = place(value)?;
    let along = || match between {
        Some(length) => Ok(length),
        None => size(value, "length"),
    };
    let form = match kind {
        "box" => Form::Box {
            size: all_above_zero("size", vector(value, "size", "m")?.ok_or("`size` is missing")?)?,
        },
        "cylinder" => Form::Cylinder { radius: size(value, "radius")?, length: along()? },
        "capsule" => Form::Capsule { radius: size(value, "radius")?, length: along()? },
        "sphere" => Form::Sphere { radius: size(value, "radius")? },
        "cone" => cone(size(value, "radius")?, value, along()?)?,
        _ => Form::Mesh {
            file: word(value, "file")?.ok_or("`file` is missing")?.to_owned(),
            scale: scale(value)?,
        },
    };
    let purpose = match word(value, "use")? {
        None => Purpose::Both,
        Some("visual") => Purpose::Visual,
        Some("collision") => Purpose::Collision,
        Some(other) => {
            return Err(format!("`use` is `{other}`; write visual or collision, or leave it out for both"));
        }
    };
    Ok(Shape { purpose, place, form, colour: colour(value)? })
}

fn cone(radius: f64, value: &Value, length: f64) -> Result<Form, String> {
    let top = number(value, "top", "m")?.unwrap_or(0.0);
    match top >= 0.0 {
        true => Ok(Form::Cone { radius, top, length }),
        false => Err(format!("`top` is {top} m, but must not be negative")),
    }
}

/// Factors of a mesh; negative ones mirror it.
fn scale(value: &Value) -> Result<[f64; 3], String> {
    let scale = vector(value, "scale", "1")?.unwrap_or([1.0; 3]);
    match scale.contains(&0.0) {
        true => Err("`scale` is 0 along an axis: the mesh would be flat".to_owned()),
        false => Ok(scale),
    }
}

/// Where the shape is; its length, where `from` and `to` give it.
fn place(value: &Value) -> Result<(Placement, Option<f64>), String> {
    let (from, to) = (vector(value, "from", "m")?, vector(value, "to", "m")?);
    let (centre, rpy) = (vector(value, "centre", "m")?, vector(value, "rpy", "rad")?);
    let (from, to): (Vector3<f64>, Vector3<f64>) = match (from, to) {
        (None, None) => {
            let centre = centre.unwrap_or_default();
            return Ok((Placement::from_rpy(centre, rpy.unwrap_or_default()), None));
        }
        (Some(from), Some(to)) => (from.into(), to.into()),
        _ => return Err("`from` and `to` belong together: write both".to_owned()),
    };
    if centre.is_some() || rpy.is_some() || value.get("length").is_some() {
        return Err(
            "`from` and `to` stand in the place of `centre`, `rpy` and `length`: keep one of both".to_owned()
        );
    }
    let axis = UnitVector3::try_new_and_get(to - from, f64::MIN_POSITIVE);
    let (axis, length) = axis.ok_or("`from` and `to` are the same point, so the shape has no length")?;
    let half_turn = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let rotation = Rotation3::rotation_between(&Vector3::z(), &axis).unwrap_or_else(half_turn).into_inner();
    Ok((Placement { rotation, translation: (from + to) / 2.0 }, Some(length)))
}

fn colour(value: &Value) -> Result<Option<[f64; 4]>, String> {
    let Some(given) = value.get("colour") else { return Ok(None) };
    let items = given.as_list().unwrap_or_default();
    let parts: Option<Vec<f64>> =
        items.iter().map(|item| item.as_number().map(|number| number.value)).collect();
    let colour = match parts.as_deref() {
        Some([red, green, blue]) => [*red, *green, *blue, 1.0],
        Some([red, green, blue, opacity]) => [*red, *green, *blue, *opacity],
        _ => return Err("`colour` must be three or four numbers: red, green, blue, opacity".to_owned()),
    };
    match colour.iter().all(|part| (0.0..=1.0).contains(part)) {
        true => Ok(Some(colour)),
        false => Err("`colour`: red, green, blue and opacity go from 0 to 1".to_owned()),
    }
}

fn word<'v>(value: &'v Value, name: &str) -> Result<Option<&'v str>, String> {
    match value.get(name) {
        None => Ok(None),
        Some(Value::Text(text)) => Ok(Some(text)),
        Some(other) => {
            Err(format!("`{name}` must be a text such as Text(\"box\"), not {}", other.describe()))
        }
    }
}

/// A length above zero.
fn size(value: &Value, name: &str) -> Result<f64, String> {
    above_zero(name, number(value, name, "m")?.ok_or_else(|| format!("`{name}` is missing"))?)
}

fn above_zero(name: &str, x: f64) -> Result<f64, String> {
    if x > 0.0 { Ok(x) } else { Err(format!("`{name}` is {x}, but must be positive")) }
}

/// A number in SI; one without a unit is taken as it stands.
fn number(value: &Value, name: &str, unit: &str) -> Result<Option<f64>, String> {
    value.get(name).map(|value| in_unit(value, name, unit)).transpose()
}

fn vector(value: &Value, name: &str, unit: &str) -> Result<Option<[f64; 3]>, String> {
    let Some(given) = value.get(name) else { return Ok(None) };
    match given {
        Value::List(items) if items.len() == 3 => {
            let mut out = [0.0; 3];
            for (out, item) in out.iter_mut().zip(items) {
                *out = in_unit(item, name, unit)?;
            }
            Ok(Some(out))
        }
        other => Err(format!("`{name}` must be three numbers in {unit}, not {}", other.describe())),
    }
}

fn in_unit(value: &Value, name: &str, unit: &str) -> Result<f64, String> {
    let Some(number) = value.as_number() else {
        return Err(format!("`{name}` must be in {unit}, not {}", value.describe()));
    };
    if !number.value.is_finite() {
        return Err(format!("`{name}` is {}, but must be finite", number.value));
    }
    let expected = Unit::parse(unit).map_or(Dimension::NONE, |unit| unit.dimension);
    match number.dimension.is_none() || number.dimension.compatible(expected) {
        true => Ok(number.value),
        false => Err(format!("`{name}` must be in {unit}, not {}", si_text(number.value, number.dimension))),
    }
}

fn all_above_zero(name: &str, all: [f64; 3]) -> Result<[f64; 3], String> {
    all.iter().try_for_each(|x| above_zero(name, *x).map(drop))?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_signal::Quantity;

    fn metres(x: f64) -> Value {
        Quantity::new(x, Unit::parse("m").expect("a unit").dimension).into()
    }

    fn set(members: &[(&str, Value)]) -> Value {
        Value::Set(members.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect())
    }

    fn kind(name: &str) -> (&'static str, Value) {
        ("kind", Value::Text(name.to_owned()))
    }

    fn point(x: f64, y: f64, z: f64) -> Value {
        Value::List([x, y, z].map(metres).to_vec())
    }

    fn refused(members: &[(&str, Value)]) -> String {
        shapes(&Value::List(vec![set(members)])).expect_err("a bad shape")
    }

    #[test]
    fn every_kind_is_read_with_its_place_and_its_colour() {
        let colour = Value::List(vec![1.0.into(), 0.4.into(), 0.0.into()]);
        let boxed = set(&[
            kind("box"),
            ("size", point(0.1, 0.2, 0.3)),
            ("centre", point(0.0, 0.0, 1.0)),
            ("colour", colour),
        ]);
        let read = shapes(&Value::List(vec![
            boxed,
            set(&[kind("sphere"), ("radius", metres(0.1)), ("use", Value::Text("collision".to_owned()))]),
            set(&[kind("cone"), ("radius", metres(0.1)), ("top", 0.0.into()), ("length", metres(0.4))]),
            set(&[
                kind("mesh"),
                ("file", Value::Text("a.stl".to_owned())),
                ("scale", Value::List(vec![0.001.into(); 3])),
            ]),
        ]))
        .expect("shapes");
        assert_eq!(read[0].form, Form::Box { size: [0.1, 0.2, 0.3] });
        assert_eq!(
            (read[0].place, read[0].colour),
            (Placement::from_translation([0.0, 0.0, 1.0]), Some([1.0, 0.4, 0.0, 1.0]))
        );
        assert!(!read[1].is_visual() && read[1].collides() && read[0].is_visual() && read[0].collides());
        assert_eq!(read[2].form, Form::Cone { radius: 0.1, top: 0.0, length: 0.4 });
        assert_eq!(read[3].form, Form::Mesh { file: "a.stl".to_owned(), scale: [0.001; 3] });
    }

    #[test]
    fn two_ends_give_place_direction_and_length() {
        for (from, to) in
            [([0.1, 0.2, 0.3], [0.1, 0.2, 0.8]), ([0.0; 3], [-1.0, 2.0, 2.0]), ([0.0, 0.0, 1.0], [0.0; 3])]
        {
            let ends = [("from", point(from[0], from[1], from[2])), ("to", point(to[0], to[1], to[2]))];
            let read = shapes(&set(&[&[kind("cylinder"), ("radius", metres(0.1))], &ends[..]].concat()))
                .expect("a shape");
            let Form::Cylinder { length, .. } = read[0].form else { panic!("{:?}", read[0]) };
            let end = read[0].place.point(&Vector3::new(0.0, 0.0, length / 2.0));
            assert!((end - Vector3::from(to)).norm() < 1e-15, "{end} != {to:?}");
            let r = read[0].place.rotation;
            assert!(
                (r.transpose() * r - nalgebra::Matrix3::identity()).abs().max() < 1e-15
                    && r.determinant() > 0.0
            );
        }
    }

    #[test]
    fn bad_shapes_are_refused_with_number_member_and_reason() {
        let mass = Quantity::new(1.0, Unit::parse("kg").expect("a unit").dimension);
        let r = ("radius", metres(0.1));
        for (members, reason) in [
            (vec![r.clone()], "shape 1: `kind` is missing: box, cylinder, capsule, sphere, cone or mesh"),
            (
                vec![kind("torus")],
                "shape 1: `torus` is not a kind of shape; there are box, cylinder, capsule, sphere, cone and mesh",
            ),
            (vec![kind("sphere")], "shape 1: `radius` is missing"),
            (vec![kind("sphere"), ("radius", mass.into())], "shape 1: `radius` must be in m, not 1 kg"),
            (
                vec![kind("sphere"), ("radius", f64::NAN.into())],
                "shape 1: `radius` is NaN, but must be finite",
            ),
            (vec![kind("sphere"), ("radius", metres(0.0))], "shape 1: `radius` is 0, but must be positive"),
            (
                vec![kind("sphere"), r.clone(), ("size", metres(1.0))],
                "shape 1: a sphere has no `size`; it has radius, use, kind, centre, rpy, colour",
            ),
            (
                vec![kind("capsule"), r.clone(), ("from", point(0.0, 0.0, 0.0))],
                "shape 1: `from` and `to` belong together: write both",
            ),
            (
                vec![kind("box"), ("size", metres(1.0))],
                "shape 1: `size` must be three numbers in m, not a number",
            ),
            (
                vec![kind("sphere"), r.clone(), ("colour", Value::List(vec![2.0.into(); 3]))],
                "shape 1: `colour`: red, green, blue and opacity go from 0 to 1",
            ),
            (
                vec![kind("sphere"), r, ("use", Value::Text("fun".to_owned()))],
                "shape 1: `use` is `fun`; write visual or collision, or leave it out for both",
            ),
        ] {
            assert_eq!(refused(&members), reason);
        }
        assert_eq!(shapes(&1.0.into()), Err("expected a list of shapes, found a number".to_owned()));
    }
}
