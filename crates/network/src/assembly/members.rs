//! Members of a network with their ports numbered as nodes.

use blocksim_block::physical::{Domain, Element, Pin};

use petgraph::unionfind::UnionFind;

use crate::assembly::words::Words;
use crate::member::{Member, Terminal};
use crate::problem::NetworkProblem;

/// Members with their ports numbered as nodes, domain by domain.
pub(crate) struct Members<'a> {
    pub(crate) list: &'a [Member],
    /// Node of each port of each member.
    node_of: Vec<Vec<usize>>,
    /// Terminals of each node of each domain.
    terminals: [Vec<Vec<Terminal>>; 5],
    /// Nodes of rotational and translational ports.
    pub rotational_nodes: usize,
    /// Nodes of electrical ports, then three of each three-phase node, then those of the other domains with nodal analysis, then those
    /// inside components.
    pub electrical_nodes: usize,
    pub three_phase_nodes: usize,
    pub frame_nodes: usize,
    /// First node inside each member.
    inner: Vec<usize>,
    /// The node that each electrical node is one with; `None` if its potential is zero.
    one_with: Vec<Option<usize>>,
    /// Domains in which something holds a potential at zero.
    references: Vec<Domain>,
}

fn index_of(domain: Domain) -> usize {
    match domain {
        // Speeds are speeds: gears between the two, as rack and pinion, need one space of nodes.
        Domain::Rotational | Domain::Translational => 0,
        Domain::Electrical => 1,
        Domain::ThreePhase => 2,
        Domain::Frame => 3,
        // Each node has one domain.
        Domain::Thermal | Domain::Magnetic | Domain::Hydraulic => 4,
    }
}

/// Number of nodes inside a component.
fn inner_nodes(elements: &[Element]) -> usize {
    let inner = |pin: &Pin| if let Pin::Inner(index) = pin { index + 1 } else { 0 };
    elements.iter().flat_map(Element::pins).map(|pin| inner(&pin)).max().unwrap_or(0)
}

impl<'a> Members<'a> {
    pub(crate) fn new(list: &'a [Member], joined: &[Vec<Terminal>]) -> Self {
        let unset = usize::MAX;
        let mut node_of: Vec<Vec<usize>> =
            list.iter().map(|member| vec![unset; member.part.ports.len()]).collect();
        let mut terminals: [Vec<Vec<Terminal>>; 5] = Default::default();
        let domain = |t: &Terminal| list[t.member].part.ports[t.port].domain;
        // Accounts look at the network without being part of it.
        let joined = joined.iter().map(|set| {
            set.iter().copied().filter(|t| !list[t.member].is_account()).collect::<Vec<Terminal>>()
        });
        for set in joined {
            let Some(first) = set.first() else { continue };
            let nodes = &mut terminals[index_of(domain(first))];
            for t in &set {
                node_of[t.member][t.port] = nodes.len();
            }
            nodes.push(set);
        }
        for (member, ports) in node_of.iter_mut().enumerate().filter(|(i, _)| !list[*i].is_account()) {
            for (port, node) in ports.iter_mut().enumerate().filter(|(_, node)| **node == unset) {
                let t = Terminal { member, port };
                let nodes = &mut terminals[index_of(domain(&t))];
                *node = nodes.len();
                nodes.push(vec![t]);
            }
        }
        let mut electrical_nodes = terminals[1].len() + 3 * terminals[2].len() + terminals[4].len();
        let mut inner = Vec::new();
        for member in list {
            inner.push(electrical_nodes);
            electrical_nodes += inner_nodes(&member.part.elements);
        }
        let mut members = Self {
            list,
            node_of,
            rotational_nodes: terminals[0].len(),
            electrical_nodes,
            inner,
            one_with: Vec::new(),
            references: Vec::new(),
            three_phase_nodes: terminals[2].len(),
            frame_nodes: terminals[3].len(),
            terminals,
        };
        members.unite();
        members
    }

    /// Makes nodes one that junctions and references join.
    fn unite(&mut self) {
        let ground = self.electrical_nodes;
        let mut joined = UnionFind::new(ground + 1);
        for (member, element) in self.elements() {
            let at = |pin: Pin| self.node_of_its_own(member, pin).unwrap_or(ground);
            match *element {
                Element::Junction { p, n } => _ = joined.union(at(p), at(n)),
                Element::ElectricalReference { port } => _ = joined.union(at(Pin::Port(port)), ground),
                _ => {}
            }
        }
        let zero = joined.find(ground);
        let references = self.elements().filter_map(|(member, element)| match *element {
            Element::ElectricalReference { port } => Some(self.list[member].part.ports[port].domain),
            _ => None,
        });
        self.references = references.collect();
        self.one_with =
            (0..ground).map(|node| Some(joined.find(node)).filter(|root| *root != zero)).collect();
    }

