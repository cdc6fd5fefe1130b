use blocksim_block::prelude::*;

use super::method::Method;
use crate::continuous::reset::{Reset, UNSEEN};
use crate::continuous::units::{SECOND, agrees, agrees_as_written};
use crate::math::Entries;

/// Sums up samples as an integral, element by element.
///
/// | method | output | next state |
/// |---|---|---|
/// | `ForwardEuler` | $y_k = x_k$ | $x_{k+1} = x_k + K T_s u_k$ |
/// | `BackwardEuler` | $y_k = x_k + K T_s u_k$ | $x_{k+1} = y_k$ |
/// | `Trapezoidal` | $y_k = x_k + \tfrac{1}{2} K T_s u_k$ | $x_{k+1} = y_k + \tfrac{1}{2} K T_s u_k$ |
///
/// With `reset` an edge of the extra input `reset` makes $x_k = x_0$ before the output of this sample.
///
/// With limits the output and the state stay within them. The unit of the output is that of the input times that
/// of `gain` times s. Direct feedthrough except with `ForwardEuler`, which breaks an algebraic loop.
///
/// ```ron
/// DiscreteIntegrator(ts: "1 ms", method: Trapezoidal, lower: -1.0, upper: 1.0)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Fraction("T","z − 1"))]
pub struct DiscreteIntegrator {
    /// Sample time $T_s$, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// `ForwardEuler`, `BackwardEuler` or `Trapezoidal`.
    #[block(default = Method::ForwardEuler)]
    pub method: Method,
    /// Factor $K$.
    #[block(difference, finite, default = 1.0)]
    pub gain: f64,
    /// State at the start. A list gives each element its own.
    #[block(finite, at_least = lower, at_most = upper, default = 0.0.into())]
    pub x0: Entries,
    /// Lower limit of the output.
    #[block(below = f64::INFINITY, default = None)]
    pub lower: Option<f64>,
    /// Upper limit of the output.
    #[block(above = f64::NEG_INFINITY, above = lower, default = None)]
    pub upper: Option<f64>,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the state back: `None`
    /// (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is set back at each sample at which the
    /// input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

impl DiscreteIntegrator {
    fn lower(&self) -> f64 {
        self.lower.unwrap_or(f64::NEG_INFINITY)
    }

    fn upper(&self) -> f64 {
        self.upper.unwrap_or(f64::INFINITY)
    }

    /// `x` plus a share of the sample, within the limits.
    fn advanced<'r>(&self, l: &Recording<'r>, x: Value<'r>, share: f64, u: Value<'r>) -> Value<'r> {
        let sum = if share == 0.0 { x } else { x + share * self.gain * self.ts * u };
        sum.clamp(l.constant(self.lower()), l.constant(self.upper()))
    }
}

