//! The schedule as the hot loop wants it: flat, short, without strings.

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use blocksim_block::schedule::{Instance, Schedule, Step, When};
use blocksim_block::{Block, Interface, Scratch};

use crate::program::fused::Fused;
use crate::program::graph::Graph;
use crate::stepping::early::Early;
use crate::stepping::plain::are_plain;

/// A range of indices in half the space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub start: u32,
    pub end: u32,
}

impl Span {
    fn new(start: usize, len: usize) -> Self {
        Self { start: start as u32, end: (start + len) as u32 }
    }

    #[inline]
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    #[inline]
    pub fn len(self) -> usize {
        (self.end - self.start) as usize
    }
}

/// A block and where its values lie.
#[derive(Debug, Clone)]
pub(crate) struct Unit {
    pub block: Arc<dyn Block>,
    pub source: Source,
    /// Which of the plan's copies bring the inputs.
    pub copies: Span,
    /// Start and end of the input ports.
    pub inputs: Arc<[(u32, u32)]>,
    /// Start and end of the output ports.
    pub outputs: Arc<[(u32, u32)]>,
    /// Number of input values.
    pub width: u32,
    pub x: Span,
    pub d: Span,
    pub y: Span,
    pub g: Span,
}

/// How a block gets at its inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// They lie one behind the other, from this cell, before the outputs of the block.
    Below(u32),
    /// They lie one behind the other, this many cells behind the outputs of the block.
    Above(u32),
    /// They have to be copied together, one by one.
    Single,
    /// They have to be copied together, some at a time.
    Scattered,
}

/// Which modes are chosen before an output group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Settles {
    Nothing,
    /// Those that belong to the group.
    Own,
    /// Those of the block, if this is the first of its groups.
    First,
}

impl Settles {
    fn of(interface: &Interface, group: u32) -> Self {
        if !interface.settles_in(group as usize) {
            Self::Nothing
        } else if interface.settling.is_some() {
            Self::Own
        } else {
            Self::First
        }
    }
}

/// Evaluation of one output group.
#[derive(Debug, Clone)]
pub(crate) struct Call {
    pub unit: Unit,
    pub block: u32,
    pub group: u32,
    pub when: When,
    pub settles: Settles,
    /// Whether what comes out of its memory is up to an input, which may have jumped.
    pub reaches: bool,
    /// Number among the calls of a major pass.
    pub number: u32,
    /// The algebraic loop that begins here.
    pub begins: Option<u32>,
}

impl Call {
    /// Whether nothing changes between the hits of a rate.
    fn rests(&self) -> bool {
        matches!(self.when, When::Sampled(_) | When::Constant)
    }
}

/// A block of a sample time that has discrete states to advance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Updated {
    pub block: usize,
    pub rate: usize,
    /// Whether the outputs, derivatives or guards between two hits can see the change.
    pub seen: bool,
}

/// The schedule as the hot loop wants it. Lists of blocks are indices in `units`, in schedule order of blocks.
#[derive(Debug)]
pub(crate) struct Plan {
    pub units: Vec<Unit>,
    /// From where among the signals inputs are brought together, and how many values: in the order of the calls, since one pass
    /// reads most of them, and of long models the cache does not hold them all.
    pub copies: Arc<[(u32, u32)]>,
    /// Everything, for major steps.
    pub major: Vec<Call>,
    /// What changes between major steps.
    pub continuous: Vec<Call>,
    /// What changes between major steps and matters to derivatives and guards.
    pub minor: Vec<Call>,
    /// What changes between major steps and is recorded, or something recorded depends on; absent where that is nearly all.
    pub rows: Option<Vec<Call>>,
    /// Blocks that settle but have no outputs, with their rate.
    pub settling: Vec<(usize, Option<usize>)>,
    pub with_states: Vec<usize>,
    pub implicit: Vec<usize>,
    /// Blocks whose guards can cross zero between major steps.
    pub guarded: Vec<usize>,
    pub jumping: Vec<usize>,
    /// Those of them that jump before the rest of the diagram is evaluated.
    pub early: Early,
    pub accepting: Vec<usize>,
    /// Blocks that want to know of inputs that change between their hits.
    pub noting: Vec<usize>,
    /// Blocks that keep a copy of their outputs.
    pub holding: Vec<usize>,
    pub remembering: Vec<usize>,
    pub timed: Vec<usize>,
    /// Blocks with `pending_event`.
    pub pending: Vec<usize>,
    pub updated: Vec<Updated>,
    /// Blocks that may update between their hits.
    pub subdividing: Vec<usize>,
    /// Whether anything happens at the hits of each rate.
    pub busy: Vec<bool>,
    /// Whether derivatives, guards or memories depend on each block, or are its own.
    pub acting: Vec<bool>,
    /// Whether any block of each rate is such.
    pub bending: Vec<bool>,
    /// Whether outputs change only, and then by jumps, at major steps.
    pub stepwise: bool,
    /// Whether each accepted step must be a major one.
    pub every_step: bool,
    /// Whether steps may be plain, see `stepping/plain.rs`.
    pub plain: bool,
    /// Most input values, and most discrete states, of one block.
    pub widest: (usize, usize),
    /// The passes with laws that are data.
    pub fused: Fused,
}

