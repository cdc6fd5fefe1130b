use blocksim_block::prelude::*;

/// An elementary function of each element: $y = f(u)$.
///
/// Angles and arguments of exponentials have no unit (an angle in degrees is one in radians already). `Sqrt` and
/// `SignedSqrt` halve the exponents of a unit, `Square` doubles and `Reciprocal` inverts them. Where a function is
/// not defined (`Asin` and `Acos` beyond one, `Ln` and `Log10` of nothing positive, `Sqrt` of less than zero,
/// `Reciprocal` of zero) the simulation stops with the value.
///
/// `SignedSqrt` is $\operatorname{sgn}(u) \sqrt{|u|}$; the solver steps onto its vertical tangent at zero.
///
/// ```ron
/// Function(function: Sqrt)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("function"))]
pub struct Function {
    /// Which one: `Sin`, `Cos`, `Tan`, `Asin`, `Acos`, `Atan`, `Sinh`, `Cosh`, `Tanh`, `Exp`, `Ln`, `Log10`,
    /// `Pow10`, `Sqrt`, `SignedSqrt`, `Square` or `Reciprocal`.
    pub function: FunctionName,
}

/// Names of elementary functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum FunctionName {
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine, -pi/2 to pi/2.
    Asin,
    /// Inverse cosine, 0 to pi.
    Acos,
    /// Inverse tangent, -pi/2 to pi/2.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Power of e.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 10.
    Log10,
    /// Power of 10.
    Pow10,
    /// Square root.
    Sqrt,
    /// Square root of the absolute value, with the sign of the argument.
    SignedSqrt,
    /// Second power.
    Square,
    /// One divided by the argument.
    Reciprocal,
}

use FunctionName::{
    Acos, Asin, Atan, Cos, Cosh, Exp, Ln, Log10, Pow10, Reciprocal, SignedSqrt, Sin, Sinh, Sqrt, Square, Tan,
    Tanh,
};

impl FunctionName {
    fn of<'r>(self, u: Value<'r>) -> Value<'r> {
        match self {
            Sin => u.sin(),
            Cos => u.cos(),
            Tan => u.tan(),
            Asin => u.asin(),
            Acos => u.acos(),
            Atan => u.atan(),
            Sinh => u.sinh(),
            Cosh => u.cosh(),
            Tanh => u.tanh(),
            Exp => u.exp(),
            Ln => u.ln(),
            Log10 => u.log10(),
            Pow10 => u.raise(10.0),
            Sqrt => u.sqrt(),
            SignedSqrt => {
                let root = u.abs().sqrt();
                u.live(Relation::Less, u.zero()).select(-root, root)
            }
            Square => u * u,
            Reciprocal => 1.0 / u,
        }
    }

    fn wants_plain_number(self) -> bool {
        !matches!(self, Sqrt | SignedSqrt | Square | Reciprocal)
    }
}

impl Block for Function {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let mut input = Input::real("u");
        let dimension = match self.function {
            Asin | Acos | Atan => Output::real("y").unit("rad").port_type.dimension,
            Square => u.dimension.map(|dimension| dimension.power(2)),
            Reciprocal => u.dimension.map(|dimension| dimension.power(-1)),
            Sqrt | SignedSqrt => u.dimension.map(|dimension| root(dimension, 2)).transpose()?,
            _ => Some(Dimension::NONE),
        };
        if self.function.wants_plain_number() {
            input = input.dimension(Some(Dimension::NONE));
        }
        let interface = Interface::new().input(input).output(Output::like("y", u.of(dimension)));
        let interface = match self.function {
            Sin | Cos | Tan => interface.turning_input(0),
            _ => interface,
        };
        let guards = if self.function == SignedSqrt { u.shape.len() } else { 0 };
        Ok(interface.guard_each("zero", guards).called("turns positive", "turns negative"))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| self.function.of(l.element(0, i)));
        if self.function == SignedSqrt {
            (0..l.width(0)).for_each(|i| l.guard(i, l.element(0, i)));
        }
        true
    }

    fn no_value(&self, failure: &Failure, _c: &Context) -> Option<String> {
        let u = failure.value;
        let plain = u == 0.0 || (1e-4..1e7).contains(&u.abs());
        let u = if plain { u.to_string() } else { format!("{u:e}") };
        Some(format!(
            "{:?} has no value at u = {u}; u must be {} (MinMax or Saturation can keep it there)",
            self.function,
            failure.domain.wanted()
        ))
    }
}

