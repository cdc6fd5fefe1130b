//! The interpreter: one `match` for two instructions, without allocation.
//!
//! Finding out what comes next takes a processor longer than to add or to multiply, so arithmetic goes in pairs: a step is two words
//! that follow each other. A processor also waits for what was just written to memory about as long as it calculates, and most
//! instructions read what the one before has brought. So the last result stays at hand, and words that read it take it from there.
//! Nothing else differs: each word writes where it would write alone, with the same roundings.

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

/// A word of arithmetic as it is run, or two of them, or another word, with numbers of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step<N> {
    /// Which forms the first and the second word have, by their number in [`pairs`]; [`OTHER`] for another word.
    pair: u16,
    other: Other,
    first: Operands<N>,
    second: Operands<N>,
}

/// Where the result of a word goes, and where its operands are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Operands<N> {
    /// As of the word; of what requires something, the number of the word.
    to: N,
    a: N,
    b: N,
    c: N,
}

/// What is no arithmetic, or takes its time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Other {
    Copy,
    Load,
    Hold,
    Neg,
    Div,
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
    /// `last / a`.
    LastDiv,
    /// `a / last`.
    DivLast,
    /// `a` where `last` is not 0, otherwise `b`.
    SelectByLast,
}

/// The value of a form of arithmetic, from cells and the last result.
macro_rules! value {
    (Add, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) + $r($at.b)
    };
    (Sub, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) - $r($at.b)
    };
    (Mul, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) * $r($at.b)
    };
    (MulAdd, $r:expr, $last:expr, $at:expr) => {
        $r($at.c) + $r($at.a) * $r($at.b)
    };
    (MulSub, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) * $r($at.b) - $r($at.c)
    };
    (SubMul, $r:expr, $last:expr, $at:expr) => {
        $r($at.c) - $r($at.a) * $r($at.b)
    };
    (LastAdd, $r:expr, $last:expr, $at:expr) => {
        $last + $r($at.a)
    };
    (LastSub, $r:expr, $last:expr, $at:expr) => {
        $last - $r($at.a)
    };
    (SubLast, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) - $last
    };
    (LastMul, $r:expr, $last:expr, $at:expr) => {
        $last * $r($at.a)
    };
    (LastMulAdd, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) + $last * $r($at.b)
    };
    (LastMulSub, $r:expr, $last:expr, $at:expr) => {
        $last * $r($at.a) - $r($at.b)
    };
    (SubLastMul, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) - $last * $r($at.b)
    };
    (LastAddMul, $r:expr, $last:expr, $at:expr) => {
        $last + $r($at.a) * $r($at.b)
    };
    (MulSubLast, $r:expr, $last:expr, $at:expr) => {
        $r($at.a) * $r($at.b) - $last
    };
    (LastSubMul, $r:expr, $last:expr, $at:expr) => {
        $last - $r($at.a) * $r($at.b)
    };
    (ClampLast, $r:expr, $last:expr, $at:expr) => {
        clamp($last, $r($at.a), $r($at.b))
    };
}

/// The forms of arithmetic, and which may follow which in one step; a step of its own is a pair with nothing.
macro_rules! forms {
    ($($first:ident: $($second:ident)*;)*) => {
        /// A form of arithmetic; what it computes stands in [`value`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        enum Form {
            $($first,)*
        }

        /// Number of forms.
        const FORMS: u16 = [$(Form::$first),*].len() as u16;

        /// The numbers of pairs.
        #[expect(non_snake_case, non_upper_case_globals, reason = "forms are called as they are")]
        mod pairs {
            use super::{Form, number};

            /// One form alone.
            pub mod alone {
                $(pub const $first: u16 = super::number(super::Form::$first, None);)*
            }
            $(pub mod $first {
                $(pub const $second: u16 = super::number(super::Form::$first, Some(super::Form::$second));)*
            })*
        }

        /// Runs a word or a pair of words of arithmetic and returns the last result; `None` for all other words ([`OTHER`]).
        #[inline(always)]
        fn arithmetic<N: Copy, C: Cells<N> + ?Sized>(step: &Step<N>, cells: &mut C, last: f64) -> Option<f64> {
            let Step { pair, first, second, .. } = step;
            match *pair {
                $(pairs::alone::$first => {
                    let value = value!($first, |cell| cells.get(cell), last, first);
                    cells.set(first.to, value);
                    Some(value)
                })*
                $($(pairs::$first::$second => {
                    let value = value!($first, |cell| cells.get(cell), last, first);
                    cells.set(first.to, value);
                    let value = value!($second, |cell| cells.get(cell), value, second);
                    cells.set(second.to, value);
                    Some(value)
                })*)*
                _ => None,
            }
        }
    };
}

forms! {
    Add:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    Sub:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    Mul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    MulAdd:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    MulSub:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    SubMul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastAdd:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastSub:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    SubLast:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastMul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastMulAdd:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastMulSub:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    SubLastMul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastAddMul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    MulSubLast:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    LastSubMul:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
    ClampLast:
        Add Sub Mul MulAdd MulSub SubMul LastAdd LastSub SubLast
        LastMul LastMulAdd LastMulSub SubLastMul LastAddMul MulSubLast LastSubMul ClampLast;
}

