//! From a formula to the program of a law.

use blocksim_law::{Condition, Recorder, Relation, Value};
use blocksim_signal::{Comparison, Formula, Function, NodeKind, Operator};

use super::LawParameters;

/// What a part of a formula is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Part<'r> {
    /// A number.
    Number(Value<'r>),
    /// True or false.
    Truth(Condition<'r>),
}

/// Greatest exponent that is computed by multiplication.
const MOST_FACTORS: f64 = 64.0;

/// Records a formula that begins at byte `begin` of a text. `name` is what stands for a name, `constant` the value of a node that
/// never changes.
///
/// Every comparison is a mode, and so is what jumps. A branch of `if`, and what stands behind the first operand of `and` or `or`,
/// need have a value only where it is asked for.
pub(crate) fn record<'r>(
    formula: &Formula,
    recorder: &'r Recorder,
    name: &dyn Fn(&str) -> Option<Part<'r>>,
    constant: &dyn Fn(usize) -> Option<f64>,
    begin: usize,
) -> Part<'r> {
    let n = formula.nodes().len();
    let mut recording = Recording { recorder, parts: Vec::with_capacity(n) };
    let (enter, leave) = branches(formula);
    for (at, node) in formula.nodes().iter().enumerate() {
        for (condition, holds) in &enter[at] {
            let condition = recording.truth(*condition);
            recorder.enter(if *holds { condition } else { !condition });
        }
        recorder.at(begin + node.span.start..begin + node.span.end);
        let part = recording.node(&node.kind, name, constant);
        recording.parts.push(part);
        (0..leave[at]).for_each(|_| recorder.leave());
    }
    recording.number_of_last()
}

/// Before which nodes a branch begins, with its condition and whether that must hold, and behind which ones how many end.
fn branches(formula: &Formula) -> (Vec<Vec<(usize, bool)>>, Vec<usize>) {
    let n = formula.nodes().len();
    let (mut enter, mut leave) = (vec![Vec::new(); n], vec![0; n]);
    for node in formula.nodes() {
        match &node.kind {
            NodeKind::Call(Function::If, all) => {
                let [condition, first, second] = all[..] else { continue };
                enter[condition + 1].push((condition, true));
                leave[first] += 1;
                enter[first + 1].push((condition, false));
                leave[second] += 1;
            }
            NodeKind::Call(function @ (Function::And | Function::Or), all) => {
                for pair in all.windows(2) {
                    enter[pair[0] + 1].push((pair[0], *function == Function::And));
                }
                if let Some(last) = all.last() {
                    leave[*last] += all.len() - 1;
                }
            }
            _ => {}
        }
    }
    // What is around begins first: it is the later one in the list of nodes.
    enter.iter_mut().for_each(|branches| branches.reverse());
    (enter, leave)
}

struct Recording<'r> {
    recorder: &'r Recorder,
    parts: Vec<Part<'r>>,
}

