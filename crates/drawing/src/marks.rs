//! Blocks that a drawing points at, and the wires between them.

use std::collections::BTreeSet;

use crate::figure::Figure;
use crate::level::Level;

/// What is marked in a drawing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Marks {
    /// Paths of blocks. A subsystem around one of them is marked with it.
    pub blocks: BTreeSet<String>,
}

impl Marks {
    /// Whether a figure stands for one of the blocks, or has one inside.
    pub(crate) fn has(&self, figure: &Figure) -> bool {
        figure.path.as_ref().is_some_and(|path| {
            let inside = format!("{path}/");
            self.blocks.contains(path)
                || self.blocks.range(inside.clone()..).next().is_some_and(|block| block.starts_with(&inside))
        })
    }

    /// Whether a wire leads from one of the blocks to one of them.
    pub(crate) fn has_net(&self, level: &Level, net: usize) -> bool {
        let net = &level.graph.nets[net];
        let mut ends = net.ends.iter().map(|end| self.has(&level.figures[end.node]));
        net.directed && ends.next() == Some(true) && ends.any(|is_marked| is_marked)
    }

    /// The path of the lowest level that has all blocks inside it.
    pub fn level(&self) -> String {
        let above = |path: &str| path.rsplit_once('/').map_or(String::new(), |(above, _)| above.to_owned());
        let mut blocks = self.blocks.iter();
        let mut level = blocks.next().map_or(String::new(), |first| above(first));
        for block in blocks {
            while !level.is_empty() && !block.starts_with(&format!("{level}/")) {
                level = above(&level);
            }
        }
        level
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_of_marks_is_the_lowest_around_all() {
        let level =
            |blocks: &[&str]| Marks { blocks: blocks.iter().map(ToString::to_string).collect() }.level();
        assert_eq!(level(&["a", "b/c"]), "");
        assert_eq!(level(&["arm/link/a", "arm/link/b"]), "arm/link");
        assert_eq!(level(&["arm/link/a", "arm/link2/b"]), "arm");
        assert_eq!(level(&[]), "");
    }
}
