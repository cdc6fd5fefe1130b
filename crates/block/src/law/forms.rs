//! Laws of many blocks, of which most are those of others with other numbers: what follows from the form of a law is found once.

use std::collections::hash_map::Entry;
use std::sync::Arc;

use blocksim_law::passes::Map;
use blocksim_law::{Id, Instruction, Op, Program, Recorder};

use super::block_law::{BlockLaw, Form};
use super::recording::Recording;
use crate::{Block, Interface};

/// Most instructions of a law that is compared with others. Longer ones, those of networks, are hardly ever alike.
const LONGEST: usize = 256;

/// Forms of the laws that were recorded so far.
#[derive(Default)]
pub struct Forms {
    known: Map<Key, Known>,
    /// Room for the key of the law that is looked up.
    key: Key,
    /// The numbers of that law, each once.
    constants: Vec<u64>,
}

/// A law as it was recorded, before it is optimised, and all that its form follows from beside it.
#[derive(Default, Clone, PartialEq, Eq, Hash)]
struct Key {
    /// Where the law does the same whatever its numbers are, constants are numbered in the order in which they appear.
    ops: Vec<Op>,
    /// Everything else, list by list, each with its length.
    rest: Vec<u32>,
}

/// What became of the first law of a form.
struct Known {
    /// Its optimised program; constants are what they are in the key.
    instructions: Vec<Instruction>,
    requirements: Vec<Id>,
    outputs: Vec<(String, Id)>,
    form: Arc<Form>,
}

