//! What is wrong with a circuit, in words.

use blocksim_block::physical::{Domain, ValveKind};

use petgraph::unionfind::UnionFind;

use super::conducting::Unsolvable;
use super::solved::solve;
use super::{Branch, Electrics, Island, loops};
use crate::assembly::domains::Nodal;
use crate::assembly::eliminate::Relations;
use crate::assembly::members::Members;
use crate::problem::NetworkProblem;

/// Everything that is wrong with an island whatever its valves do.
pub(super) fn faults(m: &Members, electrics: &Electrics, island: &Island) -> Vec<NetworkProblem> {
    let mut problems = conflicts(electrics, island);
    problems.extend(heats(m, electrics, island));
    problems.extend(unbooked_source(m, electrics, island));
    problems.extend(valve_of_fast_circuit(m, electrics, island));
    if !problems.is_empty() {
        return problems;
    }
    // What floats even while all valves conduct floats always; what they short-circuit they need not.
    match solve(electrics, island, u128::MAX) {
        Err(Unsolvable::Floating(nodes)) => vec![undetermined(m, island, nodes.first().copied())],
        Err(Unsolvable::Cut(two_pins)) => vec![no_path(m, island, &two_pins)],
        Err(Unsolvable::Loop(two_pins)) if island.valves.is_empty() => vec![closed(island, &two_pins)],
        Ok(solved) if island.valves.is_empty() => currents_in_a_loop(electrics, island, &solved),
        Err(Unsolvable::Slope(looks, source)) if island.valves.is_empty() => {
            vec![unknown_slope(island, looks, source)]
        }
        Err(Unsolvable::Loop(_) | Unsolvable::Slope(..)) | Ok(_) => too_many(island),
    }
}

/// The power of a source of magnetic potential is that times the rate of its flux, which no law gives.
fn unbooked_source(m: &Members, electrics: &Electrics, island: &Island) -> Option<NetworkProblem> {
    let account = m.list.iter().position(|member| member.is_account())?;
    let gives =
        |branch: &Branch| matches!(branch, Branch::Source(_)) && electrics.capacitance(branch).is_none();
    let source =
        island.two_pins.iter().find(|pin| pin.domain == Domain::Magnetic && gives(&pin.branch))?.member;
    let problem = NetworkProblem::new(
        "unbooked_source",
        "an account cannot book what a source of magnetic potential supplies: its power contains the rate of its flux, which is unknown",
        "put a winding in its place, `MagneticWinding` behind an electrical source, or leave out the account",
    );
    Some(problem.with(source, "gives this potential").with(account, "is to book its power"))
}

/// A valve that conducts and blocks by itself in a circuit that is integrated apart: its instants are events of the solver alone.
fn valve_of_fast_circuit(m: &Members, electrics: &Electrics, island: &Island) -> Option<NetworkProblem> {
    let fast = island.members.iter().find(|member| m.list[**member].part.separate.is_some())?;
    let mut valves = island.valves.iter().map(|valve| &electrics.valves[*valve]);
    let valve = valves.find(|valve| valve.kind != ValveKind::Switch)?;
    let problem = NetworkProblem::new(
        "valve_of_fast_circuit",
        "a part that conducts and blocks by its own current belongs to a circuit that is integrated apart, from edge to edge of its inverter",
        "let the solver integrate it (`integration: Together` of the inverter), or let a breaker open at once (`opens: AtOnce`)",
    );
    Some(problem.with(valve.member, "has such a valve").with(*fast, "asks for the integration apart"))
}

