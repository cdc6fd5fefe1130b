//! The table of a controller plug-in, version 1.
//!
//! WHO OWNS WHAT
//!   The plug-in owns its tables and texts: constant, valid from loading to the end of the process.
//!   The host owns all numbers: parameters, signals, states, results, and the message buffer. The plug-in
//!   may touch them during a call only and keeps no pointer to them.
//!   The plug-in owns no state at all. Same arguments, same bits: no globals, no clock, no files, no
//!   random numbers. Rejected steps, saving, rewinding and parallel runs then work by themselves.
//!
//! WHAT A BUFFER HOLDS
//!   Numbers are f64 and always SI. A buffer holds the quantities of its list one after the other, vectors
//!   in place: after a scalar and a vector of 3, the next quantity begins at index 4. The length of a
//!   buffer is thus the sum of the lengths in its list; the pointer of an empty buffer may be NULL.
//!   Buffers of one call never overlap.
//!
//! PHASES, stated for each function
//!   load    the library was opened, the tables are read
//!   build   a diagram is compiled: the parameters are known
//!   start   a run begins
//!   run     the run goes on
//!   Functions may be called on any thread, and on several threads at once with different buffers.
//!   None may block; in `run` none should allocate.
//!
//! HOW IT GROWS
//!   Each struct but `text` begins with its own size in bytes as its author compiled it. New fields are
//!   added at the end only, with a higher minor version; a reader takes `size` bytes at most and treats
//!   the rest as zero. In an array, the size of the first element is the distance between elements.
//!   A change of any other kind gets a new major version and a new symbol.

use core::ffi::c_char;

/// The function that a library exports: see `entry_fn`.
pub const SYMBOL: &str = "blocksim_plugin_v1";

/// In every plug-in table, so that another library with such a symbol is not taken for a plug-in.
pub const MAGIC: [u8; 8] = *b"BLKSIMP1";

/// Compatibility: the host refuses another major version.
pub const ABI_MAJOR: u16 = 1;

/// Fields known: the host takes lower and higher minor versions.
pub const ABI_MINOR: u16 = 0;

/// The most input ports a block can have, as `reads` has a bit for each.
pub const MAX_INPUTS: u32 = 64;

/// What a function reports. The host treats any number it does not know as an error.
pub type Status = i32;

/// Done; all results are written.
pub const OK: Status = 0;

/// Refused or failed for a reason that is in the message. Results are not used; the run ends with the
/// path of the block, the time and the message.
pub const ERROR: Status = 1;

/// A bug in the plug-in was caught at the border; the message says what is known. No exception, panic
/// or longjmp may leave a function of a plug-in.
pub const PANICKED: Status = 2;

/// UTF-8 text of the plug-in: `length` bytes, no NUL needed. Empty: length 0, data may be NULL.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Text {
    /// First byte; constant for the life of the process.
    pub data: *const c_char,
    /// Number of bytes.
    pub length: usize,
}

/// Where a function may say why it failed. The host owns it; it is empty text at the call.
/// A plug-in that fails writes UTF-8 with a NUL behind, cut to fit between two characters.
/// It writes nothing when it is given a NULL `message`, NULL `text` or capacity 0.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Message {
    /// Size of this struct as the host was compiled.
    pub size: u32,
    /// Bytes at `text`, the NUL included.
    pub capacity: u32,
    /// The buffer.
    pub text: *mut c_char,
}

/// A named number or vector: a parameter, a port or a state.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Quantity {
    /// Size of this struct as the plug-in was compiled.
    pub size: u32,
    /// 1: a number; n > 1: a vector of n numbers. Never 0.
    pub length: u32,
    /// As written in diagrams: a letter, then letters, digits and underscores; unique in its list.
    pub name: Text,
    /// An SI unit as written in diagrams, as "rad/s"; "1": dimensionless; "": whatever comes, unchecked.
    pub unit: Text,
    /// One or two sentences for the manual, Markdown.
    pub doc: Text,
    /// `length` numbers, or NULL.
    /// Parameter: its default; NULL: the diagram must give it.
    /// Input: its value when it is not connected; NULL: it must be connected.
    /// State: its value before `reset` is called; NULL: zeros.
    /// Output: NULL.
    pub default_value: *const f64,
    /// Outputs: bit i is set if the output at time t depends on input i at the same t (direct
    /// feedthrough). It decides the order of blocks and what counts as an algebraic loop.
    /// 0 in all other lists.
    pub reads: u64,
}

/// Are these parameters possible? The message names the parameter and the limits.
/// [build; once per instance, before any other function]
/// NULL function: all parameters are fine.
pub type CheckFn = unsafe extern "C" fn(params: *const f64, message: *const Message) -> Status;

/// Writes the sample time in seconds. [build; after `check` said OK]
/// 0: continuous. `outputs` is evaluated whenever time or an input changes; `update` is never called.
/// Positive: sampled at the start and every `period` after it. At a hit `outputs` is called, then
/// `update`; in between the outputs are held. Such a block has no continuous states.
/// Negative, infinite or not a number: the host refuses the block.
/// NULL function: continuous.
pub type SampleTimeFn =
    unsafe extern "C" fn(params: *const f64, period: *mut f64, message: *const Message) -> Status;

