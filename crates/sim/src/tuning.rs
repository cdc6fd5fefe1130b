//! Other parameters in the middle of a run.
//!
//! A block holds its parameters and nothing that changes, so a run goes on with other parameters as a run of another schedule of
//! the same shape: time, states, memories and held outputs are carried over, constants and branches are evaluated anew, and what
//! jumps by that is recorded on both sides.

use std::sync::Arc;

use blocksim_block::Invariant;
use blocksim_block::schedule::{Instance, Schedule};

use crate::diagnose::number;
use crate::evaluation::evaluate::Diagram;
use crate::{Observer, SimError, Simulation};

/// Gap of a closed loop, rad or m, that counts as none, and the factor of one that has drifted open that does so as well.
const CLOSED: f64 = 1e-6;
const DRIFT: f64 = 10.0;

/// What helps where parameters make another model.
pub const NUMBERS: &str =
    "run it from the start; while a run goes on, parameters may change numbers, not what there is";

/// That parameters make another model, and by what it differs.
pub fn other_model(difference: &str) -> String {
    format!("the parameters make another model: {difference}")
}

impl Simulation {
    /// Goes on with other parameters: those of a schedule of the same diagram. Sampled blocks use theirs from their next hit on.
    /// Returns the paths of blocks whose values at the start are others now, which have no effect any more.
    ///
    /// # Errors
    /// `tuning` if blocks, states, signals or sample times differ, or if a closed loop of bodies would be open; the run is then as it was. Those of a major step, if one
    /// with these parameters cannot be made.
    pub fn tune(
        &mut self,
        schedule: Arc<Schedule>,
        observer: &mut dyn Observer,
    ) -> Result<Vec<String>, SimError> {
        if let Some(difference) = untunable(&self.schedule, &schedule) {
            return Err(SimError::new("tuning", self.t, other_model(&difference)).help(NUMBERS));
        }
        let mut next = Self::given(schedule)?;
        if !self.started {
            *self = next;
            return Ok(Vec::new());
        }
        let begun = Self::given(Arc::clone(&self.schedule))?;
        let without_effect = starting_otherwise(&begun, &next);
        next.t = self.t;
        next.x.clone_from(&self.x);
        keep_meaning(&mut next.x, [&self.schedule, &next.schedule]);
        next.diagram.d.clone_from(&self.diagram.d);
        for signal in &self.schedule.signals {
            let cells = signal.offset..signal.offset + signal.shape.len();
            next.diagram.signals[cells.clone()].copy_from_slice(&self.diagram.signals[cells]);
        }
        next.diagram.place(next.t, &next.x);
        if let Some((block, gap)) = opened(&mut self.diagram, &mut next.diagram, &self.schedule) {
            let message = format!(
                "the bodies of `{block}` cannot go on with these parameters: a closed loop would be open by {} (m or rad)",
                number(format!("{gap:.2e}").parse().unwrap_or(gap))
            );
            let help = "change lengths and axes of a closed loop before a run; its joints then start where it closes";
            return Err(SimError::new("tuning", self.t, message).help(help));
        }
        // Only a network that works circuits out beyond the present has to know.
        let (old, new) = (Arc::clone(&self.schedule), Arc::clone(&next.schedule));
        let is_changed = |block: usize| {
            let [old, new] = [&old, &new].map(|schedule| format!("{:?}", schedule.blocks[block].block));
            old != new
        };
        let due = self.t + self.same();
        let noted = self.diagram.note(is_changed).and_then(|()| self.diagram.update_between(due));
        self.held(noted)?;
        next.diagram.d.clone_from(&self.diagram.d);
        next.modes.note(&next.diagram.d);
        next.diagram.loops.anchors.clone_from(&self.diagram.loops.anchors);
        next.diagram.place(next.t, &next.x);
        let noted = next.diagram.note(is_changed);
        next.held(noted)?;
        next.started = true;
        next.hits.next.clone_from(&self.hits.next);
        next.hits.due.clone_from(&self.hits.due);
        next.hits.tell_times();
        if let (Some(to), Some(from)) = (&mut next.rows.grid, &self.rows.grid) {
            to.go_to(from.next());
        }
        if let (Some(to), Some(from)) = (&mut next.grid, &self.grid) {
            to.go_to(from.next());
        }
        next.pace.clone_from(&self.pace);
        next.halves = self.halves.take();
        next.past.clone_from(&self.past);
        next.sizes.clone_from(&self.sizes);
        next.floors.clone_from(&self.floors);
        (next.majors, next.events, next.hit_count) = (self.majors, self.events, self.hit_count);
        next.carried = self.counts();
        // It was interrupted, and that has been told.
        next.interrupted = self.interrupted;
        next.looked = self.t;
        next.begin_anew(observer)?;
        *self = next;
        Ok(without_effect)
    }
}

