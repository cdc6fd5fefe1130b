//! Tests of systems of equations in text.

use super::*;
use crate::math::elements::{dimension, given};
use blocksim_block::testing::Bench;
use blocksim_signal::Unit;

fn named(pairs: &[(&str, f64, &str)]) -> BTreeMap<String, ParamValue> {
    let value = |(value, unit): (f64, &str)| {
        let unit = Unit::parse(unit).unwrap();
        ParamValue(Quantity::new(unit.to_si(value), unit.dimension).into())
    };
    pairs.iter().map(|(name, number, unit)| ((*name).to_owned(), value((*number, *unit)))).collect()
}

fn of(law: &str, start: BTreeMap<String, ParamValue>, parameters: BTreeMap<String, ParamValue>) -> OdeSystem {
    OdeSystem { law: law.to_owned(), start, parameters }
}

fn system(law: &str) -> OdeSystem {
    of(law, BTreeMap::new(), BTreeMap::new())
}

fn oscillator() -> OdeSystem {
    of(
        "x' = v\n  v' = (force - d*v - k*x) / m\n\n power = force * v; twice = 2*x",
        named(&[("x", 0.1, "m")]),
        named(&[("m", 2.0, "kg"), ("d", 0.0, "N*s/m"), ("k", 50.0, "N/m")]),
    )
}

#[test]
fn an_oscillator_swings_as_its_closed_form() {
    let force = PortType::scalar().of(Some(dimension("N")));
    let mut bench = Bench::with_inputs(oscillator(), vec![("force".to_owned(), force)]);
    let names: Vec<&str> = bench.interface.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["x", "v", "twice", "power"]);
    bench.set(0, &[1.0]);
    // x = F/k + (x0 - F/k) cos(5 t).
    for _ in 0..10 {
        let y = bench.integrate(0.1, 200).minor();
        let (sin, cos) = (5.0 * bench.t).sin_cos();
        let (x, v) = (0.02 + 0.08 * cos, -0.4 * sin);
        for (found, expected) in y.iter().zip([x, v, 2.0 * x, v]) {
            assert!((found - expected).abs() < 1e-9, "{y:?}");
        }
    }
}

#[test]
fn only_what_depends_on_inputs_feeds_through() {
    let force = PortType::scalar().of(Some(dimension("N")));
    let interface = Bench::with_inputs(oscillator(), vec![("force".to_owned(), force)]).interface;
    let reads = |output: usize| interface.reads(interface.group_of[output], 0);
    assert_eq!([0, 1, 2, 3].map(reads), [false, false, false, true]);
}

#[test]
fn modes_are_chosen_with_the_inputs_that_choose_them_and_states_do_not_wait_for_them() {
    let interface = Bench::new(system("x' = if(u > 0, 1, -1); full = x > 1")).interface;
    // What follows from the state is chosen with it; the mode of the derivative with a group without outputs, which knows the input.
    assert_eq!(interface.group_of, [0, 0]);
    assert!(!interface.reads(0, 0) && interface.settles_in(0));
    assert!(interface.reads(1, 0) && interface.settles_in(1));
}

#[test]
fn units_follow_from_start_values_and_rates_and_must_fit() {
    let unit = |system: &OdeSystem, inputs: &[(&str, &str)]| {
        let interface = system.clone().built().interface(&given(inputs, &[]))?;
        Ok::<_, InterfaceError>(interface.outputs.iter().map(|y| y.port_type.dimension).collect::<Vec<_>>())
    };
    let in_units = |units: [&str; 4]| units.map(|unit| Some(dimension(unit))).to_vec();
    assert_eq!(unit(&oscillator(), &[("force", "N")]), Ok(in_units(["m", "m/s", "m", "W"])));
    let error = unit(&oscillator(), &[("force", "V")]).unwrap_err();
    assert_eq!((error.code, error.ports), ("unit_mismatch", vec!["force".to_owned()]));
    // The unit of a state without a start value follows from its rate.
    assert_eq!(unit(&system("q' = i"), &[("i", "A")]), Ok(vec![Some(dimension("C"))]));
    assert_eq!(unit(&system("x' = 1 - x"), &[]).unwrap().len(), 1);
    let wrong = of("x' = a*x", named(&[("x", 1.0, "m")]), named(&[("a", 1.0, "V")]));
    let error = &wrong.try_build().unwrap_err()[0];
    assert_eq!(error.span, Some(5..8));
    assert!(error.message.contains("must be in m/s"), "{}", error.message);
}

