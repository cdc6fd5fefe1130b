//! From a level of a model to what can be laid out: blocks with their looks and ports, and nets.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_block::physical::Domain;
use blocksim_diagram::{ConnectionAst, Model, Reference, Sources};
use blocksim_layout::{End, Graph, Net, Node, PortKind, Standing};

use crate::bus::is_bus;
use crate::figure::{Figure, Look, PortLook, figure_of, pill, selector};
use crate::size::{form_of, label_size, size_of};

/// One level, ready to be laid out. Figures and nodes of the graph go together, as do nets and lines.
#[derive(Debug, Clone)]
pub struct Level {
    /// Title of the diagram.
    pub title: String,
    /// Path of the level; empty at the top.
    pub path: String,
    /// What is laid out.
    pub graph: Graph,
    /// What is drawn for each node.
    pub figures: Vec<Figure>,
    /// What is drawn for each net.
    pub lines: Vec<Line>,
}

/// What a wire carries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Drawn thick: a bus or a vector.
    pub thick: bool,
    /// Domain of a conserving connection; none for a signal.
    pub domain: Option<Domain>,
    /// The ports, `motor.r`, the source first.
    pub title: String,
    /// Path of the output that it comes from, with the elements picked from a bus: `arm/link1.q`. None for conserving
    /// connections and for what comes from an input of the level.
    pub signal: Option<String>,
}

impl Level {
    /// The name of the signal on a wire, from the top: of an output or of an input of a subsystem; nothing of conserving connections.
    pub fn name_of(&self, net: usize) -> Option<String> {
        let net = &self.graph.nets[net];
        let end = net.ends.first().filter(|_| net.directed)?;
        let figure = &self.figures[end.node];
        let port = &figure.ports[end.port].name;
        let within = |name: &str| match self.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}/{name}"),
        };
        Some(match (&figure.look, figure.name.strip_prefix("in.")) {
            (Look::Pill, _) => format!("{}.{port}", self.path),
            (Look::Selector, Some(input)) => format!("{}.{input}.{port}", self.path),
            _ => format!("{}.{port}", within(&figure.name)),
        })
    }
}

/// The level of a model. `buses` names the inputs of the level that carry buses.
pub fn level(model: &Model, sources: &Sources, buses: &BTreeSet<String>) -> Level {
    let mut build = Build { model, figures: Vec::new(), place: BTreeMap::new(), nets: BTreeMap::new() };
    let selected = selections(model);
    for (name, _) in &model.ast.inputs {
        build.add(name.text.clone(), pill(&name.text, PortKind::Output), "in");
        build.selector("in", &name.text, &selected);
    }
    for block in &model.blocks {
        let connected = connected_ports(model, &block.name);
        let written = model.ast.blocks.iter().find(|written| written.name.text == block.name);
        let text = sources.file(model.ast.file).text;
        let figure = figure_of(block, written, &text, &connected);
        build.add(block.name.clone(), figure, "block");
        for output in block.outputs() {
            build.selector(&block.name, &output, &selected);
        }
    }
    for (name, _) in &model.ast.outputs {
        build.add(name.text.clone(), pill(&name.text, PortKind::Input), "out");
    }
    for (name, _) in &model.ast.ports {
        let mut connector = pill(&name.text, PortKind::Free);
        connector.ports[0].domain = model.port_domain(&name.text);
        build.add(name.text.clone(), connector, "port");
    }
    build.connect();
    build.finish(buses)
}

/// Elements that are picked from buses: source block, port, and the paths of the elements in the order of the file.
type Selections = BTreeMap<(String, String), Vec<String>>;

fn selections(model: &Model) -> Selections {
    let mut found = Selections::new();
    for reference in signal_sources(model).filter(|reference| !reference.elements.is_empty()) {
        let list = found.entry((reference.block.clone(), reference.port.clone())).or_default();
        let path = reference.elements.join(".");
        if !list.contains(&path) {
            list.push(path);
        }
    }
    found
}

