//! Potentials and currents: how they follow from sources, windings and resistances.
//!
//! Modified nodal analysis, solved once: with the conductances `G`, the incidence `A` of all elements that prescribe
//! a voltage, and that of the elements that prescribe a current, `A_w`,
//!
//! ```text
//! | G  A' | | v |   | -A_w' i_w |      Kirchhoff's law at every node
//! | A  0  | | i | = |     e     |      prescribed voltages (sources, capacitances, wires: 0, references: 0)
//! ```
//!
//! so every voltage and every current is a linear form over the given values `(e, i_w)`.

use blocksim_block::physical::Element;
use nalgebra::DMatrix;

use crate::eliminate::{Form, Relations};
use crate::members::Members;
use crate::problem::NetworkProblem;

/// What a current that a component gives depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GivenBy {
    /// States alone.
    State,
    /// Inputs.
    Input,
    /// The voltage at the same instant.
    Voltage,
}

/// What a two-pin is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    Voltage,
    Current,
    Other,
}

/// The electrical side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Electrics {
    /// Number of voltages that components give: the first of the given values.
    pub sources: usize,
    /// What each current that a component gives depends on; these are the other given values.
    pub windings: Vec<GivenBy>,
    /// Voltage of each two-pin over the given values.
    pub voltages: Vec<Form>,
    /// Current of each two-pin over the given values.
    pub currents: Vec<Form>,
    /// Whether each given value is a state.
    is_state: Vec<bool>,
    uses: Vec<Use>,
}

impl Electrics {
    /// Number of given values.
    pub(crate) fn given(&self) -> usize {
        self.sources + self.windings.len()
    }

    /// Whether some current can be known only after the voltages.
    pub(crate) fn waits_for_voltages(&self) -> bool {
        self.windings.contains(&GivenBy::Voltage)
    }

    /// Whether a two-pin is a sensor whose reading follows from states alone.
    pub(crate) fn is_early(&self, two_pin: usize) -> bool {
        let form = match self.uses[two_pin] {
            Use::Voltage => &self.voltages[two_pin],
            Use::Current => &self.currents[two_pin],
            Use::Other => return false,
        };
        form.terms().iter().all(|(i, _)| self.is_state[*i as usize])
    }
}

/// Where the current of a two-pin comes from.
enum Branch {
    /// Row of the prescribed voltages.
    Row(usize),
    /// Index among the currents that components give.
    Given(usize),
    /// Conductance, S.
    Conductance(f64),
    Open,
}

struct TwoPin {
    member: usize,
    p: usize,
    n: usize,
    branch: Branch,
}

