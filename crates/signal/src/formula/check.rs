//! Whether the parts of a formula fit each other: kinds and dimensions.

use super::{Formula, Function, NodeKind, Operator};
use crate::arithmetic::mismatch;
use crate::{Dimension, ExprError};

impl Formula {
    /// Finds which names stand for true or false, and refuses numbers in their places and the reverse.
    pub(super) fn settle_kinds(&mut self) -> Result<(), ExprError> {
        // What each node is wanted as, from where it is used; `if` hands on what it is wanted as itself.
        let n = self.nodes.len();
        let mut wanted: Vec<Option<bool>> = vec![None; n];
        for at in (0..n).rev() {
            let (operands, truth) = match &self.nodes[at].kind {
                NodeKind::Number(_) | NodeKind::Truth(_) | NodeKind::Name(_) => (Vec::new(), None),
                NodeKind::Negate(a) | NodeKind::Scale(a, _) => (vec![*a], Some(false)),
                NodeKind::Binary(_, a, b) | NodeKind::Compare(_, a, b) => (vec![*a, *b], Some(false)),
                NodeKind::Call(Function::And | Function::Or | Function::Not, all) => {
                    (all.clone(), Some(true))
                }
                NodeKind::Call(Function::If, all) => {
                    wanted[all[0]] = Some(true);
                    (all[1..].to_vec(), wanted[at])
                }
                NodeKind::Call(_, all) => (all.clone(), Some(false)),
            };
            operands.into_iter().for_each(|operand| wanted[operand] = truth);
        }
        // The same name in another place says what it is, where its own place does not.
        let mut known: Vec<(String, bool)> = Vec::new();
        for (node, wanted) in self.nodes.iter().zip(&wanted) {
            let (NodeKind::Name(name), Some(truth)) = (&node.kind, *wanted) else { continue };
            match known.iter().find(|(other, _)| other == name) {
                Some((_, other)) if *other != truth => {
                    let message = format!("`{name}` is used as a number and as true or false");
                    return Err(ExprError::new(node.span.clone(), message).help(format!(
                        "write a comparison, such as {name} > 0, where a condition is needed"
                    )));
                }
                Some(_) => {}
                None => known.push((name.clone(), truth)),
            }
        }
        for at in 0..n {
            let truth = match &self.nodes[at].kind {
                NodeKind::Name(name) => {
                    let found = known.iter().find(|(other, _)| other == name);
                    found.is_some_and(|(_, truth)| *truth)
                }
                NodeKind::Call(Function::If, all) => {
                    let (first, second) = (self.nodes[all[1]].is_truth, self.nodes[all[2]].is_truth);
                    if first != second {
                        let message = "one branch of `if` is a number, the other one is true or false";
                        return Err(ExprError::new(self.nodes[at].span.clone(), message)
                            .help("write 1 and 0 instead of true and false, or compare the number"));
                    }
                    first
                }
                _ => self.nodes[at].is_truth,
            };
            self.nodes[at].is_truth = truth;
            let Some(wanted) = wanted[at].filter(|wanted| *wanted != truth) else { continue };
            let (span, text) = (self.nodes[at].span.clone(), self.text_of(at));
            return Err(if wanted {
                ExprError::new(span, format!("`{text}` is a number where a condition is needed"))
                    .help(format!("compare it, as in {text} > 0"))
            } else {
                ExprError::new(span, format!("`{text}` is true or false where a number is needed"))
                    .help(format!("write if({text}, 1, 0)"))
            });
        }
        Ok(())
    }

    /// The dimension of the value, from those of the names; `None` where it is not known yet. Numbers without unit have
    /// none, as in expressions, but zero fits every unit. `constant` is the value of a node that never changes, which
    /// exponents need.
    ///
    /// # Errors
    /// Quantities that do not fit each other or a function, with the bytes of the text.
    pub fn dimension(
        &self,
        of: &dyn Fn(&str) -> Option<Dimension>,
        constant: &dyn Fn(usize) -> Option<f64>,
    ) -> Result<Option<Dimension>, ExprError> {
        let mut known: Vec<Option<Dimension>> = Vec::with_capacity(self.nodes.len());
        for at in 0..self.nodes.len() {
            let dimension = self.dimension_at(at, &known, of, constant)?;
            if dimension.is_some_and(Dimension::is_saturated) {
                let span = self.nodes[at].span.clone();
                return Err(ExprError::new(span, "the exponents of the unit are too large"));
            }
            known.push(dimension);
        }
        Ok(known.last().copied().flatten())
    }

