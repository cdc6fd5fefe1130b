//! The step loop and who owns what.

use blocksim_block::problem::Problem;
use std::sync::Arc;

use blocksim_block::Resolution;

use blocksim_block::schedule::{Instance, Schedule, Solver};
use blocksim_solve::{Share, Stepper};

use crate::coarse_step::coarse_step;
use crate::evaluation::evaluate::Diagram;
use crate::events::audit::{Audit, Findings};
use crate::events::departure::Departure;
use crate::events::guards::Guards;
use crate::events::kinks::Kinks;
use crate::events::looks::Looks;
use crate::events::modes::Modes;
use crate::events::pace::Pace;
use crate::floors::Floors;
use crate::ignored_states::Sizes;
use crate::program::fused::Fused;
use crate::rows::record::Rows;
use crate::rows::refine::Refine;
use crate::steady::Rest;
use crate::stepping::advance::Stop;
use crate::stepping::angles::Angles;
use crate::stepping::clock::{Grid, Hits};
use crate::stepping::halves::Halves;
use crate::stepping::methods;
use crate::stepping::past::Past;
use crate::{Control, Observer, SimError, diagnose};

/// Steps after which the observer is asked whether to go on.
pub(crate) const PATIENCE: u32 = 256;
/// Bytes for the words of an event, so that reporting one takes no memory.
const WORDS: usize = 256;
/// A relative tolerance where none is given.
const UNTOLD: f64 = 1e-3;

/// One run of a compiled diagram: time, states, signals and all else that changes.
pub struct Simulation {
    pub(crate) schedule: Arc<Schedule>,
    pub(crate) diagram: Diagram,
    /// Absent without continuous states.
    pub(crate) stepper: Option<Box<dyn Stepper>>,
    pub(crate) t: f64,
    pub(crate) x: Vec<f64>,
    /// Which times are meant to be equal.
    pub(crate) resolution: Resolution,
    pub(crate) hits: Hits,
    pub(crate) guards: Guards,
    /// Which guards are those of kinks, and what repeats a step up to one.
    pub(crate) kinks: Kinks,
    /// Angles of which only the remainder of a turn counts.
    pub(crate) angles: Angles,
    /// What sets out from the zero of a guard.
    pub(crate) departure: Departure,
    pub(crate) modes: Modes,
    /// Room for the words of an event.
    pub(crate) words: String,
    /// How large states have become.
    pub(crate) sizes: Sizes,
    /// States below the least value that their law knows.
    pub(crate) floors: Floors,
    /// Whether a block follows another law since a step that it has taken note of.
    pub(crate) relearnt: bool,
    pub(crate) pace: Pace,
    pub(crate) rows: Rows,
    /// Where rows are needed within steps.
    pub(crate) refine: Refine,
    /// What blocks remember of steps.
    pub(crate) past: Past,
    /// Ends of the steps that no solver chooses, if anything happens in between.
    pub(crate) grid: Option<Grid>,
    /// Next time event of each block that has some.
    pub(crate) event_times: Vec<f64>,
    /// The next time of each block that would change if it ran.
    pub(crate) pending_times: Vec<f64>,
    /// When a block updates next between its hits.
    pub(crate) next_update: f64,
    /// Whether the first major step is done.
    pub(crate) started: bool,
    /// Steps since the observer was asked last.
    pub(crate) unasked: u32,
    /// Whether its last answer was to stop.
    pub(crate) interrupted: bool,
    /// Time at which it was asked last whether it waits, s.
    pub(crate) looked: f64,
    /// Present if the run is audited.
    pub(crate) audit: Option<Audit>,
    /// Whether steps of fixed size are short enough.
    pub(crate) halves: Option<Halves>,
    /// The steady state that it began in.
    pub(crate) rest: Option<Rest>,
    pub(crate) majors: u64,
    /// Work done with other parameters before.
    pub(crate) carried: Counts,
    pub(crate) events: u64,
    pub(crate) hit_count: u64,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// At its end.
    Finished,
    /// Before it, because the observer said so. Running again goes on from there.
    Interrupted,
    /// Before it, because a block said so: see [`Simulation::stop_reason`]. Running again does not go on.
    Stopped,
}

