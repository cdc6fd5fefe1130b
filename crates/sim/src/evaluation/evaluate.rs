//! The hot loop: gather the inputs of a block, call its outputs, next.

use std::ops::Range;
use std::sync::Arc;

use blocksim_block::schedule::{Schedule, When};
use blocksim_block::{Block, Context, Fault, Resolution, Scratch};
use blocksim_solve::Failed;

use crate::evaluation::loops::{Loops, Pass};
use crate::evaluation::stepwise::Stepwise;
use crate::events::looks::Looks;
use crate::program::fused::Part;
use crate::program::plan::{Call, Plan, Settles, Source, Span, Unit};

/// Everything that the evaluation of a diagram needs and changes, except time and states, which belong to whoever
/// asks for it.
pub(crate) struct Diagram {
    pub schedule: Arc<Schedule>,
    pub plan: Plan,
    /// Outputs of all blocks, then the values of unconnected inputs.
    pub signals: Vec<f64>,
    /// Discrete states of all blocks.
    pub d: Vec<f64>,
    pub(crate) now: Now,
    pub(crate) scratch: Vec<Scratch>,
    pub settle: Settling,
    pub loops: Loops,
    /// Guards at the stages of the solver.
    pub looks: Looks,
    pub stepwise: Stepwise,
    /// Derivatives that nobody asked for.
    pub(crate) unused: Vec<f64>,
    /// Blocks whose constant outputs were set from outside and are not evaluated.
    pub pinned: Vec<usize>,
    /// The first failure, until someone takes it.
    pub failure: Option<Failure>,
}

/// What is remembered of the choice of branches.
pub(crate) struct Settling {
    /// Evaluation in which each block settled last.
    last: Vec<u64>,
    /// Discrete states of one block before it settles.
    before: Vec<f64>,
    /// Whether a block chose another branch since this was last cleared.
    pub changed: bool,
}

/// The point at which the diagram is evaluated.
pub(crate) struct Now {
    pub t: f64,
    pub x: Vec<f64>,
    /// Inputs of the block at hand.
    pub u: Vec<f64>,
    /// What brings the inputs of all blocks together.
    copies: Arc<[(u32, u32)]>,
    pub evaluation: u64,
    /// Seed of the run.
    pub resolution: Resolution,
    pub seed: u64,
    pub fault: Fault,
    /// How much of the signals belongs to `t`, `x` and the discrete states.
    pub known: Known,
    /// Whether the derivatives have been evaluated, too.
    pub derived: bool,
}

/// How much of the signals is up to date.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Known {
    Nothing,
    Minor,
    Continuous,
}

/// A block that could not go on.
pub(crate) struct Failure {
    pub block: usize,
    pub t: f64,
    pub reason: String,
    /// The algebraic loop that could not be solved.
    pub ring: Option<usize>,
}

impl Now {
    /// What a block sees. Its inputs are brought together if they do not lie so already.
    #[inline]
    pub fn context<'a>(&'a mut self, unit: &'a Unit, signals: &'a [f64], d: &'a [f64]) -> Context<'a> {
        let width = unit.width as usize;
        let u = match unit.source {
            Source::Below(from) => &signals[from as usize..][..width],
            Source::Above(from) => &signals[(unit.y.end + from) as usize..][..width],
            Source::Single => {
                self.pick(unit.copies, signals);
                &self.u[..width]
            }
            Source::Scattered => {
                self.gather(unit.copies, signals);
                &self.u[..width]
            }
        };
        Context {
            t: self.t,
            x: &self.x[unit.x.range()],
            d,
            u,
            inputs: &unit.inputs,
            outputs: &unit.outputs,
            evaluation: self.evaluation,
            resolution: self.resolution,
            seed: self.seed,
            fault: &self.fault,
        }
    }

    /// Brings the inputs of a block together, all of which are apart.
    #[inline(always)]
    fn pick(&mut self, copies: Span, signals: &[f64]) {
        for (u, &(from, _)) in self.u.iter_mut().zip(&self.copies[copies.range()]) {
            *u = signals[from as usize];
        }
    }

