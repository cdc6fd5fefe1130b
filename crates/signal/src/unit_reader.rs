//! Reads units from tokens, alone or behind a number of an expression.

use crate::lexer::{Lexeme, Token};
use crate::unit_table::{self, Factor};
use crate::{
    ExprError,
    unit_hint::{hint, remedy},
};
use std::ops::Range;

/// Parentheses within parentheses that a unit may have.
const MAX_DEPTH: usize = 200;

/// Reads units from tokens, alone or behind a number of an expression.
///
/// ```text
/// unit   = part { ("*" | "/") part }
/// part   = symbol [ "^" ["-"] whole ] | "1" | "(" unit ")"
/// ```
pub(crate) struct UnitReader<'a> {
    lexemes: &'a [Lexeme<'a>],
    /// The next token.
    pub at: usize,
    /// Whether a word means something else, so that it ends a unit behind `*` or `/`.
    is_taken: &'a dyn Fn(&str) -> bool,
    depth: usize,
}

impl<'a> UnitReader<'a> {
    pub fn new(lexemes: &'a [Lexeme<'a>], at: usize, is_taken: &'a dyn Fn(&str) -> bool) -> Self {
        Self { lexemes, at, is_taken, depth: 0 }
    }

    /// A unit that must reach to `end`, which is consumed unless it is the end of the text.
    pub fn whole(&mut self, end: Token) -> Result<Factor, ExprError> {
        let first = self.at;
        let mut product = self.part(true)?;
        while let Some(divide) = self.operator() {
            self.at += 1;
            let part = self.part(true)?;
            product = join(product, part, divide, self.span_from(first))?;
        }
        if self.token() != end {
            let error = ExprError::new(self.span(), format!("expected {} in a unit", spell(end)));
            return Err(match self.token() {
                Token::Word(_) => error.help("multiply units by *, as in N*m"),
                Token::Sign('^') => error.help("a unit takes one exponent"),
                _ => error,
            });
        }
        if end != Token::End {
            self.at += 1;
        }
        Ok(product)
    }

    /// A unit behind a number: the first symbol is always a unit; behind `*` or `/` the unit goes on only with a
    /// known symbol that is not taken (written without spaces it never is), or with parentheses that hold nothing
    /// else.
    pub fn greedy(&mut self) -> Result<Factor, ExprError> {
        let first = self.at;
        let mut product =
            if self.token() == Token::Number(1.0) { self.part(false)? } else { self.part(true)? };
        let mut plain = first + 1 == self.at && self.lexemes[first].token == Token::Number(1.0);
        while let Some(divide) = self.operator() {
            let before = self.at;
            self.at += 1;
            match self.part(plain) {
                Ok(part) => product = join(product, part, divide, self.span_from(first))?,
                Err(error) if plain => return Err(error),
                Err(_) => {
                    self.at = before;
                    break;
                }
            }
            plain = false;
        }
        if self.token() == Token::Sign('^') {
            return Err(
                ExprError::new(self.span(), "a unit takes one exponent").help("group with parentheses")
            );
        }
        Ok(product)
    }

    /// One symbol with its exponent, `1`, or a unit in parentheses. `certain` says that nothing but a unit can stand
    /// here, so that no word is taken.
    fn part(&mut self, certain: bool) -> Result<Factor, ExprError> {
        let span = self.span();
        let factor = match self.token() {
            // Behind an operator of an expression, `1` may begin the next operand: 5 m / 1 s.
            Token::Number(1.0) if certain || self.lexemes[self.at + 1].token == Token::Sign('/') => {
                self.at += 1;
                return Ok(Factor::ONE);
            }
            Token::Word(symbol) => {
                let is_path = matches!(self.lexemes[self.at + 1].token, Token::Sign('.' | '('));
                if !certain && (is_path || (!self.is_tight() && (self.is_taken)(symbol))) {
                    return Err(ExprError::new(span, "not a unit"));
                }
                self.at += 1;
                unit_table::find(symbol).ok_or_else(|| unknown(symbol, span.clone()))?
            }
            Token::Sign('(') if self.depth < MAX_DEPTH => {
                self.at += 1;
                self.depth += 1;
                let inner = self.group(certain)?;
                self.depth -= 1;
                inner
            }
            Token::Sign('(') => return Err(ExprError::new(span, "parentheses are nested too deeply")),
            _ => return Err(ExprError::new(span, "expected a unit")),
        };
        self.exponent(factor, span)
    }

    /// Whether the token follows its operator, and the operator what it follows, without space: `kg*m^2` is one
    /// unit even where a parameter is called `m`.
    fn is_tight(&self) -> bool {
        let touches = |at: usize| at > 0 && self.lexemes[at - 1].span.end == self.lexemes[at].span.start;
        touches(self.at) && touches(self.at - 1)
    }

    fn group(&mut self, certain: bool) -> Result<Factor, ExprError> {
        let first = self.at;
        let mut product = self.part(certain)?;
        while let Some(divide) = self.operator() {
            self.at += 1;
            let part = self.part(certain)?;
            product = join(product, part, divide, self.span_from(first))?;
        }
        if self.token() != Token::Sign(')') {
            return Err(ExprError::new(self.span(), "expected `)` in a unit"));
        }
        self.at += 1;
        Ok(product)
    }

    fn exponent(&mut self, factor: Factor, span: Range<usize>) -> Result<Factor, ExprError> {
        if self.token() != Token::Sign('^') {
            return Ok(factor);
        }
        self.at += 1;
        let negative = self.token() == Token::Sign('-');
        self.at += usize::from(negative);
        let limit = f64::from(i8::MAX);
        let n = match self.token() {
            Token::Number(n) if n.fract() == 0.0 && n < limit => n as i8,
            _ => {
                let error = ExprError::new(self.span(), "the exponent of a unit is a whole number");
                return Err(error.help("put the quantity in parentheses to raise it to another power"));
            }
        };
        self.at += 1;
        let power = factor.power(if negative { -n } else { n });
        sound(factor, power, span.start..self.lexemes[self.at - 1].span.end)
    }

    fn operator(&self) -> Option<bool> {
        match self.token() {
            Token::Sign('*') => Some(false),
            Token::Sign('/') => Some(true),
            _ => None,
        }
    }

    fn token(&self) -> Token<'a> {
        self.lexemes[self.at].token
    }

    fn span(&self) -> Range<usize> {
        self.lexemes[self.at].span.clone()
    }

    fn span_from(&self, first: usize) -> Range<usize> {
        self.lexemes[first].span.start..self.lexemes[self.at - 1].span.end
    }
}

fn join(product: Factor, part: Factor, divide: bool, span: Range<usize>) -> Result<Factor, ExprError> {
    let joined = product.times(if divide { part.power(-1) } else { part });
    sound(if product.offset != 0.0 { product } else { part }, joined, span)
}

/// Refuses products and powers of degC and scales or exponents that leave their range.
fn sound(part: Factor, product: Factor, span: Range<usize>) -> Result<Factor, ExprError> {
    if part.offset != 0.0 {
        return Err(
            ExprError::new(span, "degC cannot be multiplied").help("use K for differences of temperature")
        );
    }
    let scale = product.scale();
    if !scale.is_normal() || product.dimension.is_saturated() {
        return Err(ExprError::new(span, "the exponents of the unit are too large"));
    }
    Ok(product)
}

fn spell(token: Token) -> &'static str {
    match token {
        Token::Sign(']') => "`]`",
        _ => "`*`, `/` or the end",
    }
}

fn unknown(symbol: &str, span: Range<usize>) -> ExprError {
    ExprError::new(span, format!("unknown unit `{symbol}`")).help(hint(symbol)).remedy(remedy(symbol))
}
