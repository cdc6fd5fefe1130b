//! A written value and where it stands.

use blocksim_block::problem::{Place, Problem};

use super::{Expected, Noted, Reading};
use crate::problems::unknown_member;
use blocksim_syntax::{Name, Node};

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

    /// Whether this is a whole block, whose members are its parameters.
    pub(super) fn is_block(&self) -> bool {
        self.expected.field.is_none() && self.reading.info.is_some()
    }

    /// Refuses a member that a set does not have. Most readers of serde would pass over it.
    pub(super) fn only(&self, members: &[(Name, Node)], known: &[&'static str]) -> Result<(), Noted> {
        if members.iter().any(|(name, _)| name.text.is_empty()) {
            self.reading.offered.replace(known.to_vec());
        }
        let unknown = members.iter().filter(|(name, _)| !known.contains(&name.text.as_str()));
        let within = self.expected.field.map(|field| format!("`{field}`: ")).unwrap_or_default();
        let mut refused = Ok(());
        for (name, _) in unknown {
            let place = Place { file: self.reading.file, span: name.span.clone() };
            refused = Err(self.reading.note(unknown_member(&within, &name.text, place, known)));
        }
        refused
    }

    pub(super) fn with_node(&self, node: &'n Node) -> Self {
        Self { node, ..*self }
    }
}
