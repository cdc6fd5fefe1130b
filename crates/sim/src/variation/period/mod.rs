//! The map of a model from one sample hit to that a period later.
//!
//! What a sampled loop does from hit to hit is a function of the states at the hit: continuous ones, those of sampled blocks, and
//! outputs of blocks that are not due there and hold. The function is evaluated by running the model over the period,
//! with all hits in between, so that several rates and holds are what they are. Its slopes are the matrices of the loop in discrete time.

mod course;
mod slopes;

use std::sync::Arc;

use blocksim_block::Invariant;
use blocksim_block::schedule::{Clock, Instance, Schedule, Solver, Steady, VariableMethod, When};
use blocksim_signal::Kind;

use crate::diagnose::state_name;
use crate::program::spread::written;
use crate::variation::taps::{Lever, with_levers};
use blocksim_block::Resolution;
pub use slopes::PeriodSlopes;

use crate::{Ended, Observer, SimError, Simulation, Snapshot, Tap, state_names};

/// Relative tolerance of the run over a period.
const RTOL: f64 = 1e-12;
/// Most sample hits in a period.
const MOST_HITS: u64 = 20_000;

/// The period of the rates of some blocks, and when it begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    /// When it begins, s.
    pub begin: f64,
    /// When it ends, s.
    pub end: f64,
    /// Its length, s.
    pub length: f64,
}

/// Where a state of the map lies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// A continuous state.
    Continuous(usize),
    /// A discrete state.
    Discrete(usize),
    /// Entry of a ring, counted from the oldest number on: the cell of the number, the first of the entries, how many numbers there are in
    /// all and in one entry.
    Ring { next: usize, first: usize, count: usize, width: usize, at: usize },
    /// A signal that a sampled block holds.
    Held(usize),
}

/// A model over one period.
#[derive(Debug)]
pub struct PeriodMap {
    simulation: Simulation,
    start: Snapshot,
    period: Period,
    taps: Vec<Tap>,
    levers: Vec<Lever>,
    /// Values at the taps at the start.
    held: Vec<f64>,
    places: Vec<Place>,
    names: Vec<String>,
    states: Vec<f64>,
    /// Signals at the start of the last evaluation.
    signals: Vec<f64>,
    /// Discrete states that are modes, and their values at the end of the period.
    modes: Vec<usize>,
    after: Option<Vec<f64>>,
}

impl Period {
    /// The shortest period of the rates of these blocks of a schedule, or the one `given`, s, at the first instant not before
    /// `t` at which most of them are due.
    ///
    /// # Errors
    /// `linearise` if there are no rates and no period is given, if the rates meet too rarely, or if the given period is not a multiple of
    /// theirs.
    pub fn of(
        schedule: &Schedule,
        involved: &[usize],
        t: f64,
        given: Option<f64>,
    ) -> Result<Period, SimError> {
        let wrong = |message: String, help: &str| SimError::new("linearise", t, message).help(help);
        let clock = &schedule.clock;
        let mut rates: Vec<usize> =
            involved.iter().filter_map(|&block| schedule.blocks[block].rate).collect();
        rates.sort_unstable();
        rates.dedup();
        if rates.is_empty() {
            let length = given.ok_or_else(|| {
                wrong(
                    "nothing that takes part is sampled, so that there is no period".to_owned(),
                    "name the period, as in `--sampled=1ms`, or leave `--sampled` away",
                )
            })?;
            return Ok(Period { begin: t, end: t + length, length });
        }
        let periods: Vec<u64> = rates.iter().map(|&rate| clock.rates[rate].period).collect();
        let listed = listed(clock, &rates);
        let fastest = periods.iter().copied().min().unwrap_or(1);
        let common = periods.iter().try_fold(1_u64, |all, &period| common_multiple(all, period));
        let common = common.filter(|common| common / fastest <= MOST_HITS).ok_or_else(|| {
            wrong(
                format!("the sample times {listed} have no common period of fewer than {MOST_HITS} hits"),
                "choose sample times that are multiples of each other",
            )
        })?;
        let ticks = match given {
            None => common,
            Some(given) => {
                let times = (given / clock.time(common)).round();
                if times < 1.0 || (given - times * clock.time(common)).abs() > 1e-9 * given {
                    let message = format!(
                        "a period of {given} s is not a multiple of that of the sample times {listed}, {} s",
                        clock.time(common)
                    );
                    return Err(wrong(
                        message,
                        "leave the period away, as in `--sampled`, for the shortest one",
                    ));
                }
                if times * common as f64 / fastest as f64 > MOST_HITS as f64 {
                    return Err(wrong(
                        format!("a period of {given} s has more than {MOST_HITS} sample hits"),
                        "leave the period away, as in `--sampled`, for the shortest one",
                    ));
                }
                times as u64 * common
            }
        };
        let same = Resolution::new(schedule.settings.stop_time).same(t);
        let begin = first_of_most(clock, &rates, t, same, common);
        Ok(Period { begin: clock.time(begin), end: clock.time(begin + ticks), length: clock.time(ticks) })
    }
}

