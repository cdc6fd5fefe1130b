//! What a block looks like from outside: ports, states, dependencies. Pure data.

use std::borrow::Cow;
use std::sync::Arc;

use blocksim_signal::{Dimension, SampleTime};

use crate::event::{Change, Changes, Event, JUMP, Subject};
use crate::physical::PhysicalPort;
use crate::ports::{Input, Output};

/// One continuous state.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Name below the block, for messages: `x`, `psi_ds` ...
    pub name: String,
    /// Value at the start.
    pub initial: f64,
    /// Dimension, where it is known.
    pub dimension: Option<Dimension>,
    /// Its nominal value, where the block knows one: a flux in per unit is about one. An automatic absolute tolerance follows it
    /// where the state itself has been smaller, as far as the state keeps its digits.
    pub nominal: Option<f64>,
    /// A magnitude of it that counts as nothing, where the block knows one; 0 where it does not.
    pub negligible: f64,
    /// The least value that its law knows, where there is one: temperatures end at absolute zero.
    pub floor: Option<Floor>,
    /// How often what the state stands for fits into it, where that follows from parameters: a run that goes on with other parameters
    /// keeps what it stands for.
    pub scale: f64,
}

impl State {
    /// A state of which no more is known than its name and its value at the start.
    pub fn new(name: impl Into<String>, initial: f64) -> Self {
        Self {
            name: name.into(),
            initial,
            dimension: None,
            nominal: None,
            negligible: 0.0,
            floor: None,
            scale: 1.0,
        }
    }
}

/// The least value of a state that its law knows. A run that has gone below it is no failure, but there is a warning at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// In SI units.
    pub value: f64,
    /// What is there, for the sentence that the state has been below it: `absolute zero`.
    pub name: &'static str,
    /// Symbol of the SI unit of the state.
    pub unit: &'static str,
    /// What to do, as a sentence without a full stop.
    pub help: &'static str,
}

/// One discrete state: a sampled state, a mode or a cell of a memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    // Of a memory, which may have millions of cells, all share one.
    stem: Arc<str>,
    cell: Option<u32>,
    /// Value at the start.
    pub initial: f64,
    /// What its changes are called, where they are events.
    pub changes: Option<Box<Changes>>,
}

impl Discrete {
    /// A discrete state whose changes are no events.
    pub fn new(name: impl Into<String>, initial: f64) -> Self {
        Self { stem: name.into().into(), cell: None, initial, changes: None }
    }

    /// Name below the block, for messages.
    pub fn name(&self) -> Cow<'_, str> {
        match self.cell {
            Some(cell) => format!("{}[{cell}]", self.stem).into(),
            None => (&*self.stem).into(),
        }
    }

    /// The same with names for its changes, which are events.
    pub fn changes(mut self, table: &'static [Change], subject: Subject) -> Self {
        self.changes = Some(Box::new(Changes { table, subject, unit: None }));
        self
    }

    /// A discrete state whose changes are jumps of something else by as much, in this unit, which are events.
    pub fn jumps(name: impl Into<String>, subject: Subject, unit: &'static str) -> Self {
        let changes = Changes { table: JUMP, subject, unit: Some(unit) };
        Self { changes: Some(Box::new(changes)), ..Self::new(name, 0.0) }
    }
}

/// A function whose zero crossings the solver must not step over.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Guard {
    /// Name below the block.
    pub name: String,
    /// Which of its crossings are events.
    pub crossing: Crossing,
    /// Whether the law has a kink there that is not held between events: both sides are seen within a step.
    pub kink: bool,
    /// What its events are called.
    pub event: Event,
    /// To whom they happen.
    pub subject: Subject,
}

impl Guard {
    /// A guard of which these crossings are events.
    pub fn new(name: impl Into<String>, crossing: Crossing) -> Self {
        Self { name: name.into(), crossing, ..Self::default() }
    }

    /// A guard of a kink, see [`Interface::kink`].
    pub fn of_kink(name: impl Into<String>) -> Self {
        Self { kink: true, ..Self::new(name, Crossing::Either) }
    }
}

