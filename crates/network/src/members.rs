//! Members of a network with their ports numbered as nodes.

use blocksim_block::physical::{Domain, Element};

use crate::assembly::{Member, Terminal};
use crate::problem::NetworkProblem;

/// Members with their ports numbered as nodes, domain by domain.
pub(crate) struct Members<'a> {
    pub(crate) list: &'a [Member],
    /// Node of each port of each member.
    node_of: Vec<Vec<usize>>,
    /// Terminals of each node of each domain.
    terminals: [Vec<Vec<Terminal>>; 4],
    pub rotational_nodes: usize,
    pub electrical_nodes: usize,
    pub three_phase_nodes: usize,
    pub frame_nodes: usize,
}

fn index_of(domain: Domain) -> usize {
    match domain {
        // Speeds are speeds: gears between the two, as rack and pinion, need one space of nodes.
        Domain::Rotational | Domain::Translational => 0,
        Domain::Electrical => 1,
        Domain::ThreePhase => 2,
        Domain::Frame => 3,
    }
}

impl<'a> Members<'a> {
    pub(crate) fn new(list: &'a [Member], joined: &[Vec<Terminal>]) -> Self {
        let unset = usize::MAX;
        let mut node_of: Vec<Vec<usize>> =
            list.iter().map(|member| vec![unset; member.part.ports.len()]).collect();
        let mut terminals: [Vec<Vec<Terminal>>; 4] = Default::default();
        let domain = |t: &Terminal| list[t.member].part.ports[t.port].domain;
        for set in joined {
            let Some(first) = set.first() else { continue };
            let nodes = &mut terminals[index_of(domain(first))];
            for t in set {
                node_of[t.member][t.port] = nodes.len();
            }
            nodes.push(set.clone());
        }
        for (member, ports) in node_of.iter_mut().enumerate() {
            for (port, node) in ports.iter_mut().enumerate().filter(|(_, node)| **node == unset) {
                let t = Terminal { member, port };
                let nodes = &mut terminals[index_of(domain(&t))];
                *node = nodes.len();
                nodes.push(vec![t]);
            }
        }
        Self {
            list,
            node_of,
            rotational_nodes: terminals[0].len(),
            electrical_nodes: terminals[1].len(),
            three_phase_nodes: terminals[2].len(),
            frame_nodes: terminals[3].len(),
            terminals,
        }
    }

    pub(crate) fn elements(&self) -> impl Iterator<Item = (usize, &'a Element)> + '_ {
        self.list.iter().enumerate().flat_map(|(i, member)| member.part.elements.iter().map(move |e| (i, e)))
    }

    pub(crate) fn count(&self, which: impl Fn(&Element) -> bool) -> usize {
        self.elements().filter(|(_, element)| which(element)).count()
    }

    pub(crate) fn node(&self, member: usize, port: usize) -> usize {
        self.node_of[member][port]
    }

    pub(crate) fn path(&self, member: usize) -> &str {
        &self.list[member].path
    }

    /// Whether nothing else is connected to a port.
    pub(crate) fn alone(&self, member: usize, port: usize) -> bool {
        let domain = self.list[member].part.ports[port].domain;
        self.terminals[index_of(domain)][self.node_of[member][port]].len() == 1
    }

    fn name(&self, domain: Domain, node: usize) -> String {
        let t = self.terminals[index_of(domain)][node][0];
        format!("{}.{}", self.list[t.member].path, self.list[t.member].part.ports[t.port].name)
    }

    pub(crate) fn node_name(&self, node: usize) -> String {
        self.name(Domain::Rotational, node)
    }

    pub(crate) fn electrical_node_name(&self, node: usize) -> String {
        self.name(Domain::Electrical, node)
    }

    pub(crate) fn any_member_at(&self, node: usize) -> usize {
        self.terminals[0][node][0].member
    }

    pub(crate) fn any_electrical_member_at(&self, node: usize) -> usize {
        self.terminals[1][node][0].member
    }

    /// The free speed of a node moves nothing.
    pub(crate) fn no_inertia(&self, node: usize) -> NetworkProblem {
        let terminals = &self.terminals[0][node];
        let name = self.node_name(node);
        let grounded = self
            .count(|element| matches!(element, Element::RotationalReference { .. } | Element::World { .. }))
            > 0;
        if let [only] = terminals[..] {
            NetworkProblem::new(
                "unconnected_port",
                format!("the rotational port `{name}` is not connected"),
                "connect it; a case goes to a RotationalReference",
            )
            .with(only.member, "has this port")
        } else {
            let (code, help) = if grounded {
                ("no_inertia", "add an Inertia there, or couple the node to something that has one")
            } else {
                (
                    "missing_reference",
                    "this network has no RotationalReference: connect one to the cases, or add an Inertia there",
                )
            };
            let problem = NetworkProblem::new(
                code,
                format!("nothing at `{name}` has inertia or a given speed, so its acceleration is unknown"),
                help,
            );
            terminals.iter().fold(problem, |problem, t| {
                problem.with(
                    t.member,
                    format!("`{}` is connected to it", self.list[t.member].part.ports[t.port].name),
                )
            })
        }
    }

    /// Electrical and three-phase ports that nothing is connected to.
    pub(crate) fn unconnected(&self) -> Vec<NetworkProblem> {
        let mut problems = Vec::new();
        for domain in [Domain::Electrical, Domain::ThreePhase] {
            for (node, terminals) in self.terminals[index_of(domain)].iter().enumerate() {
                if let [only] = terminals[..] {
                    problems.push(
                        NetworkProblem::new(
                            "unconnected_port",
                            format!("the {domain} port `{}` is not connected", self.name(domain, node)),
                            "connect it with `<->`",
                        )
                        .with(only.member, "has this port"),
                    );
                }
            }
        }
        problems
    }

    /// The supply of each three-phase node: the member that is the source.
    pub(crate) fn supplies(&self) -> Result<Vec<usize>, Vec<NetworkProblem>> {
        let mut supplies = vec![None; self.three_phase_nodes];
        let mut problems = Vec::new();
        for (member, element) in self.elements() {
            let Element::Supply { ac } = element else { continue };
            let slot: &mut Option<usize> = &mut supplies[self.node(member, *ac)];
            if let Some(other) = slot {
                problems.push(
                    NetworkProblem::new(
                        "voltage_conflict",
                        "two ideal three-phase sources are connected in parallel",
                        "remove one of them",
                    )
                    .with(member, "prescribes the voltages")
                    .with(*other, "prescribes the voltages"),
                );
            }
            *slot = Some(member);
        }
        for (node, supply) in supplies.iter().enumerate() {
            let terminals = &self.terminals[2][node];
            if supply.is_none() && terminals.len() > 1 {
                let problem = NetworkProblem::new(
                    "missing_supply",
                    format!(
                        "nothing feeds the three-phase node at `{}`",
                        self.name(Domain::ThreePhase, node)
                    ),
                    "connect a three-phase source or an inverter",
                );
                problems.push(terminals.iter().fold(problem, |p, t| p.with(t.member, "is connected to it")));
            }
        }
        if problems.is_empty() { Ok(supplies.into_iter().flatten().collect()) } else { Err(problems) }
    }
}
