//! Shapes, kinds and units of all signals.

use std::any::Any;
use std::sync::Arc;

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{Given, Interface, InterfaceError, MOST_MEMORY, PortType};
use blocksim_signal::{Dimension, Kind};
use foldhash::HashMap;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::condition::Conditional;
use crate::flatten::{Declared, Flat, FlatBlock, Source};
use crate::problems::{Problems, a};

/// Interfaces of all blocks, with the types of all outputs.
#[derive(Debug, Clone, Default)]
pub struct Typed {
    /// In the order of the flat list.
    pub interfaces: Vec<Arc<Interface>>,
    /// What the blocks of conditional subsystems were asked with, by their numbers: where units are open, the block says yes to them and
    /// might say no to those that are settled in the end.
    asked: HashMap<usize, Given>,
}

impl Typed {
    /// Type of the signal that an input takes.
    pub fn of(&self, source: &Source) -> PortType {
        self.interfaces[source.block].outputs[source.output].port_type
    }

    /// What is known of the inputs and parameters of a block.
    pub fn given(&self, block: &FlatBlock) -> Given {
        let inputs = block.interface.inputs.iter().zip(&block.inputs);
        let known =
            inputs.filter_map(|(input, source)| Some((input.name.clone(), self.of(source.as_ref()?))));
        Given::sharing(known.collect(), block.units.clone())
    }

    /// What a block of a conditional subsystem was asked with.
    pub fn asked(&self, number: usize) -> Option<&Given> {
        self.asked.get(&number)
    }
}

/// Asks every block for its interface until nothing changes, then checks every connection.
pub(crate) fn infer(flat: &Flat, problems: &mut Problems) -> Typed {
    let (mut typed, errors) = ask_all(flat);
    let agrees: Vec<bool> = errors.iter().map(Option::is_none).collect();
    for (index, error) in errors.into_iter().enumerate() {
        if let Some(error) = error {
            problems.push(disagreement(flat, index, error));
        }
    }
    for (index, block) in flat.blocks.iter().enumerate() {
        for (input, source) in typed.interfaces[index].inputs.iter().zip(&block.inputs) {
            if let Some(source) = source {
                check(flat, index, input, source, typed.of(source), problems);
            }
        }
    }
    for declared in &flat.declared {
        declared_unit(flat, declared, typed.of(&declared.source), problems);
    }
    let conditional =
        flat.blocks.iter().enumerate().filter(|(number, block)| agrees[*number] && is_conditional(block));
    typed.asked = conditional.map(|(number, block)| (number, typed.given(block))).collect();
    settle_all(&mut typed.interfaces);
    typed
}

/// What is known while blocks are asked for their interfaces.
struct Inquiry<'f> {
    flat: &'f Flat,
    way: &'f Downstream,
    typed: Typed,
    /// Blocks whose types are known; what a block says before its inputs are known does not count.
    known: Vec<bool>,
    errors: Vec<Option<InterfaceError>>,
    /// Blocks that have to be asked.
    waiting: Vec<bool>,
    /// Blocks that have refused their inputs.
    has_refused: Vec<bool>,
    room: Room,
    answers: Answers,
    types: Vec<Option<PortType>>,
}

impl<'f> Inquiry<'f> {
    fn new(flat: &'f Flat, way: &'f Downstream) -> Self {
        let interfaces: Vec<_> = flat.blocks.iter().map(|block| block.interface.clone()).collect();
        let used = interfaces.iter().map(|interface| memory(interface)).sum();
        let all = flat.blocks.len();
        Self {
            flat,
            way,
            typed: Typed { interfaces, ..Typed::default() },
            known: vec![false; all],
            errors: vec![None; all],
            waiting: vec![true; all],
            has_refused: vec![false; all],
            room: Room { used },
            answers: Answers::default(),
            types: Vec::new(),
        }
    }

    /// Asks a block that waits for it, and has those that read it wait where its answer is a new one.
    fn visit(&mut self, index: usize) {
        if !std::mem::replace(&mut self.waiting[index], false) {
            return;
        }
        let inputs = self.flat.blocks[index].inputs.iter();
        let sources = inputs.map(|source| source.as_ref().filter(|source| self.known[source.block]));
        self.types.clear();
        self.types.extend(sources.map(|source| source.map(|source| self.typed.of(source))));
        let mut answer = self.ask(index);
        self.errors[index] = answer.as_ref().err().cloned();
        if answer.is_err() && !std::mem::replace(&mut self.has_refused[index], true) {
            self.forget_guesses(index);
            answer = self.ask(index);
        }
        let mut changed = !std::mem::replace(&mut self.known[index], true);
        if let Ok(interface) = answer {
            let before = &self.typed.interfaces[index];
            changed = changed || !Arc::ptr_eq(&interface, before) && interface != *before;
            self.typed.interfaces[index] = interface;
        }
        if changed {
            self.way.readers[index].iter().for_each(|reader| self.waiting[*reader] = true);
        }
    }

