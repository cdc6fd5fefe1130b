//! Finding levels by their paths.

use std::collections::BTreeSet;

use blocksim_diagram::{Content, Model, Sources};

use crate::bus::buses_into;
use crate::level::{Level, level};

/// A path that leads to no level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathError {
    /// The part of the path that was found.
    pub found: String,
    /// The name that is not there, or has nothing inside.
    pub name: String,
    /// The block is there, but it is no subsystem.
    pub is_block: bool,
    /// Subsystems that could be meant.
    pub subsystems: Vec<String>,
}

/// The level at a path such as `arm/link1`; the top for an empty one.
///
/// # Errors
/// Where the path leads to nothing or to a block without inside.
pub fn level_at(model: &Model, sources: &Sources, path: &str) -> Result<Level, PathError> {
    let (mut at, mut buses) = (model, BTreeSet::new());
    for name in path.split('/').filter(|name| !name.is_empty()) {
        let inside = at.block(name).and_then(|block| match &block.content {
            Content::Diagram(inside) => Some(inside),
            _ => None,
        });
        let Some(inside) = inside else {
            let subsystem =
                |block: &&blocksim_diagram::ModelBlock| matches!(block.content, Content::Diagram(_));
            return Err(PathError {
                found: at.path.clone(),
                name: name.to_owned(),
                is_block: at.block(name).is_some(),
                subsystems: at.blocks.iter().filter(subsystem).map(|block| block.name.clone()).collect(),
            });
        };
        buses = buses_into(at, name, &buses);
        at = inside;
    }
    Ok(level(at, sources, &buses))
}

/// All levels, each before those inside it, in the order of the files.
pub fn all_levels(model: &Model, sources: &Sources) -> Vec<Level> {
    let mut levels = Vec::new();
    let mut open = vec![(model, BTreeSet::new())];
    while let Some((model, buses)) = open.pop() {
        levels.push(level(model, sources, &buses));
        for block in model.blocks.iter().rev() {
            if let Content::Diagram(inside) = &block.content {
                open.push((inside, buses_into(model, &block.name, &buses)));
            }
        }
    }
    levels
}
