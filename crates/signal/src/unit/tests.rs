use super::*;
use crate::{Value, evaluate, si_text, unit_table::symbols};
use std::f64::consts::PI;

fn scale(text: &str) -> f64 {
    Unit::parse(text).unwrap().scale
}

fn dimension(text: &str) -> Dimension {
    Unit::parse(text).unwrap().dimension
}

fn help(text: &str) -> String {
    Unit::parse(text).unwrap_err().help.unwrap_or_default()
}

#[test]
fn units_have_the_scales_of_the_si_brochure() {
    for (text, expected) in [
        ("kW", 1e3),
        ("mH", 1e-3),
        ("rpm", 2.0 * PI / 60.0),
        ("rev", 2.0 * PI),
        ("deg", PI / 180.0),
        ("%", 0.01),
        ("1", 1.0),
        ("kWh", 3.6e6),
        ("Ah", 3600.0),
        ("bar", 1e5),
        ("L", 1e-3),
        ("t", 1e3),
        ("km/h", 1000.0 / 3600.0),
        ("kg*m^2", 1.0),
        ("mm^2", 1e-6),
        ("N*m/(rad/s)", 1.0),
        ("1/(V*s)", 1.0),
        ("m^-2", 1.0),
        ("µm", 1e-6),
        ("kΩ", 1e3),
        ("N·m²", 1.0),
        ("kVA", 1e3),
        ("kvar", 1e3),
        ("g*mm^2", 1e-9),
    ] {
        let error = (scale(text) / expected - 1.0).abs();
        assert!(error < 4.0 * f64::EPSILON, "{text}: {} != {expected}", scale(text));
    }
}

#[test]
fn equal_dimensions_come_out_of_different_words() {
    for (a, b) in [
        ("N*m*rad/s", "W"),
        ("N*m", "J"),
        ("VA", "W"),
        ("var", "W"),
        ("V/A", "Ohm"),
        ("V*s", "Wb"),
        ("Wb/A", "H"),
        ("Wb/m^2", "T"),
        ("A*s", "C"),
        ("C/V", "F"),
        ("A/V", "S"),
        ("N/m^2", "Pa"),
        ("N*m/A", "V*s/rad"),
        ("rad", "1"),
        ("deg", "%"),
        ("L", "m^3"),
        ("cycle/s", "Hz"),
    ] {
        assert!(dimension(a).compatible(dimension(b)), "{a} {b}");
    }
}

#[test]
fn cycles_and_radians_do_not_mix() {
    assert!(!dimension("Hz").compatible(dimension("rad/s")));
    assert!(!dimension("Hz").compatible(dimension("1/s")));
    assert!(dimension("rpm").compatible(dimension("rad/s")));
}

#[test]
fn celsius_has_an_offset_and_no_products() {
    let celsius = Unit::parse("degC").unwrap();
    assert_eq!((celsius.to_si(20.0), celsius.from_si(293.15)), (293.15, 20.0));
    assert_eq!(Unit::parse("°C").unwrap().offset, 273.15);
    for text in ["degC/s", "W/degC", "degC^2", "1/degC"] {
        assert!(Unit::parse(text).unwrap_err().message.contains("degC"), "{text}");
    }
}

#[test]
fn conversion_rounds_as_the_literal_does() {
    for n in 0..2000 {
        let literal: f64 = format!("{n}e-3").parse().unwrap();
        assert_eq!(Unit::parse("ms").unwrap().to_si(f64::from(n)), literal);
        let literal: f64 = format!("{n}e-6").parse().unwrap();
        assert_eq!(Unit::parse("mm^2").unwrap().to_si(f64::from(n)), literal);
    }
}

#[test]
fn conversion_and_back_is_the_identity() {
    for symbol in symbols() {
        let unit = Unit::parse(&symbol).unwrap();
        for value in [0.0, 1.0, -2.5, 1234.5678] {
            let back = unit.from_si(unit.to_si(value));
            // The offset of 273.15 costs digits of small numbers.
            let tolerance = 4.0 * f64::EPSILON * (value.abs() + unit.offset / unit.scale);
            assert!((back - value).abs() <= tolerance, "{symbol}: {back} != {value}");
        }
    }
}

