//! Whose slopes the currents in loops of capacitances ask for, and whether anybody knows them.

use blocksim_block::physical::{Element, Needs, ValveKind};

use super::conducting::Unsolvable;
use super::{Branch, Electrics, Island, Solved, loops};
use crate::assembly::members::Members;

/// Coefficients of slopes below this part of a capacitance are rounding.
const ROUNDING: f64 = 1e-9;

/// Adds the slopes of the voltages in islands where capacitances may close loops, and what these voltages add to those of the
/// capacitances.
pub(super) fn declare(m: &Members, electrics: &mut Electrics) {
    electrics.looked = looked(m, electrics);
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
            slopes.push((source, part.rates || part.holds && part.inputs.is_empty() && !part.jumps));
            if part.rates && rated.last() != Some(&pin.member) {
                rated.push(pin.member);
            }
        }
        let island = &mut electrics.islands[index];
        (island.loops, island.shifts, island.rated, island.divides) = (law, shifts, rated, divides);
        electrics.slopes.extend(slopes);
    }
    electrics.slopes.sort_unstable_by_key(|slope| slope.0);
}

/// Whether somebody looks at the current of each two-pin.
fn looked(m: &Members, electrics: &Electrics) -> Vec<bool> {
    let accounts = m.list.iter().any(|member| member.is_account());
    let mut looked = vec![false; electrics.two_pins];
    for pin in electrics.islands.iter().flat_map(|island| &island.two_pins) {
        let part = &m.list[pin.member].part;
        let natural = |e: &Element| matches!(e, Element::Valve { kind, .. } if *kind != ValveKind::Switch);
        looked[pin.index] = match pin.branch {
            Branch::Probe => false,
            Branch::Wire => true,
            _ => {
                accounts
                    || part.outputs.iter().any(|(_, needs)| *needs != Needs::State)
                    || part.elements.iter().any(natural)
            }
        };
    }
    looked
}

/// Looks whether all slopes are known that a solution asks for: those in currents that somebody looks at, and those that
/// change a state.
///
/// # Errors
/// [`Unsolvable::Slope`].
pub(super) fn known(electrics: &Electrics, island: &Island, solved: &Solved) -> Result<(), Unsolvable> {
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