fn signal_sources(model: &Model) -> impl Iterator<Item = &Reference> {
    let wires = model.ast.connections.iter().filter_map(|connection| match connection {
        ConnectionAst::Signal(source, _) => Some(source),
        ConnectionAst::Conserving(_) => None,
    });
    wires.chain(model.ast.outputs.iter().map(|(_, reference)| reference))
}

/// Names of the ports of a block that connections speak of.
fn connected_ports(model: &Model, block: &str) -> Vec<(String, PortKind)> {
    let mut found: Vec<(String, PortKind)> = Vec::new();
    let mut note = |reference: &Reference, kind: PortKind| {
        let known = found.iter().any(|(name, _)| *name == reference.port);
        if reference.block == block && !known {
            found.push((reference.port.clone(), kind));
        }
    };
    for connection in &model.ast.connections {
        match connection {
            ConnectionAst::Signal(source, targets) => {
                note(source, PortKind::Output);
                targets.iter().for_each(|target| note(target, PortKind::Input));
            }
            ConnectionAst::Conserving(joined) => joined.iter().for_each(|end| note(end, PortKind::Free)),
        }
    }
    model.ast.outputs.iter().for_each(|(_, reference)| note(reference, PortKind::Output));
    model.ast.ports.iter().for_each(|(_, reference)| note(reference, PortKind::Free));
    found
}

/// Where a net comes from: block, port and elements, or the number of a conserving connection.
type Key = (String, String, String);

struct Build<'a> {
    model: &'a Model,
    figures: Vec<Figure>,
    /// Role (`in`, `block`, `out`, `port`, `selector`) and name to figure.
    place: BTreeMap<(&'static str, String), usize>,
    /// Ends by source, and the order of appearance.
    nets: BTreeMap<Key, (usize, Vec<End>)>,
}

