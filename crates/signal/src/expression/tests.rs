use super::*;
use crate::{Dimension, Unit};
use std::f64::consts::TAU;

struct Names(Vec<(&'static str, Value)>);

impl Scope for Names {
    fn lookup(&self, name: &str) -> Lookup {
        if name == "broken" {
            return Lookup::Failed("`broken` refers to itself".to_string());
        }
        self.0
            .iter()
            .find(|(known, _)| *known == name)
            .map_or(Lookup::Unknown, |(_, v)| Lookup::Found(v.clone()))
    }

    fn names(&self) -> Vec<String> {
        self.0.iter().map(|(name, _)| name.to_string()).collect()
    }
}

fn set(members: &[(&str, Value)]) -> Value {
    Value::Set(members.iter().map(|(name, value)| (name.to_string(), value.clone())).collect())
}

fn quantity(value: f64, unit: &str) -> Value {
    Quantity::new(value, Unit::parse(unit).unwrap().dimension).into()
}

/// A robot, a move, and the names m, r, x and pi that could be mistaken for something else.
fn scope() -> Names {
    let limits = set(&[("lower", quantity(-1.0, "rad")), ("upper", quantity(2.0, "rad"))]);
    let axis = set(&[("number", 3.0.into()), ("limits", limits), ("mass", quantity(12.5, "kg"))]);
    let target = Value::List(vec![0.1.into(), 0.2.into(), 0.3.into()]);
    Names(vec![
        ("m", 7.0.into()),
        ("r", quantity(0.5, "m")),
        ("x", 3.0.into()),
        ("pi", 3.0.into()),
        ("drive", Value::Text("dc".to_string())),
        ("brake", Value::Bool(true)),
        ("robot", set(&[("axis1", axis.clone()), ("axes", Value::List(vec![axis.clone()]))])),
        ("axis", axis),
        ("move", set(&[("target", target.clone()), ("start", target)])),
    ])
}

fn value(text: &str) -> Value {
    evaluate(text, &scope()).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn error(text: &str) -> ExprError {
    match evaluate(text, &scope()) {
        Err(error) => error,
        Ok(value) => panic!("{text} is {value}"),
    }
}

/// The value in SI with its printed unit.
fn si(text: &str) -> (f64, String) {
    let quantity = value(text).as_number().unwrap();
    (quantity.value, quantity.dimension.to_string())
}

fn check(cases: &[(&str, f64, &str)]) {
    for (text, expected, unit) in cases {
        let (found, dimension) = si(text);
        let tolerance = 8.0 * f64::EPSILON * expected.abs();
        assert!((found - expected).abs() <= tolerance, "{text}: {found} != {expected}");
        assert_eq!(dimension, *unit, "{text}");
    }
}

fn refused(cases: &[(&str, Range<usize>, &str, &str)]) {
    for (text, span, message, help) in cases {
        let error = error(text);
        assert_eq!(error.message, *message, "{text}");
        assert_eq!(error.help.as_deref().unwrap_or_default(), *help, "{text}");
        assert_eq!(error.span, *span, "{text}");
    }
}

#[test]
fn operators_bind_as_in_books() {
    check(&[
        ("1e-3", 1e-3, "1"),
        ("1 + 2 * 3", 7.0, "1"),
        ("(1 + 2) * 3", 9.0, "1"),
        ("8 - 4 - 2", 2.0, "1"),
        ("8 / 4 / 2", 1.0, "1"),
        ("2^3^2", 512.0, "1"),
        ("-2^2", -4.0, "1"),
        ("2^-1", 0.5, "1"),
        ("2 * -3", -6.0, "1"),
        ("- -3", 3.0, "1"),
        ("+3 - +2", 1.0, "1"),
        ("4^0.5", 2.0, "1"),
        ("(-2)^3", -8.0, "1"),
    ]);
}

#[test]
fn a_number_takes_its_unit_greedily() {
    check(&[
        ("12.5 kW", 12_500.0, "W"),
        ("0.8 mH", 0.0008, "H"),
        ("0.8mH", 0.0008, "H"),
        ("3000 rpm", 100.0 * PI, "rad/s"),
        ("20 1/s", 20.0, "1/s"),
        ("20 1/(V*s)", 20.0, "1/Wb"),
        ("9.81 m/s^2", 9.81, "m/s^2"),
        ("9.81 [m/s^2]", 9.81, "m/s^2"),
        ("5 %", 0.05, "1"),
        ("90°", PI / 2.0, "rad"),
        ("3 min", 180.0, "s"),
        ("(1 + 2) ms", 0.003, "s"),
        ("(1 + 2) [ms]", 0.003, "s"),
        ("sqrt(4) kV", 2000.0, "V"),
        ("-2 m^2", -2.0, "m^2"),
        ("2 µF", 2e-6, "F"),
        ("0 deg", 0.0, "rad"),
        ("3 m²", 3.0, "m^2"),
        ("1/2 s", 0.5, "1/s"),
    ]);
}

#[test]
fn a_name_never_wins_against_the_unit_behind_a_number() {
    check(&[("2 m", 2.0, "m"), ("2 * m", 14.0, "1"), ("(2) m", 2.0, "m"), ("2 [m]", 2.0, "m")]);
}

#[test]
fn behind_an_operator_a_name_wins_against_a_unit() {
    check(&[
        ("12 V * x", 36.0, "V"),
        ("12 V * s", 12.0, "Wb"),
        ("0.5 kg * m^2", 0.5 * 49.0, "kg"),
        ("0.5 [kg*m^2]", 0.5, "kg*m^2"),
        ("3 N * r", 1.5, "N*m"),
        ("10 V/(x + 2)", 2.0, "V"),
        ("10 V / (m)", 10.0 / 7.0, "V"),
        ("2 s * min(3, 4)", 6.0, "s"),
        ("6 V / 2", 3.0, "V"),
        ("2 kg * axis.number", 6.0, "kg"),
        ("10 V / (2 A)", 5.0, "Ohm"),
        ("5 s / 1 A", 5.0, "s/A"),
        ("6 V/1", 6.0, "V"),
    ]);
}

#[test]
fn a_unit_written_without_spaces_stays_whole_whatever_is_named() {
    check(&[("0.5 kg*m^2", 0.5, "kg*m^2"), ("10 V/m", 10.0, "V/m"), ("3 N*m*x", 9.0, "N*m")]);
}

/// `m` is a name in the scope, so compound units with metres are told apart above; here nothing is named.
#[test]
fn without_such_a_name_compound_units_are_read_whole() {
    let empty = Names(Vec::new());
    for (text, unit) in [("1 kg*m^2", "kg*m^2"), ("1 N*m/(rad/s)", "N*m*s/rad"), ("1 W/(m*K)", "W/(m*K)")] {
        let found = evaluate(text, &empty).unwrap().as_number().unwrap();
        assert_eq!((found.value, found.dimension.to_string().as_str()), (1.0, unit));
    }
}

#[test]
fn dimensions_follow_the_calculation() {
    check(&[
        ("2 A * 3 Ohm", 6.0, "V"),
        ("5 N*s * 2", 10.0, "N*s"),
        ("(3 V)^2 / (9 W)", 1.0, "Ohm"),
        ("sqrt(9 V^2)", 3.0, "V"),
        ("1 + 90 deg", 1.0 + PI / 2.0, "rad"),
        ("2 [N*m] * 3 rad/s", 6.0, "W"),
        ("1 [N*m/A] * 2 A", 2.0, "N*m"),
        ("5 s^2 / 1 s", 5.0, "s"),
        ("4^(1 rad / 2)", 2.0, "1"),
        ("10 [kg] * 9.81 [m/s^2]", 98.1, "N"),
    ]);
}

#[test]
fn frequencies_are_converted_on_request() {
    check(&[
        ("angular(50 Hz)", 50.0 * TAU, "rad/s"),
        ("cycles(50 rad/s)", 50.0 / TAU, "Hz"),
        ("cycles(3000 rpm)", 50.0, "Hz"),
        ("cycles(50 1/s)", 50.0 / TAU, "Hz"),
        ("angular(1 / (2 Hz))", 0.5 / TAU, "s/rad"),
        ("2*pi*50 Hz", 50.0 * TAU, "Hz"),
    ]);
}

#[test]
fn functions_agree_with_closed_forms() {
    check(&[
        ("sin(30 deg)", 0.5, "1"),
        ("cos(pi / 3)", 0.5, "1"),
        ("tan(45 deg)", 1.0, "1"),
        ("asin(1)", PI / 2.0, "rad"),
        ("acos(-1)", PI, "rad"),
        ("atan(1)", PI / 4.0, "rad"),
        ("atan2(1 kV, -1000 V)", 0.75 * PI, "rad"),
        ("exp(ln(5))", 5.0, "1"),
        ("log10(1000)", 3.0, "1"),
        ("abs(-3 V)", 3.0, "V"),
        ("sign(-3 V) + sign(0)", -1.0, "1"),
        ("min(3 V, 2 kV, 1 V)", 1.0, "V"),
        ("max(move.target)", 0.3, "1"),
        ("floor(2.5) + ceil(2.5) + round(2.5)", 8.0, "1"),
    ]);
}

#[test]
fn members_and_items_are_selected() {
    check(&[
        ("robot.axis1.limits.upper", 2.0, "rad"),
        ("robot.axes[0].mass / 2", 6.25, "kg"),
        ("move.target[0]", 0.1, "1"),
        ("move.start[axis.number - 1]", 0.3, "1"),
        ("move.start[0.1 * 3 / 0.1 - 2]", 0.2, "1"),
        ("[1 s, 2 s][1]", 2.0, "s"),
        ("(move.target)[1]", 0.2, "1"),
        ("(robot).axis1.mass", 12.5, "kg"),
        ("pi", PI, "1"),
    ]);
}

#[test]
fn a_name_alone_is_whatever_it_is() {
    assert_eq!(value("drive"), Value::Text("dc".to_string()));
    assert_eq!(value(" brake "), Value::Bool(true));
    assert_eq!(value("false"), Value::Bool(false));
    assert_eq!(value("axis").describe(), "a set of 3");
    assert_eq!(value("[x, 2 s, [drive],]").to_string(), r#"[3, "2 s", [Text("dc")]]"#);
    assert_eq!(value("[]"), Value::List(Vec::new()));
}

#[test]
fn celsius_stands_alone_or_in_a_list() {
    check(&[
        ("20 degC", 293.15, "K"),
        ("-5 degC", 268.15, "K"),
        ("20 [degC]", 293.15, "K"),
        ("-5 [degC]", 268.15, "K"),
        ("[-5 °C, 40 degC][0]", 268.15, "K"),
    ]);
    for text in
        ["20 degC + 1 K", "2 * 20 degC", "(20) degC", "(20 degC)", "- -5 degC", "20 degC^2", "5 W/degC"]
    {
        assert!(error(text).message.contains("degC") || error(text).message.contains("exponent"), "{text}");
    }
}

#[test]
fn incompatible_units_are_both_named() {
    let numbers = "a number with a unit and one without do not mix; give both the same unit";
    let kinds = "only quantities of the same kind can be put together";
    let cycles = "angular() makes rad/s of Hz, cycles() makes Hz of rad/s";
    refused(&[
        ("5 kW + 3 s", 0..10, "cannot add W and s", kinds),
        ("5 kW - 3", 0..8, "cannot subtract W and 1", numbers),
        ("50 Hz + 1 rad/s", 0..15, "cannot add Hz and rad/s", cycles),
        ("50 Hz + 1 1/s", 0..13, "cannot add Hz and 1/s", cycles),
        ("max(1 V, 2 A)", 9..12, "cannot compare V and A", kinds),
    ]);
}

#[test]
fn names_and_units_are_spelled_out() {
    refused(&[
        ("robt.axis1", 0..4, "unknown name `robt`", "did you mean `robot`?"),
        ("robot.axis2", 6..11, "no member `axis2`", "did you mean `axis1`?"),
        ("axis.foo", 5..8, "no member `foo`", "the members are: number, limits, mass"),
        ("2 kQ", 2..4, "unknown unit `kQ`", error("2 kQ").help.as_deref().unwrap()),
        ("2 rmp", 2..5, "unknown unit `rmp`", "did you mean `rpm`?"),
        ("2 Vs", 2..4, "unknown unit `Vs`", "write `V*s`"),
        ("2 x", 2..3, "unknown unit `x`", "to multiply by `x` write `* x`"),
        ("2 pi", 2..4, "unknown unit `pi`", "to multiply by `pi` write `* pi`"),
        (
            "2 * kW",
            4..6,
            "unknown name `kW`",
            "`kW` is also a unit; a unit stands behind a number, as in 1 kW",
        ),
        ("sqr(2)", 0..3, "unknown function `sqr`", "did you mean `sqrt`?"),
        ("sqrt + 1", 0..4, "unknown name `sqrt`", "`sqrt` is a function; write sqrt(...)"),
        ("1 + NaN", 4..7, "`NaN` is not a finite number", "write a number; the largest is about 1.8e308"),
        ("-inf", 1..4, "`inf` is not a finite number", "write a number; the largest is about 1.8e308"),
        ("1 + broken", 4..10, "`broken` refers to itself", ""),
    ]);
}

#[test]
fn a_decimal_comma_is_recognised() {
    const THOUSANDS: &str =
        "write numbers without separators between thousands, with a point before the decimals";
    refused(&[
        ("1,05", 0..4, "`1,05` is not a number", "decimal comma? write 1.05"),
        ("10,000 rpm", 0..6, "`10,000` is not a number", "write 10.000 or 10000, whichever is meant"),
        ("0,250 m", 0..5, "`0,250` is not a number", "decimal comma? write 0.250"),
        ("2 * 1,5 m", 4..7, "`1,5` is not a number", "decimal comma? write 1.5"),
        ("[1,05]", 1..5, "`1,05` is not a number", "decimal comma? write 1.05"),
        ("1.234,5", 0..7, "`1.234,5` is not a number", THOUSANDS),
        ("1,234.5 m", 0..7, "`1,234.5` is not a number", THOUSANDS),
    ]);
    assert_eq!(value("[1,5]").describe(), "a list of 2");
}

#[test]
fn mistakes_of_form_are_shown_where_they_are() {
    let parts =
        "an expression consists of numbers with units, names, + - * / ^, and functions such as sin(...)";
    let closes = "there is no `(` that it closes, or a value is missing before it";
    refused(&[
        ("", 0..0, "empty expression", "write a number, such as 0"),
        ("  ", 0..2, "empty expression", "write a number, such as 0"),
        ("(1 + 2", 0..1, "`(` is not closed", "add `)`"),
        ("sqrt(2", 4..5, "`(` is not closed", "add `)`"),
        ("[1, 2", 0..1, "`[` is not closed", "add `]`"),
        ("1 + 2)", 5..6, "unexpected `)`", closes),
        ("()", 1..2, "unexpected `)`", closes),
        ("1 2", 2..3, "expected an operator before `2`", "write what is to be done with both, as in ... * 2"),
        ("x y", 2..3, "expected an operator before `y`", "write what is to be done with both, as in ... * y"),
        (
            "x max y",
            2..5,
            "expected an operator before `max`",
            "`max` is a function, which stands before its values: max(...)",
        ),
        (
            "r mm",
            2..4,
            "expected an operator before `mm`",
            "a unit stands behind a number or a parenthesis, as in (x) mm",
        ),
        ("1 +", 3..3, "the expression ends too early", "a number or a name is missing at the end"),
        ("2 ** 3", 3..4, "unexpected `*`", "a power is written ^"),
        ("* 2", 0..1, "unexpected `*`", "a number or a name is missing before it"),
        ("=2 * 3", 0..1, "unexpected character `=`", "leave it out: the text is an expression already"),
        ("2 * $k", 4..5, "unexpected character `$`", "a name is written as it is, without a sign before it"),
        ("axis.", 5..5, "expected the name of a member after `.`", ""),
        ("1; 2", 1..2, "unexpected character `;`", parts),
        ("atan2(1)", 0..8, "`atan2` takes 2 arguments, not 1", ""),
        ("sin(1, 5)", 0..9, "`sin` takes one argument, not 2", "a decimal number is written with a point"),
        ("sin()", 0..5, "`sin` takes one argument, not 0", ""),
    ]);
}

#[test]
fn values_of_the_wrong_kind_are_described() {
    let first = "items of a list are selected by index, as in list[0]";
    let bracket = "a unit in brackets stands right behind a number, as in 9.81 [m/s^2]";
    refused(&[
        ("drive * 2", 0..5, "cannot multiply a text", ""),
        ("-brake", 1..6, "cannot negate true or false", ""),
        ("x + axis", 4..8, "cannot add a set of 3", ""),
        ("move.target.x", 12..13, "a list of 3 has no member `x`", first),
        ("x.y", 2..3, "a number has no member `y`", "only a set of parameters has members"),
        ("x[0]", 2..3, "a number has no items", bracket),
        ("(drive) s", 0..7, "cannot give a unit to a text", ""),
    ]);
}

#[test]
fn an_index_stays_in_its_list() {
    let three = "the list has 3 items, counted from 0 to 2";
    refused(&[
        ("move.target[3]", 12..13, "index 3 is out of range", three),
        ("move.target[-1]", 12..14, "index -1 is out of range", three),
        ("move.target[0.5]", 12..15, "an index is a whole number, not 0.5", ""),
        ("move.target[1 s]", 12..15, "an index is a whole number, not 1 s", ""),
        ("[][0]", 3..4, "index 0 is out of range", "the list is empty"),
    ]);
}

#[test]
fn impossible_numbers_are_refused() {
    refused(&[
        ("1 / (2 - 2)", 4..11, "division by zero", ""),
        ("0^-1", 0..1, "division by zero: a negative power of zero", ""),
        ("1e200 * 1e200", 0..13, "the result is beyond the range of 64-bit floating point", ""),
        ("exp(1000)", 0..9, "the result is beyond the range of 64-bit floating point", ""),
        ("1e999", 0..5, "number is beyond the range of 64-bit floating point", ""),
        ("sqrt(-1)", 5..7, "`sqrt` takes a number that is not negative, not -1", ""),
        ("ln(0)", 3..4, "`ln` takes a positive number, not 0", ""),
        ("asin(2)", 5..6, "`asin` takes a number from -1 to 1, not 2", ""),
        ("(-8)^0.5", 0..4, "a negative number has whole powers only", ""),
        ("(2 V)^0.5", 6..9, "a quantity in V has whole powers only, not 0.5", "use sqrt()"),
        ("sqrt(2 V)", 0..9, "the square root of V is not a unit", ""),
        (
            "2^3 V",
            2..5,
            "an exponent is a plain number, not one in V",
            "a unit belongs to the number before it; write (2^3) m",
        ),
        (
            "sin(2 V)",
            4..7,
            "`sin` takes a plain number or an angle, not V",
            "divide by a unit first, as in sin(x / (1 V))",
        ),
        ("angular(2 V)", 8..11, "`angular` takes a frequency in Hz, not V", ""),
        ("(1 m)^100 * (1 m)^100", 0..21, "the exponents of the unit are too large", ""),
    ]);
    assert!(error("min([])").message.contains("empty list"));
}

#[test]
fn depth_and_length_are_bounded() {
    for (open, close) in
        [("(", ")"), ("[", "]"), ("-", ""), ("sqrt(", ")"), ("2^", ""), ("move.target[", "]")]
    {
        for levels in [250, 5_000] {
            let text = format!("{}1{}", open.repeat(levels), close.repeat(levels));
            assert!(error(&text).message.contains("levels deep"), "{open}");
        }
    }
    assert_eq!(si(&format!("{}1{}", "(".repeat(150), ")".repeat(150))).0, 1.0);
    assert!(error(&"1+".repeat(100_000)).message.contains("longer than"));
    assert!(error(&format!("1 V{}", "/(V".repeat(5_000))).message.len() < 200);
    let sum = format!("0{}", "+1".repeat(20_000));
    assert_eq!(si(&sum), (20_000.0, "1".to_string()));
}

/// Words of the language in random order: whatever they make, there is an answer and no panic, and errors point
/// into the text.
#[test]
fn random_words_never_panic() {
    let words = [
        "1",
        "2.5",
        "1e3",
        "m",
        "kW",
        "degC",
        "%",
        "x",
        "axis",
        ".",
        "mass",
        "[",
        "]",
        "(",
        ")",
        "*",
        "/",
        "^",
        "-",
        "+",
        ",",
        " ",
        "sqrt",
        "min",
        "move.target",
        "°",
        "Ω",
        "²",
        "1/",
        "rad/s",
        "pi",
        "$",
        "^-1",
        "µm",
    ];
    let mut seed: u64 = 0x5eed;
    let mut answers = 0;
    for _ in 0..50_000 {
        let mut text = String::new();
        for _ in 0..1 + next(&mut seed) % 9 {
            text.push_str(words[next(&mut seed) as usize % words.len()]);
        }
        match evaluate(&text, &scope()) {
            Ok(value) => {
                answers += 1;
                assert!(value.as_number().is_none_or(|quantity| quantity.value.is_finite()), "{text}");
            }
            Err(error) => assert!(text.get(error.span.clone()).is_some(), "{text}: {error:?}"),
        }
    }
    assert!(answers > 1_000, "{answers}");
}

/// A linear congruential generator (Knuth, MMIX); the upper bits are good enough to pick words.
fn next(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    *seed >> 33
}

#[test]
fn printed_values_read_back() {
    for text in ["3 kV", "[1, 2 s]", "0.1", "-5 mm", "2 N*s", "1e-9"] {
        let printed = match value(text) {
            Value::Number(quantity) => quantity.display(),
            other => other.to_string().replace('"', ""),
        };
        assert_eq!(value(&printed), value(text), "{text} -> {printed}");
    }
    assert_eq!(value("5 rad").as_number().map(|quantity| quantity.dimension), Some(Dimension::RADIAN));
}

#[test]
fn decibels_are_ratios_of_amplitudes() {
    assert_eq!(si("20 dB"), (10.0, "1".to_string()));
    assert_eq!(si("-20 dB"), (0.1, "1".to_string()));
    let Value::List(both) = value("[-6 dB, 0 dB]") else { panic!("a list") };
    assert!((both[0].as_number().unwrap().value - 0.501_187_233_627_272_2).abs() < 1e-15);
    assert_eq!(both[1].as_number().unwrap().value, 1.0);
    for text in ["2 * 3 dB", "3 dB + 3 dB", "-(3 dB)", "3 [dB]", "(3) dB", "3 dB/s", "1 / 3 dB"] {
        let error = error(text);
        assert!(error.help.unwrap_or_default().contains("dB") || error.message.contains("dB"), "{text}");
    }
}

#[test]
fn a_period_is_a_time() {
    let of = |text: &str| value(text).as_number().unwrap().dimension;
    assert!(of("1 s").takes(of("1 / (50 Hz)")) && of("1 s").takes(of("1 / (8 kHz)")));
    assert!(
        !of("1 s").takes(of("50 Hz")) && !of("50 Hz").takes(of("1 s")) && !of("1 / (50 Hz)").takes(of("1 s"))
    );
}

#[test]
fn units_and_names_of_an_expression_are_noted() {
    let robot = set(&[("mass", quantity(2.0, "kg")), ("gains", Value::List(vec![1.0.into(), 2.0.into()]))]);
    let names = Names(vec![("robot", robot), ("n", 3.0.into()), ("r", quantity(0.5, "m"))]);
    for (text, is_bare, units, named) in [
        ("90", true, &[][..], &[][..]),
        ("1 + 2 * pi", true, &[], &[]),
        ("n - 1", true, &[], &["n"]),
        ("1 + n", true, &[], &["n"]),
        ("sqrt(n) * robot.gains[0]", true, &[], &["n", "robot.gains[0]"]),
        ("90 deg", false, &["deg"], &[]),
        ("2 * (45 deg)", false, &["deg"], &[]),
        ("3 [N * m / rad]", false, &["N*m/rad"], &[]),
        ("(1 + 2) N * m", false, &["N*m"], &[]),
        ("3 1/s", false, &["1/s"], &[]),
        ("50 %", false, &["%"], &[]),
        ("4 m / 2 mm", false, &["m", "mm"], &[]),
        ("r / r", false, &[], &["r", "r"]),
        ("n * robot.mass", false, &[], &["n", "robot.mass"]),
    ] {
        let noted = evaluate_noted(text, &names).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        assert_eq!(noted.is_bare, is_bare, "{text}");
        assert_eq!(noted.units.iter().map(|unit| unit.text.as_str()).collect::<Vec<_>>(), units, "{text}");
        assert_eq!(noted.names, named, "{text}");
        let begins = |(start, name): (&usize, &&str)| text[*start..].starts_with(name);
        assert!(noted.starts.iter().zip(named).all(begins) && noted.starts.len() == named.len(), "{text}");
    }
}
