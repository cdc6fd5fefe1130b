//! Units in texts: `kW`, `N*m/(rad/s)`, `kg*m^2`, `1/s`, `%`, `degC`.

use crate::lexer::{Lexeme, Token, lex};
use crate::unit_table::{self, Factor};
use crate::{Dimension, ExprError, closest};
use std::{fmt, ops::Range};

/// A unit of measurement: `value_SI = value * scale + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// The unit as it was written.
    pub text: String,
    /// SI units in one of this unit.
    pub scale: f64,
    /// SI value of zero in this unit; 273.15 for degC, else 0.
    pub offset: f64,
    /// What is measured.
    pub dimension: Dimension,
}

/// Why a text is no unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitError {
    /// The fact.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// The bytes of the text it is about.
    pub span: Range<usize>,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for UnitError {}

impl From<ExprError> for UnitError {
    fn from(error: ExprError) -> Self {
        Self { message: error.message, help: error.help, span: error.span }
    }
}

impl Unit {
    /// Reads a unit. `1` is the unit of plain numbers.
    ///
    /// Errors: an empty text, an unknown symbol, `degC` in a product, an exponent that is not a whole literal.
    pub fn parse(text: &str) -> Result<Unit, UnitError> {
        let lexemes = lex(text)?;
        if lexemes.len() == 1 {
            return Err(ExprError::new(0..text.len(), "empty unit")
                .help("write 1 for a plain number")
                .into());
        }
        let mut reader = UnitReader::new(&lexemes, 0, &|_| false);
        let factor = reader.whole(Token::End)?;
        let (text, scale) = (text.trim().to_string(), factor.scale());
        Ok(Unit { text, scale, offset: factor.offset, dimension: factor.dimension })
    }

    /// The SI unit of a dimension, named as [`Dimension`] prints it.
    pub fn si(dimension: Dimension) -> Unit {
        Unit { text: dimension.to_string(), scale: 1.0, offset: 0.0, dimension }
    }

    /// A value in this unit, converted to SI.
    pub fn to_si(&self, value: f64) -> f64 {
        match self.divisor() {
            Some(divisor) => value / divisor + self.offset,
            None => value * self.scale + self.offset,
        }
    }

    /// A value in SI, converted to this unit.
    pub fn from_si(&self, value: f64) -> f64 {
        match self.divisor() {
            Some(divisor) => (value - self.offset) * divisor,
            None => (value - self.offset) / self.scale,
        }
    }

    /// The whole number whose inverse is the scale, if there is one: dividing by it rounds once, so that 9 ms is the
    /// number nearest to 0.009.
    fn divisor(&self) -> Option<f64> {
        let divisor = (1.0 / self.scale).round();
        (self.scale < 1.0 && 1.0 / divisor == self.scale).then_some(divisor)
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

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
    /// known symbol that is not taken, or with parentheses that hold nothing else.
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
            Token::Number(1.0) => {
                self.at += 1;
                return Ok(Factor::ONE);
            }
            Token::Word(symbol) => {
                let is_path = matches!(self.lexemes[self.at + 1].token, Token::Sign('.' | '('));
                if !certain && ((self.is_taken)(symbol) || is_path) {
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
    ExprError::new(span, format!("unknown unit `{symbol}`")).help(hint(symbol))
}

/// What may be meant by an unknown symbol: a word for a unit, a product without sign, or a slip of the pen.
fn hint(symbol: &str) -> String {
    let singular = symbol.strip_suffix('s').unwrap_or(symbol).to_ascii_lowercase();
    let word =
        unit_table::WORDS.iter().find(|(word, _)| *word == singular || symbol.eq_ignore_ascii_case(word));
    if let Some((_, short)) = word {
        return format!("write `{short}`");
    }
    if singular.len() > 1 && unit_table::find(&singular).is_some() {
        return format!("write `{singular}`");
    }
    let split = symbol.char_indices().skip(1).find_map(|(i, _)| {
        let (left, right) = symbol.split_at(i);
        (unit_table::find(left).is_some() && unit_table::find(right).is_some())
            .then(|| format!("{left}*{right}"))
    });
    if let Some(product) = split {
        return format!("write `{product}`");
    }
    let symbols = unit_table::symbols();
    match closest(symbol, symbols.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => {
            "units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %"
                .into()
        }
    }
}
