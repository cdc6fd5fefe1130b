//! A module in a store of its own, with limits of memory and work.

use std::fmt;
use std::sync::OnceLock;

use blocksim_abi::{OK, PANICKED, SYMBOL, Status, message};
use wasmi::errors::{ErrorKind, InstantiationError};
use wasmi::{
    CompilationMode, Config, Engine, Error, Extern, Func, Memory, Module, Nullable, Ref, Store, StoreLimits,
    StoreLimitsBuilder, Table, TrapCode, TypedFunc,
};

use super::layout::{Indices, MESSAGE_SIZE};
use crate::call::Failure;
use crate::guard::{Frame, MESSAGE_BYTES, PATTERN, TEXT_BYTES, broken_rule, is_moving};
use crate::isolate::Op;

/// Most bytes of the memory of an instance.
pub const MOST_MEMORY: usize = 64 << 20;
/// Most functions that addresses may be taken of.
const MOST_FUNCTIONS: usize = 1 << 16;
/// Instructions for a call of a run.
const WORK: u64 = 1_000_000_000;
/// Instructions for what is also called to look at a diagram: the start of an instance, `check`, `sample_time`.
const WORK_TO_LOOK: u64 = 50_000_000;
/// Bytes of a page of a memory.
const PAGE: usize = 1 << 16;
/// Frames that calls take in turn where each call is to have buffers at other places.
const FRAMES: usize = 4;
/// What a module calls its memory, and the table that its function pointers are indices into.
const MEMORY: &str = "memory";
const TABLE: &str = "__indirect_function_table";
/// Functions that run the initialisers of a module, of which compilers export one or none.
const INITIALISERS: [&str; 2] = ["_initialize", "__wasm_call_ctors"];

/// What an instance may have. A memory that asks for more stops the function, as few allocators say what was missing.
fn limits() -> StoreLimits {
    StoreLimitsBuilder::new()
        .memory_size(MOST_MEMORY)
        .table_elements(MOST_FUNCTIONS)
        .instances(1)
        .memories(1)
        // It may have tables of its own that nobody else sees.
        .tables(4)
        .trap_on_grow_failure(true)
        .build()
}

/// The interpreter. Functions are translated when a module is loaded, so that the work of a call is the same each time.
pub fn engine() -> &'static Engine {
    static ENGINE: OnceLock<Engine> = OnceLock::new();
    ENGINE.get_or_init(|| {
        let mut config = Config::default();
        config.consume_fuel(true).compilation_mode(CompilationMode::Eager).ignore_custom_sections(true);
        config.wasm_custom_page_sizes(false).wasm_multi_memory(false);
        Engine::new(&config)
    })
}

type Evaluation = TypedFunc<(i32, f64, i32, i32, i32, i32, i32), i32>;

/// The functions of a block.
#[derive(Debug, Default)]
struct Bound {
    check: Option<TypedFunc<(i32, i32), i32>>,
    sample_time: Option<TypedFunc<(i32, i32, i32), i32>>,
    reset: Option<TypedFunc<(i32, i32, i32, i32), i32>>,
    outputs: Option<Evaluation>,
    update: Option<Evaluation>,
    derivatives: Option<Evaluation>,
}

impl Bound {
    fn has(&self, op: Op) -> bool {
        match op {
            Op::Check => self.check.is_some(),
            Op::SampleTime => self.sample_time.is_some(),
            Op::Reset => self.reset.is_some(),
            Op::Outputs => self.outputs.is_some(),
            Op::Update => self.update.is_some(),
            Op::Derivatives => self.derivatives.is_some(),
        }
    }
}

/// A module that runs.
pub struct Instance {
    store: Store<StoreLimits>,
    memory: Memory,
    table: Option<Table>,
    /// Where the module says that its table of blocks is.
    address: u32,
    blocks: Vec<Bound>,
    /// Where frames begin, bytes of each, how many there are, and how many calls there were.
    frames: u32,
    frame_bytes: usize,
    frame_count: usize,
    calls: usize,
    /// Whether a function did not return: nothing is known of the memory then.
    is_spent: bool,
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Instance").field("address", &self.address).finish_non_exhaustive()
    }
}