/// Work done so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Counts {
    /// Major steps; a repetition after a jump is the same step.
    pub major: u64,
    /// Steps that the solver kept.
    pub accepted: u64,
    /// Steps that it threw away.
    pub rejected: u64,
    /// Evaluations of the derivatives.
    pub evaluations: u64,
    /// Major steps at which guards have crossed zero.
    pub events: u64,
    /// Sample hits, over all rates.
    pub hits: u64,
    /// Steps of `Ode45` that stability limited, and not the tolerance.
    pub limited: u64,
    /// What the method `Auto` has left to the stiff one of its two; nothing of other methods.
    pub share: Option<Share>,
}

impl Simulation {
    /// A simulation at its start, with the steady state found that the settings may ask for. All memory that it needs is
    /// taken here.
    ///
    /// # Errors
    /// `settings` if a time or a tolerance makes no sense, `block_failed` if a block cannot be initialised,
    /// `no_steady_state`.
    pub fn new(schedule: Arc<Schedule>) -> Result<Self, SimError> {
        Self::at_start(schedule)
    }

    /// As [`new`](Self::new), at its initial values, with every block called by itself where else laws that are data run together.
    /// It gives the same bits, slower: a reference for tests.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), but for the steady state, which is not sought.
    pub fn one_by_one(schedule: Arc<Schedule>) -> Result<Self, SimError> {
        let mut simulation = Self::given(schedule)?;
        let diagram = &mut simulation.diagram;
        diagram.plan.plain = false;
        diagram.plan.fused = Fused::one_by_one(&diagram.schedule, &diagram.plan);
        diagram.plan.fused.make_room(&mut diagram.signals);
        Ok(simulation)
    }

    /// A simulation at its initial values.
    pub(crate) fn given(schedule: Arc<Schedule>) -> Result<Self, SimError> {
        methods::check(&schedule)?;
        let mut diagram = Diagram::new(Arc::clone(&schedule));
        let mut x = vec![0.0; schedule.states];
        for block in &schedule.blocks {
            let interface = &block.interface;
            x[block.x..].iter_mut().zip(&interface.states).for_each(|(x, state)| *x = state.initial);
            diagram.d[block.d..]
                .iter_mut()
                .zip(&interface.discrete)
                .for_each(|(d, state)| *d = state.initial);
        }
        diagram.initialize(&mut x).map_err(|_| diagnose::failed(&schedule, &mut diagram))?;
        if let Solver::Variable { rtol, .. } = schedule.settings.solver {
            diagram.tolerate(rtol);
        }
        let is_fixed = matches!(schedule.settings.solver, Solver::Fixed { .. });
        let plan = &diagram.plan;
        let guards = if is_fixed || plan.guarded.is_empty() {
            Vec::new()
        } else {
            let guards = schedule.blocks.iter().flat_map(|block| &block.interface.guards);
            guards.map(|guard| guard.crossing).collect()
        };
        if !guards.is_empty() {
            diagram.looks = Looks::new(guards.len());
        }
        let resolution = Resolution::new(schedule.settings.stop_time);
        let plan = &diagram.plan;
        let moves = schedule.states > 0 || !plan.continuous.is_empty() || is_fixed && plan.stepwise;
        let grid = methods::grid(&schedule).filter(|_| moves).map(|step| Grid::new(step, resolution));
        let mut guards = Guards::new(guards, schedule.states, resolution);
        if !guards.is_empty() {
            let all = schedule.blocks.iter().flat_map(|block| &block.interface.guards);
            guards.kinks = all.map(|guard| guard.kink).collect();
        }
        let mut stepper = methods::stepper(&schedule);
        stepper.iter_mut().for_each(|stepper| stepper.reserve(&diagram));
        Ok(Self {
            stepper,
            t: 0.0,
            hits: Hits::new(&schedule.clock, resolution),
            resolution,
            guards,
            kinks: Kinks::new(&schedule),
            angles: Angles::new(&schedule),
            departure: Departure::new(schedule.states),
            modes: Modes::new(&schedule),
            words: String::with_capacity(WORDS),
            pace: Pace::default(),
            rows: Rows::new(&schedule),
            refine: Refine::new(&schedule),
            past: Past::new(&schedule),
            grid,
            event_times: vec![f64::INFINITY; diagram.plan.timed.len()],
            pending_times: vec![f64::INFINITY; diagram.plan.pending.len()],
            next_update: f64::INFINITY,
            started: false,
            unasked: 0,
            interrupted: false,
            looked: f64::NEG_INFINITY,
            audit: None,
            halves: Halves::new(schedule.settings.solver, x.len()),
            rest: None,
            majors: 0,
            carried: Counts::default(),
            events: 0,
            hit_count: 0,
            relearnt: false,
            sizes: Sizes::new(&x),
            floors: Floors::new(&schedule),
            x,
            diagram,
            schedule,
        })
    }

