//! Slopes of the map over a period, by the chain rule from hit to hit.
//!
//! A direction in the space of the states is followed through all that the model does within the period: at each instant through
//! the calls of its major pass and through what discrete states become, and in between by the linear equations that follow from
//! the derivatives along the way of the model. Laws that are data give exact slopes, other blocks theirs by differences over their
//! own inputs and states. What the rules do not cover is found by a last look, at differences of the map in one direction.

use std::ops::Range;
use std::sync::Arc;

use blocksim_block::schedule::{Instance, When};
use blocksim_linear::{DMatrix, Instant, Jacobian, jacobian};

use super::{PeriodMap, Place, Witness, cell, course};
use crate::program::spread::written;
use crate::variation::chain::{Chain, Direction, Origin};
use crate::variation::period::course::Accuracy;
use crate::variation::taps::Lever;
use crate::{SimError, Simulation, Snapshot, Tap};

/// Part of what a value is a sum of by which differences in one direction may contradict slopes.
const CONTRADICTS: f64 = 1e-6;
/// The same, in errors of the differences, but no more than this part of what a value is a sum of, and than what counts as nothing.
const ERRORS: f64 = 30.0;
const DOUBTFUL: f64 = 1e-4;
const NOTHING: f64 = 1e-9;
/// What of a difference is noise of the runs, as a part of the size of a state.
const NOISE: f64 = 1e-10;
/// Lengths of the direction in which differences are taken.
const DISTANCES: [f64; 4] = [1.0, 1e-2, 1e-4, 1e-6];

/// Slopes of a [`PeriodMap`] at its states: by these, and behind them by the changes at taps.
#[derive(Debug, Clone)]
pub struct PeriodSlopes {
    /// Of the states at the end of the period.
    pub next: DMatrix<f64>,
    /// Paths of the blocks whose differences have a part in it; without any, all follows from laws.
    pub by_differences: Vec<String>,
    /// Of all signals at the beginning.
    signals: DMatrix<f64>,
    taps: Vec<Tap>,
    levers: Vec<Lever>,
}

impl PeriodSlopes {
    /// Slope of a cell of the schedule at the beginning of the period, as those who read it see it.
    pub fn signal(&self, cell: usize, column: usize) -> f64 {
        let lever = self.taps.iter().position(|tap| tap.cell == cell);
        self.signals[(lever.map_or(cell, |lever| self.levers[lever].seen), column)]
    }

    /// Slope of what the block gives at a tap then.
    pub fn given(&self, tap: usize, column: usize) -> f64 {
        self.signals[(self.levers[tap].given, column)]
    }
}

/// How one direction has come as far as an instant.
#[derive(Debug, Clone)]
struct Rates {
    x: Vec<f64>,
    d: Vec<f64>,
    signals: Vec<f64>,
}

/// The calls that are evaluated at some instants.
struct Linked {
    /// Which rates are hit; none between instants.
    due: Option<Vec<bool>>,
    chain: Chain,
    /// Cells that none of the calls writes.
    kept: Vec<usize>,
}

/// What follows directions.
struct Follower {
    /// A simulation that is put at an instant, to take slopes there.
    probe: Simulation,
    /// One that runs ahead to the next instant.
    scout: Simulation,
    linked: Vec<Linked>,
    direction: Direction,
    dx: Vec<f64>,
    doubts: bool,
    origin: Origin,
    used: Vec<bool>,
}

