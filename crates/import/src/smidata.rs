//! Numbers of a Simscape Multibody data file: `smiData.Solid(1).mass = 5;  % kg`.
//!
//! The file is a script, but only assignments of numbers and texts to `smiData` are read, each on a line of its own,
//! with the unit in the comment. A later assignment replaces an earlier one: files begin with empty values.

use std::collections::BTreeMap;
use std::path::Path;

use blocksim_multibody::{Inertia, Placement};

use crate::fault::{Fault, keep, shown};
use crate::names::Names;
use crate::numbers::numbers;
use crate::simscape::units::{length, mass};
use crate::write::{Provenance, mass_entries, place_entries, start_entries};
use crate::xml;

/// Solids, transforms and starts of joints, in SI units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SmiData {
    /// Masses of solids.
    pub solids: Vec<Entry<Inertia>>,
    /// Rigid transforms.
    pub transforms: Vec<Entry<Placement>>,
    /// Where joints start.
    pub joints: Vec<Entry<JointStart>>,
    /// What was left out.
    pub notes: Vec<String>,
}

/// Something with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry<T> {
    /// Name of parameters: letters, digits and `_`, each once among its kind.
    pub name: String,
    /// Identification in the file.
    pub id: String,
    /// Line of the first number that counts, from 1.
    pub line: u32,
    /// What the file says.
    pub value: T,
}

/// Where a joint starts.
#[derive(Debug, Clone, PartialEq)]
pub struct JointStart {
    /// Kind of joint as in the file, `RevoluteJoint`.
    pub kind: String,
    /// Translation along x, y and z and rotation about z of the joint, m and rad, as far as the file gives them.
    pub coordinates: [Option<f64>; 4],
}

/// Fields of the coordinates of a joint.
const COORDINATES: [&str; 4] = ["Px.Pos", "Py.Pos", "Pz.Pos", "Rz.Pos"];

/// A value with its unit and line.
type Value<'a> = (&'a str, &'a str, u32);
type Group<'a> = BTreeMap<u32, BTreeMap<&'a str, Value<'a>>>;

/// Reads a data file.
///
/// # Errors
/// All faults of the file: lines that are no assignment, units that are missing or not known, impossible masses.
pub fn read(file: &Path, bytes: &[u8]) -> Result<SmiData, Vec<Fault>> {
    let text = xml::text(file, bytes).map_err(|fault| vec![fault])?.trim_start_matches('\u{feff}');
    let mut faults = Vec::new();
    let mut groups: BTreeMap<&str, Group> = BTreeMap::new();
    for (i, line) in text.lines().enumerate() {
        let number = u32::try_from(i + 1).unwrap_or(u32::MAX);
        let line = line.trim();
        if line.is_empty() || line.starts_with('%') {
            continue;
        }
        let Some((group, index, field, value)) = keep(
            assignment(line).ok_or_else(|| {
                let reason = format!("`{}` is not an assignment to smiData", shown(line));
                let remedy = "only lines such as `smiData.Solid(1).mass = 5;  % kg` are read";
                Fault::new(file, reason, remedy).at(number)
            }),
            &mut faults,
        ) else {
            continue;
        };
        groups.entry(group).or_default().entry(index).or_default().insert(field, (value.0, value.1, number));
    }
    let mut data = SmiData::default();
    // Joints of all kinds are one group.
    let mut joints = Names::new(&[]);
    for (group, members) in &groups {
        match *group {
            "Solid" => {
                let mut names = Names::new(&[]);
                for fields in members.values() {
                    let solid = keep(solid(file, fields), &mut faults).flatten();
                    data.solids.extend(solid.map(|solid| entry(fields, &mut names, solid)));
                }
            }
            "RigidTransform" => {
                let mut names = Names::new(&[]);
                for fields in members.values() {
                    let place = keep(transform(file, fields), &mut faults);
                    data.transforms.extend(place.map(|place| entry(fields, &mut names, place)));
                }
            }
            kind if kind.ends_with("Joint") => {
                for fields in members.values() {
                    let start = keep(joint(file, kind, fields, &mut data.notes), &mut faults);
                    data.joints.extend(start.map(|start| entry(fields, &mut joints, start)));
                }
            }
            other => data.notes.push(format!("left out: smiData.{other} ({} entries)", members.len())),
        }
    }
    if groups.is_empty() && faults.is_empty() {
        faults.push(Fault::new(file, "the file assigns nothing to smiData", "is it the right file?"));
    }
    if faults.is_empty() { Ok(data) } else { Err(faults) }
}

