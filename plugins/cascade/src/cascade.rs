use blocksim_controller::prelude::*;

/// Position controller around a speed controller, with feedforward of speed and acceleration.
///
/// - wanted speed: `w_ref = qd_set + kv (q_set - q)`, error `e_w = w_ref - w`
/// - demand: `v = (w_ref + kp e_w + kd (qdd_set - (w - w_previous)/ts) + ki ∫ e_w dt) / w1 + u_ff`
/// - output: `u = v`, limited to `|u - w/w1| <= slip_limit`, then to -1..1
///
/// `w1` is the speed at u = 1, so the feedforward alone drives an ideal machine; one law serves all
/// drives. `u - w/w1` is the slip of an asynchronous machine: limiting it keeps the torque below
/// breakdown. While the output is limited, the integral is frozen as long as `e_w` pushes further.
///
/// At the first sample nothing is known of the speed before; the joint is taken to have moved steadily,
/// `w_previous = w`, so that a start in motion gives no kick.
#[derive(Debug)]
pub struct Cascade;

const KV: Parameter = Parameter::new(0, "kv", "1/s", "Gain from position error to set speed.").or(&[20.0]);
const KP: Parameter = Parameter::new(1, "kp", "1", "Gain of the speed error.").or(&[1.0]);
const KI: Parameter = Parameter::new(2, "ki", "1/s", "Gain of the integral of the speed error.").or(&[20.0]);
const KD: Parameter = Parameter::new(3, "kd", "s", "Gain of the acceleration error.").or(&[0.0]);
const W1: Parameter = Parameter::new(4, "w1", "rad/s", "Joint speed at u = 1.");
const SLIP_LIMIT: Parameter =
    Parameter::new(5, "slip_limit", "1", "Largest distance of u from the speed, as a share of w1.")
        .or(&[1.0]);
const TS: Parameter = Parameter::new(6, "ts", "s", "Sample time.").or(&[1e-3]);
const U_START: Parameter =
    Parameter::new(7, "u_start", "1", "Integral part of u at the start, for example to hold a load.")
        .or(&[0.0]);

const Q_SET: Input = Input::new(0, "q_set", "rad", "Set position.");
const QD_SET: Input = Input::new(1, "qd_set", "rad/s", "Set speed.");
const QDD_SET: Input = Input::new(2, "qdd_set", "rad/s^2", "Set acceleration.");
const Q: Input = Input::new(3, "q", "rad", "Position.");
const W: Input = Input::new(4, "w", "rad/s", "Speed.");

const U_FF: Input = Input::new(5, "u_ff", "1", "Part of u that is known beforehand.").or(&[0.0]);

const U: Output =
    Output::new(0, "u", "1", "Controlled value, -1 to 1.").reads(&[Q_SET, QD_SET, QDD_SET, Q, W, U_FF]);

/// Kept as a part of u rather than in rad, so that `u_start` means something for ki = 0 too.
const INTEGRAL: Discrete = Discrete::new(0, "integral", "1", "Integral part of u.");
const W_PREVIOUS: Discrete = Discrete::new(1, "w_previous", "rad/s", "Speed one sample ago.");
const STARTED: Discrete = Discrete::new(2, "started", "1", "0 before the first sample, then 1.");

/// Parts of the law at one sample.
struct Parts {
    /// Speed error.
    e_w: f64,
    /// Demand before the limits.
    v: f64,
    /// Output.
    u: f64,
}

fn law(c: &Context) -> Parts {
    let w_ref = c[QD_SET] + c[KV] * (c[Q_SET] - c[Q]);
    let e_w = w_ref - c[W];
    let acceleration = if c[STARTED] == 0.0 { 0.0 } else { (c[W] - c[W_PREVIOUS]) / c[TS] };
    let v = (w_ref + c[KP] * e_w + c[KD] * (c[QDD_SET] - acceleration)) / c[W1] + c[INTEGRAL] + c[U_FF];

    let slip_free = c[W] / c[W1];
    // The range of u is the harder limit: a joint driven beyond it keeps |u| <= 1 and exceeds the slip.
    let u = limit(v, slip_free - c[SLIP_LIMIT], slip_free + c[SLIP_LIMIT]).clamp(-1.0, 1.0);
    Parts { e_w, v, u }
}

/// Unlike `clamp` it takes limits that are not numbers, and unlike `max` it lets a demand that is not a number
/// through, so that the simulator sees it.
fn limit(v: f64, lower: f64, upper: f64) -> f64 {
    if v < lower {
        lower
    } else if v > upper {
        upper
    } else {
        v
    }
}

