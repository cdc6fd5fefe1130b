//! The meshes that a mechanism names: found, checked, and measured against the stated masses.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use blocksim_multibody::{Inertia, Placement};
use nalgebra::Vector3;

use crate::fault::{Fault, keep};
use crate::mechanism::{Body, Form, Mechanism, Role};
use crate::names::file_name;
use crate::stl;
use crate::volume::{Solid, solid};

/// A mesh as it goes beside the diagram.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    /// Path below the folder of the diagram, `meshes/link_1.stl`.
    pub name: String,
    /// The file.
    pub bytes: Vec<u8>,
}

/// Most bytes of all meshes together.
const LARGEST: usize = 512 << 20;

/// A shape of a body as it was measured.
struct Measured {
    role: Role,
    /// The mesh as named, and its line; `None` for boxes, cylinders and spheres.
    mesh: Option<(String, u32)>,
    /// What it encloses in the frame of the body; `None` for a mesh that does not exist or is passed on unread.
    solid: Option<Solid>,
}

/// Reads all meshes, renames them in the mechanism to where they go, and gives bodies without mass that of their
/// shapes together at `density` (kg/m³) where a mesh is among them. STL files are checked; those of other kinds are only passed on.
///
/// `read` gets a path and returns the bytes; `file` is the file that names the meshes.
///
/// # Errors
/// Meshes that are damaged or of an unknown kind, bodies that a mesh does not enclose. A mesh that does not exist is a note,
/// unless the mass of its body is wanted; then one that is passed on unread is a fault as well.
pub fn meshes(
    mechanism: &mut Mechanism,
    file: &Path,
    density: Option<f64>,
    read: &dyn Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<Vec<MeshFile>, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut library = Library::default();
    let mut notes = Vec::new();
    for body in &mut mechanism.bodies {
        let wanted = density.is_some() && body.inertia.is_none();
        let mut measured: Vec<Measured> = Vec::new();
        let mut absent = BTreeSet::new();
        for shape in &mut body.shapes {
            let role = shape.role;
            let Form::Mesh { file: named, scale, line } = &mut shape.form else {
                let solid = simple(&shape.form).map(|solid| turned(solid, &shape.place));
                measured.push(Measured { role, mesh: None, solid });
                continue;
            };
            let mesh = Some((named.clone(), *line));
            let is_new = !library.missing.contains_key(named);
            keep(library.fetch(file, named, read).map_err(|fault| fault.at(*line)), &mut faults);
            if library.total > LARGEST {
                return Err(faults);
            }
            if let Some(name) = library.missing.get(named) {
                // All else is drawn and moves without it, unless its mass is wanted.
                let missing = format!("there is no mesh `{named}`, which `{}` looks like", body.original);
                if wanted && absent.insert(named.clone()) {
                    let remedy = "put it there, or state mass and inertia";
                    let _ = keep::<()>(Err(Fault::new(file, missing, remedy).at(*line)), &mut faults);
                } else if is_new {
                    let at = file.display();
                    notes.push(format!("{at}:{line}: {missing}: put it to {name} beside the diagram"));
                }
                *named = name.clone();
                measured.push(Measured { role, mesh, solid: None });
                continue;
            }
            let Some((name, path, bytes)) = library.found.get(named) else { continue };
            let mut enclosed = None;
            if is_stl(path) {
                let Some(triangles) = keep(stl::read(path, bytes), &mut faults) else { continue };
                let solid = solid(&triangles, *scale);
                if solid.bounds.iter().any(|corner| corner.norm() > 100.0) {
                    notes.push(format!(
                        "`{named}` reaches beyond 100 m: is it in millimetres? then its scale is 0.001"
                    ));
                }
                enclosed = Some(turned(solid, &shape.place));
            }
            measured.push(Measured { role, mesh, solid: enclosed });
            *named = name.clone();
        }
        match whole(&measured) {
            Some(parts) => compare(body, &parts, density, file, &mut notes, &mut faults),
            None if wanted && absent.is_empty() => {
                let _ = keep(unread(body, &measured, file), &mut faults);
            }
            None => {}
        }
    }
    mechanism.notes.append(&mut notes);
    match faults.is_empty() {
        true => Ok(library.files()),
        false => Err(faults),
    }
}

/// The meshes that were looked for, by what the file calls them.
#[derive(Default)]
struct Library {
    /// Where each goes, where it was found, and what it holds.
    found: BTreeMap<String, (String, PathBuf, Vec<u8>)>,
    /// Where each would go that does not exist.
    missing: BTreeMap<String, String>,
    names: BTreeSet<String>,
    /// Bytes of all together.
    total: usize,
}