/// Largest gap of what cannot close by itself that other parameters open, and the block that it belongs to.
fn opened(old: &mut Diagram, new: &mut Diagram, schedule: &Schedule) -> Option<(String, f64)> {
    let size = |invariant: &Invariant| invariant.gaps.iter().map(|gap| gap * gap).sum::<f64>().sqrt();
    let (before, after) = (old.invariants(), new.invariants());
    let opened =
        before.iter().zip(&after).filter(|(_, after)| after.is_lasting).filter_map(|(before, after)| {
            let gap = size(after);
            let state = *after.followers[0].first()?;
            (gap > CLOSED + DRIFT * size(before)).then_some((state, gap))
        });
    let (state, gap) = opened.max_by(|one, other| one.1.total_cmp(&other.1))?;
    let own = |block: &&Instance| (block.x..block.x + block.interface.states.len()).contains(&state);
    schedule.blocks.iter().find(own).map(|block| (block.path.clone(), gap))
}

/// Brings states to what they stand for by the second schedule, if the first one gave them another scale.
fn keep_meaning(x: &mut [f64], [old, new]: [&Schedule; 2]) {
    for (old, new) in old.blocks.iter().zip(&new.blocks) {
        let states = old.interface.states.iter().zip(&new.interface.states);
        for (x, (old, new)) in x[new.x..].iter_mut().zip(states) {
            *x *= new.scale / old.scale;
        }
    }
}

/// Paths of the blocks that would start with other states.
fn starting_otherwise(one: &Simulation, other: &Simulation) -> Vec<String> {
    let differs = |block: &&Instance| {
        let states = block.x..block.x + block.interface.states.len();
        let discrete = block.d..block.d + block.interface.discrete.len();
        one.x[states.clone()] != other.x[states]
            || one.diagram.d[discrete.clone()] != other.diagram.d[discrete]
    };
    one.schedule.blocks.iter().filter(differs).map(|block| block.path.clone()).collect()
}

/// What makes it impossible to go on with another schedule in the middle of a run; nothing if states and signals mean the same in both.
pub fn untunable(now: &Schedule, next: &Schedule) -> Option<String> {
    for (one, other) in now.blocks.iter().zip(&next.blocks) {
        if one.path != other.path || one.kind != other.kind {
            return Some(format!("`{}` stands where `{}` stood", other.path, one.path));
        }
        let names = |block: &Instance| -> Vec<String> {
            let states = block.interface.states.iter().map(|state| state.name.clone());
            let discrete = block.interface.discrete.iter().map(|state| state.name().into_owned());
            states.chain(discrete).collect()
        };
        let same = (one.x, one.d, one.g, one.rate) == (other.x, other.d, other.g, other.rate)
            && one.interface.guards.len() == other.interface.guards.len()
            && names(one) == names(other);
        if !same {
            return Some(format!("`{}` has other states, conditions or sample times", one.path));
        }
    }
    let signals = |schedule: &Schedule| -> Vec<_> {
        schedule
            .signals
            .iter()
            .map(|signal| (signal.path.clone(), signal.offset, signal.shape.len()))
            .collect()
    };
    let recorded = |schedule: &Schedule| -> Vec<_> {
        schedule.recorded.iter().map(|recorded| (recorded.path.clone(), recorded.cell)).collect()
    };
    let differs = |differs: bool, what: &str| differs.then(|| what.to_owned());
    differs(now.blocks.len() != next.blocks.len(), "it has more blocks, or fewer")
        .or_else(|| differs(signals(now) != signals(next), "its signals are others"))
        .or_else(|| differs(recorded(now) != recorded(next), "other signals are recorded"))
        .or_else(|| {
            differs((now.states, now.discrete) != (next.states, next.discrete), "its states are others")
        })
        .or_else(|| differs(now.loops.len() != next.loops.len(), "its algebraic loops are others"))
        .or_else(|| differs(now.clock != next.clock, "its sample times are others"))
        .or_else(|| differs(now.settings.solver != next.settings.solver, "the method of solution is another"))
        .or_else(|| differs(now.settings.output != next.settings.output, "rows are recorded at other times"))
}
