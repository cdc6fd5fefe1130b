//! Groups of parameters that kinds of block share.

use blocksim_block::prelude::*;
use serde::de::value::{Error, MapDeserializer};

/// What all springs have.
#[derive(Debug, Clone, PartialEq, Parameters)]
struct Shaft {
    /// Stiffness.
    #[block(unit = "N*m/rad")]
    k: f64,
    /// Damping.
    #[block(unit = "N*m*s/rad", default = 0.1)]
    d: f64,
}

/// A shaft with two ends.
#[derive(Debug, Clone, PartialEq, Parameters)]
struct Coupling {
    /// Play.
    #[block(unit = "rad", default = 0.0)]
    play: f64,
    /// Between the ends.
    #[block(group)]
    shaft: Shaft,
}

/// A toy.
#[derive(Debug, Clone, PartialEq, BlockMeta)]
#[block(category = "Toys")]
struct Toy {
    /// Mass.
    #[block(unit = "kg")]
    m: f64,
    /// At its left.
    #[block(group(play = 0.5))]
    coupling: Coupling,
    /// Length.
    #[block(unit = "m", default = 2.0)]
    length: f64,
    /// Made later.
    #[block(skip)]
    made: usize,
}

impl Block for Toy {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new())
    }
}

fn read(written: &[(&'static str, f64)]) -> Result<Toy, Error> {
    Toy::from_deserializer("Toy", MapDeserializer::new(written.iter().copied()))
}

#[test]
fn the_parameters_of_a_group_stand_in_its_place() {
    let info = BlockInfo::find("Toy").expect("a kind");
    let shown: Vec<_> = info.parameters.iter().map(|p| (p.name, p.unit, p.default, p.doc)).collect();
    assert_eq!(
        shown,
        [
            ("m", "kg", None, "Mass."),
            ("play", "rad", Some("0.5"), "Play."),
            ("k", "N*m/rad", None, "Stiffness."),
            ("d", "N*m*s/rad", Some("0.1"), "Damping."),
            ("length", "m", Some("2.0"), "Length."),
        ]
    );
}

#[test]
fn a_group_is_read_flat_and_its_defaults_can_be_others() {
    let toy = read(&[("k", 3.0), ("length", 4.0), ("m", 1.0)]).expect("a toy");
    let coupling = Coupling { play: 0.5, shaft: Shaft { k: 3.0, d: 0.1 } };
    assert_eq!(toy, Toy { m: 1.0, coupling, length: 4.0, made: 0 });
    let toy = read(&[("d", 7.0), ("play", 0.0), ("k", 3.0), ("m", 1.0)]).expect("a toy");
    assert_eq!(toy.coupling, Coupling { play: 0.0, shaft: Shaft { k: 3.0, d: 7.0 } });
}

#[test]
fn what_is_missing_unknown_or_there_twice_is_named() {
    let message = |written: &[(&'static str, f64)]| read(written).unwrap_err().to_string();
    assert_eq!(message(&[("m", 1.0)]), "missing field `k`");
    assert_eq!(message(&[("k", 1.0), ("k", 2.0), ("m", 1.0)]), "duplicate field `k`");
    let unknown = message(&[("shaft", 1.0)]);
    assert!(unknown.contains("`shaft`") && unknown.contains("`play`, `k`, `d`, `length`"), "{unknown}");
}
