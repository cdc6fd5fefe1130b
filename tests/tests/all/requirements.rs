//! What declarations require of parameters is looked at, for every kind: taken from the registry.

use std::path::Path;

use blocksim_block::problem::Problem;
use blocksim_block::{BlockInfo, Bound, ParameterInfo, Requirement, kinds};
use blocksim_syntax::{Node, read};
use blocksim_tests::{Desk, compile_with};

/// Problems of the first example of a kind with parameters replaced, those about parameters alone.
fn problems(info: &BlockInfo, replaced: &[(&str, &str)]) -> Vec<String> {
    refused(info, replaced).into_iter().map(|problem| problem.message).collect()
}

fn refused(info: &BlockInfo, replaced: &[(&str, &str)]) -> Vec<Problem> {
    let example = info.examples()[0];
    let name = match example.strip_prefix('"').and_then(|rest| rest.split_once('"')) {
        Some((name, _)) => name.to_owned(),
        None => "example".to_owned(),
    };
    let block = if example.starts_with('"') { example.to_owned() } else { format!("\"example\": {example}") };
    let text = format!("Diagram(blocks: {{ {} }}, connections: [])", block.trim_end_matches(','));
    let text = with(&text, &name, replaced);
    let (compiled, _) = compile_with(&Desk::new().with("a.ron", &text), Path::new("a.ron"), &[]);
    compiled.problems.into_iter().filter(|problem| problem.code == "parameter").collect()
}

/// The text of a diagram with other parameters of one of its blocks.
fn with(text: &str, block: &str, replaced: &[(&str, &str)]) -> String {
    let diagram = read(text).unwrap_or_else(|error| panic!("{text}: {error:?}"));
    let member = |node: &Node, name: &str| {
        let found = node.members().into_iter().flatten().find(|(known, _)| known.text == name);
        found.map(|(_, node)| node.clone())
    };
    let block = member(&diagram, "blocks").and_then(|blocks| member(&blocks, block)).expect("the block");
    let mut written = text.to_owned();
    // Places before those that change stay where they are.
    let mut there: Vec<_> =
        replaced.iter().filter_map(|(name, value)| Some((member(&block, name)?.span, *value))).collect();
    there.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    there.into_iter().for_each(|(span, value)| written.replace_range(span, value));
    let absent = replaced.iter().filter(|(name, _)| member(&block, name).is_none());
    let absent: String = absent.map(|(name, value)| format!("{name}: {value}, ")).collect();
    let start = block.span.start + block.word().expect("a kind").len();
    match &written[start..] {
        _ if absent.is_empty() => {}
        rest if rest.starts_with('(') => written.insert_str(start + 1, &absent),
        _ => written.insert_str(start, &format!("({absent})")),
    }
    written
}

/// A number in SI as a value of the type of a parameter; in a list the first of some.
fn written(parameter: &ParameterInfo, number: f64) -> String {
    // Bare numbers are in SI as well, where a unit is expected.
    let has_unit = !["", "1"].contains(&parameter.unit) && number.is_finite() && number != 0.0;
    let quoted = if has_unit { format!("\"{number:?} {}\"", parameter.unit) } else { number.to_string() };
    let list = |n: usize| format!("[{}]", vec![quoted.clone(); n].join(", "));
    match parameter.rust_type {
        "u32" | "usize" => number.to_string(),
        "f64" | "Option<f64>" | "Impedance" | "Option<Impedance>" | "Entries" | "Option<Entries>" => quoted,
        "Amplitude" => format!("Rms({quoted})"),
        "Vec<f64>" | "Vec<usize>" => list(1),
        "Vec<Vec<f64>>" => format!("[{}]", list(1)),
        "[f64;3]" | "Option<[f64;3]>" => list(3),
        "Option<[f64;2]>" => list(2),
        "Option<[[f64;3];3]>" => format!("[{0}, {0}, {0}]", list(3)),
        other => panic!("no value of the type {other} of `{}`", parameter.name),
    }
}