    fn ask(&mut self, index: usize) -> Result<Arc<Interface>, InterfaceError> {
        let interface = self.answers.ask(&self.flat.blocks[index], &self.types)?;
        self.room.take(&self.typed.interfaces[index], interface)
    }

    /// Leaves out what comes round to a block in a loop.
    fn forget_guesses(&mut self, index: usize) {
        let group_of = &self.way.group_of;
        for (known, source) in self.types.iter_mut().zip(&self.flat.blocks[index].inputs) {
            *known = known
                .filter(|_| source.as_ref().is_some_and(|source| group_of[source.block] != group_of[index]));
        }
    }
}

/// Interfaces of all blocks, and what does not fit.
///
/// Blocks are asked in the order in which signals travel, those of a loop until nothing changes there, and again only when an
/// input has changed: without feedback once. In a loop a type travels at least one block further in each round, so as
/// many rounds as there are blocks suffice for what is known outside, and as many again where a guess was wrong: what comes round
/// is one at first. A block that refuses it gives once what follows from its inputs from outside, which may put the guess right.
fn ask_all(flat: &Flat) -> (Typed, Vec<Option<InterfaceError>>) {
    let way = downstream(flat);
    let mut inquiry = Inquiry::new(flat, &way);
    for group in &way.groups {
        let mut rounds = 2 * group.len() + 2;
        while rounds > 0 && group.iter().any(|block| inquiry.waiting[*block]) {
            group.iter().for_each(|block| inquiry.visit(*block));
            rounds -= 1;
        }
    }
    (inquiry.typed, inquiry.errors)
}

fn is_conditional(block: &FlatBlock) -> bool {
    (&*block.block as &dyn Any).is::<Conditional>()
}

/// An interface, and the types of the inputs that it is for.
type Answer = (Vec<Option<PortType>>, Arc<Interface>);

/// Most answers of a block that are kept.
const MOST_ANSWERS: usize = 8;

/// What blocks have answered: one that stands for several is asked once for the same types of inputs.
#[derive(Default)]
struct Answers {
    known: HashMap<*const (), Vec<Answer>>,
}

impl Answers {
    /// The interface of a block whose inputs have these types, as far as they are known.
    fn ask(
        &mut self,
        block: &FlatBlock,
        types: &[Option<PortType>],
    ) -> Result<Arc<Interface>, InterfaceError> {
        let of_block = self.known.entry(Arc::as_ptr(&block.block).cast()).or_default();
        if let Some((_, interface)) = of_block.iter().find(|(known, _)| known == types) {
            return Ok(Arc::clone(interface));
        }
        let named = block.interface.inputs.iter().zip(types);
        let named = named.filter_map(|(input, port_type)| Some((input.name.clone(), (*port_type)?)));
        let mut interface = block.block.interface(&Given::sharing(named.collect(), block.units.clone()))?;
        if block.plain {
            settle(&mut interface);
        }
        let interface = Arc::new(interface);
        // Where types are many, hardly any comes twice.
        if of_block.len() == MOST_ANSWERS {
            of_block.clear();
        }
        of_block.push((types.to_vec(), Arc::clone(&interface)));
        Ok(interface)
    }
}

/// Most elements of a signal.
const MOST_ELEMENTS: usize = 1 << 20;

/// Numbers that all blocks remember together.
struct Room {
    used: usize,
}

impl Room {
    /// The interface `new` in the place of `old`, if its signals and memories are not too large: lengths multiply from block to
    /// block, so a short text may ask for any number.
    fn take(&mut self, old: &Interface, new: Arc<Interface>) -> Result<Arc<Interface>, InterfaceError> {
        let too_large = |message: String| {
            let help = Some("make signals of fewer elements, or delay fewer samples".to_owned());
            Err(InterfaceError { code: "too_large", ports: Vec::new(), message, help })
        };
        if let Some(long) = new.outputs.iter().find(|output| output.port_type.shape.len() > MOST_ELEMENTS) {
            let n = long.port_type.shape.len();
            let message = format!("`{}` has {n} elements, more than {MOST_ELEMENTS}", long.name);
            return too_large(message);
        }
        let used = (self.used + memory(&new)).saturating_sub(memory(old));
        if used > MOST_MEMORY {
            return too_large(format!("this model remembers more than {MOST_MEMORY} numbers"));
        }
        self.used = used;
        Ok(new)
    }
}

/// States of a block, sampled and remembered ones included.
fn memory(interface: &Interface) -> usize {
    interface.states.len() + interface.discrete.len()
}

