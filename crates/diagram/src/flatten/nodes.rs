//! Conserving ports that are joined, over all levels.

use super::Flat;
use super::view::View;
use crate::ast::ConnectionAst;
use crate::model::Content;

impl View<'_> {
    /// The conserving port of a block of the list that a name leads to.
    fn terminal(&self, level: usize, block: &str, port: &str) -> Option<(usize, String)> {
        let found = self.levels[level].model.block(block)?;
        match &found.content {
            Content::Diagram(inner) => {
                let (_, inside) = inner.ast.ports.iter().find(|(name, _)| name.text == port)?;
                let inner_level = self.inside.get(&(level, block.to_owned()))?;
                self.terminal(*inner_level, &inside.block, &inside.port)
            }
            Content::Block { .. } => {
                self.index.get(&(level, block.to_owned())).map(|index| (*index, port.to_owned()))
            }
            Content::Unknown => None,
        }
    }

    /// Sets of joined conserving ports over all levels.
    pub(super) fn nodes(&self, flat: &Flat) -> Vec<Vec<(usize, usize)>> {
        let port_of = |(block, port): (usize, String)| {
            let index = flat.blocks[block].interface.ports.iter().position(|known| known.name == port)?;
            Some((block, index))
        };
        let mut sets: Vec<Vec<(usize, usize)>> = Vec::new();
        for (level, inside) in self.levels.iter().enumerate() {
            for connection in &inside.model.ast.connections {
                let ConnectionAst::Conserving(joined) = connection else { continue };
                let mut merged: Vec<(usize, usize)> = joined
                    .iter()
                    .filter_map(|reference| self.terminal(level, &reference.block, &reference.port))
                    .filter_map(port_of)
                    .collect();
                let (touching, others) =
                    sets.into_iter().partition(|set: &Vec<_>| set.iter().any(|t| merged.contains(t)));
                sets = others;
                merged.extend(touching.into_iter().flatten());
                merged.sort_unstable();
                merged.dedup();
                sets.push(merged);
            }
        }
        sets.retain(|set| !set.is_empty());
        sets.sort();
        sets
    }
}
