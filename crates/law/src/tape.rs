//! Tapes: short instructions over one array of numbers.

use std::fmt::Debug;
use std::sync::Arc;

use crate::interpreter::{FEW, Steps};
use crate::passes::Set;
use crate::{Binary, Id, Op, Relation, Unary};

/// Values of a program, ready to be computed over one array of numbers, its *cells*. Where what comes from outside lies, and where
/// results go, is up to whoever makes the tape.
#[derive(Debug, Clone, Default)]
pub struct Tape {
    words: Vec<Word>,
    /// The instruction that each word came from.
    from: Vec<Id>,
    /// First cell of those that it uses for itself.
    temporaries: u32,
    /// Those among them that hold results at the end, in order.
    places: Vec<u32>,
    /// The words as the interpreter runs them.
    steps: Steps,
    /// What runs in its place.
    machine: Option<Arc<dyn Machine>>,
}

/// Two tapes are equal if they compute the same, by whatever means.
impl PartialEq for Tape {
    fn eq(&self, other: &Self) -> bool {
        self.does_as(other) && self.from == other.from
    }
}

/// An instruction whose operands are numbers of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Word {
    /// What it does.
    pub code: WordCode,
    /// The cell that its result goes to.
    pub to: u32,
    /// First operand.
    pub a: u32,
    /// Second operand.
    pub b: u32,
    /// Third operand.
    pub c: u32,
}

use WordCode as Code;

impl Word {
    /// The cells that it reads.
    pub fn reads(&self) -> impl Iterator<Item = u32> {
        let count = match self.code {
            Code::Load => 0,
            Code::Copy | Code::Hold | Code::Neg | Code::Power | Code::Unary(_) | Code::Not => 1,
            Code::Add | Code::Sub | Code::Mul | Code::Div => 2,
            Code::Binary(_) | Code::Compare(_) | Code::And | Code::Or | Code::Require => 2,
            Code::MulAdd | Code::MulSub | Code::SubMul | Code::Clamp | Code::Select => 3,
        };
        [self.a, self.b, self.c].into_iter().take(count)
    }

    /// The cell that it writes, if it does.
    pub fn writes(&self) -> Option<u32> {
        (!matches!(self.code, Code::Hold | Code::Require)).then_some(self.to)
    }
}

/// What an instruction of a tape does. Operands that nothing is said of are cells.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "operations are called as in mathematics")]
pub enum WordCode {
    /// Copies cell `a`.
    Copy,
    /// From number `a` of what is held.
    Load,
    /// To number `to` of what is held.
    Hold,
    Neg,
    Add,
    Sub,
    Mul,
    Div,
    /// `c + a * b`, rounded twice.
    MulAdd,
    /// `a * b - c`, rounded twice.
    MulSub,
    /// `c - a * b`, rounded twice.
    SubMul,
    /// `a` to the whole exponent `b`, which is no cell but the bits of an `i32`.
    Power,
    /// `a` between `b` and `c`; see [`Op::Clamp`].
    Clamp,
    Unary(Unary),
    Binary(Binary),
    Compare(Relation),
    Not,
    And,
    Or,
    /// `b` where `a` is not 0, otherwise `c`.
    Select,
    /// Fails, about the number in `b`, where `a` is 0.
    Require,
}

/// Something that computes what a tape does, to the bit, and more quickly: machine code of it.
pub trait Machine: Debug + Send + Sync {
    /// Computes everything that is a [result](Tape::is_result).
    fn run(&self, cells: &mut [f64], held: &mut [f64]) -> Ran;
}

/// What a run of a [`Machine`] has met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ran {
    /// The first word whose requirement does not hold, and the number that it is about.
    pub failed: Option<(usize, f64)>,
    /// Whether something that is held is another number now.
    pub changed: bool,
}

/// Where a number from outside is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leaf {
    /// In a cell.
    Cell(u32),
    /// Among what is held.
    Held(u32),
}

/// What is wanted of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Root {
    /// The value is written to a cell.
    Cell(Id, u32),
    /// The value is written to what is held, at the end.
    Held(Id, u32),
    /// The value is computed, wherever that is; see [`Made::places`].
    Anywhere(Id),
    /// The requirement is looked at.
    Met(Id),
}