impl Library {
    /// Looks for a mesh, unless it has done so before.
    fn fetch(
        &mut self,
        file: &Path,
        named: &str,
        read: &dyn Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<(), Fault> {
        if self.found.contains_key(named) || self.missing.contains_key(named) {
            return Ok(());
        }
        let Some((path, bytes)) = open(file, named, read)? else {
            let name = place(Path::new(named), &mut self.names);
            self.missing.insert(named.to_owned(), name);
            return Ok(());
        };
        self.total += bytes.len();
        if self.total > LARGEST {
            let reason = format!("the meshes have more than {} MiB together", LARGEST >> 20);
            return Err(Fault::new(file, reason, "export them coarser, or leave them out with --no-meshes"));
        }
        let name = place(&path, &mut self.names);
        self.found.insert(named.to_owned(), (name, path, bytes));
        Ok(())
    }

    fn files(self) -> Vec<MeshFile> {
        self.found.into_values().map(|(name, _, bytes)| MeshFile { name, bytes }).collect()
    }
}

fn is_stl(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("stl"))
}

/// A name of its own for each mesh.
fn place(path: &Path, names: &mut BTreeSet<String>) -> String {
    let stem = file_name(&path.file_stem().unwrap_or_default().to_string_lossy());
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let numbered = (2_u32..).map(|n| format!("meshes/{stem}_{n}.{ending}"));
    let first = std::iter::once(format!("meshes/{stem}.{ending}"));
    first.chain(numbered).find(|name| names.insert(name.clone())).unwrap_or_default()
}

