//! The functions an expression may call.

use crate::arithmetic::{Operand, mismatch, sound};
use crate::{Dimension, ExprError, Quantity, Value, closest, surely};
use std::{f64::consts::TAU, ops::Range};

/// Names with the least and the greatest number of arguments.
const FUNCTIONS: [(&str, usize, usize); 20] = [
    ("sqrt", 1, 1),
    ("abs", 1, 1),
    ("sign", 1, 1),
    ("sin", 1, 1),
    ("cos", 1, 1),
    ("tan", 1, 1),
    ("asin", 1, 1),
    ("acos", 1, 1),
    ("atan", 1, 1),
    ("atan2", 2, 2),
    ("exp", 1, 1),
    ("ln", 1, 1),
    ("log10", 1, 1),
    ("min", 1, usize::MAX),
    ("max", 1, usize::MAX),
    ("floor", 1, 1),
    ("ceil", 1, 1),
    ("round", 1, 1),
    ("angular", 1, 1),
    ("cycles", 1, 1),
];

/// Whether a function of that name exists.
pub(crate) fn exists(name: &str) -> bool {
    FUNCTIONS.iter().any(|(known, ..)| *known == name)
}

/// The value of a function. `named` is the place of its name, `span` that of the whole call.
///
/// Angles go in as plain numbers or in any angle unit; inverse functions return rad. `min` and `max` also take one
/// list. `angular` makes rad/s of Hz, `cycles` makes Hz of rad/s.
pub(crate) fn call(
    name: &str,
    named: Range<usize>,
    arguments: &[Operand],
    span: Range<usize>,
) -> Result<Value, ExprError> {
    let Some((_, least, most)) = FUNCTIONS.iter().find(|(known, ..)| *known == name) else {
        let known = FUNCTIONS.map(|(known, ..)| known);
        let error = ExprError::new(named, format!("unknown function `{name}`"))
            .remedy(surely(name, known).map(str::to_owned));
        return Err(match closest(name, known) {
            Some(near) => error.help(format!("did you mean `{near}`?")),
            None => error.help(format!("the functions are: {}", known.join(", "))),
        });
    };
    let count = arguments.len();
    if count < *least || count > *most {
        let wanted = if *least == 1 { "one argument".to_string() } else { format!("{least} arguments") };
        let error = ExprError::new(span, format!("`{name}` takes {wanted}, not {count}"));
        return Err(if count == 2 { error.help("a decimal number is written with a point") } else { error });
    }
    let call = Call { name, span: span.clone() };
    let quantity = match (name, arguments) {
        ("min" | "max", _) => call.extreme(arguments)?,
        ("atan2", [y, x]) => {
            let (y, x) = (call.number(y)?, call.number(x)?);
            if !y.dimension.compatible(x.dimension) {
                return Err(mismatch("compare", y.dimension, x.dimension, span));
            }
            call.angle(y.value.atan2(x.value))
        }
        (_, [argument, ..]) => call.of_one(argument)?,
        _ => return Err(ExprError::new(span, "the function lacks its argument")),
    };
    sound(quantity, span)
}

struct Call<'a> {
    name: &'a str,
    span: Range<usize>,
}

