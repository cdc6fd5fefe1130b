//! Slopes against closed forms.

use blocksim_law::{Recorder, Sources, Value, slopes};

type Function = for<'r> fn(Value<'r>) -> Value<'r>;
type Slope = fn(f64) -> f64;

/// The slope of a function of one input.
fn slope(function: Function, u: f64) -> f64 {
    let recorder = Recorder::new();
    let y = function(recorder.input("u"));
    recorder.output("y", y);
    slopes(&recorder.finish(), &Sources { inputs: &[u], modes: &[0.0; 4], ..Sources::default() })[0][0]
}

#[test]
fn elementary_functions_have_the_slopes_of_the_books() {
    let cases: [(Function, Slope); 18] = [
        (|u| u.sqrt(), |u| 0.5 / u.sqrt()),
        (|u| u.exp(), f64::exp),
        (|u| u.ln(), |u| 1.0 / u),
        (|u| u.log10(), |u| 1.0 / (u * std::f64::consts::LN_10)),
        (|u| u.sin(), f64::cos),
        (|u| u.cos(), |u| -u.sin()),
        (|u| u.tan(), |u| 1.0 / u.cos().powi(2)),
        (|u| u.asin(), |u| 1.0 / (1.0 - u * u).sqrt()),
        (|u| u.acos(), |u| -1.0 / (1.0 - u * u).sqrt()),
        (|u| u.atan(), |u| 1.0 / (1.0 + u * u)),
        (|u| u.sinh(), f64::cosh),
        (|u| u.cosh(), f64::sinh),
        (|u| u.tanh(), |u| 1.0 / u.cosh().powi(2)),
        (|u| u.powi(3), |u| 3.0 * u * u),
        (|u| u.powi(-2), |u| -2.0 / u.powi(3)),
        (|u| u.pow(u), |u| u.powf(u) * (u.ln() + 1.0)),
        (|u| 2.0 / u - u / 4.0, |u| -2.0 / (u * u) - 0.25),
        (|u| u.hypot(2.0 * u), |u| 5.0_f64.sqrt() * u.signum()),
    ];
    for (i, (function, exact)) in cases.into_iter().enumerate() {
        for u in [0.1, 0.5, 0.9] {
            let found = slope(function, u);
            assert!((found - exact(u)).abs() < 1e-13 * (1.0 + exact(u).abs()), "{i}: {found} at {u}");
        }
    }
    assert_eq!([slope(|u| u.abs(), 2.0), slope(|u| u.abs(), -2.0)], [1.0, -1.0]);
    assert_eq!([slope(|u| u.min(3.0 * u), 2.0), slope(|u| u.max(3.0 * u), 2.0)], [1.0, 3.0]);
    assert_eq!([slope(|u| u.sign(), 2.0), slope(|u| u.floor(), 2.5)], [0.0, 0.0]);
    // The slope of the hyperbolic tangent keeps its digits far out.
    assert!((slope(|u| u.tanh(), 30.0) / (4.0 * (-60.0_f64).exp()) - 1.0).abs() < 1e-12);
}

/// An oscillator with two states: outputs and derivatives over inputs and states.
#[test]
fn states_and_their_derivatives_have_slopes_too() {
    let recorder = Recorder::new();
    let (u, k) = (recorder.input("u"), recorder.parameter("k", 3.0));
    let (x, v) = (recorder.state("x", 1.0), recorder.state("v", 0.0));
    recorder.derive(x, v);
    recorder.derive(v, u * x - k * x.powi(3));
    recorder.output("energy", v * v / 2.0);
    let program = recorder.finish();
    let sources = Sources { inputs: &[0.5], states: &[2.0, -1.5], parameters: &[3.0], ..Sources::default() };
    // energy, x', v' over u, x, v.
    assert_eq!(slopes(&program, &sources), [[0.0, 0.0, -1.5], [0.0, 0.0, 1.0], [2.0, 0.5 - 36.0, 0.0]]);
}
