//! What the values of a law depend on, and what follows for the interface of its block.

use blocksim_law::{Id, Op, Program};

use super::{BlockLaw, Form};
use crate::Interface;

/// What values of a law depend on at the same instant.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Reads {
    /// Cells of the inputs, rising.
    pub inputs: Vec<u32>,
    /// Discrete states, rising.
    pub discrete: Vec<u32>,
    /// Whether they depend on continuous states.
    pub states: bool,
    /// Whether they change with time alone.
    pub time: bool,
}

impl Reads {
    /// Whether they change between major steps even if no input does.
    pub fn flow(&self) -> bool {
        self.time || self.states
    }
}

/// Output groups as they follow from a law. Those that only choose modes have no outputs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Groups {
    /// Of each output port.
    pub of: Vec<usize>,
    /// The input ports that each reads; all if `None`.
    pub reads: Vec<Option<Vec<usize>>>,
    /// Which of the settled states each chooses, by their number among these.
    pub chosen: Vec<Vec<usize>>,
    /// Groups that choose modes, and others that depend on these.
    pub before: Vec<(usize, usize)>,
    /// Where the ports end among the cells of the outputs.
    pub ends: Vec<u32>,
}

/// What values of a program depend on, with the requirements that they stand under.
pub(super) fn reads(program: &Program, wanted: &[Id]) -> Reads {
    if wanted.is_empty() {
        return Reads::default();
    }
    let mut open = wanted.to_vec();
    open.extend(requirements_of(program, wanted));
    Walk::new(program).reads(open)
}

/// The requirements that what values of a program need stands under.
pub(super) fn requirements_of(program: &Program, wanted: &[Id]) -> Vec<Id> {
    if program.requirements.is_empty() {
        return Vec::new();
    }
    let mut needed = vec![false; program.instructions.len()];
    wanted.iter().for_each(|id| needed[id.0 as usize] = true);
    for at in (0..needed.len()).rev() {
        if needed[at] {
            let operands = program.instructions[at].op.operands();
            operands.for_each(|id| needed[id.0 as usize] = true);
        }
    }
    // One counts where the number that it is about is needed for something that may go wrong by it.
    let about = |id: &Id| match program.op(*id) {
        Op::Require(_, _, about) => needed[about.0 as usize],
        _ => false,
    };
    program.requirements.iter().copied().filter(about).collect()
}

/// Walks from values to what they depend on, many times in one program.
struct Walk<'l> {
    program: &'l Program,
    /// The walk that has come to each value last.
    seen: Vec<u32>,
    walk: u32,
}

impl<'l> Walk<'l> {
    fn new(program: &'l Program) -> Self {
        Self { program, seen: vec![0; program.instructions.len()], walk: 0 }
    }

    fn reads(&mut self, mut open: Vec<Id>) -> Reads {
        self.walk += 1;
        let mut reads = Reads::default();
        while let Some(id) = open.pop() {
            if std::mem::replace(&mut self.seen[id.0 as usize], self.walk) == self.walk {
                continue;
            }
            match self.program.op(id) {
                Op::Input(cell) => reads.inputs.push(cell),
                Op::Memory(i) => reads.discrete.push(i),
                Op::State(_) => reads.states = true,
                // Unknowns are written where the law is evaluated: no group reads them from outside.
                Op::Parameter(_) => (),
                Op::Time => reads.time = true,
                op => open.extend(op.operands()),
            }
        }
        reads.inputs.sort_unstable();
        reads.discrete.sort_unstable();
        reads
    }
}

/// Settled states that are chosen at once, and the input ports that they are chosen by.
struct Choice {
    members: Vec<usize>,
    ports: Vec<usize>,
}

impl BlockLaw {
    /// What these values depend on, with the requirements that they stand under.
    pub fn reads(&self, wanted: &[Id]) -> Reads {
        reads(&self.program, wanted)
    }

    /// What the outputs of a group depend on, port by port.
    pub fn of_group(&self, group: usize) -> impl Iterator<Item = &Reads> {
        let of_port = self.groups.of.iter().enumerate().filter(move |(_, of)| **of == group);
        let ports = of_port.map(|(port, _)| port).filter(|_| self.values.is_none());
        let cells = self.values.iter().flat_map(move |groups| &groups[group].cells);
        let of_cells = cells.map(|cell| self.groups.ends.partition_point(|end| end <= cell));
        ports.chain(of_cells).map(|port| &self.of_outputs[port])
    }

    /// The interface of the block with what follows from the law in the place of what is declared: output groups and which inputs
    /// they read, where modes are chosen, and whether anything changes with time alone.
    #[must_use]
    pub fn complete(&self, mut interface: Interface) -> Interface {
        self.complete_in(&mut interface);
        interface
    }

    /// The same where the interface lies.
    pub fn complete_in(&self, interface: &mut Interface) {
        if interface.constraint.is_none() {
            interface.group_of.clone_from(&self.groups.of);
            interface.groups.clone_from(&self.groups.reads);
        }
        interface.uses_time |= self.of_rates.time || self.of_guards.time;
        interface.uses_time |= self.of_outputs.iter().any(|reads| reads.time);
        if !self.settled.is_empty() {
            interface.settles = true;
            let chosen = self.groups.chosen.iter().enumerate();
            interface.settling = Some(chosen.filter(|(_, all)| !all.is_empty()).map(|(k, _)| k).collect());
            interface.before.clone_from(&self.groups.before);
        }
    }
}