impl PeriodMap {
    /// Slopes of the map at its states, with the first `inputs` taps as inputs and `outputs` cells of interest. With `doubts`,
    /// differences of blocks count with their errors added. Asks `go` now and then whether to go on.
    ///
    /// # Errors
    /// Why the slopes are not known, in words that go on behind "as": differences of the map are left then.
    pub fn slopes(
        &mut self,
        inputs: usize,
        outputs: &[usize],
        doubts: bool,
        go: &mut dyn FnMut() -> bool,
    ) -> Result<PeriodSlopes, String> {
        if let Some(reason) = self.obstacle(inputs, outputs) {
            return Err(reason);
        }
        let mut follower = Follower::new(self, doubts).map_err(said)?;
        let (point, none) = (self.states.clone(), vec![0.0; self.taps.len()]);
        let mut witness = Witness { simulation: Arc::clone(&self.simulation.schedule), seen: None };
        let jumps = self.begin(&point, &none, &mut witness).map_err(said)?;
        let mut rates = self.directions(inputs);
        let mut signals = None;
        let end = self.period.end;
        loop {
            if !go() {
                return Err("the search was broken off".to_owned());
            }
            let instant = self.simulation.snapshot();
            follower.instant(&instant, &mut rates)?;
            signals.get_or_insert_with(|| {
                DMatrix::from_fn(rates[0].signals.len(), rates.len(), |row, column| {
                    rates[column].signals[row]
                })
            });
            let simulation = &mut self.simulation;
            simulation.update().map_err(said)?;
            if simulation.t >= end {
                break;
            }
            let stop = simulation.next_stop(end).map_err(said)?.t;
            follower.between(&instant, stop.min(end), &mut rates, go)?;
            run_to(simulation, stop, end, &mut witness).map_err(said)?;
            if simulation.t >= end {
                break;
            }
        }
        if jumps || self.simulation.events > 0 || witness.seen.is_some() {
            return Err("something happens within the period that is not smooth".to_owned());
        }
        let d = &self.simulation.diagram.d;
        let row = |place: &Place, rates: &Rates| match *place {
            Place::Continuous(x) => rates.x[x],
            Place::Held(cell) => rates.signals[cell],
            place => rates.d[cell(place, d)],
        };
        let next = DMatrix::from_fn(self.places.len(), rates.len(), |i, j| row(&self.places[i], &rates[j]));
        let blocks = self.simulation.schedule.blocks.iter().zip(&follower.used);
        let found = PeriodSlopes {
            next,
            by_differences: blocks.filter(|(_, used)| **used).map(|(block, _)| block.path.clone()).collect(),
            signals: signals.unwrap_or_else(|| unreachable!("the first instant is followed")),
            taps: self.taps.clone(),
            levers: self.levers.clone(),
        };
        match doubts {
            true => Ok(found),
            false => self.contradiction(&found, inputs, outputs).map_or(Ok(found), Err),
        }
    }

    /// A unit vector for each state and each change at a tap.
    fn directions(&self, inputs: usize) -> Vec<Rates> {
        let diagram = &self.simulation.diagram;
        let still = Rates {
            x: vec![0.0; diagram.schedule.states],
            d: vec![0.0; diagram.d.len()],
            signals: vec![0.0; diagram.signals.len()],
        };
        let mut all = vec![still; self.places.len() + inputs];
        for (rates, place) in all.iter_mut().zip(&self.places) {
            match *place {
                Place::Continuous(x) => rates.x[x] = 1.0,
                Place::Held(cell) => rates.signals[cell] = 1.0,
                place => rates.d[cell(place, &diagram.d)] = 1.0,
            }
        }
        for (rates, lever) in all[self.places.len()..].iter_mut().zip(&self.levers) {
            rates.signals[lever.change()] = 1.0;
        }
        all
    }