/// Voltages that are prescribed twice. Loops that a capacitance closes are none, unless a variable transformer belongs to
/// them: what it gives would change its own voltage.
fn conflicts(electrics: &Electrics, island: &Island) -> Vec<NetworkProblem> {
    let shorted = |pin: &super::TwoPin| electrics.capacitance(&pin.branch).is_some() && pin.p == pin.n;
    let fixed = |i: usize| {
        matches!(island.two_pins[i].branch, Branch::Source(_) | Branch::Variable(_) | Branch::Wire)
    };
    let found = loops::find(electrics, island, fixed);
    if found.is_ok() && !island.two_pins.iter().any(shorted) {
        return Vec::new();
    }
    let fights = |branch: &Branch| electrics.capacitance(branch).is_none();
    let alone = |i: &usize| fights(&island.two_pins[*i].branch);
    // Without capacitances where they have no part in it.
    let whole = found.err().is_none_or(|of| !of.iter().all(|(i, _)| alone(i)));
    let sources = |branch: &Branch| {
        matches!(branch, Branch::Source(_) | Branch::Variable(_)) && (whole || fights(branch))
    };
    let count = island.two_pins.iter().filter(|pin| sources(&pin.branch)).count();
    let mut relations = Relations::new(island.nodes.len(), count);
    // Two-pin of each row.
    let mut owners: Vec<usize> = Vec::new();
    let mut source = 0;
    for (position, pin) in island.two_pins.iter().enumerate() {
        let across = |pin: &super::TwoPin, factor: f64| -> Vec<(usize, f64)> {
            let ends = [(pin.p, factor), (pin.n, -factor)];
            ends.into_iter().filter_map(|(node, sign)| Some((node?, sign))).collect()
        };
        let (row, given) = match pin.branch {
            branch if sources(&branch) => {
                source += 1;
                (across(pin, 1.0), vec![(source - 1, 1.0)])
            }
            Branch::Wire => (across(pin, 1.0), Vec::new()),
            Branch::Primary(ratio) => {
                let secondary = across(&island.two_pins[position + 1], -ratio);
                ([across(pin, 1.0), secondary].concat(), Vec::new())
            }
            _ => continue,
        };
        relations.add(&row, &given);
        owners.push(position);
    }
    let dependent = relations.eliminate(|_| 0).dependent;
    let mut problems: Vec<NetworkProblem> = Vec::new();
    for (row, fights) in &dependent {
        // The three phases of two sources fight in the same manner.
        let problem = conflict(island, &relations, &owners, *row, *fights);
        if !problems.contains(&problem) {
            problems.push(problem);
        }
    }
    problems
}

fn conflict(
    island: &Island,
    relations: &Relations,
    owners: &[usize],
    row: usize,
    fights: bool,
) -> NetworkProblem {
    let owner = |row: usize| {
        let pin = &island.two_pins[owners[row]];
        let what = match pin.branch {
            Branch::Source(_) => format!("prescribes the {}", Nodal::of(pin.domain).across),
            Branch::Primary(_) | Branch::Variable(_) => "couples two voltages".to_owned(),
            _ => "is a wire".to_owned(),
        };
        (pin.member, what)
    };
    let words = Nodal::of(island.two_pins[owners[row]].domain);
    let alone = relations.row(row).iter().all(|a| *a == 0.0);
    let problem = if fights && alone {
        NetworkProblem::new(
            "voltage_conflict",
            "an ideal source is short-circuited",
            "connect its pins to different nodes",
        )
    } else if fights {
        NetworkProblem::new(
            "voltage_conflict",
            format!("two parts prescribe the same {}", words.across),
            words.between,
        )
    } else {
        NetworkProblem::new(
            "indeterminate_current",
            "wires close a loop without resistance: how the current divides cannot be known",
            "remove one of the parallel sensors or references",
        )
    };
    let (member, what) = owner(row);
    let shares = |index: usize| {
        relations.row(row).iter().zip(relations.row(index)).any(|(a, b)| *a != 0.0 && *b != 0.0)
    };
    (0..owners.len())
        .filter(|index| owner(*index).0 != member && shares(*index))
        .map(owner)
        .fold(problem.with(member, what), |problem, (other, what)| problem.with(other, what))
}

/// Ideal branches that close a loop, where no single pair of them fights.
fn closed(island: &Island, two_pins: &[(usize, f64)]) -> NetworkProblem {
    let problem = NetworkProblem::new(
        "voltage_conflict",
        "ideal voltages close a loop without resistance",
        "add a resistance to the loop",
    );
    two_pins.iter().fold(problem, |problem, (i, _)| problem.with(island.two_pins[*i].member, "belongs to it"))
}

