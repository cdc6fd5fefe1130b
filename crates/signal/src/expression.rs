//! Expressions: a Pratt parser that evaluates as it reads.

mod meaning;
mod mistakes;
mod notes;

use crate::arithmetic::Operand;
use crate::lexer::{Lexeme, Token, lex};
use crate::unit::to_si;
use crate::unit_reader::UnitReader;
use crate::unit_table::{self, DECIBEL, Factor};
use crate::{ExprError, Lookup, Part, Quantity, Scope, Value};
use meaning::Evaluation;
use std::{f64::consts::PI, ops::Range};

pub(crate) use meaning::Meaning;
pub use notes::Noted;
pub(crate) use notes::Notes;

/// The value of an expression: numbers with units, `+ - * / ^`, parentheses, names of the scope, members
/// (`robot.mass`), items (`list[0]`), lists (`[a, b]`), functions, `pi`, `true`, `false`.
///
/// * `^` binds tighter than a minus sign and to the right: `-2^2` is -4, `2^3^2` is 512.
/// * A unit directly behind a number or a closing parenthesis is read greedily and binds tightest; a name of the same
///   spelling never wins: `2 m` is two metres, `2 * m` uses the name, `1/2 s` is 1/(2 s).
/// * Behind `*` or `/` within such a unit, a word belongs to the unit only if it is a known unit and the scope has no
///   such name; otherwise the sign is an operator. Parentheses there belong to the unit if all they hold does. Within
///   square brackets, `9.81 [m/s^2]`, every word is a unit.
/// * `degC` has an offset and is read only in whole literals: `"20 degC"`, `[-5 degC, 40 degC]`.
/// * `dB` is the ratio of two amplitudes, `"-3 dB"` is 0.708, and read only in whole literals, too.
/// * A frequency in Hz counts cycles and does not mix with rad/s; `angular` and `cycles` convert.
///
/// Errors carry the bytes of the text they are about. Nesting is limited to 200, the text to 64 KiB.
pub fn evaluate(text: &str, scope: &dyn Scope) -> Result<Value, ExprError> {
    evaluate_noted(text, scope).map(|noted| noted.value)
}

/// As [`evaluate`], with the units and names that stand in the expression.
///
/// # Errors
/// As of [`evaluate`].
pub fn evaluate_noted(text: &str, scope: &dyn Scope) -> Result<Noted, ExprError> {
    let (value, notes) = read(text, scope, &mut Evaluation)?;
    Ok(notes.with(value))
}

/// Reads a text; what its parts are worth, `meaning` says.
pub(crate) fn read<M: Meaning>(
    text: &str,
    scope: &dyn Scope,
    meaning: &mut M,
) -> Result<(M::Value, Notes), ExprError> {
    let lexemes = lex(text, M::COMPARES)?;
    if lexemes.len() == 1 {
        return Err(ExprError::new(0..text.len(), "empty expression").help("write a number, such as 0"));
    }
    let mut parser =
        Parser { text, lexemes: &lexemes, at: 0, scope, meaning, depth: 0, notes: Notes::default() };
    let result = parser.expression(0)?;
    match parser.token() {
        Token::End => Ok((result.value, parser.notes)),
        _ => Err(parser.unexpected()),
    }
}

const MAX_DEPTH: usize = 200;
const CONSTANTS: [&str; 3] = ["pi", "true", "false"];
const COMPARISON: u8 = 0;
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const MINUS: u8 = 3;
const POWER: u8 = 4;

struct Parser<'a, M> {
    text: &'a str,
    lexemes: &'a [Lexeme<'a>],
    at: usize,
    scope: &'a dyn Scope,
    meaning: &'a mut M,
    depth: usize,
    notes: Notes,
}

