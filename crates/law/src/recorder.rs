//! Recording of laws with ordinary operators.

use crate::{Binary, Domain, Guard, Id, Instruction, Memory, Mode, Op, Program, Relation, State, Unary};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Range, Sub};

/// Records a law. Its values are handles that can be copied and calculated with like numbers.
#[derive(Debug, Default)]
pub struct Recorder {
    inner: RefCell<Inner>,
}

#[derive(Debug, Default)]
struct Inner {
    program: Program,
    place: Option<Range<usize>>,
    /// The condition under which what is recorded now counts, and those around it.
    branches: Vec<Id>,
}

/// A number of a law.
#[derive(Debug, Clone, Copy)]
pub struct Value<'r> {
    of: &'r Recorder,
    id: Id,
}

/// Something of a law that is true or false.
#[derive(Debug, Clone, Copy)]
pub struct Condition<'r> {
    of: &'r Recorder,
    id: Id,
}

impl Recorder {
    /// An empty law.
    pub fn new() -> Self {
        Self::default()
    }

    /// What was recorded.
    pub fn finish(self) -> Program {
        self.inner.into_inner().program
    }

    /// What follows comes from these bytes of a text.
    pub fn at(&self, place: Range<usize>) {
        self.inner.borrow_mut().place = Some(place);
    }

    /// The handle of a value that is recorded already.
    pub(crate) fn handle(&self, id: Id) -> Value<'_> {
        Value { of: self, id }
    }

    /// Lists a requirement that is recorded already.
    pub(crate) fn requires(&self, id: Id) {
        self.inner.borrow_mut().program.requirements.push(id);
    }

    pub(crate) fn push(&self, op: Op) -> Id {
        let place = self.inner.borrow().place.clone();
        self.push_at(op, place)
    }

    pub(crate) fn push_at(&self, op: Op, place: Option<Range<usize>>) -> Id {
        let mut inner = self.inner.borrow_mut();
        inner.program.instructions.push(Instruction { op, place, block: None });
        Id(inner.program.instructions.len() as u32 - 1)
    }

    fn number(&self, op: Op) -> Value<'_> {
        Value { of: self, id: self.push(op) }
    }

    fn truth(&self, op: Op) -> Condition<'_> {
        Condition { of: self, id: self.push(op) }
    }

    /// A constant.
    pub fn constant(&self, value: f64) -> Value<'_> {
        self.number(Op::constant(value))
    }

    /// A truth value that never changes.
    pub fn fixed(&self, value: bool) -> Condition<'_> {
        let number = |value: bool| self.constant(f64::from(u8::from(value))).id;
        self.truth(Op::Compare(Relation::Equal, number(value), number(true)))
    }

    /// The time, s.
    pub fn time(&self) -> Value<'_> {
        self.number(Op::Time)
    }

    /// Adds an input.
    pub fn input(&self, name: &str) -> Value<'_> {
        let index = add(&mut self.inner.borrow_mut().program.inputs, name.to_owned());
        self.number(Op::Input(index))
    }

    /// Adds a continuous state.
    pub fn state(&self, name: &str, initial: f64) -> Value<'_> {
        let state = State { name: name.to_owned(), initial, derivative: None };
        let index = add(&mut self.inner.borrow_mut().program.states, state);
        self.number(Op::State(index))
    }

    /// Says what the derivative of a state is. Whatever is not a state of this law has none.
    pub fn derive(&self, state: Value, derivative: Value) {
        let mut inner = self.inner.borrow_mut();
        if let Op::State(index) = inner.program.op(state.id) {
            inner.program.states[index as usize].derivative = Some(derivative.id);
        }
    }

    /// Adds a parameter.
    pub fn parameter(&self, name: &str, value: f64) -> Value<'_> {
        let index = add(&mut self.inner.borrow_mut().program.parameters, (name.to_owned(), value));
        self.number(Op::Parameter(index))
    }

    /// Adds a memory.
    pub fn memory(&self, name: &str, initial: f64) -> Value<'_> {
        let memory = Memory { name: name.to_owned(), initial, next: None };
        let index = add(&mut self.inner.borrow_mut().program.memories, memory);
        self.number(Op::Memory(index))
    }

    /// Says what a memory becomes at the next sample hit. Whatever is not a memory of this law becomes nothing.
    pub fn update(&self, memory: Value, next: Value) {
        let mut inner = self.inner.borrow_mut();
        if let Op::Memory(index) = inner.program.op(memory.id) {
            inner.program.memories[index as usize].next = Some(next.id);
        }
    }

    /// Names a value as an output.
    pub fn output(&self, name: &str, value: Value) {
        self.inner.borrow_mut().program.outputs.push((name.to_owned(), value.id));
    }

    /// Names a truth value as an output.
    pub fn output_truth(&self, name: &str, value: Condition) {
        self.inner.borrow_mut().program.outputs.push((name.to_owned(), value.id));
    }

    /// What follows counts only where the condition holds, until [`leave`](Self::leave): requirements of the branch that is not
    /// taken are none.
    pub fn enter(&self, condition: Condition) {
        let around = self.inner.borrow().branches.last().copied();
        let id = match around {
            Some(around) => self.push(Op::And(around, condition.id)),
            None => condition.id,
        };
        self.inner.borrow_mut().branches.push(id);
    }

    /// Ends the innermost branch.
    pub fn leave(&self) {
        self.inner.borrow_mut().branches.pop();
    }

    /// The law ends with an error where `holds` is false, unless it is in a branch that is not taken.
    fn require(&self, domain: Domain, holds: Condition, about: Value) {
        let branch = self.inner.borrow().branches.last().copied();
        let holds = match branch {
            Some(branch) => {
                let elsewhere = self.push(Op::Not(branch));
                self.push(Op::Or(elsewhere, holds.id))
            }
            None => holds.id,
        };
        let id = self.push(Op::Require(domain, holds, about.id));
        self.inner.borrow_mut().program.requirements.push(id);
    }

    /// Holds `value` between major steps; it may change at the zeros of what `guards` makes of the value that is held.
    fn hold<'r>(
        &'r self,
        name: &'static str,
        value: Id,
        guards: impl FnOnce(Value<'r>) -> Vec<Value<'r>>,
    ) -> Id {
        let index = add(&mut self.inner.borrow_mut().program.modes, Mode { value, guards: Vec::new() });
        let held = self.push(Op::Mode(index));
        let guards = guards(Value { of: self, id: held });
        let guards = guards.into_iter().map(|guard| Guard { name, value: guard.id }).collect();
        self.inner.borrow_mut().program.modes[index as usize].guards = guards;
        held
    }

    fn kink(&self, name: &'static str, value: Value) {
        self.inner.borrow_mut().program.kinks.push(Guard { name, value: value.id });
    }

    fn turn(&self, angle: Value) {
        self.inner.borrow_mut().program.turns.push(angle.id);
    }
}

