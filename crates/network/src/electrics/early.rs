//! Readings that follow from states alone, whatever valves and resistances do: they close no algebraic loop.

use super::solved::{form, solve};
use super::{Branch, Early, Electrics, GivenBy, Island};
use crate::assembly::eliminate::{Form, Relations};

/// The reading of each two-pin, if it is a sensor and its reading follows from states.
pub(super) fn readings(electrics: &Electrics) -> Vec<Option<Early>> {
    let mut readings = vec![None; electrics.two_pins];
    for island in &electrics.islands {
        let of_states = |form: &Form| form.terms().iter().all(|(i, _)| is_state(electrics, *i as usize));
        // Where no valve changes the circuit, its solution tells most: dividers of a capacitance, too.
        let plain = if island.valves.is_empty() { solve(electrics, island, 0).ok() } else { None };
        let plain = plain.filter(|solved| solved.floating.is_none());
        let (voltages, currents) = (voltages(electrics, island), currents(electrics, island));
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
        Some(winding) => electrics.windings.get(winding).is_none_or(|by| *by == GivenBy::State),
        None => electrics.capacitances.contains(&given),
    }
}

/// Voltages that Kirchhoff's law of loops gives from prescribed voltages alone.
fn voltages(electrics: &Electrics, island: &Island) -> Vec<Option<Form>> {
    let nodes = island.nodes.len();
    let given = electrics.given();
    let mut relations = Relations::new(nodes, given);
    let across = |p: Option<usize>, n: Option<usize>| -> Vec<(usize, f64)> {
        [(p, 1.0), (n, -1.0)].into_iter().filter_map(|(node, sign)| Some((node?, sign))).collect()
    };
    for pin in &island.two_pins {
        match pin.branch {
            Branch::Source(index) => relations.add(&across(pin.p, pin.n), &[(index, 1.0)]),
            Branch::Wire => relations.add(&across(pin.p, pin.n), &[]),
            _ => continue,
        };
    }
    let solved = relations.eliminate(|_| 0);
    let difference = |rows: &[Vec<f64>], p: Option<usize>, n: Option<usize>, len: usize| -> Vec<f64> {
        let of = |node: Option<usize>| node.map_or_else(|| vec![0.0; len], |node| rows[node].clone());
        of(p).iter().zip(of(n)).map(|(p, n)| p - n).collect()
    };
    let free = solved.free.len();
    island
        .two_pins
        .iter()
        .map(|pin| {
            let loose = difference(&solved.over_free, pin.p, pin.n, free);
            let known = loose.iter().all(|value| *value == 0.0);
            known.then(|| form(&difference(&solved.over_given, pin.p, pin.n, given)))
        })
        .collect()
}

/// Currents that Kirchhoff's law of nodes gives from given currents alone.
fn currents(electrics: &Electrics, island: &Island) -> Vec<Option<Form>> {
    let branches = island.two_pins.len();
    let mut relations = Relations::new(branches, electrics.given());
    for node in 0..island.nodes.len() {
        let (mut unknown, mut given) = (Vec::new(), Vec::new());
        for (position, pin) in island.two_pins.iter().enumerate() {
            let sign = f64::from(u8::from(pin.p == Some(node))) - f64::from(u8::from(pin.n == Some(node)));
            match pin.branch {
                _ if sign == 0.0 => {}
                Branch::Given(index) => given.push((index, -sign)),
                Branch::Probe => {}
                _ => unknown.push((position, sign)),
            }
        }
        relations.add(&unknown, &given);
    }
    let solved = relations.eliminate(|_| 0);
    (0..branches)
        .map(|position| {
            let known = solved.over_free[position].iter().all(|value| *value == 0.0);
            known.then(|| form(&solved.over_given[position]))
        })
        .collect()
}
