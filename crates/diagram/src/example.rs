//! The block of an example alone, for the manual and for tests over all blocks.

use std::path::Path;
use std::sync::Arc;

use blocksim_block::{Block, Interface};

use crate::model::Content;
use crate::resolve::Resolver;
use crate::source::{Reader, Sources};

/// Ports and states of a block that is written as in a diagram: `Gain(k: 2.0)`. Nothing is connected, so kinds, shapes
/// and units are there as far as the parameters fix them. `None` where the block cannot be built alone: it has a
/// mistake, it reads a file, or it is a subsystem.
pub fn example_interface(example: &str) -> Option<Interface> {
    alone(example, |content| match content {
        Content::Block { interface, .. } => Some((**interface).clone()),
        Content::Diagram(_) | Content::Unknown => None,
    })
}

/// A block that is written as in a diagram, checked and loaded; `None` as for [`example_interface`].
pub fn example_block(example: &str) -> Option<Arc<dyn Block>> {
    alone(example, |content| match content {
        Content::Block { block, .. } => Some(block.clone()),
        Content::Diagram(_) | Content::Unknown => None,
    })
}

fn alone<T>(example: &str, what: impl Fn(&Content) -> Option<T>) -> Option<T> {
    let reader = OneFile(format!("Diagram(blocks: {{ \"block\": {example} }})"));
    let sources = Sources::new(&reader);
    let file = sources.open(Path::new(FILE)).ok()?;
    let (model, _) = Resolver::new(&sources, Vec::new()).top(file)?;
    what(&model.block("block")?.content)
}

const FILE: &str = "example.ron";

/// The only file of a diagram.
struct OneFile(String);

impl Reader for OneFile {
    fn read(&self, path: &Path) -> Result<String, String> {
        if path == Path::new(FILE) { Ok(self.0.clone()) } else { Err("there is only the example".to_owned()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_built_alone_has_no_interface() {
        for example in ["NoSuchKind", "Subsystem(file: \"a.ron\")", "", "Gain(", "}"] {
            assert_eq!(example_interface(example), None, "{example}");
        }
    }
}
