//! What blocks do besides outputs. Each function belongs to the point of the last evaluation.

use blocksim_block::{Block, Context, Invariant, NODES, Piece, Scratch};
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;

impl Diagram {
    /// Values at the start: those of the interfaces, then what the blocks make of them.
    pub fn initialize(&mut self, x: &mut [f64]) -> Result<(), Failed> {
        for block in 0..self.plan.units.len() {
            let Self { plan, now, signals, d, .. } = self;
            let unit = &plan.units[block];
            let c = Context { x: &[], ..now.context(unit, signals, &[]) };
            unit.block.initialize(&c, &mut x[unit.x.range()], &mut d[unit.d.range()]);
            self.checked(block)?;
        }
        Ok(())
    }

    /// Tells the blocks that subdivide their sample times the tolerance of the run.
    pub fn tolerate(&mut self, rtol: f64) {
        let Self { plan, d, .. } = self;
        for unit in plan.subdividing.iter().map(|block| &plan.units[*block]) {
            unit.block.tolerate(rtol, &mut d[unit.d.range()]);
        }
    }

    /// Derivatives of all states. The outputs must be known.
    pub fn derive(&mut self, dx: &mut [f64]) -> Result<(), Failed> {
        dx.fill(0.0);
        {
            let Self { plan, now, signals, d, .. } = self;
            plan.fused.place(now.t, &now.x, signals);
            if !plan.fused.derivatives.run(signals, d, dx) {
                return self.derive_one_by_one(dx);
            }
        }
        for i in 0..self.plan.fused.derivatives.called.len() {
            let block = self.plan.fused.derivatives.called[i];
            let Self { plan, now, signals, d, scratch, .. } = self;
            let unit = &plan.units[block];
            let c = now.context(unit, signals, &d[unit.d.range()]);
            unit.block.derivatives(&c, &mut scratch[block], &mut dx[unit.x.range()]);
            self.checked(block)?;
        }
        self.now.derived = true;
        Ok(())
    }

    /// The same without tapes, where a law has no value.
    #[cold]
    fn derive_one_by_one(&mut self, dx: &mut [f64]) -> Result<(), Failed> {
        for i in 0..self.plan.with_states.len() {
            let block = self.plan.with_states[i];
            let Self { plan, now, signals, d, scratch, .. } = self;
            let unit = &plan.units[block];
            let c = now.context(unit, signals, &d[unit.d.range()]);
            unit.block.derivatives(&c, &mut scratch[block], &mut dx[unit.x.range()]);
            self.checked(block)?;
        }
        self.now.derived = true;
        Ok(())
    }

    /// Values of all guards. The outputs must be known.
    pub fn guards(&mut self, g: &mut [f64]) -> Result<(), Failed> {
        let all_met = {
            let Self { plan, now, signals, d, .. } = self;
            plan.fused.place(now.t, &now.x, signals);
            plan.fused.guards.run(signals, d, g)
        };
        let count = if all_met { self.plan.fused.guards.called.len() } else { self.plan.guarded.len() };
        for i in 0..count {
            let block = if all_met { self.plan.fused.guards.called[i] } else { self.plan.guarded[i] };
            let Self { plan, now, signals, d, scratch, .. } = self;
            let unit = &plan.units[block];
            let c = now.context(unit, signals, &d[unit.d.range()]);
            unit.block.guards(&c, &mut scratch[block], &mut g[unit.g.range()]);
            self.checked(block)?;
        }
        Ok(())
    }

    /// Takes down the guards at a point where derivatives have just been evaluated, if anybody looks. Off the
    /// solution a guard may make no sense; that is then no look.
    pub fn look(&mut self, t: f64) {
        if !self.looks.is_on() {
            return;
        }
        let shows = self.looks.shows(t);
        let mut looks = std::mem::take(&mut self.looks);
        if !shows {
            // It takes its place all the same, so that the same looks are kept.
            looks.row(t);
        } else if self.guards(looks.row(t)).is_err() {
            self.failure = None;
            looks.forget(t);
        }
        self.looks = looks;
    }

    /// The next time event of each block in `Plan::timed`.
    pub fn next_events(&mut self, times: &mut [f64]) -> Result<(), Failed> {
        for (i, time) in times.iter_mut().enumerate() {
            let block = self.plan.timed[i];
            let Self { plan, now, signals, d, .. } = self;
            let unit = &plan.units[block];
            *time = unit.block.next_event(&now.context(unit, signals, &d[unit.d.range()]));
            self.checked(block)?;
        }
        Ok(())
    }