impl Plan {
    pub fn new(schedule: &Schedule) -> Self {
        let (copies, spans) = copies(schedule);
        let mut layouts = Layouts::new();
        let blocks = schedule.blocks.iter().zip(spans);
        let units: Vec<Unit> = blocks.map(|(block, span)| unit(block, span, &mut layouts)).collect();
        let chosen = |has: &dyn Fn(&Instance) -> bool| -> Vec<usize> {
            schedule.blocks.iter().enumerate().filter(|(_, b)| has(b)).map(|(i, _)| i).collect()
        };
        let loops = schedule.loops.iter().enumerate();
        let loops: BTreeMap<usize, u32> = loops.map(|(ring, found)| (found.first, ring as u32)).collect();
        let settles = |block: u32, group: u32| Settles::of(&schedule.blocks[block as usize].interface, group);
        let steps = schedule.steps.iter();
        let major: Vec<Call> = steps
            .enumerate()
            .map(|(number, &Step { block, group, when, .. })| {
                let unit = units[block as usize].clone();
                let begins = loops.get(&number).copied();
                let settles = settles(block, group);
                let remembers = &schedule.blocks[block as usize];
                let reaches = remembers.interface.remembers.is_some()
                    && remembers.read(group as usize).next().is_some();
                Call { unit, block, group, when, settles, reaches, number: number as u32, begins }
            })
            .collect();
        let between = |minor: bool| {
            let steps = schedule.steps.iter().zip(&major);
            steps
                .filter(|(step, _)| step.when == When::Continuous && (step.minor || !minor))
                .map(|(_, call)| call.clone())
                .collect()
        };
        let has_steps = |i: usize| major.iter().any(|call| call.block as usize == i);
        let updated = updated(schedule);
        let acting = acting(schedule);
        let continuous: Vec<Call> = between(false);
        let mut plan = Self {
            rows: rows(schedule, &continuous),
            continuous,
            minor: between(true),
            settling: chosen(&|b| b.interface.settles)
                .into_iter()
                .filter(|&i| !has_steps(i))
                .map(|i| (i, schedule.blocks[i].rate))
                .collect(),
            with_states: chosen(&|b| !b.interface.states.is_empty()),
            implicit: chosen(&|b| b.interface.implicit),
            guarded: chosen(&|b| b.watched),
            jumping: chosen(&|b| b.interface.jumps),
            early: Early::new(schedule),
            accepting: accepting(schedule),
            noting: chosen(&|b| !b.interface.notes.is_empty()),
            holding: chosen(&|b| b.interface.holds.is_some()),
            remembering: chosen(&|b| b.interface.remembers.is_some()),
            subdividing: chosen(&|b| b.interface.subdivides),
            timed: chosen(&|b| b.interface.time_events),
            pending: chosen(&|b| b.interface.pending_events),
            busy: busy(schedule, &updated),
            bending: bending(schedule, &acting),
            acting,
            updated,
            stepwise: major.iter().any(|call| call.when == When::Major),
            every_step: false,
            plain: false,
            widest: widest(&units),
            fused: Fused::default(),
            units,
            copies,
            major,
        };
        // What settles at the hits of a rate alone needs no other major steps.
        let settles = plan.settling.iter().any(|(_, rate)| rate.is_none())
            || plan.major.iter().any(|call| call.settles != Settles::Nothing && !call.rests());
        plan.every_step = settles || plan.stepwise || !plan.jumping.is_empty() || !plan.accepting.is_empty();
        plan.plain = are_plain(schedule, &plan);
        plan.fused = Fused::new(schedule, &plan);
        plan
    }
}