/// Rates in words.
fn listed(clock: &Clock, rates: &[usize]) -> String {
    let all: Vec<String> =
        rates.iter().take(4).map(|&rate| format!("{} s", clock.time(clock.rates[rate].period))).collect();
    let more = rates.len().saturating_sub(all.len());
    if more > 0 { format!("{} and {more} more", all.join(", ")) } else { all.join(", ") }
}

fn common_multiple(a: u64, b: u64) -> Option<u64> {
    let (mut large, mut small) = (a, b);
    while small > 0 {
        (large, small) = (small, large % small);
    }
    (a / large).checked_mul(b)
}

/// The first tick not before `t` at which most of the rates are hit, within a common period.
fn first_of_most(clock: &Clock, rates: &[usize], t: f64, same: f64, common: u64) -> u64 {
    let hits = |rate: usize| {
        let rate = clock.rates[rate];
        let passed = ((t - clock.time(rate.offset)) / clock.time(rate.period)).floor().max(0.0) as u64;
        let first = rate.offset + passed * rate.period;
        let first = if clock.time(first) < t - same { first + rate.period } else { first };
        (0..common / rate.period).map(move |k| first + k * rate.period)
    };
    let due = |tick: u64| {
        let hit = |&&rate: &&usize| {
            let rate = clock.rates[rate];
            tick >= rate.offset && (tick - rate.offset).is_multiple_of(rate.period)
        };
        rates.iter().filter(hit).count()
    };
    let ticks = rates.iter().flat_map(|&rate| hits(rate));
    ticks.min_by_key(|&tick| (rates.len() - due(tick), tick)).unwrap_or(0)
}

