//! What must hold for every kind of block, taken from the registry.

use std::collections::BTreeSet;

use blocksim_block::kinds;
use blocksim_signal::Unit;
use blocksim_tests::compile_text;

/// Problems that a block alone in a diagram has by nature: nothing is connected to it, and the files and plug-ins
/// of its example are not there.
const ALONE: [&str; 9] = [
    "unconnected_input",
    "unconnected_port",
    "missing_reference",
    "missing_supply",
    "missing_file",
    "no_inertia",
    "floating_node",
    "plugin_missing",
    "expression",
];

#[test]
fn the_library_is_linked_and_every_name_is_there_once() {
    let names: Vec<&str> = kinds().iter().map(|info| info.kind).collect();
    assert!(names.len() > 60, "only {} kinds are registered", names.len());
    let unique: BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(unique.len(), names.len(), "a kind is registered twice: {names:?}");
}

#[test]
fn every_kind_has_a_page_and_an_example_that_compiles() {
    for info in kinds() {
        let examples = info.examples();
        assert!(!examples.is_empty(), "{} has no ```ron example", info.kind);
        for example in examples {
            assert!(
                example.contains(info.kind),
                "the example of {} shows something else: {example}",
                info.kind
            );
            // An example may be a block or a line of a diagram.
            let block =
                if example.starts_with('"') { example.to_owned() } else { format!("\"example\": {example}") };
            let text = format!("Diagram(blocks: {{ {} }}, connections: [])", block.trim_end_matches(','));
            let (compiled, problems) = compile_text(&text);
            let unexpected: Vec<_> =
                compiled.problems.iter().filter(|problem| !ALONE.contains(&problem.code)).collect();
            assert!(
                unexpected.is_empty(),
                "the example of {} has problems:\n{problems}\n{example}",
                info.kind
            );
        }
    }
}

#[test]
fn every_unit_of_every_parameter_is_one() {
    for info in kinds() {
        for parameter in info.parameters.iter().filter(|parameter| !parameter.unit.is_empty()) {
            assert!(
                Unit::parse(parameter.unit).is_ok(),
                "{}.{} is in `{}`, which is not a unit",
                info.kind,
                parameter.name,
                parameter.unit
            );
        }
    }
}

#[test]
fn names_follow_the_rules_of_the_language() {
    for info in kinds() {
        assert!(info.kind.starts_with(|c: char| c.is_ascii_uppercase()), "{}", info.kind);
        for parameter in info.parameters {
            let fits =
                parameter.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
            assert!(fits && parameter.name != "label", "{}.{}", info.kind, parameter.name);
        }
        let unique: BTreeSet<&str> = info.parameters.iter().map(|parameter| parameter.name).collect();
        assert_eq!(unique.len(), info.parameters.len(), "{} has a parameter twice", info.kind);
    }
}

/// Kinds with limits that start outside of them.
const OUTSIDE: [&str; 8] = [
    r#"Integrator(x0: 3, lower: -1, upper: 1)"#,
    r#"DiscreteIntegrator(ts: "1 ms", x0: 3, lower: -1, upper: 1)"#,
    r#"RevoluteJoint(axis: [0, 0, 1], position: "3 rad", lower: "-1 rad", upper: "1 rad")"#,
    r#"PrismaticJoint(axis: [1, 0, 0], position: "3 m", lower: "-1 m", upper: "1 m")"#,
    r#"RotationalHardStop(phi0: "3 rad", lower: "-1 rad", upper: "1 rad", stiffness: 1, damping: 1)"#,
    r#"RotationalRigidStop(phi0: "3 rad", lower: "-1 rad", upper: "1 rad")"#,
    r#"TranslationalHardStop(x0: "3 m", lower: "-1 m", upper: "1 m", stiffness: 1, damping: 1)"#,
    r#"TranslationalRigidStop(x0: "3 m", lower: "-1 m", upper: "1 m")"#,
];

/// A start outside of the limits is a conflict between given values: it is told, and neither dropped nor cut off.
#[test]
fn every_kind_with_limits_refuses_a_start_outside_of_them() {
    let has = |info: &blocksim_block::BlockInfo, names: &[&str]| {
        info.parameters.iter().any(|parameter| names.contains(&parameter.name))
    };
    for info in kinds() {
        let starts = has(info, &["x0", "y0", "phi0", "position", "initial"]);
        // The state of a controller is its integral part, its limits are those of the sum.
        let controls = has(info, &["ki"]);
        if starts && !controls && has(info, &["lower"]) && has(info, &["upper"]) {
            let shown = OUTSIDE.iter().any(|block| block.starts_with(&format!("{}(", info.kind)));
            assert!(shown, "nobody has looked whether {} refuses a start outside of its limits", info.kind);
        }
    }
    for block in OUTSIDE {
        let (_, problems) = compile_text(&format!("Diagram(blocks: {{ \"a\": {block} }}, connections: [])"));
        let told = problems.lines().any(|line| {
            line.starts_with("error[parameter]")
                && ["outside", "starts at", "start at", "but must be at"]
                    .iter()
                    .any(|word| line.contains(word))
        });
        assert!(told, "{block}: {problems}");
    }
}