/// The elements of all members, sorted by what they prescribe.
struct Collected {
    relations: Relations,
    /// Member of each row of the relations and what it does there.
    owners: Vec<(usize, &'static str)>,
    two_pins: Vec<TwoPin>,
    electrics: Electrics,
}

/// Finds voltages and currents as forms over what components give.
pub(crate) fn build(m: &Members) -> Result<Electrics, Vec<NetworkProblem>> {
    let nodes = m.electrical_nodes;
    if nodes == 0 {
        return Ok(Electrics::default());
    }
    let Collected { relations, owners, two_pins, mut electrics } = collect(m);
    let mut problems = conflicts(&relations, &owners);
    problems.extend(floating(m, &relations, &two_pins));
    if !problems.is_empty() {
        return Err(problems);
    }

    let (rows, given) = (relations.len(), electrics.given());
    let size = nodes + rows;
    let mut matrix = DMatrix::zeros(size, size);
    let mut right = DMatrix::zeros(size, given);
    for row in 0..rows {
        for (node, a) in relations.row(row).iter().enumerate() {
            matrix[(nodes + row, node)] = *a;
            matrix[(node, nodes + row)] = *a;
        }
        for (source, b) in relations.given_row(row).iter().enumerate() {
            right[(nodes + row, source)] = *b;
        }
    }
    for pin in &two_pins {
        match pin.branch {
            Branch::Conductance(g) => {
                matrix[(pin.p, pin.p)] += g;
                matrix[(pin.n, pin.n)] += g;
                matrix[(pin.p, pin.n)] -= g;
                matrix[(pin.n, pin.p)] -= g;
            }
            Branch::Given(winding) => {
                right[(pin.p, electrics.sources + winding)] -= 1.0;
                right[(pin.n, electrics.sources + winding)] += 1.0;
            }
            Branch::Row(_) | Branch::Open => {}
        }
    }
    let Some(solution) = matrix.lu().solve(&right) else {
        return Err(vec![undetermined(m, 0)]);
    };
    let row_of = |i: usize| -> Vec<f64> { (0..given).map(|k| solution[(i, k)]).collect() };
    for pin in &two_pins {
        let (p, n) = (row_of(pin.p), row_of(pin.n));
        let voltage: Vec<f64> = p.iter().zip(&n).map(|(p, n)| p - n).collect();
        electrics.currents.push(match pin.branch {
            Branch::Row(row) => form(&row_of(nodes + row)),
            Branch::Conductance(g) => form(&voltage.iter().map(|v| g * v).collect::<Vec<_>>()),
            Branch::Given(winding) => {
                let mut unit = vec![0.0; given];
                unit[electrics.sources + winding] = 1.0;
                Form::from_dense(&unit)
            }
            Branch::Open => Form::default(),
        });
        electrics.voltages.push(form(&voltage));
    }
    let loops = currents_in_a_loop(&electrics, &two_pins);
    if loops.is_empty() { Ok(electrics) } else { Err(loops) }
}

/// Rounding must not make one part of a circuit depend on another.
fn form(row: &[f64]) -> Form {
    let scale = row.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    Form::from_dense(&row.iter().map(|v| if v.abs() < 1e-12 * scale { 0.0 } else { *v }).collect::<Vec<_>>())
}

fn collect(m: &Members) -> Collected {
    let sources =
        m.count(|element| matches!(element, Element::VoltageSource { .. } | Element::Capacitance { .. }));
    let mut c = Collected {
        relations: Relations::new(m.electrical_nodes, sources),
        owners: Vec::new(),
        two_pins: Vec::new(),
        electrics: Electrics { sources, is_state: vec![false; sources], ..Electrics::default() },
    };
    let mut source = 0;
    for (member, element) in m.elements() {
        let node = |port: usize| m.node(member, port);
        let (p, n, branch, wanted) = match *element {
            Element::ElectricalReference { port } => {
                c.relations.add(&[(node(port), 1.0)], &[]);
                c.owners.push((member, HOLDS));
                continue;
            }
            Element::VoltageSource { p, n } | Element::Capacitance { p, n } => {
                let row = c.relations.add(&[(node(p), 1.0), (node(n), -1.0)], &[(source, 1.0)]);
                c.electrics.is_state[source] = matches!(element, Element::Capacitance { .. });
                c.owners.push((member, "prescribes the voltage"));
                source += 1;
                (p, n, Branch::Row(row), Use::Other)
            }
            Element::CurrentProbe { p, n } => {
                let row = c.relations.add(&[(node(p), 1.0), (node(n), -1.0)], &[]);
                c.owners.push((member, "is a wire"));
                (p, n, Branch::Row(row), Use::Current)
            }
            Element::Winding { p, n, from_state } => {
                c.electrics.windings.push(if from_state { GivenBy::State } else { GivenBy::Voltage });
                (p, n, Branch::Given(c.electrics.windings.len() - 1), Use::Other)
            }
            Element::CurrentSource { p, n } => {
                c.electrics.windings.push(GivenBy::Input);
                (p, n, Branch::Given(c.electrics.windings.len() - 1), Use::Other)
            }
            Element::Resistance { p, n, resistance } => {
                (p, n, Branch::Conductance(1.0 / resistance), Use::Other)
            }
            Element::VoltageProbe { p, n } => (p, n, Branch::Open, Use::Voltage),
            _ => continue,
        };
        c.two_pins.push(TwoPin { member, p: node(p), n: node(n), branch });
        c.electrics.uses.push(wanted);
    }
    c.electrics.is_state.extend(c.electrics.windings.iter().map(|by| *by == GivenBy::State));
    c
}

/// What a reference does.
const HOLDS: &str = "holds the potential at zero";

/// Voltages that are prescribed twice.
fn conflicts(relations: &Relations, owners: &[(usize, &'static str)]) -> Vec<NetworkProblem> {
    let mut problems = Vec::new();
    for (row, fights) in &relations.eliminate(|_| 0).dependent {
        let (member, what) = owners[*row];
        let alone = relations.row(*row).iter().all(|a| *a == 0.0);
        let mut problem = if *fights && alone {
            NetworkProblem::new(
                "voltage_conflict",
                "an ideal source is short-circuited",
                "connect its pins to different nodes",
            )
        } else if *fights {
            NetworkProblem::new(
                "voltage_conflict",
                "two ideal sources prescribe the same voltage",
                "remove one of them, or connect them through a resistance",
            )
        } else {
            NetworkProblem::new(
                "indeterminate_current",
                "wires close a loop without resistance: how the current divides cannot be known",
                "remove one of the parallel sensors or references",
            )
        }
        .with(member, what);
        let shares = |index: usize| {
            relations.row(*row).iter().zip(relations.row(index)).any(|(a, b)| *a != 0.0 && *b != 0.0)
        };
        let mut others: Vec<&(usize, &str)> = owners
            .iter()
            .enumerate()
            .filter(|(index, (other, _))| *other != member && shares(*index))
            .map(|(_, owner)| owner)
            .collect();
        // A reference shares a node with almost everything: it is of interest only where nothing else is.
        if others.iter().any(|(_, what)| *what != HOLDS) {
            others.retain(|(_, what)| *what != HOLDS);
        }
        for (other, what) in others {
            problem = problem.with(*other, *what);
        }
        problems.push(problem);
    }
    problems
}

/// Parts of the circuit that neither a prescribed voltage nor a resistance connects to a reference.
fn floating(m: &Members, relations: &Relations, two_pins: &[TwoPin]) -> Vec<NetworkProblem> {
    let nodes = m.electrical_nodes;
    // The part of each node, and one more part for the references.
    let mut part: Vec<usize> = (0..=nodes).collect();
    let mut join = |a: usize, b: usize| {
        let (from, to) = (part[a].max(part[b]), part[a].min(part[b]));
        part.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
    };
    for row in 0..relations.len() {
        let touched: Vec<usize> =
            relations.row(row).iter().enumerate().filter(|(_, a)| **a != 0.0).map(|(node, _)| node).collect();
        match touched[..] {
            [only] => join(only, nodes),
            [a, b] => join(a, b),
            _ => {}
        }
    }
    for pin in two_pins.iter().filter(|pin| matches!(pin.branch, Branch::Conductance(_))) {
        join(pin.p, pin.n);
    }
    let Some(node) = (0..nodes).find(|node| part[*node] != part[nodes]) else { return Vec::new() };
    let meeting: Vec<&TwoPin> = two_pins
        .iter()
        .filter(|pin| {
            matches!(pin.branch, Branch::Given(_))
                && (part[pin.p] == part[node]) != (part[pin.n] == part[node])
        })
        .collect();
    let grounded = m.elements().any(|(_, element)| matches!(element, Element::ElectricalReference { .. }));
    if meeting.len() < 2 || !grounded {
        return vec![undetermined(m, node)];
    }
    let problem = NetworkProblem::new(
        "floating_node",
        format!(
            "only currents of inductances meet at `{}`: they cannot be independent",
            m.electrical_node_name(node)
        ),
        "connect a resistance from there to another node, in parallel to one of the inductances",
    );
    vec![meeting.iter().fold(problem, |problem, pin| problem.with(pin.member, "has inductance"))]
}

/// A current that follows from a voltage must not change that voltage: there is no inductance to separate them.
fn currents_in_a_loop(electrics: &Electrics, two_pins: &[TwoPin]) -> Vec<NetworkProblem> {
    let waits = |winding: usize| electrics.windings[winding] == GivenBy::Voltage;
    let depends = |pin: usize| {
        electrics.voltages[pin]
            .terms()
            .iter()
            .any(|(i, _)| (*i as usize).checked_sub(electrics.sources).is_some_and(waits))
    };
    two_pins
        .iter()
        .enumerate()
        .filter(|(pin, two_pin)| matches!(two_pin.branch, Branch::Given(w) if waits(w)) && depends(*pin))
        .map(|(_, two_pin)| {
            NetworkProblem::new(
                "indeterminate_current",
                "a current that follows from a voltage changes that voltage at the same instant",
                "give the motor an inductance, or connect it to an ideal source",
            )
            .with(two_pin.member, "has no inductance")
        })
        .collect()
}

fn undetermined(m: &Members, node: usize) -> NetworkProblem {
    let grounded = m.elements().any(|(_, element)| matches!(element, Element::ElectricalReference { .. }));
    let member = m.any_electrical_member_at(node);
    if grounded {
        NetworkProblem::new(
            "floating_node",
            format!("nothing determines the potential at `{}`", m.electrical_node_name(node)),
            "connect it to a source or to a reference",
        )
        .with(member, "is connected to it")
    } else {
        NetworkProblem::new(
            "missing_reference",
            "this electrical network has no reference",
            "add an ElectricalReference and connect it to one of the nodes",
        )
        .with(member, "belongs to it")
    }
}
