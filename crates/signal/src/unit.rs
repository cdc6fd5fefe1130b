//! Units in texts: `kW`, `N*m/(rad/s)`, `kg*m^2`, `1/s`, `%`, `degC`.

use crate::lexer::{Token, lex};
use crate::unit_reader::UnitReader;
use crate::{Dimension, ExprError};
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

/// Why a text is not a unit.
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
    /// ```
    /// let power = blocksim_signal::Unit::parse("kW")?;
    /// assert_eq!(power.to_si(12.5), 12_500.0);
    /// assert_eq!(power.dimension.to_string(), "W");
    /// # Ok::<(), blocksim_signal::UnitError>(())
    /// ```
    ///
    /// Errors: an empty text, an unknown symbol, `degC` in a product, an exponent that is not a whole literal.
    pub fn parse(text: &str) -> Result<Unit, UnitError> {
        let lexemes = lex(text, false)?;
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
        to_si(value, self.scale, self.offset)
    }

    /// The whole number whose inverse is the scale, if there is one: what a value in SI is multiplied with for one rounding alone.
    pub fn divisor(&self) -> Option<f64> {
        divisor(self.scale)
    }

    /// A value in SI, converted to this unit.
    pub fn from_si(&self, value: f64) -> f64 {
        match self.divisor() {
            Some(divisor) => (value - self.offset) * divisor,
            None => (value - self.offset) / self.scale,
        }
    }
}

/// `value * scale + offset`, rounded once where the scale is the inverse of a whole number.
pub(crate) fn to_si(value: f64, scale: f64, offset: f64) -> f64 {
    match divisor(scale) {
        Some(divisor) => value / divisor + offset,
        None => value * scale + offset,
    }
}

/// The whole number whose inverse is the scale, if there is one: dividing by it makes 9 ms the number nearest to
/// 0.009, which multiplying by 0.001 misses.
fn divisor(scale: f64) -> Option<f64> {
    let divisor = (1.0 / scale).round();
    (scale < 1.0 && 1.0 / divisor == scale).then_some(divisor)
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests;
