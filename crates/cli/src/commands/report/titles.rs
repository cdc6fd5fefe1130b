//! In which order scopes stand and under which headings, as the author of the model wants it.

use std::collections::HashMap;

use blocksim_diagram::{Content, Model};

/// Names and places of blocks by path.
#[derive(Debug, Default)]
pub struct Titles {
    blocks: HashMap<String, Title>,
}

#[derive(Debug)]
struct Title {
    place: usize,
    label: Option<String>,
    is_scope: bool,
    parent: Option<String>,
}

impl Titles {
    /// Those of a model.
    pub fn of(model: &Model) -> Titles {
        let mut titles = Titles::default();
        titles.gather(model, None);
        titles
    }

    fn gather(&mut self, model: &Model, parent: Option<&String>) {
        for block in &model.blocks {
            let place = self.blocks.len();
            let (label, is_scope) =
                (block.label.clone(), ["Scope", "XyScope"].contains(&block.kind.as_str()));
            let title = Title { place, label, is_scope, parent: parent.cloned() };
            self.blocks.insert(block.path.clone(), title);
            if let Content::Diagram(inside) = &block.content {
                self.gather(inside, block.label.as_ref());
            }
        }
    }

    /// The label of the subsystem that a block stands in.
    pub fn parent(&self, block: &str) -> Option<&str> {
        self.blocks.get(block)?.parent.as_deref()
    }

    /// Whether a block is a scope.
    pub fn is_scope(&self, block: &str) -> bool {
        self.blocks.get(block).is_some_and(|title| title.is_scope)
    }

    /// For sorting: what the author named stands before what has no label, each in the order of the files.
    pub fn rank(&self, block: &str) -> (bool, usize) {
        self.blocks.get(block).map_or((true, usize::MAX), |title| (title.label.is_none(), title.place))
    }
}
