//! What to say when an expression cannot be read.

use super::{Meaning, Parser, is_unit};
use crate::{ExprError, closest, functions, lexer::Token, select, surely};
use std::ops::Range;

impl<M: Meaning> Parser<'_, M> {
    /// Something stands where it cannot.
    pub(super) fn unexpected(&self) -> ExprError {
        if let Some(error) = self.decimal_comma(false) {
            return error;
        }
        let written = &self.text[self.span()];
        match self.token() {
            Token::Sign(sign @ (')' | ']')) => {
                let opening = if sign == ')' { '(' } else { '[' };
                let error = ExprError::new(self.span(), format!("unexpected `{sign}`"));
                error.help(format!("there is no `{opening}` that it closes, or a value is missing before it"))
            }
            Token::Word(word) if is_unit(word) => {
                let error = ExprError::new(self.span(), format!("expected an operator before `{written}`"));
                error.help(format!("a unit stands behind a number or a parenthesis, as in (x) {word}"))
            }
            Token::Word(word) if functions::exists(word) => {
                let error = ExprError::new(self.span(), format!("expected an operator before `{written}`"));
                error.help(format!("`{word}` is a function, which stands before its values: {word}(...)"))
            }
            Token::Number(_) | Token::Word(_) => {
                let error = ExprError::new(self.span(), format!("expected an operator before `{written}`"));
                error.help(format!("write what is to be done with both, as in ... * {written}"))
            }
            Token::Sign('*' | '/' | '^' | ',') => {
                let error = ExprError::new(self.span(), format!("unexpected `{written}`"));
                error.help("a number or a name is missing before it")
            }
            _ => ExprError::new(self.span(), format!("unexpected `{written}`")),
        }
    }

    /// `1,05`: a comma right between two numbers. Where commas separate, only a leading zero gives it away.
    pub(super) fn decimal_comma(&self, separates: bool) -> Option<ExprError> {
        let before = self.lexemes.get(self.at.checked_sub(1)?)?;
        let (comma, after) = (self.lexemes.get(self.at)?, self.lexemes.get(self.at + 1)?);
        let numbers = matches!((before.token, after.token), (Token::Number(_), Token::Number(_)));
        let tight = before.span.end == comma.span.start && comma.span.end == after.span.start;
        if comma.token != Token::Sign(',') || !numbers || !tight {
            return None;
        }
        let (whole, fraction) = (&self.text[before.span.clone()], &self.text[after.span.clone()]);
        let is_fraction = fraction.len() > 1 && fraction.starts_with('0') && !fraction.contains('.');
        if separates && !is_fraction {
            return None;
        }
        let error = ExprError::new(
            before.span.start..after.span.end,
            format!("`{whole},{fraction}` is not a number"),
        );
        if whole.contains('.') || fraction.contains('.') {
            // Both a comma and a point: one of them separates thousands.
            return Some(error.help(
                "write numbers without separators between thousands, with a point before the decimals",
            ));
        }
        // Thousands are separated so as well.
        if fraction.len() == 3 && whole.len() <= 3 && !whole.starts_with('0') {
            return Some(
                error.help(format!("write {whole}.{fraction} or {whole}{fraction}, whichever is meant")),
            );
        }
        let remedy = (!separates).then(|| format!("{whole}.{fraction}"));
        Some(error.help(format!("decimal comma? write {whole}.{fraction}")).remedy(remedy))
    }

    pub(super) fn unknown_name(&self, word: &str, span: Range<usize>) -> ExprError {
        let error = ExprError::new(span, format!("unknown name `{word}`"));
        if matches!(word.to_ascii_lowercase().as_str(), "nan" | "inf" | "infinity") {
            let error = ExprError::new(error.span, format!("`{word}` is not a finite number"));
            return error.help("write a number; the largest is about 1.8e308");
        }
        let names = self.scope.names();
        let known = names.iter().map(String::as_str).chain(["pi", "true", "false"]);
        if is_unit(word) {
            return error
                .help(format!("`{word}` is also a unit; a unit stands behind a number, as in 1 {word}"));
        }
        match closest(word, known) {
            Some(near) => {
                let names = names.iter().map(String::as_str).chain(["pi", "true", "false"]);
                let remedy = surely(word, names).map(str::to_owned);
                error.help(format!("did you mean `{near}`?")).remedy(remedy)
            }
            None if functions::exists(word) => {
                error.help(format!("`{word}` is a function; write {word}(...)"))
            }
            None if names.is_empty() => error.help("no names are known here"),
            None => error.help(format!("the names here are: {}", select::some_of(&names))),
        }
    }
}