/// The number of a pair of forms, or of one alone.
const fn number(first: Form, second: Option<Form>) -> u16 {
    let second = match second {
        None => 0,
        Some(form) => 1 + form as u16,
    };
    second * FORMS + first as u16
}

/// No pair.
const OTHER: u16 = (FORMS + 1) * FORMS;

/// What a word is run as.
enum Kind {
    Arithmetic(Form),
    Other(Other),
}

impl Default for Steps {
    fn default() -> Self {
        Self::Few(Vec::new())
    }
}

impl Steps {
    /// The steps of the words of a tape.
    pub fn new(words: &[Word]) -> Self {
        let mut last = None;
        let mut many: Vec<Step<u32>> = Vec::with_capacity(words.len());
        // The form of the step before, if that is one word of arithmetic.
        let mut open: Option<Form> = None;
        for (number_of_word, word) in words.iter().enumerate() {
            let (kind, mut operands) = run_as(*word, last);
            match word.code {
                Code::Hold => {}
                Code::Require => operands.to = number_of_word as u32,
                _ => last = Some(word.to),
            }
            let alone = |pair, other| Step { pair, other, first: operands, second: Operands::default() };
            open = match (kind, open, many.last_mut()) {
                (Kind::Arithmetic(form), Some(first), Some(step)) => {
                    (step.pair, step.second) = (number(first, Some(form)), operands);
                    None
                }
                (Kind::Arithmetic(form), ..) => {
                    many.push(alone(number(form, None), Other::Copy));
                    Some(form)
                }
                (Kind::Other(other), ..) => {
                    many.push(alone(OTHER, other));
                    None
                }
            };
        }
        match many.iter().map(|step| step.short()).collect() {
            Some(few) => Self::Few(few),
            None => Self::Many(many),
        }
    }

    /// Runs all steps; see [`run`].
    #[inline]
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
        let Self { pair, other, first, second } = self;
        Some(Step { pair, other, first: first.short()?, second: second.short()? })
    }
}

impl Operands<u32> {
    fn short(self) -> Option<Operands<u8>> {
        let Self { to, a, b, c } = self;
        let [to, a, b, c] = [to, a, b, c].map(|number| u8::try_from(number).ok());
        Some(Operands { to: to?, a: a?, b: b?, c: c? })
    }
}

