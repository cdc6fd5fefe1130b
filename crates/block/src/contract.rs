//! What a block must be able to say and do.

use crate::problem::Problem;
use std::any::Any;
use std::fmt::Debug;
use std::path::Path;

use crate::law::{Failure, Recording};
use crate::physical::Component;
use crate::{CodePolicy, Context, Given, Interface, InterfaceError, Invariant, NoCode, Piece};

/// A block: parameters and pure functions.
///
/// A block holds no mutable state. Continuous states `x`, discrete states `d` (sampled states, modes, memories)
/// and scratch space `w` live in buffers that the engine owns, so a rejected step, a copy of a simulation or a
/// restart costs a block nothing.
///
/// The engine calls the functions in this order at an accepted time (a *major step*): `settle` and `outputs` of
/// all blocks in schedule order, then `jump` (repeated while something jumps), then `update` of the blocks whose
/// sample time is hit. Between two major steps it calls `outputs` and `derivatives` at trial times
/// (*minor steps*); `d` does not change there. After an accepted step it calls `accept`.
///
/// Where a function is handed `x` or `d` mutably, those of the [`Context`] are empty.
///
/// Who knows a kind can look into it: `(&*block as &dyn Any).downcast_ref::<Gain>()`.
pub trait Block: Any + Debug + Send + Sync {
    /// Reads what the parameters name outside the diagram (tables, plug-ins). Called once, before everything else.
    ///
    /// # Errors
    /// A file that is missing or makes no sense, with the parameter that names it.
    fn load(&mut self, _files: &dyn Files) -> Result<(), LoadError> {
        Ok(())
    }

    /// Says where the block is in the model, `control/noise`: once, behind `load`. Returns whether that makes a difference: blocks that are
    /// written alike are one block otherwise.
    fn place(&mut self, _path: &str) -> bool {
        false
    }

