//! A model beside its tangent: a block more for each one that a parameter acts on.

use std::sync::Arc;

use blocksim_block::law::BlockLaw;
use blocksim_block::schedule::{Instance, Recorded, Schedule, Start, Step};
use blocksim_block::{Block, Context, Discrete, Fault, Input, Interface, Output, Resolution, Scratch, State};
use blocksim_law::{Code, Id, Op, Program, Sources, passes, rates};
use blocksim_signal::Shape;

use super::extrapolated;
use crate::program::spread::written;

/// Part by which derivatives of a constant over two distances may differ.
const SMOOTH: f64 = 1e-3;
/// Part by which values on both sides of an event may differ, as they are found by different ways.
const CONTINUOUS: f64 = 1e-6;

/// Discrete states for which settling has room on the stack.
const FEW: usize = 16;
/// Most times of a source that are compared.
const MOST_TIMES: usize = 10_000;

/// Why a run with a tangent ends.
pub(super) const JUMPS: &str = "jumps at a time that depends on the parameter";

/// The five variants of one block.
type Five<'s> = [&'s Instance; 5];

/// The model with its tangent, and behind which place among what it records the derivative of each signal stands; none of
/// those that the parameter does not act on.
///
/// # Errors
/// Why there is no tangent.
pub(super) fn with_tangent(
    variants: &[Schedule; 5],
    distance: f64,
) -> Result<(Schedule, Vec<Option<usize>>), String> {
    let own = &variants[2];
    let is_alike = |other: &Schedule| {
        let blocks = own.blocks.iter().zip(&other.blocks);
        other.blocks.len() == own.blocks.len()
            && other.steps == own.steps
            && other.loops == own.loops
            && other.clock == own.clock
            && other.settings == own.settings
            && blocks.into_iter().all(|(a, b)| {
                (&a.path, &a.kind, &a.gather, a.y, a.x, a.d) == (&b.path, &b.kind, &b.gather, b.y, b.x, b.d)
            })
    };
    if !variants.iter().all(is_alike) {
        return Err("the parameter changes more than numbers of laws".to_owned());
    }
    if own.settings.start != Start::Given {
        return Err("the run begins in a steady state, which the parameter moves".to_owned());
    }
    let blocks: Vec<Five> =
        (0..own.blocks.len()).map(|block| [0, 1, 2, 3, 4].map(|k| &variants[k].blocks[block])).collect();
    let inputs = (0..5).map(|k| &variants[k].initial_signals);
    let written_cells: usize = own.signals.iter().map(|signal| signal.shape.len()).sum();
    if inputs.into_iter().any(|values| values[written_cells..] != own.initial_signals[written_cells..]) {
        return Err("the parameter is the value of an input that is not connected".to_owned());
    }
    let mut twins: Vec<Option<Twin>> = Vec::with_capacity(blocks.len());
    for five in &blocks {
        twins.push(Twin::of(five, distance, own.settings.seed)?);
    }
    let influenced = influenced(own, variants, &mut twins)?;
    if !influenced.contains(&true) {
        return Err("nothing that is known of the laws changes with the parameter".to_owned());
    }
    Ok(joined(own, twins, &influenced))
}

/// Which cells the parameter acts on. Blocks that read them get a twin, too.
fn influenced(
    own: &Schedule,
    variants: &[Schedule; 5],
    twins: &mut [Option<Twin>],
) -> Result<Vec<bool>, String> {
    let mut influenced = vec![false; own.initial_signals.len()];
    let mut is_done = vec![false; twins.len()];
    let mut grows = true;
    while grows {
        grows = false;
        for (block, instance) in own.blocks.iter().enumerate() {
            let reads =
                |&(from, len): &(u32, u32)| influenced[from as usize..(from + len) as usize].contains(&true);
            if is_done[block] || twins[block].is_none() && !instance.gather.iter().any(reads) {
                continue;
            }
            twins[block].get_or_insert_with(|| Twin::plain(instance, own.settings.seed));
            possible(own, variants, block)?;
            (is_done[block], grows) = (true, true);
            let width = instance.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
            influenced[instance.y..instance.y + width].fill(true);
        }
    }
    Ok(influenced)
}