impl Controller for Cascade {
    const KIND: &'static str = "Cascade";
    const DOC: &'static str = include_str!("../README.md");
    const PARAMETERS: &'static [Parameter] = &[KV, KP, KI, KD, W1, SLIP_LIMIT, TS, U_START];
    const INPUTS: &'static [Input] = &[Q_SET, QD_SET, QDD_SET, Q, W, U_FF];
    const OUTPUTS: &'static [Output] = &[U];
    const DISCRETE: &'static [Discrete] = &[INTEGRAL, W_PREVIOUS, STARTED];

    fn check(p: &Parameters) -> Outcome {
        for (name, value) in [("kv", p[KV]), ("kp", p[KP]), ("ki", p[KI]), ("kd", p[KD])] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(format!("`{name}` is {value}, it must not be negative"));
            }
        }
        for (name, value, unit) in [("w1", p[W1], "rad/s"), ("ts", p[TS], "s")] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("`{name}` is {value} {unit}, it must be positive"));
            }
        }
        if p[SLIP_LIMIT].is_nan() || p[SLIP_LIMIT] <= 0.0 {
            return Err(format!("`slip_limit` is {}, it must be positive", p[SLIP_LIMIT]));
        }
        if !(-1.0..=1.0).contains(&p[U_START]) {
            return Err(format!("`u_start` is {}, it must be within -1 and 1", p[U_START]));
        }
        Ok(())
    }

    fn sample_time(p: &Parameters) -> f64 {
        p[TS]
    }

    fn reset(p: &Parameters, _x: &mut ContinuousStates, xd: &mut DiscreteStates) -> Outcome {
        xd[INTEGRAL] = p[U_START];
        Ok(())
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        y[U] = law(c).u;
        Ok(())
    }

    fn update(c: &Context, next: &mut DiscreteStates) -> Outcome {
        let Parts { e_w, v, u } = law(c);
        let pushes_further = (v - u) * e_w > 0.0;
        if !pushes_further {
            next[INTEGRAL] = c[INTEGRAL] + c[KI] * c[TS] * e_w / c[W1];
        }
        next[W_PREVIOUS] = c[W];
        next[STARTED] = 1.0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use blocksim_controller::testing::Bench;

    const TS_DEFAULT: f64 = 1e-3;

    fn cascade(parameters: &[(&str, f64)]) -> Bench {
        let mut all = vec![("w1", 4.0)];
        all.extend_from_slice(parameters);
        Bench::new(crate::table(), "Cascade", &all).unwrap()
    }

    /// q_set, qd_set, qdd_set, q, w
    fn sample(c: &mut Bench, u: [f64; 5]) -> f64 {
        fed_forward(c, u, 0.0)
    }

    /// The same and u_ff.
    fn fed_forward(c: &mut Bench, [q_set, qd_set, qdd_set, q, w]: [f64; 5], u_ff: f64) -> f64 {
        c.sample(0.0, &[q_set, qd_set, qdd_set, q, w, u_ff]).unwrap()[0]
    }

    #[test]
    fn what_is_known_beforehand_is_added_within_the_limits() {
        let mut c = cascade(&[("slip_limit", 0.12)]);
        assert_eq!(fed_forward(&mut c, [0.0; 5], 0.1), 0.1);
        assert_eq!(fed_forward(&mut c, [0.0; 5], 0.5), 0.12);
        assert_eq!(c.discrete()[0], 0.0, "no error, no integral");
    }

    #[test]
    fn on_the_path_feedforward_alone_drives_the_joint() {
        let mut c = cascade(&[]);
        for _ in 0..3 {
            assert_eq!(sample(&mut c, [0.5, 1.0, 0.0, 0.5, 1.0]), 1.0 / 4.0);
        }
        assert_eq!(c.discrete()[0], 0.0);
    }

    #[test]
    fn each_term_of_the_law_acts_with_its_gain() {
        // w_ref = 0.3 + 20 * 0.01 = 0.5, e_w = 0.1; second sample: w rose by 0.002 in 1 ms
        let mut c = cascade(&[("kp", 1.5), ("ki", 30.0), ("kd", 0.005)]);
        let first = sample(&mut c, [0.21, 0.3, 1.0, 0.2, 0.4]);
        let expected = (0.5 + 1.5 * 0.1 + 0.005 * 1.0) / 4.0;
        assert!((first - expected).abs() < 1e-15, "{first} != {expected}");

        let second = sample(&mut c, [0.21, 0.3, 1.0, 0.2, 0.402]);
        let e_w = 0.098;
        let expected = (0.5 + 1.5 * e_w + 0.005 * (1.0 - 2.0) + 30.0 * (0.1 * TS_DEFAULT)) / 4.0;
        assert!((second - expected).abs() < 1e-14, "{second} != {expected}");
    }

    #[test]
    fn a_start_in_motion_gives_no_kick() {
        let mut c = cascade(&[("kd", 0.1)]);
        assert_eq!(sample(&mut c, [0.0, 2.0, 0.0, 0.0, 2.0]), 0.5);
        assert_eq!(sample(&mut c, [0.0, 2.0, 0.0, 0.0, 2.0]), 0.5);
    }

    #[test]
    fn the_output_stays_in_its_range() {
        let mut c = cascade(&[]);
        assert_eq!(sample(&mut c, [9.0, 0.0, 0.0, 0.0, 0.0]), 1.0);
        assert_eq!(sample(&mut c, [-9.0, 0.0, 0.0, 0.0, 0.0]), -1.0);
    }

    #[test]
    fn the_slip_stays_in_its_limit_at_every_speed() {
        for w in [-3.9, -2.0, 0.0, 0.5, 2.0, 3.0, 3.9] {
            for q_set in [-1.0, -0.01, 0.0, 0.01, 1.0] {
                let u = sample(&mut cascade(&[("slip_limit", 0.12)]), [q_set, 0.0, 0.0, 0.0, w]);
                assert!((u - w / 4.0).abs() <= 0.12 + 1e-15 && u.abs() <= 1.0, "w {w}, q_set {q_set}: {u}");
            }
        }
    }

    #[test]
    fn a_joint_driven_beyond_the_range_keeps_the_range() {
        let u = sample(&mut cascade(&[("slip_limit", 0.12)]), [0.0, 0.0, 0.0, 0.0, 5.0]);
        assert_eq!(u, 1.0, "w/w1 = 1.25 is out of reach: the range wins over the slip");
    }

    #[test]
    fn while_limited_the_integral_is_frozen_only_against_the_limit() {
        for (sign, slip_limit) in [(1.0, 1.0), (-1.0, 1.0), (1.0, 0.12), (-1.0, 0.12)] {
            let mut c = cascade(&[("slip_limit", slip_limit), ("u_start", sign * 0.9)]);
            for _ in 0..1000 {
                sample(&mut c, [sign * 5.0, 0.0, 0.0, 0.0, 0.0]);
            }
            assert_eq!(c.discrete()[0], sign * 0.9, "frozen");
            // Still limited by the integral alone, but the error now points back: it unwinds.
            sample(&mut c, [-sign * 0.001, 0.0, 0.0, 0.0, 0.0]);
            assert!(sign * c.discrete()[0] < 0.9, "sign {sign}, slip limit {slip_limit}");
        }
    }

    #[test]
    fn the_integral_removes_a_constant_disturbance() {
        // An ideal speed drive that loses 10 % of w1: w = w1 (u - 0.1); at rest u must be 0.1.
        let mut c = cascade(&[]);
        let (mut q, mut w, mut u) = (0.0, 0.0, 0.0);
        for _ in 0..5000 {
            u = sample(&mut c, [0.2, 0.0, 0.0, q, w]);
            w += 0.1 * (4.0 * (u - 0.1) - w);
            q += w * TS_DEFAULT;
        }
        assert!((q - 0.2).abs() < 1e-6 && (u - 0.1).abs() < 1e-6, "q {q}, u {u}");
    }

    #[test]
    fn the_integral_starts_at_u_start_also_without_gain() {
        assert_eq!(sample(&mut cascade(&[("u_start", 0.2), ("ki", 0.0)]), [0.0; 5]), 0.2);
    }

    #[test]
    fn a_measurement_that_is_no_number_is_not_hidden() {
        assert!(sample(&mut cascade(&[("slip_limit", 0.12)]), [0.0, 0.0, 0.0, 0.0, f64::NAN]).is_nan());
        assert!(sample(&mut cascade(&[]), [f64::NAN, 0.0, 0.0, 0.0, 0.0]).is_nan());
    }

    #[test]
    fn parameters_without_sense_are_refused_by_name() {
        let refused = |parameters: &[(&str, f64)]| {
            Bench::new(crate::table(), "Cascade", parameters).unwrap_err().message
        };
        assert!(refused(&[]).contains("`w1`"), "w1 has no default");
        for (name, value) in
            [("w1", 0.0), ("ts", -1.0), ("kv", -1.0), ("kd", f64::NAN), ("slip_limit", 0.0), ("u_start", 2.0)]
        {
            let mut parameters = vec![("w1", 4.0)];
            parameters.retain(|p| p.0 != name);
            parameters.push((name, value));
            let message = refused(&parameters);
            assert!(message.starts_with(&format!("`{name}` is {value}")), "{message}");
        }
    }
}