/// Why a module cannot be started.
#[derive(Debug)]
pub enum Unfit {
    /// It is not a plug-in at all; what to do about it.
    Foreign(String, &'static str),
    /// It breaks a rule.
    Broken(String),
}

impl Instance {
    /// Starts a module and asks it for its table.
    ///
    /// # Errors
    /// It wants imports, has no memory or not the function of a plug-in, wants too much, or does not return.
    pub fn start(module: &Module) -> Result<Instance, Unfit> {
        if let Some(import) = module.imports().next() {
            // Names may be as long as the file.
            let name: String = format!("{}.{}", import.module(), import.name()).chars().take(80).collect();
            return Err(Unfit::Foreign(
                format!("it wants the import `{name}`, but modules are given none"),
                "build it for `wasm32-unknown-unknown`, and link what it calls into it",
            ));
        }
        let mut store = Store::new(engine(), limits());
        store.limiter(|limits| limits);
        add_fuel(&mut store, WORK_TO_LOOK);
        let started = wasmi::Instance::new(&mut store, module, &[]);
        let instance =
            started.map_err(|error| Unfit::Broken(unfinished(&error, WORK_TO_LOOK, "its start")))?;
        let Some(entry) = instance.get_func(&store, SYMBOL) else {
            return Err(Unfit::Foreign(
                format!("it does not export `{SYMBOL}`"),
                "in Rust, write `export_plugin!(\"name\", [Controller]);` and build a `cdylib`; in C, define `blocksim_plugin_v1`",
            ));
        };
        let Some(memory) = instance.get_memory(&store, MEMORY) else {
            return Err(Unfit::Foreign(format!("it does not export its memory as `{MEMORY}`"), "export it"));
        };
        for name in INITIALISERS {
            if let Some(initialiser) = instance.get_func(&store, name) {
                run(&mut store, name, initialiser)?;
                break;
            }
        }
        let address = run(&mut store, SYMBOL, entry)?;
        let table = instance.get_export(&store, TABLE).and_then(Extern::into_table);
        Ok(Instance {
            store,
            memory,
            table,
            address,
            blocks: Vec::new(),
            frames: 0,
            frame_bytes: 0,
            frame_count: 0,
            calls: 0,
            is_spent: false,
        })
    }

    /// Where its table of blocks is.
    pub fn address(&self) -> u32 {
        self.address
    }

    /// Its memory.
    pub fn memory(&self) -> &[u8] {
        self.memory.data(&self.store)
    }

    /// Whether it must not be called any more.
    pub fn is_spent(&self) -> bool {
        self.is_spent
    }

