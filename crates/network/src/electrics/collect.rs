//! From the elements of all members to islands of two-pins.

use blocksim_block::physical::{Domain, Element, ElementPlace, Handle, Pin};
use petgraph::unionfind::UnionFind;

use super::{
    Branch, Capacitance, Characteristic, Electrics, GivenBy, Heat, Island, Joined, Places, TwoPin, Valve,
    Variable,
};
use crate::assembly::members::Members;

/// What rounding makes of a voltage, as a part of it.
const LAST: f64 = 8.0 * f64::EPSILON;

/// What an element contributes, before islands are known.
struct Piece {
    member: usize,
    p: Pin,
    n: Pin,
    branch: Branch,
    domain: Domain,
}

pub(super) fn collect(m: &Members, fed: &[bool]) -> Electrics {
    let mut electrics = Electrics { places: vec![Places::default(); m.list.len()], ..Electrics::default() };
    let mut pieces: Vec<Piece> = Vec::new();
    for (member, of_member) in m.list.iter().enumerate() {
        let (two_pins, sources) = (pieces.len(), electrics.sources);
        let (windings, valves) = (electrics.windings.len(), electrics.valves.len());
        let transformers = electrics.transformers.len();
        let characteristics = electrics.characteristics.len();
        let mut named = Vec::new();
        for (index, element) in of_member.part.elements.iter().enumerate() {
            let characteristic = matches!(element, Element::Characteristic { .. })
                .then(|| electrics.characteristics.len() - characteristics);
            let place =
                |handle: Handle| ElementPlace { handle, two_pin: pieces.len() - two_pins, characteristic };
            let names = of_member.part.handles.iter().filter(|(_, of)| *of == index);
            named.extend(names.map(|(handle, _)| place(*handle)));
            let first = pieces.len();
            add(member, element, fed[member], &mut electrics, &mut pieces);
            let domain = of_member.part.domain_of(element);
            pieces[first..].iter_mut().for_each(|piece| piece.domain = domain);
        }
        let places = &mut electrics.places[member];
        places.two_pins = two_pins..pieces.len();
        places.sources = sources..electrics.sources;
        places.windings = windings..electrics.windings.len();
        places.valves = valves..electrics.valves.len();
        places.transformers = transformers..electrics.transformers.len();
        places.characteristics = characteristics..electrics.characteristics.len();
        places.named = named;
        if electrics.heats.last().is_some_and(|heat| heat.member == member) {
            let loses = |piece: &Piece| matches!(piece.branch, Branch::Conductance(_) | Branch::Valve { .. });
            places.dissipates = pieces[two_pins..].iter().map(loses).collect();
        }
    }
    // What no component gives comes behind what components give.
    for transformer in &mut electrics.transformers {
        transformer.voltage = electrics.sources;
        electrics.sources += 1;
        electrics.windings.push(GivenBy::Ratio);
        pieces[transformer.two_pin].branch = Branch::Variable(transformer.voltage);
        pieces[transformer.two_pin + 1].branch = Branch::Given(electrics.windings.len() - 1);
    }
    for characteristic in &mut electrics.characteristics {
        characteristic.rest = electrics.sources + electrics.windings.len();
        electrics.windings.push(GivenBy::Characteristic);
        pieces[characteristic.two_pin].branch =
            Branch::Characteristic(characteristic.conductance, characteristic.rest);
    }
    for heat in &mut electrics.heats {
        heat.given = electrics.sources + electrics.windings.len();
        pieces[heat.two_pin].branch = Branch::Given(electrics.windings.len());
        electrics.windings.push(GivenBy::Heat);
    }
    electrics.two_pins = pieces.len();
    // Currents come behind the voltages, whose number is known only now.
    for piece in &mut pieces {
        if let Branch::Given(index) = &mut piece.branch {
            *index += electrics.sources;
        }
    }
    for transformer in &mut electrics.transformers {
        if let Branch::Given(index) = pieces[transformer.two_pin + 1].branch {
            transformer.current = index;
        }
    }
    islands(m, &mut electrics, &pieces);
    electrics.islands.iter_mut().for_each(|island| refer(m, island));
    electrics
}

