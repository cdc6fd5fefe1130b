//! The laws of a part as programs, in the order in which they run in a step.

use blocksim_block::law::{BlockLaw, Draft, Joined, Op, Placed, Root};
use blocksim_block::schedule::When;

use crate::part::Selected;
use crate::replay::Start;

/// When a program is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Due {
    /// At each step.
    Always,
    /// At the hits of this rate.
    Rate(usize),
}

/// All that a step runs.
#[derive(Debug)]
pub(crate) struct Programs {
    /// Modes and outputs, then what discrete states become.
    pub steps: Vec<(Due, Draft)>,
    /// Derivatives of the continuous states, which are named by their numbers in the diagram.
    pub derivatives: Option<(Draft, Vec<usize>)>,
}

impl Programs {
    pub fn new(selected: &Selected, start: &Start) -> Self {
        let mut joining = Joining { selected, start, steps: Vec::new(), open: None };
        let mut seen = vec![false; selected.schedule.blocks.len()];
        for step in &selected.steps {
            let when = match step.when {
                When::Constant => continue,
                When::Sampled(rate) => due(selected, rate as usize),
                When::Major | When::Continuous => Due::Always,
            };
            let at = step.block as usize;
            let group = step.group as usize;
            seen[at] = true;
            if let Some(placed) = placed(selected, at) {
                joining.at(when).call(placed, group, true);
            }
        }
        for &at in selected.blocks.iter().filter(|at| selected.block(**at).interface.settles && !seen[**at]) {
            let is_evaluated = selected.steps.iter().any(|step| step.block as usize == at);
            if let Some(placed) = placed(selected, at).filter(|_| !is_evaluated) {
                joining
                    .at(selected.block(at).rate.map_or(Due::Always, |rate| due(selected, rate)))
                    .settle(placed);
            }
        }
        // Behind the outputs of the same rate first, so that they can be one program.
        let mut rates: Vec<usize> =
            selected.blocks.iter().filter_map(|at| selected.block(*at).rate).collect();
        rates.sort_unstable();
        rates.dedup();
        let last = joining.open.as_ref().map(|(due, _)| *due);
        rates.sort_by_key(|rate| Some(due(selected, *rate)) != last);
        for rate in rates {
            for &at in selected.blocks.iter().filter(|at| selected.block(**at).rate == Some(rate)) {
                let changes = |law: &BlockLaw| !law.updated.is_empty();
                if selected.block(at).law.as_deref().is_some_and(changes)
                    && let Some(placed) = placed(selected, at)
                {
                    joining.at(due(selected, rate)).update(placed);
                }
            }
        }
        joining.close();
        Self { steps: joining.steps, derivatives: derivatives(selected, start) }
    }

    /// All programs.
    pub fn drafts(&self) -> impl Iterator<Item = &Draft> {
        let steps = self.steps.iter().map(|(_, draft)| draft);
        steps.chain(self.derivatives.iter().map(|(draft, _)| draft))
    }
}

/// When what samples at a rate is due.
fn due(selected: &Selected, rate: usize) -> Due {
    if selected.divisor(rate) == Some((1, 0)) { Due::Always } else { Due::Rate(rate) }
}

fn placed<'s>(selected: &Selected<'s>, at: usize) -> Option<Placed<'s>> {
    let block = selected.block(at);
    block.law.as_deref().map(|law| Placed::new(law, at, block))
}

fn derivatives(selected: &Selected, start: &Start) -> Option<(Draft, Vec<usize>)> {
    let with_states = selected.blocks.iter().filter(|at| !selected.block(**at).interface.states.is_empty());
    let mut joined = Joined::default();
    for step in selected.steps.iter().filter(|step| step.minor) {
        if let Some(placed) = placed(selected, step.block as usize) {
            joined.call(placed, step.group as usize, false);
        }
    }
    let mut states = Vec::new();
    for &at in with_states {
        let block = selected.block(at);
        if let Some((law, placed)) = block.law.as_deref().zip(placed(selected, at)) {
            joined.values(placed, &law.derivatives);
            states.extend(block.x..block.x + law.derivatives.len());
        }
    }
    let mut draft = joined.finish();
    // Who reads these outputs reads them at the step.
    draft.roots.retain(|root| !matches!(root, Root::Cell(..)));
    (!states.is_empty()).then(|| (bound(draft, selected, start), states))
}

/// Programs on their way.
struct Joining<'j, 's> {
    selected: &'j Selected<'s>,
    start: &'j Start,
    steps: Vec<(Due, Draft)>,
    open: Option<(Due, Joined)>,
}

impl Joining<'_, '_> {
    /// The program that is due then, the last one if it is.
    fn at(&mut self, due: Due) -> &mut Joined {
        if self.open.as_ref().is_none_or(|(of, _)| *of != due) {
            self.close();
        }
        &mut self.open.get_or_insert_with(|| (due, Joined::default())).1
    }

    fn close(&mut self) {
        if let Some((due, joined)) = self.open.take() {
            self.steps.push((due, bound(joined.finish(), self.selected, self.start)));
        }
    }
}

/// A program with the values of all signals that never change on the target.
fn bound(mut draft: Draft, selected: &Selected, start: &Start) -> Draft {
    for instruction in &mut draft.program.instructions {
        if let Op::Input(cell) = instruction.op
            && let Some(value) = constant(selected, start, cell as usize)
        {
            instruction.op = Op::constant(value);
        }
    }
    let wanted = draft.roots.iter().filter(|root| !matches!(root, Root::Met(_)));
    let id = |root: &Root| match *root {
        Root::Cell(id, _) | Root::Held(id, _) | Root::Anywhere(id) | Root::Met(id) => id,
    };
    draft.program.outputs = wanted.clone().map(|root| (String::new(), id(root))).collect();
    let program = draft.program.optimised();
    let moved = wanted.zip(program.output_values()).map(|(root, id)| match *root {
        Root::Cell(_, cell) => Root::Cell(id, cell),
        Root::Held(_, number) => Root::Held(id, number),
        Root::Anywhere(_) | Root::Met(_) => Root::Anywhere(id),
    });
    let mut roots: Vec<Root> = moved.collect();
    roots.extend(program.requirements.iter().map(|id| Root::Met(*id)));
    Draft { program, roots }
}

/// The value of a signal that never changes on the target.
pub(crate) fn constant(selected: &Selected, start: &Start, cell: usize) -> Option<f64> {
    let changes = selected.inputs.contains_key(&cell) || selected.written.contains(&cell);
    (!changes).then(|| start.signals[cell])
}