/// Looks whether a block that the parameter acts on can have a tangent.
fn possible(own: &Schedule, variants: &[Schedule; 5], block: usize) -> Result<(), String> {
    let instance = &own.blocks[block];
    let Interface { jumps, time_events, accepts, remembers, subdivides, holds, constraint, recorded, .. } =
        &instance.interface;
    let path = &instance.path;
    if recorded.is_some() && instance.interface.outputs.is_empty() {
        return Ok(());
    }
    let Some(law) = &instance.law else { return Err(format!("`{path}` records no law")) };
    let in_loop = own.loops.iter().any(|ring| {
        own.steps[ring.first..ring.first + ring.count].iter().any(|step| step.block as usize == block)
    });
    let reason = match () {
        () if *jumps => "has states that jump",
        () if *time_events && !is_on_time(variants, block) => {
            "does something at times that may depend on the parameter"
        }
        () if *accepts || remembers.is_some() || holds.is_some() => "answers from memory",
        () if *subdivides || constraint.is_some() => "is solved by itself",
        () if in_loop => "is in an algebraic loop",
        () if instance.rate.is_some()
            && law.updated.len() + law.settled.len() < instance.interface.discrete.len() =>
        {
            "has samples that are not recorded as a law"
        }
        () => return Ok(()),
    };
    Err(format!("`{path}` {reason}"))
}

/// Whether a source does all that it does at the same times, whatever the parameter.
fn is_on_time(variants: &[Schedule; 5], block: usize) -> bool {
    let own = &variants[2].blocks[block];
    let (x, d) = at_start(own, variants[2].settings.seed);
    if !own.inputs.is_empty() {
        return false;
    }
    let fault = Fault::default();
    let mut t = f64::NEG_INFINITY;
    for _ in 0..MOST_TIMES {
        let next = variants.each_ref().map(|variant| {
            let instance = &variant.blocks[block];
            let c = Context {
                t,
                x: &x,
                d: &d,
                u: &[],
                inputs: &instance.inputs,
                outputs: &instance.outputs,
                evaluation: 0,
                fault: &fault,
                resolution: Resolution::new(variant.settings.stop_time),
                seed: variant.settings.seed,
            };
            instance.block.next_event(&c)
        });
        if next.iter().any(|time| time.to_bits() != next[2].to_bits()) || next[2] <= t {
            return false;
        }
        t = next[2];
        if t > variants[2].settings.stop_time {
            return true;
        }
    }
    false
}

/// Values at the start and their derivatives by the parameter.
type Starts = Vec<(f64, f64)>;

/// What is known of a block that has a tangent.
struct Twin {
    /// Its law, with the numbers that change as parameters.
    law: Option<Changing>,
    /// States and discrete states at the start, with the seed of the run.
    x: Starts,
    d: Starts,
}

/// A law with its numbers that change with the parameter.
struct Changing {
    program: Program,
    /// Outputs, derivatives, and what discrete states become.
    outputs: Vec<Id>,
    derivatives: Vec<Id>,
    updated: Vec<(usize, Id)>,
    /// Derivatives of the parameters of the program.
    slopes: Vec<f64>,
}

impl Twin {
    /// That of a block on which the parameter acts by inputs alone.
    fn plain(instance: &Instance, seed: u64) -> Self {
        let (x, d) = at_start(instance, seed);
        let still = |values: Vec<f64>| values.into_iter().map(|value| (value, 0.0)).collect();
        let law = instance.law.as_ref().map(|law| Changing {
            program: law.program.clone(),
            outputs: law.outputs.clone(),
            derivatives: law.derivatives.clone(),
            updated: law.updated.clone(),
            slopes: Vec::new(),
        });
        Self { law, x: still(x), d: still(d) }
    }