    /// A block on the way that cannot be followed, with the reason.
    fn obstacle(&self, inputs: usize, outputs: &[usize]) -> Option<String> {
        let schedule = &self.simulation.schedule;
        let cells_of = |block: &Instance| {
            let width = block.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
            block.y..block.y + width
        };
        let reads = |block: &Instance, marked: &[bool]| {
            let mut spans = block.gather.iter();
            spans.any(|&(from, len)| marked[from as usize..(from + len) as usize].contains(&true))
        };
        let has_place = |block: &Instance| {
            let d = block.d..block.d + block.interface.discrete.len();
            let is_own = |place: &Place| match *place {
                Place::Continuous(_) => false,
                Place::Discrete(cell) => d.contains(&cell),
                Place::Ring { next, .. } => d.contains(&next),
                Place::Held(cell) => cells_of(block).contains(&cell),
            };
            !block.interface.states.is_empty() || self.places.iter().any(is_own)
        };
        let owns: Vec<bool> = schedule.blocks.iter().map(has_place).collect();
        // What moves with the states and changes, and what states and outputs depend on.
        let mut moves = vec![false; schedule.initial_signals.len()];
        let mut counts = moves.clone();
        self.levers.iter().take(inputs).for_each(|lever| moves[lever.change()] = true);
        for &cell in outputs {
            let tap = self.taps.iter().position(|tap| tap.cell == cell);
            counts[tap.map_or(cell, |tap| self.levers[tap].seen)] = true;
            tap.iter().for_each(|&tap| counts[self.levers[tap].given] = true);
        }
        let (mut is_moved, mut is_needed) = (owns.clone(), owns.clone());
        let mut grows = true;
        while grows {
            grows = false;
            for (number, block) in schedule.blocks.iter().enumerate() {
                let moved = is_moved[number] || reads(block, &moves);
                if moved && (!is_moved[number] || cells_of(block).any(|cell| !moves[cell])) {
                    cells_of(block).for_each(|cell| moves[cell] = true);
                    (is_moved[number], grows) = (true, true);
                }
                let needed = is_needed[number] || cells_of(block).any(|cell| counts[cell]);
                let all = |&(from, len): &(u32, u32)| from as usize..(from + len) as usize;
                if needed
                    && (!is_needed[number] || block.gather.iter().flat_map(all).any(|cell| !counts[cell]))
                {
                    block.gather.iter().flat_map(all).for_each(|cell| counts[cell] = true);
                    (is_needed[number], grows) = (true, true);
                }
            }
        }
        let on_the_way =
            schedule.blocks.iter().enumerate().filter(|(number, _)| is_moved[*number] && is_needed[*number]);
        on_the_way.into_iter().find_map(|(_, block)| {
            let interface = &block.interface;
            let reason = match () {
                () if interface.accepts || interface.remembers.is_some() || interface.holds.is_some() => {
                    "answers from memory"
                }
                () if interface.subdivides => "is solved by itself within the period",
                () if interface.time_events && !block.gather.is_empty() => {
                    "does something at times that may depend on its inputs"
                }
                () if interface.settles && block.law.as_ref().is_none_or(|law| law.settled.is_empty()) => {
                    "has modes that no law records"
                }
                () => return None,
            };
            Some(format!("`{}` {reason}", block.path))
        })
    }

    /// A value of the map whose slopes differ from differences in one direction, in which all states and changes move. A distance at
    /// which limits are reached shows the slopes behind these, so shorter ones count as well.
    fn contradiction(&mut self, found: &PeriodSlopes, inputs: usize, outputs: &[usize]) -> Option<String> {
        let n = self.places.len();
        let parts = (0..n + inputs).map(|k| {
            let size = self.states.get(k).map_or(1.0, |x| x.abs().max(1.0));
            // Neither equal nor small parts, of both signs.
            let part = (k as f64 * 0.618_033_988_75).fract() - 0.5;
            size * (part + 0.5_f64.copysign(part))
        });
        let direction: Vec<f64> = parts.collect();
        let slope = |row: usize, column: usize| match row.checked_sub(n) {
            None => found.next[(row, column)],
            Some(output) => found.signal(outputs[output], column),
        };
        let mut open: Vec<usize> = (0..n + outputs.len()).collect();
        for distance in DISTANCES {
            let differences = match self.differences(&direction, distance, outputs) {
                Ok(differences) => differences,
                Err(error) => return Some(error.message),
            };
            open.retain(|&row| {
                let parts = direction.iter().enumerate().map(|(column, part)| slope(row, column) * part);
                let (sum, size) =
                    parts.fold((0.0, 0.0), |(sum, size), part: f64| (sum + part, size + part.abs()));
                let value = differences.value[(row, 0)] / distance;
                let error = differences.error[(row, 0)] / distance;
                let doubt = (ERRORS * error).min(DOUBTFUL * size + NOTHING);
                // A run has errors of its own, whatever is left of a state in the end.
                let noise = NOISE * self.states.get(row).map_or(1.0, |x| x.abs().max(1.0));
                let agrees = (sum - value).abs() <= CONTRADICTS * size + doubt + noise;
                !agrees
            });
            if open.is_empty() {
                return None;
            }
        }
        let name = match open[0].checked_sub(n) {
            None => format!("the next `{}`", self.names[open[0]]),
            Some(_) => "an output".to_owned(),
        };
        Some(format!("the slopes of {name} that were followed are not those of the model"))
    }

