//! The law of a block as data, and a block that runs it.

use std::collections::HashMap;
use std::fmt::{self, Debug};
use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

use blocksim_law::{Code, Failure, Id, Op, Program, Sources};

use super::forms::Forms;
use super::reads::{Groups, Reads, reads, requirements_of};
use super::recording::Written;
use crate::physical::Component;
use crate::problem::Problem;
use crate::{Block, Bus, Context, Given, Interface, InterfaceError, Piece, Scratch};

/// A block whose law is recorded. As a block it is the one that it was made of, with functions that run the law.
pub struct BlockLaw {
    block: Arc<dyn Block>,
    /// The law. Inputs, states and memories (the discrete states) are numbered as those of the block.
    pub program: Program,
    /// What the values of the program are to the block.
    form: Arc<Form>,
    codes: OnceLock<Codes>,
}

/// What the values of a law are to its block, and what they depend on. Laws that differ in their numbers alone have it in common.
#[derive(Debug, Clone, Default)]
pub struct Form {
    /// What each cell of the outputs is.
    pub outputs: Vec<Id>,
    /// Output group of each cell.
    pub group_of: Vec<usize>,
    /// Output groups of the ports, as they follow from the law.
    pub(super) groups: Groups,
    /// What each output port depends on.
    pub of_outputs: Vec<Reads>,
    /// What the derivatives depend on.
    pub of_rates: Reads,
    /// What the guards depend on.
    pub of_guards: Reads,
    /// The groups by values, see [`by_values`](BlockLaw::by_values); nothing where they are those of the interface.
    pub values: Option<Vec<ValueGroup>>,
    /// What each derivative is.
    pub derivatives: Vec<Id>,
    /// What each guard is.
    pub guards: Vec<Id>,
    /// Discrete states that are set at major steps, and to what.
    pub settled: Vec<(usize, Id)>,
    /// Unknowns that the engine finds, by their places among all outputs, and what is to become zero. In the program they are
    /// parameters.
    pub rest: Vec<(usize, Id)>,
    /// The group that writes what is left over, where there are unknowns.
    rest_group: Option<usize>,
    /// Discrete states that change at sample hits, and what they become.
    pub updated: Vec<(usize, Id)>,
}

impl Deref for BlockLaw {
    type Target = Form;

    fn deref(&self) -> &Form {
        &self.form
    }
}

