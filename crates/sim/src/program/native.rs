//! Machine code in the place of tapes.

use std::sync::Arc;

use blocksim_block::law::{Machine, Ran, Tape};

use crate::Simulation;

/// Numbers that tapes and machines are compared with, beside those of the start.
const TRIALS: u64 = 8;

impl Simulation {
    /// The tapes that are run, those that do the same once.
    pub fn tapes(&self) -> Vec<&Tape> {
        let mut found: Vec<&Tape> = Vec::new();
        for tape in self.diagram.plan.fused.tapes() {
            if !tape.is_empty() && !found.iter().any(|other| other.does_as(tape)) {
                found.push(tape);
            }
        }
        found
    }

    /// Has machines run in the place of [`tapes`](Self::tapes), in their order; or none of them, if one leaves another bit than its
    /// tape from the numbers of this instant or from some at random.
    ///
    /// # Errors
    /// The number of the tape whose machine computes something else.
    pub fn run_by(&mut self, machines: &[Arc<dyn Machine>]) -> Result<(), usize> {
        let tapes: Vec<Tape> = self.tapes().into_iter().cloned().collect();
        let (cells, held) = (&self.diagram.signals, &self.diagram.d);
        let pairs = tapes.iter().zip(machines);
        if let Some(other) = pairs.clone().position(|(tape, machine)| !agree(tape, &**machine, cells, held)) {
            return Err(other);
        }
        for tape in self.diagram.plan.fused.tapes_mut() {
            if let Some((_, machine)) = pairs.clone().find(|(known, _)| known.does_as(tape)) {
                tape.run_by(Arc::clone(machine));
            }
        }
        Ok(())
    }
}

/// Whether a tape and a machine leave the same bits in all results, from these numbers and from others. Numbers that are none have many
/// bits, which nobody tells apart.
fn agree(tape: &Tape, machine: &dyn Machine, cells: &[f64], held: &[f64]) -> bool {
    let is_same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    let results = |cells: &[f64]| {
        let all = cells.iter().copied().enumerate();
        all.filter(|(cell, _)| tape.is_result(*cell as u32)).map(|(_, value)| value).collect::<Vec<_>>()
    };
    (0..=TRIALS).all(|trial| {
        let mut random = Random(trial);
        let mut varied = |numbers: &[f64]| -> Vec<f64> {
            numbers.iter().map(|&number| if trial == 0 { number } else { random.near(number) }).collect()
        };
        let (mut cells, mut held) = (varied(cells), varied(held));
        let (mut other_cells, mut other_held) = (cells.clone(), held.clone());
        let met = tape.interpret(&mut cells, &mut held);
        let Ran { failed, changed } = machine.run(&mut other_cells, &mut other_held);
        let about = [met.failed.map(|(_, about)| about), failed.map(|(_, about)| about)];
        met.changed == changed
            && about[0].is_some() == about[1].is_some()
            && is_same((&about[0].unwrap_or(0.0), &about[1].unwrap_or(0.0)))
            && results(&cells).iter().zip(&results(&other_cells)).all(is_same)
            && held.iter().zip(&other_held).all(is_same)
    })
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
