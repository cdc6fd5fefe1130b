//! States that have been below the least value that their law knows: temperatures below absolute zero, pressures below that of a
//! vacuum.
//!
//! The equations go on there, and so does the run; what it says from there on is no physics.

use blocksim_block::Floor;
use blocksim_block::problem::Problem;
use blocksim_block::schedule::Schedule;

use crate::Simulation;
use crate::diagnose::{number, state_name};

/// Below its floor by this part of its largest magnitude a state may be by the errors of a run.
const SLACK: f64 = 1e-3;

/// How far states with a floor have been below it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Floors {
    states: Vec<Low>,
}

#[derive(Debug, Clone, PartialEq)]
struct Low {
    state: usize,
    /// The block, and the place among its own states.
    of: (usize, usize),
    floor: f64,
    largest: f64,
    /// Value at the end of the last step, with its time.
    last: (f64, f64),
    /// When it fell below its floor first, and the least value so far, with its time.
    since: Option<f64>,
    least: (f64, f64),
}

impl Floors {
    pub fn new(schedule: &Schedule) -> Self {
        let states = schedule.blocks.iter().enumerate().flat_map(|(index, block)| {
            let states = block.interface.states.iter().enumerate();
            states.filter_map(move |(k, state)| {
                let floor = state.floor?.value;
                let (state, high) = (block.x + k, (f64::INFINITY, 0.0));
                Some(Low { state, of: (index, k), floor, largest: 0.0, last: high, since: None, least: high })
            })
        });
        Self { states: states.collect() }
    }

    /// Begins anew where a run begins.
    pub fn begin(&mut self, t: f64, x: &[f64]) {
        for low in &mut self.states {
            (low.largest, low.since) = (0.0, None);
            (low.last, low.least) = ((f64::INFINITY, t), (f64::INFINITY, t));
        }
        self.note(t, x);
    }

    /// Takes note of an accepted step.
    #[inline]
    pub fn note(&mut self, t: f64, x: &[f64]) {
        for low in &mut self.states {
            let value = x[low.state];
            low.largest = low.largest.max(value.abs());
            if value < low.least.0 {
                low.least = (value, t);
            }
            if low.since.is_none() && value < low.floor - SLACK * low.largest.max(low.floor.abs()) {
                // Steps may be long: on a straight line from the end of the last one.
                let (last, before) = low.last;
                let part = (last - low.floor) / (last - value);
                low.since = Some(if part < 1.0 { before + part.max(0.0) * (t - before) } else { t });
            }
            low.last = (value, t);
        }
    }
}

impl Simulation {
    /// A warning for each state that has been below its floor.
    pub(crate) fn below_floors(&self) -> Vec<Problem> {
        let found = self.floors.states.iter().filter_map(|low| {
            let since = low.since?;
            let block = &self.schedule.blocks[low.of.0];
            let state = &block.interface.states[low.of.1];
            let Floor { name, unit, help, .. } = state.floor?;
            let (least, t) = low.least;
            let message = format!(
                "`{}` falls below {name} at t = {} s, where its law does not hold: its least value is {} {unit}, at {} s",
                state_name(block, &state.name),
                five_digits(since),
                five_digits(least),
                five_digits(t)
            );
            Some(Problem::warning("below_floor", message).help(help))
        });
        found.collect()
    }
}

fn five_digits(value: f64) -> String {
    number(format!("{value:.4e}").parse().unwrap_or(value))
}