    /// That of a block that the parameter changes; none if it does not.
    fn of(five: &Five, distance: f64, seed: u64) -> Result<Option<Self>, String> {
        let path = &five[2].path;
        let starts = five.map(|instance| at_start(instance, seed));
        let of_starts = |which: &dyn Fn(usize) -> Vec<f64>| -> Result<Starts, String> {
            let all: Vec<Vec<f64>> = (0..5).map(which).collect();
            if all.iter().any(|values| values.len() != all[2].len()) {
                return Err(format!("the parameter changes the number of states of `{path}`"));
            }
            (0..all[2].len()).map(|i| constant([0, 1, 2, 3, 4].map(|k| all[k][i]), distance, path)).collect()
        };
        let x = of_starts(&|k| starts[k].0.clone())?;
        let d = of_starts(&|k| starts[k].1.clone())?;
        let moves = x.iter().chain(&d).any(|(_, slope)| *slope != 0.0);
        let shape = |instance: &Instance| {
            let Interface { groups, group_of, sample_time, period, max_step, dead_time, .. } =
                &instance.interface;
            format!("{groups:?} {group_of:?} {sample_time:?} {period:?} {max_step:?} {dead_time:?}")
        };
        let laws = five.map(|instance| instance.law.as_deref());
        let [Some(a), Some(b), Some(own), Some(c), Some(e)] = laws else {
            let text = |instance: &Instance| format!("{:?}", instance.block);
            let changes =
                five.iter().any(|other| text(other) != text(five[2]) || shape(other) != shape(five[2]));
            return match moves || changes {
                true => Err(format!("`{path}` records no law")),
                false => Ok(None),
            };
        };
        let is_same = [a, b, c, e]
            .into_iter()
            .all(|law| law.program.instructions == own.program.instructions && roots(law) == roots(own));
        if is_same && !moves {
            // A source may have a period and nothing else that changes.
            return Ok(None);
        }
        if five.iter().any(|other| shape(other) != shape(five[2]) && dead_times_differ(five)) {
            return Err(format!("the parameter changes the times of `{path}`"));
        }
        // At its own value numbers may be equal by accident, which are one constant then.
        let ops = |law: &BlockLaw| {
            law.program.instructions.iter().map(|instruction| instruction.op).collect::<Vec<Op>>()
        };
        let all = [a, b, c, e].map(ops);
        let is_alike = |other: &Vec<Op>| {
            let pairs = all[3].iter().zip(other);
            other.len() == all[3].len()
                && pairs
                    .into_iter()
                    .all(|(a, b)| a == b || a.as_constant().is_some() && b.as_constant().is_some())
        };
        if !all.iter().all(is_alike) || [a, b, c].into_iter().any(|law| roots(law) != roots(e)) {
            return Err(format!("the parameter changes the form of the law of `{path}`"));
        }
        let mut program = e.program.clone();
        program.parameters.clear();
        let mut slopes = Vec::new();
        for (at, instruction) in program.instructions.iter_mut().enumerate() {
            let numbers = [0, 1, 2, 3].map(|k| all[k][at].as_constant());
            let [Some(a), Some(b), Some(c), Some(e)] = numbers else { continue };
            if [a, b, c].iter().all(|other| other.to_bits() == e.to_bits()) {
                continue;
            }
            let middle = (4.0 * 0.5 * (b + c) - 0.5 * (a + e)) / 3.0;
            let (_, slope) = constant([a, b, middle, c, e], distance, path)?;
            instruction.op = Op::Parameter(slopes.len() as u32);
            program.parameters.push((String::new(), middle));
            slopes.push(slope);
        }
        let law = Changing {
            outputs: e.outputs.clone(),
            derivatives: e.derivatives.clone(),
            updated: e.updated.clone(),
            program,
            slopes,
        };
        Ok(Some(Self { law: Some(law), x, d }))
    }
}

fn roots(law: &BlockLaw) -> [Vec<Id>; 4] {
    let seconds = |list: &[(usize, Id)]| list.iter().map(|(_, id)| *id).collect();
    [law.outputs.clone(), law.derivatives.clone(), seconds(&law.updated), seconds(&law.settled)]
}

fn dead_times_differ(five: &Five) -> bool {
    let times = five.map(|instance| (instance.interface.dead_time, instance.interface.sample_time));
    times.iter().any(|other| format!("{other:?}") != format!("{:?}", times[2]))
}

/// A number and its derivative, from its five values.
fn constant(values: [f64; 5], distance: f64, path: &str) -> Result<(f64, f64), String> {
    let [a, b, own, c, e] = values;
    if values.iter().all(|value| value.to_bits() == own.to_bits()) {
        return Ok((own, 0.0));
    }
    let (slope, error) = extrapolated([a, b, c, e], distance);
    let wide = ((e - a) / (2.0 * distance)).abs();
    let size = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    if !slope.is_finite() || error > SMOOTH * wide.max(slope.abs()) + 1e3 * f64::EPSILON * size / distance {
        return Err(format!("a number of `{path}` jumps or has a kink where the parameter has its value"));
    }
    Ok((own, slope))
}

/// States and discrete states at the start, with the seed of the run.
fn at_start(instance: &Instance, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut x: Vec<f64> = instance.interface.states.iter().map(|state| state.initial).collect();
    let mut d: Vec<f64> = instance.interface.discrete.iter().map(|state| state.initial).collect();
    let fault = Fault::default();
    // Nobody knows inputs before the start, but they have their places.
    let width = instance.inputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
    let c = Context {
        t: 0.0,
        x: &[],
        d: &[],
        u: &vec![0.0; width],
        inputs: &instance.inputs,
        outputs: &instance.outputs,
        evaluation: 0,
        fault: &fault,
        resolution: Resolution::default(),
        seed,
    };
    instance.block.initialize(&c, &mut x, &mut d);
    (x, d)
}