    /// The next time behind `t` of each block in `Plan::pending`.
    pub fn pending_events(&mut self, t: f64, times: &mut [f64]) -> Result<(), Failed> {
        for (i, time) in times.iter_mut().enumerate() {
            let block = self.plan.pending[i];
            let Self { plan, now, signals, d, .. } = self;
            let unit = &plan.units[block];
            let here = Context { t, ..now.context(unit, signals, &d[unit.d.range()]) };
            *time = unit.block.pending_event(&here);
            self.checked(block)?;
        }
        Ok(())
    }

    /// The first time at which a block updates between its hits.
    pub fn next_update(&mut self) -> Result<f64, Failed> {
        let mut first = f64::INFINITY;
        for i in 0..self.plan.subdividing.len() {
            first = first.min(self.next_update_of(self.plan.subdividing[i])?);
        }
        Ok(first)
    }

    fn next_update_of(&mut self, block: usize) -> Result<f64, Failed> {
        let Self { plan, now, signals, d, .. } = self;
        let unit = &plan.units[block];
        let next = unit.block.next_update(&now.context(unit, signals, &d[unit.d.range()]));
        self.checked(block)?;
        Ok(next)
    }

    /// Advances the discrete states of the blocks that update between their hits until `due`.
    pub fn update_between(&mut self, due: f64) -> Result<(), Failed> {
        for i in 0..self.plan.subdividing.len() {
            let block = self.plan.subdividing[i];
            if self.next_update_of(block)? <= due {
                self.change(block, |block, c, w, d| block.update(c, w, d))?;
                self.forget();
            }
        }
        Ok(())
    }

    /// Advances the discrete states of the blocks whose rates are hit. All of them see the signals of this instant,
    /// because none changes a signal.
    pub fn update(&mut self, due: &[bool]) -> Result<(), Failed> {
        let mut seen = false;
        for i in 0..self.plan.updated.len() {
            let updated = self.plan.updated[i];
            if due[updated.rate] {
                self.change(updated.block, |block, c, w, d| block.update(c, w, d))?;
                seen |= updated.seen;
            }
        }
        if seen {
            self.forget();
        }
        Ok(())
    }

    /// Tells the blocks that want to know that a step was accepted. Returns whether another law holds from here for any on which
    /// derivatives, guards or memories depend.
    pub fn accept(&mut self) -> Result<bool, Failed> {
        let mut changed = false;
        for i in 0..self.plan.accepting.len() {
            let block = self.plan.accepting[i];
            let acts = self.plan.acting[block];
            self.change(block, |block, c, _, d| changed |= block.accept(c, d) && acts)?;
        }
        if !self.plan.accepting.is_empty() {
            self.forget();
        }
        Ok(changed)
    }

    /// Tells all blocks that a steady state is sought from here on, or that the run begins.
    pub fn seek_rest(&mut self, begins: bool, x: &mut [f64]) {
        for unit in &self.plan.units {
            unit.block.seek_rest(begins, &mut x[unit.x.range()], &mut self.d[unit.d.range()]);
        }
        self.forget();
    }