#[test]
fn what_jumps_is_a_mode_and_is_watched() {
    // A state of rest between two limits, and a condition as an output.
    let law = "x' = if(and(x > 1, u > 0), 0, u); full = x > 1; speed = abs(x)";
    let mut bench = Bench::new(system(law));
    assert!(bench.interface.settles);
    bench.set(0, &[1.0]).major();
    assert_eq!(bench.derivatives(), [1.0]);
    bench.x = vec![1.5];
    // Within a step what was chosen is held.
    assert_eq!(bench.derivatives(), [1.0]);
    assert_eq!(bench.major(), [1.5, 1.5, 1.0]);
    assert_eq!(bench.derivatives(), [0.0]);
    let names: Vec<&str> = bench.interface.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["x", "speed", "full"], "what jumps comes last");
    assert_eq!(bench.interface.outputs[2].port_type.kind, Kind::Bool);
    assert_eq!(bench.guards().len(), bench.interface.guards.len());
}

#[test]
fn a_formula_may_go_on_within_parentheses_and_rates_use_definitions() {
    let mut bench = Bench::new(system("f = 2 * (u\n + 1)\nx' = f"));
    bench.set(0, &[3.0]).major();
    assert_eq!(bench.derivatives(), [8.0]);
    assert_eq!(bench.minor(), [0.0, 8.0]);
}

#[test]
fn a_division_by_zero_is_reported_with_its_part_of_the_text() {
    let mut bench = Bench::new(system("x' = -x;\n y = 1 / (x - u)"));
    let reason = bench.set(0, &[0.0]).failure().unwrap();
    assert!(reason.contains("division by zero in `1 / (x - u)`"), "{reason}");
}

#[test]
fn mistakes_are_placed_in_the_text() {
    for (law, part, what) in [
        ("x = 3", "", "no equation for the rate"),
        ("x' = v\nv + 1", "v + 1", "is not an equation"),
        ("x' = ", "x' =", "nothing stands behind"),
        ("x' = 1\nx' = 2", "x'", "two equations for `x`"),
        ("x' = 1\n2y = 3", "2y", "not a valid name"),
        ("x' = 1\nsin = 3", "sin", "meaning of its own"),
        ("x' = 2 * (1 + ", "", "ends too early"),
        ("x' = 1\n y = foo(x)", "foo", "foo"),
        ("x' = x > 1", "x'", "true or false"),
        ("x' = if(x, 1, 2)", "x", "is a number, but true or false is needed"),
        ("x' = y; y = z; z = x", "z", "used before it is defined"),
        ("x' = 1 / 0", "1 / 0", "has no value"),
    ] {
        let error = &system(law).try_build().unwrap_err()[0];
        let shown = error.span.clone().map_or("", |span| &law[span]);
        assert!(error.message.contains(what), "{law}: {}", error.message);
        assert!(
            part.is_empty() || shown == part || shown.contains(part),
            "{law}: `{shown}`: {}",
            error.message
        );
    }
    let misspelt = of("speed' = 1", named(&[("sped", 1.0, "1")]), BTreeMap::new());
    assert_eq!(misspelt.try_build().unwrap_err()[0].help.as_deref(), Some("did you mean `speed`?"));
    let unused = of("x' = 1", BTreeMap::new(), named(&[("k", 1.0, "1")]));
    assert!(unused.try_build().unwrap_err()[0].message.contains("does not use its parameter `k`"));
    let twice = of("x' = 1", BTreeMap::new(), named(&[("x", 1.0, "1")]));
    assert!(twice.try_build().unwrap_err()[0].message.contains("is a parameter as well"));
}