impl PeriodMap {
    /// The map over a period of a model that is run until it begins, with these blocks in it. With `steady`, states are sought
    /// near there at which nothing moves; returns the names of those that move all the same, as nothing depends on them.
    ///
    /// # Errors
    /// See [`SimError::code`]; `linearise` if something happens within the period, or a block that takes part answers from memory.
    /// Nothing if the observer has stopped the run.
    pub fn new(
        schedule: &Schedule,
        (involved, period): (&[usize], Period),
        taps: Vec<Tap>,
        steady: bool,
        observer: &mut dyn Observer,
    ) -> Result<Option<(PeriodMap, Vec<String>)>, SimError> {
        let wrong =
            |message: String, help: &str| SimError::new("linearise", period.begin, message).help(help);
        for block in involved.iter().map(|&block| &schedule.blocks[block]) {
            let interface = &block.interface;
            if interface.remembers.is_some() || interface.accepts {
                let message =
                    format!("`{}` answers from memory, which has no finite number of states", block.path);
                let help = "put a `Delay` of whole samples or a law without memory in its place, or linearise without \
                            `--sampled`";
                return Err(wrong(message, help).at(&block.path));
            }
            if interface.subdivides {
                let message = format!("`{}` is updated at times of its own within the period", block.path);
                let help = "a trigger does that, and a circuit that switches by itself: use averaged converters, or linearise \
                            without `--sampled`";
                return Err(wrong(message, help).at(&block.path));
            }
        }
        let cells: Vec<usize> = taps.iter().map(|tap| tap.cell).collect();
        let (mut schedule, levers) = with_levers(schedule, &cells)?;
        schedule.settings.solver = exact(schedule.settings.solver, period.length);
        let schedule = Arc::new(schedule);
        let mut simulation = Simulation::new(Arc::clone(&schedule))?;
        if !simulation.started {
            simulation.start(observer)?;
        }
        if simulation.run_until(period.begin, observer)? == Ended::Interrupted {
            return Ok(None);
        }
        let adrift = match steady {
            false => Vec::new(),
            true => {
                let mut go =
                    || observer.progress(period.begin, &crate::Counts::default()) == crate::Control::Go;
                let rest = simulation.seek_rest(&Steady::default(), false, &mut go)?;
                rest.adrift.into_iter().map(|(name, _)| name).collect()
            }
        };
        let start = simulation.snapshot();
        let held = levers.iter().map(|lever| simulation.diagram.signals[lever.given]).collect();
        let (places, names) = places(&simulation, involved);
        let d = &simulation.diagram.d;
        let states = places.iter().map(|place| match *place {
            Place::Continuous(x) => simulation.x[x],
            Place::Held(cell) => simulation.diagram.signals[cell],
            place => d[cell(place, d)],
        });
        let states = states.collect();
        let modes = modes(&schedule, &places);
        let signals = simulation.diagram.signals.clone();
        let mut map = PeriodMap {
            simulation,
            start,
            period,
            taps,
            levers,
            held,
            places,
            names,
            states,
            signals,
            modes,
            after: None,
        };
        let (point, rest) = (map.states.clone(), vec![0.0; map.taps.len()]);
        map.evaluate(&point, &rest, &mut vec![0.0; point.len()])?;
        map.after = Some(map.modes.iter().map(|&mode| map.simulation.diagram.d[mode]).collect());
        Ok(Some((map, adrift)))
    }

    /// Runs over the period from other states at its beginning, with `change` added at each tap during the whole of it; writes the
    /// states at its end.
    ///
    /// # Errors
    /// See [`SimError::code`]; `linearise` if something happens within the period, or modes are others at its end.
    pub fn evaluate(&mut self, states: &[f64], change: &[f64], next: &mut [f64]) -> Result<(), SimError> {
        let mut witness = Witness { simulation: Arc::clone(&self.simulation.schedule), seen: None };
        let mut jumped = self.begin(states, change, &mut witness)?;
        let simulation = &mut self.simulation;
        let end = self.period.end;
        let mut events = 0;
        loop {
            simulation.update()?;
            if simulation.t >= end {
                break;
            }
            let stop = simulation.next_stop(end)?;
            let arrival = simulation.advance(stop, &mut witness)?;
            events += simulation.events;
            simulation.events = 0;
            if simulation.t >= end {
                break;
            }
            simulation.major(arrival, &mut witness)?;
            jumped |= witness.seen.is_some();
        }
        if events > 0 || jumped || witness.seen.is_some() {
            return Err(self.eventful(witness.seen));
        }
        let simulation = &self.simulation;
        let now = |mode: &usize| simulation.diagram.d[*mode];
        let other =
            |after: &Vec<f64>| self.modes.iter().zip(after).position(|(mode, after)| now(mode) != *after);
        if let Some(mode) = self.after.as_ref().and_then(other) {
            return Err(self.eventful(Some(mode_name(&simulation.schedule, self.modes[mode]))));
        }
        self.ends(next);
        Ok(())
    }

    /// Goes to the beginning of the period, with other states and changes at the taps, and evaluates it. Returns whether anything jumps
    /// there.
    fn begin(&mut self, states: &[f64], change: &[f64], witness: &mut Witness) -> Result<bool, SimError> {
        self.place(states, change)?;
        let jumped = self.simulation.repeat_instant(witness)?;
        self.signals.copy_from_slice(&self.simulation.diagram.signals);
        Ok(jumped)
    }