#[test]
fn every_named_unit_prints_as_an_si_unit_that_reads_back() {
    let mut seen = 0;
    for a in symbols() {
        let si = Unit::parse(&dimension(&a).to_string()).unwrap();
        assert_eq!((si.scale, si.dimension), (1.0, dimension(&a)), "{a}");
    }
    let short =
        ["m", "kg", "s", "A", "K", "mol", "cd", "cycle", "rad", "N", "W", "V", "Ohm", "F", "Hz", "Wb", "Pa"];
    for a in short {
        for b in short {
            for c in short {
                let text = format!("{a}*{b}^2/({c}*{b})");
                let dimension = dimension(&text);
                let printed = dimension.to_string();
                let si = Unit::parse(&printed).unwrap();
                assert!(printed.is_ascii());
                assert_eq!(si.scale, 1.0, "{text} -> {printed}");
                assert!(si.dimension.compatible(dimension), "{text} -> {printed}");
                assert_eq!(si.dimension.to_string(), printed, "{text}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 17 * 17 * 17);
}

#[test]
fn quantities_read_back_to_the_last_bit() {
    struct Nothing;
    impl crate::Scope for Nothing {
        fn lookup(&self, _: &str) -> crate::Lookup {
            crate::Lookup::Unknown
        }
        fn names(&self) -> Vec<String> {
            Vec::new()
        }
    }
    for symbol in symbols() {
        for value in [0.1, -3.0, 1e-300, 5e-324, 1.7976931348623157e308, 2.0 / 3.0, 12345.6789] {
            let text = si_text(value, dimension(&symbol));
            let Ok(Value::Number(read)) = evaluate(&text, &Nothing) else { panic!("{text}") };
            assert_eq!((read.value, read.dimension), (value, dimension(&symbol)), "{text}");
        }
    }
}

#[test]
fn si_units_bear_their_printed_name() {
    let torque = Unit::si(dimension("N*m"));
    assert_eq!((torque.text.as_str(), torque.to_si(2.0), torque.from_si(2.0)), ("N*m", 2.0, 2.0));
    assert_eq!(Unit::si(Dimension::NONE).to_string(), "1");
}

/// NIST Special Publication 811 (2008), appendix B.8, to the digits that it gives.
#[test]
fn units_of_other_traditions_are_exact() {
    for (text, value) in [
        ("in", 0.0254),
        ("ft", 0.3048),
        ("lb", 0.453_592_37),
        ("lbf", 4.448_222),
        ("ft*lbf", 1.355_818),
        ("hp", 745.6999),
        ("gauss", 1e-4),
        ("lbf/in^2", 6894.757),
    ] {
        let unit = Unit::parse(text).unwrap();
        assert!((unit.to_si(1.0) / value - 1.0).abs() < 3e-7, "{text}: {}", unit.to_si(1.0));
    }
    assert_eq!(Unit::parse("kNm").unwrap().to_si(3.0), 3000.0);
    assert_eq!(Unit::parse("Nm").unwrap().dimension, dimension("N*m"));
}

#[test]
fn an_unknown_unit_names_what_may_be_meant() {
    for (text, remedy) in [
        ("NM", "did you mean `Nm`?"),
        ("inches", "write `in`"),
        ("pounds", "write `lb`"),
        ("Vs", "write `V*s`"),
        ("KW", "did you mean `kW`?"),
        ("Kg", "did you mean `kg`?"),
        ("ohms", "write `ohm`"),
        ("sec", "write `s`"),
        ("Volts", "write `V`"),
        ("degrees", "write `deg`"),
        ("rmp", "did you mean `rpm`?"),
        ("l", "write `L`"),
    ] {
        assert_eq!(help(text), remedy, "{text}");
    }
    assert!(help("quux").starts_with("units are SI symbols"));
    assert_eq!(help("degF"), "a temperature in degrees Fahrenheit is (value - 32) / 1.8 degC");
    assert_eq!(help("mph"), "1 mph is 0.44704 m/s");
    let error = Unit::parse("N*quux").unwrap_err();
    assert_eq!((error.to_string().as_str(), error.span), ("unknown unit `quux`", 2..6));
}

/// What is put into a text is the same quantity with the same prefix; `None` where that is not sure.
#[test]
fn only_what_is_meant_beyond_doubt_replaces_an_unknown_unit() {
    for (text, remedy) in [
        ("kmh", Some("km/h")),
        ("psi", Some("lbf/in^2")),
        ("mm2", Some("mm^2")),
        ("cm3", Some("cm^3")),
        ("inlb", Some("in*lbf")),
        ("mAs", Some("mA*s")),
        ("Nms", Some("Nm*s")),
        ("kNs", Some("kN*s")),
        ("Pas", Some("Pa*s")),
        ("KW", Some("kW")),
        ("hz", Some("Hz")),
        ("rads", Some("rad")),
        ("rmp", Some("rpm")),
        ("mss", Some("ms")),
        ("degF", None),
        ("dBm", None),
        ("gpm", None),
        ("kp", None),
        ("Mm", None),
        ("mhz", None),
        ("k", None),
        ("n", None),
        ("PA", None),
        ("Nmm", None),
        ("gW", None),
        ("Vm", None),
    ] {
        assert_eq!(crate::unit_hint::remedy(text).as_deref(), remedy, "{text}");
    }
}

#[test]
fn what_is_no_unit_is_refused_with_its_place() {
    for (text, span) in [
        ("", 0..0),
        ("  ", 0..2),
        ("N m", 2..3),
        ("N*", 2..2),
        ("m^x", 2..3),
        ("m^0.5", 2..5),
        ("m^2^3", 3..4),
        ("m^300", 2..5),
        ("m^100*m^100", 0..11),
        ("mm^120", 0..6),
        ("N*(m", 4..4),
        ("5 m", 0..1),
        ("m)", 1..2),
        ("$", 0..1),
    ] {
        assert_eq!(Unit::parse(text).unwrap_err().span, span, "{text}");
    }
    let deep = format!("{}m{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(Unit::parse(&deep).is_err());
    let deep = format!("{}m{}", "(".repeat(10_000), ")".repeat(10_000));
    assert!(Unit::parse(&deep).unwrap_err().message.contains("too deeply"));
}
