//! `"0 .. 50"`, `"-90 .. 90 deg"`: two numbers, each with a unit or in that of the other, else in the one that is written for the
//! value.

use std::ops::Range;
use std::rc::Rc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::schedule::Recorded;
use blocksim_signal::{Dimension, Quantity, Unit};

use crate::ast::Ast;
use crate::replacing::{Place as Where, WrittenUnit};
use crate::scope::{Scope, noted};
use crate::targets::Target;
use blocksim_syntax::{Node, Shape};

/// Decibels by which a ratio changes when it grows by all of itself, for small changes: 20 / ln 10.
const DECIBELS: f64 = 8.7;

/// What values of a range are counted in.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Scale {
    /// Nothing stands behind a number.
    Bare(Dimension),
    /// A unit.
    In(Unit),
    /// Ratios in decibels.
    Decibels,
    /// What a bare number would mean is not clear: a dimension, and the name of what has it.
    Unclear(Dimension, String),
}

impl Scale {
    /// That in which a bare number is taken for a parameter.
    pub fn of_target(target: &Target, now: Quantity) -> Scale {
        match &target.written_unit {
            WrittenUnit::One(unit) => Scale::In(unit.clone()),
            WrittenUnit::Decibels => Scale::Decibels,
            WrittenUnit::Unclear => Scale::Unclear(now.dimension, target.name.clone()),
            WrittenUnit::Si if now.dimension.is_none() => match Unit::parse(&target.unit) {
                Ok(unit) if !unit.dimension.is_none() && unit.scale == 1.0 && unit.offset == 0.0 => {
                    // A bare number stays one, but is known to be in this unit.
                    Scale::Bare(unit.dimension)
                }
                _ => Scale::Bare(Dimension::OPEN),
            },
            WrittenUnit::Si => Scale::In(Unit::si(now.dimension)),
        }
    }

    /// That in which a signal is shown.
    pub fn of_signal(recorded: &Recorded) -> Scale {
        let display = recorded.display.as_deref().and_then(|unit| Unit::parse(unit).ok());
        match (display, recorded.dimension) {
            (Some(unit), _) => Scale::In(unit),
            (None, Some(dimension)) if !dimension.is_none() => Scale::In(Unit::si(dimension)),
            (None, Some(dimension)) => Scale::Bare(dimension),
            (None, None) => Scale::Bare(Dimension::OPEN),
        }
    }

    fn dimension(&self) -> Dimension {
        match self {
            Scale::Bare(dimension) | Scale::Unclear(dimension, _) => *dimension,
            Scale::In(unit) => unit.dimension,
            Scale::Decibels => Dimension::NONE,
        }
    }

    /// A value in SI as it is counted.
    pub fn shown(&self, value: f64) -> f64 {
        match self {
            Scale::In(unit) => without_dust(unit.from_si(value), unit.offset / unit.scale),
            Scale::Decibels => without_dust(20.0 * value.log10(), DECIBELS),
            Scale::Bare(_) | Scale::Unclear(..) => value,
        }
    }

    /// What stands behind a number.
    pub fn text(&self) -> &str {
        match self {
            Scale::In(unit) => &unit.text,
            Scale::Decibels => "dB",
            Scale::Bare(_) | Scale::Unclear(..) => "",
        }
    }

    /// A number with what stands behind it.
    pub fn told(&self, value: f64) -> String {
        format!("{} {}", Quantity::plain(value).display(), self.text()).trim_end().to_owned()
    }

    /// The unit, if it is one.
    pub fn unit(self) -> Option<Unit> {
        if let Scale::In(unit) = self { Some(unit) } else { None }
    }
}

/// A value without what its conversion has added behind the last digits; `beside` is of the size of what was added on the way, such as
/// the 273.15 of a temperature.
fn without_dust(value: f64, beside: f64) -> f64 {
    let exponent = |x: f64| x.abs().log10().floor();
    let digits = 14.0 + exponent(value) - exponent(value.abs().max(beside.abs()));
    if value == 0.0 || !digits.is_finite() {
        return value;
    }
    if digits < 0.0 { 0.0 } else { format!("{value:.*e}", digits as usize).parse().unwrap_or(value) }
}

/// An end of a range.
struct End {
    /// In SI; a bare one as it is written.
    value: f64,
    dimension: Dimension,
    /// What it is counted in; nothing if that is not said.
    scale: Option<Scale>,
    place: Place,
}