/// Writes the states at the start. [start; once per run]
/// `x` and `xd` hold the default values of the lists at the call: states not written keep them.
/// NULL function: the default values are the start.
pub type ResetFn =
    unsafe extern "C" fn(params: *const f64, x: *mut f64, xd: *mut f64, message: *const Message) -> Status;

/// y = h(t, x, xd, u): writes every element of `y`. [start and run; any number of times per instant]
/// The host asks as soon as the inputs that the wanted output reads are known; other inputs may then
/// hold older or arbitrary numbers, and the outputs that read them are asked for again later. A function
/// must therefore not fail over an input, not a number included, that only another output reads.
/// Steps may be tried and rejected: time may go back between calls.
/// NULL function: allowed for a block without outputs.
pub type OutputsFn = unsafe extern "C" fn(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    y: *mut f64,
    message: *const Message,
) -> Status;

/// xd(k+1) = g(t, x, xd(k), u) at a sample hit, after `outputs` of the same hit. [run; once per hit]
/// `xd_next` holds a copy of `xd` at the call: states not written stay. The host takes it over when all
/// blocks of the hit are done, and drops it after a failure.
/// NULL function: the discrete states never change.
pub type UpdateFn = unsafe extern "C" fn(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    xd_next: *mut f64,
    message: *const Message,
) -> Status;

/// dx/dt = f(t, x, xd, u): writes every element of `dx`, per second. [run; several times per step]
/// Steps may be tried and rejected: time may go back between calls.
/// NULL function: allowed for a block without continuous states.
pub type DerivativesFn = unsafe extern "C" fn(
    params: *const f64,
    t: f64,
    x: *const f64,
    xd: *const f64,
    u: *const f64,
    dx: *mut f64,
    message: *const Message,
) -> Status;

/// One block kind of a plug-in: what it looks like from outside, and its functions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BlockTable {
    /// Size of this struct as the plug-in was compiled.
    pub size: u32,
    /// Elements at `parameters`.
    pub parameter_count: u32,
    /// Elements at `input_ports`; at most `MAX_INPUTS`.
    pub input_count: u32,
    /// Elements at `output_ports`.
    pub output_count: u32,
    /// Elements at `continuous_states`.
    pub continuous_count: u32,
    /// Elements at `discrete_states`.
    pub discrete_count: u32,
    /// The name in diagrams, as "Cascade"; unique in the plug-in.
    pub kind: Text,
    /// The page of the manual, Markdown: law first.
    pub doc: Text,
    /// What `params` holds. The pointer of an empty list may be NULL, here and below.
    pub parameters: *const Quantity,
    /// What `u` holds.
    pub input_ports: *const Quantity,
    /// What `y` holds.
    pub output_ports: *const Quantity,
    /// What `x` and `dx` hold.
    pub continuous_states: *const Quantity,
    /// What `xd` and `xd_next` hold.
    pub discrete_states: *const Quantity,
    /// See `check_fn`.
    pub check: Option<CheckFn>,
    /// See `sample_time_fn`.
    pub sample_time: Option<SampleTimeFn>,
    /// See `reset_fn`.
    pub reset: Option<ResetFn>,
    /// See `outputs_fn`.
    pub outputs: Option<OutputsFn>,
    /// See `update_fn`.
    pub update: Option<UpdateFn>,
    /// See `derivatives_fn`.
    pub derivatives: Option<DerivativesFn>,
}

/// What the exported function returns.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct PluginTable {
    /// Size of this struct as the plug-in was compiled.
    pub size: u32,
    /// `ABI_MAJOR` as the plug-in was compiled.
    pub abi_major: u16,
    /// `ABI_MINOR` as the plug-in was compiled.
    pub abi_minor: u16,
    /// `MAGIC`.
    pub magic: [u8; 8],
    /// Name of the plug-in, for messages.
    pub name: Text,
    /// Its own version, for messages and the manifest of a run.
    pub version: Text,
    /// The block kinds.
    pub blocks: *const BlockTable,
    /// Elements at `blocks`.
    pub block_count: u32,
    /// Zero.
    pub reserved: u32,
}

/// The type of the exported function. It returns the same constant table at each call, or NULL if it has
/// none. A function rather than a variable, as every linker exports functions in the same way.
/// [load; any thread]
pub type EntryFn = unsafe extern "C" fn() -> *const PluginTable;

// SAFETY: tables and texts are constants; the contract above says that nobody writes to them.
unsafe impl Sync for Text {}
// SAFETY: as above.
unsafe impl Sync for Quantity {}
// SAFETY: as above.
unsafe impl Sync for BlockTable {}
// SAFETY: as above.
unsafe impl Sync for PluginTable {}
// SAFETY: as above; reading them from another thread is as good as sharing them.
unsafe impl Send for Text {}
// SAFETY: as above.
unsafe impl Send for Quantity {}
// SAFETY: as above.
unsafe impl Send for BlockTable {}
// SAFETY: as above.
unsafe impl Send for PluginTable {}