fn add<T>(list: &mut Vec<T>, item: T) -> u32 {
    list.push(item);
    list.len() as u32 - 1
}

macro_rules! operators {
    ($($operator:ident $function:ident $record:ident;)*) => {
        $(impl<'r> $operator for Value<'r> {
            type Output = Value<'r>;
            fn $function(self, other: Value<'r>) -> Value<'r> {
                self.$record(other)
            }
        }
        impl<'r> $operator<f64> for Value<'r> {
            type Output = Value<'r>;
            fn $function(self, other: f64) -> Value<'r> {
                self.$record(self.of.constant(other))
            }
        }
        impl<'r> $operator<Value<'r>> for f64 {
            type Output = Value<'r>;
            fn $function(self, other: Value<'r>) -> Value<'r> {
                other.of.constant(self).$record(other)
            }
        })*
    };
}

operators! {
    Add add record_add;
    Sub sub record_sub;
    Mul mul record_mul;
    Div div record_div;
}

impl<'r> Neg for Value<'r> {
    type Output = Value<'r>;
    fn neg(self) -> Value<'r> {
        self.of.number(Op::Neg(self.id))
    }
}

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident $unary:ident $(, $domain:ident $check:ident)?;)*) => {
        $($(#[$doc])*
        #[must_use]
        pub fn $name(self) -> Self {
            $(self.of.require(Domain::$domain, self.$check(), self);)?
            self.of.number(Op::Unary(Unary::$unary, self.id))
        })*
    };
}

impl<'r> Value<'r> {
    functions! {
        /// The square root; the law ends where the value is negative.
        sqrt Sqrt, NotNegative is_not_negative;
        /// The power of e.
        exp Exp;
        /// The natural logarithm; the law ends where the value is not positive.
        ln Ln, Positive is_positive;
        /// The logarithm to base 10; the law ends where the value is not positive.
        log10 Log10, Positive is_positive;
        /// The inverse sine; the law ends where the value is beyond one.
        asin Asin, WithinOne is_within_one;
        /// The inverse cosine; the law ends where the value is beyond one.
        acos Acos, WithinOne is_within_one;
        /// The inverse tangent.
        atan Atan;
        /// The hyperbolic sine.
        sinh Sinh;
        /// The hyperbolic cosine.
        cosh Cosh;
        /// The hyperbolic tangent.
        tanh Tanh;
    }

    /// The number of the value in the program.
    pub fn id(self) -> Id {
        self.id
    }

    fn record_add(self, other: Self) -> Self {
        self.of.number(Op::Add(self.id, other.id))
    }

    fn record_sub(self, other: Self) -> Self {
        self.of.number(Op::Sub(self.id, other.id))
    }