/// A current that contains the slope of a voltage that nothing tells, or a voltage that contains that of a current.
fn unknown_slope(island: &Island, looks: usize, source: usize) -> NetworkProblem {
    let domain = island.two_pins[source].domain;
    if domain != Domain::Electrical {
        let Nodal { across, through, stores, resist, .. } = Nodal::of(domain);
        let (looks, source) = (island.two_pins[looks].member, island.two_pins[source].member);
        return NetworkProblem::new(
            "unknown_slope",
            format!(
                "{stores} have a {across} that comes as a signal: the {through} into them contains the slope of that signal, which is \
                 unknown"
            ),
            format!("put {resist} between both, or leave out what measures the {through}"),
        )
        .with(source, format!("gives this {across}"))
        .with(looks, format!("looks at the {through}"));
    }
    let of_current = matches!(island.two_pins[source].branch, Branch::Given(_));
    let (looks, source) = (island.two_pins[looks].member, island.two_pins[source].member);
    if of_current {
        return NetworkProblem::new(
            "unknown_slope",
            "inductances lie in series with an ideal current source: the voltage across them contains the slope of a current that \
             comes as a signal of unknown slope",
            "connect `di` of the source, put a resistance in parallel to it, for instance Resistor(r: \"1 MOhm\"), or leave out what \
             measures the voltage",
        )
        .with(source, "gives this current")
        .with(looks, "looks at the voltage");
    }
    NetworkProblem::new(
        "unknown_slope",
        "capacitors lie across an ideal source: the current through them contains the slope of a voltage that comes as a \
         signal of unknown slope",
        "connect `dv` of the source if it has this input, put a resistance in series to it, for instance Resistor(r: \"1 mOhm\"), or \
         leave out what measures the current",
    )
    .with(source, "gives this voltage")
    .with(looks, "looks at the current")
}

/// Given currents that are no states, with nothing at the node that could answer them.
fn no_path(m: &Members, island: &Island, two_pins: &[usize]) -> NetworkProblem {
    let first = &island.two_pins[two_pins[0]];
    let node = first.p.or(first.n).map_or(0, |node| island.nodes[node]);
    let words = Nodal::of(first.domain);
    let problem = NetworkProblem::new(
        "no_current_path",
        if first.domain != Domain::Electrical {
            format!(
                "the {} that is prescribed at `{}` has no path: nothing there takes it",
                words.through,
                m.electrical_node_name(node)
            )
        } else {
            format!(
                "a prescribed current has no path at `{}`: only other prescribed currents and windings that cannot follow it meet there",
                m.electrical_node_name(node)
            )
        },
        words.path,
    );
    let what = format!("prescribes the {}", words.through);
    two_pins.iter().fold(problem, |p, i| p.with(island.two_pins[*i].member, what.clone()))
}

/// Heat is known after everything else, so a temperature must not follow from it at once; nor is it known within the steps of a circuit
/// that the network integrates by itself.
fn heats(m: &Members, electrics: &Electrics, island: &Island) -> Vec<NetworkProblem> {
    let ground = island.nodes.len();
    let at = |node: Option<usize>| node.unwrap_or(ground);
    let mut held = UnionFind::new(ground + 1);
    for pin in island.two_pins.iter().filter(|pin| matches!(pin.branch, Branch::Source(_) | Branch::Wire)) {
        held.union(at(pin.p), at(pin.n));
    }
    let mut problems = Vec::new();
    for (position, _) in &island.heats {
        let pin = &island.two_pins[*position];
        let node = pin
            .p
            .map_or_else(|| m.path(pin.member).to_owned(), |node| m.electrical_node_name(island.nodes[node]));
        if let Some(fast) = island.members.iter().find(|member| m.list[**member].part.separate.is_some()) {
            let problem = NetworkProblem::new(
                "heat_of_fast_circuit",
                "a part with a heat port belongs to a circuit that is integrated apart, from edge to edge of its valves",
                "let the solver integrate it (`integration: Together` of the inverter), or leave out the heat port",
            );
            return vec![
                problem.with(pin.member, "has the heat port").with(*fast, "asks for the integration apart"),
            ];
        }
        if !held.equiv(at(pin.p), ground) {
            let alone = !island.two_pins.iter().any(|other| {
                !electrics.heats.iter().any(|heat| heat.two_pin == other.index)
                    && !matches!(other.branch, Branch::Probe)
                    && (other.p == pin.p || other.n == pin.p)
            });
            let problem = if alone {
                NetworkProblem::new(
                    "no_current_path",
                    format!("the heat that flows into `{node}` has no path: nothing there takes it"),
                    Nodal::of(Domain::Thermal).path,
                )
            } else {
                NetworkProblem::new(
                    "heat_without_capacity",
                    format!(
                        "the heat that flows into `{node}` meets no heat capacity there: its temperature would jump with the losses"
                    ),
                    format!("connect a HeatCapacity to `{node}`, or an Ambient"),
                )
            };
            problems.push(problem.with(pin.member, "makes the heat"));
        }
    }
    problems
}

