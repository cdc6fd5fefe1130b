//! The laws that blocks record, and what follows from them: which value depends on which.

use std::any::Any;
use std::sync::Arc;

use blocksim_block::law::{BlockLaw, Forms, ValueGroup};
use blocksim_block::problem::Problem;
use blocksim_block::{Block, Interface};
use foldhash::HashMap;

use crate::condition::Conditional;
use crate::flatten::{Flat, FlatBlock};
use crate::infer::Typed;
use crate::problems::Problems;

/// Start and end of ports within the inputs or outputs of a block.
pub(super) type Spans = Vec<(u32, u32)>;

/// What is known of a block beyond its interface.
pub(super) struct Known {
    /// The block as it is run.
    pub block: Arc<dyn Block>,
    pub law: Option<Arc<BlockLaw>>,
    pub inputs: Spans,
    pub outputs: Spans,
}

impl Known {
    /// Its output groups by values, where they are not those of the interface.
    pub fn values(&self) -> Option<&[ValueGroup]> {
        self.law.as_ref().and_then(|law| law.values.as_deref())
    }

    /// The input port that a cell of the inputs belongs to, and which of its elements it is.
    pub fn input(&self, cell: u32) -> Option<(usize, u32)> {
        let port = self.inputs.partition_point(|(_, end)| *end <= cell);
        self.inputs.get(port).map(|(start, _)| (port, cell - start))
    }
}

/// The same of all blocks.
pub(super) struct Laws {
    pub blocks: Vec<Known>,
}

impl Laws {
    /// Has all blocks record their laws that can, and completes their interfaces by them. Those of conditional subsystems run the laws
    /// of the blocks within them.
    pub fn record(flat: &Flat, typed: &mut Typed, problems: &mut Problems) -> Self {
        let mut shared = Shared::default();
        let blocks = flat.blocks.iter().enumerate();
        let known = blocks.map(|(number, block)| {
            let (inputs, outputs) = spans(typed, number, block);
            let mut run = Arc::clone(&block.block);
            let conditional = (&*block.block as &dyn Any).downcast_ref::<Conditional>();
            let recorded = match conditional.zip(typed.asked(number)) {
                Some((conditional, given)) => {
                    let law = conditional.with_law(given, &inputs, &outputs);
                    law.map(|law| {
                        if let Some((block, interface)) = law {
                            run = Arc::new(block);
                            // Types are known already.
                            let Interface { inputs, outputs, .. } =
                                Interface::clone(&typed.interfaces[number]);
                            typed.interfaces[number] = Arc::new(Interface { inputs, outputs, ..interface });
                        }
                        None
                    })
                }
                None => shared.record(&block.block, &mut typed.interfaces[number], &inputs, &outputs),
            };
            let law = recorded.unwrap_or_else(|wrong| {
                let message = format!("the law of the kind {} is wrong: {wrong}", block.kind);
                let problem =
                    Problem::error("law", message).help("this is a mistake in the kind, not in the diagram");
                problems.push(block.place.iter().fold(problem, |problem, place| problem.at(place, "")));
                None
            });
            Known { block: run, law, inputs, outputs }
        });
        Self { blocks: known.collect() }
    }

    /// Takes the output groups of these blocks by values, as far as that makes them finer.
    pub fn split(&mut self, typed: &Typed, blocks: &[usize]) {
        for &number in blocks {
            let known = &mut self.blocks[number];
            let law = known.law.as_ref();
            if let Some(law) = law.and_then(|law| law.by_values(&typed.interfaces[number], &known.inputs)) {
                known.law = Some(Arc::new(law));
            }
        }
    }
}

/// Laws that were recorded, of which those of blocks that are one are one as well.
#[derive(Default)]
struct Shared {
    forms: Forms,
    /// By the block and its interface.
    known: HashMap<(*const (), *const Interface), Law>,
}

/// A law and what follows from it.
struct Law {
    law: Option<Arc<BlockLaw>>,
    inputs: Spans,
    /// The interface of the block, and the same completed. The first is kept so that no other one comes to lie where it is.
    _before: Arc<Interface>,
    completed: Arc<Interface>,
}

impl Shared {
    /// The law of a block whose ports lie so; completes its interface.
    fn record(
        &mut self,
        block: &Arc<dyn Block>,
        interface: &mut Arc<Interface>,
        inputs: &Spans,
        outputs: &Spans,
    ) -> Result<Option<Arc<BlockLaw>>, String> {
        let key = (Arc::as_ptr(block).cast(), Arc::as_ptr(interface));
        let is_shared = Arc::strong_count(interface) > 1;
        if let Some(known) = self.known.get(&key).filter(|known| known.inputs == *inputs) {
            *interface = Arc::clone(&known.completed);
            return Ok(known.law.clone());
        }
        let law = self.forms.record(block, interface, inputs, outputs)?.map(Arc::new);
        let before = is_shared.then(|| Arc::clone(interface));
        if let Some(law) = &law {
            law.complete_in(Arc::make_mut(interface));
        }
        if let Some(before) = before {
            let (inputs, completed) = (inputs.clone(), Arc::clone(interface));
            self.known.insert(key, Law { law: law.clone(), inputs, _before: before, completed });
        }
        Ok(law)
    }
}

/// Where the ports of a block lie among its inputs and outputs.
fn spans(typed: &Typed, number: usize, block: &FlatBlock) -> (Spans, Spans) {
    let interface = &typed.interfaces[number];
    let inputs = interface.inputs.iter().zip(&block.inputs).map(|(input, source)| match source {
        Some(source) => typed.of(source).shape.len(),
        None => input.shape.unwrap_or_default().len(),
    });
    let outputs = interface.outputs.iter().map(|output| output.port_type.shape.len());
    (laid_out(inputs), laid_out(outputs))
}

fn laid_out(lengths: impl Iterator<Item = usize>) -> Spans {
    let mut at = 0;
    let span = |length: usize| {
        let start = at;
        at += length as u32;
        (start, at)
    };
    lengths.map(span).collect()
}
