//! Parts: mass, centre of mass, inertia, geometry.

use std::collections::BTreeMap;

use blocksim_multibody::{Inertia, Placement};
use nalgebra::Vector3;

use super::units::{self, Units};
use crate::fault::{Fault, keep};
use crate::mechanism::{Form, Role, Shape};
use crate::xml::Element;

/// A part, in SI units.
#[derive(Debug, Clone, Default)]
pub(super) struct Part {
    pub name: String,
    pub inertia: Option<Inertia>,
    pub shapes: Vec<Shape>,
}

/// All parts by their identification. `data` are the units of all numbers, where the file states them.
pub(super) fn read<'a>(
    root: Element<'a, '_>,
    data: Option<Units>,
    model: Option<Units>,
    faults: &mut Vec<Fault>,
) -> BTreeMap<&'a str, Part> {
    let mut parts = BTreeMap::new();
    for element in root.all("Parts").flat_map(|parts| parts.all("Part")) {
        let Some(uid) = keep(element.text_of("uid"), faults) else { continue };
        let part = keep(part(element, data, model), faults).unwrap_or_default();
        if parts.insert(uid, part).is_some() {
            let fault = element.fault(format!("there are two parts `{uid}`"), "export the assembly again");
            let _ = keep::<()>(Err(fault), faults);
        }
    }
    parts
}

fn part(element: Element, data: Option<Units>, model: Option<Units>) -> Result<Part, Fault> {
    let own = units::read(element, "ModelUnits")?;
    let Some(units) = data.or(own).or(model) else {
        return Err(element
            .fault("the units of this part are not stated", "add <ModelUnits mass=\"kg\" length=\"mm\"/>"));
    };
    let drawn = own.or(model).unwrap_or(units);
    let inertia = match element.one("MassProperties")? {
        Some(properties) => mass(properties, units)?,
        None => None,
    };
    let mut shapes = Vec::new();
    if let Some(geometry) = element.one("GeometryFile")? {
        let file = geometry.text_of("name")?.to_owned();
        let form = Form::Mesh { file, scale: [drawn.length; 3], line: geometry.line() };
        shapes.push(Shape {
            role: Role::Visual,
            place: Placement::identity(),
            form,
            colour: colour(element)?,
        });
    }
    Ok(Part { name: element.attribute("name").unwrap_or_default().to_owned(), inertia, shapes })
}

/// Inertia elements are Ixx, Iyy, Izz, Iyz, Izx, Ixy about the centre of mass; `None` for a part without mass.
fn mass(properties: Element, units: Units) -> Result<Option<Inertia>, Fault> {
    let [mass] = properties.need("Mass")?.content()?;
    let com: [f64; 3] = properties.need("CenterOfMass")?.content()?;
    let tensor = properties.need("Inertia")?;
    let elements: [f64; 6] = tensor.content()?;
    if mass == 0.0 && elements == [0.0; 6] {
        return Ok(None);
    }
    if mass <= 0.0 {
        let remedy = "give the part a material in the CAD program and export it again";
        return Err(properties.fault(format!("the mass is {mass}"), remedy));
    }
    let [xx, yy, zz, yz, zx, xy] = elements.map(|x| x * units.mass * units.length * units.length);
    let com = Vector3::from(com) * units.length;
    let inertia = Inertia::from_moments(mass * units.mass, com, [xx, yy, zz], [yz, zx, xy]);
    inertia.map(Some).map_err(|error| {
        tensor.fault(error.to_string(), "check the units of the file, or export the part again")
    })
}

fn colour(element: Element) -> Result<Option<[f64; 4]>, Fault> {
    let Some(diffuse) = element.all("VisualProperties").flat_map(|p| p.all("Diffuse")).next() else {
        return Ok(None);
    };
    let mut rgba = [1.0; 4];
    for (value, name) in rgba.iter_mut().zip(["r", "g", "b", "a"]) {
        if let Some([x]) = diffuse.numbers(name)? {
            *value = f64::clamp(x, 0.0, 1.0);
        }
    }
    Ok(Some(rgba))
}
