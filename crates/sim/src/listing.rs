//! What a simulation runs, as data for those who print it.

use blocksim_block::law::Draft;
use blocksim_block::schedule::{Schedule, When};

use crate::fused::Laws;
use crate::plan::{Call, Plan};

/// One of the passes over a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// Which one.
    pub kind: PassKind,
    /// What is run, one after the other.
    pub parts: Vec<PassPart>,
}

/// When a pass is made, and for what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PassKind {
    /// All that is due at a major step.
    Major,
    /// Outputs between major steps, for those who read or record them.
    Between,
    /// The part of these that derivatives and guards depend on.
    Minor,
    /// Derivatives of the continuous states.
    Derivatives,
    /// Values whose zeros are events.
    Guards,
    /// Discrete states at sample hits.
    Updates,
}

/// What is run at once.
#[derive(Debug, Clone, PartialEq)]
pub enum PassPart {
    /// The laws of several blocks as one program.
    Program {
        /// The program and where its values go.
        draft: Box<Draft>,
        /// The blocks whose laws these are, as numbers in the schedule.
        blocks: Vec<usize>,
        /// When it is due.
        when: Option<When>,
        /// Of derivatives and guards, where each value that is wanted anywhere goes.
        places: Vec<u32>,
    },
    /// Blocks that are called one by one: each with its output group, where it is called for outputs.
    Calls(Vec<(usize, Option<u32>)>),
}

/// What a simulation of this diagram runs.
pub fn passes(schedule: &Schedule) -> Vec<Pass> {
    let plan = Plan::new(schedule);
    let laws = Laws::new(schedule, &plan);
    let outputs = |kind: PassKind, calls: &[Call]| {
        let parts = laws.parts(calls, kind == PassKind::Major).into_iter().map(|(range, joined)| {
            let calls = &calls[range];
            match joined {
                Some((draft, when)) => PassPart::Program {
                    draft: Box::new(draft),
                    blocks: calls.iter().map(|call| call.block as usize).collect(),
                    when: Some(when),
                    places: Vec::new(),
                },
                None => PassPart::Calls(
                    calls.iter().map(|call| (call.block as usize, Some(call.group))).collect(),
                ),
            }
        });
        Pass { kind, parts: parts.collect() }
    };
    let gathered = |kind: PassKind, blocks: &[usize], gathered: (Draft, Vec<u32>, Vec<usize>)| {
        let (draft, places, called) = gathered;
        let blocks: Vec<usize> = blocks.iter().copied().filter(|block| !called.contains(block)).collect();
        let mut parts = Vec::new();
        if !blocks.is_empty() {
            parts.push(PassPart::Program { draft: Box::new(draft), blocks, when: None, places });
        }
        if !called.is_empty() {
            parts.push(PassPart::Calls(called.into_iter().map(|block| (block, None)).collect()));
        }
        Pass { kind, parts }
    };
    let updated: Vec<(usize, Option<u32>)> =
        plan.updated.iter().map(|updated| (updated.block, None)).collect();
    let updates = if updated.is_empty() { Vec::new() } else { vec![PassPart::Calls(updated)] };
    vec![
        outputs(PassKind::Major, &plan.major),
        outputs(PassKind::Between, &plan.continuous),
        outputs(PassKind::Minor, &plan.minor),
        gathered(PassKind::Derivatives, &plan.with_states, laws.derivatives()),
        gathered(PassKind::Guards, &plan.guarded, laws.guards()),
        Pass { kind: PassKind::Updates, parts: updates },
    ]
}