impl Root {
    fn id(self) -> Id {
        match self {
            Root::Cell(id, _) | Root::Held(id, _) | Root::Anywhere(id) | Root::Met(id) => id,
        }
    }
}

/// A tape and what it needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Made {
    /// The tape.
    pub tape: Tape,
    /// First cell behind those that it uses for itself.
    pub end: u32,
    /// The cell of each root that is wanted anywhere, in their order.
    pub places: Vec<u32>,
}

/// What a run of a tape has met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Met {
    /// The first requirement that does not hold, as the instruction of the program, and the number that it is about.
    pub failed: Option<(Id, f64)>,
    /// Whether something that is held is another number now.
    pub changed: bool,
}

impl Tape {
    /// Number of cells that makes a tape quicker which names none beyond them: what it names need not be compared then.
    pub const FEW_CELLS: usize = FEW;

    /// A tape that computes the `roots` of a program with these instructions. `leaf` says where constants and what comes from
    /// outside lie; cells from `temporaries` on are free for the tape.
    ///
    /// What comes from a cell is what that holds before the run, also where the tape writes it.
    pub fn make(ops: &[Op], roots: &[Root], leaf: &dyn Fn(Op) -> Leaf, temporaries: u32) -> Made {
        Maker::new(ops, roots).make(roots, leaf, temporaries)
    }

    /// Number of instructions.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether nothing is computed.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Its instructions.
    pub fn words(&self) -> &[Word] {
        &self.words
    }

    /// Whether both do the same and leave the same results.
    pub fn does_as(&self, other: &Tape) -> bool {
        (&self.words, self.temporaries, &self.places) == (&other.words, other.temporaries, &other.places)
    }

    /// Whether what a run leaves in this cell is a result. Nobody reads the others that are written: a machine may leave there what it likes.
    pub fn is_result(&self, cell: u32) -> bool {
        cell < self.temporaries || self.places.binary_search(&cell).is_ok()
    }

    /// The cells that a run reads or writes, and the held numbers, each once and in order.
    pub fn names(&self) -> [Vec<u32>; 2] {
        let (mut cells, mut held) = (Vec::new(), Vec::new());
        for word in &self.words {
            let Word { code, to, a, .. } = *word;
            cells.extend(word.reads());
            cells.extend(word.writes());
            match code {
                Code::Load => held.push(a),
                Code::Hold => held.push(to),
                _ => {}
            }
        }
        [cells, held].map(|mut names| {
            names.sort_unstable();
            names.dedup();
            names
        })
    }

    /// How many cells and held numbers a run needs.
    pub fn extent(&self) -> (usize, usize) {
        let [cells, held] = self.names().map(|names| names.last().map_or(0, |last| *last as usize + 1));
        (cells, held)
    }

    /// Has a machine compute what the tape says from now on.
    pub fn run_by(&mut self, machine: Arc<dyn Machine>) {
        self.machine = Some(machine);
    }

    /// Whether a machine computes what the tape says.
    pub fn has_machine(&self) -> bool {
        self.machine.is_some()
    }

    /// Computes everything.
    ///
    /// # Panics
    /// Panics if there are fewer cells or held numbers than the tape was made for.
    #[inline]
    pub fn run(&self, cells: &mut [f64], held: &mut [f64]) -> Met {
        self.met(match &self.machine {
            None => self.steps.run(cells, held),
            Some(machine) => machine.run(cells, held),
        })
    }

    /// Computes everything; returns whether all requirements are met.
    ///
    /// # Panics
    /// Panics if there are fewer cells or held numbers than the tape was made for.
    #[inline]
    pub fn meets(&self, cells: &mut [f64], held: &mut [f64]) -> bool {
        let ran = match &self.machine {
            None => self.steps.run(cells, held),
            Some(machine) => machine.run(cells, held),
        };
        ran.failed.is_none()
    }

    /// As [`run`](Self::run), always by the interpreter.
    ///
    /// # Panics
    /// Panics if there are fewer cells or held numbers than the tape was made for.
    pub fn interpret(&self, cells: &mut [f64], held: &mut [f64]) -> Met {
        self.met(self.steps.run(cells, held))
    }

