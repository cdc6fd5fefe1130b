use super::*;
use crate::{Dimension, Unit};

fn formula(text: &str) -> Formula {
    Formula::parse(text, &["p"]).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str) -> (String, String) {
    let error = Formula::parse(text, &["p"]).expect_err(text);
    (text[error.span.clone()].to_owned(), format!("{error}; {}", error.help.clone().unwrap_or_default()))
}

fn of(unit: &str) -> Dimension {
    Unit::parse(unit).unwrap().dimension
}

/// The unit of a formula of `u` (V), `i` (A), `x` (open) and `n` (not known).
fn unit(text: &str) -> Result<Option<Dimension>, String> {
    let formula = formula(text);
    let names = |name: &str| match name {
        "u" => Some(of("V")),
        "i" => Some(of("A")),
        "x" => Some(Dimension::OPEN),
        "t" => Some(Dimension::OPEN.times(of("s"))),
        "p" => Some(of("Ohm")),
        _ => None,
    };
    let constant = |node: usize| match &formula.nodes()[node].kind {
        NodeKind::Number(quantity) => Some(quantity.value),
        _ => None,
    };
    formula.dimension(&names, &constant).map_err(|error| error.to_string())
}

#[test]
fn nodes_stand_behind_those_that_they_need() {
    let formula = formula("sin(u1) * u2 + p");
    let kinds: Vec<&NodeKind> = formula.nodes().iter().map(|node| &node.kind).collect();
    let name = |name: &str| NodeKind::Name(name.to_owned());
    assert_eq!(
        kinds,
        [
            &name("u1"),
            &NodeKind::Call(Function::Sin, vec![0]),
            &name("u2"),
            &NodeKind::Binary(Operator::Multiply, 1, 2),
            &name("p"),
            &NodeKind::Binary(Operator::Add, 3, 4),
        ]
    );
    assert_eq!(formula.names(), [("u1", false), ("u2", false), ("p", false)]);
    assert_eq!((formula.text_of(1), formula.text_of(3)), ("sin(u1)", "sin(u1) * u2"));
}

#[test]
fn numbers_with_units_are_in_si_and_names_end_units() {
    assert_eq!(formula("2 km").nodes()[0].kind, NodeKind::Number(Quantity::new(2000.0, of("m"))));
    // `p` is known beforehand.
    assert_eq!(formula("2 N * p").names(), [("p", false)]);
    assert!(matches!(formula("(u + u) mA").nodes()[3].kind, NodeKind::Scale(2, unit) if unit.value == 1e-3));
    assert_eq!(formula("-2^2").nodes().len(), 4);
}

/// A unit takes all symbols that are joined to it without spaces: of a name that is a symbol it must be clear what it is.
#[test]
fn a_name_that_may_be_a_factor_of_a_unit_is_made_clear() {
    let parse = |text: &str| Formula::parse(text, &["V", "m", "s"]);
    let refused = |text: &str| {
        let error = parse(text).expect_err(text);
        (text[error.span.clone()].to_owned(), error.help.clone().unwrap_or_default())
    };
    let (place, help) = refused("-0.5 1/s*V");
    assert_eq!((&*place, &*help), ("V", "write `1/s * V` for the name, `[1/s*V]` for the unit"));
    assert_eq!(refused("2 N*m + 1").0, "m");
    assert_eq!(refused("(1 + 2) kg*m").0, "m");
    let names = |text: &str| {
        parse(text).expect(text).names().iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names("-0.5 1/s * V"), ["V"]);
    assert_eq!(names("-0.5 [1/s*V]"), [""; 0]);
    assert_eq!(names("5 m/s + s + 3 V"), ["s"]);
    assert_eq!(names("2 N*mm"), [""; 0]);
    assert_eq!(names("2*V*m"), ["V", "m"]);
}

#[test]
fn comparisons_bind_loosest_and_do_not_chain() {
    let formula = formula("u + 1 <= 2 * x");
    assert!(matches!(formula.nodes().last().unwrap().kind, NodeKind::Compare(Comparison::LessEqual, 2, 5)));
    assert!(formula.is_truth());
    assert!(error("1 < u < 2").1.contains("true or false where a number is needed"));
}

