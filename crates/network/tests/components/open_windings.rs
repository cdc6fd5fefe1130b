//! Induction machines whose windings are connected outside: in delta and in a star, against machines that are connected
//! inside.

use blocksim_block::physical::{Component, Domain, Element, Part, Pin};
use blocksim_block::{BlockMeta, Given};

use crate::plant::{Plant, close};

/// Joins phase a of one side with phase c of the other, b with a, c with b.
#[derive(Debug, BlockMeta)]
#[block(category = "Toys")]
pub struct Cyclic {}

impl Component for Cyclic {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().port("one", Domain::ThreePhase, "").port("two", Domain::ThreePhase, "");
        (0..3).fold(part, |part, k| {
            part.element(Element::Junction { p: Pin::Phase(0, (k + 1) % 3), n: Pin::Phase(1, k) })
        })
    }
}

/// Joins three phases in one point, on ground or not.
#[derive(Debug, BlockMeta)]
#[block(category = "Toys")]
pub struct StarPoint {
    /// On ground.
    grounded: bool,
}

impl Component for StarPoint {
    fn part(&self, _given: &Given) -> Part {
        let point = if self.grounded { Pin::Ground } else { Pin::Inner(0) };
        let part = Part::new().port("ac", Domain::ThreePhase, "");
        (0..3).fold(part, |part, k| part.element(Element::Junction { p: Pin::Phase(0, k), n: point }))
    }
}

const SATURATED: &str = ", saturation: Table(current: List([Number(0.0, []), Number(0.2, []), Number(0.4, []), \
     Number(1.0, [])]), voltage: List([Number(0.0, []), Number(0.6, []), Number(1.0, []), Number(1.3, [])]))";

fn machine(connection: &str, more: &str) -> String {
    format!(
        "AsynchronousMachine(rated_power: 15e3, rated_voltage: 220.0, rated_frequency: 60.0, pole_pairs: 1, \
         r_s: 0.25, x_ls: 0.9, r_r: 0.14, x_lr: 0.41, x_m: 17.0, x_0: 0.7, connection: {connection}{more})"
    )
}

/// A machine with its rotor, started on the mains; `outside` connects its windings.
fn started(connection: &str, more: &str, outside: Option<(&str, &str)>) -> Plant {
    let machine = machine(connection, more);
    let mut blocks = vec![
        ("source", "ThreePhaseSource(voltage: 220.0, frequency: 60.0)"),
        ("machine", machine.as_str()),
        ("rotor", "Inertia(j: 0.1)"),
        ("frame", "RotationalReference"),
    ];
    let mut connections = vec!["machine.r <-> rotor.r", "machine.c <-> frame.r"];
    match outside {
        None => connections.push("source.ac <-> machine.ac"),
        Some((block, ends)) => {
            blocks.push(("outside", block));
            connections.extend(ends.split(", "));
        }
    }
    Plant::new(&blocks, &connections)
}

const DELTA: (&str, &str) =
    ("Cyclic", "source.ac <-> machine.ac1 <-> outside.one, machine.ac2 <-> outside.two");
const FLOATING: (&str, &str) =
    ("StarPoint(grounded: false)", "source.ac <-> machine.ac1, machine.ac2 <-> outside.ac");
const GROUNDED: (&str, &str) =
    ("StarPoint(grounded: true)", "source.ac <-> machine.ac1, machine.ac2 <-> outside.ac");

#[track_caller]
fn alike(mut inside: Plant, mut outside: Plant) {
    for t in [0.005, 0.02, 0.1] {
        inside.run_to(t, 2e-5);
        outside.run_to(t, 2e-5);
        // The steps err by about 1e-7 of the peak torque, differently in a frame that turns and in one that stands.
        for (output, tolerance) in
            [("torque", 2e-4), ("i_rms", 2e-4), ("power", 0.1), ("pu_vds", 1e-9), ("pu_vqs", 1e-9)]
        {
            let name = format!("machine.{output}");
            close(outside.get(&name), inside.get(&name), tolerance);
        }
        close(outside.get("machine.pu_v0s"), 0.0, 1e-12);
        close(outside.get("machine.pu_i0s"), 0.0, 1e-12);
    }
}

#[test]
fn windings_in_delta_outside_act_as_a_delta_inside() {
    for more in ["", SATURATED] {
        alike(started("Delta", more, None), started("Open", more, Some(DELTA)));
    }
}

#[test]
fn windings_in_a_star_outside_act_as_a_star_inside() {
    for more in ["", SATURATED, ", zero_sequence: Exclude"] {
        for star in [FLOATING, GROUNDED] {
            alike(started("Wye", more, None), started("Open", more, Some(star)));
        }
    }
}
