//! A low-pass filter as a plug-in.

use blocksim_controller::prelude::*;

/// First-order low-pass filter, sampled: the mean of the last value and the input, weighted by `a`.
pub struct LowPass;

const A: Parameter = Parameter::new(0, "a", "1", "Weight of the input, above 0, at most 1.");
const TS: Parameter = Parameter::new(1, "ts", "s", "Sample time.").or(&[1e-3]);
const U: Input = Input::new(0, "u", "", "What to filter.");
const Y: Output = Output::new(0, "y", "", "Filtered.").reads(&[U]);
const LAST: Discrete = Discrete::new(0, "last", "", "The output one sample ago.");

impl LowPass {
    fn law(c: &Context) -> f64 {
        c[LAST] + c[A] * (c[U] - c[LAST])
    }
}

impl Controller for LowPass {
    const KIND: &'static str = "LowPass";
    const DOC: &'static str = "y(k) = y(k-1) + a (u(k) - y(k-1))";
    const PARAMETERS: &'static [Parameter] = &[A, TS];
    const INPUTS: &'static [Input] = &[U];
    const OUTPUTS: &'static [Output] = &[Y];
    const DISCRETE: &'static [Discrete] = &[LAST];

    fn check(p: &Parameters) -> Outcome {
        if p[A] > 0.0 && p[A] <= 1.0 { Ok(()) } else { Err(format!("`a` is {}, not in 0 < a <= 1", p[A])) }
    }

    fn sample_time(p: &Parameters) -> f64 {
        p[TS]
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        y[Y] = Self::law(c);
        Ok(())
    }

    fn update(c: &Context, next: &mut DiscreteStates) -> Outcome {
        next[LAST] = Self::law(c);
        Ok(())
    }
}

export_plugin!("low_pass", [LowPass]);

// For this example only: a plug-in has no `main`.
fn main() {
    use blocksim_controller::testing::Bench;
    let mut filter = Bench::new(table(), "LowPass", &[("a", 0.5)]).unwrap();
    assert_eq!(filter.sample(0.0, &[1.0]).unwrap(), [0.5]);
    assert_eq!(filter.sample(1e-3, &[1.0]).unwrap(), [0.75]);
}
