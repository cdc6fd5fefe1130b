//! A block kind of a plug-in as checked, owned data, with its functions behind safe calls.

use blocksim_abi::{BlockTable, Message, OK, Status};
use blocksim_signal::Dimension;

use crate::call::Failure;
use crate::guard::room::Room;
use crate::guard::{self, Given, Places, Wanted};
use crate::isolate::{Op, Remote};
#[cfg(feature = "wasm")]
use crate::wasm::Boxed;

/// What states are in messages.
const CONTINUOUS: &str = "continuous state";
const DISCRETE: &str = "discrete state";

/// A parameter, a port or a state of a plug-in.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name in diagrams.
    pub name: &'static str,
    /// SI unit as the plug-in writes it; `""`: any.
    pub unit: &'static str,
    /// Dimension of the unit; `None`: any.
    pub dimension: Option<Dimension>,
    /// How many numbers.
    pub length: usize,
    /// A sentence for the manual.
    pub doc: &'static str,
    /// Value where nothing is given, `length` numbers.
    pub default: Option<&'static [f64]>,
    /// Of an output: indices of the inputs that it depends on at the same instant.
    pub reads: Vec<usize>,
}

/// A block kind of a plug-in.
#[derive(Debug)]
pub struct Kind {
    /// Name in diagrams.
    pub name: &'static str,
    /// Page of the manual, Markdown.
    pub doc: &'static str,
    /// Parameters.
    pub parameters: Vec<Quantity>,
    /// Input ports.
    pub inputs: Vec<Quantity>,
    /// Output ports.
    pub outputs: Vec<Quantity>,
    /// Continuous states.
    pub continuous: Vec<Quantity>,
    /// Discrete states.
    pub discrete: Vec<Quantity>,
    pub(crate) calls: Calls,
    pub(crate) sizes: Sizes,
}

/// Where the functions of a block are.
#[derive(Clone, Copy)]
pub(crate) enum Calls {
    /// The plug-in was not loaded.
    Nowhere,
    /// In this process. Only the functions of the table are used after it was checked.
    Table(BlockTable),
    /// In another one.
    Remote(Remote),
    /// In a WebAssembly module.
    #[cfg(feature = "wasm")]
    Boxed(Boxed),
}

impl std::fmt::Debug for Calls {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Calls::Nowhere => "Nowhere",
            Calls::Table(_) => "Table",
            Calls::Remote(_) => "Remote",
            #[cfg(feature = "wasm")]
            Calls::Boxed(_) => "Boxed",
        })
    }
}

/// How many numbers each buffer holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sizes {
    pub params: usize,
    pub u: usize,
    pub y: usize,
    pub x: usize,
    pub xd: usize,
}

impl Sizes {
    /// The most that one call may need, given and wanted.
    pub fn in_all(self) -> usize {
        let Sizes { params, u, y, x, xd } = self;
        params + u + x + xd + y.max(x).max(xd)
    }
}

/// How many numbers a list describes.
pub(crate) fn numbers(list: &[Quantity]) -> usize {
    list.iter().map(|quantity| quantity.length).sum()
}

/// What every evaluation is given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct At<'a> {
    pub params: &'a [f64],
    pub t: f64,
    pub x: &'a [f64],
    pub xd: &'a [f64],
    pub u: &'a [f64],
}

/// The functions of the table. Buffers of wrong length are refused, so none of these can go astray.
impl Kind {
    /// Whether the plug-in takes these parameters.
    pub(crate) fn check(&self, params: &[f64]) -> Result<(), Failure> {
        fits(params.len(), self.sizes.params)?;
        self.call(Op::Check, 0.0, &[self.params(params)], &mut [])
    }

    /// Sample time, s; 0: continuous.
    pub(crate) fn sample_time(&self, params: &[f64]) -> Result<f64, Failure> {
        fits(params.len(), self.sizes.params)?;
        let mut period = [0.0];
        let wanted = Wanted { what: "sample time", list: &[], numbers: &mut period, is_kept: true };
        self.call(Op::SampleTime, 0.0, &[self.params(params)], &mut [wanted])?;
        Ok(period[0])
    }

    /// States at the start; both buffers hold the defaults.
    pub(crate) fn reset(&self, params: &[f64], x: &mut [f64], xd: &mut [f64]) -> Result<(), Failure> {
        fits(params.len(), self.sizes.params)?;
        fits(x.len(), self.sizes.x)?;
        fits(xd.len(), self.sizes.xd)?;
        let mut wanted = [
            Wanted { what: CONTINUOUS, list: &self.continuous, numbers: x, is_kept: true },
            Wanted { what: DISCRETE, list: &self.discrete, numbers: xd, is_kept: true },
        ];
        self.call(Op::Reset, 0.0, &[self.params(params)], &mut wanted)
    }

    /// All outputs.
    pub(crate) fn outputs(&self, room: Option<&mut Room>, at: &At, y: &mut [f64]) -> Result<(), Failure> {
        fits(y.len(), self.sizes.y)?;
        let wanted = Wanted { what: "output", list: &self.outputs, numbers: y, is_kept: false };
        self.evaluate(room, Op::Outputs, at, wanted)
    }