    /// Ports, states and dependencies, from the parameters and from what is known of the inputs. Called several
    /// times while shapes and units travel through the diagram. The names of the ports depend on the parameters
    /// alone.
    ///
    /// # Errors
    /// Inputs that do not fit each other or the parameters.
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new())
    }

    /// Records the law of the block as data, once, when a diagram is compiled: all outputs, derivatives and guards, and the discrete
    /// states that settle or are updated. Such a block needs none of the functions for these; they are not called. Returns `false`,
    /// with nothing recorded, if the block, or the block with these parameters, has to be called instead.
    fn law(&self, _l: &Recording) -> bool {
        false
    }

    /// Why the recorded law cannot go on, in the words of the block; `None` for words of the engine.
    fn no_value(&self, _failure: &Failure, _c: &Context) -> Option<String> {
        None
    }

    /// Scratch space of the block, made once for each simulation and handed back in every evaluation.
    fn scratch(&self) -> Scratch {
        Scratch::default()
    }

    /// Sets states that follow from more than the initial values in the interface. Inputs are not known yet.
    fn initialize(&self, _c: &Context, _x: &mut [f64], _d: &mut [f64]) {}

    /// Chooses the branch (mode) at a major step, just before `outputs`, with the inputs of output group 0 known.
    fn settle(&self, _c: &Context, _d: &mut [f64]) {}

    /// The part of [`settle`](Self::settle) that comes before the outputs of one group, see [`Interface::settling`].
    fn settle_in(&self, _group: usize, c: &Context, d: &mut [f64]) {
        self.settle(c, d);
    }

    /// Writes the outputs of one group: `y = h(t, x, d, u)`. `y` holds all outputs of the block, port after port.
    fn outputs(&self, _group: usize, _c: &Context, _w: &mut Scratch, _y: &mut [f64]) {}

    /// Writes `dx = f(t, x, d, u)`; all inputs are known.
    fn derivatives(&self, _c: &Context, _w: &mut Scratch, _dx: &mut [f64]) {}

    /// Advances the discrete states at a sample hit, after the outputs of that instant. A block with a sample time may
    /// have continuous states, too; its outputs are then evaluated between the hits as well.
    fn update(&self, _c: &Context, _w: &mut Scratch, _d: &mut [f64]) {}

    /// Jumps of states at a major step (a reset, an impact). Returns whether anything changed; the outputs of the
    /// diagram are then evaluated again at the same time.
    fn jump(&self, _c: &Context, _w: &mut Scratch, _x: &mut [f64], _d: &mut [f64]) -> bool {
        false
    }

    /// Functions whose sign changes are events that the solver must not step over.
    fn guards(&self, _c: &Context, _w: &mut Scratch, _g: &mut [f64]) {}

    /// The next time after `c.t` at which the block changes by itself (Step, Pulse); it is hit exactly. Where a block reads no input and
    /// has no state, it is not asked again before that time.
    fn next_event(&self, _c: &Context) -> f64 {
        f64::INFINITY
    }

    /// The next time after `c.t` at which the block would change if it ran, while it does not. Nothing happens then, but an instant that
    /// others bring about, and that differs from it by rounding alone, is meant to be the same and takes place at the later one of both.
    fn pending_event(&self, _c: &Context) -> f64 {
        f64::INFINITY
    }

    /// The next time after `c.t`, before its next sample hit, at which the block wants `update` once more, because its sample time is
    /// too coarse for the moment. It is hit exactly, but is no event: nothing is recorded for its sake. At that very time it is still
    /// the answer. Only when the interface says `subdivides`.
    fn next_update(&self, _c: &Context) -> f64 {
        f64::INFINITY
    }

    /// Notes that its parameters change now: what it has worked out beyond this instant is to be worked out anew, by an update that it
    /// wants at once. Called before they do, and of the block with the new ones. Only when the interface says `subdivides`.
    fn interrupt(&self, _c: &Context, _d: &mut [f64]) {}

    /// Notes the relative tolerance `rtol` of the run among the discrete states, once before it; a method of fixed step has none. Only
    /// when the interface says `subdivides`.
    fn tolerate(&self, _rtol: f64, _d: &mut [f64]) {}

    /// Where an approximation of the block has missed the relative tolerance `rtol` of the run, by how much and what to do
    /// about it; asked at the end of a run.
    fn warnings(&self, _d: &[f64], _rtol: f64) -> Vec<Problem> {
        Vec::new()
    }

    /// By how much something is beyond what should have changed it before the end of a step, of what size so far, and what it is: a method of
    /// fixed step looks at conditions at the ends of steps alone. All outputs are known there, and modes are those of the step.
    fn lateness(&self, _c: &Context, _w: &mut Scratch) -> Option<(f64, f64, &str)> {
        None
    }

    /// Notes what an accepted step brought (rate limits, backlash). Returns whether another law holds from here, so that the
    /// outputs or their slopes differ from those just before; a method of many steps then begins anew.
    fn accept(&self, _c: &Context, _d: &mut [f64]) -> bool {
        false
    }

    /// Notes the inputs over a part of an accepted step, as exactly as the method knows them (delay lines); the parts of a
    /// step come one behind the other, before `accept`. The [`Context`] is that of the end of the part. Only when the
    /// interface says `remembers`.
    fn remember(&self, _c: &Context, _piece: &Piece, _d: &mut [f64]) {}

    /// After `accept`: what comes out of the memory from `c.t` on may do so now. Until then the block gives what it gave just
    /// before, so that who looks at the end of a step sees nothing of a jump there. Where an output reads an input directly, such as a delay
    /// that may jump, also just before `outputs` at a major step. Only when the interface says `remembers`.
    fn reach(&self, _c: &Context, _d: &mut [f64]) {}

    /// The next time after `c.t` at which a derivative of an output jumps, though the output does not. It is hit exactly, but
    /// is no event: nothing is recorded for its sake. Only when the interface says `remembers`.
    fn next_kink(&self, _c: &Context) -> f64 {
        f64::INFINITY
    }

    /// Sets the discrete states to what they would be had the inputs always been what they are (a delay is full of them), and
    /// returns true. Only for a block whose outputs then follow from its inputs alone, in a steady state.
    fn rest(&self, _c: &Context, _d: &mut [f64]) -> bool {
        false
    }

    /// A search for a steady state begins, or has ended and the run begins there: what blocks have summed up so far is not of that run.
    fn seek_rest(&self, _begins: bool, _x: &mut [f64], _d: &mut [f64]) {}

    /// Brings states together that have one value in common, on which nothing that moves depends; says what differed, if anything did. Asked
    /// when a steady state has been found, with all outputs known.
    fn fit(&self, _c: &Context, _w: &mut Scratch, _x: &mut [f64]) -> Option<String> {
        None
    }

    /// What its states obey wherever it can be, at those of the [`Context`], with all outputs known: who linearises moves along that alone.
    fn invariants(&self, _c: &Context, _w: &mut Scratch) -> Vec<Invariant> {
        Vec::new()
    }

    /// Prepares [`solve`](Self::solve): factorises `I - hg J`, with `J` a cheap approximation of the Jacobian of
    /// this block's own states, into `w`; called right after
    /// `derivatives` at the same time and states. Only when the interface says `implicit`.
    fn prepare(&self, _c: &Context, _hg: f64, _w: &mut Scratch) {}

    /// Overwrites `r` (one value per own state) with `(I - hg J)^-1 r` of the last `prepare`.
    fn solve(&self, _w: &mut Scratch, _r: &mut [f64]) {}

    /// The time after which the block has nothing more to show (end of a move), for `stop_time: Auto`.
    fn end_time(&self) -> Option<f64> {
        None
    }

    /// The law of a block that belongs to a physical network.
    fn component(&self) -> Option<&dyn Component> {
        None
    }

    /// What the block does to the names of signals, if it does nothing else.
    fn bus(&self) -> Option<Bus> {
        None
    }
}

/// Scratch space that the engine keeps for a block, so that evaluating it does not allocate. It is no state:
/// every evaluation must give the same result with a fresh one.
#[derive(Default)]
pub struct Scratch(Option<Box<dyn Any + Send>>);

impl Scratch {
    /// Scratch space of this type.
    pub fn new<T: Any + Send>(space: T) -> Self {
        Self(Some(Box::new(space)))
    }

    /// The space, if it is of this type.
    #[inline]
    pub fn get<T: Any>(&mut self) -> Option<&mut T> {
        self.0.as_mut().and_then(|space| space.downcast_mut())
    }
}

impl Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Scratch")
    }
}

/// A block that only gives names: it costs nothing when the diagram runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Bus {
    /// Makes a bus on output `y` from inputs of these names.
    Create(Vec<String>),
    /// Takes these elements (dotted paths) out of the bus on input `u`; each output bears the last name of its path.
    Select(Vec<String>),
}

/// Where blocks read files from.
pub trait Files {
    /// Text of the file at `path`, relative to the diagram that names it.
    ///
    /// # Errors
    /// A sentence why it cannot be read.
    fn read(&self, path: &str) -> Result<String, String>;

    /// The folder of the diagram that names the file, to resolve paths that are not text.
    fn folder(&self) -> &Path;

    /// Who decides whether code that the diagram names is built and loaded; without a decision none is.
    fn code(&self) -> &dyn CodePolicy {
        &NoCode
    }

    /// Reports something about a file that does not stop the diagram.
    fn warn(&self, _warning: LoadError) {}
}

/// Something named by a parameter could not be loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadError {
    /// The parameter that names it.
    pub param: &'static str,
    /// A word for the manual: `missing_file`, `plugin_abi` ...
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}