/// The dimension of a root, or why there is none.
pub(super) fn root(dimension: Dimension, n: i8) -> Result<Dimension, InterfaceError> {
    dimension.root(n).ok_or_else(|| {
        InterfaceError::units(
            &["u"],
            format!("`u` is in {dimension}, of which there is no root of order {n}"),
        )
        .help("divide by a reference value first, so that a plain number is left")
    })
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    fn value(function: FunctionName, u: f64) -> f64 {
        Bench::new(Function { function }).respond(u)
    }

    #[test]
    fn inverse_functions_give_the_argument_back() {
        let pairs = [(Sin, Asin), (Cos, Acos), (Tan, Atan), (Exp, Ln), (Pow10, Log10), (Square, Sqrt)];
        for (function, inverse) in pairs {
            for u in [0.1, 0.7, 1.3] {
                let back = value(inverse, value(function, u));
                assert!((back - u).abs() < 1e-14, "{inverse:?}({function:?}({u})) = {back}");
            }
        }
        assert_eq!(value(Reciprocal, value(Reciprocal, 8.0)), 8.0);
    }

    #[test]
    fn hyperbolic_functions_are_made_of_exponentials() {
        for u in [-2.0, -0.3, 0.0, 1.1] {
            let (plus, minus) = (f64::exp(u), f64::exp(-u));
            for (function, expected) in [
                (Sinh, (plus - minus) / 2.0),
                (Cosh, (plus + minus) / 2.0),
                (Tanh, (plus - minus) / (plus + minus)),
            ] {
                assert!((value(function, u) - expected).abs() < 1e-14, "{function:?}({u})");
            }
        }
    }

    #[test]
    fn the_signed_root_keeps_the_sign_and_guards_zero() {
        let inputs = vec![("u".to_owned(), PortType::vector(3))];
        let mut bench = Bench::with_inputs(Function { function: SignedSqrt }, inputs);
        assert_eq!(bench.set(0, &[-4.0, 0.0, 9.0]).major(), [-2.0, 0.0, 3.0]);
        assert_eq!(bench.guards(), [-4.0, 0.0, 9.0]);
    }

    #[test]
    fn units_follow_the_function() {
        let unit = |function, u| {
            let interface = Function { function }.interface(&given(&[("u", u)], &[]))?;
            Ok::<_, InterfaceError>(interface.outputs[0].port_type.dimension)
        };
        assert_eq!(unit(Sqrt, "m^2"), Ok(Some(dimension("m"))));
        assert_eq!(unit(Square, "V"), Ok(Some(dimension("V^2"))));
        assert_eq!(unit(Reciprocal, "s"), Ok(Some(dimension("1/s"))));
        assert_eq!(unit(Atan, "1"), Ok(Some(dimension("rad"))));
        assert_eq!(unit(Sin, "rad"), Ok(Some(Dimension::NONE)));
        assert_eq!(unit(Sqrt, "V").unwrap_err().code, "unit_mismatch");
    }

    #[test]
    fn angles_and_exponents_have_no_unit() {
        for function in [Sin, Atan, Exp, Ln, Tanh] {
            let interface = Function { function }.interface(&Given::nothing()).unwrap();
            assert_eq!(interface.inputs[0].dimension, Some(Dimension::NONE), "{function:?}");
        }
        assert_eq!(
            Function { function: Square }.interface(&Given::nothing()).unwrap().inputs[0].dimension,
            None
        );
    }

    #[test]
    fn where_a_function_is_not_defined_it_objects() {
        for (function, bad, good) in [
            (Asin, 1.000_1, 1.0),
            (Acos, -1.5, -1.0),
            (Ln, 0.0, 1e-300),
            (Log10, -1.0, 2.0),
            (Sqrt, -1e-300, 0.0),
            (Reciprocal, 0.0, -1e-3),
        ] {
            let fails = |u: f64| Bench::new(Function { function }).set(0, &[u]).failure();
            assert!(fails(bad).is_some(), "{function:?}({bad})");
            assert_eq!(fails(good), None, "{function:?}({good})");
        }
    }

    #[test]
    #[should_panic(expected = "Ln has no value at u = -2; u must be positive")]
    fn the_failure_names_function_and_value() {
        value(Ln, -2.0);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for function in [Sin, Asin, Ln, Sqrt, SignedSqrt, Reciprocal, Pow10] {
            assert!(value(function, f64::NAN).is_nan(), "{function:?}");
        }
    }
}
