//! From one major step to the next: steps of the solver, events, rows in between.

use crate::diagnose::guard_of;
use crate::events::crossings::{Cut, phrase, summary, verb};
use crate::events::guards::Stride;
use crate::events::pace::Flood;
use crate::events::rhythm::Accumulation;
use crate::stepping::clock::{Grid, at_pending, earliest};
use crate::stepping::major::Arrival;
use crate::{Observer, SimError, Simulation, diagnose};

/// The next instant that must not be stepped over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    /// When, s.
    pub t: f64,
    /// Whether a block changes by itself then.
    event: bool,
    /// Whether a block has a kink or updates between its hits then.
    kink: bool,
    /// Whether the run ends then.
    end: bool,
}

impl Stop {
    /// The first of the end, the next sample hits, the next time events, and the end of the step.
    pub fn first(sim: &Simulation, end: f64) -> Self {
        let step = sim.grid.as_ref().map_or(f64::INFINITY, Grid::time);
        let times = sim.hits.times().iter().chain(&sim.event_times).copied();
        // What is due at the end may lie behind it by rounding: an edge at 3 * 1.1 s belongs to a run of 3.3 s.
        let t = earliest(times.chain([end, step, sim.past.kink, sim.next_update]), sim.resolution);
        let is_due = |time: f64| time <= t + sim.resolution.same(t);
        Self {
            t,
            event: sim.event_times.iter().any(|&time| is_due(time)),
            kink: is_due(sim.past.kink) || is_due(sim.next_update),
            end: t >= end,
        }
    }

    /// The same where a block may begin to run at the instant at which it changes, which is the later one of both.
    pub fn at_pending(self, sim: &Simulation) -> Self {
        Self { t: at_pending(self.t, &sim.pending_times, sim.resolution), ..self }
    }
}

impl Simulation {
    /// Integrates up to the first event, at the longest to `stop`.
    pub(crate) fn advance(&mut self, stop: Stop, observer: &mut dyn Observer) -> Result<Arrival, SimError> {
        loop {
            let start = self.t;
            self.refine.begin(&self.diagram.signals);
            let begun = self.guards.begin(&mut self.diagram, self.t, &self.x);
            self.held(begun)?;
            if let Some(guard) = self.guards.broken() {
                return self.choose_again(guard);
            }
            if let Some(audit) = &mut self.audit {
                audit.begin(&self.guards.start);
            }
            self.kinks.begin(&self.x);
            let longest = self.longest_way_out(stop.t);
            self.step_by_angles(longest)?;
            let mut arrival = self.cut(start, stop.t, observer)?;
            if self.t >= stop.t {
                arrival.event |= stop.event;
                arrival.cut |= stop.kink;
                arrival.end = stop.end;
            }
            // When what is remembered of this step comes out again is not known before.
            let every = self.diagram.plan.every_step || self.rows.grid.is_none() || self.past.is_new();
            // Who wants the run to stop at a time waits for the first step that reaches it.
            let every = every || observer.is_waiting(self.t);
            let major = self.t >= stop.t || arrival.cut || arrival.event || every || self.is_impatient();
            self.record_within(if major { self.t - self.same() } else { self.t }, observer)?;
            self.record_between(start, observer);
            // Where a guard leaves its zero, branches are chosen anew as well.
            let may_jump = arrival.event || arrival.cut;
            if may_jump || self.rows.jump_at(self.t, &self.hits) {
                self.look_back(may_jump)?;
            }
            self.sizes.note(&self.x);
            self.floors.note(self.t, &self.x);
            self.remember(start)?;
            self.accept()?;
            self.reach()?;
            if major {
                return Ok(arrival);
            }
        }
    }

    /// Has the modes chosen again at this time, because one of them is wrong.
    fn choose_again(&mut self, guard: usize) -> Result<Arrival, SimError> {
        self.guards.known = false;
        if self.guards.chatters(self.t) {
            self.guards.fired.fill(false);
            self.guards.fired[guard] = true;
            return Err(self.chatter());
        }
        // A delay that has jumped may have led what is read past a jump.
        self.reach()?;
        Ok(Arrival { event: true, cut: true, ..Arrival::default() })
    }