impl<'r> Recording<'r> {
    /// A number. The kinds of all parts were checked when the formula was read.
    fn number(&self, node: usize) -> Value<'r> {
        match self.parts[node] {
            Part::Number(value) => value,
            Part::Truth(condition) => {
                condition.select(self.recorder.constant(1.0), self.recorder.constant(0.0))
            }
        }
    }

    fn truth(&self, node: usize) -> Condition<'r> {
        match self.parts[node] {
            Part::Truth(condition) => condition,
            Part::Number(value) => Condition::of(value),
        }
    }

    fn number_of_last(&self) -> Part<'r> {
        self.parts.last().copied().unwrap_or_else(|| Part::Number(self.recorder.constant(f64::NAN)))
    }

    fn node(
        &self,
        kind: &NodeKind,
        name: &dyn Fn(&str) -> Option<Part<'r>>,
        constant: &dyn Fn(usize) -> Option<f64>,
    ) -> Part<'r> {
        let number = |node: &usize| self.number(*node);
        Part::Number(match kind {
            NodeKind::Number(quantity) => self.recorder.constant(quantity.value),
            NodeKind::Truth(value) => return Part::Truth(self.recorder.fixed(*value)),
            NodeKind::Name(word) => match name(word) {
                Some(part) => return part,
                None => self.recorder.constant(f64::NAN),
            },
            NodeKind::Negate(a) => -number(a),
            NodeKind::Scale(a, unit) => number(a) * unit.value,
            NodeKind::Binary(operator, a, b) => {
                let (left, right) = (number(a), number(b));
                match operator {
                    Operator::Add => left + right,
                    Operator::Subtract => left - right,
                    Operator::Multiply => left * right,
                    Operator::Divide => left / right,
                    Operator::Power => match constant(*b) {
                        Some(n) if n.fract() == 0.0 && n.abs() <= MOST_FACTORS => left.powi(n as i32),
                        _ => left.pow(right),
                    },
                }
            }
            NodeKind::Compare(comparison, a, b) => {
                let relation = match comparison {
                    Comparison::Less => Relation::Less,
                    Comparison::LessEqual => Relation::LessEqual,
                    Comparison::Greater => Relation::Greater,
                    Comparison::GreaterEqual => Relation::GreaterEqual,
                    Comparison::Equal => Relation::Equal,
                    Comparison::NotEqual => Relation::NotEqual,
                };
                return Part::Truth(number(a).is(relation, number(b)));
            }
            NodeKind::Call(function, all) => return self.call(*function, all),
        })
    }

    fn call(&self, function: Function, all: &[usize]) -> Part<'r> {
        use Function as F;
        let (first, last) = (all[0], all[all.len() - 1]);
        let truths = || all.iter().map(|node| self.truth(*node));
        let numbers = || all.iter().map(|node| self.number(*node));
        let none = || self.recorder.constant(f64::NAN);
        let one = || self.number(first);
        Part::Number(match function {
            F::And | F::Or => {
                let and = function == F::And;
                let all = truths().reduce(|a, b| if and { a.and(b) } else { a.or(b) });
                return Part::Truth(all.unwrap_or_else(|| self.recorder.fixed(and)));
            }
            F::Not => return Part::Truth(!self.truth(first)),
            F::If => {
                let condition = self.truth(first);
                return match (self.parts[all[1]], self.parts[last]) {
                    (Part::Truth(a), Part::Truth(b)) => Part::Truth(condition.choose(a, b)),
                    _ => Part::Number(condition.select(self.number(all[1]), self.number(last))),
                };
            }
            F::Min => numbers().reduce(Value::min).unwrap_or_else(none),
            F::Max => numbers().reduce(Value::max).unwrap_or_else(none),
            F::Atan2 => one().atan2(self.number(last)),
            F::Hypot => one().hypot(self.number(last)),
            F::Mod => one().modulo(self.number(last)),
            F::Sqrt => one().sqrt(),
            F::Abs => one().abs(),
            F::Sign => one().sign(),
            F::Sin => one().sin(),
            F::Cos => one().cos(),
            F::Tan => one().tan(),
            F::Asin => one().asin(),
            F::Acos => one().acos(),
            F::Atan => one().atan(),
            F::Sinh => one().sinh(),
            F::Cosh => one().cosh(),
            F::Tanh => one().tanh(),
            F::Exp => one().exp(),
            F::Ln => one().ln(),
            F::Log10 => one().log10(),
            F::Floor => one().floor(),
            F::Ceil => one().ceil(),
            F::Round => one().round(),
        })
    }
}

/// The values of the nodes that never change: what exponents may be.
pub(crate) fn constants(formula: &Formula, parameters: LawParameters) -> Vec<Option<f64>> {
    let mut known: Vec<Option<f64>> = Vec::with_capacity(formula.nodes().len());
    for node in formula.nodes() {
        known.push(match &node.kind {
            NodeKind::Number(quantity) => Some(quantity.value),
            NodeKind::Name(name) => parameters.number(name),
            NodeKind::Negate(a) => known[*a].map(|a| -a),
            NodeKind::Scale(a, unit) => known[*a].map(|a| a * unit.value),
            NodeKind::Binary(operator, a, b) => known[*a].zip(known[*b]).map(|(a, b)| match operator {
                Operator::Add => a + b,
                Operator::Subtract => a - b,
                Operator::Multiply => a * b,
                Operator::Divide => a / b,
                Operator::Power => a.powf(b),
            }),
            NodeKind::Truth(_) | NodeKind::Compare(..) | NodeKind::Call(..) => None,
        });
    }
    known
}
