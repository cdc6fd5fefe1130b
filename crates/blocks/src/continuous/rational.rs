//! A ratio of polynomials, in s or in z, as a row of states.

use blocksim_block::prelude::*;

/// $b(s) / a(s)$ in controllable canonical form (direct form II): with
/// $a = s^n + a_1 s^{n-1} + \dots + a_n$ and $b = b_0 s^n + \dots + b_n$
///
/// $$ w = u - \sum_{i=1}^n a_i x_i, \qquad y = b_0 u + \sum_{i=1}^n (b_i - a_i b_0) x_i $$
///
/// where $w$ drives the first state and each state the next. Coefficients are read as they were written, in
/// descending powers, so that evaluating does not allocate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rational<'a> {
    num: &'a [f64],
    den: &'a [f64],
}

impl<'a> Rational<'a> {
    /// From coefficients in descending powers; zeros in front of the numerator do not count, and an empty
    /// denominator counts as 1 (`check` refuses it).
    pub(crate) fn new(num: &'a [f64], den: &'a [f64]) -> Self {
        let zeros = num.iter().take_while(|b| **b == 0.0).count();
        Self { num: &num[zeros..], den: if den.is_empty() { &[1.0] } else { den } }
    }

    /// Reports coefficients that make no proper ratio: a leading zero in `den`, or more powers in `num` than in `den`.
    pub(crate) fn validate(num: &[f64], den: &[f64], variable: char, errors: &mut ParamErrors) {
        if den.first() == Some(&0.0) {
            errors.add(
                ParamError::new("den[0]", "the first coefficient of `den` is 0")
                    .help("leave out the zeros in front: coefficients are in descending powers"),
            );
        }
        let ratio = Rational::new(num, den);
        let (degree, order) = (ratio.num.len().saturating_sub(1), ratio.order());
        if degree > order {
            let message = format!(
                "`num` has degree {degree} in {variable}, but `den` only {order}: such a block would have to \
                 know the future"
            );
            let error = ParamError::new("num", message).beside(&["den"]);
            errors.add(error.help("give `den` at least as many coefficients as `num`"));
        }
    }

    /// Number of states.
    pub(crate) fn order(&self) -> usize {
        self.den.len() - 1
    }

    /// Factor from the input straight to the output.
    pub(crate) fn feedthrough(&self) -> f64 {
        self.numerator(0)
    }

    /// $b_i$, after division by the leading coefficient of the denominator.
    fn numerator(&self, i: usize) -> f64 {
        let zeros = self.den.len().saturating_sub(self.num.len());
        if i < zeros { 0.0 } else { self.num[i - zeros] / self.den[0] }
    }

    /// $a_i$, after division by the leading coefficient.
    fn denominator(&self, i: usize) -> f64 {
        self.den[i] / self.den[0]
    }

    /// What drives the first state, where state i counts from 1 and is `pace`^i times that of the canonical form.
    pub(crate) fn drive<'r>(&self, x: &[Value<'r>], u: Value<'r>, pace: f64) -> Value<'r> {
        let (mut w, mut share) = (u, 1.0);
        for (i, x) in x.iter().enumerate() {
            share /= pace;
            let a = self.denominator(i + 1) * share;
            if a != 0.0 {
                w = w - a * *x;
            }
        }
        w
    }

    /// The output from the same states. `u` is not looked at unless there is feedthrough.
    pub(crate) fn output<'r>(
        &self,
        l: &Recording<'r>,
        x: &[Value<'r>],
        u: Value<'r>,
        pace: f64,
    ) -> Value<'r> {
        let b0 = self.feedthrough();
        let mut share = 1.0;
        let factors: Vec<f64> = (1..=x.len())
            .map(|i| {
                share /= pace;
                (self.numerator(i) - self.denominator(i) * b0) * share
            })
            .collect();
        let free = l.dot(&factors, x);
        if b0 == 0.0 { free } else { b0 * u + free }
    }

    /// A power of two near the largest magnitude of the poles, 1/s: the largest of $|a_i|^{1/i}$, of exponents
    /// alone. Counted in this time the coefficients are near one, and so all states have the size of the signals.
    pub(crate) fn pace(&self) -> f64 {
        let exponent = |a: f64| ((a.abs().to_bits() >> 52) as i32) - 1023;
        let lead = exponent(self.den[0]);
        let of = |(i, a): (usize, &f64)| (*a != 0.0).then(|| (exponent(*a) - lead).div_euclid(i as i32));
        let largest = self.den.iter().enumerate().skip(1).filter_map(of).max();
        // Powers of the pace must stay numbers.
        let bound = 900 / self.den.len() as i32;
        2f64.powi(largest.unwrap_or(0).clamp(-bound, bound))
    }

    /// Input, output and as many states per element as the ratio asks for. The unit of the output is that of the
    /// input times that of the factor `k`; unknown if `k` was not written, for the coefficients have units of
    /// their own.
    pub(crate) fn interface(&self, given: &Given, x0: f64) -> Interface {
        let u = given.input_or_unknown("u");
        let dimension = given.parameters.find("k").zip(u.dimension).map(|(k, u)| u.times(k));
        let y = Output::like("y", u.of(dimension));
        let mut interface = Interface::new().input(Input::real("u"));
        interface =
            if self.feedthrough() == 0.0 { interface.output_from_state(y) } else { interface.output(y) };
        interface.states = (0..u.shape.len() * self.order())
            .map(|i| State::new(format!("x{}", i % self.order() + 1), x0))
            .collect();
        interface
    }
}