    /// One step of the solver, or all the way where there is nothing to integrate.
    #[inline]
    pub(crate) fn step(&mut self, limit: f64) -> Result<(), SimError> {
        let Some(stepper) = &mut self.stepper else {
            self.t = limit;
            return Ok(());
        };
        self.diagram.looks.begin(self.t);
        let stepped = stepper.step(&mut self.diagram, &mut self.t, &mut self.x, limit);
        stepped.map_err(|error| diagnose::step(&self.schedule, &mut self.diagram, &self.x, error))
    }

    /// Cuts the step at the first zero crossing of a guard.
    fn cut(&mut self, t0: f64, limit: f64, observer: &mut dyn Observer) -> Result<Arrival, SimError> {
        let mut arrival = Arrival::default();
        self.note_hops();
        self.guards.jumps = self.t >= limit;
        let cut = self.crossing(t0)?;
        let mut cut = self.leave_flatly(t0, cut)?;
        self.find_hops(t0, cut)?;
        if let Some(before) = cut
            && self.stops_at_kink(t0, before)
        {
            self.repeat(t0, before.t)?;
            self.guards.jumps = self.t >= limit;
            cut = self.crossing(t0)?;
        }
        let mut cut = self.confirm(t0, cut)?;
        // What happens at the cut may set signals back that have crossed the other way before.
        if cut.is_some_and(|cut| cut.crossed) && !self.guards.jumps && self.guards.has_crossed_back() {
            self.guards.jumps = true;
            cut = self.crossing(t0)?;
            cut = self.confirm(t0, cut)?;
        }
        let stride = Stride { t0, t1: self.t, stepper: self.stepper.as_deref() };
        if let Some(audit) = &mut self.audit
            && !self.guards.is_empty()
        {
            // The search has left the state at the cut in the guards' own place.
            self.guards.kept.clone_from(&self.guards.x);
            let fired = self.guards.trial.clone();
            let end = cut.map_or(self.t, |cut| cut.t);
            let looked = audit.look(&mut self.guards, &mut self.diagram, &stride, end);
            looked.map_err(|_| diagnose::failed(&self.schedule, &mut self.diagram))?;
            self.guards.x.clone_from(&self.guards.kept);
            self.guards.trial = fired;
        }
        let Some(cut) = cut else { return Ok(arrival) };
        // A crossing just before something else that is due is part of it.
        if cut.t < self.t && !(self.t == limit && cut.t >= limit - self.resolution.same(limit)) {
            self.t = cut.t;
            self.x.copy_from_slice(&self.guards.x);
        }
        arrival.cut = true;
        arrival.event = cut.crossed;
        if cut.crossed {
            self.events += 1;
            self.report_events(observer);
            if let Some(flood) = self.pace.count(self.t, self.schedule.settings.stop_time) {
                return Err(self.flooded(flood));
            }
            // Friction, stops and valves have states of rest of their own.
            if let Some((guard, accumulation)) = self.guards.beat(self.t)
                && guard_of(&self.schedule, guard).is_some_and(|(block, _)| block.parts.is_empty())
            {
                return Err(self.endless(guard, accumulation));
            }
        }
        if self.guards.chatters(self.t) { Err(self.chatter()) } else { Ok(arrival) }
    }

    /// Where the step from `t0` to the present must be cut.
    pub(crate) fn crossing(&mut self, t0: f64) -> Result<Option<Cut>, SimError> {
        let crossed = self.guards.arrive(&mut self.diagram, self.t, &self.x);
        if self.held(crossed)? {
            // The state that the step is cut at is to be as exact as the ends of steps.
            self.stepper.iter_mut().for_each(|stepper| stepper.sharpen(&mut self.diagram));
        }
        let stride = Stride { t0, t1: self.t, stepper: self.stepper.as_deref() };
        let cut = self.guards.cut(&mut self.diagram, &stride);
        cut.map_err(|_| diagnose::failed(&self.schedule, &mut self.diagram))
    }

    fn report_events(&mut self, observer: &mut dyn Observer) {
        let Self { diagram, schedule, guards, words, t, .. } = self;
        for &block in &diagram.plan.guarded {
            let instance = &schedule.blocks[block];
            for (place, guard) in instance.interface.guards.iter().enumerate() {
                let i = instance.g + place;
                if guards.fired[i]
                    && guards.is_awaited(i)
                    && let Some(verb) = verb(guard, guards.rises(i))
                {
                    observer.event(*t, phrase(words, instance, &guard.subject, verb), words);
                }
            }
        }
    }