#[test]
fn what_is_true_or_false_is_told_from_numbers() {
    let names = |text: &str| -> Vec<(String, bool)> {
        formula(text).names().into_iter().map(|(name, truth)| (name.to_owned(), truth)).collect()
    };
    assert_eq!(names("if(on, u, 0)"), [("on".into(), true), ("u".into(), false)]);
    let all = |names: [&str; 4]| names.map(|name| (name.to_owned(), true)).to_vec();
    assert_eq!(names("and(if(on, a, not(b)), c)"), all(["on", "a", "b", "c"]));
    for (text, place, message) in [
        (
            "if(u, u + 1, 0)",
            "u",
            "`u` is used as a number and as true or false; write a comparison, such as u > 0, where a condition is needed",
        ),
        (
            "(u > 0) + 1",
            "(u > 0)",
            "`u > 0` is true or false where a number is needed; write if(u > 0, 1, 0)",
        ),
        ("if(u + 1, 2, 3)", "u + 1", "`u + 1` is a number where a condition is needed; compare it"),
        ("if(u > 1, 2, true)", "if(u > 1, 2, true)", "one branch of `if` is a number"),
        (
            "if(u > 1, u)",
            "if(u > 1, u)",
            "`if` takes 3 arguments, not 2; write if(condition, value, other_value)",
        ),
    ] {
        let (_, found) = error(text);
        assert!(found.contains(message), "{text}: {found} at {place}");
    }
}

#[test]
fn mistakes_have_their_place_and_remedy() {
    for (text, place, message) in [
        ("sinn(u)", "sinn", "unknown function `sinn`; did you mean `sin`?"),
        ("2 + log(u)", "log", "unknown function `log`; write `ln`"),
        ("atan2(u)", "atan2(u)", "`atan2` takes 2 arguments, not 1"),
        (
            "sin(u, 2)",
            "sin(u, 2)",
            "`sin` takes one argument, not 2; a decimal number is written with a point",
        ),
        ("y = u", "=", "unexpected character `=`; write == to compare"),
        ("u > 1 && x > 2", "&", "write and(a, b)"),
        ("[u, 2]", "[u, 2]", "lists, items and members have no place"),
        ("u[0]", "u[0", "lists, items and members have no place"),
        ("u +", "", "the expression ends too early"),
        ("", "", "empty expression"),
        ("2 ** u", "*", "a power is written ^"),
    ] {
        let (at, found) = error(text);
        assert!(at == place && found.contains(message), "{text}: {found} at {at:?}");
    }
    assert!(Formula::parse(&"(".repeat(500), &[]).is_err());
    // A chain is long, not deep.
    assert_eq!(formula(&format!("u{}", "+u".repeat(10_000))).nodes().len(), 20_001);
}

#[test]
fn dimensions_follow_from_names_and_numbers() {
    for (text, expected) in [
        ("u / i", Some(of("Ohm"))),
        ("u + p * i", Some(of("V"))),
        ("u + n", Some(of("V"))),
        ("u * n", None),
        ("x + u", Some(of("V"))),
        ("2^t", Some(Dimension::NONE)),
        ("sin(t)", Some(Dimension::NONE)),
        ("u + t", Some(of("V"))),
        ("t^x", Some(Dimension::OPEN)),
        ("u^2 / p", Some(of("W"))),
        ("sqrt(u * u)", Some(of("V"))),
        ("max(u, 0)", Some(of("V"))),
        ("if(u > 0, i, 2 mA)", Some(of("A"))),
        ("u > 2 kV", Some(Dimension::NONE)),
        ("atan2(u, u)", Some(of("rad"))),
        ("sin(u / (1 V))", Some(Dimension::NONE)),
        ("(2 + 1) V", Some(of("V"))),
        ("mod(u, 1 V)", Some(of("V"))),
    ] {
        assert_eq!(unit(text), Ok(expected), "{text}");
    }
    for (text, message) in [
        ("u + i", "cannot add V and A"),
        ("u + 1", "cannot add V and 1"),
        ("u > i", "cannot compare V and A"),
        ("min(u, i)", "cannot compare V and A"),
        ("if(u > 0, u, i)", "cannot choose between V and A"),
        ("exp(u)", "`exp` takes a plain number or an angle, not V"),
        ("sqrt(u)", "the square root of V is not a unit"),
        ("u^0.5", "a quantity in V has whole powers only, not 0.5"),
        ("2^u", "an exponent is a plain number, not one in V"),
        ("u^n", "the exponent of a quantity in V is a number that does not change"),
    ] {
        assert_eq!(unit(text).unwrap_err(), message, "{text}");
    }
}
