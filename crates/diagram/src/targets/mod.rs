//! Everything that `--set` can name: what it is worth, where it is written, and how a text must change to say otherwise.

mod find;
mod site;
mod spelling;
mod walk;

#[cfg(test)]
mod tests;

use blocksim_block::Requirements;
use blocksim_block::problem::{Place, Problem};
use blocksim_signal::Value;

use crate::replacing::WrittenUnit;
use crate::resolve::{Chosen, Instance};
use crate::source::Sources;

pub use find::{Found, below, find};
pub use spelling::{Spelling, spelled};

/// Something that `--set` can name.
#[derive(Debug, Clone)]
pub struct Target {
    /// As `--set` names it: `pid.kp`, `robot.axis1.gear.ring_teeth`, `arm/link3.drive`.
    pub name: String,
    /// What stands in the text, or the default of the kind of block.
    pub written: String,
    /// Its value, where it has one; words such as `Clamping` have none.
    pub value: Option<Value>,
    /// The unit that it is asked in; empty where that follows from use.
    pub unit: String,
    /// The unit in which a number is written, in which a bare one is taken that replaces it.
    pub written_unit: WrittenUnit,
    /// Where it comes from.
    pub origin: Origin,
    /// Where to write another value.
    pub site: Site,
    /// How a value is written there.
    pub spelling: Spelling,
    /// So many parts of the model are made of the text that holds it.
    pub sharers: usize,
    /// An item of a list that is a target itself.
    pub is_item: bool,
    /// What the kind of block requires of it.
    pub requires: Requirements,
}

/// Where a value comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// It is written here.
    Text(Place),
    /// The file of the subsystem says so, as nothing else is given.
    Declared(Place),
    /// The kind of block says so.
    Kind(String),
}

/// Where another value is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Site {
    /// What is replaced; nothing if the span is empty.
    pub place: Place,
    /// What stands before the value.
    pub before: String,
    /// What stands behind it.
    pub after: String,
}

/// All targets of diagrams that were built, in the order of the texts.
pub(crate) fn of_instances<'a>(
    sources: &'a Sources<'a>,
    instances: &[Instance<'a>],
    chosen: &[Chosen<'a>],
) -> Vec<Target> {
    walk::of_instances(sources, instances, chosen)
}

/// All targets of a diagram, or of a file of values, in the order of the texts; and the problems found on the way.
pub fn targets(sources: &Sources, root: &std::path::Path) -> (Vec<Target>, Vec<Problem>) {
    walk::targets(sources, root)
}