/// The schedule with all twins.
fn joined(
    own: &Schedule,
    mut twins: Vec<Option<Twin>>,
    influenced: &[bool],
) -> (Schedule, Vec<Option<usize>>) {
    let mut schedule = own.clone();
    // A cell that is zero for ever, for what the parameter does not act on.
    let zero = schedule.initial_signals.len();
    schedule.initial_signals.push(0.0);
    let mut tangent_of = vec![zero as u32; own.initial_signals.len()];
    for (instance, twin) in own.blocks.iter().zip(&twins) {
        let width = instance.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
        if twin.is_some() && width > 0 {
            let first = schedule.initial_signals.len();
            schedule.initial_signals.resize(first + width, 0.0);
            (0..width).for_each(|i| tangent_of[instance.y + i] = (first + i) as u32);
        }
    }
    let mut number_of = vec![None; own.blocks.len()];
    for (block, instance) in own.blocks.iter().enumerate() {
        let Some(Twin { law: Some(law), x, d }) = twins[block].take() else { continue };
        number_of[block] = Some(schedule.blocks.len());
        let y = tangent_of.get(instance.y).copied().filter(|_| !instance.outputs.is_empty());
        let twin =
            tangent_instance(instance, law, (&x, &d), &tangent_of, y.map_or(zero, |y| y as usize), &schedule);
        schedule.states += twin.interface.states.len();
        schedule.discrete += twin.interface.discrete.len();
        schedule.blocks.push(twin);
    }
    let mut steps = Vec::with_capacity(2 * own.steps.len());
    for (at, step) in own.steps.iter().enumerate() {
        schedule
            .loops
            .iter_mut()
            .zip(&own.loops)
            .filter(|(_, before)| before.first == at)
            .for_each(|(ring, _)| ring.first = steps.len());
        steps.push(*step);
        let writes = written(own, step).next().is_some();
        steps.extend(
            number_of[step.block as usize]
                .filter(|_| writes)
                .map(|block| Step { block: block as u32, ..*step }),
        );
    }
    schedule.steps = steps;
    let mut places = Vec::with_capacity(own.recorded.len());
    for recorded in &own.recorded {
        places.push(influenced[recorded.cell].then_some(schedule.recorded.len()));
        if influenced[recorded.cell] {
            let cell = tangent_of[recorded.cell] as usize;
            schedule.recorded.push(Recorded {
                path: format!("d {}", recorded.path),
                cell,
                held: false,
                ..recorded.clone()
            });
        }
    }
    (schedule, places)
}

/// The block beside another one.
fn tangent_instance(
    instance: &Instance,
    law: Changing,
    (x, d): (&Starts, &Starts),
    tangent_of: &[u32],
    y: usize,
    schedule: &Schedule,
) -> Instance {
    let width: u32 = instance.gather.iter().map(|copy| copy.1).sum();
    let ports = instance.inputs.len();
    let cells = instance.gather.iter().flat_map(|&(from, len)| from..from + len);
    let rates = cells.map(|cell| (tangent_of[cell as usize], 1));
    let vector = |(start, end): &(u32, u32)| Shape::Vector((end - start) as usize);
    let input = |(i, port): (usize, &(u32, u32))| Input::real(format!("u{i}")).shape(vector(port));
    let output = |(i, port): (usize, &(u32, u32))| Output::real(format!("y{i}")).shape(vector(port));
    let both = instance.inputs.iter().chain(&instance.inputs);
    let reads = |reads: &Option<Vec<usize>>| {
        reads.as_ref().map(|own| own.iter().copied().chain(own.iter().map(|port| ports + port)).collect())
    };
    let states = instance.interface.states.iter().zip(x);
    let values = states.clone().map(|(state, (value, _))| State { initial: *value, ..state.clone() });
    let slopes = states.map(|(state, (_, slope))| State::new(format!("d {}", state.name), *slope));
    let discrete = instance.interface.discrete.iter().zip(d);
    let held = discrete.clone().map(|(state, (value, _))| Discrete::new(state.name(), *value));
    let has_samples = !law.updated.is_empty();
    let sampled = discrete
        .filter(|_| has_samples)
        .map(|(state, (_, slope))| Discrete::new(format!("d {}", state.name()), *slope));
    let interface = Interface {
        inputs: both.enumerate().map(input).collect(),
        outputs: instance.outputs.iter().enumerate().map(output).collect(),
        group_of: instance.interface.group_of.clone(),
        groups: instance.interface.groups.iter().map(reads).collect(),
        states: values.chain(slopes).collect(),
        discrete: held.chain(sampled).collect(),
        settles: instance.interface.settles,
        settling: instance.interface.settling.clone(),
        before: instance.interface.before.clone(),
        uses_time: instance.interface.uses_time,
        ..Interface::new()
    };
    let shifted = instance.inputs.iter().map(|(start, end)| (start + width, end + width));
    Instance {
        kind: "Tangent".to_owned(),
        block: Arc::new(Tangent::new(instance, &law)),
        law: None,
        inputs: instance.inputs.iter().copied().chain(shifted).collect(),
        gather: instance.gather.iter().copied().chain(rates).collect(),
        y,
        x: schedule.states,
        d: schedule.discrete,
        g: schedule.guards,
        watched: false,
        parts: Vec::new(),
        interface,
        ..instance.clone()
    }
}