impl Plan {
    /// Scratch space of all blocks. Of those whose laws are data only some are ever called by themselves.
    pub fn scratch(&self, schedule: &Schedule) -> Vec<Scratch> {
        // Where there are loops, passes between major steps call everything.
        let all = !schedule.loops.is_empty();
        let is_called =
            |block: &Instance| block.law.as_ref().is_none_or(|law| all || !law.updated.is_empty());
        let mut alone: Vec<bool> = schedule.blocks.iter().map(is_called).collect();
        self.early.calls.iter().for_each(|&call| alone[self.major[call].block as usize] = true);
        self.settling.iter().for_each(|(block, _)| alone[*block] = true);
        let units = self.units.iter().zip(alone);
        units.map(|(unit, alone)| if alone { unit.block.scratch() } else { Scratch::default() }).collect()
    }
}

/// Layouts of ports. Most blocks have the same few, which share their place in the cache.
type Layouts = BTreeMap<Vec<(u32, u32)>, Arc<[(u32, u32)]>>;

/// Part of the calls above which it does not matter that others are not needed for rows.
pub(crate) const NEARLY_ALL: f64 = 0.75;

/// The calls that rows between major steps need. Loops are solved as a whole, with all that is around them.
fn rows(schedule: &Schedule, continuous: &[Call]) -> Option<Vec<Call>> {
    if !schedule.loops.is_empty() {
        return None;
    }
    let graph = Graph::new(schedule);
    let recorded = schedule.recorded.iter().filter_map(|recorded| graph.writer(recorded.cell));
    let wanted = graph.behind(recorded.collect());
    let is_wanted = |call: &&Call| wanted.contains(&(call.block as usize, call.group as usize));
    let rows: Vec<Call> = continuous.iter().filter(is_wanted).cloned().collect();
    ((rows.len() as f64) < NEARLY_ALL * continuous.len() as f64).then_some(rows)
}

/// The copies of all blocks in the order in which these are called first, and where those of each are.
fn copies(schedule: &Schedule) -> (Arc<[(u32, u32)]>, Vec<Span>) {
    let mut all = Vec::new();
    let mut spans = vec![None; schedule.blocks.len()];
    let called = schedule.steps.iter().map(|step| step.block as usize);
    for block in called.chain(0..schedule.blocks.len()) {
        spans[block].get_or_insert_with(|| {
            let gather = &schedule.blocks[block].gather;
            all.extend_from_slice(gather);
            Span::new(all.len() - gather.len(), gather.len())
        });
    }
    (all.into(), spans.into_iter().flatten().collect())
}

fn unit(instance: &Instance, copies: Span, layouts: &mut Layouts) -> Unit {
    let mut layout = |ports: &Vec<(u32, u32)>| {
        let known = layouts.entry(ports.clone()).or_insert_with(|| ports.as_slice().into());
        Arc::clone(known)
    };

    let interface = &instance.interface;
    let outputs = instance.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
    let mut unit = Unit {
        block: match &instance.law {
            Some(law) => Arc::clone(law) as Arc<dyn Block>,
            None => Arc::clone(&instance.block),
        },
        source: Source::Scattered,
        copies,
        inputs: layout(&instance.inputs),
        outputs: layout(&instance.outputs),
        width: instance.gather.iter().map(|copy| copy.1).sum(),
        x: Span::new(instance.x, interface.states.len()),
        d: Span::new(instance.d, interface.discrete.len()),
        y: Span::new(instance.y, outputs),
        g: Span::new(instance.g, interface.guards.len()),
    };
    unit.source = source(&unit, &instance.gather);
    unit
}

fn source(unit: &Unit, copies: &[(u32, u32)]) -> Source {
    let first = copies.first().map_or(0, |copy| copy.0);
    let mut next = first;
    let joined = copies.iter().all(|&(from, len)| {
        let fits = from == next;
        next = from + len;
        fits
    });
    let apart = if copies.iter().all(|copy| copy.1 == 1) { Source::Single } else { Source::Scattered };
    if !joined {
        apart
    } else if next <= unit.y.start {
        Source::Below(first)
    } else if first >= unit.y.end {
        Source::Above(first - unit.y.end)
    } else {
        apart
    }
}

/// Blocks that want to know that a step was accepted, for whom that may be news.
fn accepting(schedule: &Schedule) -> Vec<usize> {
    let between = LazyCell::new(|| Between::new(schedule));
    let wants = |b: &Instance| {
        b.interface.accepts
            || b.interface.notes.iter().any(|&port| between.may_change(b, port, &mut HashSet::new()))
    };
    schedule.blocks.iter().enumerate().filter(|(_, b)| wants(b)).map(|(i, _)| i).collect()
}