/// A way through zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
pub enum Crossing {
    /// Upwards or downwards.
    #[default]
    Either,
    /// From below zero to zero or above.
    Rising,
    /// From above zero to zero or below.
    Falling,
    /// From zero or above to below zero: the guard of a mode that is right while the guard is not negative. The engine
    /// has the modes chosen again at once where such a guard is negative at the start of a step, and ends the run if it
    /// stays so. What is zero but for rounding must be given as zero.
    #[serde(skip)]
    Holds,
    /// Not a crossing: where the guard has a maximum, whatever its sign. A guard that waits for nothing is constant.
    #[serde(skip)]
    Peak,
}

impl Crossing {
    /// Whether a guard that goes from `start` to `end` crosses zero in this way. Zero is reached but not left; what is
    /// not a number crosses nothing.
    #[inline]
    pub fn happens(self, start: f64, end: f64) -> bool {
        match self {
            Self::Either => start > 0.0 && end <= 0.0 || start < 0.0 && end >= 0.0,
            Self::Rising => start < 0.0 && end >= 0.0,
            Self::Falling => start > 0.0 && end <= 0.0,
            Self::Holds => start >= 0.0 && end < 0.0,
            Self::Peak => false,
        }
    }
}

/// Discrete states that are written one after the other, and from the first again, so that which of them is the oldest is a
/// discrete state itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ring {
    /// Which discrete state holds the number of the oldest entry.
    pub next: usize,
    /// Where the entries begin; they go on to the last discrete state.
    pub first: usize,
    /// Number of discrete states of one entry.
    pub width: usize,
}

/// Outputs whose values the engine finds, so that something else becomes zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Output group whose values are found. Asked for its outputs, it leaves the unknowns as they are.
    pub group: usize,
    /// Group without outputs that writes what is left over, where the unknowns lie: each in the place of one of them.
    pub rest: usize,
    /// Where the unknowns lie among the outputs of the block, and where the search begins.
    pub unknowns: Vec<(usize, f64)>,
}

/// What a recording block wants recorded: all its inputs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordRequest {
    /// Unit to show them in; SI when absent.
    pub display: Option<String>,
    /// Units of single inputs, by number, which count before that of all.
    pub displays: Vec<Option<String>>,
    /// What each input is called in legends; empty where the names of the inputs do.
    pub legend: Vec<String>,
    /// The input over which the others are drawn, instead of over time.
    pub over: Option<usize>,
}

/// That a block passes whichever of its inputs comes from a conditional subsystem that runs; what it does follows from that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merging {
    /// What it gives before any of them has run, in SI; the run ends there with an error if it is not given.
    pub initial: Option<f64>,
}

/// What a jump of a block is called, behind its path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JumpPhrase(pub &'static str);

impl Default for JumpPhrase {
    fn default() -> Self {
        Self("jumps")
    }
}

/// What a block looks like from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Interface {
    /// Input ports in the order of `Context::inputs`.
    pub inputs: Vec<Input>,
    /// Output ports in the order of `Context::outputs`.
    pub outputs: Vec<Output>,
    /// Output group of each output.
    pub group_of: Vec<usize>,
    /// The inputs that each output group reads; `None` stands for all.
    pub groups: Vec<Option<Vec<usize>>>,
    /// Conserving ports.
    pub ports: Vec<PhysicalPort>,
    /// Continuous states.
    pub states: Vec<State>,
    /// Continuous states that may go on moving where everything else is steady, by number: places, while speeds are
    /// steady, and what has flowed.
    pub drifting: Vec<usize>,
    /// Continuous states that are as large as the largest of them where errors are measured, by number: what one law keeps at
    /// nothing, as the speed of a joint that a closed loop holds, is made of the errors of the others.
    pub kin: Vec<Vec<usize>>,
    /// Discrete states.
    pub discrete: Vec<Discrete>,
    /// Guards.
    pub guards: Vec<Guard>,
    /// When the block samples; `None` means continuous or as its inputs.
    pub sample_time: Option<SampleTime>,
    /// The outputs change with time even when inputs and states do not.
    pub uses_time: bool,
    /// Has `settle`.
    pub settles: bool,
    /// The output groups before each of which some modes are chosen (`settle_in`); `None` for all of them before the first one.
    pub settling: Option<Vec<usize>>,
    /// Output groups that choose modes, and others that depend on these.
    pub before: Vec<(usize, usize)>,
    /// Has `jump`.
    pub jumps: bool,
    /// What a jump is called; empty where guards or discrete states have the words for it.
    pub jump_phrase: JumpPhrase,
    /// Has `accept`.
    pub accepts: bool,
    /// Inputs, by port, for the sake of which it has `accept`: it may be left out where none of them changes between its hits.
    pub notes: Vec<usize>,
    /// Has `remember`, and gives what it notes back after this time at the earliest, s.
    pub remembers: Option<f64>,
    /// The output is the input this much earlier, s, in all frequencies.
    pub dead_time: Option<f64>,
    /// Discrete states whose meaning moves round.
    pub ring: Option<Ring>,
    /// Has `next_event`.
    pub time_events: bool,
    /// Has `pending_event`.
    pub pending_events: bool,
    /// Discrete states hold times for which it waits: a subsystem that pauses it stops its time.
    pub waits: bool,
    /// Has `next_update` and `tolerate`.
    pub subdivides: bool,
    /// Has `prepare` and `solve`.
    pub implicit: bool,
    /// Largest step that the block allows, s.
    pub max_step: Option<f64>,
    /// Shortest period with which the outputs swing with time alone, s.
    pub period: Option<f64>,
    /// Continuous states that are angles of which only the remainder of a turn counts, by number.
    pub turning_states: Vec<usize>,
    /// Inputs that are such angles, rad, by number.
    pub turning_inputs: Vec<usize>,
    /// The block records its inputs.
    pub recorded: Option<RecordRequest>,
    /// Outputs that the engine finds.
    pub constraint: Option<Constraint>,
    /// The block passes what comes from conditional subsystems.
    pub merges: Option<Merging>,
    /// The discrete states from this one on are a copy of the outputs, which the engine makes at the end of each step, before
    /// anything of the next major step, and at the end of each major step: what the block gave when it last ran.
    pub holds: Option<usize>,
}

