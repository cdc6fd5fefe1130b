//! Connections of one level: every name exists, directions fit, every input has one driver.

use std::cell::OnceCell;

use blocksim_block::physical::Domain;
use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_signal::{closest, surely};
use foldhash::{HashMap, HashMapExt, HashSet, HashSetExt};

use crate::ast::{Ast, ConnectionAst, Reference};
use crate::model::{Content, Model, ModelBlock, PortKind};
use crate::problems::{GUESSES, Problems, a, list, mended, mended_to};

/// Checks the connections of a diagram and of all diagrams inside it.
pub(crate) fn check(model: &Model, problems: &mut Problems) {
    let blocks = model.blocks.iter().map(|block| (block.name.as_str(), block)).collect();
    let mut level = Wiring::new(model, blocks, problems);
    level.connections();
    level.interface();
    level.unconnected();
    for block in &model.blocks {
        if let Content::Diagram(inside) = &block.content {
            check(inside, problems);
        }
    }
}

fn a_port(domain: Domain) -> String {
    a(&format!("{domain} port"))
}

/// What leads from ports of one kind to those of another.
fn way_between(one: Domain, other: Domain) -> &'static str {
    match (one, other) {
        (Domain::Rotational, Domain::Translational) | (Domain::Translational, Domain::Rotational) => {
            "a WheelAndAxle, a RackAndPinion or a LeadScrew leads from one to the other"
        }
        (Domain::Electrical, Domain::Thermal) | (Domain::Thermal, Domain::Electrical) => {
            "join ports of one kind; the thermal port `h` of a Resistor(heat_port: true) leads from one to the other"
        }
        (_, Domain::Thermal) | (Domain::Thermal, _) => {
            "join ports of one kind; a part with losses has a thermal port `h` with `heat_port: true`"
        }
        (Domain::Electrical, Domain::Magnetic) | (Domain::Magnetic, Domain::Electrical) => {
            "a MagneticWinding leads from one to the other"
        }
        (Domain::Rotational, Domain::Hydraulic) | (Domain::Hydraulic, Domain::Rotational) => {
            "a HydraulicPump leads from one to the other"
        }
        (Domain::Translational, Domain::Hydraulic) | (Domain::Hydraulic, Domain::Translational) => {
            "a HydraulicCylinder leads from one to the other"
        }
        _ => "join ports of one kind; motors, joints and sensors lead from one to the other",
    }
}

struct Wiring<'a> {
    model: &'a Model,
    blocks: HashMap<&'a str, &'a ModelBlock>,
    problems: &'a mut Problems,
    /// Block and input, and the connection that drives it.
    drivers: HashMap<(&'a str, &'a str), Place>,
    /// Blocks that a connection names with a port that they do not have, and ports of blocks that there are not: inputs
    /// without a driver, most likely, because of that.
    misnamed: HashSet<&'a str>,
    adrift: HashSet<&'a str>,
    /// Blocks whose name stands twice: which of them is meant nobody knows.
    doubled: HashSet<&'a str>,
    /// Ports that a file was told to lack, which is one cause however many blocks are of this file.
    lacking: HashSet<(FileId, &'a str)>,
    /// Names that nothing has, so far.
    unknown: usize,
    /// How often connections name what they join, once somebody asks.
    named: OnceCell<HashMap<&'a str, usize>>,
    /// Names of blocks that are written another way wherever they are used, and have been told.
    told: HashSet<&'a str>,
}

