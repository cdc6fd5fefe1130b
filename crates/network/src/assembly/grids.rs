//! Which source a machine hangs at, through lines, sensors and contacts.

use std::collections::BTreeSet;

use blocksim_block::physical::{Domain, Element, Part, Pin};

use crate::assembly::members::Members;

/// The source whose frequency the field of a machine has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Grid {
    /// The member.
    pub source: usize,
    /// Whether something on the way may exchange phases.
    pub exchanged: bool,
}

/// The grid of each machine; nothing where there are several sources, or where something else than three phases leads to them, such as the
/// direct voltage of an inverter.
pub(crate) fn grids(m: &Members) -> Vec<Option<Grid>> {
    let of = |(member, part): (usize, &Part)| {
        let [ac, _] = machine(part)?;
        let all = reached(m, member, &machine(part)?, &|_| true)?;
        let source = match all.as_slice() {
            [source] => *source,
            _ => return None,
        };
        let straight = reached(m, member, &[ac], &is_straight);
        Some(Grid { source, exchanged: straight.is_none_or(|found| !found.contains(&source)) })
    };
    m.list.iter().map(|member| &member.part).enumerate().map(of).collect()
}

/// The three-phase ports of a machine; twice the same without ends.
fn machine(part: &Part) -> Option<[usize; 2]> {
    part.elements.iter().find_map(|element| match element {
        Element::Machine { ac, ends } => Some([*ac, ends.unwrap_or(*ac)]),
        _ => None,
    })
}

/// The sources that three-phase conductors lead to from ports of a member through such parts; nothing if they lead elsewhere, too.
fn reached(
    m: &Members,
    member: usize,
    ports: &[usize],
    through: &dyn Fn(&Part) -> bool,
) -> Option<Vec<usize>> {
    let mut open: Vec<usize> = ports.iter().map(|port| m.node(member, *port)).collect();
    let mut seen: BTreeSet<usize> = open.iter().copied().collect();
    let mut sources = Vec::new();
    while let Some(node) = open.pop() {
        for terminal in m.three_phase_terminals(node).iter().filter(|terminal| terminal.member != member) {
            let part = &m.list[terminal.member].part;
            let of =
                |domain: Domain| (0..part.ports.len()).filter(move |port| part.ports[*port].domain == domain);
            let (phases, others) = (of(Domain::ThreePhase), of(Domain::Electrical).count());
            if part.elements.iter().any(|element| matches!(element, Element::Supply { .. })) {
                sources.push(terminal.member);
            } else if others > 0 && !(others == 1 && phases.clone().count() == 1 && is_passive(part)) {
                return None;
            } else if machine(part).is_none() && through(part) {
                let next = phases.map(|port| m.node(terminal.member, port));
                open.extend(next.filter(|node| seen.insert(*node)));
            }
        }
    }
    sources.sort_unstable();
    sources.dedup();
    Some(sources)
}

/// Whether a star point with nothing that could feed it: resistors, coils, wires.
fn is_passive(part: &Part) -> bool {
    part.elements.iter().all(|element| {
        matches!(
            element,
            Element::Resistance { .. }
                | Element::Winding { .. }
                | Element::Capacitance { .. }
                | Element::Junction { .. }
                | Element::VoltageProbe { .. }
                | Element::CurrentProbe { .. }
        )
    })
}

/// Whether each phase of one port leads to the same one of another.
fn is_straight(part: &Part) -> bool {
    part.elements.iter().map(Element::pins).all(|pins| match pins[..] {
        [Pin::Phase(a, i), Pin::Phase(b, j)] => a == b || i == j,
        _ => true,
    })
}