impl Interface {
    /// No ports, no states.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an input.
    pub fn input(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds an output that depends on all inputs at the same instant.
    pub fn output(self, output: Output) -> Self {
        self.output_in(None, output)
    }

    /// Adds an output that depends on no input at the same instant: it breaks algebraic loops.
    pub fn output_from_state(self, output: Output) -> Self {
        self.output_in(Some(Vec::new()), output)
    }

    /// Adds an output that depends on these inputs at the same instant.
    pub fn output_reading(self, inputs: &[usize], output: Output) -> Self {
        self.output_in(Some(inputs.to_vec()), output)
    }

    /// Outputs that read the same inputs form one group; groups are numbered as they appear.
    fn output_in(mut self, reads: Option<Vec<usize>>, output: Output) -> Self {
        let group = self.groups.iter().position(|known| *known == reads).unwrap_or_else(|| {
            self.groups.push(reads);
            self.groups.len() - 1
        });
        self.outputs.push(output);
        self.group_of.push(group);
        self
    }

    /// Adds an output with values that the engine finds: those at `unknowns` (places among all outputs, and where the search
    /// begins), so that as many numbers become zero, which follow from all inputs. The block writes these as the outputs of
    /// the group behind that of this output. It is the only output of the block.
    pub fn output_sought(mut self, output: Output, unknowns: Vec<(usize, f64)>) -> Self {
        self = self.output_from_state(output);
        self.groups.push(None);
        let rest = self.groups.len() - 1;
        self.constraint = Some(Constraint { group: rest - 1, rest, unknowns });
        self
    }

    /// Adds a continuous state.
    pub fn state(self, name: impl Into<String>, initial: f64) -> Self {
        self.state_in(name, initial, None)
    }

    /// Adds a continuous state of a dimension, if it is known.
    pub fn state_in(mut self, name: impl Into<String>, initial: f64, dimension: Option<Dimension>) -> Self {
        self.states.push(State { dimension, ..State::new(name, initial) });
        self
    }

    /// Adds a continuous state that may go on moving where everything else is steady.
    pub fn drifting_state(mut self, name: impl Into<String>, initial: f64) -> Self {
        self.drifting.push(self.states.len());
        self.state(name, initial)
    }

    /// Adds a discrete state.
    pub fn discrete(mut self, name: impl Into<String>, initial: f64) -> Self {
        self.discrete.push(Discrete::new(name, initial));
        self
    }

    /// Adds `n` discrete states of one name.
    pub fn memory(mut self, name: &str, n: usize, initial: f64) -> Self {
        let stem: Arc<str> = name.into();
        let cell = |i| Discrete { stem: Arc::clone(&stem), cell: Some(i as u32), initial, changes: None };
        self.discrete.extend((0..n).map(cell));
        self
    }

    /// Adds `n` discrete states of one name, whose changes are events.
    pub fn modes(mut self, name: &str, n: usize, initial: f64, table: &'static [Change]) -> Self {
        self.discrete.extend((0..n).map(|i| {
            let subject = Subject { part: None, detail: element(i, n) };
            Discrete::new(format!("{name}[{i}]"), initial).changes(table, subject)
        }));
        self
    }

    /// Adds a guard of which every crossing is an event.
    pub fn guard(self, name: impl Into<String>) -> Self {
        self.guard_when(Crossing::Either, name)
    }

    /// Adds a guard of which only these crossings are events. The solver stops at them alone, so the block must do
    /// without a look at the others; at the ends of the steps it sees on which side of zero it is.
    pub fn guard_when(mut self, crossing: Crossing, name: impl Into<String>) -> Self {
        self.guards.push(Guard::new(name, crossing));
        self
    }

    /// Adds a guard of a kink: a law that is continuous there, but not its slope, and that is not held on its side between
    /// events. The step that has looked beyond it is repeated up to it.
    pub fn kink(mut self, name: impl Into<String>) -> Self {
        self.guards.push(Guard::of_kink(name));
        self
    }

    /// Adds a guard for each of `n` elements.
    pub fn guard_each(self, name: &str, n: usize) -> Self {
        (0..n).fold(self, |all, i| all.guard(indexed(name, i, n)).detail(element(i, n)))
    }

    /// The same for kinks.
    pub fn kink_each(self, name: &str, n: usize) -> Self {
        (0..n).fold(self, |all, i| all.kink(indexed(name, i, n)).detail(element(i, n)))
    }

    /// The same for guards with a direction.
    pub fn guard_each_when(self, crossing: Crossing, name: &str, n: usize) -> Self {
        (0..n).fold(self, |all, i| all.guard_when(crossing, indexed(name, i, n)).detail(element(i, n)))
    }

    /// What the crossings of all guards so far that have no words yet are called: upwards, or at a maximum, and downwards.
    pub fn called(self, upwards: &'static str, downwards: &'static str) -> Self {
        self.event(Event::Crossing { upwards, downwards })
    }

    /// The crossings of all guards so far that have no words yet change modes, or make the block jump: these have the words.
    pub fn called_by_mode(self) -> Self {
        self.event(Event::Mode)
    }

    fn event(mut self, event: Event) -> Self {
        let unnamed = self.guards.iter_mut().filter(|guard| guard.event == Event::Name);
        unnamed.for_each(|guard| guard.event = event);
        self
    }

    /// Which of several things in the block the last guard is about.
    pub fn detail(mut self, detail: Option<String>) -> Self {
        self.guards.iter_mut().last().into_iter().for_each(|guard| guard.subject.detail.clone_from(&detail));
        self
    }

    /// What a jump of the block is called; nothing where guards or discrete states have the words for it.
    pub fn jump_called(mut self, phrase: &'static str) -> Self {
        self.jump_phrase = JumpPhrase(phrase);
        self
    }

    /// Samples with this period, s.
    pub fn sampled(mut self, period: f64) -> Self {
        self.sample_time = Some(SampleTime::Discrete { period, offset: 0.0 });
        self
    }

    /// Never changes.
    pub fn constant(mut self) -> Self {
        self.sample_time = Some(SampleTime::Constant);
        self
    }

    /// The outputs depend on time.
    pub fn uses_time(mut self) -> Self {
        self.uses_time = true;
        self
    }

    /// Has `settle`.
    pub fn settles(mut self) -> Self {
        self.settles = true;
        self
    }

    /// Has `jump`.
    pub fn jumps(mut self) -> Self {
        self.jumps = true;
        self
    }

    /// The output is the input `time` earlier, s.
    pub fn delays(mut self, time: f64) -> Self {
        self.dead_time = Some(time);
        self
    }

    /// Some discrete states are a ring.
    pub fn turns(mut self, ring: Ring) -> Self {
        self.ring = Some(ring);
        self
    }

    /// Has `accept`.
    pub fn accepts(mut self) -> Self {
        self.accepts = true;
        self
    }

    /// Has `remember`, and gives what it notes back after `shortest`, s, at the earliest. Steps are a little shorter than that.
    pub fn remembers(mut self, shortest: f64) -> Self {
        self.remembers = Some(shortest);
        self
    }

    /// Has `next_event`.
    pub fn time_events(mut self) -> Self {
        self.time_events = true;
        self
    }

    /// Has `next_event`, and holds the times for which it waits in discrete states.
    pub fn waits(mut self) -> Self {
        (self.time_events, self.waits) = (true, true);
        self
    }

    /// Has `next_update` and `tolerate`.
    pub fn subdivides(mut self) -> Self {
        self.subdivides = true;
        self
    }

    /// Has `prepare` and `solve`.
    pub fn implicit(mut self) -> Self {
        self.implicit = true;
        self
    }

    /// Steps may not be longer than this, s.
    pub fn max_step(mut self, step: f64) -> Self {
        self.max_step = Some(step);
        self
    }

    /// The outputs swing with time alone, with this period, s. Steps are made short enough to see it wherever a
    /// derivative, a guard or a memory depends on the outputs. Zero or infinite is no period.
    pub fn period(mut self, period: f64) -> Self {
        self.period = Some(period).filter(|period| *period > 0.0 && period.is_finite());
        self
    }

    /// A continuous state is an angle, rad, of which only the remainder of a turn counts. Steps are made short enough to see
    /// each turn wherever a derivative, a guard or a memory depends on the block, or it has guards itself.
    pub fn turning_state(mut self, state: usize) -> Self {
        self.turning_states.push(state);
        self
    }

    /// The same of an input.
    pub fn turning_input(mut self, input: usize) -> Self {
        self.turning_inputs.push(input);
        self
    }

    /// Records all inputs.
    pub fn records(mut self, recorded: RecordRequest) -> Self {
        self.recorded = Some(recorded);
        self
    }

    /// Passes what comes from conditional subsystems.
    pub fn merges(mut self, merging: Merging) -> Self {
        self.merges = Some(merging);
        self
    }

    /// Adds a conserving port.
    pub fn port(mut self, port: PhysicalPort) -> Self {
        self.ports.push(port);
        self
    }

    /// Whether modes are chosen before output group `group`, unless those of an earlier one have been.
    pub fn settles_in(&self, group: usize) -> bool {
        self.settles && self.settling.as_ref().is_none_or(|groups| groups.contains(&group))
    }

    /// Whether output group `group` reads input `input` at the same instant.
    pub fn reads(&self, group: usize, input: usize) -> bool {
        self.groups[group].as_ref().is_none_or(|inputs| inputs.contains(&input))
    }
}

/// Which element an event of a block of `n` is about; nothing where there is one alone.
fn element(i: usize, n: usize) -> Option<String> {
    (n > 1).then(|| format!("element {i}"))
}

fn indexed(name: &str, i: usize, n: usize) -> String {
    if n == 1 { name.to_owned() } else { format!("{name}[{i}]") }
}

/// The inputs do not fit the block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterfaceError {
    /// A word for the manual: `unit_mismatch`, `type_mismatch`, `parameter`.
    pub code: &'static str,
    /// The ports that disagree, most guilty first.
    pub ports: Vec<String>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

/// Most numbers that all blocks of a model together may remember.
pub const MOST_MEMORY: usize = 1 << 22;

impl InterfaceError {
    /// Whether a block may remember `cells` numbers, which `why` explains: `1000 samples of 3 elements`.
    ///
    /// # Errors
    /// They are more than [`MOST_MEMORY`].
    pub fn memory_fits(cells: Option<usize>, why: &str) -> Result<(), Self> {
        if cells.is_some_and(|cells| cells <= MOST_MEMORY) {
            return Ok(());
        }
        Err(Self {
            code: "too_large",
            ports: Vec::new(),
            message: format!("{why} are more than {MOST_MEMORY} numbers"),
            help: Some("remember fewer of them, or delay fewer elements".to_owned()),
        })
    }

    /// Shapes or kinds that do not fit.
    pub fn types(ports: &[&str], message: impl Into<String>) -> Self {
        Self::new("type_mismatch", ports, message)
    }

    /// Units that do not fit.
    pub fn units(ports: &[&str], message: impl Into<String>) -> Self {
        Self::new("unit_mismatch", ports, message)
    }

    fn new(code: &'static str, ports: &[&str], message: impl Into<String>) -> Self {
        Self {
            code,
            ports: ports.iter().map(ToString::to_string).collect(),
            message: message.into(),
            help: None,
        }
    }

    /// The same with advice.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}
