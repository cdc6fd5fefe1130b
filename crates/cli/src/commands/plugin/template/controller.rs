//! The controller `MyController`; `demo.ron` closes a loop with it.

use blocksim_controller::prelude::*;

/// Proportional and integral, sampled, limited: `u = kp e + x`, `x(k+1) = x(k) + ki ts e`.
pub struct Law;

const KP: Parameter = Parameter::new(0, "kp", "", "Proportional gain.").or(&[1.0]);
const KI: Parameter = Parameter::new(1, "ki", "", "Integral gain, that of kp per second.").or(&[1.0]);
const LIMIT: Parameter = Parameter::new(2, "limit", "", "Largest size of u.").or(&[f64::INFINITY]);
const TS: Parameter = Parameter::new(3, "ts", "s", "Sample time.").or(&[1e-3]);

const E: Input = Input::new(0, "e", "", "Set value less actual value.");
const U: Output = Output::new(0, "u", "", "What the plant gets.").reads(&[E]);

const X: Discrete = Discrete::new(0, "x", "", "Integral part.");

/// What the law wants, and what the limits leave of it.
fn limited(c: &Context) -> (f64, f64) {
    let wanted = c[KP] * c[E] + c[X];
    (wanted, wanted.clamp(-c[LIMIT], c[LIMIT]))
}

impl Controller for Law {
    const KIND: &'static str = "MyController";
    const DOC: &'static str = "Proportional and integral, sampled, limited.";
    const PARAMETERS: &'static [Parameter] = &[KP, KI, LIMIT, TS];
    const INPUTS: &'static [Input] = &[E];
    const OUTPUTS: &'static [Output] = &[U];
    const DISCRETE: &'static [Discrete] = &[X];

    fn check(p: &Parameters) -> Outcome {
        if p[TS] <= 0.0 || !p[TS].is_finite() {
            return Err(format!("`ts` is {} s, it must be above zero", p[TS]));
        }
        if p[LIMIT].is_nan() || p[LIMIT] < 0.0 {
            return Err(format!("`limit` is {}, it must not be below zero", p[LIMIT]));
        }
        Ok(())
    }

    fn sample_time(p: &Parameters) -> f64 {
        p[TS]
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        y[U] = limited(c).1;
        Ok(())
    }

    fn update(c: &Context, next: &mut DiscreteStates) -> Outcome {
        let (wanted, u) = limited(c);
        // At a limit the integral part must not grow further, or it takes long to come back.
        if (wanted - u) * c[E] <= 0.0 {
            next[X] = c[X] + c[KI] * c[TS] * c[E];
        }
        Ok(())
    }
}

export_plugin!("my_controller", [Law]);

#[cfg(test)]
mod tests {
    use blocksim_controller::testing::Bench;

    #[test]
    fn a_constant_error_is_summed_up_to_the_limit() {
        let parameters = [("kp", 2.0), ("ki", 10.0), ("limit", 3.0), ("ts", 0.1)];
        let mut controller = Bench::new(crate::table(), "MyController", &parameters).unwrap();
        assert_eq!(controller.sample(0.0, &[1.0]).unwrap(), [2.0]);
        assert_eq!(controller.sample(0.1, &[1.0]).unwrap(), [3.0]);
        assert_eq!(controller.sample(0.2, &[1.0]).unwrap(), [3.0]);
        // The integral part has stopped at 2.
        assert_eq!(controller.sample(0.3, &[-1.0]).unwrap(), [0.0]);
    }
}
