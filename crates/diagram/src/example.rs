//! The block of an example alone, for the manual.

use std::path::Path;

use blocksim_block::Interface;

use crate::model::Content;
use crate::resolve::Resolver;
use crate::source::{Reader, Sources};

/// Ports and states of a block that is written as in a diagram: `Gain(k: 2.0)`. Nothing is connected, so kinds, shapes
/// and units are there as far as the parameters fix them. `None` where the block cannot be built alone: it has a
/// mistake, it reads a file, or it is a subsystem.
pub fn example_interface(example: &str) -> Option<Interface> {
    let reader = OneFile(format!("Diagram(blocks: {{ \"block\": {example} }})"));
    let sources = Sources::new(&reader);
    let file = sources.open(Path::new(FILE)).ok()?;
    let (model, _) = Resolver::new(&sources, Vec::new()).top(file)?;
    match &model.block("block")?.content {
        Content::Block { interface, .. } => Some((**interface).clone()),
        Content::Diagram(_) | Content::Unknown => None,
    }
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
