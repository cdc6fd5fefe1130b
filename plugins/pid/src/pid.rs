use blocksim_controller::prelude::*;

/// Discrete PID controller, parallel form, with filtered derivative, limits and clamping.
///
/// All of it is one sampled law with the weight θ of the new value in the integration:
///
/// - integral: `i(k) = x(k) + θ Ts r`, `x(k+1) = x(k) + Ts r`, `r = ki e`
/// - derivative: `d(k) = n (kd e - x_f(k)) / (1 + θ n Ts)`, `x_f(k+1) = x_f(k) + Ts d(k)`
/// - output: `v = kp e + i + d`, `u = v` limited to lower..upper
///
/// θ = 0 is forward Euler, 1/2 trapezoidal, 1 backward Euler: `1/s` becomes `Ts/(z-1)`,
/// `Ts/2 (z+1)/(z-1)`, `Ts z/(z-1)`. While `v` is beyond a limit and `ki e` pushes further, `x` is frozen.
///
/// Source: Åström and Murray, Feedback Systems, chapter "PID Control": filtered derivative, discretisation,
/// windup. Clamping is conditional integration.
#[derive(Debug)]
pub struct Pid;

const KP: Parameter = Parameter::new(0, "kp", "", "Proportional gain, unit of u per unit of e.").or(&[1.0]);
const KI: Parameter = Parameter::new(1, "ki", "", "Integral gain, that of kp per second.").or(&[1.0]);
const KD: Parameter = Parameter::new(2, "kd", "", "Derivative gain, that of kp times seconds.").or(&[0.0]);
const N: Parameter = Parameter::new(3, "n", "1/s", "Corner of the derivative filter.").or(&[100.0]);
const TS: Parameter = Parameter::new(4, "ts", "s", "Sample time.");
const LOWER: Parameter = Parameter::new(5, "lower", "", "Lower limit of u.").or(&[f64::NEG_INFINITY]);
const UPPER: Parameter = Parameter::new(6, "upper", "", "Upper limit of u.").or(&[f64::INFINITY]);
const THETA: Parameter =
    Parameter::new(7, "theta", "1", "Integration: 0 forward Euler, 0.5 trapezoidal, 1 backward Euler.")
        .or(&[0.0]);
const I0: Parameter = Parameter::new(8, "i0", "", "Integral part of u at the start.").or(&[0.0]);

const E: Input = Input::new(0, "e", "", "Error: set value minus actual value.");
const U: Output = Output::new(0, "u", "", "Controlled value, limited.").reads(&[E]);

const INTEGRAL: Discrete = Discrete::new(0, "integral", "", "Integral part x.");
const FILTER: Discrete = Discrete::new(1, "filter", "", "State x_f of the derivative filter.");

/// Parts of the law at one sample.
struct Parts {
    /// Derivative part of the output.
    d: f64,
    /// Output before the limits.
    v: f64,
    /// Output.
    u: f64,
}

fn law(c: &Context) -> Parts {
    let i = c[INTEGRAL] + c[THETA] * c[TS] * c[KI] * c[E];
    let d = c[N] * (c[KD] * c[E] - c[FILTER]) / (1.0 + c[THETA] * c[N] * c[TS]);
    let v = c[KP] * c[E] + i + d;
    Parts { d, v, u: v.clamp(c[LOWER], c[UPPER]) }
}

impl Controller for Pid {
    const KIND: &'static str = "Pid";
    const DOC: &'static str = include_str!("../README.md");
    const PARAMETERS: &'static [Parameter] = &[KP, KI, KD, N, TS, LOWER, UPPER, THETA, I0];
    const INPUTS: &'static [Input] = &[E];
    const OUTPUTS: &'static [Output] = &[U];
    const DISCRETE: &'static [Discrete] = &[INTEGRAL, FILTER];

    fn check(p: &Parameters) -> Outcome {
        for k in [KP, KI, KD, I0] {
            if !p[k].is_finite() {
                return Err(format!("a gain or start value is {}, it must be finite", p[k]));
            }
        }
        let ts = p[TS];
        if !(ts > 0.0 && ts.is_finite()) {
            return Err(format!("`ts` is {ts} s, it must be positive"));
        }
        if !(p[N] >= 0.0 && p[N].is_finite()) {
            return Err(format!("`n` is {} 1/s, it must not be negative", p[N]));
        }
        if !(0.0..=1.0).contains(&p[THETA]) {
            return Err(format!("`theta` is {}, it must be within 0 and 1", p[THETA]));
        }
        if p[LOWER].is_nan() || p[UPPER].is_nan() || p[LOWER] > p[UPPER] {
            return Err(format!("`lower` is {} and `upper` is {}: lower <= upper", p[LOWER], p[UPPER]));
        }
        // The filter's pole 1 - n Ts / (1 + θ n Ts) must be inside the unit circle.
        if p[KD] != 0.0 && p[N] * ts * (1.0 - 2.0 * p[THETA]) >= 2.0 {
            let limit = 2.0 / (ts * (1.0 - 2.0 * p[THETA]));
            return Err(format!(
                "`n` is {} 1/s: the derivative filter is stable below {limit} 1/s with this `ts` and `theta` \
                 only; lower `n` or take theta = 1",
                p[N]
            ));
        }
        Ok(())
    }

    fn sample_time(p: &Parameters) -> f64 {
        p[TS]
    }

    fn reset(p: &Parameters, _x: &mut ContinuousStates, xd: &mut DiscreteStates) -> Outcome {
        xd[INTEGRAL] = p[I0];
        Ok(())
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        y[U] = law(c).u;
        Ok(())
    }

