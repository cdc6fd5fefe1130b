//! Assemblies as CAD programs export them for Simscape Multibody (import XML, version 2.0).
//!
//! Parts have masses and geometry, instances have places, and constraints or joints tie them. What constraints hold
//! fast together becomes one group of welded bodies; what they leave free between two groups becomes a joint.

mod apart;
mod constraints;
mod data;
mod framed;
mod frames;
mod freedom;
mod groups;
mod instances;
mod joints;
mod parts;
pub(crate) mod units;

use std::collections::BTreeMap;
use std::path::Path;

use crate::fault::{Fault, keep};
use crate::mechanism::{Body, Mechanism};
use crate::names::Names;
use crate::urdf::TAKEN;
use crate::xml::{self, Element};
use constraints::Constraint;
pub use data::DataFile;
use instances::Instances;
use joints::Stated;
use units::Units;

/// Most constraints and joints of a file.
const MOST: usize = 10_000;

/// Reads an import XML file.
///
/// # Errors
/// All faults of the file: what is no such XML, units that are not known, impossible masses, paths to instances that
/// do not exist.
pub fn read(file: &Path, bytes: &[u8]) -> Result<Mechanism, Vec<Fault>> {
    read_with(file, bytes, None)
}

/// Reads an import XML file with the data file that was exported with it: numbers of the data file count, and notes tell
/// where they differ from those of the assembly.
///
/// # Errors
/// Those of [`read`].
pub fn read_with(file: &Path, bytes: &[u8], data: Option<DataFile>) -> Result<Mechanism, Vec<Fault>> {
    let one = |fault| vec![fault];
    let text = xml::text(file, bytes).map_err(one)?;
    let document = xml::parse(file, text).map_err(one)?;
    let root = Element::root(file, &document);
    if root.name() != "SimscapeMultibodyImportXML" {
        let reason = format!("the outermost element is <{}>, not <SimscapeMultibodyImportXML>", root.name());
        return Err(vec![root.fault(reason, "is it the right file? name its kind with --as")]);
    }
    if root.attribute("version") != Some("2.0") {
        let reason =
            format!("this is version {}, only 2.0 is read", root.attribute("version").unwrap_or("unknown"));
        return Err(vec![root.fault(reason, "export the assembly with a newer plug-in")]);
    }
    let mut faults = Vec::new();
    let mut notes = Vec::new();
    let own = keep(units::read(root, "DataUnits"), &mut faults).flatten();
    let model = keep(units::read(root, "ModelUnits"), &mut faults).flatten();
    let Some(assembly) = keep(root.need("RootAssembly"), &mut faults) else { return Err(faults) };
    let Some(units) = own.or(model) else {
        faults.push(
            root.fault("the units of the file are not stated", "add <ModelUnits mass=\"kg\" length=\"mm\"/>"),
        );
        return Err(faults);
    };
    let mut parts = parts::read(root, own, model, &mut faults);
    let instances = instances::read(assembly, units, &mut notes, &mut faults);
    let mut ties = Ties::default();
    ties.read(assembly, 0, &instances, units, &mut notes, &mut faults);
    let assemblies: BTreeMap<&str, Element> = root
        .all("Assemblies")
        .flat_map(|all| all.all("Assembly"))
        .filter_map(|element| Some((element.attribute("uid")?, element)))
        .collect();
    for (at, node) in instances.nodes.iter().enumerate().skip(1) {
        if let Some(inner) = assemblies.get(node.entity) {
            ties.read(*inner, at, &instances, units, &mut notes, &mut faults);
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let framed = match data {
        Some(data) => {
            data.weigh(&mut parts, &mut notes);
            data.joints(&instances, &mut notes)
        }
        None => Vec::new(),
    };
    let (bodies, body_of) = bodies(&instances, &parts, &mut notes);
    let name = assembly.attribute("name").unwrap_or("assembly").to_owned();
    let mut mechanism = Mechanism { name, bodies, joints: Vec::new(), notes };
    groups::assemble(&mut mechanism, &instances, &body_of, ties, framed);
    Ok(mechanism)
}

/// What ties instances together.
#[derive(Debug, Default)]
pub(crate) struct Ties {
    constraints: Vec<Constraint>,
    stated: Vec<Stated>,
    /// Assemblies that tie their parts themselves; those of others are rigid.
    flexible: Vec<usize>,
}

impl Ties {
    fn read<'a>(
        &mut self,
        assembly: Element<'a, '_>,
        at: usize,
        instances: &Instances<'a>,
        units: Units,
        notes: &mut Vec<String>,
        faults: &mut Vec<Fault>,
    ) {
        let constraints = assembly.all("Constraints").flat_map(|all| all.children());
        for element in constraints {
            if self.constraints.len() + self.stated.len() >= MOST {
                let fault =
                    element.fault(format!("there are more than {MOST} constraints"), "simplify the assembly");
                let _ = keep::<()>(Err(fault), faults);
                return;
            }
            let Some(read) = keep(constraints::read(element, at, instances, units), faults) else { continue };
            match read {
                Some(constraint) => self.constraints.push(constraint),
                None => notes.push(format!(
                    "line {}: the constraint `{}` ({}) is not known and left out: what it holds may come loose",
                    element.line(),
                    element.attribute("name").unwrap_or_default(),
                    element.name()
                )),
            }
        }
        for element in assembly.all("Joints").flat_map(|all| all.children()) {
            if self.stated.len() >= MOST {
                let fault =
                    element.fault(format!("there are more than {MOST} joints"), "simplify the assembly");
                let _ = keep::<()>(Err(fault), faults);
                return;
            }
            let stated = joints::read(element, at, instances, units);
            self.stated.extend(keep(stated, faults));
        }
        let ties = ["Constraints", "Joints"];
        if at == 0 || ties.iter().any(|name| assembly.all(name).any(|all| all.children().next().is_some())) {
            self.flexible.push(at);
        }
    }
}

/// A body for each instance of a part, and which instance it is.
fn bodies(
    instances: &Instances,
    parts: &BTreeMap<&str, parts::Part>,
    notes: &mut Vec<String>,
) -> (Vec<Body>, Vec<Option<usize>>) {
    let mut names = Names::new(&TAKEN);
    let mut bodies = Vec::new();
    let mut body_of = vec![None; instances.nodes.len()];
    for (at, node) in instances.nodes.iter().enumerate().skip(1) {
        let Some(part) = parts.get(node.entity) else { continue };
        if part.inertia.is_none() {
            notes.push(format!("`{}` has no mass: it is a frame only", node.name));
        }
        body_of[at] = Some(bodies.len());
        bodies.push(Body {
            name: names.give(&node.name),
            original: node.name.clone(),
            inertia: part.inertia,
            shapes: part.shapes.clone(),
        });
    }
    (bodies, body_of)
}
