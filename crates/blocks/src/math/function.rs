use blocksim_block::prelude::*;

/// An elementary function of each element: $y = f(u)$, or of two signals: $y = f(u_1, u_2)$.
///
/// `Mod` and `Rem` are remainders, $u_1 - u_2 \operatorname{floor}(u_1 / u_2)$ with the sign of $u_2$ and
/// $u_1 - u_2 \operatorname{trunc}(u_1 / u_2)$ with the sign of $u_1$; `Hypot` is $\sqrt{u_1^2 + u_2^2}$. These have both inputs
/// in one unit, which is that of the output. `Pow` is $u_1^{u_2}$ of plain numbers; a constant exponent, also with units, is `Power`.
///
/// `Floor`, `Ceil`, `Round` (halves away from zero) and `Trunc` (towards zero) make whole numbers of plain ones; `Quantizer` rounds
/// to multiples of a unit. What jumps is held in between and chosen anew where the solver stops, and it stops there.
///
/// Angles and arguments of exponentials have no unit (an angle in degrees is one in radians already). `Sqrt` and
/// `SignedSqrt` halve the exponents of a unit, `Square` doubles and `Reciprocal` inverts them. Where a function is
/// not defined (`Asin` and `Acos` beyond one, `Ln` and `Log10` of nothing positive, `Sqrt` of less than zero,
/// `Reciprocal` of zero, `Mod` and `Rem` by zero, `Pow` without a real value) the simulation stops with the value.
///
/// `SignedSqrt` is $\operatorname{sgn}(u) \sqrt{|u|}$; the solver steps onto its vertical tangent at zero.
///
/// ```ron
/// Function(function: Sqrt)
/// ```
/// ```ron
/// Function(function: Mod)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("function"))]
pub struct Function {
    /// Which one: `Sin`, `Cos`, `Tan`, `Asin`, `Acos`, `Atan`, `Sinh`, `Cosh`, `Tanh`, `Exp`, `Ln`, `Log10`,
    /// `Pow10`, `Sqrt`, `SignedSqrt`, `Square`, `Reciprocal`, `Floor`, `Ceil`, `Round` or `Trunc` of `u`; `Mod`, `Rem`, `Hypot` or
    /// `Pow` of `u1` and `u2`.
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
    /// Next whole number below.
    Floor,
    /// Next whole number above.
    Ceil,
    /// Nearest whole number, halves away from zero.
    Round,
    /// Next whole number towards zero.
    Trunc,
    /// Remainder with the sign of the second argument.
    Mod,
    /// Remainder with the sign of the first argument.
    Rem,
    /// Distance of a point from the origin.
    Hypot,
    /// First argument to the power of the second.
    Pow,
}

use FunctionName::{
    Acos, Asin, Atan, Ceil, Cos, Cosh, Exp, Floor, Hypot, Ln, Log10, Mod, Pow, Pow10, Reciprocal, Rem, Round,
    SignedSqrt, Sin, Sinh, Sqrt, Square, Tan, Tanh, Trunc,
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
            // Those below are functions of two signals, or jump.
            Floor | Ceil | Round | Trunc | Mod | Rem | Hypot | Pow => u,
        }
    }

    fn wants_plain_number(self) -> bool {
        !matches!(self, Sqrt | SignedSqrt | Square | Reciprocal | Mod | Rem | Hypot)
    }

    fn is_of_two(self) -> bool {
        matches!(self, Mod | Rem | Hypot | Pow)
    }

    fn jumps(self) -> bool {
        matches!(self, Floor | Ceil | Round | Trunc | Mod | Rem)
    }

    /// The whole number that belongs to a number, and from where to where the one that is `held` does.
    fn whole<'r>(self, q: Value<'r>, held: Value<'r>) -> (Value<'r>, [Value<'r>; 2]) {
        let zero = q.zero();
        let below = q.below();
        let above = -(-q).below();
        match self {
            Ceil => (above, [held - 1.0, held]),
            Round => (q.nearest(), [held - 0.5, held + 0.5]),
            Trunc | Rem => {
                let lower = held.live(Relation::Greater, zero).select(held, held - 1.0);
                let upper = held.live(Relation::Less, zero).select(held, held + 1.0);
                (q.live(Relation::Less, zero).select(above, below), [lower, upper])
            }
            _ => (below, [held, held + 1.0]),
        }
    }
}

/// What another whole number is called.
const STEPS: &[Change] = &[Change::any("steps")];