/// What is left open has the dimension that it was given last; or none, where that may be anything.
fn settle(interface: &mut Interface) {
    let inputs = interface.inputs.iter_mut().map(|input| &mut input.dimension);
    let outputs = interface.outputs.iter_mut().map(|output| &mut output.port_type.dimension);
    inputs.chain(outputs).for_each(|dimension| *dimension = dimension.and_then(Dimension::settled));
}

/// The same for all blocks, of which many have one interface in common.
fn settle_all(interfaces: &mut [Arc<Interface>]) {
    // Those that were are kept, so that no other one comes to lie where they are.
    let mut settled: HashMap<*const Interface, [Arc<Interface>; 2]> = HashMap::default();
    for interface in interfaces.iter_mut().filter(|interface| !is_settled(interface)) {
        match Arc::get_mut(interface) {
            Some(own) => settle(own),
            None => {
                let both = settled.entry(Arc::as_ptr(interface)).or_insert_with(|| {
                    let mut new = Interface::clone(interface);
                    settle(&mut new);
                    [Arc::clone(interface), Arc::new(new)]
                });
                *interface = Arc::clone(&both[1]);
            }
        }
    }
}

fn is_settled(interface: &Interface) -> bool {
    let inputs = interface.inputs.iter().map(|input| input.dimension);
    let outputs = interface.outputs.iter().map(|output| output.port_type.dimension);
    inputs.chain(outputs).flatten().all(|dimension| dimension.settled() == Some(dimension))
}

/// Which way signals travel.
struct Downstream {
    /// The blocks of each loop, by their index, and each block that is in none; in the order in which signals travel.
    groups: Vec<Vec<usize>>,
    /// The group of each block.
    group_of: Vec<usize>,
    /// The blocks that read each block.
    readers: Vec<Vec<usize>>,
}

fn downstream(flat: &Flat) -> Downstream {
    let mut graph: DiGraph<(), ()> = DiGraph::with_capacity(flat.blocks.len(), flat.blocks.len());
    flat.blocks.iter().for_each(|_| {
        graph.add_node(());
    });
    let mut readers = vec![Vec::new(); flat.blocks.len()];
    for (index, block) in flat.blocks.iter().enumerate() {
        for source in block.inputs.iter().flatten() {
            graph.add_edge(NodeIndex::new(source.block), NodeIndex::new(index), ());
            readers[source.block].push(index);
        }
    }
    let mut group_of = vec![0; flat.blocks.len()];
    let mut groups = Vec::with_capacity(flat.blocks.len());
    for component in kosaraju_scc(&graph).into_iter().rev() {
        let mut group: Vec<usize> = component.into_iter().map(NodeIndex::index).collect();
        group.sort_unstable();
        group.iter().for_each(|block| group_of[*block] = groups.len());
        groups.push(group);
    }
    Downstream { groups, group_of, readers }
}

/// The unit that a subsystem declares for an input must be that of the signal.
fn declared_unit(flat: &Flat, declared: &Declared, found: PortType, problems: &mut Problems) {
    let Some(dimension) = found.dimension.filter(|dimension| !declared.dimension.compatible(*dimension))
    else {
        return;
    };
    let from = &flat.blocks[declared.source.block].output_names[declared.source.output];
    let has = if dimension.is_none() { "has no unit".to_owned() } else { format!("is in {dimension}") };
    problems.push(
        Problem::error(
            "unit_mismatch",
            format!("`{}` is in {}, but `{from}` {has}", declared.name, declared.dimension),
        )
        .at(&declared.source.place, has)
        .at(&declared.place, format!("declared in {}", declared.dimension))
        .help("correct the unit where the signal arises, or the one that the subsystem declares"),
    );
}

/// A block says that its inputs do not fit each other.
fn disagreement(flat: &Flat, index: usize, error: InterfaceError) -> Problem {
    let block = &flat.blocks[index];
    let mut problem = Problem::error(error.code, format!("in `{}`: {}", block.path, error.message));
    let mut placed = false;
    for port in &error.ports {
        let input = block.interface.inputs.iter().position(|input| input.name == *port);
        if let Some(source) = input.and_then(|input| block.inputs[input].as_ref()) {
            problem = problem.at(&source.target, format!("`{port}` comes from here"));
            placed = true;
        }
    }
    if let Some(place) = &block.place
        && (!placed || error.ports.len() < 2)
    {
        problem = problem.at(place, a(&block.kind));
    }
    match error.help {
        Some(help) => problem.help(help),
        None => problem,
    }
}

