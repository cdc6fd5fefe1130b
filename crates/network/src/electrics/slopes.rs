//! Whose slopes the currents in loops of capacitances and the voltages in cuts of inductances ask for, and whether anybody
//! knows them.

use blocksim_block::physical::{Element, Part, ValveKind};

use super::conducting::Unsolvable;
use super::solved::always_floating;
use super::{Branch, Electrics, GivenBy, Island, Solved, loops};
use crate::assembly::members::Members;

/// Coefficients of slopes below this part of a capacitance are rounding.
const ROUNDING: f64 = 1e-9;

/// Whether a component tells how fast what it gives changes: it says so, or what it gives stays.
fn is_known(part: &Part) -> bool {
    part.rates || part.holds && part.inputs.is_empty() && !part.jumps
}

/// Adds the slopes of the voltages in islands where capacitances may close loops, and what these voltages add to those of the
/// capacitances; and the slopes of the currents of sources that meet nothing but inductances.
pub(super) fn declare(m: &Members, electrics: &mut Electrics) {
    electrics.looked = looked(m, electrics);
    of_cuts(m, electrics);
    for index in 0..electrics.islands.len() {
        let island = &electrics.islands[index];
        let always = |i: usize| {
            matches!(island.two_pins[i].branch, Branch::Source(_) | Branch::Wire | Branch::Variable(_))
        };
        let at_times = |i: usize| {
            let branch = island.two_pins[i].branch;
            always(i) || matches!(branch, Branch::Valve { on_resistance: 0.0, .. })
        };
        let fixed = loops::find(electrics, island, always);
        let all = loops::find(electrics, island, at_times);
        if all.as_ref().is_ok_and(|all| all.is_empty()) {
            continue;
        }
        let divides = all != fixed;
        // What is wrong about loops that are always there is told with the other faults.
        let law = fixed.ok().filter(|fixed| !fixed.is_empty());
        let law = law.map(|fixed| loops::Law::of(electrics, island, &fixed));
        let shifts = law.as_ref().map_or_else(Vec::new, |law| loops::shifts(electrics, island, law));
        let mut slopes = Vec::new();
        let mut rated = Vec::new();
        for pin in &island.two_pins {
            let Branch::Source(source) = pin.branch else { continue };
            if electrics.capacitance(&pin.branch).is_some() {
                continue;
            }
            let part = &m.list[pin.member].part;
            slopes.push((source, is_known(part)));
            if part.rates && rated.last() != Some(&pin.member) {
                rated.push(pin.member);
            }
        }
        let island = &mut electrics.islands[index];
        (island.loops, island.shifts, island.divides) = (law, shifts, divides);
        island.rated.extend(rated);
        electrics.slopes.extend(slopes);
    }
    electrics.slopes.sort_unstable_by_key(|slope| slope.0);
}

/// The same for current sources that lead into parts of the circuit where only inductances meet them.
fn of_cuts(m: &Members, electrics: &mut Electrics) {
    for index in 0..electrics.islands.len() {
        let island = &electrics.islands[index];
        let by_input = |index: &usize| electrics.windings[index - electrics.sources] == GivenBy::Input;
        let sources: Vec<(usize, usize)> = island
            .two_pins
            .iter()
            .filter_map(|pin| match pin.branch {
                Branch::Given(index) if by_input(&index) => Some((index, pin.member)),
                _ => None,
            })
            .collect();
        if sources.is_empty() {
            continue;
        }
        let Some(floating) = always_floating(electrics, island).filter(|f| f.cut.contains(&true)) else {
            continue;
        };
        let cut: Vec<usize> = floating.in_cuts().collect();
        let mut rated: Vec<usize> = sources.iter().map(|(_, member)| *member).collect();
        rated.dedup();
        rated.retain(|member| m.list[*member].part.rates);
        let slopes = sources.iter().map(|(index, member)| (*index, is_known(&m.list[*member].part)));
        electrics.slopes.extend(slopes);
        let island = &mut electrics.islands[index];
        (island.in_cuts, island.rated) = (cut, rated);
    }
}

/// Whether somebody looks at the voltage or the current of each two-pin: an output that is read, an account, a valve that
/// conducts by itself, a transformer whose ratio varies.
fn looked(m: &Members, electrics: &Electrics) -> Vec<bool> {
    let accounts = m.list.iter().any(|member| member.is_account());
    let mut looked = vec![false; electrics.two_pins];
    for pin in electrics.islands.iter().flat_map(|island| &island.two_pins) {
        let sensor = matches!(pin.branch, Branch::Probe | Branch::Wire);
        let needed = |e: &Element| match e {
            Element::Valve { kind, .. } => *kind != ValveKind::Switch,
            Element::VariableTransformer { .. } | Element::Characteristic { .. } => true,
            _ => false,
        };
        let member = &m.list[pin.member];
        looked[pin.index] =
            member.is_read() || !sensor && (accounts || member.part.elements.iter().any(needed));
    }
    looked
}

/// Looks whether all slopes are known that a solution asks for: those in currents and voltages that somebody looks at, and
/// those that change a state.
///
/// # Errors
/// [`Unsolvable::Slope`].
pub(super) fn known(electrics: &Electrics, island: &Island, solved: &Solved) -> Result<(), Unsolvable> {
    known_in_cuts(electrics, island, solved)?;
    let Some(law) = &solved.loops else { return Ok(()) };
    let source = |index: usize| {
        island.two_pins.iter().position(|pin| matches!(pin.branch, Branch::Source(i) if i == index))
    };
    for (index, _) in electrics.slopes.iter().filter(|(_, known)| !known) {
        let (Some(slope), Some(at)) = (electrics.slope_of(*index), source(*index)) else { continue };
        for (position, current) in solved.currents.iter().enumerate() {
            if electrics.looked[island.two_pins[position].index] && current.at(slope) != 0.0 {
                return Err(Unsolvable::Slope(position, at));
            }
        }
        for position in &law.capacitances {
            let Some(c) = electrics.capacitance(&island.two_pins[*position].branch) else { continue };
            let shift = island.shifts.iter().find(|shift| shift.source == c.source);
            let always = shift.map_or(0.0, |shift| shift.by.at(*index));
            if (solved.currents[*position].at(slope) / c.capacitance - always).abs() > ROUNDING {
                return Err(Unsolvable::Slope(*position, at));
            }
        }
    }
    Ok(())
}

/// The voltages of parts that current sources lead into contain the slopes of these currents.
fn known_in_cuts(electrics: &Electrics, island: &Island, solved: &Solved) -> Result<(), Unsolvable> {
    let Some(floating) = &solved.floating else { return Ok(()) };
    let is_unknown = |(index, _): &&(usize, f64)| electrics.slopes.contains(&(*index, false));
    let Some((unknown, _)) = floating.driven.iter().flatten().find(is_unknown) else { return Ok(()) };
    let source = |pin: &super::TwoPin| matches!(pin.branch, Branch::Given(index) if index == *unknown);
    let at = island.two_pins.iter().position(source).unwrap_or(0);
    let looks = floating.shifts.iter().find(|(position, parts)| {
        let pin = &island.two_pins[*position];
        electrics.looked[pin.index] && parts.iter().any(|(part, _)| floating.cut[*part])
    });
    looks.map_or(Ok(()), |(position, _)| Err(Unsolvable::Slope(*position, at)))
}