    #[inline]
    fn met(&self, Ran { failed, changed }: Ran) -> Met {
        Met { failed: failed.map(|(word, about)| (self.from[word], about)), changed }
    }
}

/// Makes a tape of instructions.
struct Maker<'o> {
    ops: &'o [Op],
    /// How often each value is read by what is needed.
    uses: Vec<u32>,
    /// Products that the sum which alone reads them takes in.
    taken_in: Vec<bool>,
    /// The last reader of each value that is needed; roots count as one behind all.
    last: Vec<Option<usize>>,
    place: Vec<u32>,
    free: Vec<u32>,
    /// First cell that is free for the tape.
    temporaries: u32,
    made: Made,
}

/// The reader behind all others.
const END: usize = usize::MAX;

impl<'o> Maker<'o> {
    fn new(ops: &'o [Op], roots: &[Root]) -> Self {
        let n = ops.len();
        let mut needed = vec![false; n];
        let mut uses = vec![0_u32; n];
        for root in roots {
            needed[root.id().at()] = true;
            // Taken in by nobody.
            uses[root.id().at()] += 2;
        }
        for at in (0..n).rev() {
            if needed[at] {
                for operand in ops[at].operands() {
                    needed[operand.at()] = true;
                    uses[operand.at()] += 1;
                }
            }
        }
        let mut maker = Self {
            ops,
            uses,
            taken_in: vec![false; n],
            last: vec![None; n],
            place: vec![0; n],
            free: Vec::new(),
            temporaries: 0,
            made: Made::default(),
        };
        for at in (0..n).filter(|at| needed[*at]) {
            if let Some(product) = maker.product_of(at) {
                maker.taken_in[product.at()] = true;
            }
        }
        roots.iter().for_each(|root| maker.last[root.id().at()] = Some(END));
        for at in (0..n).rev().filter(|at| needed[*at] && !maker.taken_in[*at]).collect::<Vec<_>>() {
            maker.last[at].get_or_insert(at);
            for operand in maker.operands(at) {
                maker.last[operand.at()].get_or_insert(at);
            }
        }
        maker
    }

    /// The product that a sum or difference can take in.
    fn product_of(&self, at: usize) -> Option<Id> {
        let (Op::Add(a, b) | Op::Sub(a, b)) = self.ops[at] else { return None };
        let fits = |id: &Id| matches!(self.ops[id.at()], Op::Mul(..)) && self.uses[id.at()] == 1;
        [b, a].into_iter().find(fits)
    }

    fn is_taken_in(&self, id: Id) -> Option<(Id, Id)> {
        match self.ops[id.at()] {
            Op::Mul(a, b) if self.taken_in[id.at()] => Some((a, b)),
            _ => None,
        }
    }

    /// What an instruction reads, through products that it takes in.
    fn operands(&self, at: usize) -> Vec<Id> {
        let mut operands: Vec<Id> = Vec::with_capacity(3);
        for operand in self.ops[at].operands() {
            match self.is_taken_in(operand) {
                Some((a, b)) => operands.extend([a, b]),
                None => operands.push(operand),
            }
        }
        operands.sort_unstable();
        operands.dedup();
        operands
    }