    fn dimension_at(
        &self,
        at: usize,
        known: &[Option<Dimension>],
        of: &dyn Fn(&str) -> Option<Dimension>,
        constant: &dyn Fn(usize) -> Option<f64>,
    ) -> Result<Option<Dimension>, ExprError> {
        let node = &self.nodes[at];
        if node.is_truth && !matches!(node.kind, NodeKind::Compare(..)) {
            return Ok(Some(Dimension::NONE));
        }
        Ok(match &node.kind {
            NodeKind::Number(quantity) if quantity.value == 0.0 && quantity.dimension == Dimension::NONE => {
                Some(Dimension::OPEN)
            }
            NodeKind::Number(quantity) => Some(quantity.dimension),
            NodeKind::Truth(_) => Some(Dimension::NONE),
            NodeKind::Name(name) => of(name),
            NodeKind::Negate(a) => known[*a],
            NodeKind::Scale(a, unit) => known[*a].map(|dimension| dimension.times(unit.dimension)),
            NodeKind::Binary(Operator::Add, a, b) => self.common("add", at, &[*a, *b], known)?,
            NodeKind::Binary(Operator::Subtract, a, b) => self.common("subtract", at, &[*a, *b], known)?,
            NodeKind::Binary(Operator::Multiply, a, b) => known[*a].zip(known[*b]).map(|(a, b)| a.times(b)),
            NodeKind::Binary(Operator::Divide, a, b) => known[*a].zip(known[*b]).map(|(a, b)| a.over(b)),
            NodeKind::Binary(Operator::Power, a, b) => self.power(*a, *b, known, constant)?,
            NodeKind::Compare(_, a, b) => {
                self.common("compare", at, &[*a, *b], known)?;
                Some(Dimension::NONE)
            }
            NodeKind::Call(function, all) => self.function(*function, all, at, known)?,
        })
    }

    /// What numbers are in that are added or compared.
    fn common(
        &self,
        verb: &str,
        at: usize,
        operands: &[usize],
        known: &[Option<Dimension>],
    ) -> Result<Option<Dimension>, ExprError> {
        let mut common: Option<Dimension> = None;
        for dimension in operands.iter().filter_map(|operand| known[*operand]) {
            common = Some(match common {
                None => dimension,
                // A plain number added to an angle makes an angle.
                Some(first) if first == Dimension::NONE && first.compatible(dimension) => dimension,
                Some(first) => first
                    .meet(dimension)
                    .ok_or_else(|| mismatch(verb, first, dimension, self.nodes[at].span.clone()))?,
            });
        }
        Ok(common)
    }

    fn power(
        &self,
        base: usize,
        exponent: usize,
        known: &[Option<Dimension>],
        constant: &dyn Fn(usize) -> Option<f64>,
    ) -> Result<Option<Dimension>, ExprError> {
        let span = || self.nodes[exponent].span.clone();
        let unit = known[exponent].filter(|dimension| !dimension.is_open() && !dimension.is_none());
        if let Some(dimension) = unit {
            let message = format!("an exponent is a plain number, not one in {dimension}");
            let help = "a unit belongs to the number before it; write (2^3) m";
            return Err(ExprError::new(span(), message).help(help));
        }
        let Some(dimension) = known[base] else { return Ok(None) };
        if dimension.is_none() && !dimension.is_open() {
            return Ok(Some(Dimension::NONE));
        }
        let n = constant(exponent);
        if let Some(n) = n.filter(|n| n.fract() == 0.0 && n.abs() <= f64::from(i8::MAX)) {
            return Ok(Some(dimension.power(n as i8)));
        }
        if dimension.is_open() {
            return Ok(Some(Dimension::OPEN));
        }
        let error = match n {
            Some(n) => {
                let message = format!("a quantity in {dimension} has whole powers only, not {n}");
                ExprError::new(span(), message)
            }
            None => ExprError::new(
                span(),
                format!("the exponent of a quantity in {dimension} is a number that does not change"),
            ),
        };
        Err(if n == Some(0.5) { error.help("use sqrt()") } else { error.help("divide by a unit first") })
    }

    fn function(
        &self,
        function: Function,
        all: &[usize],
        at: usize,
        known: &[Option<Dimension>],
    ) -> Result<Option<Dimension>, ExprError> {
        use Function as F;
        let first = known[all[0]];
        Ok(match function {
            F::Abs => first,
            F::Sign | F::And | F::Or | F::Not => Some(Dimension::NONE),
            F::Sqrt => match first {
                None => None,
                Some(dimension) => Some(dimension.root(2).ok_or_else(|| {
                    let message = format!("the square root of {dimension} is not a unit");
                    ExprError::new(self.nodes[at].span.clone(), message)
                        .help("divide by a reference value first, so that a plain number is left")
                })?),
            },
            F::Min | F::Max => self.common("compare", at, all, known)?,
            F::Hypot => self.common("add", at, all, known)?,
            F::Mod => {
                // The remainder is in the unit of what is divided.
                self.common("divide with remainder", at, all, known)?
            }
            F::If => self.common("choose between", at, &all[1..], known)?,
            F::Atan2 => {
                self.common("compare", at, all, known)?;
                Some(Dimension::RADIAN)
            }
            _ => {
                if let Some(dimension) =
                    first.filter(|dimension| !dimension.is_open() && !dimension.is_none())
                {
                    let name = function.name();
                    let message = format!("`{name}` takes a plain number or an angle, not {dimension}");
                    let help = format!("divide by a unit first, as in {name}(x / (1 {dimension}))");
                    return Err(ExprError::new(self.nodes[all[0]].span.clone(), message).help(help));
                }
                match function {
                    F::Asin | F::Acos | F::Atan => Some(Dimension::RADIAN),
                    F::Floor | F::Ceil | F::Round => first,
                    _ => Some(Dimension::NONE),
                }
            }
        })
    }
}
