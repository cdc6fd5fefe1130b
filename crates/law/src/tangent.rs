//! Exact slopes by forward mode: a program that computes how the values of another one change.

use crate::{Binary, Code, Id, Instruction, Op, Program, Relation, Sources, Unary};

/// The program with its tangent: beside its inputs there is one for the rate of each of them (`d u`), then one for that
/// of each state, and beside its outputs one for the rate of each of them, then one for that of each derivative (`d x'`).
/// What modes hold does not change. Rates at a kink are those of the side on which the value is computed.
#[must_use]
pub fn tangent(program: &Program) -> Program {
    let first = program.inputs.len() as u32;
    let (mut t, rates) = Tangent::of(program, &|op| match op {
        Op::Input(i) => Some(Op::Input(first + i)),
        Op::State(i) => Some(Op::Input(2 * first + i)),
        _ => None,
    });
    let rate_names = program.inputs.iter().chain(program.states.iter().map(|state| &state.name));
    let rate_names = rate_names.map(|name| format!("d {name}"));
    let inputs = program.inputs.iter().cloned().chain(rate_names).collect();
    let mut outputs = program.outputs.clone();
    let derivatives = program.states.iter().filter_map(|state| {
        let derivative = state.derivative?;
        Some((format!("{}'", state.name), derivative))
    });
    for (name, id) in program.outputs.iter().cloned().chain(derivatives) {
        let rate = rates[id.at()].unwrap_or_else(|| t.push(Op::constant(0.0), id.at()));
        outputs.push((format!("d {name}"), rate));
    }
    Program { instructions: t.instructions, inputs, outputs, ..program.clone() }
}

/// A program of the rates of the outputs alone. `seed` is the rate of what comes from outside; without one it does not change.
#[must_use]
pub fn rates(program: &Program, seed: &dyn Fn(Op) -> Option<Op>) -> Program {
    let (mut t, rates) = Tangent::of(program, seed);
    let outputs = program.outputs.iter().map(|(name, id)| {
        let rate = rates[id.at()].unwrap_or_else(|| t.push(Op::constant(0.0), id.at()));
        (name.clone(), rate)
    });
    let outputs = outputs.collect();
    Program { instructions: t.instructions, outputs, ..program.clone() }
}

struct Tangent {
    instructions: Vec<Instruction>,
}

impl Tangent {
    /// The instructions of a program with those of the rates of all values, and where these are.
    fn of(program: &Program, seed: &dyn Fn(Op) -> Option<Op>) -> (Self, Vec<Option<Id>>) {
        let mut t = Self { instructions: program.instructions.clone() };
        let mut rates: Vec<Option<Id>> = Vec::with_capacity(program.instructions.len());
        for (at, Instruction { op, .. }) in program.instructions.iter().enumerate() {
            let rate = match *op {
                leaf if leaf.is_leaf() => seed(leaf).map(|op| t.push(op, at)),
                op => t.rate(op, Id(at as u32), &rates),
            };
            rates.push(rate);
        }
        (t, rates)
    }

    /// Adds an instruction that has the place of another one.
    fn push(&mut self, op: Op, of: usize) -> Id {
        let instruction = Instruction { op, ..self.instructions[of].clone() };
        self.instructions.push(instruction);
        Id(self.instructions.len() as u32 - 1)
    }

