//! The tree of instances: where each part and each assembly stands.

use std::collections::BTreeMap;

use blocksim_multibody::Placement;
use nalgebra::{Matrix3, Vector3};

use super::units::Units;
use crate::fault::{Fault, keep};
use crate::xml::Element;

/// Most instances of an assembly.
const MOST: usize = 2000;
/// Attributes of an instance that are read.
const KNOWN: [&str; 6] = ["name", "uid", "entityUid", "grounded", "rigid", "rigidGroup"];
/// How far the rows of a rotation may be from orthonormal: nine printed digits.
const ROUNDING: f64 = 1e-6;

/// A part or an assembly at its place. The first one is the world.
#[derive(Debug)]
pub(super) struct Node<'a> {
    /// Identifications from the outermost assembly inwards.
    pub path: Vec<&'a str>,
    pub name: String,
    /// In the world, m.
    pub place: Placement,
    /// The part or assembly that stands here.
    pub entity: &'a str,
    /// Fixed to the assembly around it.
    pub grounded: bool,
    /// An assembly within which nothing moves, whatever it ties.
    pub rigid: bool,
    /// Instances of an assembly of which this is the same do not move against each other.
    pub rigid_group: Option<&'a str>,
    /// The assembly around it.
    pub around: usize,
}

/// Instances by their paths.
#[derive(Debug)]
pub(super) struct Instances<'a> {
    pub nodes: Vec<Node<'a>>,
    index: BTreeMap<Vec<&'a str>, usize>,
}

impl<'a> Instances<'a> {
    /// The instance that a `<...>` with an `<InstancePath>` names, inside of the assembly at `inside`.
    pub fn named(&self, element: Element<'a, '_>, inside: usize) -> Result<usize, Fault> {
        let path = element.need("InstancePath")?;
        // An empty one names the assembly itself, as where something is mated with its origin.
        let own = path.all("Uid").map(|uid| uid.node.text().unwrap_or_default().trim());
        let whole: Vec<&str> = self.nodes[inside].path.iter().copied().chain(own).collect();
        self.index.get(&whole).copied().ok_or_else(|| {
            let reason = format!("there is no instance `{}`", whole.join("/"));
            path.fault(reason, "export the assembly again")
        })
    }
}

pub(super) fn read<'a>(
    root: Element<'a, '_>,
    units: Units,
    notes: &mut Vec<String>,
    faults: &mut Vec<Fault>,
) -> Instances<'a> {
    let world = Node {
        path: Vec::new(),
        name: "world".into(),
        place: Placement::identity(),
        entity: "",
        grounded: true,
        rigid: false,
        rigid_group: None,
        around: 0,
    };
    let mut all = Instances { nodes: vec![world], index: BTreeMap::from([(Vec::new(), 0)]) };
    // Depth is bounded by that of the file.
    let mut open: Vec<(Element, usize)> =
        root.all("InstanceTree").flat_map(|tree| tree.all("Instance")).map(|element| (element, 0)).collect();
    open.reverse();
    while let Some((element, around)) = open.pop() {
        if all.nodes.len() > MOST {
            let fault =
                element.fault(format!("there are more than {MOST} instances"), "simplify the assembly");
            let _ = keep::<()>(Err(fault), faults);
            return all;
        }
        let Some(node) = keep(node(element, &all.nodes[around], around, units), faults) else { continue };
        notes.extend(element.node.attributes().filter(|given| !KNOWN.contains(&given.name())).map(|given| {
            format!(
                "line {}: `{}` of the instance `{}` is not known and left out: if it holds something, that may come loose",
                element.line(),
                given.name(),
                node.name
            )
        }));
        let here = all.nodes.len();
        if all.index.insert(node.path.clone(), here).is_some() {
            let fault = element.fault(
                format!("there are two instances `{}`", node.path.join("/")),
                "export the assembly again",
            );
            let _ = keep::<()>(Err(fault), faults);
        }
        all.nodes.push(node);
        let inner: Vec<_> = element.all("Instance").map(|element| (element, here)).collect();
        open.extend(inner.into_iter().rev());
    }
    all
}

fn node<'a>(
    element: Element<'a, '_>,
    outer: &Node<'a>,
    around: usize,
    units: Units,
) -> Result<Node<'a>, Fault> {
    let name = element.called()?.to_owned();
    let path = outer.path.iter().copied().chain([element.text_of("uid")?]).collect();
    let place = outer.place * placement(element.need("Transform")?, units)?;
    let [grounded, rigid] = [is(element, "grounded")?, is(element, "rigid")?];
    let rigid_group = element.attribute("rigidGroup").filter(|group| !group.trim().is_empty());
    Ok(Node {
        path,
        name,
        place,
        entity: element.text_of("entityUid")?,
        grounded,
        rigid,
        rigid_group,
        around,
    })
}

/// Whether an attribute is true, which it is not unless given.
fn is(element: Element, name: &str) -> Result<bool, Fault> {
    match element.attribute(name).map(str::trim) {
        None | Some("false" | "0") => Ok(false),
        Some("true" | "1") => Ok(true),
        Some(other) => {
            let reason = format!("`{name}` is `{other}`");
            Err(element.fault(reason, format!("write {name}=\"true\" or {name}=\"false\"")))
        }
    }
}

/// `<Rotation>` row by row and `<Translation>`.
pub(super) fn placement(transform: Element, units: Units) -> Result<Placement, Fault> {
    let rotation = transform.need("Rotation")?;
    let matrix = Matrix3::from_row_slice(&rotation.content::<9>()?);
    let error = (matrix.transpose() * matrix - Matrix3::identity()).abs().max();
    if error > ROUNDING || matrix.determinant() < 0.0 {
        return Err(rotation.fault(
            "this is not a rotation",
            "its rows have length 1 and are perpendicular; export the assembly again",
        ));
    }
    let translation = Vector3::from(transform.need("Translation")?.content::<3>()?) * units.length;
    let clean = |x: f64| if (x - x.round()).abs() < 1e-12 { x.round() } else { x };
    Ok(Placement { rotation: matrix.map(clean), translation })
}
