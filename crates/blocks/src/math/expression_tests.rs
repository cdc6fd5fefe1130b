use super::super::elements::{dimension, given};
use super::*;
use blocksim_block::testing::Bench;
use blocksim_signal::{Quantity, Unit, Value};

fn quantity(text: &str) -> ParamValue {
    let (number, unit) = text.split_once(' ').unwrap_or((text, "1"));
    let unit = Unit::parse(unit).unwrap();
    ParamValue(Value::Number(Quantity::new(unit.to_si(number.parse().unwrap()), unit.dimension)))
}

fn law(text: &str, parameters: &[(&str, &str)]) -> Expression {
    let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), quantity(value)));
    Expression { law: text.to_owned(), parameters: parameters.collect() }
}

fn error(text: &str, parameters: &[(&str, &str)]) -> ParamError {
    law(text, parameters).try_build().expect_err(text)[0].clone()
}

#[test]
fn names_are_inputs_in_the_order_of_the_text_or_parameters() {
    let mut bench = Bench::new(law("sin(u1) * u2 + p", &[("p", "3")]));
    let names: Vec<&str> = bench.interface.inputs.iter().map(|input| input.name.as_str()).collect();
    assert_eq!(names, ["u1", "u2"]);
    assert_eq!(bench.interface.turning_inputs, [0]);
    assert_eq!(bench.set(0, &[0.5]).set(1, &[2.0]).major(), [0.5_f64.sin() * 2.0 + 3.0]);
}

#[test]
fn a_word_that_is_an_input_ends_a_unit() {
    let mut bench = Bench::new(law("m * a + 2 * m * b", &[]));
    assert_eq!(bench.set(0, &[3.0]).set(1, &[5.0]).set(2, &[7.0]).major(), [57.0]);
    let interface =
        law("m * a + 2 m/s^2 * m", &[]).built().interface(&given(&[("m", "kg"), ("a", "m/s^2")], &[]));
    assert_eq!(interface.unwrap().outputs[0].port_type.dimension, Some(dimension("N")));
}

#[test]
fn elements_are_computed_one_by_one_and_scalars_count_for_all() {
    let inputs = vec![("a".to_owned(), PortType::vector(3)), ("b".to_owned(), PortType::scalar())];
    let mut bench = Bench::with_inputs(law("if(a > b, a, sign(b)) + abs(a)", &[]), inputs);
    assert_eq!(bench.set(0, &[1.0, -5.0, 3.0]).set(1, &[2.0]).major(), [2.0, 6.0, 6.0]);
    assert_eq!((bench.d.len(), bench.interface.guards.len()), (6, 9));
    assert_eq!(bench.guards(), [-1.0, 2.0, 1.0, -7.0, 2.0, -5.0, 1.0, 2.0, 3.0]);
    // Comparisons and signs are held, the rest is not.
    assert_eq!(bench.set(0, &[4.0, -5.0, 1.0]).minor(), [5.0, 6.0, 2.0]);
    assert_eq!(bench.major(), [8.0, 6.0, 2.0]);
}

#[test]
fn a_comparison_gives_a_truth_value_and_conditions_are_truth_values() {
    let mut bench = Bench::new(law("and(on, u > 2)", &[]));
    assert_eq!(bench.interface.inputs[0].kind, Some(Kind::Bool));
    assert_eq!(bench.interface.outputs[0].port_type.kind, Kind::Bool);
    assert_eq!(bench.set(0, &[1.0]).set(1, &[3.0]).major(), [1.0]);
    assert_eq!(bench.set(0, &[0.0]).major(), [0.0]);
}

#[test]
fn units_follow_the_law() {
    let unit = |text: &str, inputs: &[(&str, &str)], parameters: &[(&str, &str)]| {
        let interface = law(text, parameters).built().interface(&given(inputs, &[]))?;
        Ok::<_, InterfaceError>(interface.outputs[0].port_type.dimension)
    };
    assert_eq!(unit("u * i", &[("u", "V"), ("i", "A")], &[]), Ok(Some(dimension("W"))));
    assert_eq!(unit("u * i", &[("u", "V")], &[]), Ok(None));
    assert_eq!(unit("p * i^2", &[("i", "A")], &[("p", "2 ohm")]), Ok(Some(dimension("W"))));
    assert_eq!(unit("u + p", &[("u", "V")], &[("p", "2")]), Ok(Some(dimension("V"))));
    assert_eq!(unit("x^n", &[("x", "m")], &[("n", "3")]), Ok(Some(dimension("m^3"))));
    let wrong = unit("2 * (u + i)", &[("u", "V"), ("i", "A")], &[]).unwrap_err();
    assert_eq!((wrong.code, wrong.message.as_str()), ("unit_mismatch", "cannot add V and A in `u + i`"));
    assert_eq!(wrong.ports, ["u", "i"]);
    assert_eq!(unit("u + 1", &[("u", "V")], &[]).unwrap_err().message, "cannot add V and 1 in `u + 1`");
}

