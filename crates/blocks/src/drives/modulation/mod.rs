//! Pulse-width modulation without blocks: from voltages to duties ([`Modulation`]), from duties to instants of
//! switching ([`Carrier`]), and what the legs of a bridge have to remember in between ([`Modulator`]).
//!
//! A leg is *high* while its upper switch is commanded on and *low* while its lower one is. A period of the carrier
//! begins low, is high in its middle and ends low; it consists of two halves, which are counted from time 0. All
//! instants are computed from these counts, so they do not drift, however long a run is.

mod amount;
mod carrier;
mod law;
mod modulator;

pub use amount::Amount;
pub use carrier::Carrier;
pub use law::{BRANCHES, Modulation, duty};
pub use modulator::{Modulator, Sampling};