fn check(
    flat: &Flat,
    index: usize,
    input: &blocksim_block::Input,
    source: &Source,
    found: PortType,
    problems: &mut Problems,
) {
    let block = &flat.blocks[index];
    let from = &flat.blocks[source.block].output_names[source.output];
    let to = || match block.kind == "Network" {
        true => input.name.clone(),
        false => format!("{}.{}", block.path, input.name),
    };
    let (a, b): (&Place, &Place) = (&source.place, &source.target);
    if let Some(kind) = input.kind {
        let fits = kind == found.kind || (kind == Kind::Real && found.kind == Kind::Int);
        if !fits {
            let help = match (found.kind, kind) {
                (Kind::Bool, _) => "Convert makes a number of a truth value",
                (_, Kind::Bool) => "Compare makes a truth value of a number",
                _ => "Convert changes the kind of a signal",
            };
            problems.push(
                Problem::error(
                    "type_mismatch",
                    format!("`{}` takes a {kind} signal, but `{from}` is {}", to(), found.kind),
                )
                .at(a, format!("{}", found.kind))
                .at(b, format!("takes {kind}"))
                .help(help),
            );
        }
    }
    if let Some(shape) = input.shape
        && shape != found.shape
    {
        let help = match found.shape {
            blocksim_signal::Shape::Vector(_) => "take one element with Selector, or several with Demux",
            _ => "put signals together with Mux",
        };
        problems.push(
            Problem::error(
                "type_mismatch",
                format!("`{}` takes a {shape}, but `{from}` is a {}", to(), found.shape),
            )
            .at(a, format!("a {}", found.shape))
            .at(b, format!("takes a {shape}"))
            .help(help),
        );
    }
    if let (Some(wanted), Some(dimension)) = (input.dimension, found.dimension)
        && !wanted.compatible(dimension)
    {
        let has = if dimension.is_none() { "has no unit".to_owned() } else { format!("is in {dimension}") };
        problems.push(
            Problem::error("unit_mismatch", format!("`{}` is in {wanted}, but `{from}` {has}", to()))
                .at(a, has)
                .at(b, format!("takes {wanted}"))
                .help(format!(
                    "correct the unit at the source of the signal, or insert `Gain(k: \"{}\")`, which gives a value in {wanted}",
                    wanted.factor_from(dimension)
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toys::{flat, messages};
    use blocksim_signal::Shape;

    fn shapes(flat: &Flat) -> Vec<Shape> {
        let mut problems = Problems::default();
        let typed = infer(flat, &mut problems);
        assert_eq!(messages(&problems), Vec::<String>::new());
        typed.interfaces.iter().map(|interface| interface.outputs[0].port_type.shape).collect()
    }

    #[test]
    fn a_shape_travels_against_the_order_of_names() {
        let flat = flat("\"a\": Gain, \"b\": Gain, \"c\": Constant(n: 3)", "\"c.y -> b.u\", \"b.y -> a.u\"");
        assert_eq!(shapes(&flat), [Shape::Vector(3); 3]);
    }

    #[test]
    fn a_shape_travels_through_a_feedback_loop() {
        let blocks = "\"a\": State, \"b\": Gain, \"sum\": Sum, \"z\": Constant(n: 2)";
        let flat = flat(blocks, "\"z.y -> sum.u\", \"a.y -> sum.v\", \"sum.y -> b.u\", \"b.y -> a.u\"");
        assert_eq!(shapes(&flat), [Shape::Vector(2); 4]);
    }

    /// `b` gives a matrix until it knows its input, and a vector for a vector.
    #[test]
    fn a_guess_in_a_loop_that_is_refused_is_put_right_from_outside() {
        for state in ["State", "Gain"] {
            let blocks = format!("\"a\": {state}, \"b\": Columns(n: 2), \"sum\": Sum, \"z\": Constant(n: 2)");
            let flat = flat(&blocks, "\"z.y -> sum.u\", \"b.y -> sum.v\", \"sum.y -> a.u\", \"a.y -> b.u\"");
            assert_eq!(shapes(&flat), [Shape::Vector(2); 4]);
        }
    }

    /// What does not fit in the end is refused, and is looked for no longer than anything else.
    #[test]
    fn a_loop_in_which_nothing_fits_is_refused() {
        let blocks = "\"a\": State, \"b\": Columns(n: 3), \"sum\": Sum, \"z\": Constant(n: 2)";
        let mut problems = Problems::default();
        infer(
            &flat(blocks, "\"z.y -> sum.u\", \"b.y -> sum.v\", \"sum.y -> a.u\", \"a.y -> b.u\""),
            &mut problems,
        );
        assert!(
            messages(&problems).iter().any(|message| message.starts_with("in `b`: ")),
            "{:?}",
            messages(&problems)
        );
    }

    #[test]
    fn inputs_that_do_not_fit_each_other_are_named() {
        let blocks = "\"a\": Constant(n: 2), \"b\": Constant(n: 3), \"sum\": Sum";
        let mut problems = Problems::default();
        infer(&flat(blocks, "\"a.y -> sum.u\", \"b.y -> sum.v\""), &mut problems);
        assert_eq!(messages(&problems).len(), 1);
        assert!(messages(&problems)[0].starts_with("in `sum`: `v` is a"), "{:?}", messages(&problems));
    }
}
