//! Blocks: magnetic circuits: reluctances, cores that saturate, windings, sources, sensors.

mod flux_sensor;
mod magnetic_core;
mod magnetic_potential_sensor;
mod magnetic_reference;
mod magnetic_winding;
mod mmf_source;
mod reluctance;

pub use flux_sensor::FluxSensor;
pub use magnetic_core::MagneticCore;
pub use magnetic_potential_sensor::MagneticPotentialSensor;
pub use magnetic_reference::MagneticReference;
pub use magnetic_winding::MagneticWinding;
pub use mmf_source::MmfSource;
pub use reluctance::Reluctance;

use blocksim_block::physical::{Domain, Part};

/// Magnetic constant, H/m (CODATA 2018).
const MU_0: f64 = 1.256_637_062_12e-6;

/// The ports `p` and `n` of a magnetic two-pin.
fn poles() -> Part {
    Part::new().port("p", Domain::Magnetic, "positive magnetic pole").port(
        "n",
        Domain::Magnetic,
        "negative magnetic pole",
    )
}