    /// Brings the inputs of a block together.
    #[inline(always)]
    fn gather(&mut self, copies: Span, signals: &[f64]) {
        let mut at = 0;
        for &(from, len) in &self.copies[copies.range()] {
            let (from, len) = (from as usize, len as usize);
            if len == 1 {
                self.u[at] = signals[from];
            } else {
                self.u[at..at + len].copy_from_slice(&signals[from..from + len]);
            }
            at += len;
        }
    }

    fn is_at(&self, t: f64, x: &[f64]) -> bool {
        self.t == t && self.x == x
    }
}

impl Diagram {
    pub fn new(schedule: Arc<Schedule>) -> Self {
        let plan = Plan::new(&schedule);
        let (inputs, discrete) = plan.widest;
        let mut signals = schedule.initial_signals.clone();
        plan.fused.make_room(&mut signals);
        Self {
            signals,
            d: vec![0.0; schedule.discrete],
            now: Now {
                t: 0.0,
                x: vec![0.0; schedule.states],
                u: vec![0.0; inputs],
                copies: Arc::clone(&plan.copies),
                evaluation: 0,
                resolution: Resolution::new(schedule.settings.stop_time),
                seed: schedule.settings.seed,
                fault: Fault::default(),
                known: Known::Nothing,
                derived: false,
            },
            scratch: plan.scratch(&schedule),
            settle: Settling { last: vec![0; plan.units.len()], before: vec![0.0; discrete], changed: false },
            loops: Loops::new(&schedule, &plan.fused),
            looks: Looks::default(),
            stepwise: Stepwise::new(&schedule),
            unused: vec![0.0; schedule.states],
            pinned: Vec::new(),
            failure: None,
            plan,
            schedule,
        }
    }

    /// A major pass: settles and evaluates everything that changes at this instant; `due` tells which rates are hit,
    /// `first` whether constants are evaluated, too.
    pub fn major(&mut self, t: f64, x: &[f64], due: &[bool], first: bool) -> Result<(), Failed> {
        self.enter(t, x);
        if self.pinned.is_empty() {
            self.major_parts(due, first)?;
        } else {
            let mut call = 0;
            while call < self.plan.major.len() {
                call = self.call(call, due, first)?;
            }
        }
        let Self { plan, now, signals, d, settle, .. } = self;
        for &(block, rate) in &plan.settling {
            if rate.is_none_or(|rate| due[rate]) {
                settle.run(block, &plan.units[block], now, signals, d);
                if now.fault.is_raised() {
                    return Err(self.failed(block));
                }
            }
        }
        // Solutions of loops are found once more, from themselves: as they are by who goes on from a snapshot.
        now.known = if self.loops.rings.is_empty() { Known::Continuous } else { Known::Nothing };
        Ok(())
    }

    /// All calls of a major pass, those whose laws are data at once.
    fn major_parts(&mut self, due: &[bool], first: bool) -> Result<(), Failed> {
        self.plan.fused.place(self.now.t, &self.now.x, &mut self.signals);
        let mut call = 0;
        for part in 0..self.plan.fused.major.len() {
            match &self.plan.fused.major[part] {
                Part::Calls(calls) => {
                    let end = calls.end;
                    while call < end {
                        call = self.call(call, due, first)?;
                    }
                }
                Part::Tape(tape, calls, when) => {
                    let wanted = match *when {
                        When::Continuous | When::Major => true,
                        When::Sampled(rate) => due[rate as usize],
                        When::Constant => first,
                    };
                    let end = calls.end;
                    if wanted {
                        let met = tape.run(&mut self.signals, &mut self.d);
                        self.settle.changed |= met.changed;
                        while met.failed.is_some() && call < end {
                            // Once more, to find out which block it was.
                            call = self.call(call, due, first)?;
                        }
                    }
                    call = end;
                }
            }
        }
        Ok(())
    }