    /// Goes to the beginning of the period, with other states and changes at the taps.
    fn place(&mut self, states: &[f64], change: &[f64]) -> Result<(), SimError> {
        let simulation = &mut self.simulation;
        simulation.restore(&self.start)?;
        for (place, &value) in self.places.iter().zip(states) {
            match *place {
                Place::Continuous(x) => simulation.x[x] = value,
                Place::Held(cell) => simulation.diagram.signals[cell] = value,
                place => {
                    let cell = cell(place, &simulation.diagram.d);
                    simulation.diagram.d[cell] = value;
                }
            }
        }
        for (n, lever) in self.levers.iter().enumerate() {
            let held = self.taps[n].open.then_some(self.held[n]);
            lever.set(&mut simulation.diagram.signals, held, change[n]);
        }
        Ok(())
    }

    /// What states obey wherever the model can be, at other ones at the beginning of the period. Nothing jumps there: beside what they
    /// obey, contacts would make them obey it again.
    ///
    /// # Errors
    /// See [`SimError::code`].
    pub fn invariants(&mut self, states: &[f64]) -> Result<Vec<Invariant>, SimError> {
        self.place(states, &vec![0.0; self.taps.len()])?;
        let simulation = &mut self.simulation;
        let evaluated = simulation.diagram.continuous(simulation.t, &simulation.x);
        simulation.held(evaluated)?;
        let mut found = simulation.diagram.invariants();
        let place = |x: usize| self.places.iter().position(|place| *place == Place::Continuous(x));
        for invariant in &mut found {
            for states in &mut invariant.followers {
                *states = states.iter().filter_map(|x| place(*x)).collect();
            }
        }
        Ok(found)
    }

    /// The states where the simulation is.
    fn ends(&self, next: &mut [f64]) {
        let simulation = &self.simulation;
        for (next, place) in next.iter_mut().zip(&self.places) {
            *next = match *place {
                Place::Continuous(x) => simulation.x[x],
                Place::Held(cell) => simulation.diagram.signals[cell],
                place => simulation.diagram.d[cell(place, &simulation.diagram.d)],
            };
        }
    }

    fn eventful(&self, what: Option<String>) -> SimError {
        let Period { begin, length, .. } = self.period;
        let what = what.unwrap_or_else(|| "a condition changes".to_owned());
        let message = format!("within the period of {length} s something happens that is not smooth: {what}");
        SimError::new("linearise", begin, message).help(
            "choose an instant with --at from which on modes stay for a period, or --steady; or linearise without --sampled",
        )
    }

    /// States at the beginning of the period.
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    /// Their names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The period.
    pub fn period(&self) -> Period {
        self.period
    }

    /// Cuts taps or closes them.
    pub fn open(&mut self, open: &[bool]) {
        self.taps.iter_mut().zip(open).for_each(|(tap, open)| tap.open = *open);
    }

    /// Value of a cell of the schedule at the beginning of the last period, as those who read it got it.
    pub fn signal(&self, cell: usize) -> f64 {
        let lever = self.taps.iter().position(|tap| tap.cell == cell);
        self.signals[lever.map_or(cell, |lever| self.levers[lever].seen)]
    }

    /// What the block gave at a tap then, without the change.
    pub fn given(&self, tap: usize) -> f64 {
        self.signals[self.levers[tap].given]
    }

    /// Discrete states of all blocks at the beginning of the period.
    pub fn discrete(&self) -> &[f64] {
        self.start.discrete()
    }
}

/// A method that leaves hardly any error over a period: of the kind of the one given.
fn exact(solver: Solver, length: f64) -> Solver {
    let method = match solver {
        Solver::Fixed { .. } => VariableMethod::Dop853,
        Solver::Variable { method, .. } => match method {
            VariableMethod::Ode23 | VariableMethod::Ode45 | VariableMethod::Dop853 => VariableMethod::Dop853,
            VariableMethod::Auto
            | VariableMethod::Ode23t
            | VariableMethod::Ode23tb
            | VariableMethod::Ode15s
            | VariableMethod::Radau5
            | VariableMethod::Rodas4
            | VariableMethod::RosW3 => VariableMethod::Radau5,
        },
    };
    let max_step = match solver {
        Solver::Variable { max_step, .. } => max_step.min(length),
        Solver::Fixed { .. } => length,
    };
    Solver::Variable { method, rtol: RTOL, atol: None, max_step }
}