    fn endless(&self, guard: usize, Accumulation { interval, ratio, end }: Accumulation) -> SimError {
        let (path, what) = self.named(Some(guard));
        let message = format!(
            "events come faster and faster without end: {what}, {interval:.2e} s after the last time, {ratio:.3} times the \
             interval before, and would do so for ever before {end:.6} s"
        );
        SimError::new("endless_events", self.t, message).at(path).help(
            "give the law a state of rest, for instance a speed below which an impact ends in contact, or a hysteresis; \
             or stop the run before",
        )
    }

    fn flooded(&self, Flood { count, within }: Flood) -> SimError {
        let stop = self.schedule.settings.stop_time;
        let fired = self.guards.fired.iter().position(|&fired| fired);
        let (path, what) = self.named(fired);
        let message = format!(
            "there are too many events to be recorded: {count} within the last {within:.2e} s, in the last one {what}; until \
             {stop} s there would be {:.0e} of them",
            f64::from(count) * stop / within
        );
        SimError::new("endless_events", self.t, message).at(path).help(
            "make what switches slower, with a wider hysteresis or a sample time; or stop the run before",
        )
    }

    fn chatter(&self) -> SimError {
        let fired = self.guards.fired.iter().position(|&fired| fired);
        let help = "give the switching a hysteresis, or use a method of fixed step";
        let named = fired.and_then(|guard| guard_of(&self.schedule, guard));
        match named {
            Some((block, guard)) => {
                let (path, what) =
                    (guard.subject.part.as_ref().unwrap_or(&block.path), summary(block, guard));
                let message = format!("`{path}` is chattering: it {what} again and again");
                SimError::new("chatter", self.t, message).at(path).help(help)
            }
            None => SimError::new(
                "chatter",
                self.t,
                "the diagram is chattering: a condition changes again and again",
            )
            .help(help),
        }
    }

    /// The part whose guard has fired, and it with what it does: `` `relay` switches on``.
    pub(crate) fn named(&self, guard: Option<usize>) -> (&str, String) {
        match guard.and_then(|guard| Some((guard, guard_of(&self.schedule, guard)?))) {
            Some((i, (block, guard))) => {
                let path = guard.subject.part.as_ref().unwrap_or(&block.path);
                let verb =
                    verb(guard, self.guards.rises(i)).map_or_else(|| summary(block, guard), str::to_owned);
                (path, format!("`{path}` {verb}"))
            }
            None => ("", "a condition changes".to_owned()),
        }
    }

    /// Records the points of the grid up to `end`, from the dense output of the last step.
    pub(crate) fn record_within(&mut self, end: f64, observer: &mut dyn Observer) -> Result<(), SimError> {
        if self.rows.next_before(end).is_some() {
            self.sharpen_rows();
        }
        while let Some(t) = self.rows.next_before(end) {
            if let Some(stepper) = &self.stepper {
                stepper.interpolate(t, &mut self.guards.x);
            }
            let evaluated = self.diagram.for_row(t, &self.guards.x);
            self.held(evaluated)?;
            if !self.rows.take(&self.diagram.signals) {
                return Err(diagnose::not_finite(&self.schedule, &self.diagram, &self.guards.x));
            }
            observer.row(t, &self.rows.values);
            self.rows.are_due(t);
        }
        Ok(())
    }

    /// Takes the row just before an event or a hit, while all branches and memories are still as they were.
    pub(crate) fn look_back(&mut self, is_event: bool) -> Result<(), SimError> {
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)?;
        self.rows.take_before(&self.diagram.signals, is_event);
        Ok(())
    }

    /// Tells blocks that a step was accepted, with their inputs at its end.
    fn accept(&mut self) -> Result<(), SimError> {
        if self.diagram.plan.accepting.is_empty() && self.diagram.plan.holding.is_empty() {
            return Ok(());
        }
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)?;
        self.diagram.hold_outputs();
        let accepted = self.diagram.accept();
        // What they remember now may stand in their guards.
        self.guards.known = false;
        self.relearnt |= self.held(accepted)?;
        Ok(())
    }
}