/// What a word is run as, if the last result stands in cell `last`, and its operands then.
fn run_as(word: Word, last: Option<u32>) -> (Kind, Operands<u32>) {
    let Word { code, to, a, b, c } = word;
    let is_last = |cell: u32| last == Some(cell);
    let (at_a, at_b, at_c) = (is_last(a), is_last(b), is_last(c));
    let all = Operands { to, a, b, c };
    let form = |form: Form, a: u32, b: u32| (Kind::Arithmetic(form), Operands { to, a, b, c: 0 });
    let plain = |form: Form| (Kind::Arithmetic(form), all);
    let other = |other: Other| (Kind::Other(other), all);
    let with = |other: Other, a: u32, b: u32| (Kind::Other(other), Operands { to, a, b, c: 0 });
    match code {
        Code::Copy if at_a => with(Other::CopyLast, 0, 0),
        Code::Copy => other(Other::Copy),
        Code::Neg if at_a => with(Other::NegLast, 0, 0),
        Code::Neg => other(Other::Neg),
        Code::Add if at_a => form(Form::LastAdd, b, 0),
        Code::Add if at_b => form(Form::LastAdd, a, 0),
        Code::Add => plain(Form::Add),
        Code::Sub if at_a => form(Form::LastSub, b, 0),
        Code::Sub if at_b => form(Form::SubLast, a, 0),
        Code::Sub => plain(Form::Sub),
        Code::Mul if at_a => form(Form::LastMul, b, 0),
        Code::Mul if at_b => form(Form::LastMul, a, 0),
        Code::Mul => plain(Form::Mul),
        Code::Div if at_a => with(Other::LastDiv, b, 0),
        Code::Div if at_b => with(Other::DivLast, a, 0),
        Code::Div => other(Other::Div),
        Code::MulAdd if at_a => form(Form::LastMulAdd, c, b),
        Code::MulAdd if at_b => form(Form::LastMulAdd, c, a),
        Code::MulAdd if at_c => form(Form::LastAddMul, a, b),
        Code::MulAdd => plain(Form::MulAdd),
        Code::MulSub if at_a => form(Form::LastMulSub, b, c),
        Code::MulSub if at_b => form(Form::LastMulSub, a, c),
        Code::MulSub if at_c => form(Form::MulSubLast, a, b),
        Code::MulSub => plain(Form::MulSub),
        Code::SubMul if at_a => form(Form::SubLastMul, c, b),
        Code::SubMul if at_b => form(Form::SubLastMul, c, a),
        Code::SubMul if at_c => form(Form::LastSubMul, a, b),
        Code::SubMul => plain(Form::SubMul),
        Code::Clamp if at_a => form(Form::ClampLast, b, c),
        Code::Clamp => other(Other::Clamp),
        Code::Select if at_a => with(Other::SelectByLast, b, c),
        Code::Select => other(Other::Select),
        Code::Load => other(Other::Load),
        Code::Hold => other(Other::Hold),
        Code::Power => other(Other::Power),
        Code::Unary(function) => other(Other::Unary(function)),
        Code::Binary(function) => other(Other::Binary(function)),
        Code::Compare(relation) => other(Other::Compare(relation)),
        Code::Not => other(Other::Not),
        Code::And => other(Other::And),
        Code::Or => other(Other::Or),
        Code::Require => other(Other::Require),
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
        if let Some(value) = arithmetic(step, cells, last) {
            last = value;
            continue;
        }
        let r = |cell: N| cells.get(cell);
        let Operands { to, a, b, c } = step.first;
        last = match step.other {
            Other::Copy => r(a),
            Other::Load => held[a.into() as usize],
            Other::Neg => -r(a),
            Other::Div => r(a) / r(b),
            Other::Power => power(r(a), b.into() as i32),
            Other::Clamp => clamp(r(a), r(b), r(c)),
            Other::Unary(function) => function.of(r(a)),
            Other::Binary(function) => function.of(r(a), r(b)),
            Other::Compare(relation) => truth(relation.holds(r(a), r(b))),
            Other::Not => truth(r(a) == 0.0),
            Other::And => truth(r(a) != 0.0 && r(b) != 0.0),
            Other::Or => truth(r(a) != 0.0 || r(b) != 0.0),
            Other::Select => {
                if r(a) != 0.0 {
                    r(b)
                } else {
                    r(c)
                }
            }
            Other::CopyLast => last,
            Other::NegLast => -last,
            Other::LastDiv => last / r(a),
            Other::DivLast => r(a) / last,
            Other::SelectByLast => {
                if last != 0.0 {
                    r(a)
                } else {
                    r(b)
                }
            }
            Other::Hold => {
                let value = r(a);
                let held = &mut held[to.into() as usize];
                outcome.changed |= *held != value;
                *held = value;
                continue;
            }
            Other::Require => {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Words of all forms of arithmetic, and some others, from and to a few cells.
    fn words() -> Vec<Word> {
        let codes = [
            Code::Add,
            Code::Sub,
            Code::Mul,
            Code::MulAdd,
            Code::MulSub,
            Code::SubMul,
            Code::Clamp,
            Code::Div,
            Code::Copy,
            Code::Neg,
            Code::Select,
        ];
        let operands = [[0, 1, 2], [3, 1, 2], [0, 3, 2], [0, 1, 3], [3, 3, 3], [3, 4, 3]];
        let word = |code| operands.map(|[a, b, c]| [3, 4].map(|to| Word { code, to, a, b, c }));
        codes.into_iter().flat_map(word).flatten().collect()
    }

    fn cells(n: usize) -> Vec<f64> {
        [0.7, -1.3, 2.9, -0.4, 5.1].into_iter().chain(std::iter::repeat(0.0)).take(n).collect()
    }

    #[test]
    fn words_together_leave_the_bits_of_words_alone() {
        let words = words();
        for first in &words {
            for second in &words {
                // A third one takes the last result of a pair.
                let third = Word { code: Code::Sub, to: 4, a: 3, b: second.to, c: 0 };
                let all = [*first, *second, third];
                let mut wanted = cells(5);
                all.iter().for_each(|word| _ = Steps::new(&[*word]).run(&mut wanted, &mut []));
                // Few cells, more than a byte can name, and a name that takes more than a byte.
                let (few, wide) = (Steps::new(&all), Word { code: Code::Copy, to: 300, a: 0, b: 0, c: 0 });
                let many = Steps::new(&[&all[..], &[wide]].concat());
                assert!(matches!((&few, &many), (Steps::Few(_), Steps::Many(_))));
                for (steps, n) in [(&few, 5), (&few, FEW), (&many, 301)] {
                    let mut cells = cells(n);
                    steps.run(&mut cells, &mut []);
                    let bits = |cells: &[f64]| cells[..5].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                    assert_eq!(bits(&cells), bits(&wanted), "{all:?}");
                }
            }
        }
    }

    #[test]
    fn arithmetic_goes_in_pairs() {
        let word = |code, to, a| Word { code, to, a, b: 0, c: 0 };
        let add = word(Code::Add, 1, 0);
        let count = |words: &[Word]| match Steps::new(words) {
            Steps::Few(steps) => steps.len(),
            Steps::Many(steps) => steps.len(),
        };
        assert_eq!([1, 2, 3, 4].map(|n| count(&vec![add; n])), [1, 1, 2, 2]);
        assert_eq!(count(&[add, word(Code::Neg, 1, 0), add, add]), 3);
    }
}
