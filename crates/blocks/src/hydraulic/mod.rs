//! Blocks: hydraulic networks: resistances, volumes, sources, pump, cylinder, valves, sensors. Pressures are above that of the
//! atmosphere.

mod accumulator;
mod check_valve;
mod directional_valve;
mod fluid_volume;
mod hydraulic_cylinder;
mod hydraulic_flow_sensor;
mod hydraulic_flow_source;
mod hydraulic_pipe;
mod hydraulic_pressure_source;
mod hydraulic_pump;
mod hydraulic_resistance;
mod opening;
mod orifice;
mod pressure_sensor;
mod relief_valve;
mod tank;
mod variable_orifice;

pub use accumulator::Accumulator;
pub use check_valve::CheckValve;
pub use directional_valve::DirectionalValve;
pub use fluid_volume::FluidVolume;
pub use hydraulic_cylinder::HydraulicCylinder;
pub use hydraulic_flow_sensor::HydraulicFlowSensor;
pub use hydraulic_flow_source::HydraulicFlowSource;
pub use hydraulic_pipe::HydraulicPipe;
pub use hydraulic_pressure_source::HydraulicPressureSource;
pub use hydraulic_pump::HydraulicPump;
pub use hydraulic_resistance::HydraulicResistance;
pub use opening::Opening;
pub use orifice::Orifice;
pub use pressure_sensor::PressureSensor;
pub use relief_valve::ReliefValve;
pub use tank::Tank;
pub use variable_orifice::VariableOrifice;

use blocksim_block::Floor;
use blocksim_block::physical::{Domain, Part};

/// Pressure of the atmosphere, Pa.
const ATMOSPHERE: f64 = 101_325.0;

/// A liquid evaporates before its pressure is that low, or the air in it comes out: the pressure stays about there, and what the pump or
/// the piston leaves is a bubble.
const VACUUM: Floor = Floor {
    value: -ATMOSPHERE,
    name: "a vacuum",
    unit: "Pa",
    help: "the liquid cavitates there, which no part shows: feed it from a higher pressure, by a wider line or a `CheckValve` from the \
           tank, or move more slowly",
};

/// The ports `a` and `b` of a hydraulic two-pin.
fn ends() -> Part {
    Part::new().port("a", Domain::Hydraulic, "hydraulic port that fluid enters by").port(
        "b",
        Domain::Hydraulic,
        "hydraulic port that it leaves by",
    )
}