impl Form {
    /// Output groups by ports: outputs that depend on the same inputs at the same instant are one. Modes are chosen with a group that
    /// knows the inputs that choose them, and outputs that depend on modes depend on these inputs, too.
    pub(super) fn output_groups(
        &self,
        program: &Program,
        interface: &Interface,
        inputs: &[(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Groups {
        let ports = |reads: &Reads| {
            let mut ports: Vec<usize> =
                reads.inputs.iter().map(|cell| inputs.partition_point(|(_, end)| end <= cell)).collect();
            ports.dedup();
            ports
        };
        let choices = self.choices(program, ports);
        let mut choice_of = vec![None; interface.discrete.len()];
        for (number, choice) in choices.iter().enumerate() {
            choice.members.iter().for_each(|&member| choice_of[self.settled[member].0] = Some(number));
        }
        let choices_of = |reads: &Reads| {
            let mut found: Vec<usize> =
                reads.discrete.iter().filter_map(|i| choice_of[*i as usize]).collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        // A function of the block chooses from all that there is.
        let chooses_all = interface.settles && self.settled.is_empty();
        let mut known: Vec<(bool, Vec<usize>)> = Vec::new();
        let mut of = Vec::with_capacity(outputs.len());
        let mut needs: Vec<Vec<usize>> = Vec::new();
        for reads in &self.of_outputs {
            let choices_of = choices_of(reads);
            let mut all = if chooses_all { (0..inputs.len()).collect() } else { ports(reads) };
            all.extend(choices_of.iter().flat_map(|choice| &choices[*choice].ports));
            all.sort_unstable();
            all.dedup();
            // Who has no inputs shows states, or depends on everything that there is.
            let group = (inputs.is_empty() && !reads.states, all);
            let group = known.iter().position(|other| *other == group).unwrap_or_else(|| {
                known.push(group);
                needs.push(Vec::new());
                known.len() - 1
            });
            needs[group].extend(choices_of);
            of.push(group);
        }
        let mut groups =
            Groups { of, ends: outputs.iter().map(|span| span.1).collect(), ..Groups::default() };
        // Blocks without outputs choose behind all others.
        let mut chosen: Vec<Vec<usize>> = vec![Vec::new(); known.len()];
        for (number, Choice { members, ports }) in choices.iter().enumerate().filter(|_| !outputs.is_empty())
        {
            let needing: Vec<usize> = (0..needs.len()).filter(|k| needs[*k].contains(&number)).collect();
            let knows = |k: &usize| ports.iter().all(|port| known[*k].1.contains(port));
            let within = |k: &usize| {
                needing.iter().all(|other| known[*k].1.iter().all(|port| known[*other].1.contains(port)))
            };
            let found = match needing[..] {
                [] => (0..known.len()).find(knows),
                _ => needing.iter().copied().find(within),
            };
            let group = found.unwrap_or_else(|| {
                known.push((false, ports.clone()));
                chosen.push(Vec::new());
                known.len() - 1
            });
            chosen[group].extend(members);
            groups
                .before
                .extend(needing.iter().filter(|other| **other != group).map(|other| (group, *other)));
        }
        let all = |reads: &[usize]| !reads.is_empty() && reads.len() == inputs.len();
        let reads =
            known.into_iter().map(|(open, reads)| if open || all(&reads) { None } else { Some(reads) });
        groups.reads = reads.collect();
        groups.chosen = chosen;
        groups
    }

    /// Settled states by what they are chosen by. Those that are chosen by each other are chosen at once, from what all were.
    fn choices(&self, program: &Program, ports: impl Fn(&Reads) -> Vec<usize>) -> Vec<Choice> {
        let ids: Vec<Id> = self.settled.iter().map(|(_, id)| *id).collect();
        let requirements = requirements_of(program, &ids);
        if !requirements.is_empty() {
            let reads = Walk::new(program).reads(ids.iter().copied().chain(requirements).collect());
            return vec![Choice { members: (0..ids.len()).collect(), ports: ports(&reads) }];
        }
        let mut walk = Walk::new(program);
        let reads: Vec<Reads> = ids.iter().map(|id| walk.reads(vec![*id])).collect();
        let mut choice_of: Vec<usize> = (0..ids.len()).collect();
        for (k, of) in reads.iter().enumerate() {
            for other in &of.discrete {
                let Some(other) = self.settled.iter().position(|(i, _)| *i == *other as usize) else {
                    continue;
                };
                let (from, to) = (choice_of[k].max(choice_of[other]), choice_of[k].min(choice_of[other]));
                if from != to {
                    choice_of.iter_mut().filter(|choice| **choice == from).for_each(|choice| *choice = to);
                }
            }
        }
        let mut choices: Vec<Choice> = Vec::new();
        let mut place: Vec<Option<usize>> = vec![None; ids.len()];
        for (k, of) in reads.iter().enumerate() {
            let at = *place[choice_of[k]].get_or_insert_with(|| {
                choices.push(Choice { members: Vec::new(), ports: Vec::new() });
                choices.len() - 1
            });
            choices[at].members.push(k);
            choices[at].ports.extend(ports(of));
        }
        // What is chosen by the same is chosen at once.
        let mut joined: Vec<Choice> = Vec::new();
        for mut choice in choices {
            choice.ports.sort_unstable();
            choice.ports.dedup();
            match joined.iter_mut().find(|other| other.ports == choice.ports) {
                Some(other) => other.members.extend(choice.members),
                None => joined.push(choice),
            }
        }
        joined
    }
}
