//! Links: inertia and shapes.

use std::collections::BTreeMap;

use blocksim_multibody::{Inertia, InertiaError, Placement};
use nalgebra::Matrix3;

use crate::fault::Fault;
use crate::mechanism::{Body, Form, Role, Shape};
use crate::xml::Element;

/// Colours of materials that are named at the top of the file.
pub(super) fn colours<'a>(robot: Element<'a, '_>) -> BTreeMap<&'a str, [f64; 4]> {
    let named =
        robot.all("material").filter_map(|material| Some((material.attribute("name")?, rgba(material)?)));
    named.collect()
}

/// The colour of a material that says one.
fn rgba(material: Element) -> Option<[f64; 4]> {
    let colour = material.all("color").next()?;
    colour.numbers("rgba").ok().flatten().map(|rgba: [f64; 4]| rgba.map(|x| x.clamp(0.0, 1.0)))
}

pub(super) fn read(
    link: Element,
    original: &str,
    name: String,
    colours: &BTreeMap<&str, [f64; 4]>,
    notes: &mut Vec<String>,
) -> Result<Body, Fault> {
    let inertia = match link.one("inertial")? {
        Some(inertial) => inertia(inertial, original, notes)?,
        None => None,
    };
    let mut shapes = Vec::new();
    for element in link.children() {
        let role = match element.name() {
            "visual" => Role::Visual,
            "collision" => Role::Collision,
            _ => continue,
        };
        shapes.push(shape(element, role, colours)?);
    }
    Ok(Body { name, original: original.to_owned(), inertia, shapes })
}

/// `None` where the link is a mere frame: its mass and all moments are zero.
fn inertia(inertial: Element, link: &str, notes: &mut Vec<String>) -> Result<Option<Inertia>, Fault> {
    let place = origin(inertial)?;
    let mass = inertial.need("mass")?;
    let kilograms = mass.number("value")?;
    let tensor = inertial.need("inertia")?;
    let [xx, xy, xz, yy, yz, zz] = {
        let mut values = [0.0; 6];
        for (value, name) in values.iter_mut().zip(["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]) {
            *value = tensor.number(name)?;
        }
        values
    };
    if kilograms == 0.0 && [xx, xy, xz, yy, yz, zz] == [0.0; 6] {
        notes.push(format!("link `{link}` has no mass: it is a frame only"));
        return Ok(None);
    }
    if kilograms <= 0.0 {
        let reason = format!("the mass of `{link}` is {kilograms} kg");
        return Err(
            mass.fault(reason, "a mass is above zero; leave <inertial> out where the link is a frame only")
        );
    }
    let about_com = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let own = Inertia { mass: kilograms, com: nalgebra::Vector3::zeros(), about_com };
    own.check().map_err(|error| {
        let remedy = match error {
            InertiaError::Triangle { .. } => {
                "check units and signs; in URDF the moments are in kg m^2 about the centre of mass"
            }
            _ => "correct the numbers",
        };
        tensor.fault(format!("the inertia of `{link}`: {error}"), remedy)
    })?;
    // Where nothing is turned the numbers stay as they are written.
    let turned = if place.rotation == Matrix3::identity() {
        Inertia { com: place.translation, ..own }
    } else {
        own.placed(&place)
    };
    Ok(Some(turned))
}

/// The placement that `<origin>` gives; none is the identity.
pub(super) fn origin(element: Element) -> Result<Placement, Fault> {
    let Some(origin) = element.one("origin")? else { return Ok(Placement::identity()) };
    let xyz = origin.numbers("xyz")?.unwrap_or([0.0; 3]);
    let rpy = origin.numbers("rpy")?.unwrap_or([0.0; 3]);
    Ok(match rpy == [0.0; 3] {
        true => Placement::from_translation(xyz),
        // Right angles leave zeros and ones, not 6e-17.
        false => {
            let turned = Placement::from_rpy(xyz, rpy);
            let clean = |x: f64| if (x - x.round()).abs() < 1e-15 { x.round() } else { x };
            Placement { rotation: turned.rotation.map(clean), ..turned }
        }
    })
}

fn shape(element: Element, role: Role, colours: &BTreeMap<&str, [f64; 4]>) -> Result<Shape, Fault> {
    let place = origin(element)?;
    let geometry = element.need("geometry")?;
    let Some(kind) = geometry.children().next() else {
        return Err(
            geometry.fault("<geometry> is empty", "put <box>, <cylinder>, <sphere> or <mesh> into it")
        );
    };
    let form = match kind.name() {
        "box" => {
            kind.text_of("size")?;
            Form::Box { size: positive(kind, "size", kind.numbers("size")?.unwrap_or_default())? }
        }
        "cylinder" => Form::Cylinder { radius: length(kind, "radius")?, length: length(kind, "length")? },
        "sphere" => Form::Sphere { radius: length(kind, "radius")? },
        "mesh" => {
            Form::Mesh { file: kind.text_of("filename")?.to_owned(), scale: scale(kind)?, line: kind.line() }
        }
        other => {
            let remedy = "shapes are <box>, <cylinder>, <sphere> and <mesh>";
            return Err(kind.fault(format!("<{other}> is no shape of URDF"), remedy));
        }
    };
    let material = element.one("material")?;
    let colour = material.and_then(|m| rgba(m).or_else(|| colours.get(m.attribute("name")?).copied()));
    Ok(Shape { role, place, form, colour })
}

fn length(element: Element, name: &str) -> Result<f64, Fault> {
    let [length] = positive(element, name, [element.number(name)?])?;
    Ok(length)
}

fn scale(mesh: Element) -> Result<[f64; 3], Fault> {
    let scale = mesh.numbers("scale")?.unwrap_or([1.0; 3]);
    match scale.iter().all(|x| *x != 0.0) {
        true => Ok(scale),
        false => Err(mesh
            .fault("a scale of zero makes a mesh flat", "write scale=\"0.001 0.001 0.001\" for millimetres")),
    }
}

fn positive<const N: usize>(element: Element, name: &str, values: [f64; N]) -> Result<[f64; N], Fault> {
    match values.iter().all(|x| *x > 0.0) {
        true => Ok(values),
        false => Err(element.fault(
            format!("`{name}` of <{}> is not above zero", element.name()),
            "lengths are in m, above zero",
        )),
    }
}
