//! What a simulation runs, as data for those who print it.

use blocksim_block::law::Draft;
use blocksim_block::schedule::{Schedule, When};

use crate::evaluation::loops::{Drafts, Form};
use crate::program::fused::Laws;
use crate::program::plan::{Call, Plan};

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

/// How the unknowns of an algebraic loop are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopMethod {
    /// By elimination, with slopes that never change.
    Elimination,
    /// By elimination, with slopes that change.
    VaryingElimination,
    /// By Newton's method with exact slopes.
    Newton,
    /// By Newton's method with slopes by differences.
    Differences,
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
    /// An algebraic loop, whose unknowns are found first.
    Loop {
        /// Its number in the schedule.
        number: usize,
        /// How they are found.
        method: LoopMethod,
        /// What goes round it, where all of its blocks record their laws.
        draft: Option<Box<Draft>>,
    },
    /// Blocks that are called one by one: each with its output group, where it is called for outputs.
    Calls(Vec<(usize, Option<u32>)>),
}

/// Calls that are no part of a program, and the loops among them.
fn called(schedule: &Schedule, calls: &[Call]) -> Vec<PassPart> {
    let mut parts = Vec::new();
    let mut at = 0;
    while let Some(call) = calls.get(at) {
        if let Some(number) = call.begins {
            let found = &schedule.loops[number as usize];
            parts.push(looped(schedule, number as usize));
            at += found.count;
            continue;
        }
        let one = (call.block as usize, Some(call.group));
        match parts.last_mut() {
            Some(PassPart::Calls(calls)) => calls.push(one),
            _ => parts.push(PassPart::Calls(vec![one])),
        }
        at += 1;
    }
    parts
}

fn looped(schedule: &Schedule, number: usize) -> PassPart {
    let drafts = Drafts::new(schedule, &schedule.loops[number]);
    let method = match drafts.as_ref().map(|drafts| drafts.form) {
        None => LoopMethod::Differences,
        Some(Form::Nonlinear) => LoopMethod::Newton,
        Some(Form::Affine) => LoopMethod::VaryingElimination,
        Some(Form::Constant) => LoopMethod::Elimination,
    };
    PassPart::Loop { number, method, draft: drafts.map(|drafts| Box::new(drafts.values)) }
}

/// What a simulation of this diagram runs.
pub fn passes(schedule: &Schedule) -> Vec<Pass> {
    let plan = Plan::new(schedule);
    let laws = Laws::new(schedule, &plan);
    let outputs = |kind: PassKind, calls: &[Call]| {
        let parts = laws.parts(calls, kind == PassKind::Major).into_iter().flat_map(|(range, joined)| {
            let calls = &calls[range];
            match joined {
                Some((draft, when)) => vec![PassPart::Program {
                    draft: Box::new(draft),
                    blocks: calls.iter().map(|call| call.block as usize).collect(),
                    when: Some(when),
                    places: Vec::new(),
                }],
                None => called(schedule, calls),
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