    fn make(mut self, roots: &[Root], leaf: &dyn Fn(Op) -> Leaf, temporaries: u32) -> Made {
        (self.temporaries, self.made.end) = (temporaries, temporaries);
        let mut targets: Vec<Option<u32>> = vec![None; self.ops.len()];
        let mut written = Set::default();
        for root in roots {
            if let Root::Cell(id, cell) = *root {
                targets[id.at()].get_or_insert(cell);
                written.insert(cell);
            }
        }
        // What lies in cells that are written is brought out of the way first; products that are taken in have no place.
        let wanted: Vec<usize> = (0..self.ops.len()).filter(|at| self.last[*at].is_some()).collect();
        for &at in wanted.iter().filter(|at| self.ops[**at].is_leaf()) {
            match leaf(self.ops[at]) {
                Leaf::Cell(cell) if !written.contains(&cell) => self.place[at] = cell,
                Leaf::Cell(cell) => {
                    self.place[at] = self.temporary();
                    self.push(Code::Copy, self.place[at], [cell, 0, 0], at);
                }
                Leaf::Held(number) => {
                    // Where it is wanted in a cell that nobody else has, it is brought there.
                    self.place[at] = match targets[at] {
                        Some(cell) => cell,
                        None => self.temporary(),
                    };
                    self.push(Code::Load, self.place[at], [number, 0, 0], at);
                }
            }
        }
        for &at in wanted.iter().filter(|at| !self.ops[**at].is_leaf()) {
            self.instruction(at, targets[at]);
        }
        for root in roots {
            match *root {
                Root::Cell(id, cell) if self.place[id.at()] != cell => {
                    self.push(Code::Copy, cell, [self.place[id.at()], 0, 0], id.at());
                }
                Root::Held(id, number) => {
                    self.push(Code::Hold, number, [self.place[id.at()], 0, 0], id.at());
                }
                Root::Anywhere(id) => self.made.places.push(self.place[id.at()]),
                Root::Cell(..) | Root::Met(_) => {}
            }
        }
        let (tape, places) = (&mut self.made.tape, &self.made.places);
        tape.temporaries = temporaries;
        tape.places = places.iter().copied().filter(|cell| *cell >= temporaries).collect();
        tape.places.sort_unstable();
        tape.places.dedup();
        tape.steps = Steps::new(&tape.words);
        self.made
    }

    fn temporary(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.made.end += 1;
            self.made.end - 1
        })
    }

    fn push(&mut self, code: Code, to: u32, [a, b, c]: [u32; 3], at: usize) {
        self.made.tape.words.push(Word { code, to, a, b, c });
        self.made.tape.from.push(Id(at as u32));
    }

    fn instruction(&mut self, at: usize, target: Option<u32>) {
        let p = |id: Id| self.place[id.at()];
        let three = |code, a, b, c| (code, [p(a), p(b), p(c)]);
        let two = |code, a, b| (code, [p(a), p(b), 0]);
        let one = |code, a| (code, [p(a), 0, 0]);
        let (code, operands) = match self.ops[at] {
            Op::Neg(a) => one(Code::Neg, a),
            Op::Add(a, b) => match (self.is_taken_in(a), self.is_taken_in(b)) {
                (_, Some((left, right))) => three(Code::MulAdd, left, right, a),
                (Some((left, right)), None) => three(Code::MulAdd, left, right, b),
                (None, None) => two(Code::Add, a, b),
            },
            Op::Sub(a, b) => match (self.is_taken_in(a), self.is_taken_in(b)) {
                (_, Some((left, right))) => three(Code::SubMul, left, right, a),
                (Some((left, right)), None) => three(Code::MulSub, left, right, b),
                (None, None) => two(Code::Sub, a, b),
            },
            Op::Mul(a, b) => two(Code::Mul, a, b),
            Op::Div(a, b) => two(Code::Div, a, b),
            Op::Power(a, n) => (Code::Power, [p(a), n as u32, 0]),
            Op::Clamp(a, lower, upper) => three(Code::Clamp, a, lower, upper),
            Op::Unary(function, a) => one(Code::Unary(function), a),
            Op::Binary(function, a, b) => two(Code::Binary(function), a, b),
            Op::Compare(relation, a, b) => two(Code::Compare(relation), a, b),
            Op::Not(a) => one(Code::Not, a),
            Op::And(a, b) => two(Code::And, a, b),
            Op::Or(a, b) => two(Code::Or, a, b),
            Op::Select(condition, a, b) => three(Code::Select, condition, a, b),
            Op::Require(_, holds, about) => two(Code::Require, holds, about),
            Op::Constant(_)
            | Op::Time
            | Op::Input(_)
            | Op::State(_)
            | Op::Parameter(_)
            | Op::Memory(_)
            | Op::Mode(_) => return,
        };
        let requires = code == Code::Require;
        for operand in self.operands(at) {
            let is_temporary = self.place[operand.at()] >= self.temporaries;
            if self.last[operand.at()] == Some(at) && is_temporary {
                self.free.push(self.place[operand.at()]);
            }
        }
        let to = match target {
            _ if requires => 0,
            Some(cell) => cell,
            None => self.temporary(),
        };
        self.place[at] = to;
        self.push(code, to, operands, at);
    }
}