impl Block for DiscreteIntegrator {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = u.dimension.map(|u| u.times(given.parameters.get("gain")).times(SECOND));
        agrees_as_written(self.x0.written(given, "x0"), "x0", "u", dimension)?;
        for parameter in ["lower", "upper"] {
            agrees(given, parameter, "u", dimension)?;
        }
        let shape = given.common_shape(&["u"], &[self.x0.shape])?;
        let y = Output::like("y", u.of(dimension).shaped(shape));
        let interface = Interface::new().input(Input::real("u"));
        let interface = self.reset.input().into_iter().fold(interface, Interface::input).output(y);
        let interface =
            (0..shape.len()).fold(interface, |all, i| all.discrete(format!("x[{i}]"), self.x0.at(i)));
        let interface =
            if self.reset == Reset::None { interface } else { interface.discrete("trigger", UNSEEN) };
        Ok(interface.sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let (share, n) = (self.method.share(), l.width(0));
        let fires = self.reset.sampled(l, n, 1);
        for i in 0..n {
            let (u, x) = (l.element(0, i), l.d()[i]);
            let x = fires.map_or(x, |(fires, _)| fires.select(l.constant(self.x0.at(i)), x));
            let y = self.advanced(l, x, share, u);
            l.set(0, i, y);
            l.update(i, self.advanced(l, y, 1.0 - share, u));
        }
        fires.into_iter().for_each(|(_, next)| l.update(n, next));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{interface_with, output_unit, vector};
    use blocksim_block::testing::Bench;

    fn block(method: Method) -> DiscreteIntegrator {
        DiscreteIntegrator {
            ts: 0.5,
            method,
            gain: 2.0,
            x0: 1.0.into(),
            lower: None,
            upper: None,
            reset: Reset::None,
        }
    }

    #[test]
    fn the_methods_give_the_sums_of_the_table() {
        // K Ts = 1 and u = 1, 2, 3, 4.
        for (method, expected) in [
            (Method::ForwardEuler, [1.0, 2.0, 4.0, 7.0]),
            (Method::BackwardEuler, [2.0, 4.0, 7.0, 11.0]),
            (Method::Trapezoidal, [1.5, 3.0, 5.5, 9.0]),
        ] {
            let mut bench = Bench::new(block(method));
            for (k, y) in expected.into_iter().enumerate() {
                assert_eq!(bench.set(0, &[k as f64 + 1.0]).hit(), [y], "{method:?} at {k}");
            }
        }
    }

    #[test]
    fn only_forward_euler_breaks_loops() {
        for (method, reads) in
            [(Method::ForwardEuler, false), (Method::BackwardEuler, true), (Method::Trapezoidal, true)]
        {
            assert_eq!(Bench::new(block(method)).interface.reads(0, 0), reads);
        }
    }

    #[test]
    fn at_a_limit_nothing_winds_up() {
        for method in [Method::ForwardEuler, Method::BackwardEuler, Method::Trapezoidal] {
            let limited = DiscreteIntegrator { lower: Some(-3.0), upper: Some(3.0), ..block(method) };
            let mut bench = Bench::with_inputs(limited, vector("u", 2));
            bench.set(0, &[1.0, -1.0]);
            (0..50).for_each(|_| drop(bench.hit()));
            assert_eq!(bench.hit(), [3.0, -3.0]);
            bench.set(0, &[-1.0, 1.0]).hit();
            bench.hit();
            assert!(bench.d[0] <= 1.0 && bench.d[1] >= -1.0, "{method:?}");
        }
    }

    #[test]
    fn the_unit_is_that_of_the_input_times_gain_times_seconds() {
        let block = block(Method::ForwardEuler);
        assert_eq!(output_unit(&block, &[("u", "m/s")], &[]), "m");
        assert_eq!(output_unit(&block, &[("u", "A")], &[("gain", "V/C")]), "V");
        assert!(interface_with(&block, &[("u", "m/s")], &[("x0", "A")]).is_err());
    }

    #[test]
    fn crossed_limits_are_refused() {
        let block = DiscreteIntegrator { lower: Some(1.0), upper: Some(0.0), ..block(Method::ForwardEuler) };
        assert_eq!(block.errors()[0].param, "upper");
    }

    #[test]
    fn after_a_reset_the_sum_begins_anew_from_this_sample_on() {
        for method in [Method::ForwardEuler, Method::BackwardEuler, Method::Trapezoidal] {
            let inputs =
                vec![("u".to_owned(), PortType::vector(2)), ("reset".to_owned(), PortType::scalar())];
            let x0 = Entries::try_from(vec![1.0, -1.0]).unwrap();
            let with_reset = DiscreteIntegrator { x0: x0.clone(), reset: Reset::Rising, ..block(method) };
            let mut bench = Bench::with_inputs(with_reset, inputs);
            let mut anew = Bench::with_inputs(DiscreteIntegrator { x0, ..block(method) }, vector("u", 2));
            for k in 0..12 {
                // A reset at sample 5.
                if k == 5 {
                    let x0 = Entries::try_from(vec![1.0, -1.0]).unwrap();
                    anew = Bench::with_inputs(DiscreteIntegrator { x0, ..block(method) }, vector("u", 2));
                }
                let u = [f64::from(k), f64::from(k * k) - 3.0];
                let reset = if k >= 5 { 1.0 } else { -1.0 };
                assert_eq!(
                    bench.set(0, &u).set(1, &[reset]).hit(),
                    anew.set(0, &u).hit(),
                    "{method:?} at {k}"
                );
            }
        }
    }
}