impl<'a> Wiring<'a> {
    fn new(
        model: &'a Model,
        blocks: HashMap<&'a str, &'a ModelBlock>,
        problems: &'a mut Problems,
    ) -> Wiring<'a> {
        let mut seen = HashSet::new();
        let names = model.blocks.iter().map(|block| block.name.as_str());
        let names = names.filter(|_| blocks.len() < model.blocks.len());
        let doubled = names.filter(|name| !seen.insert(*name)).collect();
        Wiring {
            model,
            blocks,
            problems,
            drivers: HashMap::new(),
            misnamed: HashSet::new(),
            adrift: HashSet::new(),
            doubled,
            lacking: HashSet::new(),
            unknown: 0,
            named: OnceCell::new(),
            told: HashSet::new(),
        }
    }

    fn ast(&self) -> &'a Ast {
        &self.model.ast
    }

    fn connections(&mut self) {
        for connection in &self.model.ast.connections {
            match connection {
                ConnectionAst::Signal(source, targets) => {
                    self.source(source);
                    targets.iter().for_each(|target| self.target(target));
                }
                ConnectionAst::Conserving(joined) => self.joined(joined),
            }
        }
    }

    /// The block of a reference; reports a name that is none.
    fn block(&mut self, reference: &'a Reference) -> Option<&'a ModelBlock> {
        let found = self.blocks.get(reference.block.as_str()).copied();
        if found.is_none() {
            self.unknown += 1;
            self.adrift.insert(&reference.port);
            if self.ast().unread.blocks {
                return None;
            }
            if self.told.contains(reference.block.as_str()) || self.defined_otherwise(reference) {
                return None;
            }
            let known: Vec<&str> = self.model.blocks.iter().map(|block| block.name.as_str()).collect();
            let start = reference.span.start;
            let place = self.ast().place(&(start..start + reference.block.len()));
            let problem =
                Problem::error("unknown_block_name", format!("there is no block `{}`", reference.block))
                    .at(&place, "no such block");
            self.problems.push(if self.unknown > GUESSES {
                problem
            } else {
                let problem = mended(problem, place, &reference.block, known.iter().copied());
                match closest(&reference.block, known.iter().copied()) {
                    Some(close) => problem.help(format!("did you mean `{close}`?")),
                    None if reference.block == "out" => problem.help(format!(
                        "outputs are declared: `outputs: {{ \"{}\": \"block.port\" }}`",
                        reference.port
                    )),
                    None => problem.help(format!("the blocks here are {}", list(&known))),
                }
            });
        }
        found
    }

    /// A name that stands in several connections, and a block of nearly that name which stands in none: the slip is in the one
    /// place where the block is declared. Told once.
    fn defined_otherwise(&mut self, reference: &'a Reference) -> bool {
        let named = self.named.get_or_init(|| {
            let mut named = HashMap::new();
            for reference in self.model.ast.connections.iter().flat_map(ConnectionAst::references) {
                *named.entry(reference.block.as_str()).or_default() += 1;
            }
            named
        });
        let uses = named.get(reference.block.as_str()).copied().unwrap_or_default();
        if uses < 2 || self.unknown > GUESSES {
            return false;
        }
        let unused = self.model.blocks.iter().filter(|block| !named.contains_key(block.name.as_str()));
        let unused: Vec<&ModelBlock> = unused.collect();
        let meant = surely(&reference.block, unused.iter().map(|block| block.name.as_str()));
        let Some(block) = unused.iter().find(|block| Some(block.name.as_str()) == meant) else {
            return false;
        };
        let start = reference.span.start;
        let problem = Problem::error(
            "unknown_block_name",
            format!("there is no block `{}`, but connections use it {uses} times", reference.block),
        )
        .at(&block.place, "not used in any connection");
        let problem = mended_to(problem, block.place.clone(), &block.name, &reference.block)
            .at(&self.ast().place(&(start..start + reference.block.len())), "no such block")
            .help(format!("rename `{}` to `{}`", block.name, reference.block));
        self.problems.push(problem);
        self.told.insert(&reference.block);
        true
    }

    fn port(&mut self, reference: &'a Reference, side: &str) -> Option<PortKind> {
        let block = self.block(reference)?;
        if let Some(port) = block.port(&reference.port) {
            return Some(port);
        }
        self.misnamed.insert(&reference.block);
        if let Content::Diagram(inside) = &block.content
            && !self.lacking.insert((inside.ast.file, &reference.port))
        {
            return None;
        }
        let known = match side {
            "input" => block.inputs(),
            "output" => block.outputs(),
            _ => block.ports(),
        };
        let mut all = block.inputs();
        all.extend(block.outputs());
        all.extend(block.ports());
        let (kind, declared) = (block.kind.clone(), block.place.clone());
        let place = self.ast().place(&reference.span);
        let problem = Problem::error(
            "unknown_port",
            format!("`{}` has no {side} `{}`", reference.block, reference.port),
        )
        .at(&place, "no such port")
        .at(&declared, format!("`{}` is of kind {kind}", reference.block));
        let start = reference.span.start + reference.block.len() + 1;
        let named = self.ast().place(&(start..start + reference.port.len()));
        let problem = mended(problem, named, &reference.port, known.iter().map(String::as_str));
        let listed = if known.is_empty() {
            format!("`{}` has no {side}s", reference.block)
        } else {
            format!("its {side}s are {}", list(&known))
        };
        self.problems.push(match closest(&reference.port, all.iter().map(String::as_str)) {
            Some(close) => problem.help(format!("did you mean `{close}`? {listed}")),
            None => problem.help(listed),
        });
        None
    }

    fn source(&mut self, reference: &'a Reference) {
        if reference.block == "in" {
            self.own_input(reference);
            return;
        }
        match self.port(reference, "output") {
            None | Some(PortKind::Output | PortKind::Anything) => {}
            Some(PortKind::Input) => {
                self.direction(reference, "is an input and cannot drive a signal", "put it behind `->`")
            }
            Some(PortKind::Conserving(_)) => self.mixed(reference),
        }
    }

    fn own_input(&mut self, reference: &Reference) {
        let known: Vec<&str> = self.ast().inputs.iter().map(|(name, _)| name.text.as_str()).collect();
        if known.contains(&reference.port.as_str()) || self.ast().unread.inputs {
            return;
        }
        let place = self.ast().place(&reference.span);
        let problem =
            Problem::error("unknown_port", format!("this diagram has no input `{}`", reference.port))
                .at(&place, "no such input");
        let start = reference.span.start + "in.".len();
        let named = self.ast().place(&(start..start + reference.port.len()));
        let problem = mended(problem, named, &reference.port, known.iter().copied());
        self.problems.push(match closest(&reference.port, known.iter().copied()) {
            Some(close) => problem.help(format!("did you mean `in.{close}`?")),
            None if known.is_empty() => problem.help("declare it: `inputs: { \"name\": (unit: \"1\") }`"),
            None => problem.help(format!("its inputs are {}", list(&known))),
        });
    }

    fn target(&mut self, reference: &'a Reference) {
        let place = self.ast().place(&reference.span);
        match self.port(reference, "input") {
            None => return,
            Some(PortKind::Input | PortKind::Anything) => {}
            Some(PortKind::Output) => {
                self.direction(reference, "is an output and cannot be driven", "put it in front of `->`");
                return;
            }
            Some(PortKind::Conserving(_)) => {
                self.mixed(reference);
                return;
            }
        }
        if !reference.elements.is_empty() {
            self.problems.push(
                Problem::error("unknown_port", "an element of a bus cannot be driven")
                    .at(&place, "")
                    .help("drive the whole input; a BusCreator makes a bus"),
            );
        }
        let key = (reference.block.as_str(), reference.port.as_str());
        if let Some(other) = self.drivers.insert(key, place.clone())
            && !self.doubled.contains(reference.block.as_str())
        {
            self.problems.push(
                Problem::error(
                    "second_driver",
                    format!("`{}.{}` has two drivers", reference.block, reference.port),
                )
                .at(&place, "the second")
                .at(&other, "the first")
                .help("an input takes one signal: add them with Sum, or choose with Switch"),
            );
        }
    }

    fn joined(&mut self, joined: &'a [Reference]) {
        let mut first: Option<(Domain, Place)> = None;
        for reference in joined {
            let place = self.ast().place(&reference.span);
            if !reference.elements.is_empty() {
                self.problems
                    .push(Problem::error("unknown_port", "a conserving port has no elements").at(&place, ""));
                continue;
            }
            match self.port(reference, "conserving port") {
                None | Some(PortKind::Anything) => {}
                Some(PortKind::Conserving(domain)) => match &first {
                    None => first = Some((domain, place)),
                    Some((other, _)) if *other == domain => {}
                    Some((other, there)) => self.problems.push(
                        Problem::error(
                            "domain_mismatch",
                            format!("{} cannot be joined to {}", a_port(domain), a_port(*other)),
                        )
                        .at(&place, format!("{domain}"))
                        .at(there, format!("{other}"))
                        .help(way_between(domain, *other)),
                    ),
                },
                Some(PortKind::Input | PortKind::Output) => self.problems.push(
                    Problem::error("port_kind", format!("`{}.{}` is a signal port", reference.block, reference.port))
                        .at(&place, "joined with `<->`")
                        .help("connect signals with `->`; sensors and sources lead between signals and conserving ports"),
                ),
            }
        }
    }

    fn direction(&mut self, reference: &'a Reference, what: &str, help: &str) {
        self.misnamed.insert(&reference.block);
        let place = self.ast().place(&reference.span);
        let declared = self.blocks.get(reference.block.as_str()).map(|block| block.place.clone());
        let problem =
            Problem::error("wrong_direction", format!("`{}.{}` {what}", reference.block, reference.port))
                .at(&place, "");
        let problem = match declared {
            Some(declared) => problem.at(&declared, "declared here"),
            None => problem,
        };
        self.problems.push(problem.help(help));
    }

    fn mixed(&mut self, reference: &Reference) {
        let place = self.ast().place(&reference.span);
        self.problems.push(
            Problem::error("port_kind", format!("`{}.{}` is a conserving port", reference.block, reference.port))
                .at(&place, "connected with `->`")
                .help("join conserving ports with `<->`; sensors and sources lead between signals and conserving ports"),
        );
    }

    /// What the diagram hands outward.
    fn interface(&mut self) {
        for (_, reference) in &self.model.ast.outputs {
            self.source(reference);
        }
        for (_, reference) in &self.model.ast.ports {
            if let Some(PortKind::Input | PortKind::Output) = self.port(reference, "conserving port") {
                let place = self.ast().place(&reference.span);
                self.problems.push(
                    Problem::error(
                        "port_kind",
                        format!("`{}.{}` is a signal port", reference.block, reference.port),
                    )
                    .at(&place, "handed outward as a conserving port")
                    .help("list it under `outputs`, or drive it from `inputs`"),
                );
            }
        }
    }

    fn unconnected(&mut self) {
        if self.ast().unread.connections {
            return;
        }
        for block in &self.model.blocks {
            let needed: Vec<&str> = match &block.content {
                Content::Block { interface, .. } => {
                    let needed = interface.inputs.iter().filter(|input| input.default.is_none());
                    needed.map(|input| input.name.as_str()).collect()
                }
                // One of these is called otherwise inside.
                Content::Diagram(inside) if inside.ast.lacks_inputs() => Vec::new(),
                Content::Diagram(inside) => inside.inputs().collect(),
                Content::Unknown => Vec::new(),
            };
            for input in needed {
                let driven = self.drivers.contains_key(&(block.name.as_str(), input));
                // The cause has been told: a connection that leads elsewhere than was meant.
                let told = self.misnamed.contains(block.name.as_str())
                    || self.doubled.contains(block.name.as_str())
                    || self.adrift.contains(input);
                if !driven && !told {
                    self.problems.push(
                        Problem::error(
                            "unconnected_input",
                            format!("`{}.{input}` is not connected", block.path),
                        )
                        .at(&block.place, format!("input `{input}` has no driver"))
                        .help(format!("add `\"... -> {}.{input}\"` to the connections", block.name)),
                    );
                }
            }
        }
    }
}
