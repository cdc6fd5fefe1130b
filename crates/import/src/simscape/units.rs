//! Units of length and mass by the names that CAD programs give them.

use crate::fault::{Fault, shown};
use crate::xml::Element;

/// Factors that make m and kg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    pub length: f64,
    pub mass: f64,
}

/// Metres in a unit of length.
pub(crate) fn length(name: &str) -> Option<f64> {
    Some(match name.trim().to_ascii_lowercase().as_str() {
        "m" | "meter" | "metre" => 1.0,
        "dm" | "decimeter" => 0.1,
        "cm" | "centimeter" | "centimetre" => 0.01,
        "mm" | "millimeter" | "millimetre" => 1e-3,
        "um" | "micrometer" | "micron" => 1e-6,
        "in" | "inch" => 0.0254,
        "ft" | "foot" | "feet" => 0.3048,
        "yd" | "yard" => 0.9144,
        _ => return None,
    })
}

/// Kilograms in a unit of mass. The pound is 0.45359237 kg (1959), the slug 1 lbf s²/ft.
pub(crate) fn mass(name: &str) -> Option<f64> {
    Some(match name.trim().to_ascii_lowercase().as_str() {
        "kg" | "kilogram" => 1.0,
        "g" | "gram" => 1e-3,
        "mg" | "milligram" => 1e-6,
        "t" | "tonne" => 1e3,
        "lb" | "lbm" | "pound" => 0.453_592_37,
        "oz" | "ounce" => 0.453_592_37 / 16.0,
        "slug" => 0.453_592_37 * 9.806_65 / 0.3048,
        _ => return None,
    })
}

/// `<ModelUnits>` or `<DataUnits>` inside of an element, if it is there.
pub(super) fn read(element: Element, name: &'static str) -> Result<Option<Units>, Fault> {
    let Some(units) = element.all(name).next() else { return Ok(None) };
    let factor = |kind: &str, table: fn(&str) -> Option<f64>| {
        let unit = units.text_of(kind)?;
        table(unit).ok_or_else(|| {
            let reason = format!("`{}` is not a unit of {kind} that is known", shown(unit));
            units.fault(reason, "write a unit such as meter, millimeter or inch; kilogram, gram or pound")
        })
    };
    Ok(Some(Units { length: factor("length", length)?, mass: factor("mass", mass)? }))
}
