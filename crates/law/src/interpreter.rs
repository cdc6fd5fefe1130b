//! The interpreter: one `match` an instruction, without allocation.
//!
//! A processor waits for what was just written to memory about as long as it calculates, and most instructions read what the one
//! before has brought. So the last result stays at hand, and words that read it become steps that take it from there. Nothing else
//! differs: each step writes where its word writes, with the same roundings.

use crate::op::{power, truth};
use crate::tape::{Ran, Word, WordCode as Code};
use crate::{Binary, Relation, Unary};

/// Words as they are run.
#[derive(Debug, Clone)]
pub(crate) enum Steps {
    /// Those that name none but the first [`FEW`] cells.
    Few(Vec<Step<u8>>),
    Many(Vec<Step<u32>>),
}

/// Number of cells whose numbers fit in a byte: any number of that kind is one of theirs, so nothing has to be compared.
pub(crate) const FEW: usize = 256;

/// A word as it is run, with numbers of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step<N> {
    code: StepCode,
    /// As of the word; of what requires something, the number of the word.
    to: N,
    a: N,
    b: N,
    c: N,
}

/// What a step does: as words do it, or with the last result in the place of an operand.
#[derive(Debug, Clone, Copy, PartialEq)]
enum StepCode {
    Copy,
    Load,
    Hold,
    Neg,
    Add,
    Sub,
    Mul,
    Div,
    MulAdd,
    MulSub,
    SubMul,
    Power,
    Clamp,
    Unary(Unary),
    Binary(Binary),
    Compare(Relation),
    Not,
    And,
    Or,
    Select,
    Require,
    /// `last`.
    CopyLast,
    /// `-last`.
    NegLast,
    /// `last + a`.
    LastAdd,
    /// `last - a`.
    LastSub,
    /// `a - last`.
    SubLast,
    /// `last * a`.
    LastMul,
    /// `last / a`.
    LastDiv,
    /// `a / last`.
    DivLast,
    /// `a + last * b`.
    LastMulAdd,
    /// `last * a - b`.
    LastMulSub,
    /// `a - last * b`.
    SubLastMul,
    /// `last + a * b`.
    LastAddMul,
    /// `a * b - last`.
    MulSubLast,
    /// `last - a * b`.
    LastSubMul,
    /// `last` between `a` and `b`.
    ClampLast,
    /// `a` where `last` is not 0, otherwise `b`.
    SelectByLast,
}

impl Default for Steps {
    fn default() -> Self {
        Self::Few(Vec::new())
    }
}

impl Steps {
    /// The steps of the words of a tape, one each.
    pub fn new(words: &[Word]) -> Self {
        let mut last = None;
        let step = |(number, word): (usize, &Word)| {
            let mut step = Step::of(*word, last);
            match word.code {
                Code::Hold => {}
                Code::Require => step.to = number as u32,
                _ => last = Some(word.to),
            }
            step
        };
        let many: Vec<Step<u32>> = words.iter().enumerate().map(step).collect();
        match many.iter().map(|step| step.short()).collect() {
            Some(few) => Self::Few(few),
            None => Self::Many(many),
        }
    }

    /// Runs all steps; see [`run`].
    pub fn run(&self, cells: &mut [f64], held: &mut [f64]) -> Ran {
        let Outcome { failed, changed, about } = match self {
            Self::Many(steps) => run(steps, cells, held),
            Self::Few(steps) => match cells.first_chunk_mut::<FEW>() {
                Some(few) => run(steps, few, held),
                None => run(steps, cells, held),
            },
        };
        Ran { failed: (failed != NONE).then_some((failed as usize, about)), changed }
    }
}

impl Step<u32> {
    /// The same in numbers that are bytes, if they are so small.
    fn short(self) -> Option<Step<u8>> {
        let Self { code, to, a, b, c } = self;
        let [to, a, b, c] = [to, a, b, c].map(|number| u8::try_from(number).ok());
        Some(Step { code, to: to?, a: a?, b: b?, c: c? })
    }