/// A value that does not meet a requirement, and the value that another parameter must have for that.
fn violation(
    info: &BlockInfo,
    parameter: &ParameterInfo,
    requirement: &Requirement,
) -> (String, Option<(&'static str, String)>) {
    // Far on the wrong side of whatever the other parameter is.
    let far = |below: bool| match parameter.rust_type {
        "u32" | "usize" => {
            if below {
                0.0
            } else {
                4e9
            }
        }
        _ => {
            if below {
                -1e300
            } else {
                1e300
            }
        }
    };
    let beside = |other: &'static str| {
        let known = info.parameters.iter().find(|known| known.name == other).expect("the other parameter");
        // One that may be absent is given, in the middle of what is allowed.
        (known.default == Some("None")).then(|| (other, "1.0".to_owned()))
    };
    match *requirement {
        Requirement::Finite => (written(parameter, f64::INFINITY), None),
        Requirement::NotZero => (written(parameter, 0.0), None),
        Requirement::Above(Bound::Number(bound)) | Requirement::Below(Bound::Number(bound)) => {
            (written(parameter, bound), None)
        }
        Requirement::AtLeast(Bound::Number(bound)) => {
            (written(parameter, bound - least_step(parameter, bound)), None)
        }
        Requirement::AtMost(Bound::Number(bound)) => {
            (written(parameter, bound + least_step(parameter, bound)), None)
        }
        Requirement::Above(Bound::Parameter(other)) | Requirement::AtLeast(Bound::Parameter(other)) => {
            (written(parameter, far(true)), beside(other))
        }
        Requirement::Below(Bound::Parameter(other)) | Requirement::AtMost(Bound::Parameter(other)) => {
            (written(parameter, far(false)), beside(other))
        }
        Requirement::NotEmpty if parameter.rust_type == "String" => ("\"\"".to_owned(), None),
        Requirement::NotEmpty => ("[]".to_owned(), None),
        Requirement::Increasing => ("[2.0, 1.0]".to_owned(), None),
        Requirement::AsManyAs(_) if parameter.rust_type == "Vec<Vec<f64>>" => {
            (format!("[{}]", vec!["[0.0]"; 17].join(", ")), None)
        }
        Requirement::AsManyAs(_) => (format!("[{}]", vec!["0.0"; 17].join(", ")), None),
        Requirement::Unit => ("\"no unit\"".to_owned(), None),
        Requirement::Direction => (written(parameter, 0.0), None),
    }
}

/// What is surely another value than a bound, whatever units it has passed through.
fn least_step(parameter: &ParameterInfo, bound: f64) -> f64 {
    match parameter.rust_type {
        "u32" | "usize" | "Vec<usize>" => 1.0,
        _ => 1e-9 * bound.abs().max(1.0),
    }
}

/// Parameters with what is required of them.
fn required() -> impl Iterator<Item = (&'static BlockInfo, &'static ParameterInfo)> {
    kinds().into_iter().flat_map(|info| info.parameters.iter().map(move |parameter| (info, parameter)))
}

#[test]
fn every_requirement_is_looked_at_and_the_parameter_is_named() {
    let mut looked = 0;
    for (info, parameter) in required() {
        for requirement in parameter.requires.list {
            let (value, beside) = violation(info, parameter, requirement);
            let mut replaced = vec![(parameter.name, value.as_str())];
            replaced.extend(beside.as_ref().map(|(name, value)| (*name, value.as_str())));
            let found = refused(info, &replaced);
            let named = |problem: &&Problem| {
                problem.message.contains(&format!("`{}`", parameter.name))
                    || problem.message.contains(&format!("`{}[", parameter.name))
                    // The words for units are those of all units.
                    || *requirement == Requirement::Unit
            };
            let case = format!("{}.{} = {value} against {requirement:?}", info.kind, parameter.name);
            let Some(problem) = found.iter().find(named) else { panic!("{case}: {found:?}") };
            assert!(!problem.labels.is_empty(), "{case} has no place: {problem:?}");
            // A count below zero cannot be read as its type, which has a message of its own.
            let is_number = !(["u32", "usize"].contains(&parameter.rust_type) && value.starts_with('-'));
            let helps = problem.help.is_some() || problem.message.contains("must be");
            assert!(helps || !is_number, "{case}: {problem:?}");
            looked += 1;
        }
    }
    assert!(looked > 700, "only {looked} requirements");
}

/// The ends of a range belong to it or not, as declared; another parameter may still have something against them.
#[test]
fn what_lies_just_within_a_range_is_allowed() {
    let mut looked = 0;
    for (info, parameter) in required() {
        if !["f64", "Option<f64>", "u32", "usize"].contains(&parameter.rust_type) {
            continue;
        }
        let list = parameter.requires.list;
        for requirement in list {
            let within = match *requirement {
                Requirement::AtLeast(Bound::Number(bound)) | Requirement::AtMost(Bound::Number(bound)) => {
                    bound
                }
                Requirement::Above(Bound::Number(bound)) => bound + least_step(parameter, bound),
                Requirement::Below(Bound::Number(bound)) => bound - least_step(parameter, bound),
                _ => continue,
            };
            // Where ranges have several parts, the others may exclude the end of this one.
            if list.contains(&Requirement::NotZero) && within == 0.0 || !within.is_finite() {
                continue;
            }
            let found = problems(info, &[(parameter.name, &written(parameter, within))]);
            let own = format!("`{}` is ", parameter.name);
            let declared = |message: &&String| {
                message.starts_with(&own)
                    && message.contains(", but must ")
                    && !message.contains(", which is ")
            };
            let case = format!("{}.{} = {within} against {requirement:?}", info.kind, parameter.name);
            assert_eq!(found.iter().find(declared), None, "{case}");
            looked += 1;
        }
    }
    assert!(looked > 300, "only {looked} ends");
}