/// The block beside another one: its inputs are those of the other and their derivatives by the parameter, its states a copy of those
/// of the other and their derivatives, and its outputs derivatives.
#[derive(Debug)]
struct Tangent {
    inner: Arc<BlockLaw>,
    /// Numbers of inputs, states and discrete states of the other block, and of its input ports.
    widths: [usize; 3],
    ports: usize,
    /// Whether it chooses its modes at times that no parameter moves.
    is_timed: bool,
    groups: Vec<(Vec<usize>, Code)>,
    derivatives: Code,
    updated: Code,
    registers: usize,
}

/// Room for a tangent.
struct Room {
    inner: Scratch,
    sources: Vec<f64>,
    registers: Vec<f64>,
}

impl Tangent {
    fn new(instance: &Instance, law: &Changing) -> Self {
        let Some(inner) = instance.law.clone() else { unreachable!("only laws have a tangent") };
        let width: u32 = instance.gather.iter().map(|copy| copy.1).sum();
        let widths = [width as usize, instance.interface.states.len(), instance.interface.discrete.len()];
        let count = inner.group_of.iter().max().map_or(0, |group| group + 1);
        let groups = (0..count).map(|group| {
            let cells: Vec<usize> =
                (0..law.outputs.len()).filter(|cell| inner.group_of[*cell] == group).collect();
            let wanted: Vec<Id> = cells.iter().map(|cell| law.outputs[*cell]).collect();
            (cells, code(law, &wanted, widths))
        });
        let groups: Vec<(Vec<usize>, Code)> = groups.collect();
        let updated: Vec<Id> = law.updated.iter().map(|(_, id)| *id).collect();
        let (derivatives, updated) = (code(law, &law.derivatives, widths), code(law, &updated, widths));
        let all = groups.iter().map(|(_, code)| code).chain([&derivatives, &updated]);
        let registers = all.map(Code::registers).max().unwrap_or(0);
        let chooses_times = instance.interface.time_events && instance.inputs.is_empty();
        let is_timed = instance.rate.is_some() || chooses_times;
        Self {
            inner,
            widths,
            ports: instance.inputs.len(),
            is_timed,
            groups,
            derivatives,
            updated,
            registers,
        }
    }

    /// What the other block sees.
    fn inner<'a>(&self, c: &Context<'a>, d: &'a [f64]) -> Context<'a> {
        let [u, x, _] = self.widths;
        Context { u: &c.u[..u], x: &c.x[..x], d, inputs: &c.inputs[..self.ports], ..*c }
    }