/// Where the states of the map lie, and what they are called.
fn places(simulation: &Simulation, involved: &[usize]) -> (Vec<Place>, Vec<String>) {
    let schedule = &simulation.schedule;
    let mut names = state_names(schedule);
    let mut places: Vec<Place> = (0..schedule.states).map(Place::Continuous).collect();
    for block in involved.iter().map(|&block| &schedule.blocks[block]) {
        // Of what settles, the discrete states are modes.
        if block.rate.is_none() || block.interface.settles {
            continue;
        }
        let count = block.interface.discrete.len();
        let ring = block.interface.ring;
        let named = |n: usize| state_name(block, &block.interface.discrete[n].name());
        for n in 0..ring.map_or(count, |ring| ring.next.min(ring.first)) {
            places.push(Place::Discrete(block.d + n));
            names.push(named(n));
        }
        if let Some(ring) = ring {
            let entries = count - ring.first;
            for at in 0..entries {
                let (next, first) = (block.d + ring.next, block.d + ring.first);
                places.push(Place::Ring { next, first, count: entries, width: ring.width, at });
                names.push(named(ring.first + at));
            }
        }
    }
    let included: Vec<usize> = involved.iter().filter_map(|&block| schedule.blocks[block].rate).collect();
    for step in &schedule.steps {
        let When::Sampled(rate) = step.when else { continue };
        let rate = rate as usize;
        let is_lever = schedule.blocks[step.block as usize].kind == "Lever";
        if simulation.hits.due[rate] || !included.contains(&rate) || is_lever {
            continue;
        }
        for cell in written(schedule, step) {
            let signal =
                schedule.signals.iter().find(|s| (s.offset..s.offset + s.shape.len()).contains(&cell));
            if let Some(signal) = signal.filter(|signal| signal.kind == Kind::Real) {
                places.push(Place::Held(cell));
                names.push(match signal.shape.len() {
                    1 => signal.path.clone(),
                    _ => format!("{}[{}]", signal.path, cell - signal.offset),
                });
            }
        }
    }
    (places, names)
}

/// Which discrete state a place is now.
fn cell(place: Place, d: &[f64]) -> usize {
    match place {
        Place::Ring { next, first, count, width, at } => first + (d[next] as usize * width + at) % count,
        Place::Discrete(cell) | Place::Continuous(cell) | Place::Held(cell) => cell,
    }
}

/// Discrete states that are modes: what blocks settle, where its changes have names.
fn modes(schedule: &Schedule, places: &[Place]) -> Vec<usize> {
    let of_block = |block: &Instance| -> Vec<usize> {
        let settles = block.interface.settles && !block.interface.time_events;
        let states = block.interface.discrete.iter().enumerate().filter(|_| settles);
        let modes = states.filter(|(_, state)| state.changes.is_some() || state.name().contains("mode"));
        modes.map(|(n, _)| block.d + n).collect()
    };
    let all = schedule.blocks.iter().flat_map(of_block);
    all.filter(|&mode| !places.contains(&Place::Discrete(mode))).collect()
}

/// A mode in words.
fn mode_name(schedule: &Schedule, mode: usize) -> String {
    let found = schedule.blocks.iter().find_map(|block| {
        let state = block.interface.discrete.get(mode.checked_sub(block.d)?)?;
        Some(state_name(block, &state.name()))
    });
    format!("`{}` changes", found.unwrap_or_else(|| "a mode".to_owned()))
}

/// Sees the first event that is not one of time alone.
struct Witness {
    simulation: Arc<Schedule>,
    seen: Option<String>,
}

impl Observer for Witness {
    fn row(&mut self, _t: f64, _values: &[f64]) {}

    fn event(&mut self, _t: f64, path: &str, what: &str) {
        let block = self.simulation.blocks.iter().find(|block| block.path == path && block.kind != "Lever");
        if self.seen.is_none() && !block.is_some_and(|block| block.interface.time_events) {
            self.seen = Some(format!("`{path}` {what}"));
        }
    }
}