/// Each number that a message shows is one that may be written instead of the one that stands there.
#[test]
fn messages_show_values_in_the_unit_that_is_written() {
    for (text, message) in [
        (r#"LowPass(tau: "-50 ms")"#, "`tau` is -50 ms, but must be positive"),
        (
            r#"Saturation(lower: "48 V", upper: "-2 kV")"#,
            "`upper` is -2 kV, but must be above `lower`, which is 48 V",
        ),
        (r#"LowPass(tau: "-1 min * 2")"#, "`tau` is -2 min, but must be positive"),
        (r#"LowPass(tau: -0.05)"#, "`tau` is -0.05 s, but must be positive"),
        (r#"LowPass(tau: "1 ms - 1 s")"#, "`tau` is -0.999 s, but must be positive"),
    ] {
        let text = format!("Diagram(blocks: {{ \"a\": {text} }}, connections: [])");
        let (compiled, _) = compile_with(&Desk::new().with("a.ron", &text), Path::new("a.ron"), &[]);
        let found = compiled.problems.iter().find(|problem| problem.code == "parameter");
        assert_eq!(found.map(|problem| problem.message.as_str()), Some(message));
    }
}

#[test]
fn examples_and_defaults_meet_the_requirements() {
    for info in kinds() {
        assert_eq!(problems(info, &[]), [] as [String; 0], "{}", info.kind);
    }
}

#[test]
fn whoever_is_compared_with_is_there_and_can_be_looked_at() {
    for (info, parameter) in required() {
        for other in parameter.requires.list.iter().filter_map(Requirement::other) {
            let known = info.parameters.iter().any(|known| known.name == other);
            assert!(known, "{}.{} is compared with `{other}`", info.kind, parameter.name);
        }
    }
}

/// A requirement that a parameter alone meets or not, of those whose values are plain.
fn own(parameter: &ParameterInfo) -> Option<&Requirement> {
    let alone = |one: &&Requirement| one.other().is_none() && **one != Requirement::Unit;
    parameter.requires.list.iter().find(alone)
}

#[test]
fn two_mistakes_are_both_reported_whatever_the_kind() {
    let mut looked = 0;
    for info in kinds() {
        let two: Vec<(&ParameterInfo, &Requirement)> =
            info.parameters.iter().filter_map(|parameter| Some((parameter, own(parameter)?))).collect();
        let [first, .., last] = two[..] else { continue };
        let values =
            [first, last].map(|(parameter, one)| (parameter.name, violation(info, parameter, one).0));
        let found = problems(info, &values.each_ref().map(|(name, value)| (*name, value.as_str())));
        for (name, value) in &values {
            let named = found.iter().filter(|message| {
                message.starts_with(&format!("`{name}`")) || message.starts_with(&format!("`{name}["))
            });
            assert_eq!(named.count().min(1), 1, "{}.{name} = {value}: {found:?}", info.kind);
        }
        looked += 1;
    }
    assert!(looked > 120, "only {looked} kinds");
}

#[test]
fn what_cannot_be_read_is_reported_beside_what_is_not_allowed_and_has_no_consequences() {
    let mut looked = 0;
    for info in kinds() {
        let numbers: Vec<&ParameterInfo> = info
            .parameters
            .iter()
            .filter(|parameter| parameter.rust_type == "f64" && own(parameter).is_some())
            .collect();
        let [unread, .., wrong] = numbers[..] else { continue };
        let (value, _) = violation(info, wrong, own(wrong).expect("a requirement"));
        let found = problems(info, &[(unread.name, "true"), (wrong.name, &value)]);
        assert_eq!(found.len(), 2, "{}: {found:?}", info.kind);
        assert!(found.iter().any(|message| message.contains("expected a number")), "{found:?}");
        assert!(found.iter().any(|message| message.contains(&format!("`{}`", wrong.name))), "{found:?}");
        looked += 1;
    }
    assert!(looked > 60, "only {looked} kinds");
}
