use blocksim_block::prelude::*;

use super::method::Method;
use crate::continuous::pid_law::{AntiWindup, PidLaw};
use crate::continuous::reset::{Reset, UNSEEN};

/// Sampled PID controller with filtered derivative, limits and protection against windup.
///
/// The law of `Pid` with $1/s$ replaced by a sum, for the integral part and for the filter each by its own method:
///
/// $$ v_k = k_p e_k + x_i + \alpha_i T_s w_k + y_d, \qquad w_k = k_i e_k + a, \qquad
///    y_d = \frac{n (k_d e_k - x_f)}{1 + \alpha_f n T_s}, \qquad u = \operatorname{sat}(v) $$
/// $$ x_i \leftarrow x_i + T_s w_k, \qquad x_f \leftarrow x_f + T_s y_d $$
///
/// with $\alpha = 0$ for `ForwardEuler`, 1 for `BackwardEuler`, 1/2 for `Trapezoidal`. With `form: Ideal`, `kp`
/// multiplies all parts. `BackCalculation` adds $a = k_b (u - v)$, solved together with $v$; `Clamping` leaves
/// $x_i$ as it is while $v$ is outside the limits and $k_i e$ would lead further out. With `ForwardEuler` the filter is
/// stable only for $n < 2 / T_s$. The unit of the output is that of the input times that of `kp`. Vectors are
/// controlled element by element. Direct feedthrough.
///
/// ```ron
/// DiscretePid(ts: "1 ms", kp: 8.0, ki: 2.0, kd: 0.4, lower: -1.0, upper: 1.0, anti_windup: Clamping)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("PID(z)"))]
pub struct DiscretePid {
    /// Sample time $T_s$, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Gains, limits and start values.
    #[block(group)]
    pub law: PidLaw,
    /// Method of the integral part: `ForwardEuler`, `BackwardEuler`, `Trapezoidal`.
    #[block(default = Method::ForwardEuler)]
    pub integrator: Method,
    /// Method of the derivative filter: `ForwardEuler`, `BackwardEuler`, `Trapezoidal`.
    #[block(default = Method::ForwardEuler)]
    pub filter: Method,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the integral part back
    /// to `x0` and the filter to `d0`: `None` (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is
    /// done at each sample at which the input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

/// One sample: the output, and what the states grow by, over the sample time.
struct Sample<'r> {
    u: Value<'r>,
    w: Value<'r>,
    derivative: Value<'r>,
}

impl DiscretePid {
    /// Whether the filter of the derivative does anything. Where it does not, it may be unstable, and its state stays zero.
    fn filters(&self) -> bool {
        self.law.kd != 0.0 || self.law.d0 != 0.0
    }

    /// Of element `i`, from the error and the states of the integral part and of the filter.
    fn sample<'r>(&self, l: &Recording<'r>, i: usize, e: Value<'r>, [xi, xf]: [Value<'r>; 2]) -> Sample<'r> {
        let (law, limits) = (&self.law, self.law.limits(l, i));
        let at_once = self.integrator.share() * self.ts;
        let derivative = match self.filters() {
            true => self.law.n * (self.law.kd * e - xf) / (1.0 + self.filter.share() * self.law.n * self.ts),
            false => l.constant(0.0),
        };
        let free = self.law.ki * e;
        let v = law.sum(e, xi + at_once * free, derivative);
        let w = match self.law.anti_windup {
            // Without integral gain there is nothing that could wind up.
            _ if self.law.ki == 0.0 => l.constant(0.0),
            AntiWindup::None => free,
            AntiWindup::Clamping => {
                law.winds_up(l, limits, v, e, l.constant(0.0)).is_true().select(l.constant(0.0), free)
            }
            // a = kb (u - v_a) with v_a = v + p at_once a. The correction is never so large that v_a would come
            // inside the limits, therefore u = sat(v) for both.
            AntiWindup::BackCalculation => {
                let loop_gain = self.law.kb * law.per_integral() * at_once;
                free + self.law.kb * (limits.saturate(v) - v) / (1.0 + loop_gain)
            }
        };
        // Where clamping holds the integral part, `v` stays beyond the limit, or the output would come back from it.
        let v = match law.anti_windup {
            AntiWindup::Clamping => v,
            AntiWindup::None | AntiWindup::BackCalculation => law.sum(e, xi + at_once * w, derivative),
        };
        Sample { u: limits.saturate(v), w, derivative }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.filter == Method::ForwardEuler && self.filters() && self.law.n * self.ts >= 2.0 {
            let (n, limit) = (self.law.n, 2.0 / self.ts);
            let message = format!("`n` is {n}, but the filter is stable only below 2 / ts = {limit}");
            let help = "choose a smaller `n` or `ts`, or `filter: BackwardEuler` or `Trapezoidal`";
            errors.add(ParamError::new("n", message).beside(&["ts"]).help(help));
        }
    }
}