impl Call<'_> {
    fn of_one(&self, argument: &Operand) -> Result<Quantity, ExprError> {
        let Quantity { value, dimension } = self.number(argument)?;
        let plain = || self.plain(argument);
        Ok(match self.name {
            "abs" => Quantity::new(value.abs(), dimension),
            "sign" => Quantity::plain(if value == 0.0 { 0.0 } else { value.signum() }),
            "sqrt" => self.square_root(value, dimension, argument)?,
            "sin" => Quantity::plain(plain()?.sin()),
            "cos" => Quantity::plain(plain()?.cos()),
            "tan" => Quantity::plain(plain()?.tan()),
            "asin" => self.angle(self.within_one(plain()?, argument)?.asin()),
            "acos" => self.angle(self.within_one(plain()?, argument)?.acos()),
            "atan" => self.angle(plain()?.atan()),
            "exp" => Quantity::plain(plain()?.exp()),
            "ln" => Quantity::plain(self.positive(plain()?, argument)?.ln()),
            "log10" => Quantity::plain(self.positive(plain()?, argument)?.log10()),
            "floor" => Quantity::new(plain()?.floor(), dimension),
            "ceil" => Quantity::new(plain()?.ceil(), dimension),
            "round" => Quantity::new(plain()?.round(), dimension),
            "angular" => self.angular(value, dimension, argument)?,
            _ => self.cycles(value, dimension, argument)?,
        })
    }

    fn number(&self, argument: &Operand) -> Result<Quantity, ExprError> {
        argument.number(&format!("take {} of", self.name))
    }

    fn plain(&self, argument: &Operand) -> Result<f64, ExprError> {
        let quantity = self.number(argument)?;
        if quantity.dimension.is_none() {
            return Ok(quantity.value);
        }
        let message = format!("`{}` takes a plain number or an angle, not {}", self.name, quantity.dimension);
        let help = format!("divide by a unit first, as in {}(x / (1 {}))", self.name, quantity.dimension);
        Err(ExprError::new(argument.span.clone(), message).help(help))
    }

    fn angle(&self, value: f64) -> Quantity {
        Quantity::new(value, Dimension::RADIAN)
    }

    fn refuse<T>(&self, wanted: &str, value: f64, argument: &Operand) -> Result<T, ExprError> {
        let message = format!("`{}` takes {wanted}, not {value}", self.name);
        Err(ExprError::new(argument.span.clone(), message))
    }

    fn within_one(&self, value: f64, argument: &Operand) -> Result<f64, ExprError> {
        if value.abs() <= 1.0 { Ok(value) } else { self.refuse("a number from -1 to 1", value, argument) }
    }

    fn positive(&self, value: f64, argument: &Operand) -> Result<f64, ExprError> {
        if value > 0.0 { Ok(value) } else { self.refuse("a positive number", value, argument) }
    }

    fn square_root(
        &self,
        value: f64,
        dimension: Dimension,
        argument: &Operand,
    ) -> Result<Quantity, ExprError> {
        if value < 0.0 {
            return self.refuse("a number that is not negative", value, argument);
        }
        let no_unit =
            || ExprError::new(self.span.clone(), format!("the square root of {dimension} is not a unit"));
        Ok(Quantity::new(value.sqrt(), dimension.root(2).ok_or_else(no_unit)?))
    }

    fn angular(&self, value: f64, dimension: Dimension, argument: &Operand) -> Result<Quantity, ExprError> {
        let no_cycles = || {
            let message = format!("`angular` takes a frequency in Hz, not {dimension}");
            ExprError::new(argument.span.clone(), message)
        };
        let (dimension, n) = dimension.cycles_to_radians().ok_or_else(no_cycles)?;
        Ok(Quantity::new(value * TAU.powi(n.into()), dimension))
    }

    fn cycles(&self, value: f64, dimension: Dimension, argument: &Operand) -> Result<Quantity, ExprError> {
        let no_radians = || {
            let message = format!("`cycles` takes an angular frequency in rad/s, not {dimension}");
            ExprError::new(argument.span.clone(), message)
        };
        let (dimension, n) = dimension.radians_to_cycles().ok_or_else(no_radians)?;
        Ok(Quantity::new(value / TAU.powi(n.into()), dimension))
    }

    /// The least or greatest of the arguments, or of the items of the only argument.
    fn extreme(&self, arguments: &[Operand]) -> Result<Quantity, ExprError> {
        let items: Vec<Operand> = match arguments {
            [Operand { value: Value::List(items), span }] => {
                items.iter().map(|value| Operand { value: value.clone(), span: span.clone() }).collect()
            }
            _ => arguments.to_vec(),
        };
        let mut best: Option<Quantity> = None;
        for item in &items {
            let next = self.number(item)?;
            best = Some(match best {
                Some(best) if !best.dimension.compatible(next.dimension) => {
                    return Err(mismatch("compare", best.dimension, next.dimension, item.span.clone()));
                }
                Some(best) if (self.name == "min") == (best.value <= next.value) => best,
                _ => next,
            });
        }
        best.ok_or_else(|| ExprError::new(self.span.clone(), format!("`{}` of an empty list", self.name)))
    }
}
