//! Conditional subsystems in the list of blocks: a gate for each, outlets where an output needs one, and every block inside
//! asks the gate.

use std::sync::Arc;

use blocksim_block::problem::Problem;
use blocksim_block::{Block, CONDITION, Given};
use blocksim_signal::SampleTime;
use foldhash::HashMap;

use super::view::{Asked, Tree, View};
use super::{Flat, FlatBlock, Source};
use crate::condition::{Condition, Conditional, Gate, Merger, Outlet, gate_input};
use crate::model::ModelBlock;
use crate::problems::{Problems, a};

/// What has to be added to the list of blocks.
#[derive(Default)]
pub(super) struct Conditions {
    /// The levels inside conditional subsystems, outer ones first, each with the place of its gate in the list.
    gates: Vec<(usize, usize)>,
    /// Outputs that need a block of their own: level inside, number of the output, place in the list.
    outlets: Vec<(usize, usize, usize)>,
}

impl<'m> View<'m> {
    fn condition(&self, level: usize) -> Option<&'m Condition> {
        self.levels[level].model.condition.as_ref()
    }

    /// The levels inside conditional subsystems around a level, the innermost first; that level itself included.
    fn conditional(&self, level: usize) -> impl Iterator<Item = usize> + '_ {
        let up = |level: &usize| self.levels[*level].parent.as_ref().map(|(outer, _)| *outer);
        std::iter::successors(Some(level), up).filter(|level| self.condition(*level).is_some())
    }

    /// Gives places in the list, behind its first `first` blocks, to what conditions need. `levels` are those of these blocks.
    pub(super) fn conditions(&mut self, levels: &[usize], problems: &mut Problems) -> Conditions {
        let mut found = Conditions::default();
        let mut next = levels.len();
        let mut place = || {
            next += 1;
            next - 1
        };
        let mut outlets = Vec::new();
        for level in (0..self.levels.len()).filter(|level| self.condition(*level).is_some()) {
            found.gates.push((level, place()));
            for (number, (name, inside)) in self.levels[level].model.ast.outputs.iter().enumerate() {
                let set = self
                    .condition(level)
                    .is_some_and(|c| c.when_disabled.iter().any(|s| s.name == name.text));
                let here = self.levels[level].model.ast.place(&inside.span);
                let mut asked = Asked::new(here.clone(), &inside.port);
                // What is wrong with the name itself is reported where it is read.
                let tree = self.tree(level, &inside.block, &inside.port, &inside.elements, &mut asked);
                let passes = |block: usize| !self.conditional(levels[block]).any(|outer| outer == level);
                match tree {
                    Ok(Tree::Leaf { block, .. }) if set || passes(block) => {
                        outlets.push((level, number, place()));
                    }
                    Ok(Tree::Bus(_)) if set => problems.push(
                        Problem::error(
                            "conditional",
                            format!("`when_disabled` sets `{}`, which is a bus", name.text),
                        )
                        .at(&here, "a bus")
                        .help("make the elements outputs of their own, and the bus outside"),
                    ),
                    Ok(Tree::Bus(elements)) => {
                        if let Some(element) = passing(&elements, &passes) {
                            problems.push(
                                Problem::error(
                                    "conditional",
                                    format!("element `{element}` of output `{}` comes from outside", name.text),
                                )
                                .at(&here, "a conditional subsystem cannot hold it while it does not run")
                                .help("lead it through a block inside, such as `Gain(k: 1)`, or put it into the bus outside"),
                            );
                        }
                    }
                    _ => {}
                }
            }
        }
        for (level, number, index) in &outlets {
            let (name, _) = &self.levels[*level].model.ast.outputs[*number];
            self.outlets.insert((*level, name.text.clone()), *index);
        }
        found.outlets = outlets;
        found
    }

    /// Adds gates and outlets to the list, and puts a condition around each block that has one. `levels` are those of the blocks.
    pub(super) fn apply(
        &self,
        found: &Conditions,
        levels: &[usize],
        flat: &mut Flat,
        problems: &mut Problems,
    ) {
        let gates: HashMap<usize, usize> = found.gates.iter().copied().collect();
        for (at, block) in flat.blocks.iter_mut().enumerate() {
            self.merge(block, at, levels, found, &gates, problems);
        }
        if found.gates.is_empty() {
            return;
        }
        for (block, level) in flat.blocks.iter_mut().zip(levels) {
            self.wrap(block, *level, &gates, true, problems);
        }
        let mut added: Vec<(usize, FlatBlock)> = Vec::new();
        for (level, index) in &found.gates {
            added.extend(self.gate(*level, &gates, problems).map(|gate| (*index, gate)));
        }
        for (level, number, index) in &found.outlets {
            let Some(mut outlet) = self.outlet(*level, *number, gates[level], problems) else { continue };
            if let Some((outer, _)) = &self.levels[*level].parent {
                self.wrap(&mut outlet, *outer, &gates, false, problems);
            }
            added.push((*index, outlet));
        }
        added.sort_by_key(|(index, _)| *index);
        flat.blocks.extend(added.into_iter().map(|(_, block)| block));
    }

    /// Has a block that merges ask the gates of the subsystems that its inputs come from: of each the outermost that is not around
    /// the block itself.
    fn merge(
        &self,
        block: &mut FlatBlock,
        at: usize,
        levels: &[usize],
        found: &Conditions,
        gates: &HashMap<usize, usize>,
        problems: &mut Problems,
    ) {
        let Some(merging) = block.interface.merges else { return };
        let around: Vec<usize> = self.conditional(levels[at]).collect();
        let mut asked: Vec<(usize, &ModelBlock)> = Vec::new();
        for (input, source) in block.interface.inputs.iter().zip(&block.inputs) {
            // What is not connected is reported with all other inputs.
            let Some(source) = source else { return };
            let outlet = found.outlets.iter().find(|(_, _, place)| *place == source.block);
            let level = outlet.map(|(level, ..)| *level).or_else(|| levels.get(source.block).copied());
            let own = level
                .and_then(|level| self.conditional(level).filter(|outer| !around.contains(outer)).last());
            let subsystem = own.and_then(|own| Some((own, self.subsystem(own)?)));
            let pauses = |own: usize| self.condition(own).is_some_and(Condition::pauses);
            match subsystem {
                Some((own, subsystem)) if asked.iter().any(|(known, _)| *known == own) => {
                    let message = format!(
                        "`{}` merges two outputs of `{}`, which have a value at the same times",
                        block.path, subsystem.path
                    );
                    let problem = Problem::error("conditional", message).at(&source.place, "one of both");
                    problems.push(problem.help(
                        "merge outputs of different subsystems; choose among those of one inside of it",
                    ));
                    return;
                }
                Some((own, subsystem)) if pauses(own) => asked.push((own, subsystem)),
                found => {
                    let why = match found {
                        Some(_) => "from a subsystem that runs all the time",
                        None => "from a block that runs all the time",
                    };
                    let message = format!(
                        "`{}.{}` does not come from a subsystem with `enable` or `trigger`",
                        block.path, input.name
                    );
                    problems.push(Problem::error("conditional", message).at(&source.place, why).help(
                        "enable the subsystem by an output of an IfElse or SwitchCase; a Switch or MultiportSwitch passes one of several signals",
                    ));
                    return;
                }
            }
        }
        let paths = asked.iter().map(|(_, subsystem)| subsystem.path.clone()).collect();
        let sources: Vec<_> =
            asked.iter().map(|(own, subsystem)| Some(self.asks(gates[own], subsystem))).collect();
        let merger = Merger::new(Arc::clone(&block.block), merging, paths);
        match merger.interface(&Given::sharing(Vec::new(), block.units.clone())) {
            Ok(interface) => block.interface = Arc::new(interface),
            Err(_) => Arc::make_mut(&mut block.interface).inputs.extend(sources.iter().map(|_| gate_input())),
        }
        block.inputs.extend(sources);
        block.block = Arc::new(merger);
    }

    /// Puts the conditions around a level around one of its blocks.
    fn wrap(
        &self,
        block: &mut FlatBlock,
        level: usize,
        gates: &HashMap<usize, usize>,
        has_states: bool,
        problems: &mut Problems,
    ) {
        let Some(innermost) = self.conditional(level).next() else { return };
        let around: Vec<&Condition> =
            self.conditional(level).filter_map(|level| self.condition(level)).collect();
        let interface = &block.interface;
        // Constants are the same whether anybody asks, and what only looks shows what is held.
        if interface.sample_time == Some(SampleTime::Constant)
            || interface.recorded.is_some() && interface.outputs.is_empty()
        {
            return;
        }
        let Some(subsystem) = self.subsystem(innermost) else { return };
        if block.block.component().is_some() || !interface.ports.is_empty() {
            let mut problem = Problem::error(
                "conditional",
                format!("`{}` belongs to a physical network, which goes on all the time", block.path),
            );
            if let Some(place) = &block.place {
                problem = problem.at(place, format!("{} inside a conditional subsystem", a(&block.kind)));
            }
            problems.push(problem.at(&subsystem.place, "runs at times alone").help(
                "place the network outside and let the subsystem drive its sources; switches, valves and clutches open a network at times",
            ));
            return;
        }
        let inner = Arc::clone(&block.block);
        let wrapped = Conditional::new(
            inner,
            interface,
            around.iter().any(|condition| condition.trigger.is_some()),
            has_states && around.iter().any(|condition| condition.resets()),
            around.iter().any(|condition| condition.pauses()),
        );
        // An interface that is refused is reported when types are inferred.
        match wrapped.interface(&Given::sharing(Vec::new(), block.units.clone())) {
            Ok(interface) => block.interface = Arc::new(interface),
            Err(_) => Arc::make_mut(&mut block.interface).inputs.push(gate_input()),
        }
        block.block = Arc::new(wrapped);
        block.inputs.push(Some(self.asks(gates[&innermost], subsystem)));
    }

    /// The subsystem of a level.
    fn subsystem(&self, level: usize) -> Option<&'m ModelBlock> {
        let (outer, name) = self.levels[level].parent.as_ref()?;
        self.levels[*outer].blocks.get(name.as_str()).copied()
    }

    /// The connection to a gate.
    fn asks(&self, gate: usize, subsystem: &ModelBlock) -> Source {
        Source { block: gate, output: 0, target: subsystem.place.clone(), place: subsystem.place.clone() }
    }

    fn gate(
        &self,
        level: usize,
        gates: &HashMap<usize, usize>,
        problems: &mut Problems,
    ) -> Option<FlatBlock> {
        let condition = self.condition(level)?.clone();
        let subsystem = self.subsystem(level)?;
        let (parent, name) = self.levels[level].parent.as_ref()?;
        let mut inputs: Vec<Option<Source>> =
            condition.inputs().map(|input| self.input(*parent, name, input, problems)).collect();
        let outer = self.conditional(*parent).next();
        inputs.extend(outer.map(|outer| Some(self.asks(gates[&outer], subsystem))));
        let gate = Gate { condition, nested: outer.is_some() };
        Some(self.own(subsystem, subsystem.path.clone(), CONDITION, Arc::new(gate), inputs))
    }

    fn outlet(&self, level: usize, number: usize, gate: usize, problems: &mut Problems) -> Option<FlatBlock> {
        let subsystem = self.subsystem(level)?;
        let ast = &self.levels[level].model.ast;
        let (name, inside) = ast.outputs.get(number)?;
        let place = ast.place(&inside.span);
        let mut asked = Asked::new(place.clone(), &inside.port);
        let source = match self.tree(level, &inside.block, &inside.port, &inside.elements, &mut asked) {
            Ok(Tree::Leaf { block, output }) => {
                Some(Source { block, output, target: place.clone(), place: place.clone() })
            }
            Ok(_) => None,
            Err(problem) => {
                problems.push(problem);
                None
            }
        };
        let set = self.condition(level)?.when_disabled.iter().find(|set| set.name == name.text);
        let outlet = Outlet { value: set.map(|set| set.value) };
        let mut block = self.own(
            subsystem,
            format!("{}({})", subsystem.path, name.text),
            &name.text,
            Arc::new(outlet),
            vec![source, Some(self.asks(gate, subsystem))],
        );
        if let Some(set) = set {
            block.place = Some(set.place.clone());
        }
        Some(block)
    }

    /// A block that a subsystem has of its own.
    fn own(
        &self,
        subsystem: &ModelBlock,
        path: String,
        output: &str,
        block: Arc<dyn Block>,
        inputs: Vec<Option<Source>>,
    ) -> FlatBlock {
        FlatBlock {
            output_names: vec![format!("{}.{output}", subsystem.path)],
            path,
            kind: subsystem.kind.clone(),
            title: Vec::new(),
            place: Some(subsystem.place.clone()),
            parts: Vec::new(),
            units: Arc::default(),
            plain: false,
            interface: Arc::new(block.interface(&Given::nothing()).unwrap_or_default()),
            block,
            inputs,
        }
    }
}

/// An element of a bus that comes from outside.
fn passing(elements: &[(String, Tree)], passes: &impl Fn(usize) -> bool) -> Option<String> {
    elements.iter().find_map(|(name, tree)| match tree {
        Tree::Leaf { block, .. } => passes(*block).then(|| name.clone()),
        Tree::Bus(inner) => passing(inner, passes).map(|inner| format!("{name}.{inner}")),
        Tree::Unknown => None,
    })
}
