//! What is held between major steps, and where it may change.

use blocksim_law::{Code, Id, Program, Recorder, Sources, Value, passes};

/// A law of one input, as an engine runs it.
struct Bench {
    program: Program,
    modes: Vec<f64>,
}

impl Bench {
    fn new(law: impl for<'r> Fn(Value<'r>) -> Value<'r>) -> Self {
        let recorder = Recorder::new();
        let y = law(recorder.input("u"));
        recorder.output("y", y);
        let program = recorder.finish().optimised();
        Self { modes: vec![0.0; program.modes.len()], program }
    }

    fn values(&self, program: &Program, wanted: &[Id], u: f64) -> Vec<f64> {
        let code = Code::new(program, wanted);
        let mut registers = vec![0.0; code.registers()];
        code.run(&Sources { inputs: &[u], modes: &self.modes, ..Sources::default() }, &mut registers);
        (0..wanted.len()).map(|i| code.result(&registers, i)).collect()
    }

    /// The output at a major step.
    fn major(&mut self, u: f64) -> f64 {
        let released = passes::release_modes(self.program.clone());
        self.modes = self.values(&released, &released.mode_values(), u);
        self.minor(u)
    }

    /// The output between major steps.
    fn minor(&self, u: f64) -> f64 {
        self.values(&self.program, &self.program.output_values(), u)[0]
    }

    fn guards(&self, u: f64) -> Vec<f64> {
        let guards: Vec<Id> = self.program.guards().map(|guard| guard.value).collect();
        self.values(&self.program, &guards, u)
    }
}

#[test]
fn steps_are_held_and_guarded_on_both_sides() {
    for (law, at, expected, guards) in [
        (Bench::new(|u| u.floor()), 2.25, 2.0, [0.25, -0.75]),
        (Bench::new(|u| u.ceil()), 2.25, 3.0, [0.25, -0.75]),
        (Bench::new(|u| u.round()), 2.25, 2.0, [0.75, -0.25]),
        (Bench::new(|u| u.floor()), -0.25, -1.0, [0.75, -0.25]),
    ] {
        let mut law = law;
        assert_eq!(law.major(at), expected);
        assert_eq!(law.guards(at), guards);
        assert_eq!(law.minor(at + 5.0), expected, "held");
        assert_eq!(law.major(at + 5.0), expected + 5.0);
    }
    let mut sign = Bench::new(|u| u.sign());
    assert_eq!([sign.major(3.0), sign.minor(-1.0), sign.major(-1.0), sign.major(0.0)], [1.0, 1.0, -1.0, 0.0]);
    assert_eq!(sign.guards(-0.5), [-0.5]);
}

#[test]
fn a_remainder_goes_on_within_a_step_and_falls_back_at_its_end() {
    let mut law = Bench::new(|u| u.modulo(u * 0.0 + 3.0));
    assert_eq!([law.major(4.0), law.minor(6.5), law.major(6.5), law.major(-1.0)], [1.0, 3.5, 0.5, 2.0]);
}

#[test]
fn an_angle_goes_on_beyond_its_cut() {
    let mut law = Bench::new(|y| y.atan2(y * 0.0 - 1.0));
    let before = law.major(1e-3);
    let beyond = law.minor(-1e-3);
    assert!((beyond - before - 2e-3).abs() < 1e-8, "{before} {beyond}");
    let after = law.major(-1e-3);
    assert_eq!(after, (-1e-3_f64).atan2(-1.0));
    assert!((law.minor(1e-3) - after + 2e-3).abs() < 1e-8);
}

#[test]
fn kinks_are_named_where_they_are_and_not_held() {
    let mut law = Bench::new(|u| u.abs() + u.min(u * 0.0 + 2.0));
    assert_eq!([law.major(1.0), law.minor(-1.0), law.minor(3.0)], [2.0, 0.0, 5.0]);
    assert_eq!(law.guards(1.0), [1.0, -1.0]);
    assert_eq!(law.program.kinks.iter().map(|kink| kink.name).collect::<Vec<_>>(), ["abs", "min"]);
}