fn too_many(island: &Island) -> Vec<NetworkProblem> {
    let most = u128::BITS as usize;
    let Some(first) = island.two_pins.iter().find(|pin| matches!(pin.branch, Branch::Valve { .. })) else {
        return Vec::new();
    };
    if island.valves.len() <= most {
        return Vec::new();
    }
    vec![
        NetworkProblem::new(
            "too_many_valves",
            format!("{} valves belong to one circuit; {most} are possible", island.valves.len()),
            "divide the circuit: parts that share nothing but a reference are independent",
        )
        .with(first.member, "is the first of them"),
    ]
}

/// A current that follows from a voltage must not change that voltage: there is no inductance to separate them. Nor may it
/// do so by way of a variable transformer, whose currents are found together with it.
fn currents_in_a_loop(electrics: &Electrics, island: &Island, solved: &super::Solved) -> Vec<NetworkProblem> {
    let waits = |given: usize| {
        given
            .checked_sub(electrics.sources)
            .is_some_and(|i| electrics.windings.get(i) == Some(&super::GivenBy::Voltage))
    };
    let follows = |given: usize| {
        let ratio = || electrics.transformers.iter().any(|t| t.current == given);
        let law = || electrics.characteristics.iter().any(|c| c.rest == given);
        waits(given) || island.waits && (ratio() || law())
    };
    let pins = island.two_pins.iter().zip(&solved.voltages);
    pins.filter(|(pin, _)| matches!(pin.branch, Branch::Given(index) if follows(index)))
        .filter(|(_, voltage)| voltage.terms().iter().any(|(i, _)| follows(*i as usize)))
        .map(|(pin, _)| {
            NetworkProblem::new(
                "indeterminate_current",
                "a current that follows from a voltage changes that voltage at the same instant",
                "give the motor an inductance, or connect it to an ideal source",
            )
            .with(pin.member, "has no inductance")
        })
        .collect()
}

fn undetermined(m: &Members, island: &Island, node: Option<usize>) -> NetworkProblem {
    let local = node.unwrap_or(0);
    let node = island.nodes[local];
    let at_node = |pin: &&super::TwoPin| pin.p == Some(local) || pin.n == Some(local);
    let domain = island.two_pins.iter().find(at_node).map_or(Domain::Electrical, |pin| pin.domain);
    let words = Nodal::of(domain);
    let source =
        island.two_pins.iter().find(|pin| matches!(pin.branch, Branch::Source(_) | Branch::Variable(_)));
    if source.is_none() && m.is_phase(node) {
        let problem = NetworkProblem::new(
            "missing_supply",
            format!("nothing feeds the three-phase node at `{}`", m.electrical_node_name(node)),
            "connect a three-phase source or an inverter",
        );
        island.members.iter().fold(problem, |problem, member| problem.with(*member, "is connected to it"))
    } else if m.is_grounded(domain) || words.reference.is_none() {
        let member = m.any_electrical_member_at(node);
        NetworkProblem::new(
            "floating_node",
            format!("nothing determines the {} at `{}`", words.at_node, m.electrical_node_name(node)),
            words.determine,
        )
        .with(member, "is connected to it")
    } else {
        let block = words.reference.unwrap_or_default();
        let article = if block.starts_with(['A', 'E', 'I', 'O', 'U']) { "an" } else { "a" };
        NetworkProblem::new(
            "missing_reference",
            format!("this {domain} network has no reference"),
            format!("add {article} {block} and connect it to one of the nodes"),
        )
        .with(m.any_electrical_member_at(node), "belongs to it")
    }
}