#[test]
fn names_of_other_programs_lead_to_parameters_that_exist() {
    let all: BTreeSet<&str> =
        kinds().iter().flat_map(|info| info.parameters.iter().map(|parameter| parameter.name)).collect();
    let lost: Vec<&str> = blocksim_block::synonyms::parameters().filter(|name| !all.contains(name)).collect();
    assert!(lost.is_empty(), "no kind has the parameters {lost:?} that the table leads to");
}

/// Kinds with names of parameters from elsewhere, and what is suggested.
const ELSEWHERE: [(&str, &str, &str); 60] = [
    ("Integrator", "initial", "x0"),
    ("Integrator", "InitialCondition", "x0"),
    ("Integrator", "y_start", "x0"),
    ("Integrator", "UpperSaturationLimit", "upper"),
    ("Integrator", "ExternalReset", "reset"),
    ("Gain", "gain", "k"),
    ("Gain", "factor", "k"),
    ("Sine", "freq", "frequency"),
    ("Sine", "freqHz", "frequency"),
    ("Sine", "f", "frequency"),
    ("Sine", "amp", "amplitude"),
    ("Sine", "offset", "bias"),
    ("Step", "StepTime", "time"),
    ("Step", "FinalValue", "after"),
    ("Step", "InitialValue", "before"),
    ("Step", "height", "after"),
    ("Ramp", "rate", "slope"),
    ("Pulse", "PulseWidth", "width"),
    ("Pulse", "PhaseDelay", "delay"),
    ("Constant", "k", "value"),
    ("Saturation", "UpperLimit", "upper"),
    ("Saturation", "uMin", "lower"),
    ("DeadZone", "uMax", "end"),
    ("RateLimiter", "RisingSlewLimit", "rising"),
    ("Relay", "OnSwitchValue", "on_at"),
    ("Relay", "OffOutputValue", "off"),
    ("Backlash", "BacklashWidth", "width"),
    ("Quantizer", "QuantizationInterval", "interval"),
    ("TransferFunction", "Numerator", "num"),
    ("TransferFunction", "Denominator", "den"),
    ("LowPass", "T", "tau"),
    ("LowPass", "TimeConstant", "tau"),
    ("LowPass", "x0", "y0"),
    ("Pid", "P", "kp"),
    ("Pid", "I", "ki"),
    ("Pid", "D", "kd"),
    ("Pid", "yMax", "upper"),
    ("TransportDelay", "DelayTime", "delay"),
    ("UnitDelay", "SampleTime", "ts"),
    ("UnitDelay", "dt", "ts"),
    ("Delay", "DelayLength", "steps"),
    ("Switch", "Thresh", "threshold"),
    ("Sum", "inputs", "signs"),
    ("LookupTable1D", "TableData", "table"),
    ("LookupTable2D", "BreakpointsForDimension2", "columns"),
    ("Resistor", "resistance", "r"),
    ("Inductor", "inductance", "l"),
    ("Capacitor", "initial_voltage", "v0"),
    ("VoltageSource", "voltage", "v"),
    ("Diode", "Vf", "v_f"),
    ("DcMotor", "resistance", "r"),
    ("DcMotor", "torque_constant", "k"),
    ("DcMotor", "inertia", "j"),
    ("PermanentMagnetMachine", "p", "pole_pairs"),
    ("Inertia", "inertia", "j"),
    ("Mass", "mass", "m"),
    ("RotationalSpring", "c", "k"),
    ("RotationalDamper", "damping", "d"),
    ("SimpleGear", "gear_ratio", "ratio"),
    ("World", "g", "gravity"),
];

#[test]
fn unknown_parameters_are_answered_by_meaning() {
    for (kind, name, expected) in ELSEWHERE {
        let text = format!("Diagram(blocks: {{ \"a\": {kind}({name}: 1) }}, connections: [])");
        let (compiled, problems) = compile_text(&text);
        let unknown = compiled.problems.iter().find(|problem| problem.code == "unknown_parameter");
        let unknown = unknown.unwrap_or_else(|| panic!("{kind}({name}: ..): {problems}"));
        let meant = unknown.remedy().map(|edit| edit.new.as_str());
        assert_eq!(meant, Some(expected), "{kind}({name}: ..): {problems}");
    }
}