impl<'a, M: Meaning> Parser<'a, M> {
    /// Operands joined by operators that bind at least as tightly as `least`.
    fn expression(&mut self, least: u8) -> Result<Operand<M::Value>, ExprError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let error = ExprError::new(self.span(), format!("nested more than {MAX_DEPTH} levels deep"));
            return Err(error.help("split the expression into parameters"));
        }
        let mut left = self.prefix()?;
        while let Token::Sign(sign) = self.token() {
            let (binding, right_side) = match sign {
                '+' | '-' => (SUM, SUM + 1),
                '*' | '/' => (PRODUCT, PRODUCT + 1),
                '^' => (POWER, POWER),
                '<' | '>' | '≤' | '≥' | '=' | '≠' => (COMPARISON, SUM),
                _ => break,
            };
            if binding < least {
                break;
            }
            self.at += 1;
            let right = match (sign, self.token()) {
                ('*', Token::Sign('*')) => {
                    return Err(ExprError::new(self.span(), "unexpected `*`").help("a power is written ^"));
                }
                _ => self.expression(right_side)?,
            };
            let value = self.meaning.binary(sign, &left, &right)?;
            left = Operand { value, span: left.span.start..right.span.end };
        }
        self.depth -= 1;
        Ok(left)
    }

    fn prefix(&mut self) -> Result<Operand<M::Value>, ExprError> {
        let first = self.at;
        let start = self.span().start;
        match self.token() {
            Token::Number(value) => {
                self.at += 1;
                self.literal(value, first)
            }
            Token::Word(word) => {
                let called = self.lexemes[self.at + 1].token == Token::Sign('(');
                if called {
                    let operand = self.call(word)?;
                    return self.suffix_of_parenthesis(operand);
                }
                let operand = match self.selected(word)? {
                    Some(operand) => operand,
                    None => self.name(word)?,
                };
                let operand = self.selection(operand)?;
                if !CONSTANTS.contains(&word) {
                    let span = operand.span.clone();
                    let text = &self.text[span.clone()];
                    self.meaning.note(&mut self.notes, text, span.start, &operand.value);
                }
                Ok(operand)
            }
            Token::Sign('(') => {
                self.at += 1;
                let inner = self.expression(0)?;
                self.close(')', first)?;
                let operand = Operand { value: inner.value, span: start..self.end() };
                self.suffix_of_parenthesis(operand)
            }
            Token::Sign('[') => {
                self.at += 1;
                let items = self.items(']', first)?;
                let span = start..self.end();
                let value = self.meaning.list(items, span.clone())?;
                self.selection(Operand { value, span })
            }
            Token::Sign('-') => {
                self.at += 1;
                if let Some(value) = self.whole_literal_ahead() {
                    self.at += 1;
                    return self.literal(-value, first);
                }
                let operand = self.expression(MINUS)?;
                let span = start..operand.span.end;
                let value = self.meaning.negated(&operand, span.clone())?;
                Ok(Operand { value, span })
            }
            Token::Sign('+') => {
                self.at += 1;
                let operand = self.expression(MINUS)?;
                self.meaning.plus(&operand)?;
                Ok(Operand { value: operand.value, span: start..operand.span.end })
            }
            Token::Sign(_) => Err(self.unexpected()),
            Token::End => {
                let error = ExprError::new(self.span(), "the expression ends too early");
                Err(error.help("a number or a name is missing at the end"))
            }
        }
    }

    /// The unit behind a number that has just been read. `first` is the token the literal begins with.
    fn literal(&mut self, value: f64, first: usize) -> Result<Operand<M::Value>, ExprError> {
        let start = self.lexemes[first].span.start;
        if self.token() == Token::Word(DECIBEL) {
            self.at += 1;
            let span = start..self.end();
            if !self.is_whole_literal(first) {
                return Err(decibel_error(span));
            }
            self.notes.decibels();
            let ratio = Quantity::plain(10f64.powf(value / 20.0));
            return Ok(Operand { value: self.meaning.quantity(ratio, span.clone())?, span });
        }
        let factor = if self.token() == Token::Sign('[') { Some(self.bracket()?) } else { self.unit()? };
        let Some(factor) = factor else {
            let span = start..self.end();
            return Ok(Operand { value: self.meaning.quantity(Quantity::plain(value), span.clone())?, span });
        };
        let span = start..self.end();
        if factor.offset != 0.0 && !self.is_whole_literal(first) {
            return Err(celsius_error(span));
        }
        let value = self.meaning.quantity(scaled(Quantity::plain(value), factor), span.clone())?;
        Ok(Operand { value, span })
    }

    /// What may follow `(...)`: a unit, or an index and members.
    fn suffix_of_parenthesis(&mut self, operand: Operand<M::Value>) -> Result<Operand<M::Value>, ExprError> {
        let first_in_bracket = self.lexemes.get(self.at + 1).map(|lexeme| lexeme.token);
        let factor = match (self.token(), first_in_bracket) {
            (Token::Sign('['), Some(Token::Word(word))) if is_unit(word) && !self.is_name(word) => {
                Some(self.bracket()?)
            }
            (Token::Sign('['), _) => None,
            _ => self.unit()?,
        };
        let Some(factor) = factor else {
            return self.selection(operand);
        };
        let span = operand.span.start..self.end();
        if factor.offset != 0.0 {
            return Err(celsius_error(span));
        }
        let value = self.meaning.in_unit(&operand, factor, span.clone())?;
        Ok(Operand { value, span })
    }

    /// A unit that begins here, if one does.
    fn unit(&mut self) -> Result<Option<Factor>, ExprError> {
        let next = |n: usize| self.lexemes.get(self.at + n).map(|lexeme| lexeme.token);
        match self.token() {
            Token::Word(word) if !is_unit(word) && self.is_name(word) => {
                let error = ExprError::new(self.span(), format!("unknown unit `{word}`"));
                Err(error.help(format!("to multiply by `{word}` write `* {word}`")))
            }
            Token::Word(_) => self.greedy_unit().map(Some),
            Token::Number(1.0)
                if next(1) == Some(Token::Sign('/'))
                    && matches!(next(2), Some(Token::Word(_) | Token::Sign('('))) =>
            {
                self.greedy_unit().map(Some)
            }
            _ => Ok(None),
        }
    }

    fn greedy_unit(&mut self) -> Result<Factor, ExprError> {
        let is_name = |word: &str| self.is_name(word);
        let mut reader = UnitReader::new(self.lexemes, self.at, &is_name);
        let factor = reader.greedy()?;
        let (first, end) = (self.at, reader.at);
        if M::COMPARES {
            self.is_clear(first, end)?;
        }
        self.at = end;
        self.notes.unit(&self.text[self.lexemes[first].span.start..self.end()], factor);
        Ok(factor)
    }

    /// Refuses a unit by which a name of a law is multiplied, to look at: `1/s*V`, where `V` is a state. Brackets make it clear.
    fn is_clear(&self, first: usize, end: usize) -> Result<(), ExprError> {
        let mut depth = 0;
        let mut unclear = None;
        for at in first..end {
            let is_factor = depth == 0 && at > first && self.lexemes[at - 1].token == Token::Sign('*');
            match self.lexemes[at].token {
                Token::Sign('(') => depth += 1,
                Token::Sign(')') => depth -= 1,
                Token::Word(word) if is_factor && self.is_name(word) => {
                    unclear.get_or_insert((at, word));
                }
                _ => {}
            }
        }
        let Some((at, word)) = unclear else { return Ok(()) };
        let written = |end: usize| &self.text[self.lexemes[first].span.start..self.lexemes[end].span.end];
        let error = format!("`{word}` may be a unit or a name of the law here");
        let help =
            format!("write `{} * {word}` for the name, `[{}]` for the unit", written(at - 2), written(at));
        Err(ExprError::new(self.lexemes[at].span.clone(), error).help(help))
    }

    /// `[unit]`.
    fn bracket(&mut self) -> Result<Factor, ExprError> {
        let mut reader = UnitReader::new(self.lexemes, self.at + 1, &|_| false);
        let factor = reader.whole(Token::Sign(']'))?;
        let (first, end) = (self.at, reader.at);
        self.at = end;
        self.notes.unit(&self.text[self.lexemes[first].span.end..self.end() - 1], factor);
        Ok(factor)
    }

    /// The number that comes next, if its unit is one that the sign belongs to: degrees Celsius, decibels.
    fn whole_literal_ahead(&self) -> Option<f64> {
        let mut ahead = self.lexemes[self.at..].iter().map(|lexeme| lexeme.token);
        let Some(Token::Number(value)) = ahead.next() else { return None };
        let unit = ahead.find(|token| *token != Token::Sign('['))?;
        matches!(unit, Token::Word(word) if word == DECIBEL || unit_table::is_celsius(word)).then_some(value)
    }

    /// Whether the literal from token `first` to here stands alone, in the text or in a list.
    fn is_whole_literal(&self, first: usize) -> bool {
        let before = first.checked_sub(1).map(|at| self.lexemes[at].token);
        matches!(before, None | Some(Token::Sign('[' | ',')))
            && matches!(self.token(), Token::End | Token::Sign(',' | ']'))
    }

    fn call(&mut self, word: &str) -> Result<Operand<M::Value>, ExprError> {
        let named = self.span();
        self.at += 2;
        let arguments = self.items(')', self.at - 1)?;
        let span = named.start..self.end();
        let value = self.meaning.call(word, named, &arguments, span.clone())?;
        Ok(Operand { value, span })
    }

    fn name(&mut self, word: &str) -> Result<Operand<M::Value>, ExprError> {
        let span = self.span();
        self.at += 1;
        let value = match word {
            "pi" => self.meaning.known(PI.into(), span.clone())?,
            "true" => self.meaning.known(Value::Bool(true), span.clone())?,
            "false" => self.meaning.known(Value::Bool(false), span.clone())?,
            _ => match self.scope.lookup(word) {
                Lookup::Failed(reason) => return Err(ExprError::new(span, reason)),
                looked_up => match self.meaning.name(word, looked_up, span.clone())? {
                    Some(value) => value,
                    None => return Err(self.unknown_name(word, span)),
                },
            },
        };
        Ok(Operand { value, span })
    }

    /// A name with the members and plain items behind it, where the scope knows that value.
    fn selected(&mut self, word: &str) -> Result<Option<Operand<M::Value>>, ExprError> {
        let token = |at: usize| self.lexemes.get(at).map(|lexeme| lexeme.token);
        let (start, mut at) = (self.span().start, self.at + 1);
        let mut path = Vec::new();
        loop {
            match (token(at), token(at + 1), token(at + 2)) {
                (Some(Token::Sign('.')), Some(Token::Word(name)), _) => {
                    path.push(Part::Member(name));
                    at += 2;
                }
                (Some(Token::Sign('[')), Some(Token::Number(index)), Some(Token::Sign(']')))
                    if index >= 0.0 && index.fract() == 0.0 =>
                {
                    path.push(Part::Item(index as usize));
                    at += 3;
                }
                _ => break,
            }
        }
        let found = if path.is_empty() { None } else { self.scope.select(word, &path) };
        let Some(value) = found else { return Ok(None) };
        self.at = at;
        let span = start..self.end();
        Ok(Some(Operand { value: self.meaning.known(value, span.clone())?, span }))
    }

    /// `.member` and `[index]`, any number of them.
    fn selection(&mut self, mut operand: Operand<M::Value>) -> Result<Operand<M::Value>, ExprError> {
        loop {
            let first = self.at;
            let start = operand.span.start;
            let value = match self.token() {
                Token::Sign('.') => {
                    self.at += 1;
                    let Token::Word(name) = self.token() else {
                        return Err(ExprError::new(self.span(), "expected the name of a member after `.`"));
                    };
                    let span = self.span();
                    self.at += 1;
                    self.meaning.member(operand, name, span)?
                }
                Token::Sign('[') => {
                    self.at += 1;
                    let index = self.expression(0)?;
                    self.close(']', first)?;
                    self.meaning.item(operand, &index)?
                }
                _ => return Ok(operand),
            };
            operand = Operand { value, span: start..self.end() };
        }
    }

    /// Expressions separated by commas up to the closing sign; one comma may stand at the end.
    fn items(&mut self, end: char, opened: usize) -> Result<Vec<Operand<M::Value>>, ExprError> {
        let mut items = Vec::new();
        while self.token() != Token::Sign(end) {
            items.push(self.expression(0)?);
            if self.token() != Token::Sign(',') {
                break;
            }
            if let Some(error) = self.decimal_comma(true) {
                return Err(error);
            }
            self.at += 1;
        }
        self.close(end, opened)?;
        Ok(items)
    }

    fn close(&mut self, end: char, opened: usize) -> Result<(), ExprError> {
        if self.token() == Token::Sign(end) {
            self.at += 1;
            return Ok(());
        }
        if self.token() != Token::End {
            return Err(self.unexpected());
        }
        let opening = self.lexemes[opened].span.clone();
        let message = format!("`{}` is not closed", &self.text[opening.clone()]);
        Err(ExprError::new(opening, message).help(format!("add `{end}`")))
    }

    fn is_name(&self, word: &str) -> bool {
        CONSTANTS.contains(&word) || self.scope.lookup(word) != Lookup::Unknown
    }

    fn token(&self) -> Token<'a> {
        self.lexemes[self.at].token
    }

    fn span(&self) -> Range<usize> {
        self.lexemes[self.at].span.clone()
    }

    /// Where the token before this one ends.
    fn end(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |at| self.lexemes[at].span.end)
    }
}

fn is_unit(word: &str) -> bool {
    unit_table::find(word).is_some()
}

pub(crate) fn scaled(quantity: Quantity, factor: Factor) -> Quantity {
    let value = to_si(quantity.value, factor.scale(), factor.offset);
    Quantity::new(value, quantity.dimension.times(factor.dimension))
}

fn decibel_error(span: Range<usize>) -> ExprError {
    let error = ExprError::new(span, "dB stands only in a whole literal, such as \"-3 dB\"");
    error.help("write a ratio for calculations: -3 dB is 0.708, 20 dB is 10")
}

fn celsius_error(span: Range<usize>) -> ExprError {
    let error = ExprError::new(span, "degC stands only in a whole literal, such as \"20 degC\"");
    error.help("use K for calculations and differences")
}

#[cfg(test)]
mod tests;
