//! Conserving ports that are joined, over all levels.

use foldhash::{HashMap, HashMapExt};
use indexmap::IndexSet;
use petgraph::unionfind::UnionFind;

use super::Flat;
use super::view::View;
use crate::ast::ConnectionAst;
use crate::model::Content;

impl View<'_> {
    /// The conserving port of a block of the list that a name leads to.
    fn terminal(&self, level: usize, block: &str, port: &str) -> Option<(usize, String)> {
        let found = self.levels[level].blocks.get(block)?;
        match &found.content {
            Content::Diagram(inner) => {
                let (_, inside) = inner.ast.ports.iter().find(|(name, _)| name.text == port)?;
                let inner_level = self.inside.get(&(level, block.to_owned()))?;
                self.terminal(*inner_level, &inside.block, &inside.port)
            }
            Content::Block { .. } => self.index.get(&(level, block)).map(|index| (*index, port.to_owned())),
            Content::Unknown => None,
        }
    }

    /// Sets of joined conserving ports over all levels: block and port.
    pub(super) fn nodes(&self, flat: &Flat) -> Vec<Vec<(usize, usize)>> {
        let port_of = |(block, port): (usize, String)| {
            let index = flat.blocks[block].interface.ports.iter().position(|known| known.name == port)?;
            Some((block, index))
        };
        // Ports are numbered as they are met.
        let mut ports: IndexSet<(usize, usize)> = IndexSet::new();
        let mut joined: UnionFind<usize> = UnionFind::new_empty();
        for (level, inside) in self.levels.iter().enumerate() {
            for connection in &inside.model.ast.connections {
                let ConnectionAst::Conserving(references) = connection else { continue };
                let mut first = None;
                for reference in references {
                    let terminal = self.terminal(level, &reference.block, &reference.port);
                    let Some(port) = terminal.and_then(port_of) else { continue };
                    let (number, new) = ports.insert_full(port);
                    if new {
                        joined.new_set();
                    }
                    joined.union(*first.get_or_insert(number), number);
                }
            }
        }
        let mut sets: HashMap<usize, Vec<(usize, usize)>> = HashMap::new();
        for (number, port) in ports.iter().enumerate() {
            sets.entry(joined.find(number)).or_default().push(*port);
        }
        let mut sets: Vec<_> = sets.into_values().collect();
        sets.iter_mut().for_each(|set| set.sort_unstable());
        sets.sort();
        sets
    }
}