    /// Differences of the map and of `outputs` along a direction, as a function of its part times `distance`.
    fn differences(
        &mut self,
        direction: &[f64],
        distance: f64,
        outputs: &[usize],
    ) -> Result<Jacobian, SimError> {
        let n = self.places.len();
        let (states, mut change) = (self.states.clone(), vec![0.0; self.taps.len()]);
        let mut at = states.clone();
        jacobian(&[0.0], n + outputs.len(), |s, out| {
            let by = s[0] * distance;
            at.iter_mut().zip(&states).zip(direction).for_each(|((at, x), part)| *at = x + by * part);
            change.iter_mut().zip(&direction[n..]).for_each(|(change, part)| *change = by * part);
            let (next, values) = out.split_at_mut(n);
            self.evaluate(&at, &change, next)?;
            values.iter_mut().zip(outputs).for_each(|(value, &cell)| *value = self.signal(cell));
            Ok(())
        })
    }
}

fn said(error: SimError) -> String {
    error.message
}

/// Runs up to the instant `stop`, which is evaluated unless it is the end of the period.
fn run_to(simulation: &mut Simulation, stop: f64, end: f64, witness: &mut Witness) -> Result<(), SimError> {
    loop {
        let next = simulation.next_stop(stop.min(end))?;
        let arrival = simulation.advance(next, witness)?;
        if simulation.t >= end {
            return Ok(());
        }
        simulation.major(arrival, witness)?;
        if simulation.t >= stop {
            return Ok(());
        }
        simulation.update()?;
    }
}

impl Follower {
    fn new(map: &PeriodMap, doubts: bool) -> Result<Self, SimError> {
        let schedule = &map.simulation.schedule;
        let probe = Simulation::given(Arc::clone(schedule))?;
        let direction = Direction::none(&probe.diagram, 0);
        Ok(Self {
            scout: Simulation::given(Arc::clone(schedule))?,
            linked: Vec::new(),
            direction,
            dx: vec![0.0; schedule.states],
            doubts,
            origin: Origin::Laws,
            used: vec![false; schedule.blocks.len()],
            probe,
        })
    }