    /// Brings states together that have one value in common; returns what differed, and in which block.
    pub fn fit(&mut self, x: &mut [f64]) -> Option<(usize, String)> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let mut differs = None;
        for (block, unit) in plan.units.iter().enumerate() {
            let c = now.context(unit, signals, &d[unit.d.range()]);
            let found = unit.block.fit(&c, &mut scratch[block], &mut x[unit.x.range()]);
            differs = differs.or(found.map(|what| (block, what)));
        }
        self.forget();
        differs
    }

    /// What states obey wherever the diagram can be, at those of the last evaluation.
    pub fn invariants(&mut self) -> Vec<Invariant> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let units = plan.units.iter().zip(scratch);
        let found = units.flat_map(|(unit, w)| {
            let first = unit.x.range().start;
            let own = unit.block.invariants(&now.context(unit, signals, &d[unit.d.range()]), w);
            own.into_iter().map(move |own| Invariant {
                followers: own
                    .followers
                    .map(|states| states.into_iter().map(|state| first + state).collect()),
                ..own
            })
        });
        let found = found.collect();
        self.forget();
        found
    }

    /// What should have changed before the end of a step, of which the signals are; see [`Block::lateness`].
    pub fn lateness(&mut self) -> Option<(f64, f64, &str)> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let units = plan.units.iter().zip(scratch);
        let late = units
            .filter_map(|(unit, w)| unit.block.lateness(&now.context(unit, signals, &d[unit.d.range()]), w));
        late.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Has the blocks note their inputs that want to know of changes, before something changes that never does by itself, and interrupts
    /// those for which this holds.
    pub fn note(&mut self, is_changed: impl Fn(usize) -> bool) -> Result<(), Failed> {
        for i in 0..self.plan.noting.len() {
            let index = self.plan.noting[i];
            self.change(index, |block, c, _, d| match is_changed(index) {
                true => block.interrupt(c, d),
                false => _ = block.accept(c, d),
            })?;
        }
        self.forget();
        Ok(())
    }

    /// Tells the blocks that remember what they saw of a part of a step; `inputs` are those of each block in turn, at the
    /// nodes. The signals belong to the end of the part.
    pub fn remember(&mut self, piece: &Piece) -> Result<(), Failed> {
        let mut at = 0;
        for i in 0..self.plan.remembering.len() {
            let block = self.plan.remembering[i];
            let len = NODES.len() * self.plan.units[block].width as usize;
            let own = Piece { inputs: &piece.inputs[at..at + len], ..*piece };
            at += len;
            self.change(block, |block, c, _, d| block.remember(c, &own, d))?;
        }
        self.forget();
        Ok(())
    }

    /// Tells the blocks that remember that this time has been reached, with the signals just before it.
    pub fn reach(&mut self) -> Result<(), Failed> {
        for i in 0..self.plan.remembering.len() {
            self.change(self.plan.remembering[i], |block, c, _, d| block.reach(c, d))?;
        }
        self.forget();
        Ok(())
    }

    /// The first time at which a block that remembers has a kink.
    pub fn next_kink(&mut self) -> Result<f64, Failed> {
        let mut first = f64::INFINITY;
        for i in 0..self.plan.remembering.len() {
            let block = self.plan.remembering[i];
            let Self { plan, now, signals, d, .. } = self;
            let unit = &plan.units[block];
            let c = now.context(unit, signals, &d[unit.d.range()]);
            first = first.min(unit.block.next_kink(&c));
            self.checked(block)?;
        }
        Ok(first)
    }

    /// Writes the inputs of the blocks that remember, as they are at node `node` of a piece, to `inputs`, laid out as
    /// [`remember`](Self::remember) takes them.
    pub fn inputs(&mut self, node: usize, inputs: &mut [f64]) {
        let mut at = 0;
        let Self { plan, now, signals, .. } = self;
        for &block in &plan.remembering {
            let unit = &plan.units[block];
            let width = unit.width as usize;
            let from = at + node * width;
            inputs[from..from + width].copy_from_slice(now.context(unit, signals, &[]).u);
            at += NODES.len() * width;
        }
    }

    pub(crate) fn change(
        &mut self,
        block: usize,
        mut act: impl FnMut(&dyn Block, &Context, &mut Scratch, &mut [f64]),
    ) -> Result<(), Failed> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let unit = &plan.units[block];
        act(&*unit.block, &now.context(unit, signals, &[]), &mut scratch[block], &mut d[unit.d.range()]);
        self.checked(block)
    }

    /// Lets every block jump that wants to, and tells `jumped` which did.
    pub fn jump(&mut self, x: &mut [f64], mut jumped: impl FnMut(usize)) -> Result<(), Failed> {
        for i in 0..self.plan.jumping.len() {
            let block = self.plan.jumping[i];
            if self.jump_one(block, x)? {
                jumped(block);
            }
        }
        Ok(())
    }

    /// Lets one block jump if it wants to; returns whether it did.
    pub fn jump_one(&mut self, block: usize, x: &mut [f64]) -> Result<bool, Failed> {
        let Self { plan, now, signals, d, scratch, .. } = self;
        let unit = &plan.units[block];
        let c = Context { x: &[], ..now.context(unit, signals, &[]) };
        let jumped = unit.block.jump(&c, &mut scratch[block], &mut x[unit.x.range()], &mut d[unit.d.range()]);
        if jumped {
            self.forget();
        }
        self.checked(block)?;
        Ok(jumped)
    }
}