/// The star point of a floating supply is zero where nothing in its circuit has a reference: no current can flow there.
fn refer(m: &Members, island: &mut Island) {
    let floats = |member: usize| {
        let part = &m.list[member].part;
        let loose = |port: usize| part.ports[port].open && m.alone(member, port);
        part.elements.iter().any(|e| match *e {
            Element::Supply { n: Pin::Inner(_), .. } => true,
            Element::VoltageSource { n: Pin::Port(port), .. } => loose(port),
            _ => false,
        })
    };
    let mut pins = island.two_pins.iter().filter(|pin| pin.domain == Domain::Electrical);
    if pins.clone().any(|pin| pin.p.is_none() || pin.n.is_none()) {
        return;
    }
    let Some(star) = pins.find(|pin| floats(pin.member)).and_then(|pin| pin.n) else { return };
    island.nodes.remove(star);
    for node in island.two_pins.iter_mut().flat_map(|pin| [&mut pin.p, &mut pin.n]) {
        *node = node.filter(|node| *node != star).map(|node| node - usize::from(node > star));
    }
}

fn add(member: usize, element: &Element, fed: bool, electrics: &mut Electrics, pieces: &mut Vec<Piece>) {
    let source = |electrics: &mut Electrics| {
        electrics.sources += 1;
        Branch::Source(electrics.sources - 1)
    };
    let given = |electrics: &mut Electrics, by: GivenBy| {
        electrics.windings.push(by);
        Branch::Given(electrics.windings.len() - 1)
    };
    let mut piece = |p: Pin, n: Pin, branch: Branch| {
        pieces.push(Piece { member, p, n, branch, domain: Domain::Electrical })
    };
    match *element {
        Element::VoltageSource { p, n } => piece(p, n, source(electrics)),
        Element::Capacitance { p, n, capacitance, state, start } => {
            let voltage = electrics.sources;
            let capacitance = Capacitance { source: voltage, member, state, capacitance, start, jumps: None };
            electrics.capacitances.push(capacitance);
            piece(p, n, source(electrics));
        }
        Element::CurrentProbe { p, n } => piece(p, n, Branch::Wire),
        Element::VoltageProbe { p, n } => piece(p, n, Branch::Probe),
        Element::Winding { p, n, from_state } => {
            piece(p, n, given(electrics, if from_state { GivenBy::State } else { GivenBy::Voltage }));
        }
        Element::CurrentSource { p, n } => piece(p, n, given(electrics, GivenBy::Input)),
        Element::Resistance { p, n, resistance } => piece(p, n, Branch::Conductance(1.0 / resistance)),
        Element::Characteristic { p, n, conductance, guess: first_guess } => {
            // Their given values are numbered when all others are known.
            let two_pin = pieces.len();
            let unknown = Characteristic { two_pin, rest: 0, conductance, first_guess, guess: None };
            electrics.characteristics.push(unknown);
            let branch = Branch::Characteristic(conductance, 0);
            pieces.push(Piece { member, p, n, branch, domain: Domain::Electrical });
        }
        Element::Heat { port } => {
            electrics.heats.push(Heat { member, two_pin: pieces.len(), given: 0 });
            let (p, n, branch) = (Pin::Port(port), Pin::Ground, Branch::Given(0));
            pieces.push(Piece { member, p, n, branch, domain: Domain::Thermal });
        }
        Element::IdealTransformer { primary, secondary, ratio } => {
            piece(primary.0, primary.1, Branch::Primary(ratio));
            piece(secondary.0, secondary.1, Branch::Secondary);
        }
        Element::VariableTransformer { primary, secondary } => {
            // Their given values are numbered when all others are known.
            electrics.transformers.push(Variable { two_pin: pieces.len(), voltage: 0, current: 0 });
            for (p, n) in [primary, secondary] {
                pieces.push(Piece { member, p, n, branch: Branch::Variable(0), domain: Domain::Electrical });
            }
        }
        Element::Valve { p, n, kind, on_resistance, forward_voltage, off_conductance } => {
            // Numbered within its island later.
            let branch = Branch::Valve {
                index: electrics.valves.len(),
                on_resistance,
                forward_voltage,
                off_conductance,
            };
            piece(p, n, branch);
            electrics.valves.push(Valve {
                member,
                kind,
                forward_voltage,
                holding_current: off_conductance * forward_voltage,
                rounding_current: match on_resistance > 0.0 {
                    true => LAST * forward_voltage / on_resistance,
                    false => 0.0,
                },
                two_pin: pieces.len() - 1,
            });
        }
        Element::Supply { ac, n } if !fed => {
            (0..3).for_each(|k| piece(Pin::Phase(ac, k), n, source(electrics)));
        }
        Element::Machine { ac, ends } if !fed => {
            electrics.places[member].machine =
                Some(if ends.is_some() { Joined::Outside } else { Joined::Inside });
            match ends {
                None => (0..2).for_each(|k| {
                    piece(Pin::Phase(ac, k), Pin::Phase(ac, 2), given(electrics, GivenBy::State));
                }),
                Some(ends) => (0..3).for_each(|k| {
                    piece(Pin::Phase(ac, k), Pin::Phase(ends, k), given(electrics, GivenBy::State));
                }),
            }
        }
        _ => {}
    }
}

