//! Instructions and what they compute.

use crate::interpreter::clamp;

/// The number of an instruction, which is that of the value that it computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(pub u32);

impl Id {
    pub(crate) fn at(self) -> usize {
        self.0 as usize
    }
}

/// What an instruction computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Op {
    /// A constant, by its bits.
    Constant(u64),
    /// The time, s.
    Time,
    /// An input.
    Input(u32),
    /// A continuous state.
    State(u32),
    /// A parameter.
    Parameter(u32),
    /// The value of a memory.
    Memory(u32),
    /// The value that a mode holds.
    Mode(u32),
    /// `-a`
    Neg(Id),
    /// `a + b`
    Add(Id, Id),
    /// `a - b`
    Sub(Id, Id),
    /// `a * b`
    Mul(Id, Id),
    /// `a / b`
    Div(Id, Id),
    /// A whole power, by repeated multiplication.
    Power(Id, i32),
    /// A function of one number.
    Unary(Unary, Id),
    /// A function of two numbers.
    Binary(Binary, Id, Id),
    /// The first between the second, its lower limit, and the third, its upper one; what is not a number stays so.
    Clamp(Id, Id, Id),
    /// A comparison, true or false.
    Compare(Relation, Id, Id),
    /// Whether it is false.
    Not(Id),
    /// Whether both are true.
    And(Id, Id),
    /// Whether one is true.
    Or(Id, Id),
    /// The second where the first is true, else the third.
    Select(Id, Id, Id),
    /// The law ends with an error unless the first is true; the second is the number that it is about.
    Require(Domain, Id, Id),
}

/// A function of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unary {
    /// Absolute value.
    Abs,
    /// -1, 0 or 1; what is not a number stays so.
    Sign,
    /// Square root.
    Sqrt,
    /// Power of e.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 10.
    Log10,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine.
    Asin,
    /// Inverse cosine.
    Acos,
    /// Inverse tangent.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Next whole number below.
    Floor,
    /// Next whole number above.
    Ceil,
    /// Nearest whole number, halves away from zero.
    Round,
}

/// A function of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    /// The smaller one; not a number if one of them is not.
    Min,
    /// The greater one; not a number if one of them is not.
    Max,
    /// Any power.
    Pow,
    /// Distance from the origin.
    Hypot,
    /// Angle of a point, ordinate first.
    Atan2,
}

/// A comparison. What is not a number is only unequal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

/// What a number must be, so that a function of it has a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Above zero: logarithms.
    Positive,
    /// Zero or above: square roots.
    NotNegative,
    /// From -1 to 1: inverse sines and cosines.
    WithinOne,
    /// Other than zero: divisors.
    NotZero,
    /// The base of a power: not negative unless the exponent is whole, not zero where the exponent is negative.
    Base,
}

impl Domain {
    /// What the number must be.
    pub fn wanted(self) -> &'static str {
        match self {
            Domain::Positive => "positive",
            Domain::NotNegative => "not negative",
            Domain::WithinOne => "between -1 and 1",
            Domain::NotZero => "other than 0",
            Domain::Base => {
                "positive (negative only with a whole exponent, 0 only with one that is not negative)"
            }
        }
    }
}

