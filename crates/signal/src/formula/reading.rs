//! From the reader of expressions to the nodes of a formula.

use super::function::FUNCTIONS;
use super::{Comparison, Function, Node, NodeKind, Operator};
use crate::arithmetic::Operand;
use crate::expression::{Meaning, Notes};
use crate::unit_table::Factor;
use crate::{ExprError, Lookup, Quantity, Value, arithmetic, closest, surely};
use std::ops::Range;

/// The nodes so far.
#[derive(Debug, Default)]
pub(super) struct Reading {
    pub nodes: Vec<Node>,
}

impl Reading {
    /// Adds a node; the kind of a name is settled when all is read.
    fn push(&mut self, kind: NodeKind, span: Range<usize>) -> usize {
        let is_truth = matches!(
            kind,
            NodeKind::Truth(_)
                | NodeKind::Compare(..)
                | NodeKind::Call(Function::And | Function::Or | Function::Not, _)
        );
        self.nodes.push(Node { kind, span, is_truth });
        self.nodes.len() - 1
    }
}

fn no_list(span: Range<usize>) -> ExprError {
    ExprError::new(span, "a law computes with numbers; lists, items and members have no place in it")
        .help("give what is needed as an input or as a parameter of its own")
}

impl Meaning for Reading {
    type Value = usize;
    const COMPARES: bool = true;

    fn quantity(&mut self, quantity: Quantity, span: Range<usize>) -> Result<usize, ExprError> {
        arithmetic::sound(quantity, span.clone())?;
        Ok(self.push(NodeKind::Number(quantity), span))
    }

    fn known(&mut self, value: Value, span: Range<usize>) -> Result<usize, ExprError> {
        match value {
            Value::Bool(truth) => Ok(self.push(NodeKind::Truth(truth), span)),
            value => match value.as_number() {
                Some(quantity) => self.quantity(quantity, span),
                None => Err(no_list(span)),
            },
        }
    }

    fn name(
        &mut self,
        word: &str,
        _looked_up: Lookup,
        span: Range<usize>,
    ) -> Result<Option<usize>, ExprError> {
        Ok(Some(self.push(NodeKind::Name(word.to_owned()), span)))
    }

    fn list(&mut self, _items: Vec<Operand<usize>>, span: Range<usize>) -> Result<usize, ExprError> {
        Err(no_list(span))
    }

    fn member(&mut self, from: Operand<usize>, _name: &str, span: Range<usize>) -> Result<usize, ExprError> {
        Err(no_list(from.span.start..span.end))
    }

    fn item(&mut self, from: Operand<usize>, index: &Operand<usize>) -> Result<usize, ExprError> {
        Err(no_list(from.span.start..index.span.end))
    }

    fn binary(
        &mut self,
        sign: char,
        left: &Operand<usize>,
        right: &Operand<usize>,
    ) -> Result<usize, ExprError> {
        let span = left.span.start..right.span.end;
        let compares = |comparison| NodeKind::Compare(comparison, left.value, right.value);
        let kind = match sign {
            '+' => NodeKind::Binary(Operator::Add, left.value, right.value),
            '-' => NodeKind::Binary(Operator::Subtract, left.value, right.value),
            '*' => NodeKind::Binary(Operator::Multiply, left.value, right.value),
            '/' => NodeKind::Binary(Operator::Divide, left.value, right.value),
            '<' => compares(Comparison::Less),
            '≤' => compares(Comparison::LessEqual),
            '>' => compares(Comparison::Greater),
            '≥' => compares(Comparison::GreaterEqual),
            '=' => compares(Comparison::Equal),
            '≠' => compares(Comparison::NotEqual),
            _ => NodeKind::Binary(Operator::Power, left.value, right.value),
        };
        Ok(self.push(kind, span))
    }

    fn negated(&mut self, operand: &Operand<usize>, span: Range<usize>) -> Result<usize, ExprError> {
        Ok(self.push(NodeKind::Negate(operand.value), span))
    }

    fn plus(&mut self, _operand: &Operand<usize>) -> Result<(), ExprError> {
        Ok(())
    }

    fn in_unit(
        &mut self,
        operand: &Operand<usize>,
        factor: Factor,
        span: Range<usize>,
    ) -> Result<usize, ExprError> {
        let unit = Quantity::new(factor.scale(), factor.dimension);
        Ok(self.push(NodeKind::Scale(operand.value, unit), span))
    }

    fn call(
        &mut self,
        word: &str,
        named: Range<usize>,
        arguments: &[Operand<usize>],
        span: Range<usize>,
    ) -> Result<usize, ExprError> {
        let Some((function, least, most)) = Function::find(word) else {
            return Err(unknown(word, named));
        };
        let count = arguments.len();
        if count < least || count > most {
            let wanted = match (least, most) {
                (1, 1) => "one argument".to_owned(),
                (least, most) if least == most => format!("{least} arguments"),
                (1, _) => "at least one argument".to_owned(),
                (least, _) => format!("at least {least} arguments"),
            };
            let error = ExprError::new(span, format!("`{word}` takes {wanted}, not {count}"));
            return Err(match (word, count) {
                ("if", _) => error.help("write if(condition, value, other_value)"),
                (_, 2) => error.help("a decimal number is written with a point"),
                _ => error,
            });
        }
        let arguments = arguments.iter().map(|argument| argument.value).collect();
        Ok(self.push(NodeKind::Call(function, arguments), span))
    }

    fn note(&self, _notes: &mut Notes, _text: &str, _start: usize, _value: &usize) {}
}

fn unknown(word: &str, named: Range<usize>) -> ExprError {
    let known = FUNCTIONS.map(|(known, ..)| known);
    let error = ExprError::new(named, format!("unknown function `{word}`"))
        .remedy(surely(word, known).map(str::to_owned));
    match (word, closest(word, known)) {
        ("angular", _) => error.help("write `* (2*pi) rad/cycle` to make rad/s of Hz"),
        ("cycles", _) => error.help("write `* (0.5/pi) cycle/rad` to make Hz of rad/s"),
        ("log", _) => error.help("write `ln` for the natural logarithm, `log10` for that to base 10"),
        ("pow", _) => error.help("a power is written a^b"),
        (_, Some(near)) => error.help(format!("did you mean `{near}`?")),
        _ => error.help(format!("the functions are: {}", known.join(", "))),
    }
}
