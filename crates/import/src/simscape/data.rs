//! Numbers of the data file that belongs to an assembly: masses of parts, frames and starts of joints.
//!
//! What there is and how it hangs together comes from the assembly. A number of the data file counts before that of
//! the assembly; wherever the two differ, a note tells.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use blocksim_multibody::{Inertia, Placement};

use super::apart::{SAME, apart};
use super::framed::Framed;
use super::instances::Instances;
use super::parts::Part;
use crate::smidata::{Entry, JointStart, SmiData};
use crate::write::short;

/// A data file and its name.
#[derive(Debug, Clone, Copy)]
pub struct DataFile<'d> {
    /// The file, for messages.
    pub file: &'d Path,
    /// Its numbers.
    pub data: &'d SmiData,
}

/// Most joints that are looked for, twice as many as an assembly may have.
const MOST: usize = 20_000;
/// Most bytes of paths to instances.
const LARGEST: usize = 64 << 20;
/// Masses and moments likewise, relative.
const SAME_MASS: f64 = 1e-6;

impl DataFile<'_> {
    fn at<T>(&self, entry: &Entry<T>) -> String {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        format!("{name}:{}", entry.line)
    }

    /// Puts the masses of the data file into the parts.
    pub(super) fn weigh(&self, parts: &mut BTreeMap<&str, Part>, notes: &mut Vec<String>) {
        let mut told = BTreeSet::new();
        let named = named(parts);
        for solid in &self.data.solids {
            let at = self.at(solid);
            let Some(uid) = part(parts, &named, &solid.id) else {
                notes.push(format!("{at}: the assembly has no part `{}`: left out", solid.id));
                continue;
            };
            told.insert(uid.to_owned());
            let Some(part) = parts.get_mut(uid.as_str()) else { continue };
            let before = part.inertia.replace(solid.value);
            notes.extend(before.and_then(|before| differs(&part.name, &before, &solid.value, &at)));
        }
        let silent = parts.iter().filter(|(uid, part)| part.inertia.is_some() && !told.contains(**uid));
        let silent: Vec<String> = silent.map(|(_, part)| format!("`{}`", part.name)).collect();
        if !silent.is_empty() {
            notes.push(format!("the data file has no {}: the masses of the assembly count", some(&silent)));
        }
    }

    /// The joints of which the data file has both frames. Fixed places are only compared.
    pub(super) fn joints(&self, instances: &Instances, notes: &mut Vec<String>) -> Vec<Framed> {
        let paths = paths(instances);
        let mut ends: BTreeMap<&str, [Option<&Entry<Placement>>; 2]> = BTreeMap::new();
        let mut strange = Vec::new();
        for transform in &self.data.transforms {
            let named =
                transform.id.split_once('[').and_then(|(kind, rest)| Some((kind, rest.strip_suffix(']')?)));
            match named {
                Some(("B", pair)) => ends.entry(pair).or_default()[0] = Some(transform),
                Some(("F", pair)) => ends.entry(pair).or_default()[1] = Some(transform),
                Some(("RootGround" | "SixDofRigidTransform" | "AssemblyGround", path)) => {
                    match paths.get(path).and_then(|nodes| nodes.get(&0)) {
                        Some(node) => notes.extend(self.moved(transform, *node, instances)),
                        None => strange.push(transform),
                    }
                }
                _ => strange.push(transform),
            }
        }
        let starts: BTreeMap<&str, &JointStart> =
            self.data.joints.iter().map(|joint| (joint.id.as_str(), &joint.value)).collect();
        let mut found = Vec::new();
        for (pair, both) in ends.into_iter().take(MOST) {
            match (between(pair, &paths), both) {
                (Some(between), [Some(base), Some(follower)]) => found.push(Framed {
                    id: pair.to_owned(),
                    between,
                    frames: [
                        instances.nodes[between[0]].place * base.value,
                        instances.nodes[between[1]].place * follower.value,
                    ],
                    start: starts.get(format!("[{pair}]").as_str()).map(|start| (*start).clone()),
                    at: self.at(base),
                }),
                (_, both) => strange.extend(both.into_iter().flatten()),
            }
        }
        strange.sort_by_key(|entry| entry.line);
        if !strange.is_empty() {
            let ids: Vec<String> = strange.iter().map(|entry| format!("`{}`", entry.id)).collect();
            notes.push(format!(
                "{}: the assembly has no place for {}: left out",
                self.at(strange[0]),
                some(&ids)
            ));
        }
        found
    }

    /// An instance that the data file puts elsewhere.
    fn moved(&self, entry: &Entry<Placement>, node: usize, instances: &Instances) -> Option<String> {
        let node = &instances.nodes[node];
        let drawn = instances.nodes[node.around].place.inverse() * node.place;
        apart(&drawn, &entry.value).map(|apart| {
            format!(
                "{}: `{}` stands {apart} from its place in the assembly, which counts: export both files again",
                self.at(entry),
                node.name
            )
        })
    }
}

