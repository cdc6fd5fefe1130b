//! What the library says of kinds, parameters and ports.

use blocksim_block::{BlockInfo, ParameterInfo, in_diagram, kinds};
use blocksim_diagram::HIERARCHY;

use super::Port;

/// Makes text for people of the Markdown of the manual, formulas above all.
pub type Prose = fn(&str) -> String;

/// All kinds, those of the hierarchy included.
pub fn all_kinds() -> Vec<&'static BlockInfo> {
    static OF_HIERARCHY: [BlockInfo; 2] = HIERARCHY;
    OF_HIERARCHY.iter().chain(kinds()).collect()
}

/// A kind by its name.
pub fn kind(name: &str) -> Option<&'static BlockInfo> {
    all_kinds().into_iter().find(|info| info.kind == name)
}

/// `N*m, > 0, default 0`.
pub fn about(parameter: &ParameterInfo) -> String {
    let unit = (!parameter.unit.is_empty()).then(|| parameter.unit.to_owned());
    let default = match parameter.default {
        None => Some("required".to_owned()),
        Some(default) => in_diagram(default).map(|default| format!("default {default}")),
    };
    let range = Some(parameter.range()).filter(|range| !range.is_empty());
    unit.into_iter().chain(range).chain(default).collect::<Vec<_>>().join(", ")
}

/// `output, rad/s`.
pub fn side(port: &Port) -> String {
    if port.unit.is_empty() { port.side.clone() } else { format!("{}, {}", port.side, port.unit) }
}