    /// The rate of a value; `None` where it does not change.
    fn rate(&mut self, op: Op, y: Id, rates: &[Option<Id>]) -> Option<Id> {
        let at = y.at();
        let of = |id: Id| rates[id.at()];
        match op {
            Op::Constant(_)
            | Op::Time
            | Op::Input(_)
            | Op::State(_)
            | Op::Parameter(_)
            | Op::Memory(_)
            | Op::Mode(_)
            | Op::Compare(..)
            | Op::Not(_)
            | Op::And(..)
            | Op::Or(..)
            | Op::Require(..) => None,
            Op::Neg(a) => of(a).map(|da| self.push(Op::Neg(da), at)),
            Op::Add(a, b) => self.sum(of(a), of(b), at),
            Op::Sub(a, b) => match (of(a), of(b)) {
                (Some(da), Some(db)) => Some(self.push(Op::Sub(da, db), at)),
                (da, None) => da,
                (None, Some(db)) => Some(self.push(Op::Neg(db), at)),
            },
            Op::Mul(a, b) => {
                let left = of(a).map(|da| self.push(Op::Mul(da, b), at));
                let right = of(b).map(|db| self.push(Op::Mul(a, db), at));
                self.sum(left, right, at)
            }
            Op::Div(a, b) => {
                // (da - y db) / b
                let above = match (of(a), of(b)) {
                    (da, None) => da,
                    (da, Some(db)) => {
                        let part = self.push(Op::Mul(y, db), at);
                        Some(match da {
                            Some(da) => self.push(Op::Sub(da, part), at),
                            None => self.push(Op::Neg(part), at),
                        })
                    }
                };
                above.map(|above| self.push(Op::Div(above, b), at))
            }
            Op::Power(_, 0) => None,
            Op::Power(a, n) => {
                let da = of(a)?;
                let lower = self.push(Op::Power(a, n - 1), at);
                let factor = self.push(Op::constant(f64::from(n)), at);
                let slope = self.push(Op::Mul(factor, lower), at);
                Some(self.push(Op::Mul(slope, da), at))
            }
            Op::Unary(function, a) => {
                let da = of(a)?;
                self.unary(function, a, y, da)
            }
            Op::Binary(function, a, b) => self.binary(function, (a, of(a)), (b, of(b)), y),
            Op::Select(c, a, b) => self.select(c, of(a), of(b), at),
            Op::Clamp(a, lower, upper) => {
                if [a, lower, upper].into_iter().all(|id| of(id).is_none()) {
                    return None;
                }
                let above = self.push(Op::Compare(Relation::Greater, a, upper), at);
                let below = self.push(Op::Compare(Relation::Less, a, lower), at);
                let inside = self.select(below, of(lower), of(a), at);
                self.select(above, of(upper), inside, at)
            }
        }
    }