    fn update(c: &Context, next: &mut DiscreteStates) -> Outcome {
        let Parts { d, v, u } = law(c);
        let rate = c[KI] * c[E];
        let pushes_further = (v - u) * rate > 0.0;
        if !pushes_further {
            next[INTEGRAL] = c[INTEGRAL] + c[TS] * rate;
        }
        next[FILTER] = c[FILTER] + c[TS] * d;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use blocksim_controller::testing::Bench;

    /// The example with closed-form outputs: unit step of the error.
    fn oracle(theta: f64) -> Bench {
        let parameters = [("kp", 2.0), ("ki", 3.0), ("kd", 0.5), ("n", 50.0), ("ts", 0.01), ("theta", theta)];
        Bench::new(crate::table(), "Pid", &parameters).unwrap()
    }

    fn refused(parameters: &[(&str, f64)]) -> String {
        Bench::new(crate::table(), "Pid", parameters).unwrap_err().message
    }

    #[test]
    fn the_step_response_of_each_method_is_that_of_its_z_transform() {
        let expected = [
            (0.0, [27.0, 14.53, 8.31, 5.215, 3.6825]),
            (1.0, [18.696667, 13.171111, 9.497407, 7.058272, 5.442181]),
            (0.5, [22.015, 14.045, 9.275, 6.425, 4.727]),
        ];
        for (theta, outputs) in expected {
            let mut pid = oracle(theta);
            for (k, expected) in outputs.into_iter().enumerate() {
                let u = pid.sample(0.01 * k as f64, &[1.0]).unwrap()[0];
                // The expected values are written with six decimals.
                assert!((u - expected).abs() < 5.1e-7, "theta {theta}, k {k}: {u} != {expected}");
            }
        }
    }

    #[test]
    fn all_methods_approach_the_continuous_law_in_first_order() {
        // u(t) = kp + ki t + kd n exp(-n t) for a unit step, at t = 0.1 s
        let exact = 2.0 + 3.0 * 0.1 + 0.5 * 50.0 * (-5.0_f64).exp();
        for theta in [0.0, 0.5, 1.0] {
            let error = |samples: usize| {
                let ts = 0.1 / samples as f64;
                let parameters =
                    [("kp", 2.0), ("ki", 3.0), ("kd", 0.5), ("n", 50.0), ("ts", ts), ("theta", theta)];
                let mut pid = Bench::new(crate::table(), "Pid", &parameters).unwrap();
                let last = (0..=samples).map(|k| pid.sample(ts * k as f64, &[1.0]).unwrap()[0]).last();
                last.unwrap() - exact
            };
            let ratio = error(1000) / error(2000);
            assert!((1.98..2.02).contains(&ratio), "theta {theta}: error ratio {ratio}");
            assert!(error(2000).abs() < 2e-3, "theta {theta}: {}", error(2000));
        }
    }

    #[test]
    fn while_limited_the_integral_waits() {
        let parameters = [("kp", 0.0), ("ki", 10.0), ("ts", 0.1), ("lower", -1.0), ("upper", 1.0)];
        let mut pid = Bench::new(crate::table(), "Pid", &parameters).unwrap();
        let mut u = [0.0; 6];
        for (k, u) in u.iter_mut().enumerate() {
            *u = pid.sample(0.1 * k as f64, &[0.4]).unwrap()[0];
        }
        assert_eq!(u, [0.0, 0.4, 0.8, 1.0, 1.0, 1.0], "the output stays at the limit");
        assert!((pid.discrete()[0] - 1.2).abs() < 1e-15, "one sample beyond the limit, then frozen");
        pid.sample(0.6, &[-0.4]).unwrap();
        assert!((pid.sample(0.7, &[-0.4]).unwrap()[0] - 0.8).abs() < 1e-15, "it leaves the limit at once");
    }

    #[test]
    fn the_lower_limit_works_as_the_upper_one() {
        let run = |sign: f64| {
            let parameters =
                [("ki", 4.0), ("kd", 0.2), ("ts", 0.01), ("lower", -1.5), ("upper", 1.5), ("theta", 1.0)];
            let mut pid = Bench::new(crate::table(), "Pid", &parameters).unwrap();
            (0..300)
                .map(|k| sign * pid.sample(0.01 * k as f64, &[sign * (0.02 * k as f64).sin()]).unwrap()[0])
                .collect::<Vec<_>>()
        };
        assert_eq!(run(1.0), run(-1.0));
    }

    #[test]
    fn the_integral_starts_where_it_is_told() {
        let mut pid = Bench::new(crate::table(), "Pid", &[("ts", 0.01), ("i0", 0.3)]).unwrap();
        assert_eq!(pid.sample(0.0, &[0.0]).unwrap()[0], 0.3);
    }

    #[test]
    fn parameters_without_sense_are_refused_by_name() {
        assert!(refused(&[]).contains("`ts`"), "the sample time has no default");
        assert!(refused(&[("ts", 0.0)]).contains("`ts` is 0 s"));
        assert!(refused(&[("ts", 0.01), ("lower", 1.0), ("upper", -1.0)]).contains("lower <= upper"));
        assert!(refused(&[("ts", 0.01), ("theta", 2.0)]).contains("`theta` is 2"));
        assert!(refused(&[("ts", 0.01), ("kp", f64::NAN)]).contains("finite"));
    }

    #[test]
    fn an_unstable_derivative_filter_is_refused() {
        let parameters = [("ts", 0.01), ("kd", 1.0), ("n", 200.0)];
        assert!(refused(&parameters).contains("below 200 1/s"));
        assert!(Bench::new(crate::table(), "Pid", &[("ts", 0.01), ("kd", 1.0), ("n", 199.0)]).is_ok());
        assert!(
            Bench::new(crate::table(), "Pid", &[("ts", 0.01), ("kd", 1.0), ("n", 2e4), ("theta", 1.0)])
                .is_ok()
        );
    }
}