/// Reads a range whose bare numbers are in `usual`; the ends are in the scale that is returned.
pub(super) fn read(
    scope: &Rc<Scope>,
    ast: &Ast,
    text: &str,
    span: &Range<usize>,
    usual: &Scale,
) -> Result<([f64; 2], Scale), Problem> {
    let whole = ast.place(span);
    let Some((low, high)) = text.split_once("..") else {
        let told = format!("`{text}` is not a range");
        let help = format!("write two numbers, such as \"{}\"", example(usual));
        return Err(Problem::error("panel", told).at(&whole, "not a range").help(help));
    };
    let behind = low.len() + 2;
    let low = end(scope, ast, low, span.start + 1, span)?;
    let high = end(scope, ast, high, span.start + 1 + behind, span)?;
    let scale = match (&high.scale, &low.scale) {
        (Some(scale), _) | (None, Some(scale)) => scale.clone(),
        (None, None) => usual.clone(),
    };
    if let Scale::Unclear(dimension, name) = &scale {
        let told = format!("`{name}` is computed from values in other units, the range has none");
        let help = format!("write the unit, such as \"0 .. 1 {}\"", Unit::si(*dimension).text);
        return Err(Problem::error("unit_mismatch", told).at(&whole, "in which unit?").help(help));
    }
    let counted = |end: &End| -> Result<f64, Problem> {
        if let Some(own) = &end.scale {
            let wanted = [usual.dimension(), scale.dimension()];
            if let Some(other) = wanted.iter().find(|wanted| !fits(**wanted, end.dimension)) {
                let unit = own.text();
                let told = match other.is_none() {
                    true => format!("expected a range without a unit, found {unit}"),
                    false => format!("expected a range in {other}, found {unit}"),
                };
                let help = format!("write it in a unit of the same kind, such as \"{}\"", example(usual));
                return Err(Problem::error("unit_mismatch", told).at(&end.place, "").help(help));
            }
            return Ok(scale.shown(end.value));
        }
        Ok(end.value)
    };
    let (first, last) = (counted(&low)?, counted(&high)?);
    for (value, end) in [(first, &low), (last, &high)] {
        if !value.is_finite() {
            let problem = Problem::error("panel", format!("a range cannot end at {value}"));
            return Err(problem.at(&end.place, "").help("write a finite number"));
        }
    }
    if first >= last {
        let told = format!("the range from {} to {} is empty", scale.told(first), scale.told(last));
        return Err(Problem::error("panel", told)
            .at(&whole, "is empty")
            .help("the smaller number comes first"));
    }
    Ok(([first, last], scale))
}

/// Whether a unit may stand where this dimension is asked for.
fn fits(wanted: Dimension, found: Dimension) -> bool {
    wanted.is_open() || wanted.takes(found)
}

fn example(usual: &Scale) -> String {
    let unit = match usual {
        Scale::Unclear(dimension, _) => Unit::si(*dimension).text,
        known => known.text().to_owned(),
    };
    format!("0 .. 50 {unit}").trim_end().to_owned()
}

fn end(scope: &Rc<Scope>, ast: &Ast, text: &str, start: usize, whole: &Range<usize>) -> Result<End, Problem> {
    let trimmed = text.trim();
    let start = start + (text.len() - text.trim_start().len());
    let place = ast.place(&(start..start + trimmed.len()));
    if trimmed.is_empty() {
        let problem = Problem::error("panel", "an end of the range is missing").at(&ast.place(whole), "");
        return Err(problem.help("write both, such as \"0 .. 50\""));
    }
    let noted = noted(scope, trimmed, ast.file, start, whole)?;
    let Some(Quantity { value, dimension }) = noted.value.as_number() else {
        let told = format!("a range ends at a number, not at {}", noted.value.describe());
        return Err(Problem::error("panel", told).at(&place, "not a number"));
    };
    let scale = (!noted.is_bare).then(|| {
        let node = Rc::new(Node { span: 0..0, value: Shape::Text(trimmed.to_owned()) });
        match (Where { scope: scope.clone(), file: ast.file, node }).unit(dimension) {
            WrittenUnit::One(unit) => Scale::In(unit),
            WrittenUnit::Decibels => Scale::Decibels,
            WrittenUnit::Si | WrittenUnit::Unclear if dimension.is_none() => Scale::Bare(dimension),
            WrittenUnit::Si | WrittenUnit::Unclear => Scale::In(Unit::si(dimension)),
        }
    });
    Ok(End { value, dimension, scale, place })
}