impl Block for DiscretePid {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let e = given.input_or_unknown("e");
        let dimension = self.law.dimension(given)?;
        let mut interface = Interface::new().input(Input::real("e").doc("Set value minus actual value."));
        interface = interface.output(Output::like("u", e.of(dimension))).sampled(self.ts);
        for _ in 0..e.shape.len() {
            interface = interface.discrete("integral", self.law.x0).discrete("filter", self.law.d0);
        }
        if let Some(reset) = self.reset.input() {
            interface = interface.input(reset).discrete("trigger", UNSEEN);
        }
        Ok(self.law.inputs_of_limits(interface, dimension))
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        self.law.no_value(c)
    }

    fn law(&self, l: &Recording) -> bool {
        let all = 2 * l.width(0);
        let fires = self.reset.sampled(l, all, 1);
        let start = |x0: f64, x| fires.map_or(x, |(fires, _)| fires.select(l.constant(x0), x));
        for i in 0..l.width(0) {
            let (xi, xf) = (start(self.law.x0, l.d()[2 * i]), start(self.law.d0, l.d()[2 * i + 1]));
            let Sample { u, w, derivative } = self.sample(l, i, l.element(0, i), [xi, xf]);
            l.set(0, i, u);
            l.update(2 * i, xi + self.ts * w);
            l.update(2 * i + 1, if self.filters() { xf + self.ts * derivative } else { l.constant(0.0) });
        }
        fires.into_iter().for_each(|(_, next)| l.update(all, next));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::Form;
    use crate::continuous::units::testing::{interface_with, output_unit, vector};
    use blocksim_block::testing::Bench;

    const METHODS: [Method; 3] = [Method::ForwardEuler, Method::BackwardEuler, Method::Trapezoidal];

    const LAW: PidLaw = PidLaw {
        kp: 2.0,
        ki: 3.0,
        kd: 0.5,
        n: 50.0,
        form: Form::Parallel,
        lower: None,
        upper: None,
        external_limits: false,
        anti_windup: AntiWindup::None,
        kb: 1.0,
        x0: 0.0,
        d0: 0.0,
    };

    fn pid(method: Method) -> DiscretePid {
        DiscretePid { ts: 0.01, law: LAW, integrator: method, filter: method, reset: Reset::None }
    }

    fn limited(method: Method, anti_windup: AntiWindup) -> DiscretePid {
        let law = PidLaw { kd: 0.0, lower: Some(-1.0), upper: Some(1.0), anti_windup, ..LAW };
        DiscretePid { law, ..pid(method) }
    }

    #[test]
    fn the_first_outputs_match_the_reference_values() {
        let expected = [
            [27.0, 14.53, 8.31, 5.215, 3.6825],
            [18.696667, 13.171111, 9.497407, 7.058272, 5.442181],
            [22.015, 14.045, 9.275, 6.425, 4.727],
        ];
        for (method, expected) in METHODS.into_iter().zip(expected) {
            let mut bench = Bench::new(pid(method));
            for u in expected {
                let actual = bench.set(0, &[1.0]).hit()[0];
                // The reference values are rounded to six decimals.
                assert!((actual - u).abs() < 6e-7, "{method:?}: {actual} != {u}");
            }
        }
    }

    #[test]
    fn the_methods_of_integral_part_and_filter_are_independent() {
        let mut bench =
            Bench::new(DiscretePid { integrator: Method::BackwardEuler, ..pid(Method::ForwardEuler) });
        assert!((bench.respond(1.0) - 27.03).abs() < 1e-12);
    }

    #[test]
    fn in_the_ideal_form_kp_multiplies_all_parts() {
        let mut bench = Bench::new(DiscretePid {
            law: PidLaw { form: Form::Ideal, ..LAW },
            ..pid(Method::BackwardEuler)
        });
        let expected = 2.0 * (1.0 + 0.03 + 25.0 / 1.5);
        assert!((bench.respond(1.0) - expected).abs() < 1e-12);
    }

    #[test]
    fn clamping_stops_the_integral_part_only_on_the_way_out() {
        for method in METHODS {
            let mut bench = Bench::with_inputs(limited(method, AntiWindup::Clamping), vector("e", 2));
            bench.set(0, &[1.0, -1.0]);
            (0..100).for_each(|_| drop(bench.hit()));
            assert_eq!((bench.hit(), bench.d[0], bench.d[2]), (vec![1.0, -1.0], 0.0, 0.0));
            bench.d[0] = 4.0;
            bench.set(0, &[-1.0, -1.0]).hit();
            assert!((bench.d[0] - 3.97).abs() < 1e-15);
        }
    }

    #[test]
    fn what_is_clamped_has_reached_its_limit() {
        for method in METHODS {
            let law =
                PidLaw { kp: 0.0, ki: 100.0, upper: Some(1.2), ..limited(method, AntiWindup::Clamping).law };
            let mut bench = Bench::new(DiscretePid { ts: 2.5e-3, law, ..pid(method) });
            (0..20).for_each(|_| drop(bench.set(0, &[1.0]).hit()));
            assert_eq!(bench.hit(), [1.2], "{method:?}");
            // Back from the limit at the first sample of the other sign; what was held is less than a step beyond it.
            let held = bench.d[0];
            assert!((1.0 - 1e-12..1.2 + 0.25).contains(&held));
            let expected = held - 0.25 * method.share();
            assert!((bench.set(0, &[-1.0]).hit()[0] - expected.min(1.2)).abs() < 1e-12, "{method:?}");
        }
    }

    #[test]
    fn without_protection_the_integral_part_winds_up() {
        let mut bench = Bench::new(limited(Method::ForwardEuler, AntiWindup::None));
        (0..100).for_each(|_| drop(bench.set(0, &[1.0]).hit()));
        assert!((bench.d[0] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn back_calculation_satisfies_its_own_equation_and_settles_in_balance() {
        for method in METHODS {
            for form in [Form::Parallel, Form::Ideal] {
                let limited = limited(method, AntiWindup::BackCalculation);
                let block = DiscretePid { law: PidLaw { kb: 20.0, form, ..limited.law }, ..limited };
                let mut bench = Bench::new(block.clone());
                for _ in 0..3000 {
                    let (xi, e) = (bench.d[0], 1.0);
                    bench.set(0, &[e]).hit();
                    let w = (bench.d[0] - xi) / block.ts;
                    let v = block.law.sum(e, xi + method.share() * block.ts * w, 0.0);
                    assert!((w - (3.0 * e + 20.0 * (v.clamp(-1.0, 1.0) - v))).abs() < 1e-11);
                }
                // ki e = kb (v - upper).
                let v = block.law.sum(1.0, bench.d[0], 0.0);
                assert!((v - 1.15).abs() < 1e-12, "{method:?} {form:?}: {v}");
            }
        }
    }

    #[test]
    fn a_filter_that_would_be_unstable_is_refused() {
        let block = DiscretePid { law: PidLaw { n: 200.0, ..LAW }, ..pid(Method::ForwardEuler) };
        let error = block.errors()[0].clone();
        assert_eq!(error.param, "n");
        assert!(error.help.unwrap().contains("BackwardEuler"));
        let without_d = PidLaw { kd: 0.0, ..block.law };
        assert!(DiscretePid { law: without_d, ..block.clone() }.errors().is_empty());
        for method in [Method::BackwardEuler, Method::Trapezoidal] {
            assert!(DiscretePid { filter: method, ..block.clone() }.errors().is_empty());
        }
    }

    #[test]
    fn the_unit_is_that_of_the_input_times_that_of_kp() {
        let block = pid(Method::ForwardEuler);
        assert_eq!(output_unit(&block, &[("e", "rad")], &[("kp", "V/rad")]), "V");
        assert!(interface_with(&block, &[("e", "rad")], &[("kp", "V"), ("ki", "V")]).is_err());
    }

    #[test]
    fn parameters_that_make_no_controller_are_refused() {
        let kp = DiscretePid { law: PidLaw { kp: f64::NAN, ..LAW }, ..pid(Method::ForwardEuler) };
        assert_eq!(kp.errors()[0].param, "kp");
        let ts = DiscretePid { ts: 0.0, ..pid(Method::ForwardEuler) };
        assert_eq!(ts.errors()[0].param, "ts");
    }
}