    /// Times closer to the present one than this are the same time, s.
    pub(crate) fn same(&self) -> f64 {
        self.resolution.same(self.t)
    }

    /// Runs to the stop time of the settings.
    ///
    /// # Errors
    /// See [`SimError::code`].
    pub fn run(&mut self, observer: &mut dyn Observer) -> Result<Ended, SimError> {
        self.run_until(self.schedule.settings.stop_time, observer)
    }

    /// Runs until `end`, s, which is hit exactly. May be called again with a later end.
    ///
    /// # Errors
    /// See [`SimError::code`].
    pub fn run_until(&mut self, end: f64, observer: &mut dyn Observer) -> Result<Ended, SimError> {
        if !end.is_finite() {
            return Err(SimError::new("settings", self.t, format!("the run is to end at {end} s")));
        }
        if !self.started {
            self.start(observer)?;
        }
        while self.t < end {
            if self.diagram.now.fault.ends() {
                return Ok(Ended::Stopped);
            }
            // Who runs again has changed the answer.
            let answered = std::mem::take(&mut self.interrupted);
            // Once at each time, however often a step begins there: so a stop is told by its time alone.
            let is_later = self.t > self.looked;
            self.looked = self.t;
            if !answered {
                let asks = self.asks();
                let stops = is_later && observer.is_waiting(self.t)
                    || asks && observer.progress(self.t, &self.counts()) == Control::Stop;
                if stops {
                    self.interrupted = true;
                    return Ok(Ended::Interrupted);
                }
            }
            self.update()?;
            let stop = self.next_stop(end)?;
            self.look_at_halves(stop.t);
            if self.go_plainly(end, observer)? {
                continue;
            }
            let arrival = self.advance(stop, observer)?;
            self.major(arrival, observer)?;
        }
        Ok(if self.diagram.now.fault.ends() { Ended::Stopped } else { Ended::Finished })
    }

    /// Why a block has ended the run, if one has.
    pub fn stop_reason(&self) -> Option<String> {
        self.diagram.now.fault.end()
    }

    /// Whether it is time to ask the observer.
    fn asks(&mut self) -> bool {
        self.unasked += 1;
        let asks = self.unasked > PATIENCE;
        if asks {
            self.unasked = 0;
        }
        asks
    }

    /// Whether the next question to the observer has to be reached soon.
    pub(crate) fn is_impatient(&mut self) -> bool {
        self.unasked += 1;
        self.unasked >= PATIENCE
    }

    /// When the next major step must be, at the latest, and why.
    pub(crate) fn next_stop(&mut self, end: f64) -> Result<Stop, SimError> {
        self.diagram
            .next_events(&mut self.event_times)
            .map_err(|_| diagnose::failed(&self.schedule, &mut self.diagram))?;
        if let Some(i) = self.event_times.iter().position(|&next| next.is_nan() || next <= self.t) {
            return Err(self.event_in_the_past(self.diagram.plan.timed[i], self.event_times[i]));
        }
        self.past.kink = {
            let next = self.diagram.next_kink();
            self.held(next)?
        };
        self.next_update = {
            let next = self.diagram.next_update();
            self.held(next)?
        };
        let mut stop = Stop::first(self, end);
        if !self.pending_times.is_empty() {
            // What is pending may be far behind the present: it is asked for about the stop.
            let before = stop.t - self.resolution.same(stop.t);
            let asked = self.diagram.pending_events(before, &mut self.pending_times);
            asked.map_err(|_| diagnose::failed(&self.schedule, &mut self.diagram))?;
            stop = stop.at_pending(self);
        }
        Ok(stop)
    }