    /// A word as a step, if the last result stands in cell `last`.
    fn of(word: Word, last: Option<u32>) -> Self {
        let Word { code, to, a, b, c } = word;
        let is_last = |cell: u32| last == Some(cell);
        let (at_a, at_b, at_c) = (is_last(a), is_last(b), is_last(c));
        let with = |code: StepCode, a: u32, b: u32| Self { code, to, a, b, c: 0 };
        match code {
            Code::Copy if at_a => with(StepCode::CopyLast, 0, 0),
            Code::Neg if at_a => with(StepCode::NegLast, 0, 0),
            Code::Add if at_a => with(StepCode::LastAdd, b, 0),
            Code::Add if at_b => with(StepCode::LastAdd, a, 0),
            Code::Sub if at_a => with(StepCode::LastSub, b, 0),
            Code::Sub if at_b => with(StepCode::SubLast, a, 0),
            Code::Mul if at_a => with(StepCode::LastMul, b, 0),
            Code::Mul if at_b => with(StepCode::LastMul, a, 0),
            Code::Div if at_a => with(StepCode::LastDiv, b, 0),
            Code::Div if at_b => with(StepCode::DivLast, a, 0),
            Code::MulAdd if at_a => with(StepCode::LastMulAdd, c, b),
            Code::MulAdd if at_b => with(StepCode::LastMulAdd, c, a),
            Code::MulAdd if at_c => with(StepCode::LastAddMul, a, b),
            Code::MulSub if at_a => with(StepCode::LastMulSub, b, c),
            Code::MulSub if at_b => with(StepCode::LastMulSub, a, c),
            Code::MulSub if at_c => with(StepCode::MulSubLast, a, b),
            Code::SubMul if at_a => with(StepCode::SubLastMul, c, b),
            Code::SubMul if at_b => with(StepCode::SubLastMul, c, a),
            Code::SubMul if at_c => with(StepCode::LastSubMul, a, b),
            Code::Clamp if at_a => with(StepCode::ClampLast, b, c),
            Code::Select if at_a => with(StepCode::SelectByLast, b, c),
            code => Self { code: code.into(), to, a, b, c },
        }
    }
}

impl From<Code> for StepCode {
    fn from(code: Code) -> Self {
        match code {
            Code::Copy => Self::Copy,
            Code::Load => Self::Load,
            Code::Hold => Self::Hold,
            Code::Neg => Self::Neg,
            Code::Add => Self::Add,
            Code::Sub => Self::Sub,
            Code::Mul => Self::Mul,
            Code::Div => Self::Div,
            Code::MulAdd => Self::MulAdd,
            Code::MulSub => Self::MulSub,
            Code::SubMul => Self::SubMul,
            Code::Power => Self::Power,
            Code::Clamp => Self::Clamp,
            Code::Unary(function) => Self::Unary(function),
            Code::Binary(function) => Self::Binary(function),
            Code::Compare(relation) => Self::Compare(relation),
            Code::Not => Self::Not,
            Code::And => Self::And,
            Code::Or => Self::Or,
            Code::Select => Self::Select,
            Code::Require => Self::Require,
        }
    }
}

/// The numbers that steps work on, named by numbers of a kind.
trait Cells<N> {
    fn get(&self, cell: N) -> f64;
    fn set(&mut self, cell: N, value: f64);
}

impl<N: Into<u32>> Cells<N> for [f64] {
    #[inline(always)]
    fn get(&self, cell: N) -> f64 {
        self[cell.into() as usize]
    }

    #[inline(always)]
    fn set(&mut self, cell: N, value: f64) {
        self[cell.into() as usize] = value;
    }
}

impl Cells<u8> for [f64; FEW] {
    #[inline(always)]
    fn get(&self, cell: u8) -> f64 {
        self[usize::from(cell)]
    }

