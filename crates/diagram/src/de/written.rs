//! A written value and where it stands.

use blocksim_block::problem::Problem;

use super::{Expected, Noted, Reading};
use crate::tree::Node;

/// A written value, ready to become whatever is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Written<'n, 'a> {
    pub reading: &'n Reading<'a>,
    pub node: &'n Node,
    pub expected: Expected<'n>,
}

impl<'n, 'a> Written<'n, 'a> {
    pub(crate) fn new(reading: &'n Reading<'a>, node: &'n Node) -> Self {
        Self { reading, node, expected: Expected { field: None, dimension: None } }
    }

    /// Gives the place of this value to a message that has none yet.
    pub(super) fn placed<T>(&self, result: Result<T, Noted>) -> Result<T, Noted> {
        result.map_err(|noted| {
            if noted.0.is_empty() {
                return noted;
            }
            let place = self.reading.place(self.node);
            let name = self.expected.field.map(|field| format!("`{field}`: ")).unwrap_or_default();
            self.reading.note(Problem::error("parameter", format!("{name}{}", noted.0)).at(&place, ""))
        })
    }

    pub(super) fn mismatch<T>(&self, wanted: &str) -> Result<T, Noted> {
        self.placed(Err(Noted(format!("expected {wanted}, found {}", self.node.describe()))))
    }

    pub(super) fn with_node(&self, node: &'n Node) -> Self {
        Self { node, ..*self }
    }
}