#[test]
fn mistakes_of_the_text_have_their_place() {
    let wrong = error("1 + sinn(u)", &[]);
    assert_eq!((wrong.param.as_str(), wrong.span.clone()), ("law", Some(4..8)));
    assert_eq!(wrong.message, "unknown function `sinn`");
    assert_eq!(wrong.help.as_deref(), Some("did you mean `sin`?"));
    for (text, parameters, message) in [
        ("", &[][..], "empty expression"),
        ("u + gian", &[("gain", "2")], "the law does not use its parameter `gain`"),
        ("y + 1", &[], "an input cannot have the name of the output, `y`"),
        ("u / 0", &[], "`u / 0` has no value: it needs a number that is other than 0, not 0"),
        ("u + ln(p)", &[("p", "-1")], "`ln(p)` has no value: it needs a number that is positive, not -1"),
        ("if(p, 1, 2)", &[("p", "1")], "`p` is a number, but the law needs true or false"),
        ("u + if", &[], "`if` has a meaning of its own in a law"),
        ("u + sin", &[("sin", "1")], "`sin` has a meaning of its own in a law"),
        ("u", &[("a b", "1")], "`a b` is not a valid name"),
        ("°", &[], "`°` is not a valid name"),
    ] {
        assert_eq!(error(text, parameters).message, message, "{text}");
    }
    assert_eq!(
        error("u + gian", &[("gain", "2")]).help.as_deref(),
        Some("is `gian` in the law meant to be `gain`?")
    );
    let long: String = (0..2000).map(|i| format!("u{i} * ")).collect();
    let inputs = vec![("u0".to_owned(), PortType::vector(10_000))];
    let many = law(&format!("{long}1"), &[]).built().interface(&Given::new(inputs, Default::default()));
    assert_eq!(many.unwrap_err().code, "too_large");
}

#[test]
#[should_panic(expected = "`ln(u)` has no value at -2: the number must be positive")]
fn where_the_law_has_no_value_it_says_so() {
    Bench::new(law("1 + ln(u)", &[])).respond(-2.0);
}

#[test]
#[should_panic(expected = "division by zero in `1 / u`")]
fn a_division_by_zero_stops() {
    Bench::new(law("if(u < 1, 1 / u, 0)", &[])).respond(0.0);
}

#[test]
fn a_branch_that_is_not_taken_needs_no_value() {
    let mut bench = Bench::new(law("if(u > 0, ln(u), if(u < 0, ln(-u), 0))", &[]));
    assert_eq!(
        [bench.respond(-2.0), bench.respond(2.0), bench.respond(0.0)],
        [2.0_f64.ln(), 2.0_f64.ln(), 0.0]
    );
    // Within a step the branch is held, but where it has no value the other one is taken.
    bench.set(0, &[1.0]).major();
    assert_eq!(bench.set(0, &[-1e-3]).minor(), [1e-3_f64.ln()]);
    let mut safe = Bench::new(law("if(and(u != 0, 1 / u > 2), 1, 0)", &[]));
    assert_eq!([safe.respond(0.0), safe.respond(0.25), safe.respond(1.0)], [0.0, 1.0, 0.0]);
}

#[test]
fn what_is_not_a_number_is_not_hidden() {
    for text in ["abs(u)", "min(u, 1)", "max(1, u)", "sign(u)", "floor(u)", "ln(u)", "1 / u", "u^0.5"] {
        assert!(Bench::new(law(text, &[])).respond(f64::NAN).is_nan(), "{text}");
    }
}

#[test]
fn a_law_without_inputs_is_constant() {
    let mut bench = Bench::new(law("2 * p + 1 m", &[("p", "0.5 m")]));
    assert_eq!(bench.interface.sample_time, Some(SampleTime::Constant));
    assert_eq!(bench.major(), [2.0]);
}
