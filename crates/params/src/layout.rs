//! Which quantity stands in which sheet, row and column.
//!
//! The nine sheets and their names are those of the parameter workbook in O. Preuss, "Simulation Model for a Six Axis
//! Articulated Arm Industrial Robot", 2019, table 6.11. There axes are rows; here a quantity is a row and axes are
//! columns, which leaves room for a unit and sources. Bodies and frames, which that workbook leaves to the CAD model,
//! stand in the first sheet; other drives and the controllers beside the drives they belong to.

/// The nine sheets.
pub const SHEETS: [&str; 9] = [
    "(1) General Robot Information",
    "(2) Axis Range Limits",
    "(3) Axis Speed Limits",
    "(4) Axis Acceleration Limits",
    "(5) TCP Limits",
    "(6) Joint Parameters",
    "(7) Motor Parameters",
    "(8) Transmission Parameters",
    "(9) Motor Drivers Parameters",
];

/// The hidden sheet that remembers what was exported.
pub const MEMORY: &str = "blocksim";

/// Number of the sheet, from 0, in which a quantity stands.
pub fn sheet_of(path: &str) -> usize {
    let Some((_, rest)) = axis(path) else {
        return if path.starts_with("tcp_limits.") { 4 } else { 0 };
    };
    let group = rest.split(['.', '[']).next().unwrap_or_default();
    match (group, rest) {
        ("limits", "limits.speed") => 2,
        ("limits", "limits.acceleration") => 3,
        ("limits", _) => 1,
        ("motor" | "asm" | "dc" | "torque", _) => 6,
        ("gear", _) => 7,
        ("driver" | "control", _) => 8,
        _ => 5,
    }
}

/// Takes `axis3.limits.lower` apart; such a quantity has a column for each axis.
pub(crate) fn axis(path: &str) -> Option<(usize, &str)> {
    let (number, rest) = path.strip_prefix("axis")?.split_once('.')?;
    let canonical = number.bytes().all(|byte| byte.is_ascii_digit()) && !number.starts_with('0');
    Some((number.parse().ok().filter(|n| canonical && (1..=MOST_AXES).contains(n))?, rest))
}

/// Most columns for axes.
const MOST_AXES: usize = 64;

/// Longest list with a column for each item; those of longer ones have rows.
pub(crate) const ITEMS: [&str; 3] = ["Value / x", "y", "z"];

/// The path of a cell: the reverse of `rows.rs`, from the texts of a sheet alone. `None` where the row has no such
/// column.
pub(crate) fn path_of(key: &str, heading: &str) -> Option<String> {
    let heading = heading.trim();
    let number = heading.strip_prefix("Axis ").and_then(|n| n.trim().parse::<usize>().ok());
    if let Some(rest) = key.strip_prefix("axis*.") {
        return number.map(|axis| format!("axis{axis}.{rest}"));
    }
    if let Some((axis, _)) = axis(key) {
        return (number == Some(axis)).then(|| key.to_owned());
    }
    let item = ITEMS.iter().position(|item| *item == heading).or((heading == "Value").then_some(0))?;
    match key.strip_suffix("[*]") {
        Some(list) => Some(format!("{list}[{item}]")),
        None => (item == 0).then(|| key.to_owned()),
    }
}

/// Whether a heading is that of a column of values.
pub(crate) fn is_value_heading(heading: &str) -> bool {
    let heading = heading.trim();
    heading == "Value"
        || ITEMS.contains(&heading)
        || heading.strip_prefix("Axis ").is_some_and(|n| n.trim().parse::<usize>().is_ok())
}