/// What may change between the hits of a block.
struct Between<'a> {
    schedule: &'a Schedule,
    graph: Graph<'a>,
    /// When the output groups of all blocks are evaluated.
    when: HashMap<(usize, usize), When>,
}

impl<'a> Between<'a> {
    fn new(schedule: &'a Schedule) -> Self {
        let step = |step: &Step| ((step.block as usize, step.group as usize), step.when);
        Self { schedule, graph: Graph::new(schedule), when: schedule.steps.iter().map(step).collect() }
    }

    /// Whether a signal does that comes in at a port of a block, `own` or one before it. Those that have been `seen` add nothing.
    fn may_change(&self, own: &Instance, port: usize, seen: &mut HashSet<usize>) -> bool {
        self.may_cells_change(own, own.gather[port], seen)
    }

    fn may_cells_change(&self, own: &Instance, (from, len): (u32, u32), seen: &mut HashSet<usize>) -> bool {
        let writers: BTreeSet<(usize, usize)> =
            (from as usize..(from + len) as usize).filter_map(|cell| self.graph.writer(cell)).collect();
        writers.into_iter().any(|(block, group)| {
            let before = &self.schedule.blocks[block];
            match self.when.get(&(block, group)) {
                None | Some(When::Constant) => false,
                Some(When::Continuous) => true,
                Some(When::Sampled(rate)) => !self.are_together(*rate as usize, own),
                // It changes when something before it does, if not by itself.
                Some(When::Major) => {
                    let by_itself = before.interface.time_events || !before.interface.states.is_empty();
                    by_itself
                        || before.rate.is_some_and(|rate| !self.are_together(rate, own))
                        || seen.insert(block)
                            && before.gather.iter().any(|cells| self.may_cells_change(own, *cells, seen))
                }
            }
        })
    }

    /// Whether the hits of a rate are hits of a block.
    fn are_together(&self, rate: usize, block: &Instance) -> bool {
        let rates = &self.schedule.clock.rates;
        block.rate.is_some_and(|own| {
            let (own, other) = (&rates[own], &rates[rate]);
            other.period % own.period == 0 && other.offset.abs_diff(own.offset) % own.period == 0
        })
    }
}

fn updated(schedule: &Schedule) -> Vec<Updated> {
    let continues = |block: usize| {
        schedule.steps.iter().any(|step| step.block as usize == block && step.when == When::Continuous)
    };
    let blocks = schedule.blocks.iter().enumerate();
    blocks
        .filter(|(_, b)| !b.interface.discrete.is_empty())
        .filter_map(|(block, b)| {
            let seen = !b.interface.states.is_empty() || !b.interface.guards.is_empty() || continues(block);
            Some(Updated { block, rate: b.rate?, seen })
        })
        .collect()
}

fn busy(schedule: &Schedule, updated: &[Updated]) -> Vec<bool> {
    let mut busy = vec![false; schedule.clock.rates.len()];
    for step in &schedule.steps {
        if let When::Sampled(rate) = step.when {
            busy[rate as usize] = true;
        }
    }
    updated.iter().for_each(|updated| busy[updated.rate] = true);
    busy
}

/// Which blocks have states or watched guards, or outputs on which derivatives, guards or memories depend.
fn acting(schedule: &Schedule) -> Vec<bool> {
    let own = |block: &Instance| !block.interface.states.is_empty() || block.watched;
    let mut acting: Vec<bool> = schedule.blocks.iter().map(own).collect();
    schedule.steps.iter().filter(|step| step.acts).for_each(|step| acting[step.block as usize] = true);
    acting
}

/// Rates at whose hits such a block is called, or one that takes note of accepted steps.
fn bending(schedule: &Schedule, acting: &[bool]) -> Vec<bool> {
    let mut bending = vec![false; schedule.clock.rates.len()];
    for (block, acts) in schedule.blocks.iter().zip(acting) {
        if let Some(rate) = block.rate {
            bending[rate] |= acts | block.interface.accepts;
        }
    }
    for step in schedule.steps.iter().filter(|step| step.acts) {
        if let When::Sampled(rate) = step.when {
            bending[rate as usize] = true;
        }
    }
    bending
}

fn widest(units: &[Unit]) -> (usize, usize) {
    let inputs = units.iter().map(|unit| unit.width as usize).max();
    let discrete = units.iter().map(|unit| unit.d.range().len()).max();
    (inputs.unwrap_or(0), discrete.unwrap_or(0))
}