/// Identifications of parts by their names; `None` where several have one.
fn named(parts: &BTreeMap<&str, Part>) -> BTreeMap<String, Option<String>> {
    let mut named: BTreeMap<String, Option<String>> = BTreeMap::new();
    for (uid, part) in parts {
        let known = named.entry(part.name.clone());
        known.and_modify(|uid| *uid = None).or_insert_with(|| Some((*uid).to_owned()));
    }
    named
}

/// The identification of a part by what the data file calls it.
fn part(parts: &BTreeMap<&str, Part>, named: &BTreeMap<String, Option<String>>, id: &str) -> Option<String> {
    if parts.contains_key(id) {
        return Some(id.to_owned());
    }
    // `Arm*:*Standard`: the part and its configuration.
    let name = id.split_once("*:*").map_or(id, |(name, _)| name);
    named.get(id).or_else(|| named.get(name)).cloned().flatten()
}

/// Instances by their paths, as data files write them (`motor-1:shaft-1`), and by the assembly in which the path begins.
type Paths = BTreeMap<String, BTreeMap<usize, usize>>;

fn paths(instances: &Instances) -> Paths {
    let (mut paths, mut bytes) = (Paths::new(), 0);
    for (at, node) in instances.nodes.iter().enumerate().skip(1) {
        let mut inside = node.around;
        loop {
            let depth = instances.nodes[inside].path.len();
            let path = node.path[depth..].join(":");
            bytes += path.len();
            if bytes > LARGEST {
                return paths;
            }
            paths.entry(path).or_default().entry(inside).or_insert(at);
            if inside == 0 {
                break;
            }
            inside = instances.nodes[inside].around;
        }
    }
    paths
}

/// Both instances of `arm-1:-:hand-1`, in the outermost assembly or in the first one that has both.
fn between(pair: &str, paths: &Paths) -> Option<[usize; 2]> {
    let (base, follower) = pair.split_once(":-:")?;
    let (base, follower) = (paths.get(base)?, paths.get(follower)?);
    base.iter().find_map(|(inside, node)| Some([*node, *follower.get(inside)?]))
}

fn some(names: &[String]) -> String {
    const MOST: usize = 3;
    match names.len() {
        n if n > MOST + 1 => format!("{} and {} others", names[..MOST].join(", "), n - MOST),
        _ => names.join(", "),
    }
}

/// What differs between two masses of a part.
fn differs(name: &str, before: &Inertia, now: &Inertia, at: &str) -> Option<String> {
    let scale = before.about_com.abs().max();
    let what = match () {
        () if (before.mass - now.mass).abs() > SAME_MASS * before.mass => {
            format!("{} kg, in the assembly {} kg", short(now.mass), short(before.mass))
        }
        () if (before.com - now.com).norm() > SAME => {
            format!(
                "its centre of mass {:.3} mm from that in the assembly",
                1e3 * (before.com - now.com).norm()
            )
        }
        () if (before.about_com - now.about_com).abs().max() > SAME_MASS * scale => {
            "another inertia than in the assembly".to_owned()
        }
        () => return None,
    };
    Some(format!("{at}: `{name}` has {what}; the data file counts"))
}