    pub(crate) fn elements(&self) -> impl Iterator<Item = (usize, &'a Element)> + '_ {
        self.list.iter().enumerate().flat_map(|(i, member)| member.part.elements.iter().map(move |e| (i, e)))
    }

    pub(crate) fn count(&self, which: impl Fn(&Element) -> bool) -> usize {
        self.elements().filter(|(_, element)| which(element)).count()
    }

    /// The ports that are joined at a three-phase node.
    pub(crate) fn three_phase_terminals(&self, node: usize) -> &[Terminal] {
        &self.terminals[2][node]
    }

    pub(crate) fn node(&self, member: usize, port: usize) -> usize {
        self.node_of[member][port]
    }

    /// The node at a pin, `None` if its potential is zero.
    pub(crate) fn electrical_node(&self, member: usize, pin: Pin) -> Option<usize> {
        self.node_of_its_own(member, pin).and_then(|node| self.one_with[node])
    }

    /// The node at a pin before junctions and references make several nodes one.
    fn node_of_its_own(&self, member: usize, pin: Pin) -> Option<usize> {
        match pin {
            Pin::Ground => None,
            Pin::Inner(index) => Some(self.inner[member] + index),
            Pin::Port(port) => {
                let of_domain = self.node(member, port);
                let electrical = self.list[member].part.ports[port].domain == Domain::Electrical;
                Some(if electrical { of_domain } else { self.first_of_others() + of_domain })
            }
            Pin::Phase(port, phase) => Some(self.terminals[1].len() + 3 * self.node(member, port) + phase),
        }
    }

    fn first_of_others(&self) -> usize {
        self.terminals[1].len() + 3 * self.three_phase_nodes
    }

    /// Whether an electrical node is a phase of a three-phase node.
    pub(crate) fn is_phase(&self, node: usize) -> bool {
        let ports = self.terminals[1].len();
        (ports..ports + 3 * self.three_phase_nodes).contains(&node)
    }

    /// Whether anything holds a potential at zero in this domain.
    pub(crate) fn is_grounded(&self, domain: Domain) -> bool {
        self.references.contains(&domain)
    }

    pub(crate) fn path(&self, member: usize) -> &str {
        &self.list[member].path
    }

    /// Whether nothing else is connected to a port.
    pub(crate) fn alone(&self, member: usize, port: usize) -> bool {
        let domain = self.list[member].part.ports[port].domain;
        self.terminals[index_of(domain)][self.node_of[member][port]].len() == 1
    }

    fn name_at(&self, space: usize, node: usize) -> String {
        let t = self.terminals[space][node][0];
        format!("{}.{}", self.list[t.member].path, self.list[t.member].part.ports[t.port].name)
    }

    pub(crate) fn node_name(&self, node: usize) -> String {
        self.name_at(0, node)
    }

    pub(crate) fn electrical_node_name(&self, node: usize) -> String {
        let ports = self.terminals[1].len();
        let phases = self.first_of_others();
        if node < ports {
            self.name_at(1, node)
        } else if node < phases {
            self.name_at(2, (node - ports) / 3)
        } else if node < phases + self.terminals[4].len() {
            self.name_at(4, node - phases)
        } else {
            self.path(self.any_electrical_member_at(node)).to_owned()
        }
    }

    pub(crate) fn any_electrical_member_at(&self, node: usize) -> usize {
        let ports = self.terminals[1].len();
        if node < ports {
            self.terminals[1][node][0].member
        } else if node < ports + 3 * self.three_phase_nodes {
            self.terminals[2][(node - ports) / 3][0].member
        } else if node < self.first_of_others() + self.terminals[4].len() {
            self.terminals[4][node - self.first_of_others()][0].member
        } else {
            self.inner.partition_point(|first| *first <= node) - 1
        }
    }

    /// What a mechanical node carries.
    pub(crate) fn node_domain(&self, node: usize) -> Domain {
        let Terminal { member, port } = self.terminals[0][node][0];
        self.list[member].part.ports[port].domain
    }

    /// Whether a part of the network stands still in this domain.
    fn is_held(&self, domain: Domain) -> bool {
        self.elements().any(|(member, element)| match *element {
            Element::World { .. } => true,
            Element::MechanicalReference { port } => self.list[member].part.ports[port].domain == domain,
            _ => false,
        })
    }

    /// A joint that drives a node against another one which nothing else is connected to: the joint, that other node, and whether it is
    /// the case.
    fn loose_drive(&self, node: usize) -> Option<(usize, usize, bool)> {
        self.elements().find_map(|(member, element)| {
            let Element::Joint { freedoms, .. } = element else { return None };
            let drives = freedoms.iter().filter_map(|freedom| freedom.axis()?.drive);
            let sides = drives.flat_map(|(rod, case)| [(rod, case, true), (case, rod, false)]);
            let mut loose = sides.filter(|(port, ..)| self.node(member, *port) == node);
            let (_, other, is_case) =
                loose.find(|(_, other, _)| self.terminals[0][self.node(member, *other)].len() == 1)?;
            Some((member, self.node(member, other), is_case))
        })
    }

    /// The free speed of a node moves nothing.
    pub(crate) fn no_inertia(&self, node: usize) -> NetworkProblem {
        let terminals = &self.terminals[0][node];
        let name = self.node_name(node);
        let domain = self.node_domain(node);
        let Words { inertia, part, reference, .. } = Words::of(domain);
        if let [only] = terminals[..] {
            NetworkProblem::new(
                "unconnected_port",
                format!("the {domain} port `{name}` is not connected"),
                format!("connect it; a case goes to a {reference}"),
            )
            .with(only.member, "has this port")
        } else if let Some((member, other, is_case)) = self.loose_drive(node) {
            let other = self.node_name(other);
            let (holds, help) = if is_case {
                ("holds", format!("connect it to a {reference}, or to the part that the drive is mounted on"))
            } else {
                ("drives", "connect the drive to it".to_owned())
            };
            NetworkProblem::new(
                "missing_reference",
                format!(
                    "nothing {holds} `{other}`, against which the joint moves what is connected to `{name}`"
                ),
                help,
            )
            .with(member, "has both sides of the drive")
        } else {
            let (code, help) = if self.is_held(domain) {
                ("no_inertia", format!("add {part} there, or couple the node to something that has one"))
            } else {
                (
                    "missing_reference",
                    format!("this network has no {reference}: connect one to the cases, or add {part} there"),
                )
            };
            let problem = NetworkProblem::new(
                code,
                format!("nothing at `{name}` has {inertia} or a given speed, so its acceleration is unknown"),
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

    /// Ports that nothing is connected to, in domains with nodal analysis.
    pub(crate) fn unconnected(&self) -> Vec<NetworkProblem> {
        let mut problems = Vec::new();
        for space in [Domain::Electrical, Domain::ThreePhase, Domain::Thermal].map(index_of) {
            for (node, terminals) in self.terminals[space].iter().enumerate() {
                let open = |t: &Terminal| self.list[t.member].part.ports[t.port].open;
                if let [only] = terminals[..]
                    && !open(&only)
                {
                    let domain = self.list[only.member].part.ports[only.port].domain;
                    problems.push(
                        NetworkProblem::new(
                            "unconnected_port",
                            format!("the {domain} port `{}` is not connected", self.name_at(space, node)),
                            "connect it with `<->`",
                        )
                        .with(only.member, "has this port"),
                    );
                }
            }
        }
        problems
    }

    /// The supply that feeds each supply and each machine of three-phase nodes where nothing else is connected: the
    /// member that is the source. Such machines need no circuit.
    pub(crate) fn fed_by(&self) -> Vec<Option<usize>> {
        let mut fed_by = vec![None; self.list.len()];
        for terminals in &self.terminals[2] {
            let is = |t: &Terminal, which: &dyn Fn(&Element) -> bool| {
                self.list[t.member].part.elements.iter().any(which)
            };
            let supply = |e: &Element| matches!(e, Element::Supply { .. });
            let machine = |e: &Element| matches!(e, Element::Machine { ends: None, .. });
            let alone = |t: &Terminal| {
                let part = &self.list[t.member].part;
                part.separate.is_none()
                    && part.ports.iter().filter(|port| is_electrical(port.domain)).count() == 1
            };
            let plain = terminals.iter().all(|t| (is(t, &supply) || is(t, &machine)) && alone(t));
            let mut supplies = terminals.iter().filter(|t| is(t, &supply));
            if let (true, Some(source), None) = (plain, supplies.next(), supplies.next()) {
                terminals.iter().for_each(|t| fed_by[t.member] = Some(source.member));
            }
        }
        fed_by
    }
}

fn is_electrical(domain: Domain) -> bool {
    matches!(domain, Domain::Electrical | Domain::ThreePhase)
}
