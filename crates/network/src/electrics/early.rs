//! Readings that follow from states alone, whatever valves and resistances do: they close no algebraic loop.

use super::solved::{clean, solve};
use super::sparse::{Row, plus};
use super::{Branch, Early, Electrics, GivenBy, Island, TwoPin};
use crate::assembly::eliminate::Form;

/// The reading of each two-pin, if it is a sensor and its reading follows from states.
pub(super) fn readings(electrics: &Electrics) -> Vec<Option<Early>> {
    let mut readings = vec![None; electrics.two_pins];
    for island in &electrics.islands {
        let of_states = |form: &Form| form.terms().iter().all(|(i, _)| is_state(electrics, *i as usize));
        // Where no valve changes the circuit, its solution tells most: dividers of a capacitance, too.
        let plain = if island.valves.is_empty() { solve(electrics, island, 0).ok() } else { None };
        let plain = plain.filter(|solved| solved.floating.is_none());
        let (voltages, currents) = (voltages(island), currents(island));
        for (position, pin) in island.two_pins.iter().enumerate() {
            let (known, whole) = match pin.branch {
                Branch::Probe => (&voltages[position], plain.as_ref().map(|s| &s.voltages[position])),
                Branch::Wire => (&currents[position], plain.as_ref().map(|s| &s.currents[position])),
                _ => continue,
            };
            let reading = [whole, known.as_ref()].into_iter().flatten().find(|form| of_states(form)).cloned();
            readings[pin.index] = reading.map(|form| match pin.branch {
                Branch::Probe => Early::Voltage(form),
                _ => Early::Current(form),
            });
        }
    }
    readings
}

/// Whether a given value is a state: the voltage of a capacitance, or a current from states.
fn is_state(electrics: &Electrics, given: usize) -> bool {
    match given.checked_sub(electrics.sources) {
        Some(winding) => match electrics.windings.get(winding) {
            Some(by) => *by == GivenBy::State && !electrics.follows(winding),
            None => given + 1 == electrics.given(),
        },
        None => {
            let shifted = |island: &Island| island.shifts.iter().any(|shift| shift.source == given);
            electrics.capacitance(&Branch::Source(given)).is_some() && !electrics.islands.iter().any(shifted)
        }
    }
}

/// Voltages that Kirchhoff's law of loops gives from prescribed voltages alone.
fn voltages(island: &Island) -> Vec<Option<Form>> {
    let ground = island.nodes.len();
    let at = |node: Option<usize>| node.unwrap_or(ground);
    let mut beside: Vec<Vec<(usize, Row)>> = vec![Vec::new(); ground + 1];
    for pin in &island.two_pins {
        let across = match pin.branch {
            Branch::Source(index) => vec![(index as u32, 1.0)],
            Branch::Wire => Row::new(),
            _ => continue,
        };
        // What the potential of the other end is more than that of this one.
        beside[at(pin.n)].push((at(pin.p), across.clone()));
        beside[at(pin.p)].push((at(pin.n), plus(&[], &across, -1.0)));
    }
    // Potential of each node against the first of those that it hangs together with.
    let mut known: Vec<Option<(usize, Row)>> = vec![None; ground + 1];
    for first in 0..=ground {
        if known[first].is_some() {
            continue;
        }
        known[first] = Some((first, Row::new()));
        let mut open = vec![first];
        while let Some(node) = open.pop() {
            let Some((_, here)) = known[node].clone() else { continue };
            for (other, across) in &beside[node] {
                if known[*other].is_none() {
                    known[*other] = Some((first, plus(&here, across, 1.0)));
                    open.push(*other);
                }
            }
        }
    }
    let between = |pin: &TwoPin| match (&known[at(pin.p)], &known[at(pin.n)]) {
        (Some((a, p)), Some((b, n))) if a == b => Some(clean(&plus(p, n, -1.0))),
        _ => None,
    };
    let probes = island.two_pins.iter().map(|pin| (pin, matches!(pin.branch, Branch::Probe)));
    probes.map(|(pin, probe)| if probe { between(pin) } else { None }).collect()
}

/// Currents of wires that Kirchhoff's law of nodes gives from given currents alone: nothing but such currents leads from one
/// of their sides to the other.
fn currents(island: &Island) -> Vec<Option<Form>> {
    let ground = island.nodes.len();
    let at = |node: Option<usize>| node.unwrap_or(ground);
    let mut beside: Vec<Vec<(usize, usize)>> = vec![Vec::new(); ground + 1];
    for (position, pin) in island.two_pins.iter().enumerate() {
        if !matches!(pin.branch, Branch::Given(_) | Branch::Probe) {
            beside[at(pin.p)].push((at(pin.n), position));
            beside[at(pin.n)].push((at(pin.p), position));
        }
    }
    let current = |(position, wire): (usize, &TwoPin)| {
        if !matches!(wire.branch, Branch::Wire) {
            return None;
        }
        // All that hangs together with the beginning of the wire, but for the wire.
        let mut reached = vec![false; ground + 1];
        reached[at(wire.p)] = true;
        let mut open = vec![at(wire.p)];
        while let Some(node) = open.pop() {
            for (other, by) in &beside[node] {
                if *by != position && !reached[*other] {
                    reached[*other] = true;
                    open.push(*other);
                }
            }
        }
        if reached[at(wire.n)] {
            return None;
        }
        let mut sum = Row::new();
        for pin in &island.two_pins {
            if let (Branch::Given(index), true) = (pin.branch, reached[at(pin.p)] != reached[at(pin.n)]) {
                let sign = if reached[at(pin.p)] { -1.0 } else { 1.0 };
                sum = plus(&sum, &[(index as u32, sign)], 1.0);
            }
        }
        Some(clean(&sum))
    };
    island.two_pins.iter().enumerate().map(current).collect()
}