    fn sum(&mut self, a: Option<Id>, b: Option<Id>, at: usize) -> Option<Id> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.push(Op::Add(a, b), at)),
            (one, None) | (None, one) => one,
        }
    }

    fn select(&mut self, c: Id, a: Option<Id>, b: Option<Id>, at: usize) -> Option<Id> {
        if a.is_none() && b.is_none() {
            return None;
        }
        let a = a.unwrap_or_else(|| self.push(Op::constant(0.0), at));
        let b = b.unwrap_or_else(|| self.push(Op::constant(0.0), at));
        Some(self.push(Op::Select(c, a, b), at))
    }

    fn unary(&mut self, function: Unary, a: Id, y: Id, da: Id) -> Option<Id> {
        let at = y.at();
        let one = |t: &mut Self| t.push(Op::constant(1.0), at);
        let square = |t: &mut Self, id: Id| t.push(Op::Mul(id, id), at);
        // The slope, or what the rate is to be divided by.
        let (slope, divides) = match function {
            Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round => return None,
            Unary::Abs => {
                let zero = self.push(Op::constant(0.0), at);
                let negative = self.push(Op::Compare(Relation::Less, a, zero), at);
                let back = self.push(Op::Neg(da), at);
                return Some(self.push(Op::Select(negative, back, da), at));
            }
            Unary::Sqrt => {
                let two = self.push(Op::constant(2.0), at);
                (self.push(Op::Mul(two, y), at), true)
            }
            Unary::Exp => (y, false),
            Unary::Ln => (a, true),
            Unary::Log10 => {
                let factor = self.push(Op::constant(std::f64::consts::LN_10), at);
                (self.push(Op::Mul(a, factor), at), true)
            }
            Unary::Sin => (self.push(Op::Unary(Unary::Cos, a), at), false),
            Unary::Cos => {
                let sine = self.push(Op::Unary(Unary::Sin, a), at);
                (self.push(Op::Neg(sine), at), false)
            }
            Unary::Tan => {
                let (one, square) = (one(self), square(self, y));
                (self.push(Op::Add(one, square), at), false)
            }
            Unary::Asin | Unary::Acos => {
                // (1 - a) (1 + a) keeps its digits near one.
                let one = one(self);
                let (below, above) = (self.push(Op::Sub(one, a), at), self.push(Op::Add(one, a), at));
                let product = self.push(Op::Mul(below, above), at);
                let root = self.push(Op::Unary(Unary::Sqrt, product), at);
                let root = if function == Unary::Acos { self.push(Op::Neg(root), at) } else { root };
                (root, true)
            }
            Unary::Atan => {
                let (one, square) = (one(self), square(self, a));
                (self.push(Op::Add(one, square), at), true)
            }
            Unary::Sinh => (self.push(Op::Unary(Unary::Cosh, a), at), false),
            Unary::Cosh => (self.push(Op::Unary(Unary::Sinh, a), at), false),
            Unary::Tanh => {
                // Of the hyperbolic cosine: 1 - y^2 loses all digits where y is near one.
                let cosh = self.push(Op::Unary(Unary::Cosh, a), at);
                (square(self, cosh), true)
            }
        };
        Some(self.push(if divides { Op::Div(da, slope) } else { Op::Mul(slope, da) }, at))
    }

    fn binary(
        &mut self,
        function: Binary,
        (a, da): (Id, Option<Id>),
        (b, db): (Id, Option<Id>),
        y: Id,
    ) -> Option<Id> {
        if da.is_none() && db.is_none() {
            return None;
        }
        let at = y.at();
        match function {
            Binary::Min | Binary::Max => {
                let relation = if function == Binary::Min { Relation::Less } else { Relation::Greater };
                let takes_b = self.push(Op::Compare(relation, b, a), at);
                self.select(takes_b, db, da, at)
            }
            Binary::Pow => {
                let along_base = da.map(|da| {
                    let one = self.push(Op::constant(1.0), at);
                    let lower = self.push(Op::Sub(b, one), at);
                    let power = self.push(Op::Binary(Binary::Pow, a, lower), at);
                    let slope = self.push(Op::Mul(b, power), at);
                    self.push(Op::Mul(slope, da), at)
                });
                let along_exponent = db.map(|db| {
                    let ln = self.push(Op::Unary(Unary::Ln, a), at);
                    let slope = self.push(Op::Mul(y, ln), at);
                    self.push(Op::Mul(slope, db), at)
                });
                self.sum(along_base, along_exponent, at)
            }
            Binary::Hypot => {
                let first = da.map(|da| self.push(Op::Mul(a, da), at));
                let second = db.map(|db| self.push(Op::Mul(b, db), at));
                let sum = self.sum(first, second, at)?;
                Some(self.push(Op::Div(sum, y), at))
            }
            Binary::Atan2 => {
                let first = da.map(|da| self.push(Op::Mul(b, da), at));
                let second = db.map(|db| {
                    let product = self.push(Op::Mul(a, db), at);
                    self.push(Op::Neg(product), at)
                });
                let sum = self.sum(first, second, at)?;
                let (x2, y2) = (self.push(Op::Mul(b, b), at), self.push(Op::Mul(a, a), at));
                let square = self.push(Op::Add(x2, y2), at);
                Some(self.push(Op::Div(sum, square), at))
            }
        }
    }
}

/// Slopes of the outputs, then of the derivatives, over the inputs, then over the states: a row for each of the former, at the
/// given values. `program` itself, not its tangent.
///
/// # Panics
/// Panics if there are fewer sources than the program names.
pub fn slopes(program: &Program, sources: &Sources) -> Vec<Vec<f64>> {
    // Not optimised: modes keep their numbers, and the code leaves out what it does not need.
    let tangent = tangent(program);
    let rates: Vec<Id> = tangent.outputs[program.outputs.len()..].iter().map(|(_, id)| *id).collect();
    let code = Code::new(&tangent, &rates);
    let (own, states) = (program.inputs.len(), program.states.len());
    let mut inputs = sources.inputs[..own].to_vec();
    inputs.resize(2 * own + states, 0.0);
    let mut registers = vec![0.0; code.registers()];
    let mut rows = vec![Vec::with_capacity(own + states); rates.len()];
    for direction in own..2 * own + states {
        inputs[direction] = 1.0;
        code.run(&Sources { inputs: &inputs, ..*sources }, &mut registers);
        inputs[direction] = 0.0;
        rows.iter_mut().enumerate().for_each(|(i, row)| row.push(code.result(&registers, i)));
    }
    rows
}
