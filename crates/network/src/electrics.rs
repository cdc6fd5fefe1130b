//! Potentials and currents: how they follow from sources and windings.

use blocksim_block::physical::Element;
use nalgebra::DMatrix;

use crate::eliminate::{Form, Relations};
use crate::members::Members;
use crate::problem::NetworkProblem;

/// Where the current of a two-pin comes from.
#[derive(Debug, Clone)]
pub(crate) enum CurrentOf {
    /// The component gives it; index among the windings.
    Winding(usize),
    /// It follows from the currents of the windings.
    Balance(Form),
    /// None flows.
    Open,
}

/// The electrical side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Electrics {
    /// Number of sources.
    pub sources: usize,
    /// Number of windings.
    pub windings: usize,
    /// Voltage of each two-pin over the voltages of the sources.
    pub voltages: Vec<Form>,
    /// Current of each two-pin.
    pub currents: Vec<CurrentOf>,
    /// Windings whose current follows from states alone.
    pub from_state: Vec<bool>,
}

impl Electrics {
    /// Whether the current of a two-pin follows from states alone.
    pub(crate) fn is_state(&self, two_pin: usize) -> bool {
        match &self.currents[two_pin] {
            CurrentOf::Winding(winding) => self.from_state[*winding],
            CurrentOf::Balance(form) => {
                form.terms().iter().all(|(winding, _)| self.from_state[*winding as usize])
            }
            CurrentOf::Open => true,
        }
    }
}

/// Finds how potentials follow from the sources, and the currents of the sources from those of the windings.
pub(crate) fn build(m: &Members) -> Result<Electrics, Vec<NetworkProblem>> {
    let nodes = m.electrical_nodes;
    let sources = m.count(|element| matches!(element, Element::VoltageSource { .. }));
    let mut relations = Relations::new(nodes, sources);
    let mut owners = Vec::new();
    let mut two_pins: Vec<(usize, usize, Option<usize>, Option<usize>)> = Vec::new(); // p, n, row, winding
    let mut windings: Vec<(usize, usize)> = Vec::new();
    let mut from_state = Vec::new();
    let mut source = 0;
    for (member, element) in m.elements() {
        let node = |port: usize| m.node(member, port);
        match *element {
            Element::ElectricalReference { port } => {
                relations.add(&[(node(port), 1.0)], &[]);
                owners.push((member, "holds the potential at zero"));
            }
            Element::VoltageSource { p, n } => {
                let row = relations.add(&[(node(p), 1.0), (node(n), -1.0)], &[(source, 1.0)]);
                owners.push((member, "prescribes the voltage"));
                two_pins.push((node(p), node(n), Some(row), None));
                source += 1;
            }
            Element::CurrentProbe { p, n } => {
                let row = relations.add(&[(node(p), 1.0), (node(n), -1.0)], &[]);
                owners.push((member, "is a wire"));
                two_pins.push((node(p), node(n), Some(row), None));
            }
            Element::Winding { p, n, from_state: state } => {
                from_state.push(state);
                two_pins.push((node(p), node(n), None, Some(windings.len())));
                windings.push((node(p), node(n)));
            }
            Element::VoltageProbe { p, n } => two_pins.push((node(p), node(n), None, None)),
            _ => {}
        }
    }
    if nodes == 0 {
        return Ok(Electrics::default());
    }

    let eliminated = relations.eliminate(|_| 0);
    let mut problems = Vec::new();
    for (row, fights) in &eliminated.dependent {
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
        for (index, (other, what)) in owners.iter().enumerate() {
            let shares =
                relations.row(*row).iter().zip(relations.row(index)).any(|(a, b)| *a != 0.0 && *b != 0.0);
            if index != *row && *other != member && shares {
                problem = problem.with(*other, *what);
            }
        }
        problems.push(problem);
    }
    if let Some(node) = eliminated.free.first() {
        problems.push(undetermined(m, *node));
    }
    if !problems.is_empty() {
        return Err(problems);
    }

    // Kirchhoff at every node: A' i = -(currents of windings), with A the relations.
    let rows = relations.len();
    let a = DMatrix::from_fn(rows, nodes, |row, node| relations.row(row)[node]);
    let Some(left_inverse) = (&a * a.transpose()).cholesky().map(|gram| gram.solve(&a)) else {
        return Err(vec![undetermined(m, 0)]);
    };
    let balance = |row: usize| {
        let dense: Vec<f64> =
            windings.iter().map(|(p, n)| -(left_inverse[(row, *p)] - left_inverse[(row, *n)])).collect();
        Form::from_dense(
            &dense.iter().map(|value| if value.abs() < 1e-12 { 0.0 } else { *value }).collect::<Vec<_>>(),
        )
    };
    let mut electrics = Electrics { sources, windings: windings.len(), from_state, ..Electrics::default() };
    for (p, n, row, winding) in two_pins {
        let (p, n) = (&eliminated.over_given[p], &eliminated.over_given[n]);
        electrics.voltages.push(Form::from_dense(&p.iter().zip(n).map(|(p, n)| p - n).collect::<Vec<_>>()));
        electrics.currents.push(match (row, winding) {
            (Some(row), _) => CurrentOf::Balance(balance(row)),
            (None, Some(winding)) => CurrentOf::Winding(winding),
            (None, None) => CurrentOf::Open,
        });
    }
    Ok(electrics)
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
