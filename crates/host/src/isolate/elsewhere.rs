//! Where there are no sockets between processes: plug-ins cannot be kept apart.

use blocksim_block::LoadError;

use super::Op;
use crate::call::Failure;
use crate::fault::{self, MISSING};
use crate::guard::{Given, Wanted};
use crate::open::{Binary, Library};

/// A block of a plug-in in another process, which cannot exist on this system.
#[derive(Debug, Clone, Copy)]
pub enum Remote {}

impl Remote {
    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn call(&self, _op: Op, _t: f64, _given: &[Given], _wanted: &mut [Wanted]) -> Result<(), Failure> {
        match *self {}
    }
}

/// Refuses.
///
/// # Errors
/// Always.
pub fn open(_binary: &Binary, named: &str, _is_moving: bool) -> Result<Library, LoadError> {
    let message = format!("the plug-in `{named}` cannot be run in a process of its own on this system");
    Err(fault::library(MISSING, message))
}

/// Never used.
pub fn last_duration() -> f64 {
    0.0
}

/// Never.
pub fn was_interrupted() -> bool {
    false
}

/// Refuses.
///
/// # Errors
/// Always.
pub fn serve() -> std::io::Result<()> {
    Err(std::io::ErrorKind::Unsupported.into())
}
