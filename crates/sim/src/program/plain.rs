//! The part of a major pass that a plain step needs: what is recorded, what modes are chosen by, and what may fail.

use blocksim_block::law::Draft;
use blocksim_block::schedule::When;
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::program::fused::Laws;
use crate::program::graph::Graph;
use crate::program::plan::{Call, NEARLY_ALL, Settles};

impl Laws<'_> {
    /// The outputs that somebody asks for at plain steps, if these are all data and not nearly all that there is.
    pub fn plain(&self) -> Option<Draft> {
        let plan = self.plan;
        let due: Vec<&Call> =
            plan.major.iter().filter(|call| matches!(call.when, When::Continuous | When::Major)).collect();
        let are_laws = due.iter().all(|call| self.is_recorded(call, true));
        if !plan.plain || !are_laws || !plan.settling.is_empty() || !self.schedule.loops.is_empty() {
            return None;
        }
        let graph = Graph::new(self.schedule);
        let recorded = self.schedule.recorded.iter().filter_map(|recorded| graph.writer(recorded.cell));
        let matters = |call: &&&Call| {
            let requires =
                self.law(call.block as usize).is_some_and(|law| !law.program.requirements.is_empty());
            requires || call.when == When::Major || call.settles != Settles::Nothing
        };
        let group = |call: &Call| (call.block as usize, call.group as usize);
        let acting = due.iter().filter(matters).map(|call| group(call));
        let wanted = graph.behind(recorded.chain(acting).collect());
        let calls: Vec<&Call> = due.iter().copied().filter(|call| wanted.contains(&group(call))).collect();
        ((calls.len() as f64) < NEARLY_ALL * due.len() as f64).then(|| self.pass(calls, true))
    }
}

impl Diagram {
    /// A major pass at a plain step; the signals that nobody asks for there stay as they were, and nobody takes them for known. Returns
    /// whether it was possible: otherwise all are evaluated.
    pub fn pass_plainly(&mut self, t: f64, x: &[f64]) -> Result<bool, Failed> {
        if self.plan.fused.plain.is_none() || !self.pinned.is_empty() {
            return Ok(false);
        }
        self.forget();
        let changed = self.outputs_plainly(t, x);
        self.settle.changed |= changed == Some(true);
        Ok(changed.is_some())
    }

    /// Whether steps may be made one after the other without anybody else being heard.
    pub fn dashes(&self) -> bool {
        let fused = &self.plan.fused;
        fused.whole.is_some() && fused.plain.is_some() && self.pinned.is_empty()
    }

    /// What a [major pass at a plain step](Self::pass_plainly) computes. Returns whether it has changed a mode; nothing where a law has
    /// no value.
    #[inline]
    pub fn outputs_plainly(&mut self, t: f64, x: &[f64]) -> Option<bool> {
        let Self { plan, signals, d, .. } = self;
        let tape = plan.fused.plain.as_ref()?;
        plan.fused.place(t, x, signals);
        let met = tape.run(signals, d);
        met.failed.is_none().then_some(met.changed)
    }
}
