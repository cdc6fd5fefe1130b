//! Members of sets are known or refused, wherever a set stands, and numbers mean what they say.

use blocksim_tests::compile_text;

/// Problems of a diagram with settings, parameters and blocks.
fn problems(settings: &str, parameters: &str, blocks: &str) -> String {
    compile_text(&format!(
        "Diagram(simulation: (stop_time: \"1 s\", {settings}), parameters: {{ {parameters} }}, blocks: {{ {blocks} }}, connections: [])"
    ))
    .1
}

#[test]
fn a_member_that_a_set_does_not_have_is_refused_with_the_one_that_is_meant() {
    let stepper =
        |command: &str| format!(r#""d": StepperDriver(amplitude: "2 V", drive: Half, command: {command})"#);
    let inverter = |integration: &str| {
        format!(
            r#""i": SwitchedInverter(vdc: "560 V", switching_frequency: "8 kHz", integration: {integration})"#
        )
    };
    for (settings, parameters, blocks, message, help) in [
        ("solver: Auto(rtool: 1e-3)", "", "", "`solver`: `rtool` is not known here", "did you mean `rtol`?"),
        (
            "solver: Ode45(rtool: 1e-12)",
            "",
            "",
            "`solver`: `rtool` is not known here",
            "did you mean `rtol`?",
        ),
        ("start: Steady(holt: [])", "", "", "`start`: `holt` is not known here", "did you mean `hold`?"),
        (
            "",
            "\"x\": Choice(defalt: \"a\", of: [\"a\"])",
            "",
            "`Choice`: `defalt` is not known here",
            "did you mean `default`?",
        ),
        (
            "",
            "\"x\": Choice(default: \"a\", of: [\"a\"], more: 1)",
            "",
            "`Choice`: `more` is not known here",
            "known here: `default` and `of`",
        ),
        (
            "",
            "\"x\": Chioce(default: \"a\", of: [\"a\"])",
            "",
            "`Chioce(...)` is not a value",
            "did you mean `Choice(...)`?",
        ),
        (
            "",
            "",
            &stepper("Angle(teeth: 50, teeths: 3)"),
            "`command`: `teeths` is not known here",
            "did you mean `teeth`?",
        ),
        (
            "",
            "",
            &inverter("Separate(periods: 1, period: 2)"),
            "`integration`: `period` is not known here",
            "did you mean `periods`?",
        ),
    ] {
        let told = problems(settings, parameters, blocks);
        assert!(told.contains(message) && told.contains(help), "{settings}{parameters}{blocks}\n{told}");
    }
}

#[test]
fn a_number_without_any_unit_in_it_is_one_in_si_however_it_is_computed() {
    for (tau, message) in [
        ("1 + n", ""),
        ("n - 1", ""),
        ("0.5 / n", ""),
        ("1 / (8 kHz)", ""),
        ("4 m / 2 m", "`tau` is in s, but `2` has no unit"),
        ("50 %", "`tau` is in s, but `0.5` has no unit"),
        ("-3 dB", "`tau` is in s, but"),
        ("50 Hz", "`tau` is in s, but `50 Hz` is in Hz"),
        ("length / 2", "`tau` is in s, but `0.5 m` is in m"),
    ] {
        let told =
            problems("", "\"n\": 3, \"length\": \"1 m\"", &format!("\"lag\": LowPass(tau: \"{tau}\")"));
        let about_tau = told.contains("`tau`");
        assert_eq!(about_tau, !message.is_empty(), "{tau}: {told}");
        assert!(told.contains(message), "{tau}: {told}");
    }
    let told = problems("", "", "\"sum\": Product(inputs: \"200 %\")");
    assert!(told.contains("expected a whole number, not a percentage"), "{told}");
}