    /// The calls at instants at which these rates are hit, or between instants.
    fn linked(&mut self, due: Option<&[bool]>) -> usize {
        if let Some(known) = self.linked.iter().position(|linked| linked.due.as_deref() == due) {
            return known;
        }
        let (diagram, schedule) = (&self.probe.diagram, &self.probe.schedule);
        let asked = schedule.steps.iter().map(|step| match step.when {
            When::Continuous => true,
            When::Major => due.is_some(),
            When::Sampled(rate) => due.is_some_and(|due| due[rate as usize]),
            When::Constant => false,
        });
        // A loop is gone around as a whole.
        let mut asked: Vec<bool> = asked.collect();
        for ring in &schedule.loops {
            let calls = ring.first..ring.first + ring.count;
            let any = asked[calls.clone()].contains(&true);
            asked[calls].fill(any);
        }
        let mut chain = Chain::new(diagram, &asked, &[]);
        for updated in &diagram.plan.updated {
            if due.is_some_and(|due| due[updated.rate]) {
                chain.add_update(diagram, updated.block);
            }
        }
        for (number, block) in schedule.blocks.iter().enumerate() {
            // What is sampled chooses at its hits alone.
            let chooses = block.rate.is_none_or(|rate| due.is_some_and(|due| due[rate]));
            if block.law.as_ref().is_some_and(|law| !law.settled.is_empty()) && chooses {
                chain.add_settled(diagram, number);
            }
        }
        chain.doubt(self.doubts);
        let mut kept = vec![true; diagram.signals.len()];
        for (step, _) in schedule.steps.iter().zip(&asked).filter(|(_, asked)| **asked) {
            written(schedule, step).for_each(|cell| kept[cell] = false);
        }
        let kept = (0..kept.len()).filter(|&cell| kept[cell]).collect();
        self.linked.push(Linked { due: due.map(<[bool]>::to_vec), chain, kept });
        self.linked.len() - 1
    }

    /// Takes slopes where the probe is. Returns the number of the calls.
    fn fix(&mut self, due: Option<&[bool]>, all: &[Rates]) -> usize {
        let number = self.linked(due);
        let diagram = &mut self.probe.diagram;
        let Linked { chain, kept, .. } = &mut self.linked[number];
        let moves = |&&cell: &&usize| all.iter().any(|rates| rates.signals[cell] != 0.0);
        let moving: Vec<usize> = kept.iter().filter(moves).copied().collect();
        let own = diagram.plan.updated.iter().map(|updated| diagram.plan.units[updated.block].d.range());
        let varies = |d: &Range<usize>| all.iter().any(|rates| rates.d[d.clone()].iter().any(|d| *d != 0.0));
        let varies: Vec<Range<usize>> = own.filter(varies).collect();
        chain.fix(diagram, &moving, &varies);
        number
    }

    /// Follows one direction where slopes were taken; the states of the model move along `x`.
    fn along(&mut self, number: usize, x: Option<usize>, rates: Option<&Rates>) -> Result<(), String> {
        let Self { probe, direction, linked, dx, origin, used, .. } = self;
        let Linked { kept, .. } = &linked[number];
        direction.x.fill(0.0);
        direction.d.fill(0.0);
        direction.cells.clear();
        x.into_iter().for_each(|x| direction.x[x] = 1.0);
        if let Some(rates) = rates {
            direction.d.copy_from_slice(&rates.d);
            let moving = kept.iter().map(|&cell| (cell, rates.signals[cell]));
            direction.cells.extend(moving.filter(|(_, rate)| *rate != 0.0));
            if x.is_none() && linked[number].due.is_some() {
                direction.x.copy_from_slice(&rates.x);
            }
        }
        let chain = &mut linked[number].chain;
        let found = chain.along(&probe.diagram, direction, dx);
        *origin = (*origin).max(found);
        if found == Origin::Unknown {
            return Err(self.unknown(number));
        }
        if let Some(block) = chain.moves_settled(&probe.diagram, direction) {
            let path = &probe.schedule.blocks[block].path;
            return Err(format!(
                "`{path}` holds a value that it takes between samples, or is about to change"
            ));
        }
        chain.used().for_each(|block| used[block] = true);
        Ok(())
    }

    /// What is not known of the slopes along the last direction.
    fn unknown(&self, number: usize) -> String {
        let blocks = &self.probe.schedule.blocks;
        match self.linked[number].chain.unknown() {
            Some(block) => format!("`{}` has a kink there, or a slope that is not known", blocks[block].path),
            None => "there is a slope that is not known".to_owned(),
        }
    }