    fn record_mul(self, other: Self) -> Self {
        self.of.number(Op::Mul(self.id, other.id))
    }

    /// A division by zero ends the law.
    fn record_div(self, other: Self) -> Self {
        self.of.require(Domain::NotZero, other.compare(Relation::NotEqual, 0.0), other);
        self.of.number(Op::Div(self.id, other.id))
    }

    fn compare(self, relation: Relation, other: f64) -> Condition<'r> {
        self.live(relation, self.of.constant(other))
    }

    // What is not a number passes every check: whoever made it so has reported it.
    fn is_positive(self) -> Condition<'r> {
        !self.compare(Relation::LessEqual, 0.0)
    }

    fn is_not_negative(self) -> Condition<'r> {
        !self.compare(Relation::Less, 0.0)
    }

    fn is_within_one(self) -> Condition<'r> {
        !self.absolute().compare(Relation::Greater, 1.0)
    }

    fn absolute(self) -> Self {
        self.of.number(Op::Unary(Unary::Abs, self.id))
    }

    /// The sine of an angle.
    #[must_use]
    pub fn sin(self) -> Self {
        self.of.turn(self);
        self.of.number(Op::Unary(Unary::Sin, self.id))
    }

    /// The cosine of an angle.
    #[must_use]
    pub fn cos(self) -> Self {
        self.of.turn(self);
        self.of.number(Op::Unary(Unary::Cos, self.id))
    }

    /// The tangent of an angle.
    #[must_use]
    pub fn tan(self) -> Self {
        self.of.turn(self);
        self.of.number(Op::Unary(Unary::Tan, self.id))
    }

    /// A whole power; one of zero with a negative exponent ends the law.
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        if n < 0 {
            self.of.require(Domain::NotZero, self.compare(Relation::NotEqual, 0.0), self);
        }
        self.of.number(Op::Power(self.id, n))
    }

    /// Any power; one that is no real number ends the law.
    #[must_use]
    pub fn pow(self, exponent: Self) -> Self {
        let whole = self.of.number(Op::Unary(Unary::Round, exponent.id));
        let is_whole = exponent.live(Relation::Equal, whole);
        let negative_exponent = exponent.compare(Relation::Less, 0.0);
        let broken_root = self.compare(Relation::Less, 0.0).and(!is_whole);
        let division = self.compare(Relation::Equal, 0.0).and(negative_exponent);
        self.of.require(Domain::Base, !broken_root.or(division), self);
        self.of.number(Op::Binary(Binary::Pow, self.id, exponent.id))
    }

    /// The absolute value, with a kink at zero.
    #[must_use]
    pub fn abs(self) -> Self {
        self.of.kink("abs", self);
        self.absolute()
    }

    /// The smaller value, with a kink where both are equal.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.of.kink("min", self - other);
        self.of.number(Op::Binary(Binary::Min, self.id, other.id))
    }

    /// The greater value, with a kink where both are equal.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.of.kink("max", self - other);
        self.of.number(Op::Binary(Binary::Max, self.id, other.id))
    }

    /// The value between two limits; what is not a number stays so. The kinks are at `self - lower` and `self - upper`.
    #[must_use]
    pub fn clamp(self, lower: Self, upper: Self) -> Self {
        self.of.kink("clamp", self - lower);
        self.of.kink("clamp", self - upper);
        self.of.number(Op::Clamp(self.id, lower.id, upper.id))
    }

    /// The law ends where the value is needed and `holds` is false. Whoever records it has the words for that.
    pub fn only_where(self, holds: Condition<'r>) {
        self.of.require(Domain::NotNegative, holds, self);
    }

    /// The nearest whole number, halves away from zero, without an event.
    #[must_use]
    pub fn nearest(self) -> Self {
        self.of.number(Op::Unary(Unary::Round, self.id))
    }

    /// -1, 0 or 1 without an event; what is not a number stays so.
    #[must_use]
    pub fn signum(self) -> Self {
        self.of.number(Op::Unary(Unary::Sign, self.id))
    }

    /// The next whole number below, without an event: for what is whole, or a remainder of a turn.
    #[must_use]
    pub fn below(self) -> Self {
        self.of.number(Op::Unary(Unary::Floor, self.id))
    }

    /// `base` to the power of the value.
    #[must_use]
    pub fn raise(self, base: f64) -> Self {
        self.of.constant(base).pow(self)
    }

    /// Zero, in the same law.
    #[must_use]
    pub fn zero(self) -> Self {
        self.of.constant(0.0)
    }

    /// Whether it is a number.
    pub fn is_number(self) -> Condition<'r> {
        self.live(Relation::Equal, self)
    }

    /// The distance of the point from the origin.
    #[must_use]
    pub fn hypot(self, other: Self) -> Self {
        self.of.number(Op::Binary(Binary::Hypot, self.id, other.id))
    }

    /// The angle of the point `(x, self)`, from -pi to pi. Which side of its cut the point is on is held.
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        let below = self.compare(Relation::Less, 0.0);
        let held = self.of.hold("atan2", below.id, |_| vec![self]);
        let held = Condition { of: self.of, id: held };
        let angle = self.of.number(Op::Binary(Binary::Atan2, self.id, x.id));
        let left = x.compare(Relation::Less, 0.0);
        let turn = self.of.constant(std::f64::consts::TAU);
        // Between major steps the angle goes on beyond the cut instead of jumping.
        let risen = held.and(!below).and(left);
        let fallen = (!held).and(below).and(left);
        risen.select(angle - turn, fallen.select(angle + turn, angle))
    }

    /// The angle of the point `(x, self)`, from -pi to pi, without an event at its cut.
    #[must_use]
    pub fn angle(self, x: Self) -> Self {
        self.of.number(Op::Binary(Binary::Atan2, self.id, x.id))
    }

    /// -1, 0 or 1, held between major steps.
    #[must_use]
    pub fn sign(self) -> Self {
        let sign = self.of.number(Op::Unary(Unary::Sign, self.id));
        self.held("sign", sign, |_| vec![self])
    }

    /// The next whole number below, held between major steps.
    #[must_use]
    pub fn floor(self) -> Self {
        self.rounded("floor", Unary::Floor, 0.0, 1.0)
    }

    /// The next whole number above, held between major steps.
    #[must_use]
    pub fn ceil(self) -> Self {
        self.rounded("ceil", Unary::Ceil, -1.0, 0.0)
    }

    /// The nearest whole number, halves away from zero, held between major steps.
    #[must_use]
    pub fn round(self) -> Self {
        self.rounded("round", Unary::Round, -0.5, 0.5)
    }

    /// A whole number that is right while the value is from `below` to `above` away from it.
    fn rounded(self, name: &'static str, function: Unary, below: f64, above: f64) -> Self {
        let whole = self.of.number(Op::Unary(function, self.id));
        self.held(name, whole, |held| vec![self - (held + below), self - (held + above)])
    }

    fn held(self, name: &'static str, value: Self, guards: impl FnOnce(Self) -> Vec<Self>) -> Self {
        Value { of: self.of, id: self.of.hold(name, value.id, guards) }
    }

    /// The remainder with the sign of the divisor, `a - b floor(a / b)`. A division by zero ends the law.
    #[must_use]
    pub fn modulo(self, divisor: Self) -> Self {
        self - divisor * (self / divisor).floor()
    }

    /// Compares without an event; for conditions of which both sides agree where they meet.
    pub fn live(self, relation: Relation, other: Self) -> Condition<'r> {
        self.of.truth(Op::Compare(relation, self.id, other.id))
    }

    /// Compares; the answer is held between major steps and may change where both are equal.
    pub fn is(self, relation: Relation, other: Self) -> Condition<'r> {
        let live = self.live(relation, other);
        Condition { of: self.of, id: self.of.hold("compare", live.id, |_| vec![self - other]) }
    }
}