    /// One call of a major pass, or the whole loop that it begins, if it is its time. Returns the call behind.
    #[inline(always)]
    pub(crate) fn call(&mut self, at: usize, due: &[bool], first: bool) -> Result<usize, Failed> {
        let Self { plan, now, signals, d, scratch, settle, pinned, .. } = self;
        let call = &plan.major[at];
        let wanted = match call.when {
            When::Continuous | When::Major => true,
            When::Sampled(rate) => due[rate as usize],
            When::Constant => first && !pinned.contains(&(call.block as usize)),
        };
        if let Some(ring) = call.begins {
            return self.call_loop(at, ring as usize, wanted);
        }
        if wanted {
            let block = call.block as usize;
            match call.settles {
                Settles::Nothing => (),
                Settles::First if settle.last[block] == now.evaluation => (),
                Settles::First | Settles::Own => settle.before(call, now, signals, d),
            }
            if call.reaches {
                // Who reads it at this instant is not to see what lies between what came out before and what does now.
                let unit = &plan.units[block];
                unit.block.reach(&now.context(unit, signals, &[]), &mut d[unit.d.range()]);
            }
            outputs(call, now, signals, d, scratch);
            if now.fault.is_raised() {
                return Err(self.failed(block));
            }
        }
        Ok(at + 1)
    }

    #[cold]
    fn call_loop(&mut self, first: usize, ring: usize, wanted: bool) -> Result<usize, Failed> {
        if wanted {
            self.settle_loop(ring)?;
        }
        Ok(first + self.loops.rings[ring].count)
    }

    /// Evaluates what changes between major steps; discrete states, sampled outputs and branches are held.
    pub fn continuous(&mut self, t: f64, x: &[f64]) -> Result<(), Failed> {
        self.held(t, x, Known::Continuous)
    }

    /// The part of [`continuous`](Self::continuous) that what is recorded depends on. Nobody takes other signals for known.
    pub fn for_row(&mut self, t: f64, x: &[f64]) -> Result<(), Failed> {
        if self.plan.rows.is_none() || self.now.known == Known::Continuous && self.now.is_at(t, x) {
            return self.continuous(t, x);
        }
        self.enter(t, x);
        if self.parts(|plan| (&plan.fused.rows, plan.rows.as_deref().unwrap_or_default())) {
            return Ok(());
        }
        // Once more, to find out which block it was.
        let Self { plan, now, signals, d, scratch, .. } = self;
        now.evaluation += 1;
        for call in plan.rows.iter().flatten() {
            outputs(call, now, signals, d, scratch);
            if now.fault.is_raised() {
                let block = call.block as usize;
                return Err(self.failed(block));
            }
        }
        Ok(())
    }

    /// A minor pass: the part of [`continuous`](Self::continuous) that derivatives and guards depend on.
    pub fn minor(&mut self, t: f64, x: &[f64]) -> Result<(), Failed> {
        self.held(t, x, Known::Minor)
    }

    fn held(&mut self, t: f64, x: &[f64], wanted: Known) -> Result<(), Failed> {
        if self.now.known >= wanted && self.now.is_at(t, x) {
            return Ok(());
        }
        self.enter(t, x);
        if !self.loops.rings.is_empty() {
            return self.held_with_loops(wanted);
        }
        let all_met = match wanted {
            Known::Minor => self.parts(|plan| (&plan.fused.minor, &plan.minor)),
            _ => self.parts(|plan| (&plan.fused.continuous, &plan.continuous)),
        };
        let Self { plan, now, signals, d, scratch, .. } = self;
        let calls = if wanted == Known::Minor { &plan.minor } else { &plan.continuous };
        if !all_met {
            // Once more, to find out which block it was.
            now.evaluation += 1;
            for call in calls {
                outputs(call, now, signals, d, scratch);
                if now.fault.is_raised() {
                    let block = call.block as usize;
                    return Err(self.failed(block));
                }
            }
        }
        now.known = wanted;
        Ok(())
    }