    /// Discrete states of the next sample; `next` holds a copy of the present ones.
    pub(crate) fn update(&self, room: Option<&mut Room>, at: &At, next: &mut [f64]) -> Result<(), Failure> {
        fits(next.len(), self.sizes.xd)?;
        let wanted =
            Wanted { what: "next discrete state", list: &self.discrete, numbers: next, is_kept: true };
        self.evaluate(room, Op::Update, at, wanted)
    }

    /// Time derivatives of the continuous states.
    pub(crate) fn derivatives(
        &self,
        room: Option<&mut Room>,
        at: &At,
        dx: &mut [f64],
    ) -> Result<(), Failure> {
        fits(dx.len(), self.sizes.x)?;
        let wanted = Wanted { what: "derivative", list: &self.continuous, numbers: dx, is_kept: false };
        self.evaluate(room, Op::Derivatives, at, wanted)
    }

    fn params<'a>(&'a self, numbers: &'a [f64]) -> Given<'a> {
        Given { what: "parameter", list: &self.parameters, numbers }
    }

    /// The room of a block for evaluations, where they are calls of functions of this process; others bring their own.
    pub(crate) fn room(&self) -> Option<Room> {
        let Sizes { params, u, y, x, xd } = self.sizes;
        matches!(self.calls, Calls::Table(_)).then(|| Room::new([params, x, xd, u], y.max(x).max(xd)))
    }

    /// Calls a function that is given all that an evaluation may read, in the room of the block if it has one.
    #[inline]
    fn evaluate(&self, room: Option<&mut Room>, op: Op, at: &At, mut wanted: Wanted) -> Result<(), Failure> {
        let (Some(room), Calls::Table(table)) = (room, &self.calls) else {
            return self.call(op, at.t, &self.given(at)?, &mut [wanted]);
        };
        self.fit(at)?;
        let given = [at.params, at.x, at.xd, at.u];
        // SAFETY: as in `call`: the room has been made for the lengths that the table states, and `fit` has compared these.
        room.call(
            given,
            &mut wanted,
            || self.named(at),
            |places, m| unsafe { perform(table, op, at.t, places, m) },
        )
    }

    /// Refuses lists of other lengths than the table states.
    fn fit(&self, at: &At) -> Result<(), Failure> {
        fits(at.params.len(), self.sizes.params)?;
        fits(at.x.len(), self.sizes.x)?;
        fits(at.xd.len(), self.sizes.xd)?;
        fits(at.u.len(), self.sizes.u)
    }

    /// What every evaluation may read.
    fn given<'a>(&'a self, at: &At<'a>) -> Result<[Given<'a>; 4], Failure> {
        self.fit(at)?;
        Ok(self.named(at))
    }

    /// The same with names, whatever the lengths.
    fn named<'a>(&'a self, at: &At<'a>) -> [Given<'a>; 4] {
        [
            self.params(at.params),
            Given { what: CONTINUOUS, list: &self.continuous, numbers: at.x },
            Given { what: DISCRETE, list: &self.discrete, numbers: at.xd },
            Given { what: "input", list: &self.inputs, numbers: at.u },
        ]
    }

    /// Calls a function wherever it is, with buffers of the lengths that the table states.
    fn call(&self, op: Op, t: f64, given: &[Given], wanted: &mut [Wanted]) -> Result<(), Failure> {
        match &self.calls {
            Calls::Nowhere => Err(Failure { status: OK, text: "the plug-in was never loaded".to_owned() }),
            Calls::Remote(remote) => remote.call(op, t, given, wanted),
            #[cfg(feature = "wasm")]
            Calls::Boxed(boxed) => boxed.call(op, t, given, wanted),
            Calls::Table(table) => {
                // SAFETY: `guard` gives places for as many numbers as each buffer has, the callers of this function have
                // checked these, and the message is valid during the call.
                guard::call(given, wanted, |places, m| unsafe { perform(table, op, t, places, m) })
            }
        }
    }
}

/// Calls a function of a table; one that is absent does nothing.
///
/// # Safety
/// The table is that of a loaded plug-in; the places hold buffers of the lengths that it states for this function.
unsafe fn perform(table: &BlockTable, op: Op, t: f64, places: &Places, m: *const Message) -> Status {
    let Places { given: [params, x, xd, u], wanted: [first, second] } = *places;
    // SAFETY: the caller vouches for all of it.
    unsafe {
        match op {
            Op::Check => table.check.map(|check| check(params, m)),
            Op::SampleTime => table.sample_time.map(|sample_time| sample_time(params, first, m)),
            Op::Reset => table.reset.map(|reset| reset(params, first, second, m)),
            Op::Outputs => table.outputs.map(|outputs| outputs(params, t, x, xd, u, first, m)),
            Op::Update => table.update.map(|update| update(params, t, x, xd, u, first, m)),
            Op::Derivatives => {
                table.derivatives.map(|derivatives| derivatives(params, t, x, xd, u, first, m))
            }
        }
    }
    .unwrap_or(OK)
}

#[inline]
fn fits(given: usize, wanted: usize) -> Result<(), Failure> {
    if given == wanted {
        return Ok(());
    }
    Err(Failure {
        status: OK,
        text: format!("a bug of blocksim: it has {given} numbers where the plug-in takes {wanted}"),
    })
}