/// Group, index, field, value and unit of `smiData.Solid(1).mass = 5;  % kg`.
fn assignment(line: &str) -> Option<(&str, u32, &str, (&str, &str))> {
    let (left, right) = line.strip_prefix("smiData.")?.split_once('=')?;
    let (group, rest) = left.trim().split_once('(')?;
    let (index, field) = rest.split_once(").")?;
    let right = right.trim();
    // A text may hold `;` and `%`.
    let end = match right.chars().next()? {
        quote @ ('\'' | '"') => 1 + right[1..].find(quote)? + 1,
        _ => right.find(';')?,
    };
    let (value, rest) = right.split_at(end);
    let unit = rest.trim_start().strip_prefix(';')?.trim();
    let unit = if unit.is_empty() { "" } else { unit.strip_prefix('%')?.trim() };
    Some((group.trim(), index.trim().parse().ok()?, field.trim(), (value.trim(), unit)))
}

fn entry<T>(fields: &BTreeMap<&str, Value>, names: &mut Names, value: T) -> Entry<T> {
    let id = fields.get("ID").map_or("", |(value, ..)| value.trim_matches(['\'', '"'])).to_owned();
    let line = fields.iter().filter(|(name, _)| **name != "ID").map(|(_, (_, _, line))| *line).min();
    Entry { name: names.give(&id), id, line: line.unwrap_or(1), value }
}

/// Numbers of a field with a factor for their unit.
fn field<const N: usize>(
    file: &Path,
    fields: &BTreeMap<&str, Value>,
    name: &str,
    factor: impl Fn(&str) -> Option<f64>,
) -> Result<[f64; N], Fault> {
    let Some((value, unit, line)) = fields.get(name) else {
        let (_, _, line) = fields.values().next().copied().unwrap_or(("", "", 1));
        return Err(Fault::new(file, format!("`{name}` is missing"), "add it").at(line));
    };
    let values = numbers::<N>(value.trim_matches(['[', ']']))
        .map_err(|(reason, remedy)| Fault::new(file, format!("`{name}`: {reason}"), remedy).at(*line))?;
    // Zero is zero in all units: files begin with empty values.
    let factor = match factor(unit) {
        Some(factor) => factor,
        None if values.iter().all(|x| *x == 0.0) => 1.0,
        None => {
            let reason = format!("`{name}` has the unit `{}`", shown(unit));
            let remedy =
                "write a unit that is known as a comment behind the value, such as % kg, % mm, % kg*mm^2";
            return Err(Fault::new(file, reason, remedy).at(*line));
        }
    };
    Ok(values.map(|x| x * factor))
}

/// kg*mm^2 and the like.
fn inertia_unit(unit: &str) -> Option<f64> {
    let (kilograms, metres) = unit.split_once('*')?;
    Some(mass(kilograms)? * length(metres.trim().strip_suffix("^2")?)?.powi(2))
}

fn angle_unit(unit: &str) -> Option<f64> {
    match unit {
        "rad" => Some(1.0),
        "deg" => Some(1.0_f64.to_radians()),
        _ => None,
    }
}

fn joint(
    file: &Path,
    kind: &str,
    fields: &BTreeMap<&str, Value>,
    notes: &mut Vec<String>,
) -> Result<JointStart, Fault> {
    let mut coordinates = [None; 4];
    for (coordinate, name) in coordinates.iter_mut().zip(COORDINATES) {
        if fields.contains_key(name) {
            let unit = if name.starts_with('R') { angle_unit } else { length };
            let [value] = field(file, fields, name, unit)?;
            *coordinate = Some(value);
        }
    }
    let others = fields.iter().filter(|(name, _)| !COORDINATES.contains(name) && **name != "ID");
    notes.extend(others.map(|(name, (_, _, line))| format!("line {line}: left out: `{name}` of a {kind}")));
    Ok(JointStart { kind: kind.to_owned(), coordinates })
}

/// `None` for a solid without mass.
fn solid(file: &Path, fields: &BTreeMap<&str, Value>) -> Result<Option<Inertia>, Fault> {
    let line = fields.get("mass").map_or(1, |(_, _, line)| *line);
    let [kilograms] = field(file, fields, "mass", mass)?;
    let com: [f64; 3] = field(file, fields, "CoM", length)?;
    let moments: [f64; 3] = field(file, fields, "MoI", inertia_unit)?;
    let products: [f64; 3] = field(file, fields, "PoI", inertia_unit)?;
    if kilograms == 0.0 && moments == [0.0; 3] && products == [0.0; 3] {
        return Ok(None);
    }
    if kilograms <= 0.0 {
        return Err(Fault::new(file, format!("the mass is {kilograms} kg"), "a mass is above zero").at(line));
    }
    let solid = Inertia::from_moments(kilograms, com, moments, products);
    solid
        .map(Some)
        .map_err(|error| Fault::new(file, error.to_string(), "check the numbers and their units").at(line))
}