impl Forms {
    /// As [`BlockLaw::record`].
    ///
    /// # Errors
    /// As there.
    pub fn record(
        &mut self,
        block: &Arc<dyn Block>,
        interface: &Interface,
        inputs: &[(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Result<Option<BlockLaw>, String> {
        let recorder = Recorder::new();
        let recording = Recording::new(&recorder, interface, inputs, outputs);
        if !block.law(&recording) {
            return Ok(None);
        }
        let written = recording.finish()?;
        written.is_whole()?;
        let mut program = recorder.finish();
        // Blocks name their guards and angles themselves.
        program.kinks.clear();
        program.turns.clear();
        if !is_comparable(&program, interface) {
            let program = written.wanted_of(program).optimised();
            let form = Form::new(&program, &written, interface, inputs, outputs)?;
            return Ok(Some(BlockLaw::new(block, program, Arc::new(form))));
        }
        let is_fixed = self.key.set(&program, &mut self.constants);
        self.key.list(program.requirements.iter().map(|id| id.0));
        written
            .lists()
            .into_iter()
            .for_each(|list| self.key.list(list.iter().map(|id| id.map_or(0, |id| id.0 + 1))));
        for spans in [inputs, outputs] {
            self.key.list(spans.iter().flat_map(|(start, end)| [*start, *end]));
        }
        self.key.rest.extend([u32::from(is_fixed), u32::from(interface.settles)]);
        let constants = (!is_fixed).then_some(&self.constants[..]);
        if let Some(known) = self.known.get(&self.key) {
            known.put_into(&mut program, constants);
            return Ok(Some(BlockLaw::new(block, program, Arc::clone(&known.form))));
        }
        let program = written.wanted_of(program).optimised();
        let form = Arc::new(Form::new(&program, &written, interface, inputs, outputs)?);
        if let Entry::Vacant(place) = self.known.entry(self.key.clone()) {
            place.insert(Known::new(&program, constants, Arc::clone(&form)));
        }
        Ok(Some(BlockLaw::new(block, program, form)))
    }
}

/// Whether another law may have the form of this one: what comes from a text has places in it, which are its own.
fn is_comparable(program: &Program, interface: &Interface) -> bool {
    let instructions = &program.instructions;
    instructions.len() <= LONGEST
        && interface.constraint.is_none()
        && program.modes.is_empty()
        && instructions.iter().all(|instruction| instruction.place.is_none())
}

/// Whether the optimised program depends on the numbers in this one: operations with constants alone are computed, and choices
/// made whose condition never changes.
fn depends_on_numbers(program: &Program) -> bool {
    let is_constant = |id: Id| matches!(program.op(id), Op::Constant(_));
    program.instructions.iter().any(|instruction| match instruction.op {
        Op::And(a, b) | Op::Or(a, b) => is_constant(a) || is_constant(b),
        Op::Select(condition, a, b) => is_constant(condition) || is_constant(a) && is_constant(b),
        op => !op.is_leaf() && op.operands().all(is_constant),
    })
}

impl Key {
    /// Begins the key of a law; whether it stays with the numbers that the law has. `constants` become those that it may have in the
    /// places of others.
    fn set(&mut self, program: &Program, constants: &mut Vec<u64>) -> bool {
        self.ops.clear();
        self.rest.clear();
        constants.clear();
        let ops = program.instructions.iter().map(|instruction| instruction.op);
        if depends_on_numbers(program) {
            self.ops.extend(ops);
            return true;
        }
        // Equal numbers are one in an optimised program.
        let numbered = ops.map(|op| match op {
            Op::Constant(bits) => Op::Constant(number_of(bits, constants)),
            op => op,
        });
        self.ops.extend(numbered);
        false
    }

    fn list(&mut self, numbers: impl Iterator<Item = u32>) {
        let at = self.rest.len();
        self.rest.push(0);
        self.rest.extend(numbers);
        self.rest[at] = (self.rest.len() - at) as u32;
    }
}

/// The number of a constant among those that are known, to which it is added if it is not.
fn number_of(bits: u64, constants: &mut Vec<u64>) -> u64 {
    let at = constants.iter().position(|known| *known == bits);
    let at = at.unwrap_or_else(|| {
        constants.push(bits);
        constants.len() - 1
    });
    at as u64
}

impl Known {
    /// What became of a law with these constants, or with fixed ones.
    fn new(program: &Program, constants: Option<&[u64]>, form: Arc<Form>) -> Self {
        let mut instructions = program.instructions.clone();
        let number_of = |bits: u64| constants?.iter().position(|known| *known == bits);
        for instruction in &mut instructions {
            if let Op::Constant(bits) = &mut instruction.op {
                *bits = number_of(*bits).map_or(*bits, |number| number as u64);
            }
        }
        Self {
            instructions,
            requirements: program.requirements.clone(),
            outputs: program.outputs.clone(),
            form,
        }
    }

    /// Makes of a law that was recorded what the first one of its form became, with the constants of its own.
    fn put_into(&self, program: &mut Program, constants: Option<&[u64]>) {
        program.instructions.clear();
        program.instructions.extend(self.instructions.iter().map(|instruction| {
            let op = match (instruction.op, constants) {
                (Op::Constant(number), Some(constants)) => Op::Constant(constants[number as usize]),
                (op, _) => op,
            };
            Instruction { op, ..instruction.clone() }
        }));
        program.requirements.clone_from(&self.requirements);
        program.outputs.clone_from(&self.outputs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Input, InterfaceError, Output};

    /// `y = between 0 and a of (a - b) * u / c`, and a state that runs down.
    #[derive(Debug)]
    struct Toy([f64; 3]);

    impl Block for Toy {
        fn interface(&self, _given: &crate::Given) -> Result<Interface, InterfaceError> {
            Ok(Interface::new().input(Input::real("u")).output(Output::real("y")).state("x", self.0[0]))
        }

        fn law(&self, l: &Recording) -> bool {
            let [a, b, c] = self.0;
            let difference = if self.0.contains(&9.0) { l.constant(a) - b } else { l.u(0) - b };
            l.set(0, 0, (difference * l.u(0) / (l.u(0) + c)).clamp(l.constant(0.0), l.constant(a)));
            l.derive(0, -b * l.x()[0]);
            true
        }
    }

    #[test]
    fn a_law_of_a_known_form_is_what_it_would_be_by_itself() {
        let mut forms = Forms::default();
        let numbers = [
            [1.0, 2.0, 3.0],
            [4.0, 5.0, 6.0],
            // Equal numbers are one constant, which is another form.
            [4.0, 4.0, 6.0],
            [7.0, 7.0, 8.0],
            [0.0, 1.0, 2.0],
            [-0.0, 1.0, 2.0],
            [f64::NAN, 1.0, 2.0],
            // What is computed from constants counts as what it is.
            [9.0, 2.0, 3.0],
            [9.0, 4.0, 3.0],
            [9.0, 2.0, 3.0],
        ];
        for numbers in numbers {
            let block: Arc<dyn Block> = Arc::new(Toy(numbers));
            let interface = block.interface(&crate::Given::nothing()).expect("an interface");
            let spans = [(0, 1)];
            let record = |forms: &mut Forms| {
                forms.record(&block, &interface, &spans, &spans).expect("a law that is right").expect("a law")
            };
            let (law, alone) = (record(&mut forms), record(&mut Forms::default()));
            // Numbers that are none are compared by their bits.
            assert_eq!(
                format!("{:?}", law.program.instructions),
                format!("{:?}", alone.program.instructions)
            );
            assert_eq!(law.program.requirements, alone.program.requirements);
            assert_eq!(law.program.outputs, alone.program.outputs);
            assert_eq!(law.program.states[0].initial.to_bits(), numbers[0].to_bits());
            assert_eq!(format!("{:?}", law.of_outputs), format!("{:?}", alone.of_outputs));
            assert_eq!((&law.outputs, &law.derivatives), (&alone.outputs, &alone.derivatives));
        }
        assert_eq!(
            forms.known.len(),
            5,
            "two with three numbers, those with equal ones, zero, and two fixed"
        );
    }
}
