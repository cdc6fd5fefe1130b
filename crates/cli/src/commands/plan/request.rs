//! What was asked on the command line as the text of a move, so that the language itself checks numbers and units.

use crate::args::plan::{JointArgs, ToolArgs};
use crate::failure::Failure;

/// A move as text, without its start.
///
/// # Errors
/// An empty value, or another number of them.
pub fn joint(args: &JointArgs) -> Result<String, Failure> {
    Ok(format!(
        "    target: {},\n    velocity: {},\n    acceleration: {},\n",
        list("--to", &args.to, "deg")?,
        quoted(&united(&args.velocity, "%")),
        quoted(&united(&args.acceleration, "%"))
    ))
}

/// A path of the tool as text, without its start; an arc with `via`.
///
/// # Errors
/// An empty value, or another number of them.
pub fn tool(args: &ToolArgs, via: Option<&str>) -> Result<String, Failure> {
    let mut text = format!("    tool: (\n        target: {},\n", three("--to", &args.to, "mm")?);
    if let Some(via) = via {
        text += &format!("        via: {},\n", three("--via", via, "mm")?);
    }
    text += &format!("        orientation: Text({}),\n", quoted(&args.orientation));
    if let Some(rotation) = &args.rotation {
        text += &format!("        rotation: {},\n", three("--rotation", rotation, "deg")?);
    }
    for (member, value, unit) in [
        ("rotation_velocity", &args.rotation_velocity, "deg/s"),
        ("rotation_acceleration", &args.rotation_acceleration, "deg/s^2"),
    ] {
        if let Some(value) = value {
            text += &format!("        {member}: {},\n", quoted(&united(value, unit)));
        }
    }
    text += &format!(
        "        velocity: {},\n        acceleration: {},\n        profile: Text({}),\n        resolution: {},\n    ),\n",
        quoted(&united(&args.velocity, "mm/s")),
        quoted(&united(&args.acceleration, "%")),
        quoted(&args.profile),
        quoted(&united(&args.resolution, "mm"))
    );
    if let Some(limit) = &args.singular_limit {
        text += &format!("    singular_limit: {},\n", quoted(limit.trim()));
    }
    Ok(text)
}

/// A value as it was typed; a bare number gets the unit that the help of its option names. A file keeps the unit, so that
/// nothing is left to be guessed there, where a bare number is one in SI.
pub fn united(value: &str, unit: &str) -> String {
    let value = value.trim();
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => format!("{value} {unit}"),
        _ => value.to_owned(),
    }
}

/// Values between commas as a list of texts.
///
/// # Errors
/// An empty value: the option and a remedy.
pub fn list(option: &str, values: &str, unit: &str) -> Result<String, Failure> {
    let items: Vec<&str> = values.split(',').map(str::trim).collect();
    if items.iter().any(|item| item.is_empty()) {
        let help = format!("write \"1 {unit}, 2 {unit}\"");
        return Err(Failure::usage(format!("{option} has an empty value")).help(help));
    }
    Ok(format!("[{}]", items.iter().map(|item| quoted(&united(item, unit))).collect::<Vec<_>>().join(", ")))
}

/// Three values between commas.
///
/// # Errors
/// As [`list`], and another number of values.
pub fn three(option: &str, values: &str, unit: &str) -> Result<String, Failure> {
    match values.split(',').count() {
        3 => list(option, values, unit),
        count => Err(Failure::usage(format!("{option} has {count} values, but needs three"))
            .help(format!("write \"1 {unit}, 2 {unit}, 3 {unit}\"; a decimal comma is written as a point"))),
    }
}

/// A text of RON.
pub fn quoted(text: &str) -> String {
    format!("{text:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_become_texts_and_bare_numbers_get_the_unit_of_their_option() {
        let list = |option, text, unit| super::list(option, text, unit).map_err(|failure| failure.text());
        assert_eq!(list("--to", "1 m,-20 mm, 0", "mm").as_deref(), Ok(r#"["1 m", "-20 mm", "0 mm"]"#));
        assert_eq!(
            list("--to", "60, -3e1 ,1 rad", "deg").as_deref(),
            Ok(r#"["60 deg", "-3e1 deg", "1 rad"]"#)
        );
        assert_eq!(list("--to", "NaN, inf", "mm").as_deref(), Ok(r#"["NaN", "inf"]"#));
        assert!(three("--to", "1,05 m, 0, 1", "mm").unwrap_err().text().contains("decimal comma"));
        assert!(list("--to", "1 m,", "mm").unwrap_err().contains("empty"));
    }
}
