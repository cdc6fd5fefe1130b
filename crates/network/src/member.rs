//! What a network is made of.

use std::sync::Arc;

use blocksim_block::Block;
use blocksim_block::physical::{Element, Needs, Part};

/// A block of a network.
#[derive(Debug, Clone)]
pub struct Member {
    /// Path of the block.
    pub path: String,
    /// The block; it has a component.
    pub block: Arc<dyn Block>,
    /// What the component says of itself.
    pub part: Part,
    /// Number of elements of each input port.
    pub input_lengths: Vec<usize>,
    /// Whether anything is connected to each output, or records it.
    pub read: Vec<bool>,
}

impl Member {
    /// Somebody reads an output that depends on voltages and currents.
    pub(crate) fn is_read(&self) -> bool {
        let outputs = self.part.outputs.iter().zip(&self.read);
        outputs.into_iter().any(|((_, needs), read)| *read && *needs != Needs::State)
    }

    /// Somebody reads an output that depends on states alone, as those on voltages and currents do where these are `early`.
    pub(crate) fn is_charge_read(&self, early: bool) -> bool {
        let outputs = self.part.outputs.iter().zip(&self.read);
        let from_states = |needs: Needs| needs == Needs::State || early && needs == Needs::Electrics;
        outputs.into_iter().any(|((_, needs), read)| *read && from_states(*needs))
    }

    /// It keeps an account of the network, and is connected to it at no matter what node.
    pub(crate) fn is_account(&self) -> bool {
        self.part.elements.iter().any(|element| matches!(element, Element::EnergyAccount { .. }))
    }
}

/// A conserving port of a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Terminal {
    /// Index of the member.
    pub member: usize,
    /// Index of the port in its part.
    pub port: usize,
}