    fn event_in_the_past(&self, block: usize, next: f64) -> SimError {
        let path = &self.schedule.blocks[block].path;
        SimError::new("time_event", self.t, format!("`{path}` gives {next} s as the time of its next event"))
            .at(path)
            .help("a time event must lie after the present time")
    }

    /// Has every step looked at on a fine grid from now on, for changes of conditions that were passed over. Returns
    /// `false` where there is nothing to audit: a method of fixed step chooses all branches at its steps, and does
    /// not look in between.
    pub fn audit(&mut self) -> bool {
        let fixed = matches!(self.schedule.settings.solver, Solver::Fixed { .. });
        self.audit = (!fixed).then(Audit::default);
        !fixed
    }

    /// What an audit has found so far, if there is one. That includes what [`undeclared`](Self::undeclared) finds now; a run may go on
    /// behind it with other last digits.
    pub fn findings(&mut self) -> Option<Findings> {
        let mut findings = self.audit.as_ref()?.findings(&self.schedule);
        // A run that has failed may be where nothing can be evaluated.
        findings.undeclared = self.undeclared().unwrap_or_default();
        Some(findings)
    }

    /// The compiled diagram.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The compiled diagram, to be shared.
    pub fn shared_schedule(&self) -> Arc<Schedule> {
        Arc::clone(&self.schedule)
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.t
    }

    /// Continuous states of all blocks.
    pub fn states(&self) -> &[f64] {
        &self.x
    }

    /// Discrete states of all blocks.
    pub fn discrete_states(&self) -> &[f64] {
        &self.diagram.d
    }

    /// Values of all signals by their cells, as of the last evaluation; what lies behind those of the schedule is scratch space.
    pub fn signals(&self) -> &[f64] {
        &self.diagram.signals
    }

    /// Values of an output by its path (`arm/base/joint.q`), as of the last evaluation; none if there is no such output.
    /// Of an output of a physical network that the diagram neither reads nor records it is exact only if it was named when the diagram
    /// was compiled (`compile_to_watch`).
    pub fn signal(&self, path: &str) -> Option<&[f64]> {
        let signal = self.schedule.signals.iter().find(|signal| signal.path == path)?;
        Some(&self.diagram.signals[signal.offset..signal.offset + signal.shape.len()])
    }

    /// What is to be said of the accuracy of the run so far: approximations of blocks that have missed the tolerance, and states
    /// that the tolerance has ignored. A method of fixed step, which knows no tolerance, is taken for one of 1e-3.
    pub fn warnings(&mut self) -> Vec<Problem> {
        let rtol = match self.schedule.settings.solver {
            Solver::Variable { rtol, .. } => rtol,
            Solver::Fixed { .. } => UNTOLD,
        };
        let cells = |block: &Instance| block.d..block.d + block.interface.discrete.len();
        let blocks = self.schedule.blocks.iter();
        let told = blocks.flat_map(|block| block.block.warnings(&self.diagram.d[cells(block)], rtol));
        let mut told: Vec<Problem> = told.collect();
        told.extend(self.below_floors());
        told.extend(self.ignored_states());
        // A source that swings within a step puts states off, too.
        told.extend(coarse_step(&self.schedule).or_else(|| self.too_long_for()));
        told
    }

    /// Work done so far.
    pub fn counts(&self) -> Counts {
        let solver = self.stepper.as_ref().map(|stepper| stepper.counts()).unwrap_or_default();
        Counts {
            major: self.majors,
            accepted: self.carried.accepted + solver.accepted,
            rejected: self.carried.rejected + solver.rejected,
            evaluations: self.carried.evaluations + solver.evaluations,
            events: self.events,
            hits: self.hit_count,
            limited: self.carried.limited + solver.limited,
            share: self.stepper.as_ref().and_then(|stepper| stepper.share()),
        }
    }
}

impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("t", &self.t)
            .field("counts", &self.counts())
            .finish_non_exhaustive()
    }
}