    /// All calls of a pass between major steps, those whose laws are data at once. Returns whether all could go on.
    #[inline(always)]
    fn parts(&mut self, which: impl Fn(&Plan) -> (&[Part], &[Call])) -> bool {
        let Self { plan, now, signals, d, scratch, .. } = self;
        plan.fused.place(now.t, &now.x, signals);
        let (parts, calls) = which(plan);
        let mut all_met = true;
        for part in parts {
            match part {
                Part::Calls(range) => {
                    for call in &calls[range.clone()] {
                        outputs(call, now, signals, d, scratch);
                    }
                }
                Part::Tape(tape, ..) => all_met &= tape.run(signals, d).failed.is_none(),
            }
        }
        let raised = now.fault.is_raised();
        if raised {
            now.fault.take();
        }
        all_met && !raised
    }

    /// The same where there are algebraic loops.
    fn held_with_loops(&mut self, wanted: Known) -> Result<(), Failed> {
        let pass = if wanted == Known::Minor { Pass::Minor } else { Pass::Continuous };
        let mut part = 0;
        loop {
            let Self { plan, signals, d, .. } = self;
            let fused = &plan.fused;
            let parts = if pass == Pass::Minor { &fused.minor } else { &fused.continuous };
            let Some(next) = parts.get(part) else { break };
            part += 1;
            let calls = match next {
                Part::Calls(calls) => calls.clone(),
                Part::Tape(tape, calls, _) => {
                    if tape.run(signals, d).failed.is_none() {
                        continue;
                    }
                    // Once more, to find out which block it was.
                    calls.clone()
                }
            };
            self.calls_with_loops(calls, pass)?;
        }
        self.now.known = wanted;
        Ok(())
    }

    /// Calls of a pass between major steps one by one, and the loops among them.
    fn calls_with_loops(&mut self, range: Range<usize>, pass: Pass) -> Result<(), Failed> {
        let mut at = range.start;
        while at < range.end {
            let Self { plan, now, signals, d, scratch, loops, .. } = self;
            let call = if pass == Pass::Minor { &plan.minor[at] } else { &plan.continuous[at] };
            if let Some(ring) = call.begins {
                let ring = ring as usize;
                let count = loops.rings[ring].count;
                self.solve_loop(ring, pass, at, None::<fn(usize, &mut [f64])>)?;
                at += count;
            } else {
                outputs(call, now, signals, d, scratch);
                let block = call.block as usize;
                self.checked(block)?;
                at += 1;
            }
        }
        Ok(())
    }

    /// As [`continuous`](Self::continuous), but always, with the calls of a major pass that are `asked` for and with someone
    /// who may change signals behind each call, whose number among those of the plan he is told. Nobody takes the signals
    /// for known afterwards.
    pub fn touched(
        &mut self,
        t: f64,
        x: &[f64],
        asked: &[bool],
        mut touch: impl FnMut(usize, &mut [f64]),
    ) -> Result<(), Failed> {
        self.enter(t, x);
        let mut behind = 0;
        for (i, _) in asked.iter().enumerate().filter(|(_, asked)| **asked) {
            if i < behind {
                continue;
            }
            let Self { plan, now, signals, d, scratch, loops, .. } = self;
            let call = &plan.major[i];
            if let Some(ring) = call.begins {
                behind = i + loops.rings[ring as usize].count;
                self.solve_loop(ring as usize, Pass::Major, i, Some(&mut touch))?;
                continue;
            }
            outputs(call, now, signals, d, scratch);
            if now.fault.is_raised() {
                let block = call.block as usize;
                return Err(self.failed(block));
            }
            touch(i, signals);
        }
        Ok(())
    }

