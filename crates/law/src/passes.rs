//! Functions from program to program. None of them changes a bit of any result.

use crate::{Id, Instruction, Op, Program};
use std::collections::{HashMap, HashSet};

/// A map of what is made by compilers, which needs no protection against numbers chosen to collide.
pub type Map<K, V> = HashMap<K, V, foldhash::fast::FixedState>;
pub(crate) type Set<K> = HashSet<K, foldhash::fast::FixedState>;

/// Most instructions of a short program.
const SHORT: usize = 16;

/// Makes a program anew: `place` takes all but the instructions and each of these, with its operands renamed already, and says which
/// value stands for it; the names so far are beside them.
fn rewritten(
    mut program: Program,
    mut place: impl FnMut(&Program, &[Id], Instruction, &mut Vec<Instruction>) -> Id,
) -> Program {
    let old = std::mem::take(&mut program.instructions);
    let mut instructions = Vec::with_capacity(old.len());
    let mut names: Vec<Id> = Vec::with_capacity(old.len());
    for instruction in old {
        let op = instruction.op.map(|id| names[id.at()]);
        let id = place(&program, &names, Instruction { op, ..instruction }, &mut instructions);
        names.push(id);
    }
    program.instructions = instructions;
    program.each_root(|id| *id = names[id.at()]);
    program
}

fn push(instruction: Instruction, instructions: &mut Vec<Instruction>) -> Id {
    instructions.push(instruction);
    Id(instructions.len() as u32 - 1)
}

/// Puts the values of the parameters in their places.
#[must_use]
pub fn bind_parameters(program: Program) -> Program {
    rewritten(program, |program, _, mut instruction, instructions| {
        if let Op::Parameter(index) = instruction.op {
            instruction.op = Op::constant(program.parameters[index as usize].1);
        }
        push(instruction, instructions)
    })
}

/// Computes what needs constants alone, with the very functions of the interpreter. Choices whose condition is constant are made,
/// requirements that always hold are dropped.
#[must_use]
pub fn fold_constants(program: Program) -> Program {
    let mut folded =
        rewritten(program, |program, names, instruction, new| folded(instruction, program, names, new));
    let Program { requirements, kinks, turns, .. } = &mut folded;
    let (mut required, mut kinked, mut turned) =
        (std::mem::take(requirements), std::mem::take(kinks), std::mem::take(turns));
    let holds = |id: &Id| match folded.op(*id) {
        Op::Require(_, holds, _) => folded.op(holds).as_constant().is_some_and(|value| value != 0.0),
        _ => false,
    };
    let changes = |id: &Id| folded.op(*id).as_constant().is_none();
    required.retain(|id| !holds(id));
    kinked.retain(|kink| changes(&kink.value));
    turned.retain(changes);
    Program { requirements: required, kinks: kinked, turns: turned, ..folded }
}

/// What stands for an instruction whose operands are folded; `names` are the new values of those before it.
fn folded(
    mut instruction: Instruction,
    program: &Program,
    names: &[Id],
    instructions: &mut Vec<Instruction>,
) -> Id {
    let constant = |id: Id| instructions[id.at()].op.as_constant();
    if let Op::Select(condition, a, b) = instruction.op
        && let Some(condition) = constant(condition)
    {
        return if condition != 0.0 { a } else { b };
    }
    if let Op::Mode(index) = instruction.op {
        let value = names[program.modes[index as usize].value.at()];
        if constant(value).is_some() {
            return value;
        }
    }
    let shortened = match instruction.op {
        Op::And(a, b) | Op::Or(a, b) => {
            let and = matches!(instruction.op, Op::And(..));
            match (constant(a), constant(b)) {
                // What decides alone, or leaves the other one to decide; that one is 0 or 1 already.
                (Some(value), _) => Some(if (value != 0.0) == and { b } else { a }),
                (_, Some(value)) => Some(if (value != 0.0) == and { a } else { b }),
                _ => None,
            }
        }
        _ => None,
    };
    if let Some(id) = shortened {
        return id;
    }
    let known = instruction.op.operands().all(|id| constant(id).is_some());
    let value = if known { instruction.op.value(|id| constant(id).unwrap_or(f64::NAN)) } else { None };
    if let Some(value) = value {
        instruction.op = Op::constant(value);
    }
    push(instruction, instructions)
}

/// Computes equal expressions once; the place is that of the first. Modes that choose the same become one.
#[must_use]
pub fn share_equal(program: Program) -> Program {
    let mut known: Map<Op, Id> = Map::default();
    let mut held: Map<Id, Id> = Map::default();
    // Most laws of blocks are so short that to look through them is quicker than a map.
    let is_short = program.instructions.len() <= SHORT;
    let mut shared = rewritten(program, |program, names, instruction, instructions| {
        let op = instruction.op;
        let add = || {
            if !is_short {
                return *known.entry(op).or_insert_with(|| push(instruction, instructions));
            }
            let at = instructions.iter().position(|known| known.op == op);
            at.map_or_else(|| push(instruction, instructions), |at| Id(at as u32))
        };
        match op {
            Op::Mode(index) => {
                *held.entry(names[program.modes[index as usize].value.at()]).or_insert_with(add)
            }
            _ => add(),
        }
    });
    let mut seen = Set::default();
    shared.requirements.retain(|id| seen.insert(*id));
    seen.clear();
    shared.kinks.retain(|kink| seen.insert(kink.value));
    seen.clear();
    shared.turns.retain(|id| seen.insert(*id));
    shared
}

/// Drops what neither an output nor a derivative, memory, mode, guard or requirement needs, and modes that nothing reads; those that are
/// left are numbered anew.
#[must_use]
pub fn drop_unused(mut program: Program) -> Program {
    // A mode counts if something reads it that counts itself; kinks, turns and requirements always do.
    let n = program.instructions.len();
    let mut used = vec![false; n];
    let mut modes = vec![false; program.modes.len()];
    let mut open: Vec<Id> = program.output_values();
    open.extend(program.states.iter().filter_map(|state| state.derivative));
    open.extend(program.memories.iter().filter_map(|memory| memory.next));
    open.extend(program.kinks.iter().map(|kink| kink.value));
    open.extend(program.turns.iter().chain(&program.requirements));
    while let Some(id) = open.pop() {
        if std::mem::replace(&mut used[id.at()], true) {
            continue;
        }
        let op = program.op(id);
        open.extend(op.operands());
        if let Op::Mode(index) = op
            && !std::mem::replace(&mut modes[index as usize], true)
        {
            let mode = &program.modes[index as usize];
            open.push(mode.value);
            open.extend(mode.guards.iter().map(|guard| guard.value));
        }
    }
    let numbers: Vec<u32> = modes
        .iter()
        .scan(0, |next, used| {
            let number = *next;
            *next += u32::from(*used);
            Some(number)
        })
        .collect();
    let mut which = modes.iter();
    program.modes.retain(|_| which.next() == Some(&true));
    rewritten(program, |_, names, mut instruction, instructions| {
        if !used[names.len()] {
            return Id(u32::MAX);
        }
        if let Op::Mode(index) = &mut instruction.op {
            *index = numbers[*index as usize];
        }
        push(instruction, instructions)
    })
}

/// Reads values as they are at the moment in the place of those that modes hold: what the modes of a major step are chosen by.
#[must_use]
pub fn release_modes(program: Program) -> Program {
    rewritten(program, |program, names, instruction, instructions| match instruction.op {
        Op::Mode(index) => names[program.modes[index as usize].value.at()],
        _ => push(instruction, instructions),
    })
}
