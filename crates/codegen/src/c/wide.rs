//! What stays in double precision in code of single precision: the time, and what is computed from it.
//!
//! A time of 1000 s in single precision is off by up to 3e-5 s: a sine of 50 Hz that is computed from it by a percent, and the
//! difference of two such times, 1 ms apart, by 6 percent.

use std::collections::BTreeSet;

use blocksim_block::law::{Binary, Draft, Id, Op, Root, Unary};

use crate::programs::Programs;

/// Discrete states and signals that stay in double precision, by their numbers in the diagram.
#[derive(Debug, Default)]
pub(super) struct Wide {
    pub memories: BTreeSet<u32>,
    pub cells: BTreeSet<u32>,
}

impl Wide {
    /// What is kept of times in any of the programs.
    pub fn new(programs: &Programs) -> Self {
        let mut all = Self::default();
        loop {
            let before = (all.memories.len(), all.cells.len());
            for draft in programs.drafts() {
                let wide = all.values(draft);
                for root in &draft.roots {
                    match *root {
                        Root::Held(id, number) if wide[id.0 as usize] => {
                            all.memories.insert(number);
                        }
                        Root::Cell(id, cell) if wide[id.0 as usize] => {
                            all.cells.insert(cell);
                        }
                        _ => {}
                    }
                }
            }
            if before == (all.memories.len(), all.cells.len()) {
                return all;
            }
        }
    }

    /// Whether each value of a program of single precision stays in double precision.
    pub fn values(&self, draft: &Draft) -> Vec<bool> {
        let mut wide: Vec<bool> = Vec::with_capacity(draft.program.instructions.len());
        for instruction in &draft.program.instructions {
            let any = |ids: &[Id]| ids.iter().any(|id| wide[id.0 as usize]);
            let is_wide = match instruction.op {
                Op::Time => true,
                Op::Memory(number) => self.memories.contains(&number),
                Op::Input(cell) => self.cells.contains(&cell),
                Op::Neg(a)
                | Op::Power(a, _)
                | Op::Unary(Unary::Abs | Unary::Floor | Unary::Ceil | Unary::Round, a) => any(&[a]),
                Op::Add(a, b)
                | Op::Sub(a, b)
                | Op::Mul(a, b)
                | Op::Div(a, b)
                | Op::Binary(Binary::Min | Binary::Max, a, b)
                | Op::Select(_, a, b) => any(&[a, b]),
                Op::Clamp(a, lower, upper) => any(&[a, lower, upper]),
                // A sine and the like have no more digits than the signals with which they come together.
                _ => false,
            };
            wide.push(is_wide);
        }
        wide
    }
}