    /// One call of a major pass by itself, with the branches as they are.
    pub fn give(&mut self, call: usize) -> Result<(), Failed> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let call = &plan.major[call];
        now.evaluation += 1;
        outputs(call, now, signals, d, scratch);
        let block = call.block as usize;
        self.checked(block)
    }

    /// Goes to another point without an evaluation.
    pub fn place(&mut self, t: f64, x: &[f64]) {
        self.enter(t, x);
    }

    /// Begins an evaluation: what blocks have in their scratch space is old from here.
    fn enter(&mut self, t: f64, x: &[f64]) {
        let now = &mut self.now;
        now.t = t;
        now.x.copy_from_slice(x);
        now.evaluation += 1;
        now.known = Known::Nothing;
        now.derived = false;
        if !self.loops.rings.is_empty() {
            self.plan.fused.place(t, x, &mut self.signals);
        }
    }

    /// Says that discrete states or states have changed since the last evaluation.
    pub fn forget(&mut self) {
        self.now.known = Known::Nothing;
    }

    /// Whether the block just called could go on.
    #[inline]
    pub(crate) fn checked(&mut self, block: usize) -> Result<(), Failed> {
        if self.now.fault.is_raised() { Err(self.failed(block)) } else { Ok(()) }
    }

    #[cold]
    fn failed(&mut self, block: usize) -> Failed {
        if let Some(reason) = self.now.fault.take() {
            self.blame(block, reason);
        }
        self.now.known = Known::Nothing;
        Failed
    }

    /// Notes that a block could not go on, and why.
    #[cold]
    pub(crate) fn blame(&mut self, block: usize, reason: String) -> Failed {
        self.failure = Some(Failure { block, t: self.now.t, reason, ring: None });
        self.now.known = Known::Nothing;
        Failed
    }
}

/// Calls the outputs of one group. Always inlined: the call alone would cost a fifth of the pass.
#[inline(always)]
pub(crate) fn outputs(call: &Call, now: &mut Now, signals: &mut [f64], d: &[f64], scratch: &mut [Scratch]) {
    let unit = &call.unit;
    let (u, y) = match unit.source {
        Source::Below(from) => {
            let (before, rest) = signals.split_at_mut(unit.y.start as usize);
            (&before[from as usize..][..unit.width as usize], &mut rest[..unit.y.len()])
        }
        Source::Above(from) => {
            let (before, rest) = signals.split_at_mut(unit.y.end as usize);
            (&rest[from as usize..][..unit.width as usize], &mut before[unit.y.start as usize..])
        }
        Source::Single => {
            now.pick(unit.copies, signals);
            (&now.u[..unit.width as usize], &mut signals[unit.y.range()])
        }
        Source::Scattered => {
            now.gather(unit.copies, signals);
            (&now.u[..unit.width as usize], &mut signals[unit.y.range()])
        }
    };
    let c = Context {
        t: now.t,
        x: &now.x[unit.x.range()],
        d: &d[unit.d.range()],
        u,
        inputs: &unit.inputs,
        outputs: &unit.outputs,
        evaluation: now.evaluation,
        resolution: now.resolution,
        seed: now.seed,
        fault: &now.fault,
    };
    unit.block.outputs(call.group as usize, &c, &mut scratch[call.block as usize], y);
}

impl Settling {
    /// Lets a block choose the branches that belong to a group.
    pub fn before(&mut self, call: &Call, now: &mut Now, signals: &[f64], d: &mut [f64]) {
        let (block, group) = (call.block as usize, call.group as usize);
        self.choose(block, &call.unit, now, signals, d, |block, c, d| block.settle_in(group, c, d));
    }

    /// Lets a block choose its branches.
    pub fn run(&mut self, block: usize, unit: &Unit, now: &mut Now, signals: &[f64], d: &mut [f64]) {
        self.choose(block, unit, now, signals, d, |block, c, d| block.settle(c, d));
    }

    fn choose(
        &mut self,
        block: usize,
        unit: &Unit,
        now: &mut Now,
        signals: &[f64],
        d: &mut [f64],
        choose: impl Fn(&dyn Block, &Context, &mut [f64]),
    ) {
        let d = &mut d[unit.d.range()];
        let before = &mut self.before[..d.len()];
        before.copy_from_slice(d);
        choose(&*unit.block, &now.context(unit, signals, &[]), d);
        self.changed |= *before != *d;
        self.last[block] = now.evaluation;
    }
}
