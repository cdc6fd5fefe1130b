//! A block kind of a plug-in as checked, owned data, with its functions behind safe calls.

use blocksim_abi::{BlockTable, OK};
use blocksim_signal::Dimension;

use crate::call::{Failure, call};

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
    /// None where the plug-in was not loaded.
    pub(crate) functions: Option<Functions>,
    pub(crate) sizes: Sizes,
}

/// The table of the plug-in; only its functions are used after it was checked.
#[derive(Clone, Copy)]
pub(crate) struct Functions(pub BlockTable);

impl std::fmt::Debug for Functions {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Functions")
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
    fn table(&self) -> Result<&BlockTable, Failure> {
        let never = || Failure { status: OK, text: "the plug-in was never loaded".to_owned() };
        self.functions.as_ref().map(|functions| &functions.0).ok_or_else(never)
    }

    /// Whether the plug-in takes these parameters.
    pub(crate) fn check(&self, params: &[f64]) -> Result<(), Failure> {
        fits(params.len(), self.sizes.params)?;
        let Some(check) = self.table()?.check else { return Ok(()) };
        // SAFETY: a buffer of the length that the table states; the message is valid during the call.
        call(|m| unsafe { check(params.as_ptr(), m) })
    }

    /// Sample time, s; 0: continuous.
    pub(crate) fn sample_time(&self, params: &[f64]) -> Result<f64, Failure> {
        fits(params.len(), self.sizes.params)?;
        let mut period = 0.0;
        let Some(sample_time) = self.table()?.sample_time else { return Ok(period) };
        // SAFETY: as above, and `period` is a number to write.
        call(|m| unsafe { sample_time(params.as_ptr(), &mut period, m) })?;
        Ok(period)
    }

    /// States at the start; both buffers hold the defaults.
    pub(crate) fn reset(&self, params: &[f64], x: &mut [f64], xd: &mut [f64]) -> Result<(), Failure> {
        fits(params.len(), self.sizes.params)?;
        fits(x.len(), self.sizes.x)?;
        fits(xd.len(), self.sizes.xd)?;
        let Some(reset) = self.table()?.reset else { return Ok(()) };
        // SAFETY: buffers of the lengths that the table states; two `&mut` never overlap.
        call(|m| unsafe { reset(params.as_ptr(), x.as_mut_ptr(), xd.as_mut_ptr(), m) })
    }

    /// All outputs.
    pub(crate) fn outputs(&self, at: &At, y: &mut [f64]) -> Result<(), Failure> {
        self.fits(at)?;
        fits(y.len(), self.sizes.y)?;
        let Some(outputs) = self.table()?.outputs else { return Ok(()) };
        let At { params, t, x, xd, u } = *at;
        // SAFETY: buffers of the lengths that the table states; a `&mut` overlaps nothing.
        call(|m| unsafe {
            outputs(params.as_ptr(), t, x.as_ptr(), xd.as_ptr(), u.as_ptr(), y.as_mut_ptr(), m)
        })
    }

    /// Discrete states of the next sample; `next` holds a copy of the present ones.
    pub(crate) fn update(&self, at: &At, next: &mut [f64]) -> Result<(), Failure> {
        self.fits(at)?;
        fits(next.len(), self.sizes.xd)?;
        let Some(update) = self.table()?.update else { return Ok(()) };
        let At { params, t, x, xd, u } = *at;
        // SAFETY: as above.
        call(|m| unsafe {
            update(params.as_ptr(), t, x.as_ptr(), xd.as_ptr(), u.as_ptr(), next.as_mut_ptr(), m)
        })
    }

    /// Time derivatives of the continuous states.
    pub(crate) fn derivatives(&self, at: &At, dx: &mut [f64]) -> Result<(), Failure> {
        self.fits(at)?;
        fits(dx.len(), self.sizes.x)?;
        let Some(derivatives) = self.table()?.derivatives else { return Ok(()) };
        let At { params, t, x, xd, u } = *at;
        // SAFETY: as above.
        call(|m| unsafe {
            derivatives(params.as_ptr(), t, x.as_ptr(), xd.as_ptr(), u.as_ptr(), dx.as_mut_ptr(), m)
        })
    }

    fn fits(&self, at: &At) -> Result<(), Failure> {
        fits(at.params.len(), self.sizes.params)?;
        fits(at.x.len(), self.sizes.x)?;
        fits(at.xd.len(), self.sizes.xd)?;
        fits(at.u.len(), self.sizes.u)
    }
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