impl Form {
    /// What an optimised program is to a block with this interface, whose input and output ports lie so. The outputs of the program are
    /// all that was written, one list behind the other.
    ///
    /// # Errors
    /// The program does what no law of a block may.
    pub(super) fn new(
        program: &Program,
        written: &Written,
        interface: &Interface,
        inputs: &[(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Result<Self, String> {
        if !program.modes.is_empty() {
            return Err("the law has modes of its own".to_owned());
        }
        let mut ids = program.outputs.iter().map(|(_, id)| *id);
        let mut all = |list: &[Option<Id>]| ids.by_ref().take(list.len()).collect::<Vec<Id>>();
        let (y, dx, g) = (all(&written.outputs), all(&written.derivatives), all(&written.guards));
        let mut some = |list: &[Option<Id>]| {
            let said = list.iter().enumerate().filter(|(_, id)| id.is_some()).map(|(i, _)| i);
            said.zip(ids.by_ref()).collect::<Vec<_>>()
        };
        let (settled, updated) = (some(&written.settled), some(&written.updated));
        let rest = some(&written.rest);
        let unknowns = interface.constraint.iter().flat_map(|constraint| &constraint.unknowns);
        let mut form = Self {
            group_of: vec![0; y.len()],
            outputs: y,
            derivatives: dx,
            guards: g,
            rest: unknowns.zip(rest).map(|((place, _), (_, id))| (*place, id)).collect(),
            rest_group: interface.constraint.as_ref().map(|constraint| constraint.rest),
            settled,
            updated,
            ..Self::default()
        };
        if form.reads_unknown(program, form.derivatives.iter().chain(&form.guards)) {
            return Err("a derivative or guard depends on an unknown".to_owned());
        }
        form.of_outputs = outputs.iter().map(|span| reads(program, &form.outputs[cells(*span)])).collect();
        form.of_rates = reads(program, &form.derivatives);
        form.of_guards = reads(program, &form.guards);
        form.groups = form.output_groups(program, interface, inputs, outputs);
        for (span, group) in outputs.iter().zip(&form.groups.of) {
            form.group_of[cells(*span)].fill(*group);
        }
        Ok(form)
    }

    /// Whether any of these values depends on what the engine finds.
    fn reads_unknown<'i>(&self, program: &Program, ids: impl Iterator<Item = &'i Id>) -> bool {
        let mut open: Vec<Id> = if self.rest.is_empty() { Vec::new() } else { ids.copied().collect() };
        let mut seen = vec![false; program.instructions.len()];
        while let Some(id) = open.pop() {
            match program.op(id) {
                Op::Parameter(_) => return true,
                op if !std::mem::replace(&mut seen[id.0 as usize], true) => open.extend(op.operands()),
                _ => (),
            }
        }
        false
    }
}

/// Output cells of a block that depend on the same input cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ValueGroup {
    /// Output cells, rising.
    pub cells: Vec<u32>,
    /// Input cells that they read, rising.
    pub reads: Vec<u32>,
}

/// Most dependences of outputs on inputs of a block that is looked at by its values.
const MOST_DEPENDENCES: usize = 20_000;

/// What is computed at each occasion, one block at a time.
#[derive(Debug)]
struct Codes {
    groups: Vec<(Vec<usize>, Code)>,
    derivatives: Code,
    guards: Code,
    settled: Code,
    /// What is settled with each group: the numbers of the states, and their values.
    chosen: Vec<(Vec<usize>, Code)>,
    updated: Code,
    registers: usize,
}

/// Registers for which settling has room on the stack.
const FEW: usize = 128;

impl BlockLaw {
    /// The law of a block with this interface, whose input and output ports lie so; `None` if the block records none. Who records
    /// many has [`Forms`].
    ///
    /// # Errors
    /// What is wrong with the law: an output, derivative or guard that is not said or said twice.
    pub fn record(
        block: &Arc<dyn Block>,
        interface: &Interface,
        inputs: &[(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Result<Option<Self>, String> {
        Forms::default().record(block, interface, inputs, outputs)
    }

    pub(super) fn new(block: &Arc<dyn Block>, program: Program, form: Arc<Form>) -> Self {
        Self { block: Arc::clone(block), program, form, codes: OnceLock::new() }
    }

    /// The same law with output groups that follow from it: outputs that read the same cells of the inputs are one, whatever
    /// ports these cells are of. Nothing if the groups of the interface are as fine already, or if the block chooses modes, which
    /// takes all inputs at once.
    pub fn by_values(&self, interface: &Interface, inputs: &[(u32, u32)]) -> Option<Self> {
        if interface.settles || interface.constraint.is_some() {
            return None;
        }
        let mut groups: Vec<ValueGroup> = Vec::new();
        let mut known: HashMap<Vec<u32>, usize> = HashMap::new();
        let mut group_of = Vec::with_capacity(self.outputs.len());
        let mut dependences = 0;
        for (cell, id) in self.outputs.iter().enumerate() {
            let reads = self.reads(&[*id]).inputs;
            dependences += reads.len();
            if dependences > MOST_DEPENDENCES {
                return None;
            }
            let group = *known.entry(reads.clone()).or_insert(groups.len());
            if group == groups.len() {
                groups.push(ValueGroup { cells: Vec::new(), reads });
            }
            groups[group].cells.push(cell as u32);
            group_of.push(group);
        }
        let is_as_fine = |group: &ValueGroup| {
            let of = self.group_of[group.cells[0] as usize];
            let read = inputs.iter().enumerate().filter(|(port, _)| interface.reads(of, *port));
            group.reads.len() == read.map(|(_, (start, end))| (end - start) as usize).sum::<usize>()
        };
        if groups.iter().all(is_as_fine) {
            return None;
        }
        let form = Form {
            group_of,
            values: Some(groups),
            rest: Vec::new(),
            rest_group: None,
            settled: Vec::new(),
            ..Form::clone(&self.form)
        };
        Some(Self::new(&self.block, self.program.clone(), Arc::new(form)))
    }

    /// The settled states that are chosen with a group, by their number among [`settled`](Form::settled).
    pub fn chosen_in(&self, group: usize) -> &[usize] {
        self.groups.chosen.get(group).map_or(&[], Vec::as_slice)
    }

    /// The output cells of a group.
    pub fn cells_of(&self, group: usize) -> Vec<usize> {
        match &self.values {
            Some(groups) => {
                groups.get(group).map(|group| group.cells.iter().map(|cell| *cell as usize).collect())
            }
            None => Some((0..self.outputs.len()).filter(|cell| self.group_of[*cell] == group).collect()),
        }
        .unwrap_or_default()
    }

    /// The output cells that a group writes, and what they are: of what is left over of constraints, in the places of the unknowns.
    pub fn written(&self, group: usize) -> Vec<(usize, Id)> {
        if self.rest_group == Some(group) {
            return self.rest.clone();
        }
        let is_found = |cell: &usize| self.rest.iter().any(|(place, _)| place == cell);
        let cells = self.cells_of(group).into_iter().filter(|cell| !is_found(cell));
        cells.map(|cell| (cell, self.outputs[cell])).collect()
    }

    fn codes(&self) -> &Codes {
        self.codes.get_or_init(|| {
            let code = |ids: Vec<Id>| {
                let mut wanted = ids;
                wanted.extend(self.requirements_of(&wanted));
                Code::new(&self.program, &wanted)
            };
            let seconds = |list: &[(usize, Id)]| list.iter().map(|(_, id)| *id).collect::<Vec<Id>>();
            let count = self.group_of.iter().chain(&self.rest_group).max().map_or(0, |group| group + 1);
            let groups = (0..count).map(|group| {
                let (cells, ids) = self.written(group).into_iter().unzip();
                (cells, code(ids))
            });
            let mut codes = Codes {
                groups: groups.collect(),
                derivatives: code(self.derivatives.clone()),
                guards: code(self.guards.clone()),
                settled: code(seconds(&self.settled)),
                chosen: self
                    .groups
                    .chosen
                    .iter()
                    .map(|members| {
                        let states = members.iter().map(|member| self.settled[*member].0).collect();
                        (states, code(members.iter().map(|member| self.settled[*member].1).collect()))
                    })
                    .collect(),
                updated: code(seconds(&self.updated)),
                registers: 0,
            };
            let single = [&codes.derivatives, &codes.guards, &codes.settled, &codes.updated];
            let several = codes.groups.iter().chain(&codes.chosen).map(|(_, code)| code);
            let all = several.chain(single);
            codes.registers = all.map(Code::registers).max().unwrap_or(0);
            codes
        })
    }

    /// The requirements that what these values need stands under.
    pub fn requirements_of(&self, wanted: &[Id]) -> Vec<Id> {
        requirements_of(&self.program, wanted)
    }

    /// Why the law cannot go on.
    pub fn reason(failure: &Failure) -> String {
        let Failure { domain, value, .. } = failure;
        match domain {
            blocksim_law::Domain::NotZero => "a division by zero".to_owned(),
            domain => format!("a number is {value:e}, but must be {}", domain.wanted()),
        }
    }

    /// Runs a code; `y` are all outputs, among which unknowns stand where the code may need them.
    fn run<'w>(&self, code: &Code, c: &Context, y: &[f64], w: &'w mut Scratch) -> &'w [f64] {
        if w.get::<Vec<f64>>().is_none() {
            *w = self.scratch();
        }
        let room = w.get::<Vec<f64>>().map(Vec::as_mut_slice).unwrap_or_default();
        let (registers, unknowns) = room.split_at_mut(self.codes().registers);
        if !y.is_empty() {
            unknowns.iter_mut().zip(&self.rest).for_each(|(z, (place, _))| *z = y[*place]);
        }
        self.run_in(code, c, c.d, unknowns, registers);
        registers
    }

    /// Sets discrete states to what a code computes.
    fn choose(&self, code: &Code, states: impl Iterator<Item = usize>, c: &Context, d: &mut [f64]) {
        let registers = self.codes().registers;
        let mut few = [0.0; FEW];
        let mut many = Vec::new();
        let registers = if registers <= FEW {
            &mut few[..]
        } else {
            many.resize(registers, 0.0);
            &mut many[..]
        };
        self.run_in(code, c, d, &[], registers);
        states.enumerate().for_each(|(k, i)| d[i] = code.result(registers, k));
    }

    fn run_in(&self, code: &Code, c: &Context, d: &[f64], unknowns: &[f64], registers: &mut [f64]) {
        let sources = Sources {
            time: c.t,
            inputs: c.u,
            states: c.x,
            memories: d,
            parameters: unknowns,
            ..Sources::default()
        };
        if let Some(failure) = code.run(&sources, registers) {
            c.fail(self.block.no_value(&failure, c).unwrap_or_else(|| Self::reason(&failure)));
        }
    }
}

fn cells((start, end): (u32, u32)) -> Range<usize> {
    start as usize..end as usize
}

impl Debug for BlockLaw {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("BlockLaw").field("block", &self.block).finish_non_exhaustive()
    }
}

impl Block for BlockLaw {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.complete(self.block.interface(given)?))
    }

    /// Room to run the law. Without it the first run takes the memory.
    fn scratch(&self) -> Scratch {
        Scratch::new(vec![0.0_f64; self.codes().registers + self.rest.len()])
    }

    fn initialize(&self, c: &Context, x: &mut [f64], d: &mut [f64]) {
        self.block.initialize(c, x, d);
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        if self.settled.is_empty() {
            return self.block.settle(c, d);
        }
        self.choose(&self.codes().settled, self.settled.iter().map(|(i, _)| *i), c, d);
    }

    fn settle_in(&self, group: usize, c: &Context, d: &mut [f64]) {
        match self.codes().chosen.get(group) {
            Some((states, code)) if !self.settled.is_empty() => {
                self.choose(code, states.iter().copied(), c, d)
            }
            Some(_) => self.block.settle(c, d),
            None => self.settle(c, d),
        }
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        // A group without outputs has no code.
        let Some((cells, code)) = self.codes().groups.get(group) else { return };
        let registers = self.run(code, c, y, w);
        cells.iter().enumerate().for_each(|(k, cell)| y[*cell] = code.result(registers, k));
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        let code = &self.codes().derivatives;
        let registers = self.run(code, c, &[], w);
        dx.iter_mut().enumerate().for_each(|(k, dx)| *dx = code.result(registers, k));
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let code = &self.codes().guards;
        let registers = self.run(code, c, &[], w);
        g.iter_mut().enumerate().for_each(|(k, g)| *g = code.result(registers, k));
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        if self.updated.is_empty() {
            return self.block.update(c, w, d);
        }
        let code = &self.codes().updated;
        let here = Context { d, ..*c };
        let registers = self.run(code, &here, &[], w);
        self.updated.iter().enumerate().for_each(|(k, (i, _))| d[*i] = code.result(registers, k));
    }

    fn jump(&self, c: &Context, w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        self.block.jump(c, w, x, d)
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.block.next_event(c)
    }

    fn next_update(&self, c: &Context) -> f64 {
        self.block.next_update(c)
    }

    fn tolerate(&self, rtol: f64, d: &mut [f64]) {
        self.block.tolerate(rtol, d);
    }

    fn warnings(&self, d: &[f64], rtol: f64) -> Vec<Problem> {
        self.block.warnings(d, rtol)
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        self.block.accept(c, d)
    }

    fn remember(&self, c: &Context, piece: &Piece, d: &mut [f64]) {
        self.block.remember(c, piece, d);
    }

    fn reach(&self, c: &Context, d: &mut [f64]) {
        self.block.reach(c, d);
    }

    fn next_kink(&self, c: &Context) -> f64 {
        self.block.next_kink(c)
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        self.block.rest(c, d)
    }

    fn end_time(&self) -> Option<f64> {
        self.block.end_time()
    }

    fn component(&self) -> Option<&dyn Component> {
        self.block.component()
    }

    fn bus(&self) -> Option<Bus> {
        self.block.bus()
    }
}