impl<'r> Condition<'r> {
    /// The number of the truth value in the program.
    pub fn id(self) -> Id {
        self.id
    }

    /// A truth value of the law, given as 0 or 1.
    pub fn of(value: Value<'r>) -> Self {
        value.is_nonzero()
    }

    /// 1 where it is true, else 0.
    pub fn number(self) -> Value<'r> {
        Value { of: self.of, id: self.id }
    }

    /// Whether both are true.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        self.of.truth(Op::And(self.id, other.id))
    }

    /// Whether one is true.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        self.of.truth(Op::Or(self.id, other.id))
    }

    /// Whether one is true and the other is not.
    #[must_use]
    pub fn xor(self, other: Self) -> Self {
        self.of.truth(Op::Compare(Relation::NotEqual, self.id, other.id))
    }

    /// The first where it is true, else the second.
    #[must_use]
    pub fn select(self, first: Value<'r>, second: Value<'r>) -> Value<'r> {
        self.of.number(Op::Select(self.id, first.id, second.id))
    }

    /// The same of truth values.
    #[must_use]
    pub fn choose(self, first: Self, second: Self) -> Self {
        self.of.truth(Op::Select(self.id, first.id, second.id))
    }
}

impl<'r> Value<'r> {
    /// A truth value that is given as 0 or 1.
    pub fn is_true(self) -> Condition<'r> {
        self.is_nonzero()
    }

    fn is_nonzero(self) -> Condition<'r> {
        self.compare(Relation::NotEqual, 0.0)
    }
}

impl<'r> std::ops::Not for Condition<'r> {
    type Output = Condition<'r>;
    fn not(self) -> Condition<'r> {
        self.of.truth(Op::Not(self.id))
    }
}
