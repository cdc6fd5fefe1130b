//! A loop whose blocks all record their laws, as a program: what goes round it, and its exact slopes.

use blocksim_block::law::{Draft, Joined, Op, Placed, Program, Root};
use blocksim_block::schedule::{Loop, Schedule};

/// Most instructions of a program with the slopes along all unknowns at once.
const MOST: usize = 100_000;

/// The programs of a loop.
#[derive(Debug, Clone)]
pub(crate) struct Drafts {
    /// What its steps write, given the unknowns.
    pub values: Draft,
    /// The slopes of what stands in the cells of the unknowns afterwards, by what stood there: row by row, or along one direction.
    pub slopes: Draft,
    /// Whether slopes are along a direction in the space of the unknowns.
    pub along: bool,
    pub form: Form,
}

/// How what a loop gives depends on its unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// Affine, with slopes that never change.
    Constant,
    /// Affine, with slopes that depend on what comes from outside of the loop.
    Affine,
    Nonlinear,
}

impl Drafts {
    /// The programs of a loop; nothing where a block of it records no law.
    pub fn new(schedule: &Schedule, found: &Loop) -> Option<Self> {
        let mut joined = Joined::default();
        for step in &schedule.steps[found.first..found.first + found.count] {
            let block = &schedule.blocks[step.block as usize];
            let law = block.law.as_deref()?;
            joined.call(Placed::new(law, step.block as usize, block), step.group as usize, false);
        }
        let cells: Vec<u32> = found.cells.iter().map(|cell| *cell as u32).collect();
        let values = joined.clone().finish();
        if found.sought > 0 {
            // What becomes zero is searched for, with slopes that are differences.
            return Some(Self { values, slopes: Draft::default(), along: false, form: Form::Nonlinear });
        }
        let along = cells.len() * values.program.instructions.len() > MOST;
        let slopes = if along { joined.slopes_along(&cells)? } else { joined.slopes_by(&cells)? };
        let form = match is_affine(&values, &cells) {
            false => Form::Nonlinear,
            true if is_constant(&slopes.program) => Form::Constant,
            true => Form::Affine,
        };
        Some(Self { values, slopes, along, form })
    }
}

/// Whether what is wanted of a program is a sum of the inputs `cells` with factors that do not depend on them.
fn is_affine(draft: &Draft, cells: &[u32]) -> bool {
    // The degree of each value: 0, 1, or 2 for all that is not affine.
    let mut degrees: Vec<u8> = Vec::with_capacity(draft.program.instructions.len());
    for instruction in &draft.program.instructions {
        let of = |id: blocksim_block::law::Id| degrees[id.0 as usize];
        let degree = match instruction.op {
            Op::Input(cell) => u8::from(cells.contains(&cell)),
            Op::Neg(a) => of(a),
            Op::Add(a, b) | Op::Sub(a, b) => of(a).max(of(b)),
            Op::Mul(a, b) => (of(a) + of(b)).min(2),
            Op::Div(a, b) if of(b) == 0 => of(a),
            Op::Power(a, 1) => of(a),
            Op::Select(condition, a, b) if of(condition) == 0 => of(a).max(of(b)),
            op => 2 * u8::from(op.operands().any(|id| of(id) > 0)),
        };
        degrees.push(degree);
    }
    draft.roots.iter().all(|root| match *root {
        Root::Met(id) => degrees[id.0 as usize] == 0,
        Root::Cell(id, _) | Root::Held(id, _) | Root::Anywhere(id) => degrees[id.0 as usize] < 2,
    })
}

/// Whether a program computes the same at all times.
fn is_constant(program: &Program) -> bool {
    program.instructions.iter().all(|instruction| {
        !matches!(instruction.op, Op::Input(_) | Op::State(_) | Op::Memory(_) | Op::Mode(_) | Op::Time)
    })
}