    /// Follows all directions through an instant.
    fn instant(&mut self, instant: &Snapshot, all: &mut [Rates]) -> Result<(), String> {
        self.probe.restore(instant).map_err(said)?;
        let due = self.probe.hits.due.clone();
        let number = self.fix(Some(&due), all);
        let mut next = Vec::new();
        for rates in all {
            self.along(number, None, Some(rates))?;
            let Self { probe, direction, linked, origin, used, .. } = self;
            let chain = &mut linked[number].chain;
            next.clear();
            let found = chain.updates(&probe.diagram, direction, |d, rate| next.push((d, rate)));
            *origin = (*origin).max(found);
            if found == Origin::Unknown {
                return Err(self.unknown(number));
            }
            chain.used().for_each(|block| used[block] = true);
            next.iter().for_each(|(d, rate)| rates.d[*d] = *rate);
            rates.signals.iter_mut().enumerate().for_each(|(cell, rate)| *rate = chain.rate(cell));
        }
        Ok(())
    }

    /// Follows all directions from an instant, which is evaluated, to the next one.
    fn between(
        &mut self,
        instant: &Snapshot,
        stop: f64,
        all: &mut [Rates],
        go: &mut dyn FnMut() -> bool,
    ) -> Result<(), String> {
        let n = self.dx.len();
        if n == 0 {
            return Ok(());
        }
        let (begin, length) = (instant.time(), stop - instant.time());
        // Directions in which something is held that is not still.
        let number = self.linked(None);
        let kept = self.linked[number].kept.clone();
        let is_held = |rates: &Rates| {
            rates.d.iter().any(|d| *d != 0.0) || kept.iter().any(|&cell| rates.signals[cell] != 0.0)
        };
        let held: Vec<usize> = (0..all.len()).filter(|&column| is_held(&all[column])).collect();
        let mut witness = Witness { simulation: Arc::clone(&self.probe.schedule), seen: None };
        let at = |places: &[f64], accuracy: &mut Accuracy| -> Result<Vec<Instant>, String> {
            self.scout.restore(instant).map_err(said)?;
            self.scout.update().map_err(said)?;
            let mut found = Vec::with_capacity(places.len());
            for (k, place) in places.iter().enumerate() {
                if !go() {
                    return Err("the search was broken off".to_owned());
                }
                if k > 0 {
                    self.scout.update().map_err(said)?;
                }
                run_to(&mut self.scout, begin + place * length, f64::INFINITY, &mut witness).map_err(said)?;
                self.probe.restore(&self.scout.snapshot()).map_err(said)?;
                let number = self.fix(None, all);
                let mut slopes = Instant { a: DMatrix::zeros(n, n), b: DMatrix::zeros(n, held.len()) };
                for x in 0..n {
                    self.along(number, Some(x), None)?;
                    slopes.a.column_mut(x).copy_from_slice(&self.dx);
                }
                for (column, &rates) in held.iter().enumerate() {
                    self.along(number, None, Some(&all[rates]))?;
                    slopes.b.column_mut(column).copy_from_slice(&self.dx);
                }
                found.push(slopes);
            }
            if self.origin == Origin::Differences {
                *accuracy = Accuracy::OF_DIFFERENCES;
            }
            Ok(found)
        };
        let found = course::over(length, at)?;
        if self.scout.events > 0 || witness.seen.is_some() {
            return Err("something happens within the period that is not smooth".to_owned());
        }
        let (phi, gamma) = found.ok_or_else(|| {
            format!("slopes change too much, or are too rough, to be followed over {length:.3e} s")
        })?;
        for rates in all.iter_mut() {
            let x = &phi * DMatrix::from_column_slice(n, 1, &rates.x);
            rates.x.copy_from_slice(x.as_slice());
        }
        for (column, &rates) in held.iter().enumerate() {
            all[rates].x.iter_mut().zip(gamma.column(column).iter()).for_each(|(x, by)| *x += by);
        }
        Ok(())
    }
}