    /// Finds the functions of all blocks, and makes room for calls with so many words.
    ///
    /// # Errors
    /// Which function is not there or of another type, or that the memory cannot grow.
    pub fn prepare(
        &mut self,
        names: &[&'static str],
        functions: &[Indices],
        words: usize,
    ) -> Result<(), Unfit> {
        let needs_table = functions.iter().flatten().any(|index| *index != 0);
        if needs_table && self.table.is_none() {
            return Err(Unfit::Foreign(
                format!("it does not export its table of functions as `{TABLE}`"),
                "link it with `--export-table`, in Rust: `cargo rustc --release --target wasm32-unknown-unknown -- -C link-arg=--export-table`",
            ));
        }
        self.blocks = functions
            .iter()
            .zip(names)
            .map(|(indices, name)| self.bound(indices, name))
            .collect::<Result<_, _>>()?;
        self.frame_count = if is_moving() { FRAMES } else { 1 };
        self.frame_bytes = (8 * words + TEXT_BYTES + MESSAGE_SIZE).next_multiple_of(8);
        let bytes = self.frame_bytes * self.frame_count;
        let before = self.memory.data_size(&self.store);
        add_fuel(&mut self.store, WORK_TO_LOOK);
        let grown = self.memory.grow(&mut self.store, bytes.div_ceil(PAGE) as u64);
        if grown.is_err() {
            return Err(Unfit::Broken(format!(
                "its memory cannot grow from {before} bytes by {bytes} bytes for buffers; link it without a maximum, modules may have {} MB",
                MOST_MEMORY >> 20
            )));
        }
        // A memory is at most `MOST_MEMORY` long.
        self.frames = before as u32;
        let pattern = PATTERN.to_le_bytes();
        self.memory.data_mut(&mut self.store)[before..].as_chunks_mut::<8>().0.fill(pattern);
        Ok(())
    }

    fn bound(&self, indices: &Indices, name: &str) -> Result<Bound, Unfit> {
        let [check, sample_time, reset, outputs, update, derivatives] = *indices;
        Ok(Bound {
            check: self.function(check, name, "check")?,
            sample_time: self.function(sample_time, name, "sample_time")?,
            reset: self.function(reset, name, "reset")?,
            outputs: self.function(outputs, name, "outputs")?,
            update: self.function(update, name, "update")?,
            derivatives: self.function(derivatives, name, "derivatives")?,
        })
    }

    /// A function by its index, with the type that it must have; `None` for the index 0, which is NULL.
    fn function<P: wasmi::WasmParams>(
        &self,
        index: u32,
        block: &str,
        what: &str,
    ) -> Result<Option<TypedFunc<P, i32>>, Unfit> {
        let Some(table) = self.table.filter(|_| index != 0) else { return Ok(None) };
        let broken = |reason: &str| Err(Unfit::Broken(format!("`{what}` of `{block}` {reason}")));
        match table.get(&self.store, u64::from(index)) {
            None => broken(&format!("is function {index}, but there are {}", table.size(&self.store))),
            Some(Ref::Func(Nullable::Val(function))) => match function.typed(&self.store) {
                Ok(function) => Ok(Some(function)),
                Err(_) => {
                    broken(&format!("is function {index}, which has other arguments or results than it must"))
                }
            },
            Some(_) => broken(&format!("is function {index}, which is NULL")),
        }
    }

    /// Calls a function of a block with what is in the frame, and leaves there what it wrote.
    ///
    /// # Errors
    /// Why it did not return.
    pub fn perform(&mut self, block: usize, op: Op, t: f64, frame: &mut Frame) -> Result<Status, Failure> {
        if !self.blocks.get(block).is_some_and(|bound| bound.has(op)) {
            return Ok(OK);
        }
        if self.frame_count > 1 && self.is_old_written() {
            return Err(broken_rule("it wrote to a buffer of an earlier call"));
        }
        let begin = self.frames as usize + self.frame_bytes * (self.calls % self.frame_count);
        self.calls += 1;
        let place = begin..begin + self.frame_bytes;
        let text = begin + 8 * frame.words.len();
        let message = text + TEXT_BYTES;
        write(&mut self.memory.data_mut(&mut self.store)[place.clone()], frame, text as u32);
        let work = if matches!(op, Op::Check | Op::SampleTime) { WORK_TO_LOOK } else { WORK };
        add_fuel(&mut self.store, work);
        let outcome = self.call(block, op, t, frame, begin, message as i32);
        let bytes = &mut self.memory.data_mut(&mut self.store)[place];
        read(bytes, frame);
        if self.frame_count > 1 {
            bytes.as_chunks_mut::<8>().0.fill(PATTERN.to_le_bytes());
        }
        outcome.map_err(|error| {
            self.is_spent = true;
            let text = message::written(&frame.text[..MESSAGE_BYTES]);
            // Without unwinding, a panic writes its text and stops.
            if error.as_trap_code() == Some(TrapCode::UnreachableCodeReached) && !text.is_empty() {
                return Failure { status: PANICKED, text: text.to_owned() };
            }
            let reason = unfinished(&error, work, &format!("`{}`", op.name()));
            Failure { status: OK, text: format!("the plug-in stopped: {reason}") }
        })
    }

    fn call(
        &mut self,
        block: usize,
        op: Op,
        t: f64,
        frame: &Frame,
        begin: usize,
        m: i32,
    ) -> Result<Status, Error> {
        let place = |word: Option<usize>| word.map_or(0, |word| (begin + 8 * word) as i32);
        let [params, x, xd, u] = frame.given.map(place);
        let [first, second] = frame.wanted.map(place);
        let (store, bound) = (&mut self.store, &self.blocks[block]);
        let evaluation = match op {
            Op::Check => return bound.check.map_or(Ok(OK), |check| check.call(store, (params, m))),
            Op::SampleTime => {
                return bound
                    .sample_time
                    .map_or(Ok(OK), |sample_time| sample_time.call(store, (params, first, m)));
            }
            Op::Reset => {
                return bound.reset.map_or(Ok(OK), |reset| reset.call(store, (params, first, second, m)));
            }
            Op::Outputs => bound.outputs,
            Op::Update => bound.update,
            Op::Derivatives => bound.derivatives,
        };
        evaluation.map_or(Ok(OK), |function| function.call(store, (params, t, x, xd, u, first, m)))
    }

    /// Whether a frame of an earlier call was written after that call.
    fn is_old_written(&self) -> bool {
        let begin = self.frames as usize;
        let frames = &self.memory()[begin..begin + self.frame_bytes * self.frame_count];
        frames.as_chunks::<8>().0.iter().any(|word| *word != PATTERN.to_le_bytes())
    }
}

/// Calls a function without arguments; gives the address that it returns, 0 if it returns nothing.
fn run(store: &mut Store<StoreLimits>, name: &str, function: Func) -> Result<u32, Unfit> {
    let outcome = if let Ok(function) = function.typed::<(), ()>(&*store) {
        function.call(&mut *store, ()).map(|()| 0)
    } else if let Ok(function) = function.typed::<(), i32>(&*store) {
        function.call(&mut *store, ()).map(i32::cast_unsigned)
    } else {
        return Err(Unfit::Broken(format!("`{name}` takes arguments, or does not return an address")));
    };
    outcome.map_err(|error| Unfit::Broken(unfinished(&error, WORK_TO_LOOK, &format!("`{name}`"))))
}

/// Puts a frame into a memory; `text` is the address that its message will have.
fn write(bytes: &mut [u8], frame: &Frame, text: u32) {
    let (words, rest) = bytes.split_at_mut(8 * frame.words.len());
    words
        .as_chunks_mut::<8>()
        .0
        .iter_mut()
        .zip(&*frame.words)
        .for_each(|(to, word)| *to = word.to_le_bytes());
    let (to, rest) = rest.split_at_mut(TEXT_BYTES);
    to.copy_from_slice(&frame.text[..]);
    let message = [MESSAGE_SIZE as u32, MESSAGE_BYTES as u32, text];
    rest.as_chunks_mut::<4>().0.iter_mut().zip(message).for_each(|(to, word)| *to = word.to_le_bytes());
}

/// Takes a frame out of a memory.
fn read(bytes: &[u8], frame: &mut Frame) {
    let (words, rest) = bytes.split_at(8 * frame.words.len());
    frame
        .words
        .iter_mut()
        .zip(words.as_chunks::<8>().0)
        .for_each(|(to, word)| *to = u64::from_le_bytes(*word));
    frame.text.copy_from_slice(&rest[..TEXT_BYTES]);
}

fn add_fuel(store: &mut Store<StoreLimits>, fuel: u64) {
    // It fails where an engine does not count the work; ours does.
    let _ = store.set_fuel(fuel);
}

/// Why a function, or a start, did not come to its end.
fn unfinished(error: &Error, work: u64, what: &str) -> String {
    let more_memory =
        || format!("{what} requested more memory than the {} MB that a module may have", MOST_MEMORY >> 20);
    let reason = match (error.as_trap_code(), error.kind()) {
        (_, ErrorKind::Instantiation(InstantiationError::FailedToInstantiateMemory(_))) => {
            return more_memory();
        }
        (_, ErrorKind::Instantiation(InstantiationError::FailedToInstantiateTable(_))) => {
            return format!(
                "{what} requested a table of more than the {MOST_FUNCTIONS} functions that a module may have"
            );
        }
        (None, _) => return format!("{what} failed: {error}"),
        (Some(TrapCode::GrowthOperationLimited), _) => return more_memory(),
        (Some(TrapCode::OutOfFuel), _) => {
            let millions = work / 1_000_000;
            return format!(
                "{what} did not return within {millions} million instructions: a loop without end?"
            );
        }
        (Some(TrapCode::UnreachableCodeReached), _) => {
            "reached an `unreachable` instruction: a panic, or `abort`"
        }
        (Some(TrapCode::MemoryOutOfBounds), _) => "touched an address outside of its memory",
        (Some(TrapCode::TableOutOfBounds), _) => {
            "called a function pointer outside of its table of functions"
        }
        (Some(TrapCode::IndirectCallToNull), _) => "called a NULL function pointer",
        (Some(TrapCode::BadSignature), _) => "called a function pointer of another type",
        (Some(TrapCode::IntegerDivisionByZero), _) => "divided an integer by zero",
        (Some(TrapCode::IntegerOverflow), _) => {
            "overflowed in a division of integers or a conversion to an integer"
        }
        (Some(TrapCode::BadConversionToInteger), _) => "converted a number to an integer that cannot hold it",
        (Some(TrapCode::StackOverflow), _) => "overflowed its stack: a recursion without end?",
        (Some(TrapCode::OutOfSystemMemory), _) => "found no memory left on this computer",
    };
    format!("{what} {reason}")
}