impl Build<'_> {
    fn add(&mut self, name: String, figure: Figure, role: &'static str) {
        self.place.insert((role, name), self.figures.len());
        self.figures.push(figure);
    }

    fn selector(&mut self, block: &str, port: &str, selected: &Selections) {
        if let Some(paths) = selected.get(&(block.to_owned(), port.to_owned())) {
            self.add(format!("{block}.{port}"), selector(&format!("{block}.{port}"), paths), "selector");
            if let (Some(from), Some(to)) =
                (self.source_end(block, port), self.end("selector", &format!("{block}.{port}"), ""))
            {
                self.join(&(block.to_owned(), port.to_owned(), String::new()), from, to);
            }
        }
    }

    fn end(&self, role: &'static str, name: &str, port: &str) -> Option<End> {
        let node = *self.place.get(&(role, name.to_owned()))?;
        let port = self.figures[node].ports.iter().position(|known| known.name == port)?;
        Some(End { node, port })
    }

    fn source_end(&self, block: &str, port: &str) -> Option<End> {
        if block == "in" { self.end("in", port, port) } else { self.end("block", block, port) }
    }

    fn join(&mut self, key: &Key, from: End, to: End) {
        let count = self.nets.len();
        let (_, ends) = self.nets.entry(key.clone()).or_insert_with(|| (count, vec![from]));
        // A second wire to the same port is a mistake that is told elsewhere.
        if !ends.contains(&to) {
            ends.push(to);
        }
    }

    fn wire(&mut self, source: &Reference, to: Option<End>) {
        let elements = source.elements.join(".");
        let from = if elements.is_empty() {
            self.source_end(&source.block, &source.port)
        } else {
            self.end("selector", &format!("{}.{}", source.block, source.port), &elements)
        };
        if let (Some(from), Some(to)) = (from, to) {
            self.join(&(source.block.clone(), source.port.clone(), elements), from, to);
        }
    }

    fn connect(&mut self) {
        let model = self.model;
        let mut groups: Vec<Vec<End>> = Vec::new();
        for connection in &model.ast.connections {
            match connection {
                ConnectionAst::Signal(source, targets) => {
                    for target in targets {
                        let to = self.end("block", &target.block, &target.port);
                        self.wire(source, to);
                    }
                }
                ConnectionAst::Conserving(joined) => {
                    groups.push(
                        joined.iter().filter_map(|end| self.end("block", &end.block, &end.port)).collect(),
                    );
                }
            }
        }
        for (name, source) in &model.ast.outputs {
            let to = self.end("out", &name.text, &name.text);
            self.wire(source, to);
        }
        for (name, inside) in &model.ast.ports {
            let mut ends =
                [self.end("block", &inside.block, &inside.port), self.end("port", &name.text, &name.text)];
            // A chain of bodies begins at its base.
            if name.text == "base" {
                ends.reverse();
                groups.insert(0, ends.into_iter().flatten().collect());
            } else {
                groups.push(ends.into_iter().flatten().collect());
            }
        }
        for (i, ends) in merged(groups).into_iter().enumerate() {
            if ends.len() > 1 {
                self.nets.insert((String::new(), String::new(), format!("{i:06}")), (usize::MAX, ends));
            }
        }
    }

    fn finish(self, buses: &BTreeSet<String>) -> Level {
        let mut nets: Vec<(Key, (usize, Vec<End>))> = self.nets.into_iter().collect();
        nets.sort_by(|a, b| (a.1.0, &a.0).cmp(&(b.1.0, &b.0)));
        let name_of = |end: &End| {
            let (figure, port) = (&self.figures[end.node], &self.figures[end.node].ports[end.port]);
            match figure.look {
                Look::Pill => port.name.clone(),
                _ if port.name.is_empty() => figure.name.clone(),
                _ => format!("{}.{}", figure.name, port.name),
            }
        };
        let lines = nets
            .iter()
            .map(|((block, port, elements), (_, ends))| {
                let directed = !block.is_empty();
                let domain = || ends.iter().find_map(|end| self.figures[end.node].ports[end.port].domain);
                let reference = Reference {
                    block: block.clone(),
                    port: port.clone(),
                    elements: elements.split('.').filter(|e| !e.is_empty()).map(str::to_owned).collect(),
                    span: 0..0,
                };
                let names: Vec<String> = ends.iter().map(name_of).collect();
                let title = match names.split_first() {
                    Some((from, to)) if directed => format!("{from} -> {}", to.join(", ")),
                    _ => names.join(" <-> "),
                };
                let source = if self.model.path.is_empty() {
                    block.clone()
                } else {
                    format!("{}/{block}", self.model.path)
                };
                let picked = if elements.is_empty() { String::new() } else { format!(".{elements}") };
                Line {
                    signal: (directed && block != "in").then(|| format!("{source}.{port}{picked}")),
                    thick: directed && is_bus(self.model, &reference, buses),
                    domain: if directed { None } else { domain() },
                    title,
                }
            })
            .collect();
        let graph = Graph {
            nodes: self.figures.iter().map(node).collect(),
            nets: nets
                .into_iter()
                .map(|((block, ..), (_, ends))| Net { ends, directed: !block.is_empty() })
                .collect(),
        };
        let title = self.model.ast.title.clone().unwrap_or_default();
        Level { title, path: self.model.path.clone(), graph, figures: self.figures, lines }
    }
}

/// Groups that share an end are one.
fn merged(groups: Vec<Vec<End>>) -> Vec<Vec<End>> {
    let mut out: Vec<Vec<End>> = Vec::new();
    for group in groups {
        let (mut touched, rest): (Vec<_>, Vec<_>) =
            out.into_iter().partition(|known: &Vec<End>| known.iter().any(|end| group.contains(end)));
        out = rest;
        let mut whole = if touched.is_empty() { Vec::new() } else { touched.remove(0) };
        for end in touched.into_iter().flatten().chain(group) {
            if !whole.contains(&end) {
                whole.push(end);
            }
        }
        out.push(whole);
    }
    out
}

fn node(figure: &Figure) -> Node {
    let ((width, height), (label_width, label_height)) = (size_of(figure), label_size(figure));
    let standing = match (&figure.look, figure.ports.first().map(|port| port.kind)) {
        (Look::Pill, Some(PortKind::Output)) => Standing::First,
        (Look::Pill, Some(PortKind::Input)) => Standing::Last,
        _ => Standing::Free,
    };
    Node {
        width,
        height,
        label_width,
        label_height,
        form: form_of(figure),
        standing,
        ports: figure.ports.iter().map(|port: &PortLook| port.kind).collect(),
    }
}
