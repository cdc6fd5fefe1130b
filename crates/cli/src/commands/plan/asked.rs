//! What was asked on the command line as the text of a move, so that the language itself checks numbers and units.

use crate::args::plan::{JointArgs, ToolArgs};

/// A move as text, without its start.
///
/// # Errors
/// A number without its unit.
pub fn joint(args: &JointArgs) -> Result<String, String> {
    Ok(format!(
        "    target: {},\n    velocity: {},\n    acceleration: {},\n",
        list("--to", &args.to, "deg")?,
        quoted(&args.velocity),
        quoted(&args.acceleration)
    ))
}

/// A path of the tool as text, without its start; an arc with `via`.
///
/// # Errors
/// A number without its unit.
pub fn tool(args: &ToolArgs, via: Option<&str>) -> Result<String, String> {
    let mut text = format!("    tool: (\n        target: {},\n", list("--to", &args.to, "mm")?);
    if let Some(via) = via {
        text += &format!("        via: {},\n", list("--via", via, "mm")?);
    }
    text += &format!("        orientation: Text({}),\n", quoted(&args.orientation));
    if let Some(rotation) = &args.rotation {
        text += &format!("        rotation: {},\n", list("--rotation", rotation, "deg")?);
    }
    text += &format!(
        "        velocity: {},\n        acceleration: {},\n        profile: Text({}),\n        resolution: {},\n    ),\n",
        quoted(&args.velocity),
        quoted(&args.acceleration),
        quoted(&args.profile),
        quoted(&args.resolution)
    );
    Ok(text)
}

/// Values between commas as a list of texts. A number other than zero must say its unit, because a bare one would
/// silently be taken for rad or m.
///
/// # Errors
/// The option, the number and a remedy.
pub fn list(option: &str, values: &str, unit: &str) -> Result<String, String> {
    let items: Vec<&str> = values.split(',').map(str::trim).collect();
    for item in &items {
        if item.is_empty() {
            return Err(format!(
                "error: {option} has an empty value\n  = help: write \"1 {unit}, 2 {unit}\""
            ));
        }
        if item.parse::<f64>().is_ok_and(|number| number != 0.0) {
            return Err(format!(
                "error: `{item}` of {option} has no unit\n  = help: write `{item} {unit}`; a decimal comma is written as a \
                 point"
            ));
        }
    }
    Ok(format!("[{}]", items.iter().map(|item| quoted(item)).collect::<Vec<_>>().join(", ")))
}

/// A text of RON.
fn quoted(text: &str) -> String {
    format!("{text:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_become_texts_and_bare_numbers_are_refused() {
        assert_eq!(list("--to", "1 m,-20 mm, 0", "mm").as_deref(), Ok(r#"["1 m", "-20 mm", "0"]"#));
        assert!(list("--to", "60, 30 deg", "deg").unwrap_err().contains("`60` of --to has no unit"));
        assert!(list("--to", "1,05 m", "mm").unwrap_err().contains("decimal comma"));
        assert!(list("--to", "1 m,", "mm").unwrap_err().contains("empty"));
    }
}
