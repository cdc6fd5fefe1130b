//! The kinds of block that are linked into the program.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::{Fields, ParameterInfo, Symbol};

/// A kind of block that can be read from a diagram: typetag finds it by its name in `Kind(parameters)`, and reads what parameters it
/// can. `#[derive(BlockMeta)]` implements it beside a kind.
#[typetag::deserialize]
pub trait Registered {
    /// The parameters as far as they could be read.
    fn fields(self: Box<Self>) -> Box<dyn Fields>;
}

/// What the manual, the error messages and the tools know of a kind. `#[derive(BlockMeta)]` fills it from the
/// source of the block.
#[derive(Debug, Clone, Copy)]
pub struct BlockInfo {
    /// Name in diagrams.
    pub kind: &'static str,
    /// Heading in the manual.
    pub category: &'static str,
    /// What it looks like in drawings.
    pub symbol: Symbol,
    /// The comment above the struct, Markdown.
    pub doc: &'static str,
    /// Parameters in the order of the source, those of groups in their places.
    pub parameters: &'static [ParameterInfo],
    /// Source file, for "view source".
    pub file: &'static str,
    /// Line in the source file.
    pub line: u32,
}

inventory::collect!(BlockInfo);

/// All kinds, by category and name.
pub fn kinds() -> Vec<&'static BlockInfo> {
    let mut kinds: Vec<_> = inventory::iter::<BlockInfo>.into_iter().collect();
    kinds.sort_by_key(|info| (info.category, info.kind));
    kinds
}

impl BlockInfo {
    /// The kind of this name.
    pub fn find(kind: &str) -> Option<&'static BlockInfo> {
        // Compilers ask for every block of a diagram, editors at every keystroke.
        static KINDS: LazyLock<HashMap<&str, &BlockInfo>> = LazyLock::new(|| {
            inventory::iter::<BlockInfo>.into_iter().map(|info| (info.kind, info)).collect()
        });
        KINDS.get(kind).copied()
    }

    /// The `ron` examples in the comment of the kind.
    pub fn examples(&self) -> Vec<&'static str> {
        self.doc.split("```ron").skip(1).filter_map(|rest| rest.split("```").next()).map(str::trim).collect()
    }
}