fn transform(file: &Path, fields: &BTreeMap<&str, Value>) -> Result<Placement, Fault> {
    let translation: [f64; 3] = field(file, fields, "translation", length)?;
    let [angle] = field(file, fields, "angle", angle_unit)?;
    let axis: [f64; 3] = field(file, fields, "axis", |_| Some(1.0))?;
    let place = Placement::from_axis_angle(translation, axis, angle);
    let clean = |x: f64| if (x - x.round()).abs() < 1e-12 { x.round() } else { x };
    Ok(Placement { rotation: place.rotation.map(clean), ..place })
}

/// The text of a parameter file: `solids`, `transforms` and, where the file has any, `joints`.
pub fn parameters(data: &SmiData, provenance: &Provenance) -> String {
    let solids = group("solids", &data.solids, |solid, out| mass_entries(solid, 12, out));
    let transforms = group("transforms", &data.transforms, |place, out| place_entries(place, 12, out));
    let joints = match data.joints.is_empty() {
        true => String::new(),
        false => group("joints", &data.joints, |start, out| start_entries(start, 12, out)),
    };
    format!("{}(\n{solids}{transforms}{joints})\n", provenance.comment("Solids and transforms"))
}

fn group<T>(name: &str, entries: &[Entry<T>], members: impl Fn(&T, &mut String)) -> String {
    let mut text = format!("    {name}: (\n");
    for Entry { name, id, value, .. } in entries {
        if name != id {
            text.push_str(&format!("        // {}\n", crate::write::line(id)));
        }
        text.push_str(&format!("        {name}: (\n"));
        members(value, &mut text);
        text.push_str("        ),\n");
    }
    text.push_str("    ),\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const TORCH: &str = "% a comment\n%%%VariableName:smiData\n\nsmiData.Solid(1).mass = 0.0;\nsmiData.Solid(1).CoM = [0.0 0.0 0.0];\nsmiData.Solid(1).MoI = [0.0 0.0 0.0];\nsmiData.Solid(1).PoI = [0.0 0.0 0.0];\nsmiData.Solid(1).ID = '';\nsmiData.Solid(1).mass = 5;  % kg\nsmiData.Solid(1).CoM = [-6.5981 89.2022 112.7592];  % mm\nsmiData.Solid(1).MoI = [11039.939 1894.567 11790.502];  % kg*mm^2\nsmiData.Solid(1).PoI = [414.197 89.323 -2574.717];  % kg*mm^2\nsmiData.Solid(1).opacity = 1;\nsmiData.Solid(1).ID = 'Welding_End_Effector*:*Standard';\nsmiData.RigidTransform(2).translation = [0 1 2];  % in\nsmiData.RigidTransform(2).angle = 2.0943951023931953;  % rad\nsmiData.RigidTransform(2).axis = [1 1 1];\nsmiData.RigidTransform(2).ID = \"B[a-1:-:b-1]; % no comment\";\nsmiData.RevoluteJoint(1).Rz.Pos = 90.0;  % deg\nsmiData.Solver(1).step = 1;\n";

    #[test]
    fn numbers_become_si_and_later_lines_win() {
        let data = read(Path::new("a.m"), TORCH.as_bytes()).unwrap();
        let Entry { name, id, line, value: torch } = &data.solids[0];
        assert_eq!(
            (name.as_str(), id.as_str(), *line),
            ("Welding_End_Effector_Standard", "Welding_End_Effector*:*Standard", 9)
        );
        assert_eq!(torch.mass, 5.0);
        assert!((torch.com.z - 0.1127592).abs() < 1e-15);
        assert!((torch.about_com[(0, 1)] + 2574.717e-6).abs() < 1e-15);
        let Entry { id, value: place, .. } = &data.transforms[0];
        assert_eq!(id, "B[a-1:-:b-1]; % no comment");
        assert!((place.translation.y - 0.0254).abs() < 1e-15);
        // A third of a turn about the diagonal takes x to y.
        assert_eq!(place.rotation.column(0).as_slice(), [0.0, 1.0, 0.0]);
        let start =
            JointStart { kind: "RevoluteJoint".into(), coordinates: [None, None, None, Some(FRAC_PI_2)] };
        assert_eq!(data.joints[0].value, start);
        assert_eq!(data.notes, ["left out: smiData.Solver (1 entries)"]);
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_text() {
        let plain = read(Path::new("a.m"), TORCH.as_bytes()).unwrap();
        let marked = read(Path::new("a.m"), format!("\u{feff}{TORCH}").as_bytes()).unwrap();
        assert_eq!(marked.solids, plain.solids);
    }

    #[test]
    fn faults_have_their_lines() {
        for (from, to, line) in [
            ("% kg\n", "% bushels\n", 9),
            ("= 5;  % kg", "= -5;  % kg", 9),
            ("[11039.939", "[99999.0", 9),
            ("112.7592]", "nan]", 10),
            ("smiData.Solid(1).opacity = 1;", "delete('*');", 13),
        ] {
            let faults = read(Path::new("a.m"), TORCH.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert_eq!(faults[0].line, Some(line), "{to}: {}", faults[0]);
        }
    }
}
