//! What the resolver notes while it builds a model.

use std::cell::RefCell;
use std::rc::Rc;

use blocksim_block::problem::Place;

use crate::ast::Ast;

/// Something that the resolver has found.
pub(crate) enum Event {
    /// A parameter is named.
    Named {
        place: Place,
        /// Where it is declared.
        declared: Place,
    },
    /// A block, at the place of its name, is this diagram.
    Inside { block: Place, ast: Rc<Ast> },
    /// A block, at the place of its name, is one of these, with the places of their names and their kinds.
    Variant { block: Place, alternatives: Vec<(Place, String)> },
}

/// Notes, if somebody asks for them.
#[derive(Default)]
pub(crate) struct Log(RefCell<Option<Vec<Event>>>);

impl Log {
    pub(crate) fn start(&self) {
        self.0.replace(Some(Vec::new()));
    }

    pub(crate) fn is_on(&self) -> bool {
        self.0.borrow().is_some()
    }

    pub(crate) fn note(&self, event: Event) {
        if let Some(events) = self.0.borrow_mut().as_mut() {
            events.push(event);
        }
    }

    pub(crate) fn take(&self) -> Vec<Event> {
        self.0.take().unwrap_or_default()
    }
}