impl Function {
    /// Two inputs, or one that is rounded.
    fn interface_of_two_or_whole(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names: &[&str] = if self.function.is_of_two() { &["u1", "u2"] } else { &["u"] };
        let plain = self.function.wants_plain_number();
        let dimension = if plain { Some(Dimension::NONE) } else { given.common_dimension(names)? };
        let shape = given.common_shape(names, &[])?;
        let input = |name: &&str| {
            let input = Input::real(*name);
            if plain { input.dimension(Some(Dimension::NONE)) } else { input }
        };
        let interface = names.iter().map(input).fold(Interface::new(), Interface::input);
        let y = PortType { kind: Kind::Real, shape, dimension };
        let interface = interface.output(Output::like("y", y));
        if !self.function.jumps() {
            return Ok(interface);
        }
        let n = shape.len();
        let interface = interface.modes("whole", n, 0.0, STEPS);
        Ok(interface.guard_each_when(Crossing::Holds, "whole", n).called_by_mode())
    }

    fn law_of_two_or_whole(&self, l: &Recording) {
        for i in 0..l.width(0) {
            let u = l.element(0, i);
            let other = if self.function.is_of_two() { l.element(1, i) } else { u };
            match self.function {
                Hypot => l.set(0, i, u.hypot(other)),
                Pow => l.set(0, i, u.pow(other)),
                function => {
                    let q = if function.is_of_two() { u / other } else { u };
                    let held = l.d()[i];
                    let (whole, [lower, upper]) = function.whole(q, held);
                    // What is not a number stays so.
                    l.settle(i, whole);
                    l.guard(i, (q - lower).min(upper - q));
                    l.set(0, i, if function.is_of_two() { u - other * held } else { held });
                }
            }
        }
    }
}

impl Block for Function {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        if self.function.is_of_two() || self.function.jumps() {
            return self.interface_of_two_or_whole(given);
        }
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
        if self.function.is_of_two() || self.function.jumps() {
            self.law_of_two_or_whole(l);
            return true;
        }
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
        match self.function {
            Mod | Rem => {
                return Some(format!("{:?} divides by zero: keep `u2` away from zero", self.function));
            }
            Pow => return Some(format!("Pow has no real value at u1 = {u}: make `u1` positive")),
            _ => {}
        }
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

    #[test]
    fn whole_numbers_are_those_of_the_table() {
        // Floor, Ceil, Round, Trunc.
        for (u, expected) in [
            (2.5, [2.0, 3.0, 3.0, 2.0]),
            (-2.5, [-3.0, -2.0, -3.0, -2.0]),
            (0.4, [0.0, 1.0, 0.0, 0.0]),
            (-0.4, [-1.0, 0.0, 0.0, 0.0]),
            (3.0, [3.0; 4]),
            (-3.0, [-3.0; 4]),
            (0.499_999_999_999_999_94, [0.0, 1.0, 0.0, 0.0]),
        ] {
            for (function, expected) in [Floor, Ceil, Round, Trunc].into_iter().zip(expected) {
                let mut bench = Bench::new(Function { function });
                assert_eq!(bench.respond(u), expected, "{function:?}({u})");
                assert!(bench.guards()[0] >= 0.0, "{function:?}({u}) holds");
                for step in [-2.1, -1.1, 0.3, 1.1] {
                    let other = value(function, u + step) != expected;
                    let left = bench.set(0, &[u + step]).guards()[0];
                    assert_eq!(left < 0.0, other, "{function:?} at {u} + {step}");
                }
            }
        }
    }

    #[test]
    fn functions_of_two_signals_are_those_of_the_standard_library() {
        for (a, b) in [(7.5, 2.0), (-7.5, 2.0), (7.5, -2.0), (-7.5, -2.0), (0.3, 4.0), (6.0, 3.0)] {
            let of = |function| Bench::new(Function { function }).set(0, &[a]).set(1, &[b]).major()[0];
            let modulo: f64 = ((a % b) + b) % b;
            assert!((of(Mod) - modulo).abs() < 1e-14, "{a} mod {b}");
            assert!((of(Rem) - a % b).abs() < 1e-14, "{a} rem {b}");
            assert_eq!(of(Hypot), f64::hypot(a, b));
            if a > 0.0 {
                assert_eq!(of(Pow), a.powf(b));
            }
        }
        let mut bench = Bench::new(Function { function: Hypot });
        let mut pow = Bench::new(Function { function: Pow });
        assert_eq!(bench.set(0, &[3.0]).set(1, &[4.0]).major(), [5.0]);
        assert!(pow.set(0, &[-1.0]).set(1, &[0.5]).failure().unwrap().contains("no real value at u1 = -1"));
    }

    #[test]
    fn units_of_two_signals_agree_or_there_are_none() {
        let interface =
            |function, a, b| Function { function }.interface(&given(&[("u1", a), ("u2", b)], &[]));
        let unit = interface(Mod, "deg", "rad").unwrap().outputs[0].port_type.dimension;
        assert_eq!(unit, Some(dimension("rad")));
        assert_eq!(interface(Hypot, "m", "m").unwrap().outputs[0].port_type.dimension, Some(dimension("m")));
        assert_eq!(interface(Hypot, "m", "s").unwrap_err().code, "unit_mismatch");
        assert_eq!(interface(Pow, "m", "1").unwrap().inputs[0].dimension, Some(Dimension::NONE));
    }
}