/// Finds a mesh and reads it; `None` if there is none.
fn open(
    file: &Path,
    named: &str,
    read: &dyn Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<Option<(PathBuf, Vec<u8>)>, Fault> {
    const KNOWN: [&str; 6] = ["stl", "dae", "obj", "step", "stp", "ply"];
    let ending = Path::new(named).extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if !ending.is_some_and(|ending| KNOWN.contains(&ending.as_str())) {
        let remedy = "meshes are .stl; .dae, .obj, .ply and .step are passed on unread";
        return Err(Fault::new(file, format!("`{named}` is not a mesh that is known"), remedy));
    }
    let places = places(file, named);
    for path in &places {
        match read(path) {
            Ok(bytes) => return Ok(Some((path.clone(), bytes))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => {
                let reason = format!("the mesh `{}` cannot be read: {error}", path.display());
                return Err(Fault::new(file, reason, "check the file, or leave meshes out with --no-meshes"));
            }
        }
    }
    Ok(None)
}

/// Where a mesh may be: beside the file; one of a ROS package below a folder around the file.
fn places(file: &Path, named: &str) -> Vec<PathBuf> {
    const LEVELS: usize = 5;
    let folder = file.parent().unwrap_or(Path::new(""));
    let Some(inside) = named.strip_prefix("package://") else {
        let plain = named.strip_prefix("file://").unwrap_or(named).replace('\\', "/");
        return vec![folder.join(plain)];
    };
    let rest = inside.split_once('/').map_or(inside, |(_, rest)| rest);
    let around: Vec<PathBuf> = (0..LEVELS).map(|n| folder.join("../".repeat(n))).collect();
    around.iter().flat_map(|folder| [folder.join(inside), folder.join(rest)]).collect()
}

/// What a shape that is no mesh encloses, in its own frame.
fn simple(form: &Form) -> Option<Solid> {
    match form {
        Form::Box { size } => Some(Solid::cuboid(*size)),
        Form::Cylinder { radius, length } => Some(Solid::cylinder(*radius, *length)),
        Form::Sphere { radius } => Some(Solid::sphere(*radius)),
        Form::Mesh { .. } => None,
    }
}

/// From the frame of the shape into that of the body.
fn turned(solid: Solid, place: &Placement) -> Solid {
    let r = place.rotation;
    let [low, high] = solid.bounds;
    let corners = (0..8).map(|i| {
        let pick = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        let corner = place.point(&Vector3::new(pick(0), pick(1), pick(2)));
        [corner, corner]
    });
    Solid {
        centre: place.point(&solid.centre),
        about_centre: r * solid.about_centre * r.transpose(),
        bounds: around(corners),
        ..solid
    }
}

/// The least bounds around others.
fn around(all: impl Iterator<Item = [Vector3<f64>; 2]>) -> [Vector3<f64>; 2] {
    let empty = [Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)];
    all.fold(empty, |[low, high], [least, largest]| [low.inf(&least), high.sup(&largest)])
}

/// The shapes that make up a body: those to be looked at, or those that collide where some of the former could not be measured.
/// `None` where no mesh is among them: simple shapes alone are no image of a body.
fn whole(measured: &[Measured]) -> Option<Vec<(&Measured, Solid)>> {
    [Role::Visual, Role::Collision].into_iter().find_map(|role| {
        let parts = measured.iter().filter(|part| part.role == role);
        let parts = parts.map(|part| Some((part, part.solid?))).collect::<Option<Vec<_>>>()?;
        parts.iter().any(|(part, _)| part.mesh.is_some()).then_some(parts)
    })
}

/// The fault of a body whose mass is wanted, where a mesh was not measured.
fn unread(body: &Body, measured: &[Measured], file: &Path) -> Result<(), Fault> {
    let part = measured.iter().find(|part| part.solid.is_none());
    let Some((named, line)) = part.and_then(|part| part.mesh.as_ref()) else { return Ok(()) };
    let reason =
        format!("`{named}`, which `{}` looks like, is passed on unread, so it gives no mass", body.original);
    Err(Fault::new(file, reason, "export it as .stl, or state mass and inertia").at(*line))
}

/// Holds the stated mass against what the shapes of a body enclose, or takes it from there.
fn compare(
    body: &mut Body,
    parts: &[(&Measured, Solid)],
    density: Option<f64>,
    file: &Path,
    notes: &mut Vec<String>,
    faults: &mut Vec<Fault>,
) {
    match (body.inertia, density) {
        (None, None) => {}
        (None, Some(density)) => body.inertia = keep(filled(body, parts, density, file, notes), faults),
        (Some(inertia), _) => check(body, &inertia, parts, notes),
    }
}

/// The mass of a body that its shapes have together.
fn filled(
    body: &Body,
    parts: &[(&Measured, Solid)],
    density: f64,
    file: &Path,
    notes: &mut Vec<String>,
) -> Result<Inertia, Fault> {
    let name = &body.original;
    let mut total = Inertia::zero();
    for (part, solid) in parts {
        let Some(inertia) = solid.inertia(density).filter(|inertia| inertia.check().is_ok()) else {
            let mesh = part.mesh.as_ref().map_or("", |(named, _)| named);
            let reason = format!("the mesh `{mesh}` of `{name}` has holes: it encloses no volume");
            let fault = Fault::new(file, reason, "repair the mesh, or state mass and inertia");
            return Err(part.mesh.iter().fold(fault, |fault, (_, line)| fault.at(*line)));
        };
        total = total + inertia;
    }
    let from = match parts.len() {
        1 => "its mesh".to_owned(),
        shapes => format!("its {shapes} shapes together"),
    };
    notes.push(format!("`{name}` has no stated mass: {} kg from {from}", total.mass));
    Ok(total)
}

/// Notes where a stated mass cannot be that of what is seen.
fn check(body: &Body, inertia: &Inertia, parts: &[(&Measured, Solid)], notes: &mut Vec<String>) {
    let name = &body.original;
    let [low, high] = around(parts.iter().map(|(_, solid)| solid.bounds));
    let margin = (high - low) * 0.1;
    let inside = (0..3).all(|k| (low[k] - margin[k]..=high[k] + margin[k]).contains(&inertia.com[k]));
    if !inside {
        notes.push(format!("the centre of mass of `{name}` lies outside of its mesh: check units and scale"));
    }
    let density = inertia.mass / parts.iter().map(|(_, solid)| solid.volume.abs()).sum::<f64>();
    // Foam to gold.
    if parts.iter().all(|(_, solid)| solid.closed) && !(10.0..=20_000.0).contains(&density) {
        notes.push(format!("`{name}` would have a density of {density:.3e} kg/m^3: check units and scale"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stl::tests::{as_binary, cuboid};

    const ROBOT: &str = r#"<robot name="r">
  <link name="base"/>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/></joint>
  <link name="arm">
    <visual>
      <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/>
      <geometry><mesh filename="package://robot/meshes/arm.STL" scale="0.001 0.001 0.001"/></geometry>
    </visual>
  </link>
</robot>"#;

    fn disk(path: &Path) -> io::Result<Vec<u8>> {
        match path.to_string_lossy().replace("../", "").as_str() {
            "urdf/meshes/arm.STL" => Ok(as_binary(&cuboid([0.0; 3], [300.0, 100.0, 50.0]))),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    }

    #[test]
    fn a_link_without_mass_gets_that_of_its_mesh_where_it_sits() {
        let file = Path::new("urdf/r.urdf");
        let mut robot = crate::urdf::read(file, ROBOT.as_bytes(), true).unwrap();
        let files = meshes(&mut robot, file, Some(2700.0), &disk).unwrap();
        assert_eq!(files[0].name, "meshes/arm.stl");
        let inertia = robot.bodies[1].inertia.unwrap();
        assert!((inertia.mass - 2700.0 * 0.0015).abs() < 1e-12);
        assert!((inertia.com - Vector3::new(-0.05, 0.15, 1.025)).norm() < 1e-12);
        // long along y now
        let expected = inertia.mass / 12.0 * (0.3_f64.powi(2) + 0.05_f64.powi(2));
        assert!((inertia.about_com[(0, 0)] - expected).abs() < 1e-12);
    }

    #[test]
    fn a_mesh_that_does_not_exist_is_told_with_its_line() {
        let file = Path::new("elsewhere/r.urdf");
        let urdf = |text: &str| crate::urdf::read(file, text.as_bytes(), true).unwrap();
        let robot = urdf(ROBOT);
        assert_eq!(meshes(&mut robot.clone(), file, None, &disk), Ok(Vec::new()), "nothing to write");
        let faults = meshes(&mut robot.clone(), file, Some(1000.0), &disk).unwrap_err();
        assert_eq!(faults[0].line, Some(7));
        let mut known = urdf(&ROBOT.replace("<visual>", "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial><visual>"));
        meshes(&mut known, file, Some(1000.0), &disk).unwrap();
        let told = "elsewhere/r.urdf:7: there is no mesh `package://robot/meshes/arm.STL`, which `arm` looks like: put it to meshes/arm.stl beside the diagram";
        assert_eq!(known.notes, [told]);
        let Form::Mesh { file: named, .. } = &known.bodies[1].shapes[0].form else { panic!("a mesh") };
        assert_eq!(named, "meshes/arm.stl");
    }

    /// Shapes of the arm in place of its mesh, 0.3 x 0.1 x 0.05 m with a corner at the origin.
    fn arm(shapes: &[&str]) -> Mechanism {
        let (start, end) = (ROBOT.find("<visual>").unwrap(), ROBOT.find("</link>\n</robot>").unwrap());
        let text = format!("{}{}{}", &ROBOT[..start], shapes.concat(), &ROBOT[end..]);
        crate::urdf::read(Path::new("urdf/r.urdf"), text.as_bytes(), true).unwrap()
    }

    const MESH: &str =
        "<geometry><mesh filename='package://robot/meshes/arm.STL' scale='0.001 0.001 0.001'/></geometry>";

    #[test]
    fn a_link_without_mass_gets_that_of_all_shapes_that_are_seen() {
        let shapes = [
            &format!("<visual>{MESH}</visual>"),
            &format!("<visual><origin xyz='1 0 0'/>{MESH}</visual>"),
            "<visual><origin xyz='0 0 0.5'/><geometry><box size='0.1 0.1 0.3'/></geometry></visual>",
            &format!("<collision><origin xyz='9 9 9'/>{MESH}</collision>"),
        ];
        let mut robot = arm(&shapes);
        meshes(&mut robot, Path::new("urdf/r.urdf"), Some(1000.0), &disk).unwrap();
        let inertia = robot.bodies[1].inertia.unwrap();
        // 1.5 kg at (0.15, 0.05, 0.025) and at (1.15, 0.05, 0.025), 3 kg at (0, 0, 0.5).
        assert!((inertia.mass - 6.0).abs() < 1e-12, "{inertia:?}");
        let centre = Vector3::new(0.325, 0.025, 0.2625);
        assert!((inertia.com - centre).norm() < 1e-12, "{inertia:?}");
        // Each has m (x^2 + z^2) / 12 of its own, and the parallel axis theorem.
        let own = 2.0 * 1.5 * (0.09 + 0.0025) / 12.0 + 3.0 * (0.01 + 0.09) / 12.0;
        let away = |x: f64, z: f64| (x - centre.x).powi(2) + (z - centre.z).powi(2);
        let expected = own + 1.5 * (away(0.15, 0.025) + away(1.15, 0.025)) + 3.0 * away(0.0, 0.5);
        assert!((inertia.about_com[(1, 1)] - expected).abs() < 1e-12, "{inertia:?}");
        assert_eq!(robot.notes.len(), 1);
        assert!(robot.notes[0].ends_with("kg from its 3 shapes together"), "{:?}", robot.notes);
    }

    #[test]
    fn a_mass_is_not_taken_from_a_part_of_what_is_seen() {
        let read = |path: &Path| match path.ends_with("cap.dae") {
            true => Ok(vec![1]),
            false => disk(path),
        };
        let cap = "<visual>\n<geometry><mesh filename='cap.dae'/></geometry></visual>";
        let seen = format!("<visual>{MESH}</visual>{cap}");
        let file = Path::new("urdf/r.urdf");
        let faults = meshes(&mut arm(&[&seen]), file, Some(1000.0), &read).unwrap_err();
        let told: Vec<_> = faults.iter().map(|fault| (fault.line, fault.reason.as_str())).collect();
        assert_eq!(
            told,
            [(Some(6), "`cap.dae`, which `arm` looks like, is passed on unread, so it gives no mass")]
        );
        assert_eq!(meshes(&mut arm(&[&seen]), file, None, &read).map(|files| files.len()), Ok(2));
        // What collides is measured in its place.
        let mut robot = arm(&[&seen, &format!("<collision>{MESH}</collision>")]);
        meshes(&mut robot, file, Some(1000.0), &read).unwrap();
        assert!((robot.bodies[1].inertia.unwrap().mass - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_stated_mass_is_held_against_all_shapes_that_are_seen() {
        let stated = |mass: f64, x: f64| {
            format!(
                "<inertial><origin xyz='{x} 0 0'/><mass value='{mass}'/>\
                 <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"
            )
        };
        let two = format!("<visual>{MESH}</visual><visual><origin xyz='1 0 0'/>{MESH}</visual>");
        let notes = |mass: f64, x: f64| {
            let mut robot = arm(&[&stated(mass, x), &two]);
            meshes(&mut robot, Path::new("urdf/r.urdf"), None, &disk).unwrap();
            robot.notes
        };
        // 0.003 m^3 from x = 0 to 1.3 m: 15000 kg/m^3, which would be 30000 of the first mesh alone.
        assert_eq!(notes(45.0, 1.1), [""; 0]);
        assert_eq!(notes(75.0, 1.1), ["`arm` would have a density of 2.500e4 kg/m^3: check units and scale"]);
    }

    #[test]
    fn a_mesh_that_does_not_exist_is_missed_by_each_link_whose_mass_it_was_to_give() {
        let link = |name: &str, inertial: &str, line: &str| {
            let mesh = "<geometry><mesh filename='no.stl'/></geometry>";
            format!(
                "<link name='{name}'>{inertial}{line}<visual>{mesh}</visual><collision>{mesh}</collision></link>"
            )
        };
        let inertial = "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
        let joint = |child: &str| {
            format!(
                "<joint name='{child}j' type='continuous'><parent link='base'/><child link='{child}'/></joint>"
            )
        };
        let links =
            [link("a", inertial, ""), link("b", "", "\n"), link("c", "", "\n"), link("d", inertial, "")];
        let joints = ["a", "b", "c", "d"].map(joint);
        let text =
            format!("<robot name='r'><link name='base'/>{}{}</robot>", links.concat(), joints.concat());
        let file = Path::new("r.urdf");
        let mut robot = crate::urdf::read(file, text.as_bytes(), true).unwrap();
        let faults = meshes(&mut robot, file, Some(1000.0), &disk).unwrap_err();
        let told: Vec<_> = faults.iter().map(|fault| (fault.line, fault.reason.as_str())).collect();
        let missing = ["b", "c"].map(|name| format!("there is no mesh `no.stl`, which `{name}` looks like"));
        assert_eq!(told, [(Some(2), missing[0].as_str()), (Some(3), missing[1].as_str())]);
    }

    #[test]
    fn numbers_that_do_not_fit_the_mesh_are_noted() {
        let text = ROBOT.replace(
            "<visual>",
            "<inertial><origin xyz='500 0 0'/><mass value='4'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial><visual>",
        );
        let text = text.replace(" scale=\"0.001 0.001 0.001\"", "");
        let file = Path::new("urdf/r.urdf");
        let mut robot = crate::urdf::read(file, text.as_bytes(), false).unwrap();
        meshes(&mut robot, file, None, &disk).unwrap();
        let notes = robot.notes.join("\n");
        for word in ["millimetres", "outside of its mesh", "density"] {
            assert!(notes.contains(word), "{notes}");
        }
    }
}