    #[inline(always)]
    fn set(&mut self, cell: u8, value: f64) {
        self[usize::from(cell)] = value;
    }
}

/// What a run has met, in as little space as a processor returns at once.
#[derive(Clone, Copy)]
struct Outcome {
    /// The first word that requires something which does not hold, or [`NONE`].
    failed: u32,
    /// Whether something that is held is another number now.
    changed: bool,
    /// The number that the requirement is about.
    about: f64,
}

const NONE: u32 = u32::MAX;

/// Runs all steps.
///
/// # Panics
/// Panics if there are fewer cells or held numbers than the steps name.
fn run<N: Copy + Into<u32>, C: Cells<N> + ?Sized>(
    steps: &[Step<N>],
    cells: &mut C,
    held: &mut [f64],
) -> Outcome {
    let mut outcome = Outcome { failed: NONE, changed: false, about: 0.0 };
    let mut last = 0.0;
    for step in steps {
        let r = |cell: N| cells.get(cell);
        let Step { code, to, a, b, c } = *step;
        last = match code {
            StepCode::Copy => r(a),
            StepCode::Load => held[a.into() as usize],
            StepCode::Neg => -r(a),
            StepCode::Add => r(a) + r(b),
            StepCode::Sub => r(a) - r(b),
            StepCode::Mul => r(a) * r(b),
            StepCode::Div => r(a) / r(b),
            StepCode::MulAdd => r(c) + r(a) * r(b),
            StepCode::MulSub => r(a) * r(b) - r(c),
            StepCode::SubMul => r(c) - r(a) * r(b),
            StepCode::Power => power(r(a), b.into() as i32),
            StepCode::Clamp => clamp(r(a), r(b), r(c)),
            StepCode::Unary(function) => function.of(r(a)),
            StepCode::Binary(function) => function.of(r(a), r(b)),
            StepCode::Compare(relation) => truth(relation.holds(r(a), r(b))),
            StepCode::Not => truth(r(a) == 0.0),
            StepCode::And => truth(r(a) != 0.0 && r(b) != 0.0),
            StepCode::Or => truth(r(a) != 0.0 || r(b) != 0.0),
            StepCode::Select => {
                if r(a) != 0.0 {
                    r(b)
                } else {
                    r(c)
                }
            }
            StepCode::CopyLast => last,
            StepCode::NegLast => -last,
            StepCode::LastAdd => last + r(a),
            StepCode::LastSub => last - r(a),
            StepCode::SubLast => r(a) - last,
            StepCode::LastMul => last * r(a),
            StepCode::LastDiv => last / r(a),
            StepCode::DivLast => r(a) / last,
            StepCode::LastMulAdd => r(a) + last * r(b),
            StepCode::LastMulSub => last * r(a) - r(b),
            StepCode::SubLastMul => r(a) - last * r(b),
            StepCode::LastAddMul => last + r(a) * r(b),
            StepCode::MulSubLast => r(a) * r(b) - last,
            StepCode::LastSubMul => last - r(a) * r(b),
            StepCode::ClampLast => clamp(last, r(a), r(b)),
            StepCode::SelectByLast => {
                if last != 0.0 {
                    r(a)
                } else {
                    r(b)
                }
            }
            StepCode::Hold => {
                let value = r(a);
                let held = &mut held[to.into() as usize];
                outcome.changed |= *held != value;
                *held = value;
                continue;
            }
            StepCode::Require => {
                if r(a) == 0.0 && outcome.failed == NONE {
                    (outcome.failed, outcome.about) = (to.into(), r(b));
                }
                continue;
            }
        };
        cells.set(to, last);
    }
    outcome
}

/// `u` between the limits; what is not a number stays so.
#[inline]
pub(crate) fn clamp(u: f64, lower: f64, upper: f64) -> f64 {
    if u > upper {
        upper
    } else if u < lower {
        lower
    } else {
        u
    }
}
