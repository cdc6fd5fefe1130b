//! Machine code in the place of tapes.

use std::collections::HashMap;
use std::sync::Arc;

use blocksim_block::law::{Machine, Ran, Tape};

use crate::Simulation;
use crate::stepping::methods::takes_slopes;

/// Numbers that tapes and machines are compared with, beside those of the start.
const TRIALS: u64 = 8;

/// Words of a tape that is worth a function of its own in any number. A shorter one gains four nanoseconds a run at most, and takes a
/// compiler as long as hundreds of thousands of runs.
const LONG: usize = 8;

/// How many shorter ones are compiled as well: so few that nobody has to wait for them.
const SHORT_ONES: usize = 64;

impl Simulation {
    /// The tapes that are worth machine code, those that do the same once: those that a run seldom needs are left to the
    /// interpreter, and so are short ones where there are many.
    pub fn tapes(&self) -> Vec<&Tape> {
        let takes_slopes = takes_slopes(self.schedule.settings.solver);
        let mut known = Kinds::default();
        let tapes = self.diagram.plan.fused.busy_tapes(takes_slopes).filter(|tape| !tape.is_empty());
        let mut tapes: Vec<&Tape> = tapes.filter(|tape| known.add(tape)).collect();
        if tapes.iter().filter(|tape| tape.len() < LONG).count() > SHORT_ONES {
            tapes.retain(|tape| tape.len() >= LONG);
        }
        tapes
    }

    /// Has machines run in the place of [`tapes`](Self::tapes), in their order; or none of them, if one leaves another bit than its
    /// tape from the numbers of this instant or from some at random.
    ///
    /// # Errors
    /// The number of the tape whose machine computes something else.
    pub fn run_by(&mut self, machines: &[Arc<dyn Machine>]) -> Result<(), usize> {
        let mut trial = Trial::new(&self.diagram.signals, &self.diagram.d);
        let tapes: Vec<Tape> = self.tapes().into_iter().cloned().collect();
        let mut known = Kinds::default();
        for (number, (tape, machine)) in tapes.iter().zip(machines).enumerate() {
            if !trial.agree(tape, &**machine) {
                return Err(number);
            }
            known.add(tape);
        }
        for tape in self.diagram.plan.fused.tapes_mut() {
            if let Some(number) = known.number(tape) {
                tape.run_by(Arc::clone(&machines[number]));
            }
        }
        Ok(())
    }
}

/// Number of words and the cells of the first one.
type Begin = (usize, [u32; 4]);

/// Tapes that do different things, by how they begin: one by one, thousands would take longer to compare than to compile.
#[derive(Default)]
struct Kinds<'t> {
    found: HashMap<Begin, Vec<(usize, &'t Tape)>>,
    count: usize,
}

impl<'t> Kinds<'t> {
    fn begin(tape: &Tape) -> Begin {
        (tape.len(), tape.words().first().map_or([0; 4], |word| [word.to, word.a, word.b, word.c]))
    }

    /// The number of what a tape does, if it is known.
    fn number(&self, tape: &Tape) -> Option<usize> {
        let alike = self.found.get(&Self::begin(tape))?;
        alike.iter().find(|(_, other)| other.does_as(tape)).map(|(number, _)| *number)
    }

    /// Gives what a tape does the next number. Returns whether it was not known.
    fn add(&mut self, tape: &'t Tape) -> bool {
        let is_new = self.number(tape).is_none();
        if is_new {
            self.found.entry(Self::begin(tape)).or_default().push((self.count, tape));
            self.count += 1;
        }
        is_new
    }
}

/// What a tape and its machine are run on: a copy of the same numbers for each. Only what a tape names is varied and put back, as most
/// tapes of a large model name little of it.
struct Trial<'n> {
    /// The numbers of this instant: cells, and what is held.
    begin: [&'n [f64]; 2],
    by_tape: [Vec<f64>; 2],
    by_machine: [Vec<f64>; 2],
}

impl<'n> Trial<'n> {
    fn new(cells: &'n [f64], held: &'n [f64]) -> Self {
        let copy = || [cells.to_vec(), held.to_vec()];
        Self { begin: [cells, held], by_tape: copy(), by_machine: copy() }
    }

    /// Whether a tape and a machine leave the same bits in all results, from these numbers and from others. Numbers that are none have
    /// many bits, which nobody tells apart.
    fn agree(&mut self, tape: &Tape, machine: &dyn Machine) -> bool {
        let named = tape.names();
        let agreed = (0..=TRIALS).all(|trial| {
            let mut random = Random(trial);
            self.put(&named, |number| if trial == 0 { number } else { random.near(number) });
            self.leave_the_same(tape, machine)
        });
        self.put(&named, |number| number);
        agreed
    }

    /// Puts numbers that follow from those of this instant where a tape names them.
    fn put(&mut self, named: &[Vec<u32>; 2], mut follow: impl FnMut(f64) -> f64) {
        for (array, names) in named.iter().enumerate() {
            for at in names.iter().map(|at| *at as usize) {
                let number = follow(self.begin[array][at]);
                self.by_tape[array][at] = number;
                self.by_machine[array][at] = number;
            }
        }
    }

    /// Whether a run leaves the same everywhere but in what is no result, also where a machine should write nothing.
    fn leave_the_same(&mut self, tape: &Tape, machine: &dyn Machine) -> bool {
        let ([cells, held], [other_cells, other_held]) = (&mut self.by_tape, &mut self.by_machine);
        let met = tape.interpret(cells, held);
        let Ran { failed, changed } = machine.run(other_cells, other_held);
        let about = [met.failed.map(|(_, about)| about), failed.map(|(_, about)| about)];
        let is_same = |a: f64, b: f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        let mut cells = cells.iter().zip(other_cells).enumerate();
        met.changed == changed
            && about[0].is_some() == about[1].is_some()
            && is_same(about[0].unwrap_or(0.0), about[1].unwrap_or(0.0))
            && cells.all(|(cell, (a, b))| is_same(*a, *b) || !tape.is_result(cell as u32))
            && held.iter().zip(other_held).all(|(a, b)| is_same(*a, *b))
    }
}

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    /// A number of either sign and of any size between a tenth and ten times that of this one, or around 1.
    fn near(&mut self, number: f64) -> f64 {
        // The generator of Steele, Lea and Flood (SplitMix, 2014).
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        let size = 10_f64.powf((bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
        let sign = if bits & 1 == 0 { 1.0 } else { -1.0 };
        sign * size * if number == 0.0 || !number.is_finite() { 1.0 } else { number }
    }
}
