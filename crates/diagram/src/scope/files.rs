//! Files of values and of diagrams as trees.

use std::path::Path;

use blocksim_block::problem::{FileId, Place, Problem};

use crate::source::Sources;
use crate::tree::Node;

/// Reads a file as a tree.
pub(crate) fn read_tree(sources: &Sources, file: FileId) -> Result<Node, Problem> {
    crate::tree::read(&sources.file(file).text).map_err(|error| error.problem(file))
}

/// A file that cannot be read.
pub(crate) fn missing_file(path: impl AsRef<Path>, reason: &str, place: &Place) -> Problem {
    Problem::error("missing_file", format!("cannot read `{}`: {reason}", path.as_ref().display()))
        .at(place, "named here")
        .help("paths are relative to the file that names them")
}
