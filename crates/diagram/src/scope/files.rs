//! Files of values and of diagrams as trees.

use std::path::Path;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};

use crate::overrides::COMMAND_LINE;
use crate::problems::not_ron;
use crate::source::Sources;
use blocksim_syntax::Node;

/// Reads a file as a tree.
pub(crate) fn read_tree(sources: &Sources, file: FileId) -> Result<Rc<Node>, Problem> {
    sources.tree(file).map_err(|error| not_ron(error, file))
}

/// A file that cannot be read.
pub(crate) fn missing_file(
    sources: &Sources,
    path: impl AsRef<Path>,
    reason: &str,
    place: &Place,
) -> Problem {
    let is_override = sources.file(place.file).path == Path::new(COMMAND_LINE);
    let help = match is_override {
        true => "paths on the command line are relative to the folder where the program is called",
        false => "paths are relative to the file that names them",
    };
    Problem::error("missing_file", format!("cannot read `{}`: {reason}", path.as_ref().display()))
        .at(place, "named here")
        .help(help)
}