impl Op {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Op::Constant(value.to_bits())
    }

    /// The value of a constant.
    pub fn as_constant(self) -> Option<f64> {
        if let Op::Constant(bits) = self { Some(f64::from_bits(bits)) } else { None }
    }

    /// Whether its value comes from outside, or never changes.
    pub fn is_leaf(self) -> bool {
        matches!(
            self,
            Op::Constant(_)
                | Op::Time
                | Op::Input(_)
                | Op::State(_)
                | Op::Parameter(_)
                | Op::Memory(_)
                | Op::Mode(_)
        )
    }

    /// Whether it is true or false rather than a number; a mode is what its value is.
    pub fn is_truth(self) -> bool {
        matches!(self, Op::Compare(..) | Op::Not(_) | Op::And(..) | Op::Or(..) | Op::Require(..))
    }

    /// What it needs.
    pub fn operands(self) -> impl Iterator<Item = Id> {
        let operands = match self {
            Op::Constant(_)
            | Op::Time
            | Op::Input(_)
            | Op::State(_)
            | Op::Parameter(_)
            | Op::Memory(_)
            | Op::Mode(_) => [None; 3],
            Op::Neg(a) | Op::Power(a, _) | Op::Unary(_, a) | Op::Not(a) => [Some(a), None, None],
            Op::Add(a, b)
            | Op::Sub(a, b)
            | Op::Mul(a, b)
            | Op::Div(a, b)
            | Op::Binary(_, a, b)
            | Op::Compare(_, a, b)
            | Op::And(a, b)
            | Op::Or(a, b)
            | Op::Require(_, a, b) => [Some(a), Some(b), None],
            Op::Select(a, b, c) | Op::Clamp(a, b, c) => [Some(a), Some(b), Some(c)],
        };
        operands.into_iter().flatten()
    }

    /// The same with other operands.
    #[must_use]
    pub fn map(self, mut f: impl FnMut(Id) -> Id) -> Self {
        match self {
            Op::Constant(_)
            | Op::Time
            | Op::Input(_)
            | Op::State(_)
            | Op::Parameter(_)
            | Op::Memory(_)
            | Op::Mode(_) => self,
            Op::Neg(a) => Op::Neg(f(a)),
            Op::Power(a, n) => Op::Power(f(a), n),
            Op::Unary(function, a) => Op::Unary(function, f(a)),
            Op::Not(a) => Op::Not(f(a)),
            Op::Add(a, b) => Op::Add(f(a), f(b)),
            Op::Sub(a, b) => Op::Sub(f(a), f(b)),
            Op::Mul(a, b) => Op::Mul(f(a), f(b)),
            Op::Div(a, b) => Op::Div(f(a), f(b)),
            Op::Binary(function, a, b) => Op::Binary(function, f(a), f(b)),
            Op::Clamp(a, lower, upper) => Op::Clamp(f(a), f(lower), f(upper)),
            Op::Compare(relation, a, b) => Op::Compare(relation, f(a), f(b)),
            Op::And(a, b) => Op::And(f(a), f(b)),
            Op::Or(a, b) => Op::Or(f(a), f(b)),
            Op::Require(domain, a, b) => Op::Require(domain, f(a), f(b)),
            Op::Select(a, b, c) => Op::Select(f(a), f(b), f(c)),
        }
    }

    /// The value of an operation on numbers; `None` for what comes from outside and for requirements.
    #[inline]
    pub(crate) fn value(self, r: impl Fn(Id) -> f64) -> Option<f64> {
        Some(match self {
            Op::Constant(bits) => f64::from_bits(bits),
            Op::Neg(a) => -r(a),
            Op::Add(a, b) => r(a) + r(b),
            Op::Sub(a, b) => r(a) - r(b),
            Op::Mul(a, b) => r(a) * r(b),
            Op::Div(a, b) => r(a) / r(b),
            Op::Power(a, n) => power(r(a), n),
            Op::Unary(function, a) => function.of(r(a)),
            Op::Binary(function, a, b) => function.of(r(a), r(b)),
            Op::Clamp(a, lower, upper) => clamp(r(a), r(lower), r(upper)),
            Op::Compare(relation, a, b) => truth(relation.holds(r(a), r(b))),
            Op::Not(a) => truth(r(a) == 0.0),
            Op::And(a, b) => truth(r(a) != 0.0 && r(b) != 0.0),
            Op::Or(a, b) => truth(r(a) != 0.0 || r(b) != 0.0),
            Op::Select(c, a, b) => {
                if r(c) != 0.0 {
                    r(a)
                } else {
                    r(b)
                }
            }
            Op::Time
            | Op::Input(_)
            | Op::State(_)
            | Op::Parameter(_)
            | Op::Memory(_)
            | Op::Mode(_)
            | Op::Require(..) => return None,
        })
    }
}

#[inline]
pub(crate) fn truth(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// `base^n` by repeated squaring, so that it is the same everywhere. A negative exponent gives the reciprocal.
pub(crate) fn power(base: f64, n: i32) -> f64 {
    let (mut left, mut square, mut product) = (n.unsigned_abs(), base, 1.0);
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    if n < 0 { 1.0 / product } else { product }
}

impl Unary {
    /// The value.
    #[inline]
    pub fn of(self, u: f64) -> f64 {
        match self {
            Unary::Abs => u.abs(),
            Unary::Sign => {
                if u == 0.0 || u.is_nan() {
                    u
                } else {
                    u.signum()
                }
            }
            Unary::Sqrt => u.sqrt(),
            Unary::Exp => u.exp(),
            Unary::Ln => u.ln(),
            Unary::Log10 => u.log10(),
            Unary::Sin => u.sin(),
            Unary::Cos => u.cos(),
            Unary::Tan => u.tan(),
            Unary::Asin => u.asin(),
            Unary::Acos => u.acos(),
            Unary::Atan => u.atan(),
            Unary::Sinh => u.sinh(),
            Unary::Cosh => u.cosh(),
            Unary::Tanh => u.tanh(),
            Unary::Floor => u.floor(),
            Unary::Ceil => u.ceil(),
            Unary::Round => u.round(),
        }
    }
}

impl Binary {
    /// The value.
    #[inline]
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Min => {
                if b < a || b.is_nan() {
                    b
                } else {
                    a
                }
            }
            Binary::Max => {
                if b > a || b.is_nan() {
                    b
                } else {
                    a
                }
            }
            Binary::Pow => a.powf(b),
            Binary::Hypot => a.hypot(b),
            Binary::Atan2 => a.atan2(b),
        }
    }
}

impl Relation {
    /// Whether it holds.
    #[inline]
    pub fn holds(self, a: f64, b: f64) -> bool {
        match self {
            Relation::Less => a < b,
            Relation::LessEqual => a <= b,
            Relation::Greater => a > b,
            Relation::GreaterEqual => a >= b,
            Relation::Equal => a == b,
            Relation::NotEqual => a != b,
        }
    }
}