/// Divides the pieces: those that share a node other than ground, or a member, belong together.
fn islands(m: &Members, electrics: &mut Electrics, pieces: &[Piece]) {
    let place = |piece: &Piece, pin: Pin| m.electrical_node(piece.member, pin);
    let nodes = m.electrical_nodes;
    let mut joined = UnionFind::new(nodes + m.list.len());
    for piece in pieces {
        for node in [place(piece, piece.p), place(piece, piece.n)].into_iter().flatten() {
            joined.union(node, nodes + piece.member);
        }
    }
    let mut root_of: Vec<usize> = Vec::new();
    let mut local: Vec<Option<usize>> = vec![None; nodes];
    for (index, piece) in pieces.iter().enumerate() {
        let root = joined.find(nodes + piece.member);
        let number = root_of.iter().position(|known| *known == root).unwrap_or_else(|| {
            root_of.push(root);
            electrics.islands.push(Island::default());
            root_of.len() - 1
        });
        let island = &mut electrics.islands[number];
        if island.members.last() != Some(&piece.member) {
            island.members.push(piece.member);
            electrics.places[piece.member].island = Some(number);
            let wanted = m.list[piece.member].part.separate;
            let part = &m.list[piece.member].part;
            let gives = |e: &Element| {
                matches!(
                    e,
                    Element::VoltageSource { .. }
                        | Element::Capacitance { .. }
                        | Element::CurrentSource { .. }
                        | Element::Supply { .. }
                        | Element::VariableTransformer { .. }
                        | Element::Characteristic { .. }
                        | Element::Heat { .. }
                )
            };
            island.holds = (island.holds || island.members.len() == 1)
                && (part.holds || !part.elements.iter().any(gives));
            island.separate = [island.separate, wanted].into_iter().flatten().reduce(f64::min);
        }
        let mut node = |pin: Pin| {
            place(piece, pin).map(|node| {
                *local[node].get_or_insert_with(|| {
                    island.nodes.push(node);
                    island.nodes.len() - 1
                })
            })
        };
        let (p, n) = (node(piece.p), node(piece.n));
        if let Branch::Given(index) = piece.branch {
            let by = electrics.windings[index - electrics.sources];
            island.waits |= by == GivenBy::Voltage;
            island.has_windings |= by == GivenBy::State;
        }
        let branch = match piece.branch {
            Branch::Valve { index, on_resistance, forward_voltage, off_conductance } => {
                island.valves.push(index);
                let index = island.valves.len() - 1;
                Branch::Valve { index, on_resistance, forward_voltage, off_conductance }
            }
            Branch::Variable(voltage) => {
                let number = electrics.transformers.iter().position(|t| t.voltage == voltage);
                island.transformers.extend(number.map(|number| (island.two_pins.len(), number)));
                Branch::Variable(voltage)
            }
            Branch::Characteristic(conductance, rest) => {
                let number = electrics.characteristics.iter().position(|c| c.rest == rest);
                island.characteristics.extend(number.map(|number| (island.two_pins.len(), number)));
                Branch::Characteristic(conductance, rest)
            }
            Branch::Given(given) => {
                let number = electrics.heats.iter().position(|heat| heat.given == given);
                island.heats.extend(number.map(|number| (island.two_pins.len(), number)));
                Branch::Given(given)
            }
            branch => branch,
        };
        island.two_pins.push(TwoPin { member: piece.member, index, p, n, branch, domain: piece.domain });
    }
}