    fn run<'r>(&self, code: &Code, c: &Context, d: &[f64], room: &'r mut Room) -> &'r [f64] {
        let [_, x, memories] = self.widths;
        room.sources.clear();
        room.sources.extend_from_slice(c.u);
        room.sources.extend_from_slice(&c.x[x..]);
        let rates = d.get(memories..).filter(|rates| !rates.is_empty());
        match rates {
            Some(rates) => room.sources.extend_from_slice(rates),
            None => room.sources.resize(room.sources.len() + memories, 0.0),
        }
        let sources = Sources {
            time: c.t,
            inputs: &room.sources,
            states: &c.x[..x],
            memories: &d[..memories],
            ..Sources::default()
        };
        code.run(&sources, &mut room.registers);
        &room.registers
    }

    /// Outputs and derivatives of the other block with these modes.
    fn law_with(&self, c: &Context, d: &[f64]) -> Vec<f64> {
        let c = self.inner(c, d);
        let mut w = self.inner.scratch();
        let mut y = vec![0.0; self.inner.outputs.len()];
        (0..self.groups.len()).for_each(|group| self.inner.outputs(group, &c, &mut w, &mut y));
        let mut dx = vec![0.0; self.widths[1]];
        self.inner.derivatives(&c, &mut w, &mut dx);
        y.extend(dx);
        y
    }

    /// Chooses modes as the other block does, unless that makes its values jump at a time that the parameter moves.
    fn choose(&self, c: &Context, d: &mut [f64], choose: impl Fn(&Context, &mut [f64])) {
        let own = &mut d[..self.widths[2]];
        let (mut few, many);
        let before = if own.len() <= FEW {
            few = [0.0; FEW];
            few[..own.len()].copy_from_slice(own);
            &few[..own.len()]
        } else {
            many = own.to_vec();
            &many[..]
        };
        choose(&self.inner(c, &[]), own);
        if before == &*own || self.is_timed || c.t <= 0.0 {
            return;
        }
        let (last, next) = (self.law_with(c, before), self.law_with(c, own));
        let jumps =
            last.iter().zip(&next).any(|(a, b)| (a - b).abs() > CONTINUOUS * a.abs().max(b.abs()).max(1e-6));
        if jumps {
            c.fail(JUMPS);
        }
    }
}

impl Block for Tangent {
    fn scratch(&self) -> Scratch {
        let [u, x, d] = self.widths;
        Scratch::new(Room {
            inner: self.inner.scratch(),
            sources: Vec::with_capacity(2 * u + x + d),
            registers: vec![0.0; self.registers],
        })
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        self.choose(c, d, |c, own| self.inner.settle(c, own));
    }

    fn settle_in(&self, group: usize, c: &Context, d: &mut [f64]) {
        self.choose(c, d, |c, own| self.inner.settle_in(group, c, own));
    }

    fn outputs(&self, group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let (Some((cells, code)), Some(room)) = (self.groups.get(group), w.get::<Room>()) else { return };
        let registers = self.run(code, c, c.d, room);
        cells.iter().enumerate().for_each(|(k, cell)| y[*cell] = code.result(registers, k));
    }

    fn derivatives(&self, c: &Context, w: &mut Scratch, dx: &mut [f64]) {
        let Some(room) = w.get::<Room>() else { return };
        let (values, slopes) = dx.split_at_mut(self.widths[1]);
        self.inner.derivatives(&self.inner(c, &c.d[..self.widths[2]]), &mut room.inner, values);
        let registers = self.run(&self.derivatives, c, c.d, room);
        slopes.iter_mut().enumerate().for_each(|(k, slope)| *slope = self.derivatives.result(registers, k));
    }

    fn update(&self, c: &Context, w: &mut Scratch, d: &mut [f64]) {
        let Some(room) = w.get::<Room>() else { return };
        let memories = self.widths[2];
        if d.len() > memories {
            let registers = self.run(&self.updated, c, d, room);
            let targets = self.inner.updated.iter().enumerate();
            targets.for_each(|(k, (i, _))| d[memories + i] = self.updated.result(registers, k));
        }
        self.inner.update(&self.inner(c, &[]), &mut room.inner, &mut d[..memories]);
    }
}

/// A program for the rates of some values of a law along the parameter; rates of inputs, states and memories stand behind the inputs.
fn code(law: &Changing, wanted: &[Id], [inputs, states, _]: [usize; 3]) -> Code {
    let alone = Program {
        outputs: wanted.iter().map(|id| (String::new(), *id)).collect(),
        kinks: Vec::new(),
        turns: Vec::new(),
        requirements: Vec::new(),
        ..law.program.clone()
    };
    let seed = |op: Op| match op {
        Op::Input(i) => Some(Op::Input(inputs as u32 + i)),
        Op::State(i) => Some(Op::Input((2 * inputs) as u32 + i)),
        Op::Memory(i) => Some(Op::Input((2 * inputs + states) as u32 + i)),
        Op::Parameter(i) => Some(Op::constant(law.slopes[i as usize])),
        _ => None,
    };
    let found = passes::bind_parameters(rates(&alone, &seed)).optimised();
    Code::new(&found, &found.output_values())
}
